"""Measures the pages in a real browser: what is painted when, a tap on START, and the first page on a slow link."""

import random
import time
from typing import List, NamedTuple, Tuple

from fleet import Fleet, Robot
from gateway import LONGEST_PAUSE_S, organisers_code
from processes import Box, wait
from support.browser import Browser, Page, find

from roah_rsbb.protocol import BoxState, RobotState

PHONE, SCREEN = (360, 740), (1280, 800)
# 1 Mbit/s, and a delay that a wireless network has.
SLOW = {"offline": False, "latency": 5, "downloadThroughput": 125_000, "uploadThroughput": 125_000}
CLOCK_PROBES = 30

# After the frame that shows a change: a task that is posted in it runs when the frame is drawn.
_PAINTED = """
window.painted = [];
const afterFrame = done => requestAnimationFrame(() => {
  const channel = new MessageChannel();
  channel.port1.onmessage = () => done(performance.now());
  channel.port2.postMessage(0);
});
"""
_CHANGES = _PAINTED + """
const shown = () => [...document.querySelectorAll(".below")].map(part => part.textContent).join();
let last = shown();
new MutationObserver(() => {
  if (shown() !== last) {
    last = shown();
    afterFrame(time => painted.push(time));
  }
}).observe(document.body, {subtree: true, childList: true, characterData: true});
"""
# When Chromium has given the lift of a finger to the page.
_CLICKS = """
window.clicked = [];
addEventListener("click", () => clicked.push(performance.now()), true);
"""
_FIRST = _PAINTED + """
new MutationObserver((_, observer) => {
  if (document.querySelector(".cards")) {
    observer.disconnect();
    afterFrame(time => painted.push(time));
  }
}).observe(document, {subtree: true, childList: true});
const Real = WebSocket;
window.received = 0;
window.WebSocket = class extends Real {
  constructor(...how) {
    super(...how);
    this.addEventListener("message", event => received += event.data.length);
  }
};
window.WebSocket.OPEN = Real.OPEN;
"""
_BYTES = """
performance.getEntriesByType("navigation").concat(performance.getEntriesByType("resource"))
  .reduce((sum, entry) => sum + entry.transferSize, 0) + received
"""


class FirstPage(NamedTuple):
    """What the first visit of a page takes."""

    kilobytes: float  # of all files, as compressed, with their headers, and of the first live data
    seconds: float  # from the beginning of the navigation until the runs are painted


class Pages:
    """A browser, beside a box with pages. Use it as a context manager."""

    def __init__(self, box: Box) -> None:
        self.url = f"http://127.0.0.1:{box.web_port}"
        program = find()
        if program is None:
            raise SystemExit("bench: no Chromium: on Debian apt-get install chromium")
        self._browser = Browser(program)

    def __enter__(self) -> "Pages":
        return self

    def __exit__(self, *_error: object) -> None:
        self._browser.close()

    def painted(self, box: Box, count: int) -> List[float]:
        """Milliseconds from the call of a command until the display has painted the change, `count` times."""
        page = self._browser.page(f"{self.url}/display?layout=list", *SCREEN)
        page.wait("document.querySelector('.below') !== null", "the events are shown")
        page.get(f"(() => {{ {_CHANGES} window.painted = painted; }})()")
        offset_s, dice, taken = _offset_s(page), random.Random(7), []
        for number in range(count):
            at = time.monotonic()
            box.command("previous" if number % 2 else "next", 0)
            page.wait("painted.length > 0", "the change is painted")
            taken.append((page.get("painted.shift()") / 1e3 - offset_s - at) * 1e3)
            time.sleep(dice.uniform(0.2, LONGEST_PAUSE_S))
        page.close()
        return taken

    def taps(self, box: Box, fleet: Fleet, robot: Robot, count: int) -> Tuple[List[float], List[float]]:
        """Milliseconds from a finger's lift on START until the box sends PREPARE, `count` times.

        Beside them: those from the lift until the page gets the click, which are Chromium's alone.
        """
        page = self._browser.page(organisers_code()["url"], *PHONE)
        page.wait("document.querySelector('#person') !== null", "the form is shown")
        page.get("document.querySelector('#person').value = 'Bench'")
        page.touch_at("form button")
        page.wait_address("/box")
        page.get(f"(() => {{ {_CLICKS} }})()")
        offset_s = _offset_s(page)
        button, dice = 'button[data-command="start"]', random.Random(8)
        taken: List[float] = []
        clicked: List[float] = []
        for _ in range(count):
            _reconnect(box, robot)
            page.wait(f"(b => b && !b.disabled && !b.dataset.changed)(document.querySelector('{button}'))",
                      "START is on")
            page.get(f"document.querySelector('{button}').scrollIntoView({{block: 'center'}})")
            time.sleep(dice.uniform(0.05, 0.25))
            left, top, width, height = page.box(button)
            page.touch(left + width / 2, top + height / 2, lift=False)
            at = time.monotonic()
            taken.append(fleet.ask(page.lift, robot, BoxState.PREPARE))
            clicked.append((page.get("clicked.shift()") / 1e3 - offset_s - at) * 1e3)
        page.close()
        return taken, clicked

    def first(self, count: int) -> List[FirstPage]:
        """What the first visit of the display takes over a slow link, `count` times."""
        found = []
        for _ in range(count):
            page = self._browser.page("about:blank", *SCREEN)
            page.command("Network.setCacheDisabled", cacheDisabled=True)
            page.command("Network.emulateNetworkConditions", **SLOW)
            page.command("Page.addScriptToEvaluateOnNewDocument", source=f"{{ {_FIRST} }}")
            page.command("Page.navigate", url=f"{self.url}/display")
            page.wait_address("/display")
            page.wait("painted.length > 0", "the display is painted")
            found.append(FirstPage(page.get(_BYTES) / 1e3, page.get("painted[0]") / 1e3))
            page.close()
        return found


def _reconnect(box: Box, robot: Robot) -> None:
    """Take the robot's run back to where START is pressed once."""
    box.command("stop", 0)
    wait(lambda: robot.box_state is BoxState.STOP and robot.state is RobotState.STOP, "the run is stopped")
    box.command_when_allowed("disconnect", 0)
    box.command_when_allowed("connect", 0)
    wait(lambda: robot.box_state is BoxState.STOP and robot.state is RobotState.STOP, "the robot is connected")


def _offset_s(page: Page) -> float:
    """How far the page's clock is ahead of time.monotonic: from the exchange that took the least time."""
    best = (float("inf"), 0.0)
    for _ in range(CLOCK_PROBES):
        before = time.monotonic()
        there = page.get("performance.now()") / 1e3
        after = time.monotonic()
        best = min(best, (after - before, there - (before + after) / 2))
    return best[1]
