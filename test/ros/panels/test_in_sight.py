"""What a referee must see during a run, at each size of the window."""

import os

from support.gui_testing import QWidget, click, wait_until
from support.panel_case import BUMPS
from support.window_case import WindowCase, in_sight, wait_still

from roah_rsbb.core.scoring.sheet import Mark
from roah_rsbb.msg import RunClock
from roah_rsbb.rqt.qt import QScrollArea

PERSON = ("Disqualifying behaviours", "Hits Annie or another person")
# Qt's scale factor is that of the process: in_sight.test starts these cases with 1 and with 2.
SCALE = int(os.environ.get("QT_SCALE_FACTOR", "1"))
SIZES = {1: ((1366, 768), (1920, 1080), (2560, 1440)), 2: ((2560, 1440), (3840, 2160))}[SCALE]
if "LC_MESSAGES" in os.environ:  # in another language: where space is shortest
    SIZES = SIZES[:1]


class TestInSight(WindowCase):
    """All that counts during a run."""

    def at_all_sizes(self):
        for size in SIZES:
            self.window.resize(*(length // SCALE for length in size))
            wait_still(self.window)
            yield size

    def assert_in_sight(self, size, **widgets: QWidget) -> None:
        """Wait until they are: a layout follows a message or another size in several steps."""
        def cut():
            return [name for name, widget in widgets.items() if not in_sight(widget)]

        wait_until(lambda: not cut(), lambda: f"at {size[0]}x{size[1]}, scale {SCALE}, all is in sight but {cut()}")

    def test_every_item_and_every_command_is_in_sight_during_the_run(self) -> None:
        self.window.resize(*(length // SCALE for length in SIZES[0]))
        wait_still(self.window)
        self.run_zone()
        for number in range(7):
            self.zone.mark(Mark(*BUMPS, number + 1, note=str(number)), "Anna")
        wait_until(lambda: len(self.scoring.undo.buttons) == 5, "the last five marks are shown")
        self.zone.goal = RunClock(goal=1)
        wait_until(self.control.times.goal.isVisible, "the goal's time is shown")
        for size in self.at_all_sizes():
            parts = {f"item {row.text.text()}": row for row in self.scoring.rows.values()}
            parts.update({f"buttons of {name}": row.menu_button for name, row in parts.items()})
            parts.update({f"undo {number}": button for number, button in enumerate(self.scoring.undo.buttons)})
            parts.update({f"command {name}": button for name, button in self.control.buttons.items()})
            overview = self.panel("OverviewPanel")
            self.assert_in_sight(
                size, stop_all=overview.stop, running=overview.head, phase=self.control._phase,
                run_time=self.control.times.main, goal_time=self.control.times.goal, reason=self.control.reason,
                zone=self.control._zones, referee=self.scoring.referee, answer=self.scoring._answer,
                history=self.scoring.history, **parts)
            self.assertEqual(len(self.scoring.rows), 9)

    def test_no_text_of_an_item_is_cut_off(self) -> None:
        self.run_zone()
        for size in self.at_all_sizes():
            for row in self.scoring.rows.values():
                needed = row.text.heightForWidth(row.text.width())
                self.assertGreaterEqual(row.text.height(), needed, f"{row.text.text()} at {size}")

    def test_disqualifying_items_do_not_scroll_away(self) -> None:
        self.run_zone()
        click(self.panel("OverviewPanel").toggle)
        wait_until(lambda: not self.panel("OverviewPanel").is_collapsed, "the overview is back")
        self.window.resize(1366 // SCALE, 700 // SCALE)
        wait_still(self.window)
        area = self.scoring.sheet.findChild(QScrollArea)
        bar = area.verticalScrollBar()
        for place in (bar.minimum(), bar.maximum()):
            bar.setValue(place)
            self.assertTrue(in_sight(self.scoring.rows[PERSON].more))
