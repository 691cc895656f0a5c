"""A real browser, touched as by a finger: Chromium without a window, driven by its DevTools protocol.

No more than chromium and tornado (which the tablet needs anyway) is needed for that.
"""

import asyncio
import base64
import contextlib
import itertools
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import unittest
from typing import Any, ClassVar, Dict, List, Optional, Tuple

from tornado import websocket

from roah_rsbb.results.printing import BROWSERS
from support.waiting import LIMIT_S, wait_until

LOOK_AGAIN_S = 0.05
IS_ALL = os.environ.get("ROAH_TEST_ALL") == "yes"
_AXE = pathlib.Path(__file__).resolve().parents[2] / "data" / "axe" / "axe.min.js"
_MAX_ANSWER_BYTES = 64 * 1024 * 1024
# Sets window.tapped when the next touch ends: whether an element was clicked. Nothing else is: the page may move the
# element away between the look at its place and the touch, or change its meaning, and then it ignores the touch.
_NOTE_TAP = """element => {
  window.tapped = null;
  window.taps?.abort();
  window.taps = new AbortController();
  for (const kind of ["pointerup", "pointercancel", "click"]) {
    window.addEventListener(kind, event => {
      const isHit = kind !== "pointercancel" && element.contains(event.target)
        && !element.matches(":disabled, [data-changed]");
      if (window.tapped !== true && !isHit) {
        event.preventDefault();
        event.stopImmediatePropagation();
        window.tapped = false;
      } else if (kind === "click" && window.tapped === null) {
        window.tapped = true;
        window.taps.abort();
      }
    }, {capture: true, signal: window.taps.signal});
  }
}"""


def find(is_shown: bool = False) -> Optional[str]:
    """The browser's program; None: there is none that runs (on Ubuntu 20.04 it is only the way to a snap). `is_shown`:
    one that can show a window."""
    for name in BROWSERS[is_shown:]:
        path = shutil.which(name)
        if path is not None:
            asked = subprocess.run([path, "--version"], capture_output=True, text=True, check=False)
            if asked.returncode == 0:
                return path
    return None


