"""STOP on a referee's phone, in a real browser with real touches: at every size, in every language and state, and with
every other part of the page broken. The box is the test's; test_referee_page.py has the real one.

`make test-all` tries every combination, and leaves screenshots in build/screenshots.
"""

import asyncio
import contextlib
import itertools
import json
import pathlib
import random
from typing import Any, Callable, Dict, Iterator, List, Tuple
from unittest import mock

from support.browser import IS_ALL, Browser, NeedsBrowser, Page, find
from support.fakes.gateway import LONG, URL, FakeGateway
from support.waiting import happened, wait_until

from roah_rsbb.web import device_documents
from roah_rsbb.web.pairing import Grant

SHOTS = pathlib.Path(__file__).resolve().parents[3] / "build" / "screenshots"
SIZES = ((320, 480), (390, 844), (844, 390), (768, 1024))
LANGUAGES = ("en", "de", LONG)
ZONES = (1, 4, 12)
# In `make test` each value of each kind once.
FEW = [((320, 480), LONG, 12), ((390, 844), "de", 1), ((844, 390), "en", 4), ((768, 1024), LONG, 1)]
COMBINATIONS = list(itertools.product(SIZES, LANGUAGES, ZONES)) if IS_ALL else FEW
# Upright and across.
TWO_SIZES = SIZES if IS_ALL else SIZES[:3:2]
TAPS = 1000 if IS_ALL else 50
PHONE = SIZES[1]
STOP, ALL = ".stopbar .stop", ".stopbar .stopall"
IS_ON = f"document.querySelector('{STOP}').ariaDisabled === 'false'"
SAID = "document.querySelector('.stopsaid').textContent"
STILL = "document.querySelector('[data-changed]') === null"
OUTSIDE = "[...document.querySelectorAll('.dock button')].filter(one => (({left, right, top, bottom}) => " \
          "left < 0 || right > innerWidth || top < 0 || bottom > innerHeight)(one.getBoundingClientRect()))" \
          ".map(one => one.textContent)"
# A button is clicked as soon as it may be: in the same moment, because it may change in the next one.
CLICKED = "(button => button && !button.matches(':disabled, [data-changed]') && (button.click(), true))" \
          "(document.querySelector('{}'))"
OPERATION = {"phase": "running",
             "operation": "Ask Dr. Kimble to enter the target area, and then to leave it by the door",
             "choices": ["done", "not done"]}
# States: what the zones are in, what is opened on the page, and whether STOP is possible.
STATES: Dict[str, Tuple[Dict[str, Any], str, bool]] = {
    "no run": ({"phase": "idle"}, "", False),
    "connected": ({"phase": "connected"}, "", False),
    "running": ({"phase": "running"}, "", True),
    "warning": ({"phase": "running", "warning": "No message from the robot for 3 s"}, "", True),
    "manual operation": (OPERATION, "", True),
    "typed answer": ({**OPERATION, "choices": []}, "document.querySelector('.operation input').focus()", True),
    "timeout": ({"phase": "ended", "end_reason": "timeout"}, "", False),
    "over, sheet open": ({"phase": "ended", "end_reason": "stopped"},
                         "document.querySelector('.sheet .item-name').click(), "
                         "document.querySelector('.over').open = true, "
                         "document.querySelector('.sheet').scrollIntoView()", False),
    "more open": ({"phase": "running"},
                  "document.querySelector('.to-more:last-child').click(), scrollTo(0, 9999)", True),
    "zones open": ({"phase": "running"}, "document.querySelector('.others, .who').click()", True),
    "locked": ({"phase": "running"}, "window.dispatchEvent(new Event('wake'))", True),
    "core silent": ({"phase": "running"}, "", True),
}
# What breaks one part of the page each: a script in the page, and what the page then says.
HAS_FAILED = "has failed"
BREAK = ("Object.defineProperty(live.data['page.zone'], '{}', {{get() {{ throw new Error('broken part'); }}}}), "
         "live.onChange([])")
FAULTS = {
    **{f"{part} cannot be drawn": (BREAK.format(field), HAS_FAILED) for part, field in (
        ("the run", "team"), ("what to do", "todo"), ("the commands", "off"), ("the sheet", "items"),
        ("the runs that are over", "unsigned"), ("the page", "judging"))},
    "an item is bad": ("live.data['page.zone'].items = [null], live.onChange([])", HAS_FAILED),
    "a zone is bad": ("live.data['page.zones'] = [null, null], live.onChange([])", HAS_FAILED),
    "the header fails": ("live.data['page.device_words'].role_everywhere = null, live.onChange([])", HAS_FAILED),
    "texts fail": ("live.data['page.device_words'] = new Proxy({}, {get() { throw new Error('broken part'); }}), "
                   "live.onChange([])", HAS_FAILED),
    "no texts": ("live.data['page.device_words'] = null, live.onChange([])", HAS_FAILED),
    "texts that are none": (
        "live.data['page.device_words'] = {stop: 5, stop_way: 'x', not_stopped: null}, live.onChange([])", ""),
    "an update fails": ("live.onChange = () => { throw new Error('broken part'); }, 0", HAS_FAILED),
    "a bad document": ("live.receive = () => { throw new Error('broken part'); }, 0", HAS_FAILED),
    "a timer fails": ("setTimeout(() => { throw new Error('broken part'); }), 0", HAS_FAILED),
    "a promise fails": ("Promise.reject(new Error('broken part')), 0", HAS_FAILED),
    "the marks fail": ("marks.waiting = null, live.onChange([])", HAS_FAILED),
    "sounds fail": ("window.AudioContext = class { constructor() { throw new Error('broken part'); } }, 0", ""),
    "no storage": ("Storage.prototype.setItem = () => { throw new Error('broken part'); }, 0", ""),
    "the page's connection is gone": ("live.close(), live.watch()", ""),
    "the page is empty": ("document.querySelector('#page').remove()", ""),
}
# Everything that moves during a run, in the old and in the new way of the browser to say so.
NOTE_SHIFTS = """(() => {
  window.shifts = [];
  new PerformanceObserver(list => list.getEntries().forEach(one => shifts.push([one.value,
    ...one.sources.map(({node}) => node && `${node.className || node.parentNode?.className}: ${node.textContent}`)])))
    .observe({type: "layout-shift", buffered: false});
})()"""
RECTS = """Object.fromEntries([...document.querySelectorAll(
  ".who, .run, .last, .incidents, .sheet, .mark, .take-back, .dock, .stop, .stopsaid")
  ].filter(node => node.offsetParent || getComputedStyle(node).position === "fixed").map(node => {
    const {left, top, width, height} = node.getBoundingClientRect();
    const item = node.closest("[data-item]");
    const name = node.className.split(" ")[0];
    return [`${name} ${item ? item.dataset.item + node.textContent : ""}`, [left, top, width].join()];
  }))"""


class PhoneCase(NeedsBrowser):
    """A case with a phone and a gateway of the test's box."""

    PAGES = "STOP on the referee's page"

    def gateway(self, zones: int = 1) -> FakeGateway:
        """A gateway, in place of the one before; it ends with the test."""
        self.doCleanups()
        made = FakeGateway(zones)
        self.addCleanup(made.close)
        return made

    def phone(self, gateway: FakeGateway, size: Tuple[int, int] = PHONE, language: str = "en", **how: Any) -> Page:
        """A paired phone that shows the page."""
        page = gateway.phone(self.browser, size, language, **how)
        self.addCleanup(self._close, page)
        return page

    def running(self, zones: int = 1, size: Tuple[int, int] = PHONE) -> Tuple[FakeGateway, Page]:
        """A gateway in whose first zone a run is in progress, and a phone on which STOP is on."""
        gateway = self.gateway(zones)
        gateway.set(phase="running")
        page = self.phone(gateway, size)
        page.wait(IS_ON, "STOP is on")
        return gateway, page

    @staticmethod
    def _close(page: Page) -> None:
        with contextlib.suppress(RuntimeError):  # it is closed already
            page.close()

    def stops(self, gateway: FakeGateway, page: Page, zone: str = "") -> None:
        """A touch where STOP is drawn stops the run."""
        gateway.given.clear()
        page.touch_at(STOP)
        gateway.wait_given("stop", zone or gateway.zones[0].name)


