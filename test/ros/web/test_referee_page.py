"""A run by a referee's phone, in a real browser: with a gateway that is killed, and with a network that goes.

`make test-all` leaves screenshots in build/screenshots.
"""

import json
import os
import pathlib
import signal
import uuid
from typing import Any, Dict, Optional

from support.box_case import BoxCase
from support.box_client import Refusal
from support.browser import IS_ALL, Browser, NeedsBrowser, Page, find
from support.connections import process_of
from support.gateway import CORE, URL, ask, wait_served
from support.waiting import wait_until

from roah_rsbb.model.as_json import from_json
from roah_rsbb.model.results import JudgedRun, RunSheet

ROOT = pathlib.Path(__file__).resolve().parents[3]
SHOTS = ROOT / "build" / "screenshots"
ZONE = "Room"
PHONE, LAPTOP = (360, 740), (1280, 800)
TEXT = "document.body.innerText"
HALL, OBJECTS, EMPTY = "Hall", "Objects put away", "Table is empty"
ENTERS, DEVICE = "Enters Annie's room", "Operates the right device"
# What the page did before it sent the first command of a name: whether it was drawn since the touch, and how many
# sounds it made. A later mark may wait for the answer to the one before.
NOTE_SENT = """
window.sent = {};
window.sounds = 0;
let drawn = "";
window.contexts = 0;
const page = document.querySelector("#page"), text = () => page.innerHTML, real = window.fetch;
window.AudioContext = class extends AudioContext {
  constructor() { super(); contexts += 1; }
  createOscillator() { sounds += 1; return super.createOscillator(); }
};
page.addEventListener("click", () => { drawn = text(); }, true);
const note = (name) => {
  sent[name] ??= {drawn: drawn !== text(), said: page.querySelector(".run.ended") !== null, sounds};
};
window.fetch = (path, ...how) => {
  note(path.split("/").pop());
  return real(path, ...how);
};
WebSocket.prototype.send = (send => function (...what) {
  note("stop");
  return send.apply(this, what);
})(WebSocket.prototype.send);
"""
# Each drawing of the whole page reads the items of the zone.
COUNT_DRAWS = """
window.draws = window.ticks = 0;
live.data["page.zone"] = new Proxy(live.data["page.zone"], {get: (zone, name) => {
  draws += name === "items";
  return zone[name];
}});
new MutationObserver(() => { ticks += 1; }).observe(
  document.querySelector(".clock"), {characterData: true, childList: true, subtree: true});
"""


def command(name: str) -> str:
    """The selector of a command's button."""
    return f'button[data-command="{name}"]'


def mark(desc: str) -> str:
    """The selector of the button that marks a scoring item: one more, or yes."""
    return f'[data-item="{desc}"] .mark'


def less(desc: str) -> str:
    """The selector of the button that takes one away: one less, or no."""
    return f'[data-item="{desc}"] .take-back'


