"""The base of all panels: a line with the zone and whether the state is current, and the panel's own widgets.

`CollapsingPanel` is the base of those that leave their space to Scoring while a run of the zone is scored, on small
screens. They collapse to one visible line when the run starts, and expand when it is disconnected. A button in that
line expands them earlier. It works in rqt as in our window: a dock with a small maximum height leaves its space to the
others.
"""

import contextlib
from typing import List, Optional, Tuple

from roah_rsbb.model.zone import ENDED, IDLE, RUNNING
from roah_rsbb.rqt import basic, process
from roah_rsbb.rqt.calls import CallOutcome, Done
from roah_rsbb.rqt.client import RefereeClient
from roah_rsbb.rqt.model import same
from roah_rsbb.rqt.qt import (
    QApplication,
    QDockWidget,
    QHBoxLayout,
    QLabel,
    QMainWindow,
    QScrollArea,
    QSize,
    QSizePolicy,
    Qt,
    QTimer,
    QToolButton,
    QVBoxLayout,
    QWidget,
)
from roah_rsbb.wording import sheets, times, whole_box
from roah_rsbb.wording.language import tr, tr_later
from roah_rsbb.wording.whole_box import REPLAY_NOT_LIVE

SILENT = tr_later("The box is silent: this is its last known state")
# Narrow: the STOP strip takes its height from the panels. In pixels: left, top, right, bottom.
MARGINS = (6, 2, 6, 2)
# Below this size, in units of the desktop's font, a panel does not shrink.
LEAST_WIDE_EMS, LEAST_HIGH_EMS = 8.0, 2.0
# More than all panels of a window have.
MOST_CONTROLS = 1000


class _Body(QVBoxLayout):
    """The layout of a panel. Its parts shrink to their least height before the panel scrolls."""

    _is_asking = False

    def heightForWidth(self, width: int) -> int:
        if self._is_asking:  # Qt's answer to the question below asks this one
            return super().heightForWidth(width)
        self._is_asking = True
        try:
            return self.minimumHeightForWidth(width)
        finally:
            self._is_asking = False


class PanelArea(QScrollArea):
    """What a panel shows below its heading. It scrolls in a window that is too small, so that every window can be as
    small as its STOP strip."""

    def __init__(self, content: QWidget) -> None:
        super().__init__(widgetResizable=True)
        self.setFrameShape(QScrollArea.NoFrame)
        self.setFocusPolicy(Qt.NoFocus)
        self.setWidget(content)

    def sizeHint(self) -> QSize:
        return self.widget().sizeHint()

    def minimumSizeHint(self) -> QSize:
        least = QSize(round(LEAST_WIDE_EMS * basic.em()), round(LEAST_HIGH_EMS * basic.em()))
        return self.widget().minimumSizeHint().boundedTo(least)