class TestStopInEveryState(PhoneCase):
    """STOP is where it always is, and stops or says why it cannot."""

    def enter(self, gateway: FakeGateway, page: Page, name: str) -> None:
        """Bring the box and the page into a state."""
        of_zones, opening, can_stop = STATES[name]
        # Each state is one of another run: while the STOP of a run is not answered, a second touch repeats nothing.
        run = gateway.zones[0].run + 1
        gateway.set(**{"run": run, "operation": "", "warning": "", "end_reason": "", "not_stopped": [], **of_zones})
        page.wait(f"document.querySelector('.run.{of_zones['phase']}') !== null", name)
        if of_zones["phase"] != "idle":
            page.wait(f"live.data['page.zone'].identity.endsWith(' {run}')", "it is that run")
        page.wait(f"document.querySelector('{STOP}').ariaDisabled === '{json.dumps(not can_stop)}'", "STOP")
        page.wait("(document.querySelector('.now.operation') !== null) === "
                  + json.dumps(bool(of_zones.get("operation"))), "the manual operation")
        if opening:
            page.wait(f"({opening}, true)", name)
        if name == "core silent":
            gateway.do(lambda: setattr(gateway, "is_silent", True))
            page.wait("document.querySelector('.stopsaid.alarm') !== null && document.body.matches('.old')",
                      "it says so")

    def leave(self, gateway: FakeGateway, page: Page) -> None:
        """Close what a state has opened."""
        gateway.do(lambda: setattr(gateway, "is_silent", False))
        page.wait("!document.body.matches('.old')", "the page is current")
        page.get("document.querySelectorAll('details').forEach(one => (one.open = false)), scrollTo(0, 0), "
                 "document.querySelector('.choice button:last-child')?.click(), "
                 "document.querySelector('.drawer:not(.closed) header button')?.click(), "
                 "document.activeElement.blur(), 0")
        page.get("(knob => knob.offsetParent && knob.dispatchEvent(new MouseEvent('click')))"
                 "(document.querySelector('.lock button')), 0")

    def test_stop_stops_or_says_why_not(self) -> None:
        places: Dict[Tuple[int, int], Any] = {}
        for zones, group in itertools.groupby(sorted(COMBINATIONS, key=lambda one: one[2]), key=lambda one: one[2]):
            gateway = self.gateway(zones)
            for size, language, _ in group:
                page = self.phone(gateway, size, language)
                for name, (_, _, can_stop) in STATES.items():
                    with self.subTest(size=size, language=language, zones=zones, state=name):
                        self.enter(gateway, page, name)
                        box = page.box(STOP)
                        self.assertEqual(box, places.setdefault(size, box), "STOP keeps its place")
                        self.assertGreaterEqual(box[3], 64)
                        self.assertGreaterEqual(box[2], size[0] - 32, "the full width")
                        self.assertLessEqual(box[1] + box[3], size[1])
                        self.assertLessEqual(page.get("document.scrollingElement.scrollWidth"), size[0])
                        self.assertEqual(page.get(OUTSIDE), [], "every choice can be seen")
                        shot = f"stop_{size[0]}x{size[1]}_{language}_{zones}_{name.replace(' ', '_')}"
                        page.screenshot(SHOTS / f"{shot}.png")
                        if can_stop:
                            self.stops(gateway, page)
                        else:
                            self.says_why_not(gateway, page)
                        self.assertEqual(page.box(STOP), box, "what STOP says does not move it")
                        self.leave(gateway, page)
                page.close()

    def says_why_not(self, gateway: FakeGateway, page: Page) -> None:
        """STOP is off, and a touch on it has no effect."""
        gateway.given.clear()
        page.wait(f"{SAID}.length > 20 && document.querySelector('{STOP}').ariaDisabled === 'true'", "why it is off")
        page.touch_at(STOP)
        page.wait("document.querySelector('.stopbar.whole') !== null", "all of the reason is shown")
        self.assertEqual(gateway.given, [])

    def test_a_phone_with_a_keyboard_on_its_screen_or_an_enlarged_page(self) -> None:
        gateway, page = self.running()
        page.command("Emulation.setPageScaleFactor", pageScaleFactor=2)
        bar = "document.querySelector('.stopbar').getBoundingClientRect()"
        page.wait("visualViewport.scale === 2 && "
                  f"Math.abs({bar}.bottom - visualViewport.offsetTop - visualViewport.height) < 2", "STOP is in sight")


class TestFaults(PhoneCase):
    """Whatever else of the page or the gateway fails, STOP works, and the page says what has failed."""

    def test_a_part_of_the_page_fails(self) -> None:
        gateway = self.gateway(2)
        for name, (script, says) in FAULTS.items():
            with self.subTest(fault=name):
                gateway.set(phase="running", operation="")
                page = self.phone(gateway)
                is_said = page.note(f"{SAID}.includes({json.dumps(says)})")
                page.get(f"setTimeout(() => {{ {script}; }}), 0")
                gateway.set(warning=f"Something new: {name}")  # and whatever comes then
                page.wait(is_said, "the page says that a part has failed")
                self.stops(gateway, page)
                page.wait(f"{SAID}.includes('robot has stopped') || {json.dumps(name)}.includes('texts that')",
                          "its way")
                page.close()

    def test_a_script_of_the_page_is_lost(self) -> None:
        gateway, page = self.running()
        page.command("Network.setBlockedURLs", urls=["*/preact-htm.js"])
        page.reload(ignoreCache=True)
        page.wait(f"document.querySelector('.run') === null && {IS_ON}",
                  "nothing but STOP is there")
        self.stops(gateway, page)

    def test_a_document_cannot_be_made(self) -> None:
        gateway = self.gateway()
        page = self.phone(gateway)
        for name in ("zone_page", "zones_page", "clock_page"):
            with self.subTest(document=name), mock.patch.object(
                    device_documents, name, side_effect=TypeError("broken")):
                gateway.set(phase="running")
                page.wait(f"{IS_ON}", "STOP is on")
                if name == "zone_page":
                    page.wait("document.body.innerText.includes('cannot show this zone')", "the page says so")
                self.stops(gateway, page)
                page.wait(f"!({IS_ON})", "it is over")

    def test_one_phone_fails_and_the_others_continue(self) -> None:
        gateway = self.gateway()
        real = device_documents.zone_page
        german = self.phone(gateway, language="de")
        english = self.phone(gateway)
        says = device_documents.sheets.phase

        def fails_in_german(*what: Any) -> Any:
            if says("idle") != "NOT CONNECTED":
                raise TypeError("tr() got multiple values for argument 'text'")
            return real(*what)

        with mock.patch.object(device_documents, "zone_page", fails_in_german):
            gateway.set(**OPERATION)
            english.wait("document.querySelector('.operation') !== null", "the English phone shows the operation")
            german.wait("document.body.innerText.includes('Web-Gateway')", "the German one says that it cannot")
            self.stops(gateway, german)
            english.wait("document.querySelector('.run.ended') !== null", "the English phone shows the end")
        german.wait("document.querySelector('.run.ended') !== null", "the German one has missed no more than that")

    def test_a_translation_that_raises_is_english(self) -> None:
        gateway = self.gateway()

        def translate(text: str, _count: int) -> str:
            raise TypeError(f"tr() got multiple values for argument 'text': {text}")

        gateway.do(lambda: gateway.server.store._languages.update(bad=translate))
        gateway.set(**OPERATION)
        page = self.phone(gateway, language="bad")
        page.wait("document.querySelector('.now.operation') !== null", "it is shown")
        self.stops(gateway, page)

    def test_a_document_of_stop_that_cannot_be_made(self) -> None:
        gateway, page = self.running()
        with mock.patch.object(device_documents, "stop_page", side_effect=TypeError("broken")):
            gateway.set(warning="Something new")
            page.wait(f"{SAID}.includes('NO LINK')", "it does not know")
            page.get("window.parsed = 0, JSON.parse = (parse => text => (parsed++, parse(text)))(JSON.parse), 0")
            is_forgotten = page.note(f"!{SAID}.includes('NO LINK')")
            page.wait("parsed > 4", "messages that say nothing new have come")
            self.assertFalse(page.get(is_forgotten), "it still does not know")
            self.stops(gateway, page)


