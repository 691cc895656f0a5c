"""The panels, the parts of them, and here the list of all panels.

To add a panel, write its class and add it here. Its plugin's class is made from this list; a test
(test/pure/rqt/test_rqt_launch_files.py) reports what is still missing: the entry in plugin.xml, the place in rqt's
layout.
"""

import importlib
from typing import TYPE_CHECKING, Dict, NamedTuple, Type

if TYPE_CHECKING:
    from roah_rsbb.rqt.panels.panel import Panel


class Listed(NamedTuple):
    """A panel of the list."""

    file: str  # in this folder
    what: str  # what it is for


PANELS: Dict[str, Listed] = {
    "benchmark_control": Listed("benchmark_control", "Choose the zone and control its benchmark"),
    "core_status": Listed("whole_box", "The state of the RSBB, and the exit button"),
    "tablet_status": Listed("whole_box", "The last messages of the tablet"),
    "scoring": Listed("scoring", "The referee's score sheet"),
    "manual_operation": Listed("operations", "The benchmarking module's requests to the referee"),
    "active_robots": Listed("whole_box", "The robots that the RSBB hears"),
    "online_data": Listed("texts", "The robot's reports during the run"),
    "log_display": Listed("texts", "The log of the zone's run"),
    "omf_switches": Listed("operations", "The switches that the robot changed, in HOMF"),
    "devices": Listed("devices", "View and operate the home devices"),
    "overview": Listed("overview", "All zones at a glance, and a button that stops all of them"),
}


def plugin_name(name: str) -> str:
    """Return the name of a panel's plugin in rqt, such as OmfSwitches for omf_switches."""
    return name.title().replace("_", "")


def load(name: str) -> "Type[Panel]":
    """Import the panel of this name and return its class."""
    module = importlib.import_module(f"roah_rsbb.rqt.panels.{PANELS[name].file}")
    return getattr(module, f"{plugin_name(name)}Panel")
