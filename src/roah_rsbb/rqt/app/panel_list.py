"""All panels: those of the original RSBB first, then the others."""

from typing import Tuple, Type

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

PANELS: Tuple[Type[Panel], ...] = (
    BenchmarkControlPanel,
    CoreStatusPanel,
    TabletStatusPanel,
    ScoringPanel,
    ManualOperationPanel,
    ActiveRobotsPanel,
    OnlineDataPanel,
    LogDisplayPanel,
    OmfSwitchesPanel,
    DevicesPanel,
    OverviewPanel,
    ResultsPanel,
)
