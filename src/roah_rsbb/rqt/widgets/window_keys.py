"""Keys that work in all windows of the process, wherever the focus is."""

from roah_rsbb.rqt.qt import QGuiApplication, QObject


class WindowKeys(QObject):
    """Filters the events of each window that gets the focus. Subclasses implement `eventFilter`.

    Qt sends each key press to the window with the focus before it reaches any widget.
    """

    def __init__(self) -> None:
        super().__init__()
        QGuiApplication.instance().focusWindowChanged.connect(self._watch)
        self._watch(QGuiApplication.focusWindow())

    def end(self) -> None:
        """Stop watching."""
        QGuiApplication.instance().focusWindowChanged.disconnect(self._watch)
        for window in QGuiApplication.allWindows():
            window.removeEventFilter(self)

    def _watch(self, window) -> None:
        if window is not None:
            window.installEventFilter(self)
