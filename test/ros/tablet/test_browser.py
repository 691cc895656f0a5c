"""The tablet's page in a real browser, touched by a finger; what is touched goes all the way to the robot.

`make test-all` leaves screenshots in build/screenshots.
"""

import os
import pathlib
import signal
import time
from typing import Optional

from support import tablet_nodes
from support.box_case import LISTENER, BoxCase
from support.browser import NeedsBrowser, Page
from support.connections import kill, process_of
from support.robots import RSBB_PORT
from support.waiting import wait_until

from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.tablet import maps
from roah_rsbb.tablet.server import SAME_CALL_S

ROS_TESTS = pathlib.Path(__file__).resolve().parents[1]
SHOTS = ROS_TESTS.parents[1] / "build" / "screenshots"
MAP = maps.load(str(ROS_TESTS / "config" / "turned_map.yaml"))
# Width and height in CSS pixels.
SCREENS = {
    "small_phone": (320, 480), "phone": (390, 844), "phone_lying": (844, 390), "tablet": (820, 1180),
    "tablet_lying": (1180, 820),
}
# What a finger hits for certain, in CSS pixels (WCAG 2.2 asks for 24, Android for 48).
FINGER = 48
PIXEL_M = 0.05
USABLE = "!document.getElementById('call').disabled"
SHOWS_CALL, SHOWS_MAP = "document.body.dataset.view === 'call'", "document.body.dataset.view === 'map'"
SAID = "document.getElementById('said').textContent"
ALARM = "(document.getElementById('alarm').hidden ? '' : document.getElementById('alarm').textContent)"


class BrowserCase(NeedsBrowser, BoxCase):
    """A test case with a browser."""

    PAGES = "the tablet's page"

    def open(self, screen: str, url: Optional[str] = None) -> Page:
        """The page, on a screen."""
        return self._leaving(self.browser.page(url or tablet_nodes.launched_url(), *SCREENS[screen], scale=2))

    def assert_fits(self, page: Page, screen: str, selector: str) -> None:
        """All of an element is on the screen, and nothing can be scrolled."""
        left, top, width, height = page.box(selector)
        screen_width, screen_height = SCREENS[screen]
        where = f"{selector} on {screen}: {(left, top, width, height)}"
        self.assertGreaterEqual(min(left, top), 0, where)
        self.assertLessEqual(left + width, screen_width + 0.5, where)
        self.assertLessEqual(top + height, screen_height + 0.5, where)
        self.assertGreaterEqual(min(width, height), FINGER, where)
        self.assertEqual(page.get(
            "[document.scrollingElement.scrollWidth, document.scrollingElement.scrollHeight, "
            "visualViewport.scale]"), [screen_width, screen_height, 1], where)

    def assert_undistorted(self, page: Page, screen: str, selector: str) -> None:
        """The button is round, the map has its own proportions, and either is as large as fits."""
        _, _, width, height = page.box(selector)
        proportion = 1.0 if selector == "#call" else MAP.width / MAP.height
        self.assertAlmostEqual(width / height, proportion, delta=0.02, msg=f"{selector} on {screen}")
        self.assertGreater(max(width / SCREENS[screen][0], height / SCREENS[screen][1]), 0.7, f"{selector} on {screen}")

    def turn_through_screens(self, page: Page, view: str, selector: str) -> None:
        """Try a view on every screen, and keep a picture of each."""
        for screen, size in SCREENS.items():
            page.resize(*size, scale=2)
            page.wait(f"innerWidth === {size[0]} && innerHeight === {size[1]}", f"the screen is a {screen}")
            page.get("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")
            self.assert_fits(page, screen, selector)
            self.assert_fits(page, screen, "#said")
            self.assert_undistorted(page, screen, selector)
            page.screenshot(SHOTS / f"tablet_{view}_{screen}.png")


