"""The title of a window, with a mark in front of it while something is so."""

from roah_rsbb.rqt.qt import QWidget
from roah_rsbb.wording.language import tr
from roah_rsbb.wording.whole_box import REPLAY


class MarkedTitle:
    """Puts a mark in front of the title of a window, such as that of a replay, and removes it again."""

    def __init__(self, window: QWidget, mark: str = REPLAY) -> None:
        self._window = window
        self._mark = f"{tr(mark)} – "
        self._is_marked = False

    def show(self, is_marked: bool) -> None:
        """Mark the title, or remove the mark."""
        if is_marked != self._is_marked:
            self._is_marked = is_marked
            title = self._window.windowTitle()
            self._window.setWindowTitle(self._mark + title if is_marked else title.replace(self._mark, "", 1))
