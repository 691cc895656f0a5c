"""The panels as rqt plugins; plugin.xml lists them."""

from typing import Type

from rqt_gui_py.plugin import Plugin

from roah_rsbb.rqt.model.client import Client
from roah_rsbb.rqt.panels.active_robots import ActiveRobotsPanel
from roah_rsbb.rqt.panels.benchmark_control import BenchmarkControlPanel
from roah_rsbb.rqt.panels.core_status import CoreStatusPanel
from roah_rsbb.rqt.panels.devices import DevicesPanel
from roah_rsbb.rqt.panels.log_display import LogDisplayPanel
from roah_rsbb.rqt.panels.manual_operation import ManualOperationPanel
from roah_rsbb.rqt.panels.omf_switches import OmfSwitchesPanel
from roah_rsbb.rqt.panels.online_data import OnlineDataPanel
from roah_rsbb.rqt.panels.overview import OverviewPanel
from roah_rsbb.rqt.panels.panel import Panel
from roah_rsbb.rqt.panels.results import ResultsPanel
from roah_rsbb.rqt.panels.scoring import ScoringPanel
from roah_rsbb.rqt.panels.tablet_status import TabletStatusPanel


class PanelPlugin(Plugin):
    """A panel in rqt's hands."""

    PANEL: Type[Panel]

    def __init__(self, context) -> None:
        super().__init__(context)
        self.setObjectName(type(self).__name__)
        self.panel = self.PANEL(Client.acquire())
        if context.serial_number() > 1:
            self.panel.setWindowTitle(f"{self.panel.windowTitle()} ({context.serial_number()})")
        context.add_widget(self.panel)

    def shutdown_plugin(self) -> None:
        self.panel.shutdown()
        Client.release()

    def save_settings(self, plugin_settings, instance_settings) -> None:
        self.panel.save_settings(instance_settings)

    def restore_settings(self, plugin_settings, instance_settings) -> None:
        self.panel.restore_settings(instance_settings)


class BenchmarkControl(PanelPlugin):
    PANEL = BenchmarkControlPanel


class CoreStatus(PanelPlugin):
    PANEL = CoreStatusPanel


class TabletStatus(PanelPlugin):
    PANEL = TabletStatusPanel


class Scoring(PanelPlugin):
    PANEL = ScoringPanel


class ManualOperation(PanelPlugin):
    PANEL = ManualOperationPanel


class ActiveRobots(PanelPlugin):
    PANEL = ActiveRobotsPanel


class OnlineData(PanelPlugin):
    PANEL = OnlineDataPanel


class LogDisplay(PanelPlugin):
    PANEL = LogDisplayPanel


class OmfSwitches(PanelPlugin):
    PANEL = OmfSwitchesPanel


class Devices(PanelPlugin):
    PANEL = DevicesPanel


class Overview(PanelPlugin):
    PANEL = OverviewPanel


class Results(PanelPlugin):
    PANEL = ResultsPanel
