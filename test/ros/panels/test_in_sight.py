"""What a referee must see during a run, at each size of the window."""

import os
import pathlib

from support.gui_testing import QWidget, click, settle, wait_until
from support.panel_case import BUMPS
from support.window_case import WindowCase, in_sight

from roah_rsbb.bmbox.hnf import HNF
from roah_rsbb.model.records import ScoreValue
from roah_rsbb.model.zone import RunClock
from roah_rsbb.rqt import basic
from roah_rsbb.rqt.qt import QLabel, QPoint, QScrollArea, QStyle, Qt, QTabBar
from roah_rsbb.rulebook.config import load_benchmarks
from roah_rsbb.scoring.sheet import Mark

ROOT = pathlib.Path(__file__).resolve().parents[3]
CONFIG, SHOTS = ROOT / "config", ROOT / "build" / "screenshots"

PERSON = ("Disqualifying behaviours", "Hits Annie or another person")
# Qt's scale factor is that of the process: in_sight.test starts these cases with 1 and with 2.
SCALE = int(os.environ.get("QT_SCALE_FACTOR", "1"))
# The smallest window has the shortest space. At scale 2, the largest one has the layout of 1920x1080.
SIZES = {1: ((1366, 768), (1920, 1080), (2560, 1440)), 2: ((2560, 1440), (3840, 2160))}[SCALE]
if "LC_MESSAGES" in os.environ:
    SIZES = SIZES[:1]
elif os.environ.get("ROAH_TEST_ALL") != "yes":
    SIZES = {1: (SIZES[0], SIZES[-1]), 2: SIZES[:1]}[SCALE]


# The scores of a run of HNF with five waypoints.
EACH = (("time", "s"), ("timed_out", ""), ("distance_error", "m"), ("orientation_error", "rad"))
MODULE_SCORES = [
    *(ScoreValue("", name, "12.3456", value.unit, value.desc) for name, value in HNF.SCORES.items()),
    *(ScoreValue(f"waypoint {number}", name, "0.1234", unit, HNF.EACH[name].desc)
      for number in range(1, 6) for name, unit in EACH),
]