class TestWholeWay(BrowserCase):
    """A run of HCFGAC: Granny Annie calls, the robot asks for the map, she shows it where to go."""

    def test_granny_calls_and_shows_a_place(self) -> None:
        self.robot, self.listener = self.robot("Delta"), self.participant(LISTENER)
        phone, tablet = self.open("phone"), self.open("tablet")
        for page in (phone, tablet):
            page.wait(f"{USABLE} && {SHOWS_CALL}", "the call button can be touched")
        self.box.connect("Room")
        self.box.start("Room")
        self.robot.wait_did("execute HCFGAC")
        self.a_call_reaches_the_robot(phone, tablet)
        self.turn_through_screens(phone, "call", "#call")
        self.robot.request("display_map", True)
        for page in (phone, tablet):
            page.wait(f"{SHOWS_MAP} && document.getElementById('map').naturalWidth === 200", "the map is shown")
        self.a_place_reaches_the_robot(phone, tablet, 0.25, 0.75)
        self.a_place_reaches_the_robot(tablet, phone, 0.9, 0.1)
        self.two_fingers_pick_nothing(phone)
        self.a_keyboard_picks_a_place(tablet)
        self.turn_through_screens(phone, "map", "#sheet")
        self.robot.request("display_map", False)
        phone.wait(SHOWS_CALL, "the call button is shown again")
        self.assertEqual(self.browser.errors, [])

    def a_call_reaches_the_robot(self, touched: Page, other: Page) -> None:
        began = time.time()
        touched.touch_at("#call")
        wait_until(lambda: self.robot.tablet.call_time[0] >= int(began), "the robot hears the call")
        for page in (touched, other):
            page.wait(f"{SAID}.includes('✓ The robot was called')", "the box's answer is shown")
        wait_until(lambda: self.box.gui.tablet_call_time.to_sec() >= began - 1e-3, "the referee sees the call")
        first, heard = self.robot.tablet.call_time, time.monotonic()
        wait_until(lambda: time.monotonic() - heard > SAME_CALL_S, "a tap is another call")
        other.touch_at("#call")
        wait_until(lambda: self.robot.tablet.call_time > first, "the robot hears the next call")

    def a_place_reaches_the_robot(self, touched: Page, other: Page, u: float, v: float) -> None:
        before = self.robot.tablet.position_time
        touched.touch_at("#sheet", u, v)
        wait_until(lambda: self.robot.tablet.position_time > before, "the robot hears the position")
        x, y = MAP.to_metres(u, v)
        self.assertAlmostEqual(self.robot.tablet.position_x, x, delta=PIXEL_M)
        self.assertAlmostEqual(self.robot.tablet.position_y, y, delta=PIXEL_M)
        for page in (touched, other):
            page.wait(f"{SAID}.includes('x {self.robot.tablet.position_x:.2f} m')", "the box's answer is shown")
            sheet, mark = page.box("#sheet"), page.box("#mark")
            self.assertAlmostEqual(mark[0] + mark[2] / 2, sheet[0] + u * sheet[2], delta=2)
            self.assertAlmostEqual(mark[1] + mark[3] / 2, sheet[1] + v * sheet[3], delta=2)

    def two_fingers_pick_nothing(self, page: Page) -> None:
        """Nor do they zoom, as they do on other pages, nor do two quick touches."""
        left, top, width, height = page.box("#sheet")
        fingers = [{"x": left + width * part, "y": top + height / 2, "id": number}
                   for number, part in enumerate((0.3, 0.6))]
        spread = [{**fingers[0], "x": left + 5}, {**fingers[1], "x": left + width - 5}]
        places = self.places_published()
        for kind, points in (("touchStart", fingers[:1]), ("touchStart", fingers), ("touchMove", spread),
                             ("touchEnd", spread[:1]), ("touchEnd", [])):
            page.command("Input.dispatchTouchEvent", type=kind, touchPoints=points)
        for _ in range(2):
            page.touch_at("#said")
        self.assertEqual(page.get("visualViewport.scale"), 1)
        self.a_place_reaches_the_robot(page, page, 0.4, 0.6)
        wait_until(lambda: len(self.places_published()) > len(places), "the place is in the box's beacon")
        self.assertEqual(len(self.places_published()), len(places) + 1)

    def places_published(self) -> set:
        """The times of all places that the box has published so far."""
        return {(m.tablet_position_time.sec, m.tablet_position_time.nsec)
                for m, _ in list(self.listener.heard) if isinstance(m, pb.RoahRsbbBeacon)}

    def a_keyboard_picks_a_place(self, page: Page) -> None:
        before = self.robot.tablet.position_time
        page.get("document.getElementById('sheet').focus()")
        for key in ("ArrowRight", "ArrowUp", "ArrowUp", "Enter"):
            page.key(key)
        wait_until(lambda: self.robot.tablet.position_time > before, "the robot hears the position")
        x, y = MAP.to_metres(0.52, 0.46)
        self.assertAlmostEqual(self.robot.tablet.position_x, x, delta=1e-6)
        self.assertAlmostEqual(self.robot.tablet.position_y, y, delta=1e-6)


class TestNoConnection(BrowserCase):
    """The page shows when nothing can be sent."""

    def test_a_box_that_is_not_there(self) -> None:
        url, end = tablet_nodes.served(RSBB_PORT + 96)
        self.addCleanup(end)
        page = self.open("phone", url)
        page.wait(f"{ALARM}.includes('box is silent')", "the page says that the box is silent")
        self.assertTrue(page.get("document.getElementById('call').disabled"))
        self.assert_undistorted(page, "phone", "#call")
        page.screenshot(SHOTS / "tablet_no_box.png")

    def test_a_core_that_hangs_ends_and_comes_back(self) -> None:
        page = self.open("tablet_lying")
        page.wait(USABLE, "the call button can be touched")
        number = process_of("/roah_rsbb_core")
        os.kill(number, signal.SIGSTOP)
        try:
            page.wait(f"{ALARM}.includes('No connection')", "the page says that the core is silent")
            self.assertTrue(page.get("document.getElementById('call').disabled"))
            page.screenshot(SHOTS / "tablet_no_connection.png")
        finally:
            os.kill(number, signal.SIGCONT)
        page.wait(f"{USABLE} && {ALARM} === ''", "the page works again")
        was_gone = page.note(f"{ALARM}.includes('No connection')")
        kill("/roah_rsbb_core")
        page.wait(was_gone, "the page says that the core has gone")
        page.wait(f"{USABLE} && {ALARM} === ''", "the page works again, without being reloaded")
