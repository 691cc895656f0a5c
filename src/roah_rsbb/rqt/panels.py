"""All panels: those of the manual's section 5 in its order, then the others."""

from typing import Tuple, Type

from roah_rsbb.rqt.active_robots import ActiveRobotsPanel
from roah_rsbb.rqt.benchmark_control import BenchmarkControlPanel
from roah_rsbb.rqt.core_status import CoreStatusPanel
from roah_rsbb.rqt.devices import DevicesPanel
from roah_rsbb.rqt.log_display import LogDisplayPanel
from roah_rsbb.rqt.manual_operation import ManualOperationPanel
from roah_rsbb.rqt.omf_switches import OmfSwitchesPanel
from roah_rsbb.rqt.online_data import OnlineDataPanel
from roah_rsbb.rqt.overview import OverviewPanel
from roah_rsbb.rqt.panel import Panel
from roah_rsbb.rqt.results import ResultsPanel
from roah_rsbb.rqt.scoring import ScoringPanel
from roah_rsbb.rqt.tablet_status import TabletStatusPanel

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
