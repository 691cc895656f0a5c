"""Checks the set-up before a competition: `rosrun roah_rsbb preflight --rsbb-host 192.168.1.255`.

Prints a line for each check, with the remedy if something is wrong. It needs no ROS master and starts no nodes.
"""

import argparse
import os
import sys
from typing import Dict, List, Optional

import rospkg

from roah_rsbb.arguments import Parser, number
from roah_rsbb.devices.sounds import BELL, default_command
from roah_rsbb.ros.display import has_display
from roah_rsbb.rulebook.errors import Report
from roah_rsbb.rulebook.launch_file import arguments
from roah_rsbb.tools import preflight_checks as checks
from roah_rsbb.tools import preflight_venue as venue
from roah_rsbb.tools.competition.files import FIREWALL, LAUNCH, MODULES
from roah_rsbb.tools.competition.firewall import TABLET_PORT
from roah_rsbb.tools.interfaces import interfaces
from roah_rsbb.tools.open_ports import listeners
from roah_rsbb.tools.preflight_checks import Remark, Severity

PROGRAM = "preflight"
_DESCRIPTION = """\
Check the set-up before a competition, with the settings for roah_rsbb.launch: network, UDP ports, firewall, other
boxes, clock, disk, configuration, modules, passwords, motion capture, home devices, tablet, sounds, display.
"""
_EPILOG = """\
The exit status is 0 if no check failed (possibly with warnings), 1 if a check failed, 2 for wrong usage.

Run it while your box is not running: it listens for other boxes on the public UDP port.
"""
FILES = ("benchmarks", "schedule", "passwords")
_LOG_DIR = "~/.ros/roah_rsbb"  # roah_rsbb.launch's
_SMARTIF_HOST, _SMARTIF_PORT = "192.168.1.56", 6665  # roah_rsbb.launch's
_WEB_PORT = 8081  # roah_rsbb.launch's
# Seconds to wait for invisible markers.
_MARKERS_S = 3.0

_MARKS = {Severity.OK: "ok     ", Severity.WARNING: "WARNING", Severity.FAILED: "FAILED "}


def _parser() -> argparse.ArgumentParser:
    parser = Parser(PROGRAM, _DESCRIPTION, _EPILOG)
    parser.add_argument("--rsbb-host", default="10.255.255.255",
                        help="broadcast address of the network with the robots (default: %(default)s)")
    parser.add_argument("--rsbb-port", type=int, default=6666, help="public UDP port (default: %(default)s)")
    parser.add_argument("--bind-host", default="0.0.0.0", help="own address to use (default: all)")
    parser.add_argument("--competition", metavar="DIR",
                        help="a folder that new_competition created: check its files and its log")
    for name in FILES:
        parser.add_argument(f"--{name}-file", metavar="FILE",
                            help="default: the competition's, or the included one")
    parser.add_argument("--modules-dir", metavar="DIR",
                        help="the parameters of the benchmarking modules (default: the competition's modules/ if it "
                        "exists, else the included ones)")
    parser.add_argument("--tablet-port", type=int, default=TABLET_PORT, metavar="PORT",
                        help="TCP port of the tablet's page (default: %(default)s)")
    parser.add_argument("--web-port", type=int, default=_WEB_PORT, metavar="PORT",
                        help="TCP port of the web pages (default: %(default)s)")
    parser.add_argument("--smartif-host", metavar="HOST",
                        help=f"controller of the home devices (default: the competition's, or {_SMARTIF_HOST})")
    parser.add_argument("--smartif-port", type=int, default=_SMARTIF_PORT, metavar="PORT",
                        help="its TCP port (default: %(default)s)")
    parser.add_argument("--log-dir", metavar="DIR", help=f"default: the competition's log/, or {_LOG_DIR}")
    parser.add_argument("--listen", type=number(0.0, 3600.0), default=5.0, metavar="S",
                        help="seconds to listen for another box; 0: do not listen (default: %(default)s)")
    return parser


def complete(options: argparse.Namespace, config_dir: str) -> None:
    """Set the files and directories that were not given to their defaults."""
    folder = options.competition or config_dir
    for name in FILES:
        if getattr(options, f"{name}_file") is None:
            setattr(options, f"{name}_file", os.path.join(folder, f"{name}.yaml"))
    if options.modules_dir is None:
        # A competition without a modules folder uses the included one, as its launch file does.
        own = os.path.join(folder, MODULES)
        options.modules_dir = own if os.path.isdir(own) else os.path.join(config_dir, MODULES)
    if options.log_dir is None:
        options.log_dir = os.path.join(options.competition, "log") if options.competition else _LOG_DIR


def findings(options: argparse.Namespace) -> List[Remark]:
    """Return the results of all checks, in the order in which an organiser would check."""
    files = {f"{name}_file": getattr(options, f"{name}_file") for name in FILES}
    own = interfaces()
    network = checks.check_network(options.rsbb_host, own)
    ports = checks.check_ports(options.bind_host, options.rsbb_port)
    found = [network, *ports]
    firewall_file = os.path.join(options.competition or "COMPETITION", FIREWALL)
    found += checks.check_exposure(options.rsbb_host, own, listeners(), checks.list_firewall(), firewall_file)
    if options.listen and network.level is not Severity.FAILED:
        found.append(checks.check_other_box(options.rsbb_host, options.rsbb_port, options.bind_host, options.listen))
    found.append(checks.check_clock(checks.is_synchronised()))
    found += checks.check_log_dir(os.path.expanduser(options.log_dir))
    found += checks.check_configuration(files, options.modules_dir)
    found += _check_venue(options, files)
    found.append(venue.check_web_port(options.bind_host, options.web_port))
    found.append(checks.check_player(default_command(BELL)[0]))
    found.append(checks.check_display(has_display()))
    return found


def _check_venue(options: argparse.Namespace, files: Dict[str, str]) -> List[Remark]:
    from roah_rsbb.nodes.modules.check_ground_truth import look  # imported late: it needs the built messages

    loaded = venue.loaded_config(files)
    if loaded is None:
        return []
    # Errors in the launch file are those of `check_configuration`.
    given = arguments(Report(), os.path.join(options.competition, LAUNCH)) if options.competition else {}
    set_here = given["smartif_host"].default if "smartif_host" in given else ""
    host = options.smartif_host or set_here or _SMARTIF_HOST
    return [
        *venue.check_ground_truth(loaded, options.modules_dir, lambda truth: look(truth, _MARKERS_S)),
        *venue.check_devices(loaded, host, options.smartif_port),
        *venue.check_tablet_port(loaded, options.bind_host, options.tablet_port),
    ]


def main(arguments: Optional[List[str]] = None) -> None:
    """Run the program with these arguments (default: those of the process)."""
    config_dir = os.path.join(rospkg.RosPack().get_path("roah_rsbb"), "config")
    options = _parser().parse_args(sys.argv[1:] if arguments is None else arguments)
    complete(options, config_dir)
    found = findings(options)
    for finding in found:
        print(f"{_MARKS[finding.level]}  {finding.text}")
        if finding.remedy:
            print(f"         -> {finding.remedy}")
    worst = [sum(f.level is level for f in found) for level in (Severity.FAILED, Severity.WARNING)]
    print(f"{worst[0]} failed, {worst[1]} warnings")
    sys.exit(1 if worst[0] else 0)