class TestWays(PhoneCase):
    """How far a STOP came, with answers that are late, lost or old."""

    NO_CONNECTION = "window.realSend = window.realSend || WebSocket.prototype.send, WebSocket.prototype.send = () => {}"
    NO_NETWORK = f"{NO_CONNECTION}, window.realFetch = window.realFetch || fetch, " \
                 "window.fetch = () => Promise.reject(new TypeError('no network')), 0"
    NETWORK = "window.fetch = realFetch, WebSocket.prototype.send = realSend, 0"
    LATER = "Date.now = (now => () => now() + 60e3)(Date.now), 0"

    def silent(self, gateway: FakeGateway, page: Page, is_silent: bool = True) -> None:
        """The core falls silent, or is heard again."""
        gateway.do(lambda: setattr(gateway, "is_silent", is_silent))
        page.wait(f"document.body.matches('.old') === {json.dumps(is_silent)}", "the page has noticed")

    def test_a_stop_needs_no_new_connection_and_no_connection_that_is_open(self) -> None:
        """A flood may keep a phone from new ones, and one that is open may be dead."""
        gateway = self.gateway()
        for way in ("window.fetch = () => new Promise(() => {}), 0", f"{self.NO_CONNECTION}, 0"):
            gateway.set(phase="running", run=gateway.zones[0].run + 1)
            page = self.phone(gateway)
            page.wait(f"{IS_ON}", "STOP is on")
            page.get(way)
            self.stops(gateway, page)
            page.wait(f"{SAID}.includes('the robot has stopped')", "its way")
            page.close()

    def test_an_answer_takes_back_what_is_still_on_its_way(self) -> None:
        """A late STOP must not stop a run that the referee has continued."""
        gateway, page = self.running()
        page.get("""window.realFetch = fetch, window.realSend = WebSocket.prototype.send,
            window.realTimeout = setTimeout, window.setTimeout = (act, ms) => ms < 6000 ? realTimeout(act, ms) : 0,
            WebSocket.prototype.send = function (text) { window.arrive = () => (realSend.call(this, text), 0); },
            window.fetch = (path, how) => path.endsWith("/stop") ? new Promise((_, fail) => {
              window.signal = how.signal, signal.onabort = () => fail(signal.reason);
            }) : realFetch(path, how), 0""")
        page.touch_at(STOP)
        page.wait("Boolean(window.signal)", "it is also sent by a request")
        assert not page.get("signal.aborted")
        page.get("arrive()")
        page.wait("signal.aborted", "the request has ended")

    def test_a_stop_outlives_its_page(self) -> None:
        gateway, page = self.running()
        page.get(f"{self.NO_CONNECTION}, 0")
        gateway.given.clear()
        page.touch_at(STOP)
        page.close()
        gateway.wait_given("stop", "Home A")

    def test_a_late_answer_counts_more_than_a_refusal(self) -> None:
        gateway, page = self.running()
        page.get(f"{self.NO_CONNECTION}, 0")
        page.get("""window.asked = [], window.realFetch = fetch,
            window.fetch = (path, ...how) => path.endsWith("/stop") ? new Promise(done => asked.push(done))
              : realFetch(path, ...how),
            window.answer = (index, status) =>
              asked[index](new Response('{"reasons": ["it is over"]}', {status})), 0""")
        page.touch_at(STOP)
        page.wait("asked.length === 2", "no answer for a while, so it is sent again")
        page.get("answer(1, 409), 0")
        page.wait(f"{SAID}.includes('STOP was refused: it is over')", "the second one is refused")
        page.get("answer(0, 200), 0")
        page.wait(f"!{SAID}.includes('refused') && {SAID}.includes('STOP Home A: ')", "the first one stopped the run")
        page.get("window.asked.length = 0")
        page.touch_at(STOP)
        page.wait("asked.length === 2", "no answer for a while, so it is sent again")
        page.get("answer(0, 200), 0")
        page.wait(f"{SAID}.includes('NO ANSWER FROM THE ROBOT')", "the box has it")
        page.get("answer(1, 409), 0")
        page.get("fetch('/api/v1/session').then(answer => answer.text())")
        self.assertIn("NO ANSWER FROM THE ROBOT", page.get(SAID))
        self.assertEqual(page.get("asked.length"), 2, "it is not sent again")

    def test_many_touches_do_not_hold_back_the_stop_of_another_zone(self) -> None:
        gateway, page = self.running(2)
        real, hangs = gateway.server.command, asyncio.Event()

        async def hang(command: Any) -> Any:
            gateway.given.append((command.name, command.zone, command.fields))
            happened()
            await hangs.wait()
            return await real(command)

        gateway.do(lambda: setattr(gateway.server, "command", hang))
        page.get("""window.realFetch = fetch, window.open_ = window.most = 0, window.fetch = (...what) => {
            most = Math.max(most, open_ += 1);
            return realFetch(...what).finally(() => (open_ -= 1));
        }, 0""")
        for _ in range(10):
            page.touch_at(STOP)
        self.assertLess(page.get("most"), 6, "the browser has six connections")
        page.get("strip.show('Home B')")
        self.stops(gateway, page, "Home B")
        gateway.do(hangs.set)
        page.wait(f"{SAID} === 'STOP Home A, Home B: the robot has stopped'", "both have stopped")

    def test_an_old_stop_of_an_unknown_run_stops_no_later_run(self) -> None:
        gateway = self.gateway()
        page = self.phone(gateway)
        for is_reloaded in (False, True):
            with self.subTest(is_reloaded=is_reloaded):
                self.silent(gateway, page)  # a run may begin unnoticed
                page.get(self.NO_NETWORK)
                page.touch_at(STOP)
                page.wait(f"{SAID}.includes('STOP Home A: NOT DELIVERED')", "it is sent again and again")
                if is_reloaded:
                    page.get("(kept => sessionStorage.setItem('roah_rsbb_stops', JSON.stringify(kept.map(one => "
                             "({...one, pressed: one.pressed - 600e3})))))"
                             "(JSON.parse(sessionStorage.getItem('roah_rsbb_stops'))), "
                             "Storage.prototype.setItem = () => {}, 0")  # as if it were closed at once
                    page.reload()
                else:
                    page.get(self.LATER)
                page.wait(f"{SAID}.includes('Home A: STOP WAS NOT DELIVERED')", "it has ended, and the page says so")
                page.get(f"window.realFetch ? ({self.NETWORK}) : 0")
                gateway.set(phase="running")
                self.silent(gateway, page, False)
                page.wait(f"{IS_ON} && !{SAID}.includes('NOT DELIVERED')", "the later run is shown")
                page.get("fetch('/api/v1/session').then(answer => answer.text())")
                self.assertEqual(gateway.given, [])
                self.stops(gateway, page)
                gateway.set(phase="idle")
                page.wait(f"!({IS_ON})", "the run is left")
                gateway.given.clear()

    def test_a_stop_of_an_unknown_run_that_is_pressed_again_counts_again(self) -> None:
        gateway = self.gateway()
        page = self.phone(gateway)
        self.silent(gateway, page)
        page.get(self.NO_NETWORK)
        page.touch_at(STOP)
        page.wait(f"{SAID}.includes('NOT DELIVERED')", "it is sent again and again")
        page.get(self.LATER)
        page.wait(f"{SAID}.includes('STOP WAS NOT DELIVERED')", "it has ended")
        page.touch_at(STOP)
        page.wait(f"{SAID}.includes('STOP Home A: NOT DELIVERED')", "it is sent again and again")
        gateway.set(phase="running")
        page.get(self.NETWORK)
        gateway.wait_given("stop", "Home A")

    def test_what_was_refused_is_shown_until_it_is_read(self) -> None:
        gateway = self.gateway()
        page = self.phone(gateway)
        self.silent(gateway, page)
        page.get(f"{self.NO_CONNECTION}, window.realFetch = fetch, window.fetch = async () => new Response("
                 "'{\"reasons\": [\"there is nothing to stop\"]}', {status: 409}), 0")
        page.touch_at(STOP)
        page.wait(f"{SAID}.includes('refused: there is nothing to stop')", "it is refused")
        page.get(self.NETWORK)
        self.silent(gateway, page, False)
        page.wait(f"!{SAID}.includes('refused')", "it is read")

    def test_a_robot_that_has_stopped_stays_so_without_a_link(self) -> None:
        gateway, page = self.running()
        self.stops(gateway, page)
        page.wait(f"{SAID}.includes('the robot has stopped')", "its way")
        alarm = page.note(f"{SAID}.includes('NO ANSWER FROM THE ROBOT')")
        for is_silent in (True, False):
            self.silent(gateway, page, is_silent)
        page.wait(f"{SAID}.includes('the robot has stopped')", "its way")
        self.assertFalse(page.get(alarm))

    def test_old_data_says_of_no_zone_that_it_needs_nobody(self) -> None:
        gateway = self.gateway(4)
        page = self.phone(gateway)
        for is_silent, said in ((False, "No other zone needs its referee"), (True, "all zones")):
            self.silent(gateway, page, is_silent)
            page.wait(f"document.querySelector('.others').innerText === {json.dumps(said)}", said)

    def test_a_box_that_was_superseded_names_its_successor(self) -> None:
        gateway, page = self.running()
        gateway.do(lambda: setattr(gateway, "successor", "10.0.0.2"))
        page.wait(f"{SAID}.includes('open the pages at 10.0.0.2') && !({IS_ON}) && document.body.matches('.old')", "it")

    def test_the_pairing_ends_while_a_stop_is_sent(self) -> None:
        gateway, page = self.running()
        gateway.do(lambda: setattr(gateway, "answers", False))
        self.stops(gateway, page)
        page.wait(f"{SAID}.includes('NOT DELIVERED')", "it is sent again and again")
        gateway.do(lambda: gateway.server.revoke(""))
        page.wait(f"document.querySelector('{STOP}').hidden", "there is nothing to stop any more")
        page.wait(f"{SAID} === 'STOP was refused: This device is not paired' && "
                  "document.querySelector('.stopsaid').offsetHeight > 0", "how it ended")

    def test_a_phone_is_turned_while_a_stop_is_sent(self) -> None:
        gateway, page = self.running(4)
        gateway.do(lambda: setattr(gateway, "answers", False))
        self.stops(gateway, page)
        for width, height in ((844, 390), (390, 844), (480, 320), (320, 480)):
            page.resize(width, height)
            page.wait(f"innerWidth === {width} && {SAID}.includes('NOT DELIVERED')", "it is turned")
            left, top, wide, high = page.box(STOP)
            self.assertEqual((left, wide), (12, width - 24))
            self.assertGreaterEqual(high, 64)
            self.assertEqual(top + high, height - 8)
            self.stops(gateway, page)


