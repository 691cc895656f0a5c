"""Keeps menus, lists, dialogs and floating docks off the STOP strip, and lets a press through while one is open."""

from typing import Dict, List, Optional

from roah_rsbb.rqt.qt import (
    QApplication,
    QDialog,
    QDockWidget,
    QEvent,
    QObject,
    QRect,
    QScrollArea,
    Qt,
    QTimer,
    QVBoxLayout,
    QWidget,
)
from roah_rsbb.rqt.widgets.stop_strip import StopStrip, strips_in_sight

# How often this looks for an open menu or list: Qt does not report them.
LOOK_MS = 25
SCROLLED = "ScrolledDialog"


def clear_place(wanted: QRect, strips: List[QRect], screen: QRect) -> QRect:
    """Return the place nearest to `wanted` on the screen that covers no strip; smaller if it has to be."""
    for strip in strips:
        if not wanted.intersects(strip):
            continue
        above = QRect(screen.left(), screen.top(), screen.width(), strip.top() - screen.top())
        below = QRect(screen.left(), strip.bottom() + 1, screen.width(), screen.bottom() - strip.bottom())
        area = above if above.height() >= min(wanted.height(), below.height()) else below
        wanted = QRect(wanted.topLeft(), wanted.size().boundedTo(area.size()))
        wanted.moveTop(max(area.top(), min(wanted.top(), area.bottom() + 1 - wanted.height())))
    return wanted


class KeepClear(QObject):
    """Watches what is open in this process."""

    def __init__(self) -> None:
        super().__init__()
        self.popup: Optional[QWidget] = None  # the menu or list that is open, once this has seen it
        self._modal: Optional[QWidget] = None
        self._stand_ins: Dict[StopStrip, StopStrip] = {}  # by the strip that a modal dialog blocks
        self._timer = QTimer(self, timeout=self._look)
        self._timer.start(LOOK_MS)

    def end(self) -> None:
        """Stop watching."""
        self._timer.stop()
        self._stand_in(None)

    def eventFilter(self, _window: QObject, event: QEvent) -> bool:
        """Let a press through that a menu would take. Qt sends it to the window of the menu, wherever it is."""
        if event.type() != QEvent.MouseButtonPress or event.button() != Qt.LeftButton:
            return False
        popup = QApplication.activePopupWidget()
        if popup is None or popup.frameGeometry().contains(event.globalPos()):
            return False
        strip = next((one for one in StopStrip.shown if one.part_at(event.globalPos()) is not None), None)
        if strip is None:
            return False
        while popup is not None:  # a menu of a menu
            popup.close()
            following = QApplication.activePopupWidget()
            popup = following if following is not popup else None
        return strip.press_at(event.globalPos())

    def _look(self) -> None:
        self.popup = QApplication.activePopupWidget()
        if self.popup is not None and self.popup.windowHandle() is not None:
            self.popup.windowHandle().installEventFilter(self)
            self._move_off(self.popup)
        self._stand_in(QApplication.activeModalWidget())
        for window in QApplication.topLevelWidgets():
            if not window.isVisible():
                continue
            if isinstance(window, QDialog) or (isinstance(window, QDockWidget) and not QApplication.mouseButtons()):
                self._move_off(window)  # but no dock that is being dragged: it may be on its way to another place
            elif window.windowType() == Qt.ToolTip and not window.windowFlags() & Qt.WindowTransparentForInput:
                # A press on a tooltip would close it and do nothing else.
                window.windowHandle().setFlags(window.windowFlags() | Qt.WindowTransparentForInput)

    def _stand_in(self, modal: Optional[QWidget]) -> None:
        """Put a strip above each one that a modal dialog blocks. Ours are not modal, but others in rqt are. Qt does not
        block what belongs to the dialog."""
        if modal is not self._modal:
            for strip in self._stand_ins.values():
                strip.end()
                strip.deleteLater()
            self._modal, self._stand_ins = modal, {}
            if modal is not None and modal.windowHandle() is not None:
                self._stand_ins = {strip: strip.stand_in(modal.windowHandle()) for strip in list(StopStrip.shown)
                                   if strip.isVisible()}
        for blocked, strip in self._stand_ins.items():
            if strip.geometry() != blocked.on_screen():
                strip.setGeometry(blocked.on_screen())

    @staticmethod
    def _move_off(window: QWidget) -> None:
        frame = window.frameGeometry()
        screen = _screen_of(window)
        if screen is None:
            return
        place = clear_place(frame, strips_in_sight(), screen)
        if place == frame:
            return
        if place.height() < frame.height() and isinstance(window, QDialog):
            let_scroll(window)
        window.resize(window.width() - frame.width() + place.width(), window.height() - frame.height() + place.height())
        window.move(place.topLeft())


def let_scroll(dialog: QDialog) -> None:
    """Let the content of a dialog scroll, so that it can be smaller than its content."""
    layout = dialog.layout()
    if layout is None or dialog.findChild(QScrollArea, SCROLLED) is not None:
        return
    content, area = QWidget(), QScrollArea(widgetResizable=True)
    area.setObjectName(SCROLLED)
    content.setLayout(layout)
    area.setFrameShape(QScrollArea.NoFrame)
    area.setWidget(content)
    outer = QVBoxLayout(dialog)
    outer.setContentsMargins(0, 0, 0, 0)
    outer.addWidget(area)
    dialog.setMinimumSize(0, 0)


def _screen_of(window: QWidget) -> Optional[QRect]:
    handle = window.windowHandle()
    screen = QApplication.primaryScreen() if handle is None else handle.screen()
    return None if screen is None else screen.availableGeometry()
