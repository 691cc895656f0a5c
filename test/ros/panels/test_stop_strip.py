"""STOP in the window: one press stops, at each size, in each language, whatever is open and whatever has failed."""

import contextlib
import itertools
import os
from typing import Callable, Dict, Iterator, List, Optional, Tuple
from unittest import mock

from support.fakes.core import Asked
from support.gui_testing import (
    LONG_S,
    SCREEN,
    QApplication,
    QMessageBox,
    QPoint,
    QWidget,
    click,
    limit,
    places,
    question,
    settle,
    show,
    wait_until,
)
from support.real_input import Fingers, click_at, click_on, give_focus_away, held_at, press_key, right_click_at
from support.window_case import WindowCase, in_sight

from helpers import catalogues
from roah_rsbb.client import client
from roah_rsbb.rqt import calls, stop_strip, stop_window, stops
from roah_rsbb.rqt.keys import KeysPage
from roah_rsbb.rqt.panels.devices import DevicesPanel
from roah_rsbb.rqt.qt import (
    QComboBox,
    QDialog,
    QLineEdit,
    QMainWindow,
    QMenu,
    QRect,
    QSize,
    Qt,
    QTimer,
    QToolButton,
    QToolTip,
)
from roah_rsbb.rqt.stop_strip import LEAST_HIGH, LEAST_WIDE, StopStrip, clear_place
from roah_rsbb.wording import language, stop
from roah_rsbb.wording.language import read_texts, translation

ALL = os.environ.get("ROAH_TEST_ALL") == "yes"
SCALE = float(os.environ.get("QT_SCALE_FACTOR", "1"))
WHOLE_SCREEN = tuple(round(pixels / SCALE) for pixels in SCREEN)
# In logical pixels. In test-all, stop_strip.test also starts these cases at other scales, on a screen of 3840 x 2160.
SIZES = ((640, 400), (900, 500), (1024, 600), (1366, 768)) if SCALE == 1 else ((640, 400), (960, 540), (1280, 720))


def twice_as_long(text: str, _n: int) -> str:
    """A language whose texts are twice as long."""
    return f"{text} {text}"


GERMAN = translation("de", read_texts(catalogues.FOLDER / "de.ts"))
LANGUAGES: Dict[str, Optional[Callable[[str, int], str]]] = {
    "English": None, "German": GERMAN, "twice as long": twice_as_long}


class StripCase(WindowCase):
    """The window, and presses where STOP is drawn."""

    SPOKEN: Optional[Callable[[str, int], str]] = None
    SIZE = SIZES[-1]

    def setUp(self) -> None:
        limit(self, language, "_translate", self.SPOKEN)
        super().setUp()
        self.strip = self.window.strip
        self.stop = self.strip.stop

    def popup(self) -> QWidget:
        """The menu or list that is open, once the strip has seen it."""
        wait_until(lambda: self.client.keep_clear.popup is not None, "a menu or list is open")
        return self.client.keep_clear.popup

    def place(self, button: Optional[QWidget] = None) -> QPoint:
        """The middle of STOP, or of another button, on the screen."""
        button = self.stop if button is None else button
        return button.mapToGlobal(button.rect().center())

    def stops_of(self, zone: str) -> int:
        return self.core.calls.count(("stop_run", zone))

    def start(self, *zones: str) -> None:
        """Runs are in progress in these zones, or in the first one."""
        for zone in zones or ("Home A",):
            found = self.core.zones[zone]
            if found.phase == "ended":
                found.command("disconnect")
            if found.phase == "idle":
                found.command("connect", "start")
            wait_until(lambda zone=zone, found=found: zone in self.client.model.running_zones()
                       and self.client.model.identity_of(zone) == found.identity, "this run is in progress")

    def small_stop(self) -> stop_window.StopWindow:
        """Another program is in front, and the small STOP is on the screen."""
        give_focus_away()
        wait_until(self.client.stop_window.isVisible, "it is on the screen")
        return self.client.stop_window

    def shown(self, text: str) -> None:
        """The strip shows this of a STOP."""
        wait_until(lambda: text in self.strip.way.whole, lambda: f"'{text}' is shown, not '{self.strip.way.whole}'")

    def press_stop(self, zone: str = "Home A") -> None:
        """One click where STOP is drawn stops the run of that zone."""
        wait_until(self.stop.is_on, "STOP is live")
        before = self.stops_of(zone)
        click_at(self.place())
        wait_until(lambda: self.stops_of(zone) > before, lambda: f"{zone} is stopped by one click: {self.core.calls}")
        wait_until(lambda: self.core.zones[zone].phase == "ended", "the run has ended")

    def forget_stops(self) -> None:
        """It is so long ago that no STOP is shown any more."""
        def are_gone() -> bool:
            for one in self.client.stops.sent():
                one.until_mono = 0.0
            return not self.client.stops.sent()

        wait_until(are_gone, "no STOP is shown")

    def press_in_vain(self) -> None:
        """A click where STOP is drawn stops nothing, and the strip says why."""
        before = len(self.core.calls)
        self.strip.said = ("", 0.0)
        click_at(self.place())
        wait_until(lambda: self.strip.said[0] and self.strip.said[0] in self.strip.way.whole, "the strip says why")
        self.assertEqual(len(self.core.calls), before)


# -- the matrix: every size, every state, each language, few and many zones ------------------------------