class Panel(QWidget):
    """Base of all panels. A subclass fills `self.body` and implements `show_model`, `PARTS` and `show_times`.

    `show_model` is called when a part changed while the panel is visible, and when it becomes visible. `show_times` is
    called after it, and a few times a second.
    """

    TITLE = ""
    TAB = ""  # a shorter title for the tabs of our window; empty: the title
    WHERE = ""  # the heading of a panel that shows no zone
    WHERE_FACTOR = basic.TEXT
    PARTS: Tuple[str, ...] = ("zone",)  # what it shows: the zone, and fields of the document
    # Whether both are also called while the panel is behind others: it beeps there, has keys that work
    # everywhere, or keeps what it shows.
    WORKS_BEHIND = False

    def __init__(self, client: RefereeClient) -> None:
        super().__init__()
        self.client = client
        self.model = client.model
        self._docks: List[QDockWidget] = []  # that the panel is in, or was
        self._has_ended = False
        self._drawn: tuple = ()  # the parts that are shown
        self._left: Optional[QWidget] = None  # the control that was switched off while it had the focus
        self.setObjectName(type(self).__name__)
        self.setWindowTitle(tr(self.TITLE))
        self._where = basic.enlarged(basic.ShortenedLabel(), self.WHERE_FACTOR, bold=True)
        self._where.setSizePolicy(QSizePolicy.Ignored, QSizePolicy.Preferred)
        self.news = basic.Badge()
        self._title = basic.MarkedTitle(self)
        self.heading = QHBoxLayout()
        self.heading.addWidget(self._where, 1)
        self.heading.addWidget(self.news)
        self.content = QWidget()
        self.body = _Body(self.content)
        self.body.setContentsMargins(0, 0, 0, 0)
        self.area = PanelArea(self.content)
        outer = QVBoxLayout(self)
        outer.setContentsMargins(*MARGINS)
        outer.setSpacing(MARGINS[1])
        outer.addLayout(self.heading)
        outer.addWidget(self.area, 1)
        self.foot = QVBoxLayout()  # what does not scroll away
        outer.addLayout(self.foot)
        self.model.updated.connect(self._on_update)
        self.model.ticked.connect(self._on_tick)

    def show_model(self) -> None:
        """Show the state of the model."""
        raise NotImplementedError

    def parts(self) -> tuple:
        """Return what the panel shows of the model, beside the box, its age and the name of the zone. It is drawn again
        when a part is another object."""
        document = self.model.document
        return tuple(self.model.zone if name == "zone" else document and getattr(document, name) for name in self.PARTS)

    def show_times(self) -> None:
        """Show what changes while only time passes."""

    def watch(self) -> None:
        """Do what must be done at each news and moment, even while the panel is hidden."""

    def where(self) -> str:
        """Return the panel's heading: its zone, and the event there."""
        if self.WHERE:
            return tr(self.WHERE)
        zone = self.model.zone
        if zone is None:
            return self.model.zone_name
        event = zone.event
        return f"{zone.zone}  ·  {event.code}  ·  {event.team}  ·  {sheets.turn(event.round, event.run)}"

    def where_tip(self) -> str:
        """Return the tooltip of the heading."""
        return ""

    def shutdown(self) -> None:
        """Stop: no more updates or answers reach this panel."""
        self._has_ended = True
        self.model.updated.disconnect(self._on_update)
        self.model.ticked.disconnect(self._on_tick)
        self.client.calls.forget(self)

    def save_settings(self, settings) -> None:
        """Save the referee's settings of this panel; `settings` has `set_value(key, value)`."""

    def restore_settings(self, settings) -> None:
        """Restore what `save_settings` saved; `settings` has `value(key, default)`."""

    def showEvent(self, event) -> None:
        super().showEvent(event)
        self._follow_docks()
        self.redraw()

    def _follow_docks(self) -> None:
        """Follow the docks that the panel is in. Qt does not hide a dock behind another tab, but moves it away, so that
        the panel gets no event when it comes to the front."""
        widget = self.parentWidget()
        while widget is not None:
            if isinstance(widget, QDockWidget) and widget not in self._docks:
                widget.visibilityChanged.connect(self._on_dock)
                self._docks.append(widget)
            widget = widget.parentWidget()

    def _on_dock(self, is_visible: bool) -> None:
        if is_visible:
            self.redraw()

    def focusNextPrevChild(self, forward: bool) -> bool:
        """Tab skips panels that are behind others.

        Qt also calls this when a control with the focus is switched off. Then the panel itself takes the focus: in the
        next control, a second press of the same key would be another command.
        """
        focused = self.window().focusWidget()
        if focused is not None and not focused.isEnabled():
            self._left = focused
            self.setFocus()
            return True
        if focused is self and self._left is not None:
            with contextlib.suppress(RuntimeError):  # it was deleted
                _following(self._left, forward).setFocus(Qt.TabFocusReason if forward else Qt.BacktabFocusReason)
                return True
        for _ in range(MOST_CONTROLS):
            moved = super().focusNextPrevChild(forward)
            focused = QApplication.focusWidget()
            panel = focused if focused is None or isinstance(focused, Panel) else basic.around(focused, Panel)
            if not moved or panel is None or not panel.visibleRegion().isEmpty():
                break
        return moved

    def _return_focus(self) -> None:
        """Give the focus back to a control that is on again, unless another one has it by now."""
        if self._left is None:
            return
        with contextlib.suppress(RuntimeError):  # it was deleted
            if self.window().focusWidget() is self and self._left.isVisible():
                if not self._left.isEnabled():
                    return
                self._left.setFocus()
        self._left = None

    def _is_followed(self) -> bool:
        """Whether it shows what changes now."""
        return not self._has_ended and self.isVisible() and (
            self.WORKS_BEHIND or not self.visibleRegion().isEmpty())

    def _on_update(self) -> None:
        if self._is_followed() and not same(self._all_parts(), self._drawn):
            self.redraw()
        with process.reported(tr(self.TITLE)):
            self.watch()

    def _on_tick(self) -> None:
        self._on_update()  # it may have come into sight
        if self._is_followed():
            with process.reported(tr(self.TITLE)):
                self._show_heading()
                self.show_times()
                self._return_focus()

    def _all_parts(self) -> tuple:
        return (self.model.box, self.model.is_old, self.model.why, self.model.zone_name, *self.parts())

    def redraw(self, *_: object) -> None:
        """Show everything again, if the panel is not hidden."""
        if self._has_ended or not self.isVisible():
            return
        self._drawn = self._all_parts()
        with process.reported(tr(self.TITLE)):
            self._show_heading()
            self.show_model()
            self.show_times()
            self._return_focus()

    def _show_heading(self) -> None:
        self._where.setText(self.where())
        self._where.setToolTip(self.where_tip())
        self._show_news()

    def _show_news(self) -> None:
        if self.model.is_superseded:
            self.news.show_text(f"⚠ {tr(whole_box.SUPERSEDED_NOT_LIVE)}", basic.OLD)
        elif self.model.is_old:
            self.news.show_text(f"⚠ {times.silence(self.model.silence_s)}", basic.OLD)
        elif self.model.is_replay:
            self.news.show_text(f"▶ {tr(REPLAY_NOT_LIVE)}", basic.OLD)
        else:
            self.news.show_text(tr("● live"), basic.OFF)
        self.news.setToolTip(basic.tip(self.model.why))
        self._title.show(self.model.is_replay)


