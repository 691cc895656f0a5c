"""The web pages in a real browser, which the core serves; it is killed in the middle of a run.

`make test-all` leaves screenshots in build/screenshots.
"""

import os
import pathlib
import signal

from support.box_case import BoxCase
from support.box_client import Refusal
from support.browser import NeedsBrowser, Page
from support.connections import kill, process_of
from support.gateway import CORE, URL, answer, ask, wait_served
from support.waiting import wait_until

from roah_rsbb.web.server import PAGES

ROOT = pathlib.Path(__file__).resolve().parents[3]
SHOTS = ROOT / "build" / "screenshots"
ZONE = "Room"
# Width and height in CSS pixels.
PHONE, TABLET, LAPTOP, SCREEN = (360, 740), (1180, 820), (1366, 768), (1920, 1080)
TEXT = "document.body.innerText"
BIG = "(document.querySelector('.big') || {}).textContent"
COUNTS = f"/^[0-9]+:[0-9][0-9]$/.test({BIG})"


class TestData(BoxCase):
    """What programs read, and the core's death."""

    def setUp(self) -> None:
        super().setUp()
        wait_served()

    def test_where_nothing_ends_the_box_the_remedy_is_named(self) -> None:
        """The box of this test has no node that ends its launch."""
        with self.assertRaisesRegex(Refusal, r"No launch file started this box \(.*unavailable.*\): .* with Ctrl-C"):
            self.box.ask("exit")

    def test_the_pages_of_a_core_that_replaces_a_killed_one(self) -> None:
        robot = self.robot("Delta")
        self.box.connect(ZONE)
        self.box.start(ZONE)
        robot.wait_did("execute HCFGAC")
        wait_until(lambda: answer("state")["data"]["runs"][0]["phase"] == "running", "the run is public")
        ends = answer("state")["data"]["runs"][0]["ends"]
        killed = process_of(CORE)
        self.kill_core()
        wait_served()
        self.assertNotEqual(process_of(CORE), killed)
        run = answer("state")["data"]["runs"][0]
        self.assertEqual((run["phase"], run["team"]), ("running", "Delta"))
        self.assertAlmostEqual(run["ends"], ends, delta=0.1)
        self.assertEqual(self.box.zone_details(ZONE).phase, "running")