class MatrixCase(StripCase):
    """In each state, a press where STOP is drawn stops the run, or the strip says why it cannot."""

    def _run(self) -> Iterator[str]:
        self.start()
        yield "Home A"

    def _no_run(self) -> Iterator[str]:
        if self.zone.phase != "idle":
            self.zone.command("disconnect")
        wait_until(lambda: not self.client.model.running_zones(), "no run is in progress")
        yield ""

    def _operation(self) -> Iterator[str]:
        self.start()
        self.zone.asked = Asked(1, "Open the door of the living room, then confirm it here", ("Opened", "Skip"))
        manual = self.panel("ManualOperationPanel")
        wait_until(lambda: manual.text.text().startswith("Open the door"), "the operation is asked for")
        yield "Home A"
        self.zone.asked = None

    def _timeout(self) -> Iterator[str]:
        self.start()
        self.zone.end("timeout")
        wait_until(lambda: not self.client.model.running_zones(), "the run is over")
        yield ""

    def _behind(self) -> Iterator[str]:
        self.window.docks[DevicesPanel.__name__].raise_()
        yield from self._timeout()
        self.window.docks["ScoringPanel"].raise_()

    def _list(self) -> Iterator[str]:
        self.start()
        self.control.zones.showPopup()
        self._wait_clear(self.popup())
        yield "Home A"
        self.assertIsNone(QApplication.activePopupWidget(), "the same click has closed the list")

    def _menu(self) -> Iterator[str]:
        self.start()
        menu = self.window.menuBar().actions()[0].menu()
        menu.popup(self.window.mapToGlobal(QPoint(10, 20)))
        self._wait_clear(self.popup())
        yield "Home A"
        self.assertFalse(menu.isVisible(), "the same click has closed the menu")

    def _question(self) -> Iterator[str]:
        self.start()
        wait_until(self.control.buttons["disconnect"].isEnabled, "disconnect is on")
        self.control.buttons["disconnect"].click()
        box = question()
        box.move(self.window.pos() + QPoint(0, self.window.height() - box.height()))  # over STOP
        self._wait_clear(box)
        yield "Home A"
        box.reject()

    def _dialog(self) -> Iterator[str]:
        self.start()
        self.client.keys.open_page()
        dialog = self.dialog(KeysPage)
        dialog.move(self.window.pos())
        self._wait_clear(dialog)
        yield "Home A"
        dialog.reject()

    def _silent(self) -> Iterator[str]:
        self.start()
        with mock.patch.object(client, "OLD_S", 0.0):
            self.client.model._tick()
            yield "Home A"

    STATES: Tuple[Callable[["MatrixCase"], Iterator[str]], ...] = (
        _run, _no_run, _operation, _timeout, _behind, _list, _menu, _question, _dialog, _silent)

    def _wait_clear(self, window: QWidget) -> None:
        wait_until(lambda: not window.frameGeometry().intersects(self.strip.on_screen()),
                   lambda: f"{window.frameGeometry()} is clear of {self.strip.on_screen()}")

    def check(self, size: Tuple[int, int], state: Callable[["MatrixCase"], Iterator[str]]) -> None:
        self.window.resize(*size)
        settle(self.window)
        with contextlib.contextmanager(state)(self) as zone:
            self.strip_is_in_its_place(size)
            if zone:
                self.press_stop(zone)
            else:
                self.press_in_vain()
        wait_until(lambda: not self.client.model.running_zones(), "the run is over")

    def strip_is_in_its_place(self, size: Tuple[int, int]) -> None:
        self.assertEqual((self.window.width(), self.window.height()), size)
        self.assertTrue(in_sight(self.stop) and in_sight(self.strip.stop_all), "both are in sight")
        self.assertGreaterEqual(self.stop.width(), LEAST_WIDE)
        self.assertGreaterEqual(self.stop.height(), LEAST_HIGH)
        corner = self.stop.mapTo(self.window, QPoint(0, self.stop.height()))
        self.assertEqual((corner.x(), size[1] - corner.y()), (2, 2))


def _matrix() -> Iterator[Tuple[str, type]]:
    """A class for each language and number of zones; `make test` tries each pair of a size and a state once."""
    zones = {1: ("Home A",), 4: ("Home A", "Home B", "Hall", "Kitchen"),
             12: ("Home A", *(f"Competition arena {number}" for number in range(2, 13)))}
    kinds = list(itertools.product(LANGUAGES, zones))
    pairs = list(itertools.product(SIZES, MatrixCase.STATES))
    for number, (spoken, count) in enumerate(kinds):
        some = pairs if ALL else pairs[number::len(kinds)]

        def test(self: MatrixCase, some: List[tuple] = some) -> None:
            for size, state in some:
                with self.subTest(size=size, state=state.__name__):
                    self.check(size, state)

        name = f"Test{spoken.title().replace(' ', '')}With{count}Zones"
        speaks = LANGUAGES[spoken]
        yield name, type(name, (MatrixCase,), {
            "ZONES": zones[count], "SPOKEN": None if speaks is None else staticmethod(speaks), "test_stop": test})


globals().update(_matrix())