class TestOthersStop(PhoneCase):
    """A robot that did not answer a STOP which this phone did not send."""

    WHYS = "(document.querySelector('.dock-why')?.textContent || '')"
    IS_NEXT = "document.querySelector('button[data-command=disconnect]').matches('.next')"
    WARNED = "R2D2 did not answer STOP. After the disconnect the box does not repeat it: stop by hand first"

    def test_every_line_says_so_and_disconnect_is_not_the_next_command(self) -> None:
        gateway = self.gateway()
        page = self.phone(gateway)
        gateway.set(phase="ended", end_reason="stopped", not_stopped=["R2D2"])
        page.wait(f"{SAID} === 'The run is over, but the robot did not answer STOP: stop it by hand' "
                  "&& document.querySelector('.stopsaid.alarm') !== null", "beside STOP, as an alarm")
        page.wait("document.querySelector('.todo.urgent').innerText.includes('The robot did not answer STOP')", "to do")
        self.assertFalse(page.get(self.IS_NEXT))
        self.assertTrue(page.get(self.WHYS).startswith(f"⚠ Disconnect: {self.WARNED}"))
        self.assertIn(f"⚠ {self.WARNED}", page.get(
            "document.querySelector('[data-command=withdrawn]').closest('li').textContent"))
        page.wait(CLICKED.format("button[data-command=disconnect]"), "once")
        page.wait(CLICKED.format("button[data-command=disconnect]"), "it is allowed to whoever knows it")
        gateway.wait_given("disconnect", "Home A")
        gateway.set(phase="ended", end_reason="stopped", not_stopped=[])
        page.wait(f"document.querySelector('.stopsaid.alarm') === null && {self.IS_NEXT} "
                  f"&& !{self.WHYS}.includes('STOP')", "this robot has stopped")

    def test_a_locked_page_does_not_hide_it(self) -> None:
        gateway, page = self.running(4, SIZES[0])
        page.get("window.dispatchEvent(new Event('wake'))")
        urgent = "document.querySelector('.lock .urgent')"
        page.wait("document.querySelector('.lock:not([hidden])') !== null", "it is locked")
        self.assertEqual(page.get(f"{urgent}.innerText"), "")
        gateway.do(lambda: (setattr(gateway.zone("Hall"), "warning", "The robot has disappeared"),
                            setattr(gateway.zone("Home A"), "warning", "No message from the robot for 3 s")))
        page.wait(f"{urgent}.innerText === '⚠ No message from the robot for 3 s\\n⚠ Hall: The robot has disappeared'",
                  "what needs its referee")
        left, top, width, height = page.box(".lock .urgent")
        self.assertGreater(height, 30)
        self.assertTrue(page.get(f"document.elementFromPoint({left + width / 2}, {top + height / 2}) === {urgent}"))
        gateway.set(warning="")
        page.wait(f"{urgent}.innerText === '' && {urgent}.offsetHeight === 0", "nothing needs it any more")


class TestZoneIsGone(PhoneCase):
    """`reload` has removed the zone that is shown."""

    def choose(self, page: Page, zone: str) -> None:
        """Show another zone."""
        page.wait(STILL, "nothing has changed just now")
        page.wait(CLICKED.format(".zones"), "the list is opened")
        page.wait(CLICKED.format(f".choice [data-zone={zone}]"), "a zone is chosen")
        page.wait(f"live.data['page.zone']?.zone === '{zone}'", "it is shown")

    def test_an_organisers_page_shows_another_zone_and_says_so(self) -> None:
        gateway = self.gateway(4)
        page = self.phone(gateway)
        self.choose(page, "Hall")
        gateway.do(lambda: setattr(gateway.zone("Home B"), "phase", "running"))
        page.wait(STILL, "nothing has changed just now")
        is_other = "document.querySelector('.zones')?.innerText.includes('Home B')"
        page.note(f"{is_other} && (window.first = window.first || "  # the buttons when it is first shown
                  "[...document.querySelectorAll('.dock button, .incidents button')].map("
                  "one => 'changed' in one.dataset), false)")
        gateway.do(lambda: gateway.zones.remove(gateway.zone("Hall")))
        gone = "Hall is not in the schedule. This page shows Home B now"
        page.wait(f"{is_other} && {SAID} === {json.dumps(gone)}", "the running zone is shown")
        self.assertEqual(set(page.get("first")), {True}, "they are new ones, which do nothing yet")
        self.assertIn("Home B", page.get(f"document.querySelector('{STOP}').textContent"))
        self.assertIn("zone=Home+B", page.get("location.search"))
        page.wait(CLICKED.format("summary, .others"), "the page is touched")
        page.wait(f"{SAID} !== {json.dumps(gone)}", "it is read")
        self.stops(gateway, page, "Home B")

    def test_it_hides_no_robot_that_did_not_answer_and_ends_when_the_zone_is_back(self) -> None:
        gateway = self.gateway(4)
        page = self.phone(gateway)
        self.choose(page, "Hall")
        hall = gateway.zone("Hall")
        gateway.do(lambda: gateway.zones.remove(hall))
        page.wait(f"{SAID}.startsWith('Hall is not in the schedule')", "another zone is shown")
        shown = page.get("live.data['page.zone'].zone")
        gateway.do(lambda: gateway.zone(shown).__dict__.update(
            phase="ended", end_reason="stopped", not_stopped=["R2D2"]))
        unanswered = "The run is over, but the robot did not answer STOP: stop it by hand"
        page.wait(f"{SAID}.startsWith({json.dumps(unanswered)}) && {SAID}.includes('Hall is not in the schedule')",
                  "both are said, the robot first")
        gateway.do(lambda: gateway.zones.append(hall))
        page.wait(f"{SAID} === {json.dumps(unanswered)}", "the zone is back")

    def test_a_referee_of_this_zone_reads_what_to_do(self) -> None:
        gateway = self.gateway(2)
        page = self.phone(gateway, zone="Home B")
        gateway.do(lambda: gateway.zones.remove(gateway.zone("Home B")))
        gone = "Home B is not in the schedule. To use this device in another zone, pair it again"
        page.wait(f"{SAID} === {json.dumps(gone)} && document.querySelector('#page .nothing').innerText === "
                  f"{json.dumps(gone)}", "what to do")
        self.assertTrue(page.get(f"document.querySelector('{STOP}').hidden"), "there is nothing to stop")


