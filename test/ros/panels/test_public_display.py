"""The public display, on two virtual screens, with a fake core."""

import os
import pathlib
import signal
import time
import unittest
from functools import partial
from unittest import mock

import rosgraph
import rospy
import rosservice
from support.fakes.public import MIDNIGHT, NOON, TEAMS, FakePublic, event, scene
from support.gui_testing import LONG_S, SCREEN, SECOND_SCREEN, app, limit, show, wait_until
from support.programs import Program
from support.waiting import LIMIT_S

from roah_rsbb.msg import ModuleScore, PublicBoard, PublicDetails
from roah_rsbb.ros.feed import Feed
from roah_rsbb.rqt.public import display, node
from roah_rsbb.rqt.public.display import BOARD_TOPIC, OLD_BACKGROUND, RUNNING, TOPIC, PublicDisplay
from roah_rsbb.rqt.public.node import ScreenChoice
from roah_rsbb.rqt.qt import QColor, QPixmap, Qt
from roah_rsbb.srv import UInt8
from roah_rsbb.wording.replay import PREFIX

LAUNCH = pathlib.Path(__file__).resolve().parents[3] / "launch" / "roah_rsbb_public.launch"
ALL_SIZES = ((1280, 720), (1920, 1080), (3840, 2160))
# How many runs each size is tried with. The layout of a page depends on their number, its letters on the size.
RUNS = {ALL_SIZES[0]: (0, 1, 2, 3, 4, 5, 6, 20), ALL_SIZES[1]: (1, 4, 20), ALL_SIZES[2]: (1, 20)}
# The largest size takes most time to paint. All is twice as large there as at the size before.
SIZES = ALL_SIZES if os.environ.get("ROAH_TEST_ALL") == "yes" else ALL_SIZES[:2]
FEW_S, MANY_S = 0.25, 1e9  # for how long a page is shown


