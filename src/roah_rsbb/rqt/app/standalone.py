"""One panel in its own window, such as `rosrun roah_rsbb roah_rsbb_scoring`.

It shows the zone of the namespace in which it is started (`__ns:=`), as all panels of a client do.
"""

import re
import sys
from typing import Type

from roah_rsbb.ros import display
from roah_rsbb.ros.command_line import explain_panel
from roah_rsbb.rqt.app import application
from roah_rsbb.rqt.app.application import PanelSettings
from roah_rsbb.rqt.model.client import Client
from roah_rsbb.rqt.panels.panel import Panel
from roah_rsbb.rqt.qt import QMainWindow, QSettings
from roah_rsbb.rqt.widgets import basic
from roah_rsbb.wording.language import tr

# Size at the first start, in units of the desktop's font.
WIDE_EMS, HIGH_EMS = 40, 40


def name_of(kind: Type[Panel]) -> str:
    """Return the name of a panel's program and node, such as roah_rsbb_omf_switches for OmfSwitchesPanel."""
    words = re.findall("[A-Z][a-z]*", kind.__name__)[:-1]
    return "_".join(["roah_rsbb", *(word.lower() for word in words)])


def main(kind: Type[Panel]) -> None:
    """Show the panel until it is closed or ROS ends."""
    explain_panel(sys.modules[kind.__module__].__doc__)
    if not display.has_display():
        sys.exit(display.NO_DISPLAY)
    name = name_of(kind)
    application.init_node(name)
    app = application.grow(application.make_application(sys.argv[:1]))
    settings = QSettings("roah_rsbb", name)
    kept = PanelSettings(settings, kind.__name__)
    panel = kind(Client.acquire())
    window = QMainWindow()
    window.setCentralWidget(panel)
    panel.client.add_strip(window)
    window.setWindowTitle(f"{tr(kind.TITLE)} – RoAH RSBB")
    window.resize(round(WIDE_EMS * basic.em()), round(HIGH_EMS * basic.em()))
    geometry = settings.value("geometry")
    if geometry is not None:
        window.restoreGeometry(geometry)
    panel.restore_settings(kept)
    window.show()
    code = application.run(app)
    settings.setValue("geometry", window.saveGeometry())
    panel.save_settings(kept)
    settings.sync()
    panel.shutdown()
    Client.release()
    application.leave(code)
