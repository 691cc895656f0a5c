"""Log Display: the log of the zone's run, as it is written (docs/referee.md, "Log Display")."""

from roah_rsbb.msg import ZoneState
from roah_rsbb.rqt.panels.text_panel import TextPanel
from roah_rsbb.rqt.widgets.log_levels import LevelColours


class LogDisplayPanel(TextPanel):
    """The run's log; warnings and errors stand out."""

    TITLE = "Log Display"
    NOTHING = "Nothing was logged yet"

    def __init__(self, client, parent=None) -> None:
        super().__init__(client, parent)
        self._colours = LevelColours(self.view.document())

    def text_of(self, zone: ZoneState) -> str:
        return zone.log