class TestLeaving(PhoneCase):
    """Back, links and other pages of a paired device during a run."""

    STAYED = f"{SAID} === 'Back does not leave this page while a run is in progress'"
    IS_OVER = "document.querySelector('.run.ended') !== null"

    def stays(self, gateway: FakeGateway, go_back: Callable[[Page], object]) -> Iterator[Page]:
        """A referee's and an organiser's page, on which somebody went back in a run."""
        for page in (self.phone(gateway), self.phone(gateway, zone="")):
            gateway.set(phase="idle")
            page.open(f"{URL}/pair?language=en")
            page.open(f"{URL}/referee?language=en")
            page.wait("document.querySelector('.run.idle') !== null", "the zone is shown")
            gateway.set(phase="running")
            page.wait(IS_ON, "STOP is on")
            for _ in range(2):
                go_back(page)
                page.wait(f"{self.STAYED} && location.pathname === '/referee' && history.state !== null", "it stays")
            yield page

    def test_the_key_of_a_browser_does_not_lead_away_from_a_run(self) -> None:
        program = find(is_shown=True)
        if program is None:
            self.skipTest("no Chromium with a window: on Debian apt-get install chromium")
        from support import real_input  # late: it needs Qt, and a display of its own

        def press_key(page: Page) -> None:
            page.command("Page.bringToFront")
            page.touch(5, 5)  # the key leaves a page that nobody has touched
            wait_until(lambda: real_input.give_focus_to_newest() or page.is_now("document.hasFocus()"),
                       "the window has the focus")
            real_input.send_key("Left", "Alt_L")

        gateway = self.gateway()
        self.addCleanup(setattr, self, "browser", self.browser)
        self.browser = Browser(program, is_shown=True)
        self.addCleanup(self.browser.close)
        for page in self.stays(gateway, press_key):
            self.stops(gateway, page)
            self._close(page)

    def test_back_does_not_lead_away_from_a_run(self) -> None:
        gateway = self.gateway()
        for page in self.stays(gateway, lambda page: page.get("history.back()")):
            page.get("document.querySelector('.links a:last-child').click()")
            page.wait_address("/pair")
            page.wait("document.querySelector('.paired') !== null", "the page for pairing is shown")
            gaps = ("[...document.querySelectorAll('#page a, #page button')].map(one => one.getBoundingClientRect())"
                    ".map((one, number, all) => number && one.top - all[number - 1].bottom).slice(1)")
            self.assertGreaterEqual(min(page.get(gaps)), 8, "no button touches another one")
            page.get("history.back()")
            page.wait_address("/referee")
            page.wait(IS_ON, "STOP is on")
            page.get("history.back()")
            page.wait(self.STAYED, "it stays")
            self.stops(gateway, page)
            page.wait(self.IS_OVER, "the run is over")
            page.get("history.back()")
            page.wait_address("/pair")

    def test_the_browser_asks_before_a_page_with_a_run_is_left(self) -> None:
        gateway = self.gateway()
        page = self.phone(gateway)
        page.touch(5, 5)  # browsers ask nothing of a reader who has not touched the page
        self.browser.stays = True
        self.addCleanup(setattr, self.browser, "stays", False)
        for of_zones, is_asked in (({"phase": "running"}, True), ({"phase": "idle"}, False),
                                   ({"phase": "ended", "not_stopped": ["R2D2"]}, True)):
            with self.subTest(**of_zones):
                gateway.set(**of_zones)
                page.wait(f"document.querySelector('.run.{of_zones['phase']}') !== null", "it is shown")
                asked = self.browser.asked
                page.get("window.isOld = true, setTimeout(() => location.reload()), 0")
                if is_asked:
                    wait_until(lambda before=asked: self.browser.asked > before, "the browser asks")
                    self.assertTrue(page.get("window.isOld"), "it stays")
                else:
                    is_new = "!window.isOld && document.querySelector('.run') !== null"
                    wait_until(lambda new=is_new: page.is_now(new), "it goes")
                    self.assertEqual(self.browser.asked, asked)
                    page.touch(5, 5)

    def test_pairing_leaves_no_page_behind(self) -> None:
        gateway = self.gateway()
        code = gateway.do(lambda: gateway.server.codes.make(gateway.server.now(), Grant("referee", "Home A")))
        page = self.browser.page("about:blank", *PHONE, is_alone=True)
        self.addCleanup(self._close, page)
        page.open(f"{URL}/pair?language=en")
        page.fill("#person", "Anna")
        page.get(f"location.replace('#{code.link}')")  # a link that is opened where /pair is shown
        page.wait(f"document.querySelector('#code').value === '{code.typed}'", "its code is filled in")
        before = page.get("history.length")
        page.press("form button")
        page.wait_address("/referee")
        page.wait("document.querySelector('.run') !== null", "the zone is shown")
        self.assertEqual(page.get("history.length"), before)

    def test_every_page_of_a_paired_device_has_stop_while_a_run_is_in_progress(self) -> None:
        gateway = self.gateway(2)
        for role, zone in (("referee", "Home B"), ("organiser", "")):
            page = self.phone(gateway, zone=zone, role=role)
            for path in ("pair", "displays", "codes", "", "team/Delta", "display"):
                with self.subTest(role=role, path=path):
                    gateway.set(phase="idle")
                    page.open(f"{URL}/{path}?language=de")
                    page.wait("document.querySelector('#page > *') !== null "
                              "&& document.querySelector('.stopbar').hidden",
                              "without a run there is nothing to stop")
                    gateway.set(phase="running", run=gateway.zones[0].run + 1)
                    page.wait(f"{IS_ON} && document.querySelector('.stopall').hidden === "
                              f"{json.dumps(bool(zone))}", "STOP")
                    left, top, width, height = page.box(STOP)
                    self.assertGreaterEqual(height, 64)
                    self.assertEqual((left, width, top + height), (12, PHONE[0] - 24, PHONE[1] - 8))
                    page.screenshot(SHOTS / f"stop_on_{role}_{path.partition('/')[0] or 'index'}.png")
                    self.stops(gateway, page, zone)
                    page.wait(f"{SAID}.includes('hat angehalten')", "its way")
            page.open(f"{URL}/overlay")
            self.assertTrue(page.get("document.querySelector('.stopbar') === null"), "a part of a picture")
            page.close()

    def test_a_device_that_is_not_paired_says_that_it_cannot_stop_and_who_can(self) -> None:
        gateway, page = self.running()
        gateway.do(lambda: gateway.server.revoke(""))
        english = ("This device is not paired, so it cannot stop a robot. A paired device, the referees' table and the "
                   "robot's emergency button can")
        for language, said in (("en", english), ("de", "Not-Aus-Taster")):
            page.open(f"{URL}/referee?zone=Home+A&language={language}")
            wrong = page.note(f"{SAID}.includes('nothing to stop')")
            page.wait(f"{SAID}.includes({json.dumps(said)})", "it cannot stop")
            self.assertFalse(page.get(wrong))
            page.screenshot(SHOTS / f"stop_unpaired_{language}.png")
        page.open(f"{URL}/pair")
        self.assertTrue(page.get("document.querySelector('.stopbar') === null"))

    def test_stop_is_of_the_only_run_as_in_the_panels(self) -> None:
        gateway = self.gateway(4)
        page = self.phone(gateway)
        where = f"document.querySelector('{STOP} .where').textContent"
        page.wait(f"live.data['page.zone']?.zone === 'Home A' && {where} === 'Home A'", "it is shown")
        gateway.do(lambda: setattr(gateway.zone("Hall"), "phase", "running"))
        page.wait(f"{where} === 'Hall' && {IS_ON}", "STOP names the only run")
        gateway.do(lambda: setattr(gateway.zone("Room 4"), "phase", "running"))
        page.wait(f"{where} === 'Home A' && !({IS_ON}) && {SAID}.endsWith("
                  "'Running: Hall, Room 4. Choose one of them, or hold STOP ALL')", "which one is not known")
        gateway.do(lambda: setattr(gateway.zone("Home A"), "phase", "running"))
        page.wait(f"{where} === 'Home A' && {IS_ON}", "the one that is shown")
        gateway.do(lambda: setattr(gateway.zone("Room 4"), "phase", "idle"))
        page.get("(now => (performance.now = () => now))(performance.now()), 0")
        self.stops(gateway, page, "Home A")
        page.wait("live.data['page.zone'].phase === 'ended'", "it is over")
        self.assertEqual(page.get(where), "Home A", "a second press is no STOP of another run")
        page.get("delete performance.now")
        page.wait(f"{where} === 'Hall' && {IS_ON}", "then it is")
        self.stops(gateway, page, "Hall")


class TestReloaded(PhoneCase):
    """What a page must not lose, and must not show, when it is loaded again or shows another part."""

    UNDO = "button[data-command=undo]"

    def test_the_last_mark_can_be_taken_back_after_a_reload(self) -> None:
        gateway, page = self.running()
        for desc in ("Enters", "Bumps"):
            page.wait(CLICKED.format(f"[data-item^={desc}] .mark"), "it is marked")
            page.wait(f"document.querySelector('{self.UNDO}').ariaLabel.includes('{desc}')", "it can be taken back")
        page.reload()
        for desc, given in (("Bumps", "mark"), ("Enters", "take_back")):
            page.wait(f"document.querySelector('{self.UNDO}').ariaLabel.includes('{desc}')", "it still can")
            gateway.given.clear()
            page.wait(CLICKED.format(self.UNDO), "it is taken back")
            gateway.wait_given(given, "Home A")
        page.wait(f"document.querySelector('{self.UNDO}').disabled", "nothing is left")
        page.reload()
        page.wait(f"document.querySelector('{self.UNDO}').disabled", "what was taken back is not offered again")

    def test_parts_that_are_changed_quickly_give_up_no_connection(self) -> None:
        """Browsers let the next connections of such a page wait for seconds."""
        page = self.phone(self.gateway(2))
        page.open(f"{URL}/box?language=en")
        page.wait("document.querySelector('[data-part=runs]') !== null", "its parts are shown")
        page.get("""window.givenUp = 0, WebSocket.prototype.close = (close => function () {
            givenUp += this.readyState === WebSocket.CONNECTING;
            close.call(this);
        })(WebSocket.prototype.close), 0""")
        page.wait(STILL, "nothing has changed just now")
        page.get("['overview', 'schedule', 'robots', 'runs', 'box', 'schedule'].forEach("
                 "part => document.querySelector(`[data-part=${part}]`).click()), 0")
        page.wait("document.querySelector('.part .filters') !== null", "the last one is shown")
        self.assertEqual(page.get("givenUp"), 0)