class DisplayCase(unittest.TestCase):
    """A display, and a core that publishes what the test wants."""

    page_s = MANY_S
    title, logo = "", None
    silent = False
    silent_s = LONG_S  # only tests of a silent core must reach this limit

    def setUp(self) -> None:
        limit(self, display, "SILENT_S", self.silent_s)
        self.core = FakePublic(silent=self.silent)
        self.addCleanup(self.core.close)
        feed = Feed({TOPIC: PublicDetails, BOARD_TOPIC: PublicBoard})
        feed.start()
        self.addCleanup(feed.stop)
        self.display = PublicDisplay(feed, self.page_s, title=self.title, logo=self.logo)
        self.addCleanup(self.display.close)
        show(self.display, *SIZES[0])

    def wait(self, condition, what: str) -> None:
        wait_until(lambda: self.display.look() or condition(), lambda: what)

    def publish(self) -> None:
        """Publish, and wait until it is on the screen."""
        self.core.publish()
        self.wait_heard()

    def wait_heard(self) -> None:
        """Wait until what was published is on the screen."""
        clock = self.core.said_utc_s
        self.wait(lambda: self.display._details is not None and self.display._details.clock.to_sec() >= clock,
                  "what was published is heard")
        self.display.repaint()

    def texts(self) -> list:
        return [written.text for written in self.display.written]

    def wait_text(self, text: str) -> None:
        wait_until(lambda: self.display.look() or text in self.texts(), f"the screen says {text!r}")

    def wait_gone(self, text: str) -> None:
        wait_until(lambda: self.display.look() or text not in self.texts(), f"the screen says {text!r} no more")

    def countdown(self) -> int:
        """Seconds left of the run that is shown; 0: none is."""
        shown = next((text for text in self.texts() if text.startswith("▶ ")), "▶ 0:00")
        minutes, seconds = shown[2:].split(":")
        return 60 * int(minutes) + int(seconds)

    def count(self, colour) -> int:
        """How much of a colour is on the screen, of many points."""
        image = self.display.grab().toImage()
        width, height = self.display.width(), self.display.height()
        step_x, step_y = width // 100, height // 40
        points = [(x, y) for x in range(step_x // 2, width, step_x) for y in range(step_y // 2, height, step_y)]
        return sum(image.pixelColor(x, y) == colour for x, y in points)


class TestNothingHeard(DisplayCase):
    silent = True

    def test_it_waits_for_a_core(self) -> None:
        self.wait_text("Waiting for the referee box")


class TestWhatIsShown(DisplayCase):
    def test_the_countdown_runs_by_itself(self) -> None:
        self.core.ahead_s = 3600.0  # the box's clock is not this computer's
        self.core.silent = True  # one message is enough
        self.core.runs = [self.core.run(left_s=100.5)]
        self.core.publish()
        # Whatever it shows first: it counts down from there.
        wait_until(lambda: self.display.look() or self.countdown() > 0, "a countdown is shown")
        before = self.countdown()
        self.assertLessEqual(before, 101)
        wait_until(lambda: self.display.look() or 0 < self.countdown() < before, "it counts")
        self.assertIn("BrassButlers", self.texts())
        self.assertIn("running", self.texts())
        self.assertGreater(self.count(RUNNING), 3)

    def test_a_paused_run_has_a_band_that_says_so(self) -> None:
        for count in (1, 2, 3, 6):  # every kind of card
            self.core.runs = [self.core.run(number, left_s=100.0 + count, counting=False) for number in range(count)]
            self.wait_text(f"‖ 1:{40 + count}")
            image = self.display.grab().toImage()
            bands = [one for one in self.display.written if one.text == "PAUSED"]
            self.assertEqual([one.shown for one in bands], count * ["PAUSED"])
            for band in bands:
                self.assertGreater(band.ink.x, band.place.x)
                self.assertLess(band.ink.right, band.place.right)
                edges = (band.place.x + 2, band.place.right - 3)
                colours = [image.pixelColor(int(x), int(band.place.y + band.place.h / 2)) for x in edges]
                self.assertEqual(colours, [RUNNING, RUNNING])

    def test_how_a_run_is_prepared_and_ends(self) -> None:
        self.core.runs = [self.core.run(0, "connected", left_s=600.0)]
        self.wait_text("getting ready")
        self.assertIn("10:00", self.texts())
        self.core.runs = [self.core.run(0, "ended")]
        self.wait_text("ended")
        self.assertFalse({"✓ completed", "■ stopped"} & set(self.texts()))
        self.core.runs = [self.core.run(0, "ended", end_reason="completed")]
        self.wait_text("✓ completed")

    def test_all_robots_at_once(self) -> None:
        run = self.core.run(teams=list(TEAMS))
        run.event.team = "ALL"
        self.core.runs = [run]
        self.wait_text("All teams")
        self.assertIn(f"round 1, run 1 · {', '.join(TEAMS)}", self.texts())

    def test_what_follows_and_when_nothing_does(self) -> None:
        self.wait_text("The schedule is done")
        self.assertIn("Nothing is running at the moment", self.texts())
        first, second = event(0), event(1)
        self.core.following = [first, second]
        self.wait_text("CopperKettle")
        self.assertIn(time.strftime("%H:%M", time.localtime(second.scheduled.to_sec())), " ".join(self.texts()))

    def test_times_of_day_are_local(self) -> None:
        zone = {"TZ": "UTC-5"}  # five hours ahead of UTC
        with mock.patch.dict(os.environ, zone):
            time.tzset()
            self.addCleanup(time.tzset)
            self.core.following = [event(0)]
            self.core.following[0].scheduled = rospy.Time(int(NOON) // 86400 * 86400 + 10 * 3600)
            self.wait_text("Next")
            wait_until(lambda: self.display.look() or any(text.endswith("15:00") for text in self.texts()),
                       "10:00 UTC is 15:00 here")


class TestResults(DisplayCase):
    page_s = FEW_S

    def test_without_results_there_is_only_what_follows(self) -> None:
        scene(self.core, 2, scores=False)
        self.wait_text("Next")
        seen = set()
        until = time.monotonic() + 4 * FEW_S
        wait_until(lambda: self.display.look() or seen.update(self.texts()) or time.monotonic() > until, "some pages")
        self.assertFalse([text for text in seen if "Results" in text or "Achievements" in text])

    def test_results_take_turns_with_what_follows(self) -> None:
        scene(self.core, 2)
        seen = set()
        wanted = {"Next", "✓ completed", "■ timeout", "■ stopped", "■ no data saved", "■ module failed",
                  "Waypoints reached 4 · Achievements 4", "Penalized behaviours 2 (1 not attempted)"}
        wait_until(lambda: self.display.look() or seen.update(self.texts()) or wanted <= seen, "all pages are seen")


    def test_the_board_takes_turns_with_what_follows(self) -> None:
        scene(self.core, 2)
        self.core.publish_board([self.core.result(2, "stopped")])
        seen = set()
        wanted = {"Next", "Provisional results", "Standing: Getting to know my home 1/2", "1", "TeaAtFive", "■ timeout",
                  "Achievements: 8 · Distance error (less is better): 0.1 m"}
        wait_until(lambda: self.display.look() or seen.update(self.texts()) or wanted <= seen,
                   lambda: f"not seen: {wanted - seen}")

    def test_what_is_not_signed_off_is_on_pages_of_its_own(self) -> None:
        scene(self.core, 1, scores=False)
        self.core.publish_board([self.core.result(3, "timeout")], teams=())
        pages = {}

        def seen() -> bool:
            self.display.look()
            self.display.repaint()
            titles = [text for text in self.texts() if text in ("Next", "Results", "Provisional results")]
            if titles:
                pages[tuple(titles)] = "■ timeout" in self.texts()
            return ("Provisional results",) in pages and ("Next",) in pages

        wait_until(seen, "both pages are seen")
        self.assertEqual(pages, {("Next",): False, ("Provisional results",): True})

    def test_scores_of_modules_are_never_cut(self) -> None:
        with self.core.lock:
            scene(self.core, 3)
            score = self.core.finished[0].module_scores
            score += [ModuleScore("", f"n{i}", "0.123", "m", f"Mean distance error of number {i}") for i in range(12)]
            score.append(ModuleScore("", "evil", '"' + "=evil()" * 40 + '"', "", "A robot's text"))
        self.core.publish_board(teams=())
        seen, checked = [], [self.display.written]

        def all_seen() -> bool:
            self.display.look()
            if self.display.written is checked[-1]:  # it was not painted again
                return False
            checked.append(self.display.written)
            for one in self.display.written:
                self.assertEqual(one.shown, one.text)
                if one.text not in seen:
                    seen.append(one.text)
            text = " ".join(seen)
            return "".join(seen).count("=evil()") >= 38 and all(f"number {i} 0.123 m" in text for i in range(12))

        wait_until(all_seen, lambda: f"all scores are seen: {seen}")


class TestCompetition(DisplayCase):
    title = "European Robotics League 2026"

    def setUp(self) -> None:
        self.logo = QPixmap(300, 200)
        self.logo.fill(QColor("#d04020"))
        super().setUp()

    def shows(self, runs: int) -> bool:
        return len(self.display.content.cards) == runs

    def test_title_and_logo_are_shown_and_live_teams_are_the_largest(self) -> None:
        for size in SIZES:
            for runs in range(1, 7):
                with self.subTest(size=size, runs=runs):
                    show(self.display, *size)
                    scene(self.core, runs)
                    self.core.publish()
                    self.wait(partial(self.shows, runs), "the runs are on the screen")
                    self.display.repaint()
                    pixels = [one.pixels for one in self.display.written if one.text in TEAMS]
                    self.assertGreater(min(pixels[:runs]), max(pixels[runs:]), "live teams are written first")
                    title = next(one for one in self.display.written if one.text == self.title)
                    self.assertEqual(title.shown, title.text)
                    self.assertGreater(self.count(QColor("#d04020")), 3)


class TestTrouble(DisplayCase):
    silent_s = display.SILENT_S

    def setUp(self) -> None:
        super().setUp()
        self.core.runs = [self.core.run()]
        self.wait_text("running")

    def trouble(self) -> str:
        return next((text for text in self.texts() if text.startswith("No signal since")), "")

    def fall_silent(self) -> None:
        """Let the core fall silent, and wait until the display says so."""
        self.core.silent = True
        self.wait_heard()
        self.wait_trouble()

    def wait_trouble(self) -> None:
        self.wait(self.trouble, "it is said that all is old")

    def test_a_silent_core_is_said_and_the_countdown_stands(self) -> None:
        self.fall_silent()
        self.assertGreater(self.count(OLD_BACKGROUND), 3)
        self.assertEqual(self.count(RUNNING), 0)
        before = self.texts()
        until = time.monotonic() + 1.5
        wait_until(lambda: self.display.look() or time.monotonic() > until, "time passes")
        self.assertEqual(self.texts(), before)
        self.core.silent = False
        self.wait(lambda: not self.trouble() and "running" in self.texts(), "it is live again")
        self.assertEqual(self.count(OLD_BACKGROUND), 0)

    def test_a_replay_is_marked(self) -> None:
        self.assertNotIn("REPLAY", self.texts())
        self.core.box_uuid = f"{PREFIX}fake"
        self.wait(lambda: "REPLAY" in self.texts(), "the display is marked")
        self.assertGreater(self.count(OLD_BACKGROUND), 3)
        self.assertTrue(self.display.windowTitle().startswith("REPLAY – "))

    def test_a_repeated_message_is_not_a_sign_of_life(self) -> None:
        self.fall_silent()
        self.display._feed.renew()  # gets what is latched
        until = time.monotonic() + 1.0
        wait_until(lambda: self.display.look() or time.monotonic() > until, "time passes")
        self.assertTrue(self.trouble())

    def test_another_core_with_another_clock(self) -> None:
        self.core.close()
        self.wait_trouble()
        limit(self, display, "SILENT_S", LONG_S)
        core = FakePublic()
        self.addCleanup(core.close)
        core.box_uuid, core.ahead_s = "another", -7200.0
        core.runs = [core.run(1, left_s=50.0)]
        self.wait_text("CopperKettle")
        self.wait_gone("BrassButlers")
        big = next(text for text in self.texts() if text.startswith("▶"))
        self.assertRegex(big, r"▶ 0:([0-4]\d|50)$")


class TestLayout(DisplayCase):
    page_s = FEW_S

    def check(self, may_shorten: bool) -> None:
        """All texts are complete and do not overlap."""
        width, height = self.display.width(), self.display.height()
        written = list(self.display.written)
        for one in written:
            if not may_shorten:
                self.assertEqual(one.shown, one.text)
            for inner, outer in ((one.ink, one.place), (one.place, (0, 0, width, height))):
                x, y, w, h = outer
                self.assertGreaterEqual(inner.x, x - 1, one)
                self.assertGreaterEqual(inner.y, y - 1, one)
                self.assertLessEqual(inner.right, x + w + 1, one)
                self.assertLessEqual(inner.bottom, y + h + 1, one)
        for i, one in enumerate(written):
            for other in written[i + 1:]:
                a, b = one.place, other.place
                if a.right > b.x + 1 and b.right > a.x + 1 and a.bottom > b.y + 1 and b.bottom > a.y + 1:
                    self.fail(f"{one} overlaps {other}")

    def see_all(self, wanted: set, may_shorten: bool = False) -> None:
        seen, checked = set(), [self.display.written]

        def all_seen() -> bool:
            self.display.look()
            if self.display.written is not checked[-1]:  # it was painted
                checked.append(self.display.written)
                self.check(may_shorten)
                seen.update(self.texts())
            return wanted <= seen

        wait_until(all_seen, "all pages are seen")

    def test_everything_is_whole_at_every_size(self) -> None:
        for size, numbers in RUNS.items():
            for runs in numbers:
                with self.subTest(size=size, runs=runs):
                    show(self.display, *size)
                    results, following = scene(self.core, runs)
                    self.core.publish()
                    places = {f"Home {i + 1} · round {1 + i // 12}, run {1 + i % 3}" for i in range(runs)}
                    self.see_all(places | {"Next", "✓ completed", "■ module failed"})
                    self.assertEqual((self.display.width(), self.display.height()), size)

    def test_long_names_and_many_runs(self) -> None:
        with self.core.lock:
            scene(self.core, 7)
            for thing in [*self.core.runs, *self.core.following, *self.core.finished]:
                event = getattr(thing, "event", thing)
                event.team, event.benchmark, event.zone = "Team " * 20, "Benchmark " * 20, f"Zone {event.zone} " * 9
        for size in SIZES:
            with self.subTest(size=size):
                show(self.display, *size)
                self.core.publish()
                self.see_all({"Next", "✓ completed", "■ module failed", "Team " * 20, "running"}, may_shorten=True)

    def test_rows_of_another_day_are_whole(self) -> None:
        for hour in (21.0, 23.9, 0.1):
            core = FakePublic(MIDNIGHT - 86400.0 * (hour > 12) + 3600.0 * hour, silent=True)
            core.close()
            scene(core, 2)
            with self.core.lock:
                self.core.runs, self.core.following, self.core.finished = core.runs, core.following, core.finished
                self.core.results = core.results
                self.core.ahead_s = core.now() - NOON
            for size in SIZES:
                with self.subTest(hour=hour, size=size):
                    show(self.display, *size)
                    self.publish()
                    self.see_all({"Next", "✓ completed", "■ module failed"})

    def test_other_shapes_of_screens(self) -> None:
        scene(self.core, 6)
        for size in ((1280, 1024), (2560, 1080), (1024, 768)):
            with self.subTest(size=size):
                show(self.display, *size)
                self.see_all({"Next", "✓ completed", "■ module failed"}, may_shorten=True)

    def test_what_matters_is_large(self) -> None:
        """Read from ten metres: see the theory in public_layout."""
        scene(self.core, 6)
        self.publish()
        high = {one.text: one.place.h / self.display.height() for one in self.display.written}
        self.assertGreater(high["BrassButlers"], 0.06)
        self.assertGreater(min(h for text, h in high.items() if text.startswith("▶")), 0.06)


class TestScreens(DisplayCase):
    def setUp(self) -> None:
        super().setUp()
        self.choice = ScreenChoice(self.display, 0)
        self.addCleanup(self.choice._service.shutdown, "the test is over")
        self.service = rospy.ServiceProxy(f"{rospy.get_namespace()}screen", UInt8)

    def wait_on(self, number: int, size: tuple) -> None:
        def there() -> bool:
            self.choice.look()
            self.display.look()
            screen = self.display.windowHandle().screen()
            return (app.screens().index(screen), self.display.width(), self.display.height()) == (number, *size)

        wait_until(there, f"it fills screen {number}")

    def call(self, number: int) -> None:
        """The service is answered while Qt's thread is in here: it must not wait for it."""
        rospy.wait_for_service("screen", LIMIT_S)
        self.service(number)

    def test_a_screen_is_chosen_by_service(self) -> None:
        self.wait_on(0, SCREEN)
        self.call(1)
        self.wait_on(1, SECOND_SCREEN)
        self.assertTrue(self.display.isFullScreen())
        self.assertEqual(self.display.cursor().shape(), Qt.BlankCursor)
        self.call(0)
        self.wait_on(0, SCREEN)

    def test_a_screen_that_is_not_there_is_refused(self) -> None:
        self.call(1)
        self.wait_on(1, SECOND_SCREEN)
        with self.assertRaisesRegex(rospy.ServiceException, "no screen 2: there are screens 0 to 1"):
            self.call(2)
        self.wait_on(1, SECOND_SCREEN)

    def test_a_screen_that_is_unplugged_is_left_and_found_again(self) -> None:
        both = app.screens()
        self.call(1)
        self.wait_on(1, SECOND_SCREEN)
        with mock.patch("roah_rsbb.rqt.public.node.QGuiApplication.screens", return_value=both[:1]):
            self.wait_on(0, SCREEN)
        self.wait_on(1, SECOND_SCREEN)

    def test_the_parameter(self) -> None:
        for value, screen in ((1, 1), (0, 0), (300, 0), (-1, 0), ("x", 0), (True, 0)):
            rospy.set_param("~screen", value)
            self.assertEqual(node._chosen_screen(), screen, value)
        rospy.delete_param("~screen")
        self.assertEqual(node._chosen_screen(), 0)


class TestProgram(unittest.TestCase):
    """The launch file, as organisers use it."""

    def test_the_screen_and_its_service(self) -> None:
        launch = Program("roslaunch", str(LAUNCH), "screen:=1")
        self.addCleanup(launch.close)
        size = "{}x{}".format(*SECOND_SCREEN)
        launch.wait_printed("On screen 1 (")
        launch.wait_printed(f", {size})")
        (name,) = [name for name in rosservice.get_service_list() if name.endswith("/screen")]
        self.assertRegex(name, "^/roah_rsbb_public_[^/]+/screen$")
        self.assertEqual(rosservice.get_service_type(name), "roah_rsbb/UInt8")
        launch.wait_printed(f"rosservice call {name} 1")
        with self.assertRaisesRegex(rospy.ServiceException, "no screen 2"):
            rospy.ServiceProxy(name, UInt8)(2)
        rospy.ServiceProxy(name, UInt8)(0)
        launch.wait_printed("On screen 0 (")
        listens = [f"{name.rpartition('/')[0]}/roah_rsbb_public"]
        wait_until(lambda: dict(rosgraph.Master("/t").getSystemState()[1]).get(TOPIC) == listens, "it listens")
        launch.signal(signal.SIGINT)
        launch.wait_ended()
        self.assertNotIn(name.rpartition("/")[0], str(rosgraph.Master("/t").getSystemState()), "it has left the master")
