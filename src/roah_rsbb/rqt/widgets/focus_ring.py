"""A frame around the widget that has the focus. Many desktop styles hardly show it."""

from typing import Optional

from roah_rsbb.rqt.qt import (
    QApplication,
    QEvent,
    QObject,
    QPainter,
    QPalette,
    QPen,
    QPoint,
    QRect,
    QSplitter,
    Qt,
    QWidget,
)

WIDTH = 3


class _Frame(QWidget):
    """The frame. It takes neither the mouse nor the focus."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.setAttribute(Qt.WA_TransparentForMouseEvents)
        self.setFocusPolicy(Qt.NoFocus)
        self.setObjectName("focus ring")

    def paintEvent(self, event) -> None:
        painter = QPainter(self)
        half = WIDTH // 2 + 1
        # Light and dark: visible on every colour.
        for colour, width in ((self.palette().color(QPalette.Base), WIDTH + 2),
                              (self.palette().color(QPalette.Highlight), WIDTH)):
            painter.setPen(QPen(colour, width))
            painter.drawRect(self.rect().adjusted(half, half, -half, -half))


class FocusRing(QObject):
    """Keeps the frame around the widget with the focus, in the windows for which `belongs` holds."""

    def __init__(self, belongs) -> None:
        """`belongs(widget)`: whether the widget is one of ours."""
        super().__init__()
        self._belongs = belongs
        self._frame: Optional[_Frame] = None
        self._on: Optional[QWidget] = None
        QApplication.instance().focusChanged.connect(self._follow)

    def end(self) -> None:
        """Stop following."""
        QApplication.instance().focusChanged.disconnect(self._follow)
        self._leave()

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        if watched is self._on:
            if event.type() in (QEvent.Move, QEvent.Resize, QEvent.Show):
                self._place()
            elif event.type() in (QEvent.Hide, QEvent.DeferredDelete):
                self._leave()
        return False

    def _follow(self, _before: Optional[QWidget], widget: Optional[QWidget]) -> None:
        self._leave()
        parent = None if widget is None else widget.parentWidget()
        while isinstance(parent, QSplitter):  # it would treat the frame as one of its parts
            parent = parent.parentWidget()
        if parent is None or widget.focusPolicy() == Qt.NoFocus or not self._belongs(widget):
            return
        self._on = widget
        widget.installEventFilter(self)
        # Python does not notice the end of a widget that Qt created, such as a dialog's button. If it was hidden
        # before it got the focus, no other event comes.
        widget.destroyed.connect(self._forget)
        self._frame = _Frame(parent)
        self._place()
        self._frame.show()

    def _place(self) -> None:
        if self._frame is not None and self._on is not None:
            place = QRect(self._on.mapTo(self._frame.parentWidget(), QPoint()), self._on.size())
            self._frame.setGeometry(place.adjusted(-1, -1, 1, 1))
            self._frame.raise_()

    def _forget(self) -> None:
        """Leave a widget that no longer exists."""
        self._on = None
        self._leave()

    def _leave(self) -> None:
        if self._on is not None:
            self._on.removeEventFilter(self)
            self._on.destroyed.disconnect(self._forget)
        if self._frame is not None:
            self._frame.hide()
            self._frame.setParent(None)
            self._frame.deleteLater()
        self._on = self._frame = None
