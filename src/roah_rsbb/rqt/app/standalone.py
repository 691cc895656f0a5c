"""One panel in its own window, such as `rosrun roah_rsbb panel scoring`.

It shows the zone of the namespace in which it is started (`__ns:=`), as all panels of a client do.
"""

from roah_rsbb.rqt.app.application import PanelSettings, open_at
from roah_rsbb.rqt.app.panel_list import load
from roah_rsbb.rqt.model.client import RefereeClient
from roah_rsbb.rqt.qt import QMainWindow, QSettings
from roah_rsbb.rqt.widgets import basic
from roah_rsbb.rqt.with_ros.host import HostWithRos
from roah_rsbb.wording.language import tr

# Size at the first start, in units of the desktop's font.
WIDE_EMS, HIGH_EMS = 40, 40


class PanelWindow(QMainWindow):
    """A window with one panel. Its size and the panel's settings are saved."""

    def __init__(self, host: HostWithRos, name: str, settings: QSettings) -> None:
        """`name` is that of the panel."""
        super().__init__()
        kind = load(name)
        self._settings = settings
        self._of_panel = PanelSettings(settings, kind.__name__)
        self._panel = kind(RefereeClient.acquire(lambda: host))
        self.setCentralWidget(self._panel)
        self._panel.client.add_strip(self)
        self.setWindowTitle(f"{tr(kind.TITLE)} – RoAH RSBB")
        open_at(self, WIDE_EMS * basic.em(), HIGH_EMS * basic.em(), settings.value("geometry"))
        self._panel.restore_settings(self._of_panel)

    def shutdown(self) -> None:
        """Save the settings, and close the panel."""
        self._settings.setValue("geometry", self.saveGeometry())
        self._panel.save_settings(self._of_panel)
        self._settings.sync()
        self._panel.shutdown()
        RefereeClient.release()
