"""Panels that leave their space to Scoring while a run of the zone is scored, on small screens.

They collapse to one visible line when the run starts, and expand when it is disconnected. A button in that line
expands them earlier. It works in rqt as in our window: a dock with a small maximum height leaves its space to the
others.
"""

from functools import partial
from typing import Optional

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


def scoring_in(window: QWidget) -> Optional[Panel]:
    """Return the panel Scoring in a window; None: it has none."""
    return next((panel for panel in window.findChildren(Panel) if panel.objectName() == SCORING), None)


def dock_of(panel: Panel) -> Optional[QDockWidget]:
    """Return the dock that a panel is in."""
    widget = panel.parentWidget()
    while widget is not None and not isinstance(widget, QDockWidget):
        widget = widget.parentWidget()
    return widget


class CollapsingPanel(Panel):
    """Base of these panels."""

    def __init__(self, client) -> None:
        super().__init__(client)
        self.is_collapsed = False
        self._run = ""  # the run that is scored
        self._height = 0  # of the dock while no run is connected; 0: not known
        self.toggle = QToolButton()
        self.toggle.setFocusPolicy(Qt.TabFocus)
        self.toggle.clicked.connect(lambda: self._collapse(not self.is_collapsed))
        self.toggle.hide()
        self.heading.addWidget(self.toggle)
        # Do this even while the panel is hidden behind others, because its limit applies to all of them.
        self.model.updated.connect(self._watch)

    def shutdown(self) -> None:
        self.model.updated.disconnect(self._watch)
        super().shutdown()

    def show_collapsed(self, is_collapsed: bool) -> None:
        """Show only the visible line, or everything."""
        self.content.setVisible(not is_collapsed)

    def _watch(self) -> None:
        zone, details = self.model.zone, self.model.zone_details
        if zone is None or details is None:
            return
        is_scored = details.phase in ("running", "ended") and bool(zone.scoring)
        run = details.identity if is_scored else ""
        if details.phase == "idle" and not self.is_collapsed and not self.visibleRegion().isEmpty():
            dock = dock_of(self)
            self._height = 0 if dock is None else dock.height()
        if run != self._run:
            self._run = run
            self._collapse(bool(run) and self._is_in_the_way())

    def _is_in_the_way(self) -> bool:
        """Whether Scoring could use the space: it is in the same, small window."""
        window, dock = self.window(), dock_of(self)
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
        dock = dock_of(self)
        self.show_collapsed(is_collapsed)
        self.layout().activate()
        self.setMaximumHeight(self.layout().minimumSize().height() if is_collapsed else NO_LIMIT)
        if not is_collapsed and dock is not None:
            # Pass the height: an update may change it before the timer fires.
            QTimer.singleShot(0, partial(self._grow, self._height))
        self._on_update()

    def _grow(self, height: int) -> None:
        """Restore an earlier height of the dock."""
        window = self.window()
        scoring = scoring_in(window)
        docks = [dock_of(panel) for panel in (self, scoring) if panel is not None]
        if len(docks) == 2 and None not in docks and isinstance(window, QMainWindow) and height:
            both = sum(dock.height() for dock in docks)
            if not self.is_collapsed and height < both:
                window.resizeDocks(docks, [height, both - height], Qt.Vertical)