def _following(widget: QWidget, forward: bool) -> QWidget:
    """Return the control that Tab reaches from a widget."""
    step = QWidget.nextInFocusChain if forward else QWidget.previousInFocusChain
    following = step(widget)
    while following is not widget and not (
            following.focusPolicy() & Qt.TabFocus and following.focusProxy() is None
            and following.isEnabled() and not following.visibleRegion().isEmpty()):
        following = step(following)
    return following


# Height that is reserved for an answer, in lines.
LINES = 2
# How long a success is shown; a failure stays.
DONE_MS = 4000


class AnswerLine(QLabel):
    """The line in which a panel shows the result of the last command."""

    def __init__(self) -> None:
        super().__init__(wordWrap=True, textFormat=Qt.PlainText, textInteractionFlags=Qt.TextSelectableByMouse)
        self._done = QTimer(self, singleShot=True, timeout=self.clear_answer)
        # It keeps its height while it is empty, so that nothing moves under the mouse when a text appears.
        self.setFixedHeight(round(LINES * self.fontMetrics().lineSpacing() + basic.em() / 2))
        self.clear_answer()

    def say(self, text: str) -> None:
        """Show what is in progress."""
        self._show(text, "")

    def warn(self, text: str) -> None:
        """Show a warning."""
        self._show(text, basic.OLD.css + "font-weight:bold;")

    def show_outcome(self, what: str, outcome: CallOutcome) -> None:
        """Show the result of the command `what`."""
        if outcome.error:
            tone = basic.ALARM
            failed = tr("✘ {what} failed: {error}", what=what, error=outcome.error)
            self._show(failed, tone.css)
        else:
            self._show(tr("✔ {what}: done", what=what), "")
            self._done.start(DONE_MS)

    def begin(self, what: str) -> Done:
        """Show that the command `what` is in progress. Returns what shows its outcome."""
        self.say(f"{what} …")
        return lambda outcome: self.show_outcome(what, outcome)

    def clear_answer(self) -> None:
        """Show nothing."""
        self._show(" ", "")

    def _show(self, text: str, style: str) -> None:
        self._done.stop()
        self.setText(text)
        self.setToolTip(basic.tip(text.strip()))  # the whole text, if it does not fit
        basic.set_style(self, f"QLabel {{ padding: 0.2em; {style} }}")