class TestPages(NeedsBrowser, BoxCase):
    """The pages in a browser."""

    PAGES = "the pages of the gateway"

    def open(self, path: str, width: int, height: int) -> Page:
        """A page of the gateway."""
        return self._leaving(self.browser.page(f"{URL}{path}", width, height))

    def test_a_run_on_all_pages(self) -> None:
        robot = self.robot("Delta")
        display, phone = self.open("/display", *SCREEN), self.open("/display?language=de", *PHONE)
        overlay, team = self.open(f"/overlay?zone={ZONE}", *SCREEN), self.open("/team/Delta", *PHONE)
        explained = self.open("/display?show=run&layout=list", *SCREEN)
        pages = {"explained": explained, "display": display, "phone": phone, "overlay": overlay, "team": team,
                 "index": self.open("/", *PHONE), "tablet": self.open("/display?layout=board", *TABLET)}
        display.wait(f"{TEXT}.includes('Nothing is running at the moment')", "the display says that nothing runs")
        self.box.connect(ZONE)
        self.box.start(ZONE)
        robot.wait_did("execute HCFGAC")
        for page, word in ((display, "running"), (phone, "läuft"), (overlay, "running"), (team, "running")):
            page.wait(f"{TEXT}.includes('Delta') && {TEXT}.includes('{word}')", "the run is shown")
        explained.wait(f"{TEXT}.includes('The robot carries out its task') && {TEXT}.includes('Granny Annie calls')",
                       "the run is explained")
        self.the_clock_is_the_box_s(display)
        for name, page in pages.items():
            self.assert_accessible(name, page)
            page.screenshot(SHOTS / f"web_{name}.png")
        self.assertEqual(overlay.get("getComputedStyle(document.body).backgroundColor"), "rgba(0, 0, 0, 0)")
        linked = pages["index"].get("[...document.querySelectorAll('a')].map(link => link.pathname)")
        self.assertEqual([name for name in PAGES if f"/{name}" not in linked], [], "the first page lists all")
        for page in (phone, team):
            self.assertEqual(page.get("document.scrollingElement.scrollWidth"), PHONE[0], "nothing is too wide")
        self.nothing_of_the_board_is_cut(display)
        self.a_silent_box_is_reported(display, overlay)
        self.a_new_connection_has_time_for_its_first_message(display)
        self.a_killed_core_is_reported(display)
        self.box.command("stop", ZONE)
        display.wait(f"{TEXT}.includes('stopped')", "the end and its reason are shown")
        self.assertEqual([error for error in self.browser.errors if "WebSocket" not in error
                          and "ERR_CONNECTION" not in error], [], "a gateway that is gone is no error of the pages")

    def test_a_page_of_which_a_part_was_lost_is_loaded_again(self) -> None:
        page = self.open("/", *PHONE)
        page.wait(f"{TEXT}.includes('Public display')", "it is shown")
        page.command("Network.setBlockedURLs", urls=["*/assets/live.js"])
        page.reload()
        wait_until(lambda: page.is_now("document.readyState === 'complete' && window.live === undefined"),
                   "a part of it is lost")
        page.command("Network.setBlockedURLs", urls=[])
        wait_until(lambda: page.is_now(f"{TEXT}.includes('Public display')"), "it is loaded again")
        page.get("fetch('/').then(answer => answer.text()).then(text => "
                 "document.body.append("  # not in `#page`, which is drawn again
                 "new DOMParser().parseFromString(text, 'text/html').querySelector('.first'))), 0")
        late = "document.querySelector('.first .late')"
        said = f"getComputedStyle({late})"
        page.wait(f"{late}.textContent.includes('does not answer yet')",
                  "a page that hears nothing says why")
        self.assertEqual(page.get(f"{said}.visibility"), "hidden", "but not at once")
        page.wait(f"{said}.visibility === 'visible'", "after some seconds")
        page.screenshot(SHOTS / "web_no_answer.png")

    def test_the_organiser_sets_what_a_display_shows(self) -> None:
        display = self.open("/display?name=Hall&show=schedule", *LAPTOP)
        display.wait(f"{TEXT}.includes('Next')", "it shows what its address says")
        self.pair_an_organiser()
        organiser = self.open("/displays", *LAPTOP)
        row = "document.querySelector('[data-name=Hall]')"
        organiser.wait(f"{row} !== null && {row}.innerText.includes('1366 × 768')", "the display is listed")
        self.assert_accessible("displays", organiser)
        organiser.screenshot(SHOTS / "web_displays.png")
        self.a_list_that_comes_again_does_not_disturb(organiser, row)
        self.choose(organiser, row, "show", "standings")
        self.choose(organiser, row, "language", "de")
        wanted = f"{TEXT}.includes('Noch keine Rangliste ist öffentlich')"
        display.wait(wanted, "it shows what is set, in the language that is set")
        self.assert_accessible("display that is set", display)
        was_silent = display.note("live.silentSince !== null")
        self.kill_core()
        wait_served()
        display.wait(was_silent, "the gateway is gone")
        display.wait(f"live.silentSince === null && {wanted}", "a new gateway knows the setting")
        again = self.open("/display?name=Hall&show=schedule", *PHONE)
        again.wait(wanted, "so does a browser that was started again")
        organiser.wait(f"{row}.querySelector('[data-command=take_back]') !== null", "it can be taken back")
        organiser.get(f"{row}.querySelector('[data-command=take_back]').click()")
        display.wait(f"{TEXT}.includes('Next')", "the address counts again")

    def a_list_that_comes_again_does_not_disturb(self, page: Page, row: str) -> None:
        """Nor does it show what is not set, or hide why."""
        field, shows = f"{row}.querySelector('[id^=name-]')", f"{row}.querySelector('[id^=show-]')"
        page.get("window.realFetch = fetch, window.lists = 0, window.fetch = async (path, how) => { "
                 "if (how.method === 'POST') return new Response(JSON.stringify({reasons: ['the disk is full']}), "
                 "{status: 500, headers: {'Content-Type': 'application/json'}}); "
                 "const answer = await realFetch(path, how); lists += 1; return answer; }, 0")
        self.choose(page, row, "show", "results")
        page.wait(f"{TEXT}.includes('the disk is full') && {shows}.selectedIndex === 0", "it is not set")
        page.get(f"{field}.value = 'Hal', {field}.dispatchEvent(new Event('input', {{bubbles: true}})), lists = 0, 0")
        page.wait("lists >= 2", "the list has come again")
        self.assertEqual(page.get(f"{field}.value"), "Hal")
        self.assertTrue(page.get(f"{TEXT}.includes('the disk is full')"))
        page.get(f"{field}.value = '', {field}.dispatchEvent(new Event('input', {{bubbles: true}})), "
                 "window.fetch = realFetch, 0")

    def pair_an_organiser(self) -> None:
        """Pair the browser."""
        code = ask(self.box, "pair", role="organiser")["code"]
        page = self.open(f"/pair#{code}", *LAPTOP)
        page.wait("document.querySelector('#person') !== null", "the form is shown")
        page.fill("#person", "Olga")
        page.press("form button")
        page.wait_address("/box")

    def test_a_team_sees_its_robot_with_its_code(self) -> None:
        self.robot("Delta")
        self.pair_an_organiser()
        codes = self.open("/codes", *PHONE)
        line = "document.querySelector('[data-team=Delta] code')"
        codes.wait(f"{line} !== null", "the codes are listed")
        self.assert_accessible("codes", codes)
        codes.screenshot(SHOTS / "web_codes.png")
        code = codes.get(f"{line}.textContent")
        codes.get("fetch('/api/v1/session', {method: 'DELETE'}).then(answer => answer.status)")
        team = self.open("/team/Delta", *PHONE)
        team.wait("document.querySelector('#code') !== null", "the page asks for the code")
        self.assertNotIn("The box hears", team.get(TEXT))
        self.assert_accessible("team that has no code", team)
        team.fill("#code", code)
        team.press("form button")
        team.wait(f"{TEXT}.includes('The box hears') && {TEXT}.includes('Its clock is')", "the robot's state is shown")
        self.assert_accessible("team that has its code", team)
        team.screenshot(SHOTS / "web_team_code.png")

    def choose(self, page: Page, row: str, what: str, value: str) -> None:
        """Choose in a list of the organiser's page."""
        found = f"{row}.querySelector('[id^={what}-]')"
        page.get(f"{found}.value = '{value}', {found}.dispatchEvent(new Event('change', {{bubbles: true}}))")

    def the_clock_is_the_box_s(self, page: Page) -> None:
        """The page counts by the box's clock, although the clock of its own computer is wrong."""
        page.get("Date.now = () => 0")
        before = answer("state")["clock"]
        shown = page.get("live.now()")
        self.assertAlmostEqual(shown, before, delta=600.0)
        page.wait(COUNTS, "the countdown is shown")

    def assert_accessible(self, name: str, page: Page) -> None:
        """axe-core finds nothing."""
        self.assertEqual(page.inaccessible(), [], name)

    def nothing_of_the_board_is_cut(self, page: Page) -> None:
        """Everything is on the screen, which cannot be scrolled."""
        self.assertEqual(page.get("[document.scrollingElement.scrollWidth, document.scrollingElement.scrollHeight]"),
                         list(SCREEN))
        self.assertEqual(page.get(
            "[...document.querySelectorAll('#page > *, .zone > *, .row > *')].filter(one => !one.closest('.copy'))"
            ".filter(one => (b => b.right > innerWidth + 1 || b.bottom > innerHeight + 1)(one.getBoundingClientRect()))"
            ".map(one => one.outerHTML)"), [])
        # The title is long.
        self.assertEqual(page.get(
            "[...document.querySelectorAll('.top > *')].filter(one => one.getBoundingClientRect().top < 0"
            " || one.scrollHeight > one.clientHeight + 1).map(one => one.outerHTML)"), [])

    def a_silent_box_is_reported(self, *pages: Page) -> None:
        """The core hangs."""
        core = process_of(CORE)
        self.assertNotEqual(core, 0)
        os.kill(core, signal.SIGSTOP)
        try:
            for page in pages:
                page.wait(f"{TEXT}.includes('No signal since')", "the page says that the box is silent")
            shown = pages[0].get(BIG)
            self.assert_accessible("silent", pages[0])
            pages[0].screenshot(SHOTS / "web_silent.png")
            self.assertEqual(pages[0].get(BIG), shown, "the countdown is stopped")
        finally:
            os.kill(core, signal.SIGCONT)
        for page in pages:
            page.wait(f"!{TEXT}.includes('No signal since')", "the page is current again")

    def a_new_connection_has_time_for_its_first_message(self, page: Page) -> None:
        """Even after a silence: on a slow network, that message comes late."""
        self.assertEqual(page.get("""(() => {
            const Real = WebSocket, made = [];
            window.WebSocket = class {
                static CONNECTING = 0;
                static OPEN = 1;
                constructor() { made.push(this); this.readyState = 1; }
                close() { this.isClosed = true; }
            };
            const slow = new live.constructor("events", {}, () => {}, 1e6);
            made[0].onopen && made[0].onopen();
            slow.watch();
            const wasClosed = Boolean(made[0].isClosed);
            slow.startedAt = -Infinity;
            made[0].readyState = 0;  // it is still not made
            slow.watch();
            const isGivenUp = Boolean(made[0].isClosed);
            slow.close();
            window.WebSocket = Real;
            return [made.length, wasClosed, isGivenUp];
        })()"""), [1, False, True])

    def a_killed_core_is_reported(self, page: Page) -> None:
        """The page says so, and continues by itself."""
        was_silent = page.note(f"{TEXT}.includes('No signal since')")
        kill(CORE)
        page.wait(was_silent, "the page says that the box is silent")
        page.wait(f"!{TEXT}.includes('No signal since') && {COUNTS}", "the page works again")