class TestTouches(PhoneCase):
    """What counts as STOP, and what happens under a finger."""

    def test_a_touch_stops_when_it_begins(self) -> None:
        gateway, page = self.running()
        left, top, width, height = page.box(STOP)
        x, y = left + width / 2, top + height / 2
        page.touch(x, y, lift=False)
        gateway.wait_given("stop", "Home A")
        page.lift()
        page.wait("document.querySelector('.run.ended') !== null", "it is over")
        for how in ("mouse", "key", "palm"):
            with self.subTest(how=how):
                gateway.set(phase="running")
                page.wait(f"{IS_ON}", "STOP is on")
                gateway.given.clear()
                if how == "mouse":
                    page.command("Input.dispatchMouseEvent", type="mousePressed", x=x, y=y, button="left", clickCount=1)
                elif how == "key":
                    page.get(f"document.querySelector('{STOP}').focus()")
                    page.command("Input.dispatchKeyEvent", type="keyDown", key="Enter", code="Enter", text="\r",
                                 windowsVirtualKeyCode=13)
                else:
                    row = page.box(".stoprow")
                    points = [{"x": 40 + 60 * n, "y": row[1] + 10, "id": n} for n in range(3)]
                    page.command("Input.dispatchTouchEvent", type="touchStart", touchPoints=points[:2])
                    self.assertEqual(gateway.given, [])
                    page.command("Input.dispatchTouchEvent", type="touchStart", touchPoints=points)
                gateway.wait_given("stop", "Home A")
                page.wait("document.querySelector('.run.ended') !== null", "it is over")
                self.assertEqual(gateway.count("stop"), 1)
                if how == "mouse":
                    page.command("Input.dispatchMouseEvent", type="mouseReleased", x=x, y=y, button="left",
                                 clickCount=1)
                elif how == "key":
                    page.command("Input.dispatchKeyEvent", type="keyUp", key="Enter", code="Enter")
                else:
                    page.lift()
                self.assertEqual(gateway.count("stop"), 1, "it is given once")
        page.wait("document.querySelector('button[data-command=start]').textContent.includes('Start again')",
                  "what the rules allow after a stop by mistake")

    def test_the_way_of_a_stop(self) -> None:
        gateway = self.gateway()
        gateway.set(phase="running", stops=False)
        page = self.phone(gateway)
        gateway.do(lambda: setattr(gateway, "answers", False))
        box = page.box(STOP)
        said = [page.note(f"{SAID}.includes('sent …')")]
        self.stops(gateway, page)
        page.wait(f"{said[0]} && {SAID}.includes('NOT DELIVERED')", "the box does not answer")
        wait_until(lambda: gateway.count("stop") >= 3, "it keeps trying")
        at_box = page.note(f"{SAID}.includes('the box has it') || {SAID}.includes('NO ANSWER FROM THE ROBOT')")
        gateway.do(lambda: setattr(gateway, "answers", True))
        page.wait(f"{at_box} && {SAID}.includes('NO ANSWER FROM THE ROBOT')", "the robot does not answer")
        gateway.set(not_stopped=[])
        page.wait(f"{SAID}.includes('the robot has stopped')", "it has stopped")
        self.assertEqual(page.box(STOP), box)

    def test_a_second_tap_on_connect_starts_nothing(self) -> None:
        for size in TWO_SIZES:
            with self.subTest(size=size):
                while not self.second_taps(size):
                    pass

    def second_taps(self, size: Tuple[int, int]) -> bool:
        """Whether the taps reached the page within 1.4 s of one another, as the fast ones of a person do: then they
        must have started nothing. On a busy machine they are later."""
        gateway = self.gateway()
        page = self.phone(gateway, size)
        page.get("document.querySelector('button[data-command=connect]').scrollIntoView({block: 'center'})")
        page.wait("document.querySelector('[data-changed], [data-moved]') === null", "all is still")
        left, top, width, height = page.box("button[data-command=connect]")
        page.touch(left + width / 2, top + height / 2)
        gateway.wait_given("connect", "Home A")
        page.wait("document.querySelector('.run.connected') !== null && ((window.tapped = [performance.now()]), "
                  "addEventListener('pointerdown', () => tapped.push(performance.now()), true), true)",
                  "it is connected")
        for _ in range(2):
            page.get("new Promise(done => setTimeout(done, 700))")
            page.touch(left + width / 2, top + height / 2)
        page.get("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")
        page.get("fetch('/api/v1/session').then(answer => answer.text())")  # comes after what the touches sent
        times, given = page.get("tapped"), [given[0] for given in gateway.given]
        page.close()
        is_fast = len(times) == 3 and all(after - before < 1400 for before, after in zip(times, times[1:]))
        if is_fast:
            self.assertEqual(given, ["connect"])
        return is_fast

    def test_nothing_moves_during_a_run(self) -> None:
        for size, language in itertools.product(SIZES, ("en", LONG)) if IS_ALL else zip(TWO_SIZES, (LONG, "en")):
            with self.subTest(size=size, language=language):
                gateway = self.gateway(2)
                self.nothing_moves(gateway, self.phone(gateway, size, language))

    def nothing_moves(self, gateway: FakeGateway, page: Page) -> None:
        """From Connect to the end, without a reload."""
        page.wait(STILL, "nothing has changed just now")
        page.get(NOTE_SHIFTS)
        known: Dict[str, str] = {}

        def look(step: str) -> None:
            page.get("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")
            # What is asked for has the page for itself. After that, the sheet is where it was.
            for name, rect in page.get(RECTS).items() if step != "a manual operation" else ():
                self.assertEqual(rect, known.setdefault(name, rect), f"{name} at {step}")
            self.assertEqual(page.get("shifts"), [], step)

        look("idle")
        for step, of_zones, shows in (
            ("connected", {"phase": "connected"}, ".run.connected"), ("running", {"phase": "running"}, ".run.running"),
            ("warning", {"warning": "No message from the robot for 3 s. " * 9}, ".todo.urgent"),
            ("a manual operation", OPERATION, ".now.operation"),
            ("answered", {"operation": "", "warning": ""}, ".sheets:not(.covered)"),
        ):
            if step == "running":  # the sheet takes the place of what is checked before
                known.clear()
            gateway.set(**of_zones)
            page.wait(f"document.querySelector({json.dumps(shows)}) !== null", step)
            look(step)
        page.get("window.realFetch = fetch, window.fetch = () => Promise.reject(new TypeError('no network')), 0")
        page.wait(CLICKED.format("[data-item^=Operates] .mark"), "a mark")
        page.wait("marks.waiting.length === 1 && marks.waiting[0].isLate", "a mark is not confirmed")
        look("a mark that is not confirmed")
        page.get("window.fetch = realFetch, 0")
        page.wait("marks.waiting.length === 0", "it is confirmed")
        look("a mark")
        self.stops(gateway, page)
        page.wait("document.querySelector('.run.ended') !== null", "it is over")
        look("over")
        gateway.set(phase="running", stops=False)
        page.wait("document.querySelector('.run.running') !== null", "it runs again")
        self.stops(gateway, page)
        page.wait("document.querySelector('.stopsaid.alarm') !== null", "the robot does not stop")
        look("the robot does not stop")
        gateway.do(lambda: setattr(gateway, "is_silent", True))
        page.wait("document.body.matches('.old')", "the core is silent")
        look("the core is silent")

    def test_no_tap_on_a_mark_is_lost(self) -> None:
        gateway, page = self.running()
        chance = random.Random(1)
        page.get("document.querySelector('[data-item^=Operates] .mark').scrollIntoView({block: 'center'})")
        page.wait(STILL, "nothing has changed just now")
        left, top, width, height = page.box("[data-item^=Operates] .mark")
        phase = "running"
        for number in range(TAPS):
            if chance.random() < 0.3:  # just before a touch, or while it is on its way
                phase = {"running": "ended", "ended": "running"}[phase]
                operation = OPERATION["operation"] if phase == "running" and chance.random() < 0.5 else ""
                gateway.set(phase=phase, operation=operation, choices=["done"], run=1)
            page.touch(left + width / 2, top + height / 2)
            if number % 20 == 0:  # the gateway takes 20 a second
                page.wait("marks.waiting.length < 10", "most are answered")
        page.wait("marks.waiting.length === 0", "all are answered")
        self.assertEqual(gateway.count("mark"), TAPS)
        self.assertEqual(page.box("[data-item^=Operates] .mark"), (left, top, width, height))

    def test_a_control_that_means_something_else_ignores_a_touch(self) -> None:
        gateway = self.gateway()
        gateway.set(**OPERATION)
        page = self.phone(gateway)
        page.wait(STILL, "nothing has changed just now")
        page.get("window.hits = [], addEventListener('click', e => hits.push(e.target.dataset.changed || ''), true), "
                 "scrollTo(0, 0)")
        gateway.set(choices=["a new answer", "another one"])
        page.wait("(button => button && (button.click(), true))"
                  "(document.querySelector('.operation .controls button[data-changed]'))", "they show it")
        self.assertEqual(page.get("hits"), ["changed"])
        page.wait(CLICKED.format(".operation .controls button"), "the moment is over")
        gateway.wait_given("operation", "Home A")
        self.assertEqual(gateway.count("operation"), 1)

    def test_a_control_whose_text_changes_but_not_its_meaning_takes_every_touch(self) -> None:
        gateway, page = self.running(4)
        text = "Ask Dr. Kimble to enter"
        page.wait(STILL, "nothing has changed just now")
        shows = f"document.querySelector('{{}}').innerText.includes({json.dumps(text)})"
        gateway.do(lambda: setattr(gateway.zone("Hall"), "operation", text))
        # In one moment: it is touched when the new text is there, and the list is open.
        page.wait(f"{shows.format('.others')} && (document.querySelector('.others').click(), true)", "a touch")
        page.wait("document.querySelector('.choice') !== null", "all zones")
        page.wait(STILL, "they are new, so they take nothing for a moment")
        gateway.do(lambda: setattr(gateway.zone("Hall"), "operation", f"{text}, please"))
        text += ", please"
        shows = f"document.querySelector('{{}}').innerText.includes({json.dumps(text)})"
        hall = ".choice [data-zone=Hall]"
        page.wait(f"{shows.format(hall)} && (document.querySelector('{hall}').click(), true)", "it is chosen")
        page.wait("document.querySelector('.choice') === null && live.data['page.zone'].zone === 'Hall'", "Hall")