class _AtAllSizes(WindowCase):
    """Sizes, and what is in sight at them."""

    def at_all_sizes(self):
        for size in SIZES:
            self.window.resize(*(length // SCALE for length in size))
            self.wait_quiet()
            yield size

    def assert_in_sight(self, size, **widgets: QWidget) -> None:
        """Wait until they are: a layout follows a message or another size in several steps."""
        def cut():
            return [name for name, widget in widgets.items() if not in_sight(widget)]

        wait_until(lambda: not cut(), lambda: f"at {size[0]}x{size[1]}, scale {SCALE}, all is in sight but {cut()}")

    def assert_sheet_and_commands_in_sight(self, size, items: int, **more: QWidget) -> None:
        rows = {f"item {row.text.text()}": row for row in self.scoring.rows.values()}
        self.assertEqual(len(rows), items)
        self.assert_in_sight(
            size, stop=self.window.strip.stop, stop_all=self.window.strip.stop_all,
            running=self.panel("OverviewPanel").head, phase=self.control.phase, run_time=self.control.times.main,
            goal_time=self.control.times.goal, reason=self.control.reason, **rows,
            **{f"buttons of {name}": row.menu_button for name, row in rows.items()},
            **{f"command {name}": button for name, button in self.control.buttons.items()}, **more)


class TestInSight(_AtAllSizes):
    """All that counts before and during a run."""

    def test_all_is_in_sight_before_and_during_a_run(self) -> None:
        self.the_pages_can_be_opened()
        self.no_title_of_a_tab_is_shortened()
        self.window.resize(*(length // SCALE for length in SIZES[0]))
        self.wait_quiet()
        self.run_zone()
        for number in range(7):
            self.zone.mark(Mark(*BUMPS, number + 1, note=str(number)), "Anna")
        wait_until(lambda: len(self.scoring.undo.buttons) == 5, "the last five marks are shown")
        self.zone.goal = RunClock(goal=1)
        wait_until(self.control.times.goal.isVisible, "the goal's time is shown")
        for size in self.at_all_sizes():
            undo = {f"undo {number}": button for number, button in enumerate(self.scoring.undo.buttons)}
            self.assert_sheet_and_commands_in_sight(
                size, 9, zone=self.control.zones, referee=self.scoring.referee, answer=self.scoring.answer, **undo)
            wait_until(lambda: not self.cut(), lambda size=size: f"no text is cut off at {size}, as {self.cut()}")
        self.disqualifying_items_do_not_scroll_away()

    def cut(self) -> list:
        """The texts of items that are cut off."""
        texts = [row.text for row in self.scoring.rows.values()]
        return [text.text() for text in texts if text.height() < text.heightForWidth(text.width())]

    def disqualifying_items_do_not_scroll_away(self) -> None:
        click(self.panel("OverviewPanel").toggle)
        wait_until(lambda: not self.panel("OverviewPanel").is_collapsed, "the overview is back")
        self.window.resize(1366, 700)
        self.wait_quiet()
        area = self.scoring.sheet.findChild(QScrollArea)
        bar = area.verticalScrollBar()
        for place in (bar.minimum(), bar.maximum()):
            bar.setValue(place)
            settle(self.scoring)
            self.assertTrue(in_sight(self.scoring.rows[PERSON].more))

    def the_pages_can_be_opened(self) -> None:
        self.core.add_call("paired", lambda given, caller: {"devices": []})
        pages = self.control.pages
        wait_until(pages.isEnabled, "they are served")
        for width, height in ((900, 500), (1920, 1080)):
            self.window.resize(width, height)
            self.wait_quiet()
            self.assert_in_sight((width, height), pages=pages)
            self.assertGreaterEqual(pages.width(), pages.sizeHint().width())
            if os.environ.get("ROAH_TEST_ALL") == "yes":
                SHOTS.mkdir(parents=True, exist_ok=True)
                self.window.grab().save(str(SHOTS / f"window_{width}x{height}_{pages.text()[:3].lower()}_{SCALE}.png"))

    def no_title_of_a_tab_is_shortened(self) -> None:
        # From a large screen to the smallest: the docks keep their shares. Fusion is the style of the pictures and of
        # desktops without one of their own.
        # The last one is that of 1920x1080 at scale 2: some may be behind an arrow there.
        sizes = [(3840, 2160), *SIZES, (1280 * SCALE, 720 * SCALE), (960 * SCALE, 540 * SCALE)]
        for size in sizes:
            self.window.resize(*(length // SCALE for length in size))
            self.wait_quiet()
            bars = [bar for bar in self.window.findChildren(QTabBar) if bar.parent() is self.window and bar.isVisible()]
            self.assertEqual(sorted(bar.count() for bar in bars), [3, 6])
            for bar in bars:
                beside = bar.style().pixelMetric(QStyle.PM_TabBarTabHSpace, None, bar)
                for index in range(bar.count()):
                    needed = bar.fontMetrics().horizontalAdvance(bar.tabText(index)) + beside
                    self.assertGreaterEqual(bar.tabRect(index).width(), needed, f"{bar.tabText(index)} at {size}")
                    is_here = size == sizes[-1] or bar.rect().contains(bar.tabRect(index))
                    self.assertTrue(is_here, f"{bar.tabText(index)} at {size}")


class TestFunctionalityInSight(_AtAllSizes):
    """All that counts during a run of HNF, whose module scores, too."""

    ITEMS = load_benchmarks(str(CONFIG / "benchmarks.yaml"))["HNF"].scoring

    def test_every_item_and_the_scores_of_the_run_are_in_sight(self) -> None:
        self.window.resize(*(length // SCALE for length in SIZES[0]))
        self.wait_quiet()
        self.run_zone()
        bumps = self.ITEMS[0]
        for number in range(7):
            self.zone.mark(Mark(bumps.group, bumps.desc, number + 1, note=str(number)), "Anna")
        wait_until(lambda: len(self.scoring.undo.buttons) == 5, "the last five marks are shown")
        self.zone.goal = RunClock(goal=5)
        self.zone.module_scores = MODULE_SCORES
        scores = self.scoring.module_scores
        wait_until(lambda: scores.isVisible() and self.control.times.goal.isVisible(), "the module's scores are shown")
        for size in self.at_all_sizes():
            self.assert_sheet_and_commands_in_sight(size, 3, scores=scores.verticalScrollBar())
            run_time, goal_time = (figure.figure for figure in (self.control.times.main, self.control.times.goal))
            between = goal_time.mapToGlobal(QPoint()).x() - run_time.mapToGlobal(QPoint(run_time.width(), 0)).x()
            self.assertGreaterEqual(between, basic.em(), "the two times are not read as one")
            self.assertEqual(scores.verticalScrollBar().value(), 0)
            wait_until(lambda: scores.viewport().height() >= self.height_of_the_whole_run(scores),
                       lambda size=size: f"at {size}, the values of the whole run are in sight: "
                       f"{scores.viewport().height()} of {self.height_of_the_whole_run(scores)}")

    @staticmethod
    def height_of_the_whole_run(scores) -> int:
        """The height of the title and of the values of the whole run."""
        before, _, _ = scores.text.text().partition("<b>waypoint 1</b>")
        whole = QLabel(before.rpartition("<tr>")[0] + "</table>", wordWrap=True)
        whole.setFont(scores.text.font())
        whole.setTextFormat(Qt.RichText)
        return whole.heightForWidth(scores.viewport().width())
