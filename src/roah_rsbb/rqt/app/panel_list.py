"""The list of all panels.

To add a panel, write its file and add it here. Its plugin class is made from this list; a test
(test/pure/rqt/test_rqt_launch_files.py) reports what is still missing: the entry in plugin.xml, the program, the
place in rqt's layout.
"""

from typing import Tuple, Type

from roah_rsbb.rqt.panels.active_robots import ActiveRobotsPanel
from roah_rsbb.rqt.panels.benchmark_control import BenchmarkControlPanel
from roah_rsbb.rqt.panels.core_status import CoreStatusPanel
from roah_rsbb.rqt.panels.devices import DevicesPanel
from roah_rsbb.rqt.panels.judges import JudgesPanel
from roah_rsbb.rqt.panels.log_display import LogDisplayPanel
from roah_rsbb.rqt.panels.manual_operation import ManualOperationPanel
from roah_rsbb.rqt.panels.omf_switches import OmfSwitchesPanel
from roah_rsbb.rqt.panels.online_data import OnlineDataPanel
from roah_rsbb.rqt.panels.overview import OverviewPanel
from roah_rsbb.rqt.panels.panel import Panel
from roah_rsbb.rqt.panels.results import ResultsPanel
from roah_rsbb.rqt.panels.schedule import SchedulePanel
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
    JudgesPanel,
    SchedulePanel,
)


def plugin_name(panel: Type[Panel]) -> str:
    """The name of a panel's plugin in rqt."""
    return panel.__name__[:-len("Panel")]