class TestStopAll(PhoneCase):
    """STOP ALL of a device for all zones."""

    def hold(self, page: Page) -> None:
        """Hold it until it is sent."""
        left, top, width, height = page.box(ALL)
        held = page.note("document.querySelector('.stopall.held') !== null")
        page.touch(left + width / 2, top + height / 2, lift=False)
        page.wait(f"{held} && document.querySelector('.stopall.held') === null", "it is held long enough")
        page.lift()

    def test_each_running_zone_is_stopped(self) -> None:
        gateway = self.gateway(4)
        page = self.phone(gateway, SIZES[0])
        idle, *running = gateway.zones
        for opening in ("0", "document.querySelector('.others').click()", "window.dispatchEvent(new Event('wake'))",
                        "scrollTo(0, 9999)"):
            with self.subTest(opening=opening):
                gateway.set(phase="running", stops=True)
                gateway.do(lambda: (setattr(idle, "phase", "idle"), setattr(running[0], "stops", False)))
                page.wait(f"document.querySelector('{ALL}').ariaDisabled === 'false'", "it is on")
                page.get(f"{opening}, 0")
                page.wait("document.querySelector('.stopsaid.alarm') === null", "the box is heard again after a sleep")
                gateway.given.clear()
                if opening == "0":
                    page.touch_at(ALL)
                    page.get("new Promise(done => setTimeout(done, 1000))")
                    self.assertEqual(gateway.given, [], "a touch does nothing")
                stop = page.box(STOP)
                self.hold(page)
                for zone in running:
                    gateway.wait_given("stop", zone.name)
                self.assertEqual({given[1] for given in gateway.given}, {zone.name for zone in running})
                page.wait(f"{SAID}.includes('STOP Home B: NO ANSWER FROM THE ROBOT') "
                          f"&& {SAID}.includes('STOP Hall, Room 4: the robot has stopped')", "the way of each")
                page.wait("document.querySelector('.stopsaid').scrollHeight <= document.querySelector('.stopsaid')"
                          ".clientHeight", "nothing of it is cut")
                self.assertEqual(page.box(STOP), stop)
                gateway.set(phase="idle")
                page.wait(f"!{SAID}.includes('NO ANSWER')", "the runs are left")

    def test_a_referee_of_one_zone_has_none(self) -> None:
        gateway = self.gateway(2)
        page = self.phone(gateway, zone="Home B")
        self.assertTrue(page.get(f"document.querySelector('{ALL}').hidden"))
        gateway.set(phase="running")
        page.wait(f"{IS_ON}", "STOP is on")
        self.stops(gateway, page, "Home B")
        self.assertEqual(gateway.count("stop"), 1)

    def test_a_judge_stops_nothing(self) -> None:
        gateway = self.gateway()
        gateway.set(phase="running")
        page = self.phone(gateway, zone="Home A", role="judge")
        page.wait(f"document.querySelector('{STOP}').hidden", "a judge has no STOP")

    def test_the_others_stay_in_sight(self) -> None:
        gateway, page = self.running(4, SIZES[0])
        gateway.do(lambda: setattr(gateway.zone("Hall"), "operation", "Ask Dr. Kimble to enter"))
        page.get("scrollTo(0, 9999)")
        others = "document.querySelector('.others')"
        page.wait(f"{others}.innerText.includes('⚠ Hall: Ask Dr. Kimble to enter')", "what another zone needs")
        left, top, width, height = page.box(".others")
        hit = f"document.elementFromPoint({left + width / 2}, {top + height / 2})"
        self.assertTrue(page.get(f"{others}.contains({hit})"))
        page.wait(STILL, "nothing has changed just now")
        page.touch_at(".others")
        page.wait("document.querySelector('.choice [data-zone=Hall]') !== null", "all zones")
        page.wait(STILL, "nothing has changed just now")
        page.touch_at(".choice [data-zone=Hall]")
        page.wait(f"document.querySelector('{STOP}').textContent.includes('Hall')", "STOP is of this zone")
        self.stops(gateway, page, "Hall")


class TestLock(PhoneCase):
    """Slide to unlock."""

    LOCKED = "document.querySelector('.lock:not([hidden])') !== null"

    def slide(self, page: Page, share: float) -> None:
        """Slide the knob by a share of its way."""
        (left, top, width, height), track = page.box(".lock button"), page.box(".track")
        y, way = top + height / 2, track[2] - width
        at = [{"x": left + width / 2 + way * share * step / 5, "y": y} for step in range(6)]
        page.commands("Input.dispatchTouchEvent", {"type": "touchStart", "touchPoints": at[:1]},
                      *({"type": "touchMove", "touchPoints": [one]} for one in at[1:]),
                      {"type": "touchEnd", "touchPoints": []})

    def test_a_slide_unlocks_at_every_size(self) -> None:
        gateway = self.gateway()
        for size, language in sorted({(size, language) for size, language, _ in COMBINATIONS}):
            with self.subTest(size=size, language=language):
                gateway.set(phase="running")
                page = self.phone(gateway, size, language)
                self.assertFalse(page.get(self.LOCKED))
                page.get("window.dispatchEvent(new Event('wake'))")
                page.wait(self.LOCKED, "it is locked")
                self.assertEqual(page.get(
                    "[...Array(50).keys()].filter(n => !document.elementFromPoint("
                    f"(n % 10 + 0.5) * {size[0] / 10}, (Math.floor(n / 10) + 0.5) * {size[1] / 5})"
                    ".closest('.lock, .stopbar'))"), [], "all is covered")
                for share in (0.0, 0.6):
                    self.slide(page, share)
                    self.assertTrue(page.get(self.LOCKED), "a touch or a short slide")
                self.stops(gateway, page)
                self.assertTrue(page.get(self.LOCKED))
                self.slide(page, 1.0)
                page.wait(f"!({self.LOCKED})", "it is unlocked")
                page.close()

    def test_a_hand_does_not_unlock(self) -> None:
        page = self.phone(self.gateway())
        page.get("window.dispatchEvent(new Event('wake'))")
        page.wait(self.LOCKED, "it is locked")
        (left, top, width, height), track = page.box(".lock button"), page.box(".track")
        y, way = top + height / 2, track[2] - width
        for first, second in ((5, 60), (60, 5)):  # in each order, and with a second contact beside the slider
            for other in (y, y - 80):
                points = [[{"x": left + first + way * step / 5, "y": y, "id": 1},
                           {"x": left + second + way * step / 5, "y": other, "id": 2}] for step in range(6)]
                page.commands(
                    "Input.dispatchTouchEvent", {"type": "touchStart", "touchPoints": points[0][:1]},
                    {"type": "touchStart", "touchPoints": points[0]},
                    *({"type": "touchMove", "touchPoints": both} for both in points[1:]),
                    {"type": "touchEnd", "touchPoints": []})
                self.assertTrue(page.get(self.LOCKED))
        self.slide(page, 1.0)
        page.wait(f"!({self.LOCKED})", "one finger unlocks")

    def test_a_key_unlocks(self) -> None:
        page = self.phone(self.gateway())
        page.get("window.dispatchEvent(new Event('wake'))")
        page.wait(self.LOCKED, "it is locked")
        page.get("document.querySelector('.lock button').focus()")
        page.command("Input.dispatchKeyEvent", type="keyDown", key="Enter", code="Enter", text="\r",
                     windowsVirtualKeyCode=13)
        page.wait(f"!({self.LOCKED})", "it is unlocked")

    def test_a_run_is_not_locked_by_idleness_and_a_lock_in_it_leaves_the_clock(self) -> None:
        gateway, page = self.running()
        later = "[Date, performance].forEach(clock => (clock.now = (now => () => now() + 170e3)" \
                "(clock.now.bind(clock)))), document.querySelector('.lock').className = 'lock', 0"
        looked = "document.querySelector('.lock.clear') !== null"
        for _ in range(2):
            page.get(later)
            page.wait(looked, "the page has looked at how long it lay idle")
            self.assertFalse(page.get(self.LOCKED))
        page.get("window.dispatchEvent(new Event('wake'))")
        page.wait(f"{self.LOCKED} && {looked}", "it slept")
        self.assertEqual(page.get("getComputedStyle(document.querySelector('.lock')).background").split(")")[0],
                         "rgba(0, 0, 0, 0")
        left, top, width, height = page.box(".run .clock")
        self.assertTrue(page.get(f"document.elementFromPoint({left + width / 2}, {top + height / 2}) === "
                                 "document.querySelector('.lock')"), "no text of the lock is above the clock")
        self.slide(page, 1.0)
        page.wait(f"!({self.LOCKED})", "it is unlocked")
        gateway.set(phase="ended")
        page.wait(f"!({looked})", "the run is over")
        self.assertFalse(page.get(self.LOCKED), "it lies idle from now on")
        for _ in range(2):
            page.get(later)
        page.wait(self.LOCKED, "it lay idle")

    def test_a_page_that_lay_idle_or_slept_is_locked(self) -> None:
        page = self.phone(self.gateway())
        page.touch_at(".run")
        page.reload()
        page.wait("document.querySelector('.run') !== null", "the page is back")
        self.assertFalse(page.get(self.LOCKED), "it was touched just now")
        page.get("sessionStorage.setItem('roah_rsbb_touched', Date.now() - 200000)")
        page.reload()
        page.wait(self.LOCKED, "it was thrown away while the phone slept")
        self.slide(page, 1.0)
        page.wait(f"!({self.LOCKED})", "it is unlocked")
        page.get("window.visible = 'hidden', Object.defineProperty(document, 'visibilityState', {get: () => visible})")
        page.get("document.dispatchEvent(new Event('visibilitychange')), 0")
        self.assertFalse(page.get(self.LOCKED))
        page.get("visible = 'visible', document.dispatchEvent(new Event('visibilitychange')), 0")
        page.wait(self.LOCKED, "its phone slept")