class TestOpen(StripCase):
    """One press stops, whatever is open."""

    ZONES = ("Home A", "Home B", "Hall")

    def test_one_press_stops_with_each_list_and_menu_open(self) -> None:
        self.core.add_call("paired", lambda given, caller: {"devices": []})
        wait_until(self.control.pages.isEnabled, "the box's page can be opened")
        self.start()
        tried = 0
        for dock in self.window.docks.values():
            for number in range(4):
                self.start()
                openers = self.openers(dock)[number:]
                tried += bool(openers) and self.try_popup(openers[0])
        self.assertGreaterEqual(tried, 7)
        self.window.docks["ScoringPanel"].raise_()
        settle(self.window)
        self.try_context_menu(self.scoring.referee)

    def openers(self, dock: QWidget) -> List[QWidget]:
        """What opens a list or a menu in a panel."""
        dock.raise_()
        settle(self.window)
        found = [one for one in dock.findChildren((QComboBox, QToolButton)) if one.isEnabled() and in_sight(one)]
        return [one for one in found if isinstance(one, QComboBox) or one.menu() is not None]

    def try_popup(self, opener: QWidget) -> bool:
        def opened() -> None:
            click_at(opener.mapToGlobal(QPoint(opener.width() - 6, opener.height() // 2)))

        return self.try_open(opened)

    def try_context_menu(self, field: QLineEdit) -> None:
        self.start()
        self.assertTrue(self.try_open(lambda: right_click_at(self.place(field))))

    def try_open(self, opened: Callable[[], None]) -> bool:
        """Open it; an open menu has an event loop of its own, so a timer presses STOP. Returns whether it opened."""
        wait_until(self.stop.is_on, "STOP is live")
        before, seen, look = self.stops_of("Home A"), [], QTimer()

        def press() -> None:
            popup = self.client.keep_clear.popup
            if popup is not None and not popup.frameGeometry().intersects(self.strip.on_screen()):
                look.stop()
                seen.append(type(popup).__name__)
                QTimer.singleShot(0, lambda: click_at(self.place()))

        look.timeout.connect(press)
        look.start(20)
        opened()
        wait_until(lambda: self.stops_of("Home A") > before, f"one press stops with {seen} open")
        look.stop()
        self.assertIsNone(QApplication.activePopupWidget())
        wait_until(lambda: self.zone.phase == "ended", "the run has ended")
        return bool(seen)

    def test_a_menu_of_a_menu(self) -> None:
        self.start()
        menu = QMenu("a menu", self.window)
        for _ in range(3):
            inner = menu.addMenu("a menu of it")
            for number in range(40):
                inner.addAction(f"entry {number}")
        menu.popup(self.window.mapToGlobal(QPoint(10, 20)))
        self.popup()
        click_at(menu.mapToGlobal(menu.actionGeometry(inner.menuAction()).center()))
        wait_until(lambda: self.client.keep_clear.popup is inner, "the menu of the menu is open")
        wait_until(lambda: not inner.frameGeometry().intersects(self.strip.on_screen()), "it is clear of the strip")
        self.press_stop()
        self.assertFalse(menu.isVisible() or inner.isVisible())

    def test_a_tooltip_takes_no_press(self) -> None:
        self.start()
        QToolTip.showText(self.place(), f"<p>{'why ' * 300}</p>", self.control)
        tip = next(one for one in QApplication.topLevelWidgets() if one.inherits("QTipLabel") and one.isVisible())
        tip.move(self.window.mapToGlobal(QPoint(0, self.window.height() - tip.height())))
        self.assertTrue(tip.frameGeometry().contains(self.place()))
        wait_until(lambda: tip.windowHandle().flags() & Qt.WindowTransparentForInput, "it is seen")
        self.press_stop()

    def test_another_button_of_the_mouse_stops_nothing(self) -> None:
        self.start()
        for button in (2, 3):
            click_at(self.place(), button)
        self.control.zones.showPopup()
        self.popup()
        right_click_at(self.place())
        self.wait_heard()
        self.assertEqual(self.core.calls, [])

    def test_stop_all_can_be_held_with_a_list_open(self) -> None:
        self.start("Home A", "Home B")
        self.core.zones["Hall"].command("connect")  # a run that is only connected stays as it is
        self.control.zones.showPopup()
        self.popup()
        with held_at(self.place(self.strip.stop_all)):
            self.wait_call("stop_run", "Home A")
            self.wait_call("stop_run", "Home B")
        self.wait_answered()
        self.assertEqual(set(self.core.calls), {("stop_run", "Home A"), ("stop_run", "Home B")})

    def test_each_zone_that_could_not_be_stopped_is_named(self) -> None:
        self.start("Home A", "Home B")
        self.core.refuse = "the core has a cold"
        with held_at(self.place(self.strip.stop_all)):
            wait_until(lambda: "the core has a cold" in self.strip.way.whole and
                       "the core has a cold" in self.strip.others.whole, "both failures are shown")
        self.assertTrue(self.strip.stop_all.is_on())  # it may be tried again at once

    def test_a_short_press_on_stop_all_stops_nothing_and_says_how(self) -> None:
        self.start()
        wait_until(self.strip.stop_all.is_on, "STOP ALL is live")
        # A list takes the release: the button notices it when the time is over.
        for with_list, keep_ms in ((False, 3_600_000), (True, stop_strip.KEEP_MS)):
            limit(self, stop_strip, "KEEP_MS", keep_ms)
            self.strip.said = ("", 0.0)
            if with_list:
                self.control.zones.showPopup()
                self.popup()
            click_at(self.place(self.strip.stop_all))
            self.shown("hold the button down")
        self.assertEqual(self.core.calls, [])


class Unpaintable(QWidget):
    """A part of a panel that fails whenever it is drawn."""

    def __init__(self, panel: QWidget) -> None:
        super().__init__(panel)
        self.resize(20, 20)
        self.show()

    def paintEvent(self, event) -> None:
        raise RuntimeError("injected")


class TestFaults(StripCase):
    """Whatever else fails, STOP works, and the strip names the part."""

    ZONES = ("Home A", "Home B")

    def fails(self, *_: object) -> None:
        raise RuntimeError("injected")

    def stop_works(self, part: str) -> None:
        limit(self, stop_strip, "FAILURE_S", LONG_S)
        self.strip.failed = None
        self.start()
        self.press_stop()
        self.forget_stops()
        wait_until(lambda: part in self.strip.way.whole, lambda: f"{part} is named: {self.strip.way.whole}")

    def test_in_each_panel(self) -> None:
        for name, panel in self.window.panels.items():
            self.window.docks[name].raise_()
            for what in ("show_model", "where"):
                with self.subTest(panel=name, what=what), mock.patch.object(panel, what, self.fails):
                    self.stop_works(panel.TITLE)
            part = Unpaintable(panel)
            with self.subTest(panel=name, what="painted"):
                self.stop_works("Unpaintable")
            part.deleteLater()

    def test_in_what_the_strip_itself_shows_beside_stop(self) -> None:
        for what in ("_way", "_others"):
            with self.subTest(what=what), mock.patch.object(self.strip, what, self.fails):
                self.start()
                self.press_stop()
            wait_until(lambda: self.strip.failed is not None, "the fault is noticed")

    def test_in_the_translation(self) -> None:
        """The original fault: a German text had a place with the name of a parameter."""
        for broken in (self.fails, lambda text, n: "{missing}", lambda text, n: "{"):
            with mock.patch.object(language, "_translate", broken):
                self.start()
                self.press_stop()

        with mock.patch.object(language, "_translate", GERMAN):
            self.start()
            self.zone.asked = Asked(1, "Open {text} the door", ())
            self.wait_heard()
            self.press_stop()


class TestWay(StripCase):
    """How far a STOP came."""

    def test_to_the_robot(self) -> None:
        self.start()
        self.zone.not_stopped = ["mbot"]
        self.press_stop()
        self.shown("the box has it. Waiting for the robot")
        limit(self, stop, "NOT_DELIVERED_S", 0.0)
        self.shown("NO ANSWER FROM THE ROBOT. Stop it by hand")
        self.assertIn(stop_strip.basic.ALARM.background, self.strip.way.styleSheet())
        self.zone.not_stopped = []
        self.shown("the robot has stopped")
        self.forget_stops()

    def test_one_that_has_no_answer_does_not_hide_another(self) -> None:
        self.start("Home B")
        self.core.zones["Home B"].not_stopped = ["mbot"]
        limit(self, stop, "NOT_DELIVERED_S", 0.0)
        self.client.stops.stop(["Home B"])
        self.shown("STOP Home B: NO ANSWER FROM THE ROBOT")
        self.start("Home A")
        self.press_stop()
        said = "STOP Home A: the robot has stopped"
        wait_until(lambda: self.strip.others.whole.startswith(said), lambda: f"also: {self.strip.others.whole}")
        self.assertTrue(in_sight(self.strip.others))

    def test_of_a_run_that_somebody_else_stopped(self) -> None:
        """Each window names a robot that did not answer, also of a zone that it does not show."""
        self.start("Home B")
        self.core.zones["Home B"].not_stopped = ["mbot"]
        self.core.zones["Home B"].command("stop")
        wait_until(lambda: self.client.model.zone_of("Home B").phase == "ended", "the run has ended")
        self.assertEqual(self.client.stops.sent(), [], "it is not late yet")
        limit(self, stop, "NOT_DELIVERED_S", 0.0)
        self.shown("STOP Home B: NO ANSWER FROM THE ROBOT")
        give_focus_away()
        small = self.client.stop_window
        wait_until(lambda: small.isVisible() and small.ways["Home B"].text() == "NO ANSWER", "so does the small one")
        self.core.zones["Home B"].not_stopped = []
        self.shown("STOP Home B: the robot has stopped")
        self.core.zones["Home B"].command("disconnect")
        wait_until(lambda: not self.client.stops.sent(), "the run was left")
        self.assertEqual(self.core.calls, [])

    def test_in_a_narrow_window_it_is_brief_and_not_cut_off(self) -> None:
        limit(self, stop, "NOT_DELIVERED_S", 0.0)
        for zone in ("Home A", "Home B"):
            self.start(zone)
            self.core.zones[zone].not_stopped = ["mbot"]
        self.client.stops.stop(["Home A", "Home B"])
        for width, shown in ((480, "NO ANSWER, stop by"), (640, "NO ANSWER, stop by hand: Home A, Home B")):
            self.window.resize(width, 320)
            wait_until(lambda shown=shown: self.strip.way.text().startswith(shown),
                       lambda: f"shown: {self.strip.way.text()}")
            self.assertIn("STOP Home B: NO ANSWER FROM THE ROBOT", self.strip.way.whole)
            self.assertFalse(self.strip.others.isVisible())
        self.window.resize(*self.SIZE)
        wait_until(lambda: self.strip.way.text().startswith("STOP Home") and self.strip.others.isVisible(), "in full")

    def test_it_is_sent_until_the_box_answers(self) -> None:
        self.start()
        self.core.answer_gate.clear()
        limit(self, client, "STOP_S", 0.01)
        click_at(self.place())
        self.shown("sent")
        limit(self, stop, "NOT_DELIVERED_S", 0.0)
        self.shown("NOT DELIVERED. Stop the robot by hand")
        wait_until(lambda: self.stops_of("Home A") > 5, "it is sent again and again")
        self.core.answer_gate.set()
        self.shown("the robot has stopped")

    def test_calls_that_hang_end_and_no_press_is_ignored(self) -> None:
        self.start()
        self.core.answer_gate.clear()
        limit(self, calls, "TIMEOUT_S", 0.1)
        self.stop.pressed.emit()
        wait_until(lambda: self.stops_of("Home A") > 2, "a call that is not answered ends, and it is sent again")
        limit(self, calls, "TIMEOUT_S", LONG_S)
        before = self.stops_of("Home A")
        for _ in range(30):
            self.stop.pressed.emit()
        wait_until(lambda: self.stops_of("Home A") >= before + 30, lambda: f"each is sent: {self.stops_of('Home A')}")
        self.shown("sent")
        self.core.answer_gate.set()
        self.shown("the robot has stopped")

    def test_a_master_that_is_gone_keeps_no_stop(self) -> None:
        self.start()
        with mock.patch("xmlrpc.client.ServerProxy", side_effect=OSError):
            self.press_stop()

    def test_a_run_that_continues_raises_no_alarm(self) -> None:
        self.start()
        self.press_stop()
        self.shown("the robot has stopped")
        self.zone.command("start")
        wait_until(lambda: not self.client.stops.sent(), "nothing is shown of the STOP before")

    def test_what_the_box_refuses_is_shown_with_its_reason(self) -> None:
        self.start()
        self.core.refuse = "because of the test"
        click_at(self.place())
        self.shown("because of the test")

    def test_a_run_that_was_left_needs_no_words(self) -> None:
        self.start()
        self.zone.not_stopped = ["mbot"]
        self.press_stop()
        self.shown("Waiting for the robot")
        self.zone.command("disconnect")
        wait_until(lambda: not self.client.stops.sent(), "it is over")


class TestKeys(StripCase):
    """Esc stops what STOP names."""

    ZONES = ("Home A", "Home B", "Hall")

    def esc_twice(self) -> None:
        for _ in range(2):
            press_key("Escape")

    def test_esc_stops_the_only_run_while_another_zone_is_shown(self) -> None:
        self.start("Home B")
        self.client.model.choose_zone("Hall")
        wait_until(lambda: self.stop.zone == "Home B", lambda: f"STOP names it in large letters: {self.stop.zone}")
        said = "STOP and Esc stop Home B, the only run. You see Hall"
        wait_until(lambda: self.strip.way.whole == said, lambda: f"the line says so: {self.strip.way.whole}")
        self.esc_twice()
        self.wait_call("stop_run", "Home B")

    def test_space_and_enter_press_stop_where_it_has_the_focus(self) -> None:
        for key in ("space", "Return", "KP_Enter"):
            self.start()
            self.stop.setFocus(Qt.TabFocusReason)
            before = self.stops_of("Home A")
            press_key(key)
            wait_until(lambda before=before: self.stops_of("Home A") > before, f"{key} stops")
            wait_until(lambda: self.zone.phase == "ended", "the run has ended")

    def test_of_several_runs_it_stops_that_of_the_zone_shown(self) -> None:
        self.start("Home A", "Home B")
        self.client.model.choose_zone("Home B")
        wait_until(lambda: self.stop.hint == "Esc twice: Home B", lambda: f"STOP names it: {self.stop.hint}")
        self.esc_twice()
        self.wait_call("stop_run", "Home B")
        self.assertEqual(self.stops_of("Home A"), 0)

    def test_who_presses_twice_stops_no_other_zone(self) -> None:
        self.start("Home A", "Hall")
        self.client.model.choose_zone("Hall")
        limit(self, stops, "SAME_S", 3_600.0)
        self.press_stop("Hall")
        wait_until(lambda: self.client.model.running_zones() == ["Home A"], "one run is left")
        before = self.stops_of("Hall")
        click_at(self.place())
        self.esc_twice()
        wait_until(lambda: self.stops_of("Hall") == before + 2, "the same zone is stopped again")
        self.assertEqual(self.stops_of("Home A"), 0)
        limit(self, stops, "SAME_S", 0.0)
        wait_until(lambda: self.stop.zone == "Home A", "then STOP names the only run")
        self.press_stop("Home A")

    def test_if_it_stops_none_of_several_runs_it_says_why(self) -> None:
        self.start("Home A", "Home B")
        self.client.model.choose_zone("Hall")
        wait_until(lambda: not self.stop.is_on(), "STOP stops nothing")
        press_key("Escape")
        self.wait_prompt("Nothing is running in Hall. Running: Home A, Home B")
        self.press_in_vain()


class TestOthers(StripCase):
    """What happens elsewhere."""

    ZONES = ("Home A", "Home B", "Hall")

    def test_other_zones_that_need_the_referee_are_named_while_one_is_scored(self) -> None:
        self.window.resize(900, 500)
        self.run_zone("Home A")
        self.core.zones["Hall"].warnings = ["The setup time of 1 minute is over"]
        self.start("Home B")
        self.core.zones["Home B"].asked = Asked(1, "Open the door")
        said = "☛ Home B: Open the door   ⚠ Hall: The setup time of 1 minute is over"
        wait_until(lambda: self.strip.others.whole == said,
                   lambda: f"both are named: {self.strip.others.whole}")
        self.assertTrue(in_sight(self.strip.others))

    def test_while_another_program_is_in_front_a_small_stop_stays_on_the_screen(self) -> None:
        self.start("Home A", "Home B")
        small, title = self.client.stop_window, self.window.windowTitle()
        self.assertFalse(small.isVisible())
        give_focus_away()
        wait_until(small.isVisible, "it is on the screen")
        wait_until(lambda: self.window.windowTitle() == f"Esc is off: click here first – {title}", "the title says so")
        wait_until(lambda: self.stop.hint == "Home A · Esc is off here", "STOP says so, too")
        self.assertEqual([(zone, one.zone) for zone, one in small.buttons.items()],
                         [("Home A", "Home A"), ("Home B", "Home B")])
        click_on(small.buttons["Home B"])
        self.wait_call("stop_run", "Home B")
        self.assertEqual(self.stops_of("Home A"), 0)
        wait_until(lambda: [zone for zone, one in small.buttons.items() if one.is_on()] == ["Home A"],
                   "one run is left")
        self.window.activateWindow()
        wait_until(lambda: not small.isVisible(), "it is gone when the window is in front again")
        self.assertEqual(self.window.windowTitle(), title)

    def test_a_small_stop_that_was_closed_comes_back_for_another_run(self) -> None:
        self.start("Home A")
        small = self.small_stop()
        limit(self, stop_window, "GOES_MS", 0)
        click_on(small.close_button)
        wait_until(lambda: not small.isVisible(), "it is closed")
        self.run_zone("Hall")
        wait_until(small.isVisible, "it is there again")

    def test_at_the_place_of_a_small_stop_there_is_never_another_one(self) -> None:
        self.start("Home B", "Home A")
        small = self.small_stop()

        def places() -> Dict[str, QRect]:
            return {zone: QRect(one.mapToGlobal(QPoint()), one.size()) for zone, one in small.buttons.items()}

        before = places()
        place = before["Home A"].center()
        self.assertLess(place.x(), before["Home B"].center().x(), "in the order of the zones")
        for presses in (1, 2):
            click_at(place)
            wait_until(lambda presses=presses: self.stops_of("Home A") == presses, "each press is for this zone")
        wait_until(lambda: not small.buttons["Home A"].is_on() and all(one.is_done for one in self.client.stops.sent()),
                   "its run has ended")
        self.assertEqual(places(), before)
        self.forget_stops()
        wait_until(lambda: places() == {"Home B": before["Home B"]}, "nothing moves to the place that is free")
        click_at(place)
        self.start("Hall")
        self.start("Home A")
        wait_until(lambda: {zone: where for zone, where in places().items() if zone != "Hall"} == before,
                   lambda: f"each has its place again: {places()}")
        self.assertEqual((self.stops_of("Home A"), self.stops_of("Home B")), (2, 0))

    def test_a_stop_without_an_answer_stays_in_sight(self) -> None:
        """Also if the window was in front meanwhile."""
        self.start()
        self.zone.not_stopped = ["mbot"]
        limit(self, stop, "NOT_DELIVERED_S", 0.0)
        self.press_stop()
        wait_until(lambda: "NO ANSWER" in self.strip.way.whole, "there is no answer")
        small = self.client.stop_window
        self.assertFalse(small.isVisible())
        give_focus_away()
        wait_until(lambda: small.isVisible() and "NO ANSWER" in small.heading.whole, "it says so above all windows")

    def test_the_small_stop_is_not_over_the_stop_of_the_window(self) -> None:
        """It may name another zone at the same place."""
        self.window.resize(*WHOLE_SCREEN)
        self.start("Home A", "Home B")
        self.client.model.choose_zone("Home B")
        self.small_stop()
        self.press_stop("Home B")
        self.assertEqual(self.stops_of("Home A"), 0)

    def test_the_small_stop_shows_how_far_a_stop_came(self) -> None:
        self.start()
        small = self.small_stop()
        self.assertEqual(small.heading.whole, "RSBB: runs in progress")
        self.core.answer_gate.clear()
        self.hush()
        before = places(small)
        click_on(small.buttons["Home A"])
        wait_until(lambda: "sent" in small.heading.whole, "it is sent")
        limit(self, stop, "NOT_DELIVERED_S", 0.0)
        wait_until(lambda: "NOT DELIVERED. Stop the robot by hand" in small.heading.whole, "it is not delivered")
        self.assertIn(stop_strip.basic.ALARM.background, small.heading.styleSheet())
        self.assertEqual(places(small), before)
        self.core.silent = False
        self.core.answer_gate.set()
        wait_until(lambda: "the robot has stopped" in small.heading.whole, "it is delivered")
        self.assertTrue(small.isVisible() and not any(one.is_on() for one in small.buttons.values()))
        self.forget_stops()
        wait_until(lambda: small.heading.whole == "RSBB: no run is in progress", "nothing is left to say")
        self.assertTrue(small.isVisible(), "it does not go under a hand")

    def click_where_start_is(self, small: QWidget, part: QWidget) -> Callable[[], None]:
        """Move the small STOP, with a part of it over START. Returns what clicks there."""
        wait_until(self.control.buttons["start"].isEnabled, "the run can be continued")
        place = self.place(self.control.buttons["start"])
        small.move(small.pos() + place - self.place(part))
        wait_until(lambda: self.place(part) == place, "it is there")
        return lambda: click_at(place)

    def test_who_clicks_the_small_stop_twice_does_not_hit_what_is_behind_it(self) -> None:
        """Neither when it was closed, nor when the window has come to the front."""
        limit(self, stop_window, "GOES_MS", 3_600_000)
        small = self.client.stop_window
        for goes in ("closed", "in front"):
            with self.subTest(goes=goes):
                limit(self, stop_window, "GOES_MS", 3_600_000)
                self.start()
                give_focus_away()
                wait_until(small.isVisible, "it is on the screen")
                click_on(small.buttons["Home A"])
                wait_until(lambda: self.zone.phase == "ended", "the run is over")
                calls_before = len(self.core.calls)
                if goes == "closed":
                    click_there = self.click_where_start_is(small, small.close_button)
                    click_there()
                else:
                    click_there = self.click_where_start_is(small, small.heading)
                    self.window.activateWindow()
                    wait_until(lambda: QApplication.applicationState() == Qt.ApplicationActive, "it is in front")
                for _ in range(3):
                    click_there()
                    self.wait_heard()
                self.assertEqual(self.core.calls[calls_before:], [])
                self.assertEqual(small.heading.whole, "This STOP closes …")
                limit(self, stop_window, "GOES_MS", 0)
                click_there()
                wait_until(lambda: not small.isVisible(), "then it is gone")
                click_there()
                self.wait_call("start", "Home A")
                self.window.activateWindow()
                wait_until(lambda: QApplication.applicationState() == Qt.ApplicationActive, "the window is in front")
                self.press_stop()
                self.forget_stops()

    def test_the_small_stop_shows_the_way_of_each_zone_and_stays_while_a_robot_has_not_stopped(self) -> None:
        self.start("Home A", "Home B")
        self.core.zones["Home B"].not_stopped = ["mbot"]
        small = self.small_stop()
        before = places(small)
        limit(self, stop, "NOT_DELIVERED_S", 0.0)
        self.core.answer_gate.clear()
        self.hush()
        for zone in ("Home B", "Home A"):
            click_on(small.buttons[zone])

        def ways() -> Dict[str, str]:
            return {zone: label.whole for zone, label in small.ways.items()}

        wait_until(lambda: ways() == {"Home A": "NOT DELIVERED", "Home B": "NOT DELIVERED"}, "both are lost")
        self.core.silent = False
        self.core.answer_gate.set()
        wait_until(lambda: ways() == {"Home A": "has stopped", "Home B": "NO ANSWER"}, lambda: f"each way: {ways()}")
        self.assertIn("STOP Home B: NO ANSWER FROM THE ROBOT", small.heading.whole)
        self.assertIn(stop_strip.basic.DONE.background, small.ways["Home A"].styleSheet())
        self.assertIn(stop_strip.basic.ALARM.background, small.ways["Home B"].styleSheet())
        self.assertEqual(places(small), before)
        limit(self, stop_window, "GOES_MS", 0)
        click_at(self.place(small.close_button))
        self.wait_heard()
        self.assertTrue(small.isVisible() and not small.close_button.isEnabled())
        self.core.zones["Home B"].not_stopped = []
        wait_until(small.close_button.isEnabled, "it can be closed")
        click_on(small.close_button)
        wait_until(lambda: not small.isVisible(), "it is closed")

    def test_a_small_stop_that_was_closed_comes_back_if_the_robot_does_not_answer(self) -> None:
        self.start()
        self.zone.not_stopped = ["mbot"]
        small = self.small_stop()
        click_on(small.buttons["Home A"])
        limit(self, stop_window, "GOES_MS", 0)
        limit(self, stop, "NOT_DELIVERED_S", 3600.0)
        click_on(small.close_button)
        wait_until(lambda: not small.isVisible(), "it is closed")
        limit(self, stop, "NOT_DELIVERED_S", 0.0)
        wait_until(lambda: small.isVisible() and small.ways["Home A"].whole == "NO ANSWER", "it is there again")

    def test_where_another_box_has_taken_over_stop_is_grey_and_says_why(self) -> None:
        self.start()
        self.core.superseded_by = "10.0.0.9"
        wait_until(lambda: not self.stop.is_on(), "STOP stops nothing")
        self.assertFalse(self.strip.stop_all.is_on())
        for keys in (("Escape",), ("Escape", "Shift_L")):
            for _ in range(2):
                press_key(*keys)
            self.wait_prompt("Another box has taken over")
        self.press_in_vain()
        self.assertIn("Another box has taken over", self.strip.way.whole)
        give_focus_away()
        wait_until(lambda: QApplication.applicationState() != Qt.ApplicationActive, "another program is in front")
        self.assertFalse(self.client.stop_window.isVisible())


class TestTouch(StripCase):
    """Fingers, with the touch events that Qt's part for X11 reports."""

    ZONES = ("Home A", "Home B")

    def setUp(self) -> None:
        super().setUp()
        self.fingers = Fingers(self.window)

    def inside(self, widget: QWidget) -> QPoint:
        return widget.mapTo(self.window, widget.rect().center())

    def test_stop_acts_when_it_is_touched(self) -> None:
        self.start()
        self.fingers.put_down(0, self.inside(self.stop))
        self.wait_call("stop_run", "Home A")
        self.fingers.lift(0)
        self.assertFalse(self.stop.isDown())

    def test_a_finger_elsewhere_does_not_keep_stop(self) -> None:
        beside_stop = self.inside(self.stop) - QPoint(self.stop.width() // 2 + 1, 0)
        at_the_edge = QPoint(1, self.window.height() // 2)
        for place in QPoint(200, 500), self.inside(self.control.zones), at_the_edge, beside_stop:
            with self.subTest(place):
                self.start()
                before = self.stops_of("Home A")
                self.fingers.put_down(0, place)
                self.fingers.put_down(1, self.inside(self.stop))
                wait_until(lambda: self.stops_of("Home A") > before, "the run is stopped")  # noqa: B023
                self.fingers.lift(1)
                self.fingers.lift(0)
                self.assertFalse(self.stop.isDown())
                self.assertEqual(self.stops_of("Home A"), before + 1)

    def test_stop_all_is_held_by_a_finger_while_another_has_a_list_open(self) -> None:
        self.start("Home A", "Home B")
        wait_until(self.strip.stop_all.is_on, "STOP ALL is live")
        self.fingers.put_down(0, self.inside(self.control.zones))
        self.popup()
        self.fingers.put_down(1, self.inside(self.strip.stop_all))
        self.fingers.lift(1)
        wait_until(lambda: "hold the button down" in self.strip.way.whole, "a tap stops nothing")
        self.assertEqual(self.core.calls, [])
        self.fingers.put_down(1, self.inside(self.strip.stop_all))
        self.wait_call("stop_run", "Home A")
        self.wait_call("stop_run", "Home B")

    def test_stop_all_is_held_by_a_finger(self) -> None:
        self.start("Home A", "Home B")
        wait_until(self.strip.stop_all.is_on, "STOP ALL is live")
        self.fingers.put_down(0, self.inside(self.strip.stop_all))
        self.fingers.lift(0)
        wait_until(lambda: "hold the button down" in self.strip.way.whole, "a tap stops nothing")
        self.assertEqual(self.core.calls, [])
        self.fingers.put_down(1, self.inside(self.strip.stop_all))
        self.wait_call("stop_run", "Home A")
        self.wait_call("stop_run", "Home B")

    def test_a_touch_that_an_open_list_gets_is_stop(self) -> None:
        self.start()
        click_on(self.control.zones)
        window = self.popup().window()
        Fingers(window).put_down(0, window.mapFromGlobal(self.place()))
        self.wait_call("stop_run", "Home A")
        self.assertFalse(window.isVisible())

    def test_a_touch_in_a_window_that_is_not_watched_yet(self) -> None:
        self.start("Home A", "Home B")
        wait_until(self.strip.stop_all.is_on, "STOP ALL is live")
        self.client.keep_clear.end()
        self.window.windowHandle().removeEventFilter(self.client.keep_clear)
        self.fingers.put_down(0, self.inside(self.stop))
        self.wait_call("stop_run", "Home A")
        self.fingers.lift(0)
        self.assertFalse(self.stop.isDown())
        self.fingers.put_down(0, self.inside(self.strip.stop_all))
        self.wait_call("stop_run", "Home B")

    def test_a_touch_on_the_small_stop(self) -> None:
        self.start()
        small = self.small_stop()
        settle(small)
        button = small.buttons["Home A"]
        Fingers(small).put_down(0, button.mapTo(small, button.rect().center()))
        self.wait_call("stop_run", "Home A")

    def test_a_hand_beside_stop_is_stop(self) -> None:
        self.start()
        place = self.inside(self.strip)
        for number in range(2):
            self.fingers.put_down(number, place + QPoint(30 * number, 0))
        self.wait_heard()
        self.assertEqual(self.core.calls, [])
        self.fingers.put_down(2, place + QPoint(60, 0))
        self.wait_call("stop_run", "Home A")


class TestDialogs(StripCase):
    """No dialog covers STOP."""

    def test_a_modal_dialog_of_others_blocks_everything_but_stop(self) -> None:
        self.start()
        for close in (QDialog.reject, QDialog.deleteLater):
            self.start()
            others = QDialog(self.window)
            others.setModal(True)
            others.resize(200, 100)
            others.show()
            others.move(self.window.pos() + QPoint(400, 50))
            wait_until(lambda: len(StopStrip.shown) == 2, "a strip stands in for the blocked one")
            settle(self.window)
            self.press_stop()
            self.assertTrue(others.isVisible())
            close(others)
            wait_until(lambda: StopStrip.shown == [self.strip], "it is gone")
        self.start()
        self.press_stop()

    def test_nor_does_a_panel_that_floats(self) -> None:
        self.start()
        dock = self.window.docks["DevicesPanel"]
        dock.setFloating(True)
        dock.resize(400, 300)
        wait_until(dock.isVisible, "it floats")
        dock.move(self.window.pos() + QPoint(0, self.window.height() - 200))
        wait_until(lambda: not dock.frameGeometry().intersects(self.strip.on_screen()), "it is clear of the strip")
        self.assertTrue(dock.isFloating())
        self.press_stop()

    def test_a_dialog_that_is_moved_over_stop_is_moved_back(self) -> None:
        self.start()
        click(self.control.buttons["disconnect"])
        box = self.dialog(QMessageBox)
        box.move(self.window.pos() + QPoint(20, self.window.height() - box.height()))
        wait_until(lambda: not box.frameGeometry().intersects(self.strip.on_screen()), "it is clear of the strip")
        self.press_stop()
        self.assertTrue(box.isVisible())

    def test_the_nearest_place_is_chosen_and_the_size_bounded(self) -> None:
        screen, strip = QRect(0, 0, 640, 400), QRect(0, 340, 640, 60)
        self.assertEqual(clear_place(QRect(10, 10, 300, 200), [strip], screen), QRect(10, 10, 300, 200))
        self.assertEqual(clear_place(QRect(10, 200, 300, 200), [strip], screen), QRect(10, 140, 300, 200))
        self.assertEqual(clear_place(QRect(10, 0, 300, 390), [strip], screen), QRect(10, 0, 300, 340))
        at_the_top = QRect(0, 40, 640, 60)
        self.assertEqual(clear_place(QRect(10, 50, 300, 200), [at_the_top], screen), QRect(10, 100, 300, 200))


class TestSinglePanel(StripCase):
    """A panel in a window of its own."""

    def test_it_has_the_strip(self) -> None:
        window = QMainWindow()
        self.addCleanup(window.close)
        window.setCentralWidget(DevicesPanel(self.client))
        strip = self.client.add_strip(window)
        self.addCleanup(window.centralWidget().shutdown)
        self.assertIs(self.client.add_strip(window), strip)
        show(window, 400, 300)
        self.start()
        wait_until(strip.stop.is_on, "STOP is live")
        settle(window)
        before = places(strip.stop)
        click_on(strip.stop)
        self.wait_call("stop_run", "Home A")
        self.assertEqual(places(strip.stop), before)


class TestTooSmall(StripCase):
    """The window does not become too small for STOP, and says so."""

    def test_it_says_so(self) -> None:
        self.start()
        for size in ((1, self.window.height()), (self.window.width(), 1)):
            self.window.resize(*SIZES[1])
            settle(self.window)
            self.strip.said = ("", 0.0)
            self.window.resize(*size)
            wait_until(lambda: "The window cannot be smaller" in self.strip.way.whole, "it says why")
        self.assertTrue(in_sight(self.stop) and in_sight(self.strip.stop_all))

    def test_stop_remains_in_a_window_that_the_desktop_forces_to_be_smaller(self) -> None:
        self.start()
        self.window.windowHandle().setMinimumSize(QSize(0, 0))
        self.window.setMinimumSize(QSize(1, 1))
        self.window.resize(280, 160)
        wait_until(lambda: self.window.width() == 280, "it is small")
        settle(self.window)
        self.assertTrue(in_sight(self.stop))
        self.assertEqual(self.window.childAt(self.stop.mapTo(self.window, self.stop.rect().bottomRight())), self.stop)
        self.press_stop()


class TestSmallPrint(StripCase):
    """What can be read."""

    ZONES = ("Home A", *(f"Competition arena {number}" for number in range(2, 13)))

    def test_no_text_is_smaller_than_9_pt(self) -> None:
        self.window.resize(1024, 600)
        self.run_zone()
        small = {f"{type(one).__name__} {getattr(one, 'text', str)()}": one.font().pointSizeF()
                 for one in self.window.findChildren(QWidget)
                 if one.isVisible() and 0 < one.font().pointSizeF() < stop_strip.basic.LEAST_PT}
        self.assertEqual(small, {})

    def test_red_is_the_colour_of_stop_alone(self) -> None:
        self.start()
        self.zone.asked = Asked(1, "Open the door")
        self.core.box_warnings = ["ANOTHER RSBB"]
        self.core.refuse = "because of the test"
        click(self.scoring.rows[next(iter(self.scoring.rows))].toggle)
        self.wait_quiet()
        red = stop_strip.basic.STOP.background
        found = [one for one in self.window.findChildren(QWidget) if red in one.styleSheet()]
        self.assertEqual(found, [])  # STOP and STOP ALL draw themselves
        image = self.window.grab().toImage()
        ratio = image.devicePixelRatio()
        for button in (self.stop, self.strip.stop_all):
            place = button.mapTo(self.window, QPoint(6, 6)) * ratio
            self.assertEqual(image.pixelColor(place).name(), red)

    def test_stop_and_stop_all_look_alike_where_they_stop_nothing(self) -> None:
        wait_until(lambda: not self.stop.is_on() and not self.strip.stop_all.is_on(), "no run is in progress")
        image = self.window.grab().toImage()
        colours = {image.pixelColor(button.mapTo(self.window, QPoint(6, 6)) * image.devicePixelRatio()).name()
                   for button in (self.stop, self.strip.stop_all)}
        self.assertEqual(colours, {stop_strip.basic.IDLE.background})

    def test_the_end_of_a_long_name_can_be_read(self) -> None:
        with mock.patch.object(stop_strip.QPainter, "drawText") as drawn:
            self.stop.show_target(True, zone="Competition arena number 12")
            self.stop.repaint()
        shown = [call[0][2] for call in drawn.call_args_list]
        self.assertTrue(any(text.endswith("12") for text in shown), shown)