class TestRefereePage(NeedsBrowser, BoxCase):
    """The page on a phone."""

    PAGES = "the referee's page"

    def setUp(self) -> None:
        super().setUp()
        wait_served()
        ask(self.box, "revoke")
        self.addCleanup(ask, self.box, "revoke")

    def paired(self, role: str = "referee", person: str = "Anna", language: str = "en", zone: str = "",
               browser: Optional[Browser] = None) -> Page:
        """A phone with the page of this role. `zone`: another one than usual, on a phone beside others."""
        is_alone = bool(zone)
        zone = "" if role == "organiser" else zone or ZONE
        url = ask(self.box, "pair", role=role, zone=zone)["url"].replace("/pair", f"/pair?language={language}")
        page = (browser or self.browser).page(url, *PHONE, is_alone=is_alone)
        if browser is None:
            self._leaving(page)
        page.fill("#person", person)
        page.press("form button")  # a browser that is paired already moves the form down
        if role == "organiser":
            page.wait_address("/box")
            page.open(f"{URL}/referee?language={language}")
        page.wait_address("/referee")
        page.wait("document.querySelector('.run') !== null", "the zone is shown")
        return page

    def tap(self, page: Page, selector: str) -> None:
        """Touch a button as soon as it is there and on; again if the page has just moved."""
        is_hit = False
        while not is_hit:
            page.wait(f"(b => b && !b.matches(':disabled'))(document.querySelector({json.dumps(selector)}))",
                      f"{selector} is on")
            page.wait(f"!document.querySelector({json.dumps(selector)}).dataset.changed", "it has not changed just now")
            page.get(f"document.querySelector({json.dumps(selector)}).scrollIntoView({{block: 'center'}})")
            is_hit = page.tap(selector)

    def press_twice(self, page: Page, name: str, question: str, inside: str = "") -> None:
        """Press a command, and again when it asks. `inside`: the selector of what has it. A script does it: the page
        forgets the first press after 4 s. On a busy machine it may do so before the script comes to the second one,
        which is then the first again."""
        button = f"document.querySelector({json.dumps(f'{inside} {command(name)}')})"
        page.wait(f"(b => b && !b.matches(':disabled'))({button})", f"{name} is on")
        page.get("window.pressed = -Infinity, 0")
        page.wait(f"(b => !b.dataset.changed && (b.textContent.includes({json.dumps(question)})) ? (b.click(), true) : "
                  "(b.dataset.changed || performance.now() - pressed < 5000 "
                  f"|| (pressed = performance.now(), b.click()), false))({button})", f"{name} asks")

    def open_over(self, page: Page) -> Page:
        """Open the list of the runs that are over."""
        page.wait("document.querySelector('.over').open = true", "the runs that are over are shown")
        return page

    def touch_stop(self, page: Page) -> None:
        """Touch STOP as soon as it is on."""
        page.wait(f"document.querySelector({json.dumps(command('stop'))}).ariaDisabled === 'false'", "STOP is on")
        page.touch_at(command("stop"))

    def phase(self, name: str) -> None:
        """Wait until the box is in this phase."""
        self.box.wait_details(ZONE, lambda details: details.phase == name, name)

    def sheet(self, identity: str = "") -> RunSheet:
        """The score sheet of a run."""
        return self.sheet_of(ZONE, identity)

    def sheet_of(self, zone: str, identity: str) -> RunSheet:
        """The score sheet of a run in a zone."""
        return from_json(RunSheet, self.box.ask("sheet", zone=zone, run=identity))

    def values(self) -> Dict[str, int]:
        """The values of the scoring items."""
        return {one.desc: one.value for one in self.sheet().items}

    def shows(self, page: Page, desc: str, value: str) -> None:
        """Wait until an item has this value on the page."""
        selector = f"[data-item={json.dumps(desc)}] .shown"
        page.wait(f"(document.querySelector({json.dumps(selector)}) || {{}}).textContent === {json.dumps(value)}",
                  f"{desc} is {value}")

    def assert_accessible(self, name: str, page: Page) -> None:
        """axe-core finds nothing, and nothing is wider than the phone."""
        found = []

        def is_accessible() -> bool:  # on a busy machine the page may be old for a moment: then its parts are off
            found[:] = page.inaccessible()
            return not found

        wait_until(is_accessible, lambda: f"axe-core finds nothing on {name}, but {found}")
        self.assertLessEqual(page.get("document.scrollingElement.scrollWidth"), page.get("innerWidth"), name)

    def shot(self, name: str, page: Page, is_on_laptop: bool = IS_ALL) -> None:
        """Look at the page, on a phone and on a laptop."""
        page.get("scrollTo(0, 0)")
        self.assert_accessible(name, page)
        page.screenshot(SHOTS / f"web_referee_{name}.png")
        if not is_on_laptop:
            return
        page.resize(*LAPTOP)
        page.screenshot(SHOTS / f"web_referee_{name}_laptop.png")
        self.assert_accessible(name, page)
        page.resize(*PHONE)

    def test_a_whole_run_by_phone(self) -> None:
        robot = self.robot("Delta")
        page = self.paired()
        self.shot("idle", page)
        page.get(f"(() => {{ {NOTE_SENT} }})()")
        self.tap(page, command("connect"))
        self.assertEqual(page.get("contexts"), 1, "a touch allows sounds")
        self.phase("connected")
        page.wait(f"{TEXT}.includes('The run is not started')", "why STOP is off is text")
        self.tap(page, command("start"))
        robot.wait_did("execute HCFGAC")
        self.shows(page, DEVICE, "0")
        self.tap(page, mark(ENTERS))
        self.shows(page, ENTERS, "yes")
        for _ in range(3):
            self.tap(page, mark(DEVICE))
        self.shows(page, DEVICE, "3")
        self.tap(page, command("undo"))
        self.shows(page, DEVICE, "2")
        self.tap(page, less(ENTERS))
        self.shows(page, ENTERS, "no")
        self.tap(page, mark(ENTERS))
        self.shows(page, ENTERS, "yes")
        page.wait("marks.waiting.length === 0", "the marks are confirmed")
        self.assertEqual(self.values()[DEVICE], 2)
        self.shot("running", page, is_on_laptop=True)
        page.get(f"(() => {{ {COUNT_DRAWS} }})()")
        page.wait("ticks >= 2", "the clock ticks")
        self.assertEqual(page.get("draws"), 0, "a tick of the clock draws nothing else")
        page.get("sounds = 0, 0")
        self.touch_stop(page)
        self.phase("ended")
        page.wait(f"{TEXT}.includes('stopped')", "the page shows the end")
        for name in ("connect", "start", "mark"):
            self.assertFalse(page.get(f"sent.{name}.drawn"), f"{name} is sent before the page is drawn")
        self.assertEqual(page.get("[sent.stop.said, sent.stop.sounds]"), [False, 0],
                         "STOP is sent before all else")
        self.assertIn("Anna, Linux", self.sheet().ends[-1].who)
        history = self.sheet().history
        (who,) = {entry.who for entry in history}
        self.assertRegex(who, r"^Anna, Linux [0-9a-f]{8} \(roah_rsbb\)$")
        self.assertNotIn("roah_rsbb", page.get("document.querySelector('.timeline').innerText"))
        self.shot("ended", page)
        identity = self.box.zone_details(ZONE).identity
        self.press_twice(page, "disconnect", "Press again")
        self.phase("idle")
        self.open_over(page)
        page.wait(f"live.data['page.zone'].unsigned[0].identity === {json.dumps(identity)}", "this run is listed first")
        self.tap(page, command("correct"))
        self.tap(page, f".correction {mark(DEVICE)}")
        self.shows(page, DEVICE, "3")
        self.tap(page, f".correction {less(ENTERS)}")
        self.shows(page, ENTERS, "no")
        # The value may come before the answer to the mark, and only that makes it the one that can be undone.
        undo = ".correction button[data-command=undo]"
        page.wait(f"document.querySelector({json.dumps(undo)}).textContent.includes({json.dumps(ENTERS)})"
                  " && marks.waiting.length === 0", "the last mark can be undone")
        self.tap(page, undo)
        self.shows(page, ENTERS, "yes")
        self.assertEqual([one.value for one in self.sheet(identity).items if one.desc == DEVICE], [3])
        self.assertTrue(self.sheet(identity).run.corrected)
        self.shot("correction", page)
        self.tap(page, command("correct"))
        self.captain_signs(page, identity)
        self.tap(page, ".unsigned summary")
        self.publish(page, 300, "provisional · objections until")
        self.box.wait_current()
        state = self.box.document.judging[identity]
        self.assertEqual(state.objections_until_utc_s - state.published_utc_s, 300.0)
        self.publish(page, 0, "the time for objections is over")
        asks = page.note(f"{TEXT}.includes('Press again: Sign off')")
        self.tap(page, f".dock {command('sign_off')}")
        page.wait(asks, "it asks")
        self.assertFalse(self.sheet(identity).run.signed_utc_s)
        self.press_twice(page, "sign_off", "Press again", ".dock")
        wait_until(lambda: self.sheet(identity).run.signed_utc_s, "the sheet is signed off")
        self.assertIn("Anna, Linux", self.sheet(identity).run.signed_by)
        network = ("WebSocket", "Failed to load resource")  # while a gateway is killed
        self.assertEqual([error for error in self.browser.errors if not any(mark in error for mark in network)], [])

    def captain_signs(self, page: Page, identity: str) -> None:
        """The captain reads the sheet on this phone, and signs it with a finger."""
        self.tap(page, command("captain_reads"))
        page.fill(".captain input", "Cleo")
        page.get("document.querySelector('.captain .signature').scrollIntoView({block: 'center'})")
        left, top, width, height = page.box(".captain .signature")
        for kind, parts in (("touchStart", (0.25, 0.2)), ("touchMove", (0.5, 0.8)), ("touchMove", (0.75, 0.2))):
            at = {"x": left + parts[0] * width, "y": top + parts[1] * height}
            page.command("Input.dispatchTouchEvent", type=kind, touchPoints=[at])
        page.lift()
        self.shot("captain", page)
        self.tap(page, command("captain"))
        wait_until(lambda: self.sheet(identity).captain, "the box has the signature")
        (sign,) = self.sheet(identity).captain
        self.assertRegex(sign.drawing, r"^M100 30L200 120L300 30$")
        page.wait(f"{TEXT}.includes('Signed by captain Cleo')", "the page shows it")
        self.tap(page, command("captain_reads"))

    def publish(self, page: Page, seconds: int, shown: str) -> None:
        """Publish a result without judges as provisional, with this time for objections."""
        text = {0: "None", 300: "5 minutes"}[seconds]
        page.wait("(b => b && !b.dataset.changed && (b.click(), true))([...document.querySelectorAll("
                  f"'.objection-time button')].find(one => one.textContent === '{text}'))", "a time is chosen")
        self.press_twice(page, "publish", "Press again")
        page.wait(f"{TEXT}.includes({json.dumps(shown)})", "it is published")

    def running(self, language: str = "en", browser: Optional[Browser] = None) -> Page:
        """A run in progress, and a phone that shows it."""
        robot = self.robot("Delta")
        self.box.connect(ZONE, again=True)
        self.box.start(ZONE)
        robot.wait_did("execute HCFGAC")
        page = self.paired(language=language, browser=browser)
        # At first, the gateway may know a run from before only, and the page says so.
        identity = self.box.zone_details(ZONE).identity
        page.wait(f"live.data['page.zone'].identity === {json.dumps(identity)} && live.silentSince === null",
                  "this run is shown")
        self.shows(page, DEVICE, "0")
        return page

    def test_stop_is_repeated_until_the_box_is_back(self) -> None:
        page = self.running()
        self.shows(page, DEVICE, "0")
        killed = process_of(CORE)
        os.kill(killed, signal.SIGSTOP)  # it may come back only after the page has said all
        try:
            page.wait(f"{TEXT}.includes('NO LINK TO THE BOX')", "the page says that it is alone")
            page.wait("document.querySelector('.dock fieldset').disabled", "no command waits for a link")
            for number in (1, 2):
                self.tap(page, mark(DEVICE))
                self.shows(page, DEVICE, str(number))
            page.wait("document.querySelector('.last').innerText.includes('2 waiting')",
                      "marks wait, and the referee sees it")
            self.tap(page, command("undo"))
            self.shows(page, DEVICE, "1")
            self.touch_stop(page)
            page.wait(f"{TEXT}.includes('NOT DELIVERED')", "the page says that STOP is not confirmed")
            page.screenshot(SHOTS / "web_referee_stopping.png")
        finally:
            os.kill(killed, signal.SIGKILL)
        self.phase("ended")
        self.assertNotEqual(process_of(CORE), killed)
        page.wait(f"!document.body.matches('.old') && {TEXT}.includes('stopped')", "the page is current again")
        page.wait(f"{TEXT}.includes('the robot has stopped')", "the way of STOP")
        self.assertIn("Anna, Linux", self.sheet().ends[-1].who)
        page.wait("marks.waiting.length === 0", "the box has the mark that was not taken back")
        self.assertEqual([(one.value, one.item) for one in self.sheet().history], [(1, DEVICE)])

    def test_fast_touches_count_in_their_order(self) -> None:
        page = self.running()
        page.wait("document.querySelector('.sheets button[data-changed]') === null", "nothing has changed just now")
        page.get("""(() => {
            window.realFetch = fetch;
            window.asked = [];
            window.fetch = (path, how) => new Promise(done => asked.push({path, body: JSON.parse(how.body), done}));
            window.answer = (status, body) => asked.shift().done(new Response(JSON.stringify(body), {
                status, headers: {"Content-Type": "application/json"}}));
        })()""")
        touched = """(async selector => {
            document.querySelector(selector).click();
            await new Promise(requestAnimationFrame);
            return [...document.querySelectorAll(".sheets button[data-changed]")].map(button => button.textContent);
        })(%s)"""
        for selector in (mark(DEVICE), mark(DEVICE), mark(ENTERS)):
            self.assertEqual(page.get(touched % json.dumps(selector)), [], "a mark changes no button")
        page.get(touched % json.dumps(less(ENTERS)))
        for desc, entered, status in ((DEVICE, "1", 200), (DEVICE, "1", 503), (DEVICE, "1", 200), (ENTERS, 1, 409),
                                      (ENTERS, 0, 200)):
            page.wait("asked.length === 1", "one is sent, when the one before is answered")
            self.assertEqual(page.get("asked.map(one => [one.body.desc, one.body.added || one.body.value])"),
                             [[desc, entered]])
            self.assertTrue(page.get("asked[0].body.made <= asked[0].body.now"), "when it was made, and sent")
            page.get(f"answer({status}, {{number: 1, reasons: ['somebody has signed']}}), 0")
        page.wait(f"{TEXT}.includes('somebody has signed')", "the referee reads what was refused")
        page.wait("marks.waiting.length === 0", "all are answered")
        self.assertTrue(page.get(f"{TEXT}.includes('somebody has signed')"), "also when others are accepted")
        self.assert_accessible("refused", page)
        page.screenshot(SHOTS / "web_referee_refused.png")
        self.tap(page, command("close_refused"))
        page.wait(f"!{TEXT}.includes('somebody has signed')", "until it is closed")
        page.get(f"document.querySelector({json.dumps('[data-item=' + json.dumps(DEVICE) + '] .item-name')}).click()")
        page.fill(".options input", "a note on this run")
        page.get("live.data['page.zone'].identity = 'the next run', live.onChange(['page.zone']), 0")
        page.wait("document.querySelector('.options') === null", "a note that was typed is for no other run")

    def test_not_attempted_is_pressed_and_taken_off(self) -> None:
        page = self.running()
        more, button = (f"document.querySelector({json.dumps(f'[data-item={json.dumps(ENTERS)}] {what}')})"
                        for what in (".item-name", ".options button"))
        touched = "(b => b && !b.dataset.changed && (b.click(), true))(%s)"  # a button that changed takes no touch
        page.wait(touched % more, "the options are opened")
        for pressed in ("true", "false"):
            page.wait(touched % button, "it is touched")
            page.wait(f"{button}.getAttribute('aria-pressed') === '{pressed}' && marks.waiting.length === 0",
                      f"the box has it: {pressed}")
        self.assertEqual(page.get("marks.refused.length"), 0)

    def test_a_number_is_typed_below_the_options(self) -> None:
        page = self.running()
        more = f"document.querySelector({json.dumps(f'[data-item={json.dumps(DEVICE)}] .item-name')})"
        page.wait(f"(b => b && !b.dataset.changed && (b.click(), true))({more})", "the options are opened")
        page.fill(".options .entry input", "17")
        self.tap(page, ".options .entry button")
        shown = f"document.querySelector({json.dumps(f'[data-item={json.dumps(DEVICE)}] .shown')})"
        page.wait(f"{shown}.textContent === '17' && marks.waiting.length === 0", "the box has it")
        self.assertEqual(page.get("marks.refused.length"), 0)

    def test_a_mark_that_is_not_on_all_disks_is_not_confirmed_and_keeps_no_other_one(self) -> None:
        page = self.running()
        page.wait("document.querySelector('.sheets button[data-changed]') === null", "nothing has changed just now")
        page.get("""(() => {
            window.asked = [];
            window.fetch = (path, how) => new Promise(done => asked.push({id: JSON.parse(how.body).id, done}));
            window.answer = (id, status, body) => asked.splice(asked.findIndex(one => one.id === id), 1)[0].done(
                new Response(JSON.stringify(body), {status, headers: {"Content-Type": "application/json"}}));
        })()""")
        for number, button in enumerate((mark(ENTERS), less(ENTERS)), 1):
            page.get(f"document.querySelector({json.dumps(button)}).click()")
            page.wait(f"marks.waiting.length === {number}", "it is entered")
        self.assertEqual(page.get("asked.length"), 1, "the second one waits for the first one")
        first, second = page.get("marks.waiting.map(mark => mark.id)")
        is_asked = "asked.some(one => one.id === {!r})".format
        page.get(f"answer({first!r}, 202, {{reasons: ['not confirmed: no standby']}}), 0")
        page.wait(f"{TEXT}.includes('The box has it, but it is not on all disks yet')", "the referee sees it")
        page.wait(is_asked(second), "the next one of the item is sent")
        page.get(f"answer({second!r}, 200, {{number: 2}}), 0")
        page.wait(f"marks.waiting.length === 1 && {is_asked(first)}", "the first one is sent again")
        page.get(f"answer({first!r}, 200, {{number: 1}}), 0")
        page.wait("marks.waiting.length === 0", "both are confirmed")
        self.assertFalse(page.get(f"{TEXT}.includes('NOT CONFIRMED')"))

    def test_two_tabs_of_a_phone(self) -> None:
        first = self.running()
        # It shows the zone of the pairing, and not that of an old address.
        second = self._leaving(self.browser.page(f"{URL}/referee?language=en&zone={HALL}", *PHONE))
        self.shows(second, DEVICE, "0")
        first.get("window.fetch = () => Promise.reject(new TypeError('no network')), 0")
        self.tap(first, mark(DEVICE))
        first.wait(f"{TEXT}.includes('NOT CONFIRMED: ')", "the first tab could not send its mark")
        self.tap(second, mark(ENTERS))
        self.shows(second, ENTERS, "yes")
        second.wait("marks.waiting.length === 0", "the mark of the second tab is confirmed")
        first.reload()
        first.wait_address("/referee")
        self.shows(first, DEVICE, "1")
        first.wait("marks.isRead && marks.waiting.length === 0", "the mark of the first tab is confirmed")
        first.wait("import('/assets/kept.js').then(({kept}) => kept('waiting')).then(all => window.left = all.length) "
                   "&& left === 0", "nothing is left of it")
        self.paired(person="Bert")
        for page in (first, second):
            page.wait("document.querySelector('.links').textContent.includes('Bert · Referee in')",
                      "all tabs belong to who was paired last")
        was_old = first.note(f"{TEXT}.includes('NO LINK')")
        first.get("Date.now = (now => () => now() + 3600e3)(Date.now), 0")
        first.wait(f"{was_old} && !{TEXT}.includes('NO LINK')", "after a sleep, nothing counts that was before")

    def test_marks_without_an_answer_are_shown_and_count_once(self) -> None:
        page = self.running()
        page.get("window.sent = 0, window.realFetch = fetch, window.fetch = (...what) => realFetch(...what).then(() => "
                 "{ sent += 1; throw new TypeError('the answer is lost'); }), 0")
        self.tap(page, mark(DEVICE))
        page.wait(f"{TEXT}.includes('NOT CONFIRMED: ')", "the page says that it is not confirmed")
        self.assert_accessible("not confirmed", page)
        page.screenshot(SHOTS / "web_referee_not_confirmed.png")
        page.wait("sent >= 3", "it is sent again")
        page.get("window.fetch = realFetch, 0")
        page.wait("marks.waiting.length === 0", "the mark is confirmed")
        self.shows(page, DEVICE, "1")
        self.assertEqual(self.values()[DEVICE], 1, "it came several times and counted once")
        self.a_mark_survives_a_killed_gateway_and_a_reload(page)

    def a_mark_survives_a_killed_gateway_and_a_reload(self, page: Page) -> None:
        """The second mark of a run."""
        identity = self.box.zone_details(ZONE).identity
        page.get("window.fetch = () => Promise.reject(new TypeError('no network')), 0")
        self.tap(page, mark(DEVICE))
        page.wait(f"{TEXT}.includes('NOT CONFIRMED: ')", "the page says that it is not confirmed")
        self.kill_core()
        wait_served()
        self.assertEqual(page.get("marks.waiting.length"), 1)
        page.reload()
        page.wait_address("/referee")
        self.shows(page, DEVICE, "2")
        page.wait("marks.waiting.length === 0", "the mark is confirmed")
        self.assertEqual([(one.value, one.item) for one in self.sheet(identity).history], [(1, DEVICE), (2, DEVICE)])

    def test_nothing_acknowledged_is_lost_with_the_core_or_the_browser(self) -> None:
        browser = Browser(find())
        self.addCleanup(browser.close)
        page = self.running(browser=browser)
        identity = self.box.zone_details(ZONE).identity
        self.tap(page, mark(DEVICE))
        page.wait("marks.waiting.length === 0", "the mark is confirmed")
        # The core is killed while marks are on their way: whether they arrived before is not known.
        page.get(f"[1, 2, 3].forEach(() => document.querySelector({json.dumps(mark(DEVICE))}).click())")
        self.kill_core()
        page.wait("marks.waiting.length === 0 && !document.body.classList.contains('old')", "all marks are confirmed")
        self.shows(page, DEVICE, "4")
        self.assertEqual((self.box.zone_details(ZONE).identity, self.values()[DEVICE]), (identity, 4))
        browser.kill()  # with all that it has not written to its disk yet: it is paired again
        ask(self.box, "revoke")
        page = self.paired()
        self.shows(page, DEVICE, "4")
        self.tap(page, mark(DEVICE))
        self.shows(page, DEVICE, "5")
        page.wait("marks.waiting.length === 0", "the mark is confirmed")
        self.touch_stop(page)
        self.phase("ended")
        history = self.sheet(identity).history
        self.assertEqual((sum(entry.value - entry.old for entry in history), self.values()[DEVICE]), (5, 5))

    def post(self, page: Page, name: str, **fields: Any) -> int:
        """The status of a command that the page's scripts send."""
        body = json.dumps({"zone": ZONE, **fields})
        return page.get(f"fetch('/api/v1/commands/{name}', {{method: 'POST', body: {json.dumps(body)}, "
                        "headers: {'Content-Type': 'application/json'}}).then(answer => answer.status)")

    def test_a_judge_gives_no_commands_and_notices_the_end_of_the_pairing(self) -> None:
        self.robot("Delta")
        page = self.paired("judge", "Cora")
        self.assertEqual(page.get(f"document.querySelector({json.dumps(command('connect'))})"), None)
        self.assertEqual(self.post(page, "connect"), 403)
        self.assertEqual(self.post(page, "mark", identity="x", id="x", group="x", desc="x", judge="Dora"), 403)
        self.assert_accessible("judge", page)
        ask(self.box, "revoke")
        page.wait(f"{TEXT}.includes('This device is not paired')", "the page says so")
        self.assert_accessible("not paired", page)
        self.assertEqual(self.post(page, "connect"), 401)

    def judged(self) -> str:
        """A run without a robot in the hall, which two judges score."""
        self.box.command("open_sheet", HALL, again=True)
        self.box.start(HALL)
        identity = self.box.zone_details(HALL).identity
        self.box.command("stop", HALL)
        self.box.command("disconnect", HALL)
        return identity

    def judge(self, person: str, objects: int, rating: str, language: str = "en") -> Page:
        """A judge's phone on which the own sheet is filled in."""
        page = self.paired("judge", person, language, HALL)
        self.shows(page, OBJECTS, "0")
        for number in range(objects):
            self.tap(page, mark(OBJECTS))
            self.shows(page, OBJECTS, str(number + 1))
        self.tap(page, mark(EMPTY))
        page.fill("[data-item=Presentation] input", rating)
        self.tap(page, "[data-item=Presentation] .entry button.main")  # it stands out until the value is set
        page.wait("marks.waiting.length === 0", "the marks are confirmed")
        self.shows(page, "Presentation", rating)
        return page

    def judging(self, identity: str, judge: str = "") -> JudgedRun:
        """What the core shows of the judges."""
        return from_json(JudgedRun, self.box.ask("judges", zone=HALL, run=identity, judge=judge))

    def test_two_judges_who_differ(self) -> None:
        identity = self.judged()
        ann = self.judge("Ann", 2, "7")
        self.assert_accessible("judge", ann)
        ann.get("document.querySelector('.judging').scrollIntoView()")
        ann.screenshot(SHOTS / "web_judge.png")
        ben = self.judge("Ben", 3, "8", "de")
        self.shows(ben, EMPTY, "ja")
        self.assertEqual(self.post(ben, "waive", identity=identity), 403)
        self.press_twice(ann, "submit", "Press again")
        ann.wait(f"{TEXT}.includes('submitted and locked')", "the sheet is locked")
        ben.wait(f"{TEXT}.includes('Ann: hat abgegeben')", "the other judge sees who is missing")
        self.assertEqual(list(self.judging(identity).judged), [], "nobody sees the values yet")
        head = self.open_over(self.paired("referee", "Hugo", zone=HALL))
        head.wait(f"{TEXT}.includes('Ben: is judging')", "the head referee sees who is missing")
        self.assertFalse(head.get(f"{TEXT}.includes('differs')"))
        self.kill_core()
        self.press_twice(ben, "submit", "Noch einmal")
        ben.wait(f"{TEXT}.includes('abgegeben und gesperrt')", "the sheet is locked")
        head.wait(f"{TEXT}.includes('Items to settle: 1')", "the difference is shown")
        self.open_over(head)
        settle = f"[data-item={json.dumps(OBJECTS)}] "
        # While the core is away, the page does not show them.
        given = f"(document.querySelector({json.dumps(settle + '.given')}) || document.body)"
        head.wait(f"{given}.innerText.replace(/\\s+/g, ' ') === 'Ann 2 Ben 3'", "side by side")
        self.shot("judges", head, is_on_laptop=True)
        chosen = f"(document.querySelector({json.dumps(settle + 'input.value')}) || {{}})"
        head.fill(settle + "input.value", "-")
        head.wait(f"{chosen}.value === '-' && document.querySelector({json.dumps(settle + 'form > button')}).disabled",
                  "text that is not a number does not become 0")
        self.tap(head, settle + ".given button:last-child")  # what Ben gave
        head.wait(f"{chosen}.value === '3'", "it is chosen")
        head.fill(settle + "form > label:last-of-type input", "the video shows three")
        button = f"document.querySelector({json.dumps(settle + 'form > button')})"
        # A script presses: while the core is away, the page disables the button and moves it.
        head.wait(f"(b => b && !b.matches(':disabled, [data-changed]') && (b.click(), true))({button})",
                  "it can be settled")
        head.wait(f"{TEXT}.includes('Settled by Hugo')", "it is settled")
        self.kill_core()
        head.wait(f"!{TEXT}.includes('NO LINK') && !document.body.matches('.old')", "the page is current again")
        self.open_over(head).wait(f"{TEXT}.includes('Settled by Hugo')", "it stays settled")
        head.screenshot(SHOTS / "web_judges_settled.png")
        sheet = self.sheet_of(HALL, identity)
        self.assertEqual([(one.value, one.text) for one in sheet.items], [(3, ""), (1, ""), (7, "7.5")])
        self.assertIn("the video shows three", [entry.note for entry in sheet.history])
        with self.assertRaisesRegex(Refusal, "publish the result as provisional first"):
            self.box.act("sign_off", HALL, identity, "Hugo")

    def submit(self, identity: str, judge: str, objects: int) -> None:
        """A judge submits a sheet with this number of objects."""
        for desc, change in ((OBJECTS, {"value": objects}), ("Presentation", {"text": "7"})):
            self.box.act("judge_mark", HALL, identity, judge=judge, id=str(uuid.uuid4()),
                         group="Show" if "text" in change else "Table", desc=desc, **change)
        self.box.act("submit", HALL, identity, judge=judge)

    def give_reason(self, page: Page, form: str, reason: str) -> None:
        """Type a reason into a form, and touch its button."""
        page.fill(f"{form} > label:last-of-type input", reason)
        self.tap(page, f"{form} > button")

    def test_look_again_withdrawal_objection_and_the_final_result(self) -> None:
        identity = self.judged()
        self.submit(identity, "Ann", 2)
        self.submit(identity, "Ben", 3)
        run = f"[data-run={json.dumps(identity)}] "
        head, ben = self.open_over(self.paired("referee", "Hugo", zone=HALL)), self.paired("judge", "Ben", zone=HALL)
        ben.wait(f"{TEXT}.includes('submitted and locked')", "the sheet is locked")
        self.tap(head, run + "details:nth-of-type(1) > summary")
        sheet_of_ann, sheet_of_ben = (f"{run}details:nth-of-type(1) > div:nth-of-type({number}) " for number in (1, 2))
        self.give_reason(head, sheet_of_ben + "[data-form=hand_back]", "count once more")
        ben.wait(f"{TEXT}.includes('asks you to look again: count once more')", "the judge reads why")
        head.wait(f"{TEXT}.includes('Ben: looks again')", "the head referee sees it")
        self.assertEqual(list(self.judging(identity).judged), [], "the values are hidden again")
        self.tap(ben, run + less(OBJECTS))
        ben.wait("marks.waiting.length === 0", "the mark is confirmed")
        self.press_twice(ben, "submit", "Press again")
        head.wait(f"{TEXT}.includes('Ben: has submitted') && !{TEXT}.includes('Items to settle')", "the judges agree")
        self.give_reason(head, sheet_of_ann + "[data-form=withdraw]", "another team's judge")
        head.wait(f"!{TEXT}.includes('Ann:') && {TEXT}.includes('missing: 1 of 2')", "Ann's place is free")
        self.give_reason(head, run + "[data-form=waive]", "nobody else is here")
        head.wait(f"{TEXT}.includes('not waited for: nobody else is here')", "nobody is waited for")
        self.assertEqual([[given.judge for given in one.given] for one in self.judging(identity).judged], [["Ben"]] * 3)
        self.tap(head, run + "details:nth-of-type(2) > summary")
        self.press_twice(head, "publish", "Press again")
        head.wait(f"{TEXT}.includes('provisional · objections until')", "it is published")
        objection = run + "[data-form=object]"
        head.fill(objection + " > label:first-of-type input", "Epsilon")
        head.fill(objection + " > label:last-of-type input", "the cup was away")
        head.get("(form => [1, 2].forEach(() => form.requestSubmit()))"
                 f"(document.querySelector({json.dumps(objection)})), 0")
        head.wait(f"{TEXT}.includes('objections to answer: 1')", "the objection is listed")
        self.assert_accessible("objection", head)
        head.screenshot(SHOTS / "web_judges_objection.png")
        self.give_reason(head, run + "[data-form=reject]", "it was there")
        head.wait(f"{TEXT}.includes('rejected: it was there')", "it is answered")
        (answered,) = self.judging(identity).objections
        self.assertEqual((answered.by, answered.text, answered.upheld, answered.answer),
                         ("Epsilon", "the cup was away", False, "it was there"))
        self.press_twice(head, "sign_off", "Press again")
        head.wait(f"{TEXT}.includes('objections are possible until')", "the page says why it is not final")
        self.box.act("publish", HALL, identity, "Hugo", seconds=0)
        head.wait(f"{TEXT}.includes('the time for objections is over')", "the limit is over")
        self.press_twice(head, "sign_off", "Press again")
        head.wait(f"document.querySelector({json.dumps(run.strip())}) === null", "the result is final")
        signed = self.sheet_of(HALL, identity).run.signed_by
        self.assertIn("Hugo, Linux", signed)

    def test_an_organiser_chooses_the_zone(self) -> None:
        self.kill_core()  # the new one does not know the zones before a device asks for them
        wait_served()
        page = self.paired("organiser", "Olga")
        self.assertIn(ZONE, page.get("document.querySelector('.zones').textContent"))
        self.assert_accessible("organiser", page)