# A window of this height has space for all panels, in units of the desktop's font.
HIGH_WINDOW_EMS = 75
SCORING = "ScoringPanel"
SHOW, HIDE = "▸", "▾"
SHOW_TIP, HIDE_TIP = tr_later("Show this panel now"), tr_later("Leave the space to Scoring")
NO_LIMIT = 16777215  # Qt's QWIDGETSIZE_MAX
# How often the earlier height is asked for: a referee who drags a panel gets the last word.
MOST_ATTEMPTS = 20


def scoring_in(window: QWidget) -> Optional[Panel]:
    """Return the panel Scoring in a window; None: it has none."""
    return next((panel for panel in window.findChildren(Panel) if panel.objectName() == SCORING), None)


class CollapsingPanel(Panel):
    """Base of panels that leave their space to Scoring."""

    def __init__(self, client) -> None:
        super().__init__(client)
        self.is_collapsed = False
        self._run = ""  # the run that is scored
        self._height = 0  # of the dock while no run is connected; 0: not known
        self._attempts = 0  # that are left to give the dock this height again
        self.toggle = QToolButton()
        self.toggle.setFocusPolicy(Qt.TabFocus)
        self.toggle.clicked.connect(lambda: self._collapse(not self.is_collapsed))
        self.toggle.hide()
        self.heading.addWidget(self.toggle)

    def show_collapsed(self, is_collapsed: bool) -> None:
        """Show only the visible line, or everything."""
        self.area.setVisible(not is_collapsed)

    def _show_news(self) -> None:
        """Leave the space to what the line says."""
        super()._show_news()
        if self.is_collapsed and self.model.is_old:
            self.news.setToolTip(basic.tip("\n".join(filter(None, (self.news.text(), self.model.why)))))
            self.news.show_text("⚠", basic.OLD)

    def watch(self) -> None:
        # Also while it is behind others: the limit of its height applies to all of them.
        zone = self.model.zone
        if zone is None:
            return
        run = zone.identity if zone.phase in (RUNNING, ENDED) and zone.items else ""
        if not self.is_collapsed and not self.visibleRegion().isEmpty():
            if self._attempts:
                self._grow()
            elif zone.phase == IDLE:
                dock = basic.around(self, QDockWidget)
                self._height = 0 if dock is None else dock.height()
        if run != self._run:
            self._run = run
            self._collapse(bool(run) and self._is_in_the_way())

    def _is_in_the_way(self) -> bool:
        """Whether Scoring could use the space: it is in the same, small window."""
        window, dock = self.window(), basic.around(self, QDockWidget)
        if dock is None or dock.isFloating() or window.height() > HIGH_WINDOW_EMS * basic.em():
            return False
        return scoring_in(window) is not None

    def _collapse(self, is_collapsed: bool) -> None:
        self.toggle.setVisible(bool(self._run) and (is_collapsed or self._is_in_the_way()))
        self.toggle.setText(SHOW if is_collapsed else HIDE)
        self.toggle.setToolTip(tr(SHOW_TIP if is_collapsed else HIDE_TIP))
        if is_collapsed == self.is_collapsed:
            return
        self.is_collapsed = is_collapsed
        self.show_collapsed(is_collapsed)
        self.layout().activate()
        self.setMaximumHeight(self.layout().minimumSize().height() if is_collapsed else NO_LIMIT)
        self._attempts = 0 if is_collapsed else MOST_ATTEMPTS
        if not is_collapsed:
            QTimer.singleShot(0, self._grow)
        self.redraw()

    def _grow(self) -> None:
        """Restore the earlier height of the dock. Qt gives it only when Scoring needs no space for its sheet any more,
        and a busy computer shows that later."""
        window = self.window()
        docks = [basic.around(panel, QDockWidget) for panel in (self, scoring_in(window)) if panel is not None]
        if len(docks) < 2 or None in docks or not isinstance(window, QMainWindow) or not self._height:
            self._attempts = 0
        elif self._attempts:
            left = sum(dock.height() for dock in docks) - self._height
            if left >= docks[1].minimumSizeHint().height():  # otherwise, Scoring still needs the space
                self._attempts -= 1
                window.resizeDocks(docks, [self._height, left], Qt.Vertical)
            if docks[0].height() == self._height:
                self._attempts = 0
