"""The title of a window, which says whether a replay is shown."""

from roah_rsbb.rqt.qt import QWidget
from roah_rsbb.wording.language import tr
from roah_rsbb.wording.replay import MARK


class MarkedTitle:
    """Puts the mark of a replay in front of the title of a window, and removes it again."""

    def __init__(self, window: QWidget) -> None:
        self._window = window
        self._is_marked = False

    def show(self, is_replay: bool) -> None:
        """Mark the title, or remove the mark."""
        if is_replay == self._is_marked:
            return
        self._is_marked = is_replay
        mark, title = f"{tr(MARK)} – ", self._window.windowTitle()
        self._window.setWindowTitle(mark + title if is_replay else title[len(mark):])