class TestPhone(PhoneCase):
    """What the page asks of its phone: it may refuse."""

    SPY = """window.asked = 0, window.isRefused = false, window.held = null, window.felt = [],
        window.visible = "visible",
        Object.defineProperty(document, "visibilityState", {get: () => visible}),
        Object.defineProperty(navigator, "vibrate", {value: (pattern) => felt.push(pattern.join(" "))}),
        Object.defineProperty(navigator, "wakeLock", {value: {request: async () => {
          asked += 1;
          if (isRefused) throw new DOMException("low battery", "NotAllowedError");
          held = new EventTarget();
          held.release = () => (lock => (window.held = null, lock.dispatchEvent(new Event("release"))))(held);
          return held;
        }}}), 0"""
    SHOW = "visible = '{0}', '{0}' === 'hidden' && held?.release(), " \
           "document.dispatchEvent(new Event('visibilitychange')), 0"
    # Before its scripts: how the browser keeps nothing.
    KEEPS_NOTHING = {
        "refused": "IDBFactory.prototype.open = () => { throw new DOMException('private', 'SecurityError'); }",
        "failing": "IDBFactory.prototype.open = () => { const asked = {error: new DOMException('', 'UnknownError')}; "
                   "setTimeout(() => asked.onerror()); return asked; }",
        "full": "IDBObjectStore.prototype.put = () => { throw new DOMException('', 'QuotaExceededError'); }",
    }

    def test_the_screen_stays_on_in_a_run(self) -> None:
        gateway = self.gateway()
        page = self.phone(gateway)
        page.get(self.SPY)
        for what, phase, script, is_held, asked in (
                ("a run begins", "running", "0", True, 1),
                ("the page is hidden", "", self.SHOW.format("hidden"), False, 1),
                ("it is seen again", "", self.SHOW.format("visible"), True, 2),
                ("the run ends", "ended", "0", False, 2),
                ("it is hidden and seen without a run", "",
                 f"{self.SHOW.format('hidden')}, {self.SHOW.format('visible')}", False, 2),
                # Now each change asks again.
                ("the battery is low", "running", "isRefused = true", False, None),
                ("it is loaded", "", "isRefused = false", True, None)):
            with self.subTest(what):
                page.get(f"{script}, 0")
                if phase:
                    gateway.set(phase=phase)
                if asked is not None:
                    page.wait(f"Boolean(held) === {json.dumps(is_held)}", what)
                gateway.set(warning=what)
                page.wait(f"JSON.stringify(live.data['page.zone']).includes({json.dumps(what)})", "all is drawn again")
                page.wait(f"Boolean(held) === {json.dumps(is_held)}", what)
                self.assertIn(asked, (None, page.get("asked")))
        gateway.close()
        page.wait("document.body.matches('.old')", "there is no link any more")
        for state, is_held in (("hidden", False), ("visible", True)):
            page.get(self.SHOW.format(state))
            page.wait(f"Boolean(held) === {json.dumps(is_held)}", state)

    def test_a_phone_shakes_at_start_stop_and_refusal(self) -> None:
        gateway = self.gateway()
        gateway.set(phase="connected")
        page = self.phone(gateway)
        page.get(self.SPY)
        page.touch(5, 5)  # browsers let no page do it that nobody has touched
        start, stop, end, refusal = "300", "150", "600 150 600", "80 80 80"
        page.get("window.realFetch = fetch, "
                 "window.fetch = async () => new Response('{\"reasons\": [\"not now\"]}', {status: 409}), 0")
        page.wait(CLICKED.format("button[data-command=start]"), "start")
        page.wait(f"felt.includes('{refusal}') && document.body.innerText.includes('not now')", "a refusal is felt")
        page.get("window.fetch = realFetch, 0")
        page.wait(CLICKED.format("button[data-command=start]"), "start")
        page.wait(f"felt.includes('{start}')", "a start is felt")
        page.wait(IS_ON, "STOP is on")
        self.stops(gateway, page)
        page.wait(f"felt.includes('{stop}') && felt.includes('{end}')", "a stop is felt, and the end of the run")
        self.assertEqual(page.get("felt"), [refusal, start, stop, end])

    def test_marks_count_where_the_browser_keeps_nothing(self) -> None:
        gateway = self.gateway()
        gateway.set(phase="running")
        for how, script in self.KEEPS_NOTHING.items():
            with self.subTest(how):
                page = self.phone(gateway)
                page.command("Page.addScriptToEvaluateOnNewDocument", source=f"{script};")
                page.reload()
                page.wait(f"{IS_ON} && marks.isRead", "it is loaded")
                page.get("window.realFetch = fetch, window.fetch = () => Promise.reject(new TypeError('away')), 0")
                gateway.given.clear()
                page.wait(CLICKED.format("[data-item^=Operates] .mark"), "it is marked")
                page.wait(f"{SAID}.includes('This browser keeps nothing')", "the page says that it must stay open")
                page.get("window.fetch = realFetch, 0")
                gateway.wait_given("mark", "Home A")
                page.wait("marks.waiting.length === 0", "it counted")
                page.close()


class TestLooks(PhoneCase):
    """Colours and sizes."""

    def test_large_texts(self) -> None:
        """Some people's phones show texts twice as large."""
        gateway = self.gateway(4)
        for size in (*SIZES, (480, 320)):
            with self.subTest(size=size):
                gateway.set(phase="running")
                page = self.phone(gateway, size, "de")
                page.get("document.documentElement.style.fontSize = '32px', 0")
                page.wait(f"{IS_ON}", "STOP is on")
                self.assertEqual(page.get("[innerWidth, innerHeight]"), list(size), "nothing is wider than the screen")
                left, top, width, height = page.box(STOP)
                self.assertGreaterEqual(height, 64)
                self.assertGreaterEqual(width, size[0] - 48)
                self.assertLessEqual(top + height, size[1])
                self.assertLessEqual(page.box(".stopbar")[3], 0.55 * size[1], "the page has space")
                page.get("window.dispatchEvent(new Event('wake'))")
                page.wait(TestLock.LOCKED, "it is locked")
                self.assertGreaterEqual(page.box(".lock button")[3], 40)
                self.stops(gateway, page)
                TestLock.slide(self, page, 1.0)
                page.wait(f"!({TestLock.LOCKED})", "it is unlocked")
                page.screenshot(SHOTS / f"stop_large_texts_{size[0]}x{size[1]}.png")
                page.close()

    def test_the_commands_are_in_sight_on_a_small_phone(self) -> None:
        gateway = self.gateway()
        for language in LANGUAGES:
            page = self.phone(gateway, SIZES[0], language)
            left, top, width, height = page.box(".dock")
            self.assertLessEqual(top + height, page.box(".stopbar")[1])
            page.close()

    def test_red_stays_where_a_reader_chooses_the_colours(self) -> None:
        gateway, page = self.running()
        colours = f"(style => [style.color, style.backgroundColor])(getComputedStyle(document.querySelector('{STOP}')))"
        before = page.get(colours)
        page.command("Emulation.setEmulatedMedia", features=[{"name": "forced-colors", "value": "active"}])
        self.assertTrue(page.get("matchMedia('(forced-colors: active)').matches"))
        self.assertEqual(page.get(colours), before)

    def test_red_is_of_stop_alone_and_texts_are_legible(self) -> None:
        gateway = self.gateway(4)
        page = self.phone(gateway)
        for of_zones in (STATES["warning"][0], OPERATION, {"phase": "ended"}):
            gateway.set(**{"operation": "", **of_zones})
            page.wait(f"document.querySelector('.run.{of_zones['phase']}') !== null", "it is shown")
            page.wait(STILL, "nothing has changed just now")
            self.assertEqual(page.get("""[...document.querySelectorAll("body *")].filter(node => {
                const style = getComputedStyle(node);
                const isRed = ["color", "backgroundColor", "borderTopColor", "backgroundImage"].some(name =>
                  [...style[name].matchAll(/rgba?\\((\\d+), (\\d+), (\\d+)(?:, ([\\d.]+))?/g)].some(
                    ([, r, g, b, a]) => a !== "0" && r > 80 && g < r / 2 && b < r / 2));
                return isRed && !node.closest(".stopbar .stop, .stopbar .stopall");
              }).map(node => node.outerHTML)"""), [])
            self.assertEqual(page.get("""[...document.querySelectorAll("body *")].filter(node =>
                [...node.childNodes].some(child => child.nodeType === 3 && child.data.trim())
                && parseFloat(getComputedStyle(node).fontSize) < 14 && node.offsetParent)
                .map(node => node.outerHTML)"""), [])
            self.assertEqual(self._inaccessible(page), [])
        gateway.set(phase="running")
        page.wait(f"{IS_ON}", "STOP is on")
        colours = page.get("(style => [style.color, style.backgroundColor])"
                           f"(getComputedStyle(document.querySelector('{STOP}')))")
        self.assertGreaterEqual(contrast(*colours), 7.0)

    @staticmethod
    def _inaccessible(page: Page) -> Any:
        """What axe finds while the page is current. In an old one, all commands are off, and axe takes a list among
        them, which can be reached, for one that cannot."""
        page.get("window.wasOld = false, new MutationObserver(() => { wasOld ||= document.body.matches('.old'); "
                 "}).observe(document.body, {attributes: true}), 0")
        while True:
            page.wait("!document.body.matches('.old')", "the page is current")
            page.get("wasOld = false")
            found = page.inaccessible()
            if not page.get("wasOld"):
                return found


def contrast(*colours: str) -> float:
    """The contrast of two colours as the browser writes them (WCAG 2)."""
    light: List[float] = []
    for colour in colours:
        parts = [int(part) / 255 for part in colour[colour.index("(") + 1:-1].split(",")[:3]]
        linear = [part / 12.92 if part <= 0.03928 else ((part + 0.055) / 1.055) ** 2.4 for part in parts]
        light.append(0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2])
    return (max(light) + 0.05) / (min(light) + 0.05)
