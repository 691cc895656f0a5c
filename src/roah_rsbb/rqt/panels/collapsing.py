"""Panels that leave their space to Scoring while a run of the zone is scored, on small screens.

They collapse to one visible line when the run starts, and expand when it is disconnected. A button in that line
expands them earlier. It works in rqt as in our window: a dock with a small maximum height leaves its space to the
others.
"""

from typing import Optional

from roah_rsbb.model.zone import ENDED, IDLE, RUNNING
from roah_rsbb.rqt.panels.panel import Panel
from roah_rsbb.rqt.qt import QDockWidget, QMainWindow, Qt, QTimer, QToolButton, QWidget
from roah_rsbb.rqt.widgets import basic
from roah_rsbb.wording.language import tr, tr_later

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
    """Base of these panels."""

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
        # Do this even while the panel is hidden behind others, because its limit applies to all of them.
        self.model.updated.connect(self._watch)
        self.model.ticked.connect(self._watch)

    def shutdown(self) -> None:
        self.model.updated.disconnect(self._watch)
        self.model.ticked.disconnect(self._watch)
        super().shutdown()

    def show_collapsed(self, is_collapsed: bool) -> None:
        """Show only the visible line, or everything."""
        self.area.setVisible(not is_collapsed)

    def _show_news(self) -> None:
        """Leave the space to what the line says."""
        super()._show_news()
        if self.is_collapsed and self.model.is_old:
            self._news.setToolTip(basic.tip("\n".join(filter(None, (self._news.text(), self.model.why)))))
            self._news.show_text("⚠", basic.OLD)

    def _watch(self) -> None:
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
