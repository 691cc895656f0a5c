"""The list of all panels.

To add a panel, write its file and add it here. Its plugin class is made from this list; a test
(test/pure/rqt/test_rqt_launch_files.py) reports what is still missing: the entry in plugin.xml, the place in rqt's
layout.
"""

import importlib
from typing import TYPE_CHECKING, Dict, Type

if TYPE_CHECKING:
    from roah_rsbb.rqt.panels.panel import Panel

# Each panel's name, which is that of its file, and what it is for.
PANELS: Dict[str, str] = {
    "benchmark_control": "Choose the zone and control its benchmark",
    "core_status": "The state of the RSBB, and the exit button",
    "tablet_status": "The last messages of the tablet",
    "scoring": "The referee's score sheet",
    "manual_operation": "The benchmarking module's requests to the referee",
    "active_robots": "The robots that the RSBB hears",
    "online_data": "The robot's reports during the run",
    "log_display": "The log of the zone's run",
    "omf_switches": "The switches that the robot changed, in HOMF",
    "devices": "View and operate the home devices",
    "overview": "All zones at a glance, and a button that stops all of them",
}


def plugin_name(name: str) -> str:
    """Return the name of a panel's plugin in rqt, such as OmfSwitches for omf_switches."""
    return name.title().replace("_", "")


def load(name: str) -> "Type[Panel]":
    """Import the panel of this name and return its class."""
    return getattr(importlib.import_module(f"roah_rsbb.rqt.panels.{name}"), f"{plugin_name(name)}Panel")