class Browser:
    """A Chromium that reaches only this machine. Close it at the end of the test."""

    def __init__(self, program: str, *options: str, is_shown: bool = False) -> None:
        """`is_shown`: in windows on the display of this process, which keys of `real_input` reach."""
        self._folder = tempfile.mkdtemp(prefix="roah_browser_")
        self._process = subprocess.Popen(
            [program, "--ozone-platform=x11" if is_shown else "--headless=new", "--remote-debugging-port=0",
             f"--user-data-dir={self._folder}", "--no-sandbox", "--no-first-run", "--no-default-browser-check",
             "--disable-background-networking", "--disable-sync",
             "--disable-component-update", "--disable-gpu", "--disable-backgrounding-occluded-windows",
             "--disable-renderer-backgrounding", "--disable-dev-shm-usage", "--hide-scrollbars",
             "--renderer-process-limit=1",  # each start of a process for a page takes 0.1 s of CPU
             "--proxy-server=direct://", "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1", *options,
             "about:blank"],
            stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True,
        )
        self.errors: List[str] = []  # of the pages' own programs, and whatever could not be loaded
        self.stays = False  # what is answered to a page that asks whether it is to be left
        self.asked = 0  # how many have asked
        self._answers: Dict[int, asyncio.Future] = {}
        self._loads: Dict[str, asyncio.Future] = {}  # by session
        self._numbers = itertools.count(1)
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, name="browser", daemon=True)
        self._thread.start()
        try:
            self._connection = self._do(self._connect())
        except BaseException:
            self.close()
            raise

    def kill(self) -> None:
        """End the browser as a crash does. Close it all the same."""
        self._signal(signal.SIGKILL)
        self._process.wait()

    def close(self) -> None:
        """End the browser."""
        self._signal(signal.SIGTERM)
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(LIMIT_S)
        self._signal(signal.SIGKILL)
        self._process.wait()
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join(LIMIT_S)
        shutil.rmtree(self._folder, ignore_errors=True)

    def _signal(self, number: int) -> None:
        """Send a signal to the browser and to the script that started it."""
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self._process.pid, number)

    def page(self, url: str, width: int, height: int, scale: float = 1.0, is_alone: bool = False) -> "Page":
        """A page on a touch screen of this size, in CSS pixels. `is_alone`: it shares no cookies with other pages."""
        own = {"browserContextId": self.command("Target.createBrowserContext")["browserContextId"]} if is_alone else {}
        target = self.command("Target.createTarget", url="about:blank", newWindow=True, **own)["targetId"]
        session = self.command("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        page = Page(self, session, target)
        for domain in ("Page", "Runtime", "Log", "Network"):
            page.command(f"{domain}.enable")
        page.command("Emulation.setTouchEmulationEnabled", enabled=True, maxTouchPoints=2)
        page.resize(width, height, scale)
        page.open(url)
        return page

    def command(self, method: str, session: Optional[str] = None, **parameters: Any) -> Dict[str, Any]:
        """Send a DevTools command; returns its result."""
        return self._do(self._ask(method, session, parameters))

    def all_of(self, method: str, session: str, parameters: Tuple[Dict[str, Any], ...]) -> None:
        """Send several DevTools commands at once."""
        async def ask_all() -> None:
            await asyncio.gather(*(self._ask(method, session, each) for each in parameters))
        self._do(ask_all())

    def _do(self, coroutine: Any) -> Any:
        return asyncio.run_coroutine_threadsafe(coroutine, self._loop).result(LIMIT_S)

    async def _connect(self) -> websocket.WebSocketClientConnection:
        reported = pathlib.Path(self._folder, "DevToolsActivePort")
        while not (reported.exists() and len(reported.read_text().splitlines()) == 2):
            await asyncio.sleep(LOOK_AGAIN_S)  # a file cannot be awaited
        port, path = reported.read_text().splitlines()
        return await websocket.websocket_connect(
            f"ws://127.0.0.1:{port}{path}", on_message_callback=self._receive, max_message_size=_MAX_ANSWER_BYTES
        )

    def load(self, session: str, url: str) -> None:
        """Open an address in a page, and wait until it is loaded."""
        self._do(self._load(session, url))

    async def _load(self, session: str, url: str) -> None:
        loaded = self._loads[session] = self._loop.create_future()
        answer = await self._ask("Page.navigate", session, {"url": url})
        if "errorText" in answer:  # what is shown instead is empty
            raise ConnectionError(f"{url}: {answer['errorText']}")
        await loaded

    async def _ask(self, method: str, session: Optional[str], parameters: Dict[str, Any]) -> Dict[str, Any]:
        number = next(self._numbers)
        message = {"id": number, "method": method, "params": parameters}
        if session is not None:
            message["sessionId"] = session
        answer = self._answers[number] = self._loop.create_future()
        await self._connection.write_message(json.dumps(message))
        return await answer

    def _receive(self, text: Optional[str]) -> None:
        message = json.loads(text) if text else {}
        answer = self._answers.pop(message.get("id", 0), None)
        if answer is not None:
            if "error" in message:
                answer.set_exception(RuntimeError(message["error"]["message"]))
            else:
                answer.set_result(message["result"])
        elif message.get("method") == "Page.loadEventFired":
            loaded = self._loads.pop(message["sessionId"], None)
            if loaded is not None:
                loaded.set_result(None)
        elif message.get("method") == "Page.javascriptDialogOpening":
            self.asked += 1
            answered = self._ask("Page.handleJavaScriptDialog", message["sessionId"], {"accept": not self.stays})
            self._loop.create_task(answered)
        elif message.get("method") == "Runtime.exceptionThrown":
            self.errors.append(json.dumps(message["params"]["exceptionDetails"]))
        elif message.get("method") == "Log.entryAdded" and message["params"]["entry"]["level"] == "error":
            self.errors.append(message["params"]["entry"]["text"])


class Page:
    """One page on its touch screen."""

    def __init__(self, browser: Browser, session: str, target: str) -> None:
        self._browser = browser
        self._session = session
        self._target = target

    def command(self, method: str, **parameters: Any) -> Dict[str, Any]:
        """Send a DevTools command for this page."""
        return self._browser.command(method, self._session, **parameters)

    def commands(self, method: str, *parameters: Dict[str, Any]) -> None:
        """Send several DevTools commands without waiting for the answers between them."""
        self._browser.all_of(method, self._session, parameters)

    def open(self, url: str) -> None:
        """Open another address, and wait until it is loaded."""
        self._browser.load(self._session, url)

    def reload(self, **how: Any) -> None:
        """Load the page again, and wait for that: a browser that asks first takes a moment."""
        self.get("window.isOld = true, 0")
        self.command("Page.reload", **how)
        wait_until(lambda: self.is_now("!window.isOld && document.readyState === 'complete'"), "it is loaded again")

    def close(self) -> None:
        """Close the page."""
        self._browser.command("Target.closeTarget", targetId=self._target)

    def resize(self, width: int, height: int, scale: float = 1.0) -> None:
        """Another screen, or the same one turned."""
        self.command(
            "Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=scale, mobile=True
        )

    def get(self, script: str) -> Any:
        """The value of a JavaScript expression."""
        answer = self.command("Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True)
        assert "exceptionDetails" not in answer, f"{script}: {answer['exceptionDetails']}"
        return answer["result"].get("value")

    def wait(self, condition: str, what: str) -> None:
        """Wait until a JavaScript expression is true."""
        # What is looked for may be missing until the page is drawn again: then the condition raises an exception.
        poll = "new Promise(done => { const holds = () => { try " \
               f"{{ return {condition}; }} catch {{ return false; }} }}; " \
               "const look = () => { if (holds()) done(true); " \
               "else if (performance.now() > end) done(false); else setTimeout(look, 50); }; " \
               f"const end = performance.now() + {LIMIT_S * 1000 / 2}; look(); }})"
        assert self.get(poll), (f"not so: {what}; the page says:\n{self.get('document.body.innerText')}\n"
                                f"its errors: {self._browser.errors}")

    def note(self, condition: str) -> str:
        """Note from now on whether a JavaScript expression becomes true, for however short a time. Returns the
        expression that says so."""
        self.get(f"window.noted = {condition}; "
                 f"new MutationObserver(() => {{ window.noted = window.noted || {condition}; }}).observe("
                 "document.body, {subtree: true, childList: true, characterData: true, attributes: true})")
        return "window.noted"

    def wait_address(self, path: str) -> None:
        """Wait until the page's script has opened another page of this path, and that page is loaded."""
        condition = f"location.pathname === {json.dumps(path)} && document.readyState === 'complete'"
        wait_until(lambda: self.is_now(condition), f"{path} is opened")

    def is_now(self, condition: str) -> bool:
        """Whether a JavaScript expression is true, on a page that may be left at this moment."""
        # Its parts may be missing until it is loaded.
        with contextlib.suppress(RuntimeError):  # a script cannot be asked while its page is left
            return self.get(f"(() => {{ try {{ return {condition}; }} catch {{ return false; }} }})()")
        return False

    def box(self, selector: str) -> Tuple[float, float, float, float]:
        """Left, top, width and height of an element, in CSS pixels."""
        return tuple(self.get(
            f"(() => {{ const b = document.querySelector({json.dumps(selector)}).getBoundingClientRect(); "
            "return [b.left, b.top, b.width, b.height]; })()"))

    def touch(self, x: float, y: float, lift: bool = True) -> None:
        """One finger down there, and up again at once: a pause between two commands would make it a long press."""
        self.commands("Input.dispatchTouchEvent", {"type": "touchStart", "touchPoints": [{"x": x, "y": y}]},
                      *([{"type": "touchEnd", "touchPoints": []}] if lift else []))

    def lift(self) -> None:
        """All fingers up."""
        self.command("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])

    def touch_at(self, selector: str, u: float = 0.5, v: float = 0.5) -> None:
        """Touch an element; `u`, `v`: fractions of it from its left and top."""
        left, top, width, height = self.box(selector)
        self.touch(left + u * width, top + v * height)

    def tap(self, selector: str) -> bool:
        """Touch a button. Returns whether the touch has reached it: the page may move it away at this moment. What is
        reached instead does not notice."""
        self.get(f"({_NOTE_TAP})(document.querySelector({json.dumps(selector)})), 0")
        self.touch_at(selector)
        try:
            self.wait("window.tapped !== null", "the touch is taken")
            return self.get("window.tapped") is not False  # undefined: it opened another page
        except RuntimeError:  # a script cannot be asked while its page is left
            return True

    def press(self, selector: str) -> None:
        """Touch a button, again if the page has just moved it away."""
        is_hit = False
        while not is_hit:
            self.get(f"document.querySelector({json.dumps(selector)}).scrollIntoView({{block: 'center'}})")
            is_hit = self.tap(selector)

    def fill(self, selector: str, text: str) -> None:
        """Type into a field, as soon as it is there. Without the event, the page would restore what it knows."""
        self.wait(f"document.querySelector({json.dumps(selector)}) !== null", f"{selector} is shown")
        self.get(f"(i => (i.value = {json.dumps(text)}, i.dispatchEvent(new Event('input', {{bubbles: true}}))))"
                 f"(document.querySelector({json.dumps(selector)})), 0")

    def key(self, name: str) -> None:
        """Press a key of a keyboard."""
        for kind in ("keyDown", "keyUp"):
            self.command("Input.dispatchKeyEvent", type=kind, key=name, code=name)

    def inaccessible(self) -> Any:
        """What axe-core finds: the rule and an element each. It describes nothing else, which would take as long."""
        if self.get("window.axe === undefined"):
            self.command("Runtime.evaluate", expression=_AXE.read_text(encoding="utf-8"))
        return self.get("axe.run({resultTypes: ['violations'], preload: false})"
                        ".then(found => found.violations.map(one => [one.id, one.nodes[0].html]))")

    def screenshot(self, path: pathlib.Path) -> None:
        """Save what is shown as a PNG file, for people to look at. Only `make test-all` does."""
        if not IS_ALL:
            return
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(base64.b64decode(self.command("Page.captureScreenshot", format="png")["data"]))


class NeedsBrowser(unittest.TestCase):
    """Test cases with a browser. Without one they are skipped, and say so loudly."""

    PAGES = ""  # which pages they test
    browser: ClassVar[Optional[Browser]] = None

    @classmethod
    def setUpClass(cls) -> None:
        super().setUpClass()
        program = find()
        if program is None:
            print("\n" + "!" * 100 + f"\n!!! NOT TESTED: {cls.PAGES}. There is no Chromium here ("
                  + ", ".join(BROWSERS) + ").\n!!! On Debian: apt-get install chromium-headless-shell\n" + "!" * 100,
                  file=sys.stderr, flush=True)
        else:
            cls.browser = Browser(program)
            cls.addClassCleanup(cls.browser.close)

    def setUp(self) -> None:
        if self.browser is None:
            self.skipTest("no Chromium: on Debian apt-get install chromium-headless-shell")
        super().setUp()
