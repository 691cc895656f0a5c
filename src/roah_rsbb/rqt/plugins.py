"""The panels as rqt plugins: a class for each panel of the list, such as `Scoring` for `ScoringPanel`."""

from typing import Type

from rqt_gui_py.plugin import Plugin

from roah_rsbb.rqt.client import RefereeClient
from roah_rsbb.rqt.node import WindowNode
from roah_rsbb.rqt.panels import PANELS, load, plugin_name
from roah_rsbb.rqt.panels.panel import Panel
from roah_rsbb.rqt.qt import QMainWindow, QTimer


class PanelPlugin(Plugin):
    """Shows a panel in rqt."""

    PANEL: Type[Panel]

    def __init__(self, context) -> None:
        super().__init__(context)
        self.setObjectName(type(self).__name__)
        self.panel = self.PANEL(RefereeClient.acquire(WindowNode))
        if context.serial_number() > 1:
            self.panel.setWindowTitle(f"{self.panel.windowTitle()} ({context.serial_number()})")
        context.add_widget(self.panel)
        QTimer.singleShot(0, self._add_strip)  # only then is the panel in rqt's window

    def _add_strip(self) -> None:
        """Add the STOP strip to rqt's window, once for all panels."""
        window = self.panel.window()
        while window is not None and not isinstance(window, QMainWindow):  # a dock that floats
            window = window.parentWidget()
        if window is not None:
            self.panel.client.add_strip(window)

    def shutdown_plugin(self) -> None:
        self.panel.shutdown()
        RefereeClient.release()

    def save_settings(self, plugin_settings, instance_settings) -> None:
        self.panel.save_settings(instance_settings)

    def restore_settings(self, plugin_settings, instance_settings) -> None:
        self.panel.restore_settings(instance_settings)


# rqt looks the classes up by the names in plugin.xml.
globals().update({
    plugin_name(name): type(plugin_name(name), (PanelPlugin,), {"PANEL": load(name), "__module__": __name__})
    for name in PANELS
})
