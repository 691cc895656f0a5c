"""Checks the set-up before a competition: `roah-rsbb preflight FOLDER`; with ROS: `rosrun roah_rsbb preflight`.

Prints a line for each check, with the remedy if something is wrong. It needs no ROS master and starts no nodes.
"""

import argparse
import os
import sys
from typing import List, NamedTuple, Optional

from roah_rsbb.box.parameters import BoxParameters, parameters_of, read_parameters
from roah_rsbb.box.settings import of_competition, of_words
from roah_rsbb.client.places import local_door_file
from roah_rsbb.comm.sockets import ANY_HOST
from roah_rsbb.devices.sounds import SILENCE, command_of
from roah_rsbb.ground.arguments import Parser, called, is_without_ros, number
from roah_rsbb.ground.params import BadParams
from roah_rsbb.tools import preflight_checks as checks
from roah_rsbb.tools import preflight_checks as venue
from roah_rsbb.tools.competition.files import FIREWALL
from roah_rsbb.tools.ports import interfaces, listeners
from roah_rsbb.tools.preflight_checks import Remark, Severity
from roah_rsbb.web.serving import LOOPBACK

PROGRAM = called("preflight")
_DESCRIPTION = """\
Check the set-up before a competition, with the box's settings: network, UDP ports, firewall, other boxes, clock, disk,
configuration, modules, passwords, motion capture, home devices, tablet, web pages, sounds, display.
"""
_EPILOG = """\
The settings are those of the folder's launch file and, for what that does not set, of roah_rsbb.launch. Each can also
be given as name:=value, as for the box, such as rsbb_host:=192.168.1.255.

The exit status is 0 if no check failed (possibly with warnings), 1 if a check failed, 2 for wrong usage.

Run it while your box is not running: it listens for other boxes on the public UDP port.
"""
# The settings with an option of their own: the name of the value, and what it is.
_OPTIONS = {
    "rsbb_host": ("ADDRESS", "broadcast address of the network with the robots"),
    "rsbb_port": ("PORT", "public UDP port"),
    "bind_host": ("ADDRESS", "own address to use"),
    "benchmarks_file": ("FILE", "the benchmarks"),
    "schedule_file": ("FILE", "the schedule"),
    "passwords_file": ("FILE", "the teams' passwords"),
    "modules_dir": ("DIR", "the parameters of the benchmarking modules"),
    "tablet_port": ("PORT", "TCP port of the tablet's page"),
    "web_port": ("PORT", "TCP port of the web pages"),
    "smartif_host": ("HOST", "controller of the home devices"),
    "smartif_port": ("PORT", "its TCP port"),
    "log_dir": ("DIR", "the journal and the run logs"),
}
# Seconds to wait for invisible markers.
_MARKERS_S = 3.0

_MARKS = {Severity.OK: "ok     ", Severity.WARNING: "WARNING", Severity.FAILED: "FAILED "}


class CheckedSettings(NamedTuple):
    """The settings of the box whose set-up is checked."""

    box: BoxParameters
    modules_dir: str
    has_devices: bool
    smartif_host: str
    smartif_port: int
    tablet_port: int  # 0: any free port, or no page
    web_port: int  # 0: any free port, or no pages
    players: List[List[str]]  # the commands that play sounds; for an included one, that which plays silence


def _parser() -> argparse.ArgumentParser:
    parser = Parser(PROGRAM, _DESCRIPTION, _EPILOG, usage=f"{PROGRAM} [OPTION ...] [FOLDER] [name:=value ...]")
    folder = parser.add_mutually_exclusive_group()
    folder.add_argument("folder", metavar="FOLDER", nargs="?",
                        help="the competition's folder (default: none, the included files)")
    folder.add_argument("--competition", metavar="FOLDER", help="the same")
    for name, (value, what) in _OPTIONS.items():
        parser.add_argument("--" + name.replace("_", "-"), metavar=value, help=f"{what} (setting {name})")
    parser.add_argument("--listen", type=number(0.0, 3600.0), default=5.0, metavar="S",
                        help="seconds to listen for another box; 0: do not listen (default: %(default)s)")
    return parser


def read_settings(options: argparse.Namespace, words: List[str]) -> CheckedSettings:
    """Return the settings: those of the command line, else those of the competition's folder, else the defaults.

    `words`: those of the command line that are name:=value. Raises `BadParams`, also for what the box would refuse.
    """
    given = {name: getattr(options, name) for name in _OPTIONS if getattr(options, name) is not None}
    settings = of_competition(options.folder or options.competition or "", {**of_words(words), **given})
    bell, timeout = (command_of(settings, name, SILENCE) for name in ("bell_ring_command", "timeout_ring_command"))
    modules_dir = settings.path("modules_dir")
    has_devices, has_tablet, has_web = (settings.flag(name, True) for name in ("devices", "tablet", "web"))
    smartif_host, smartif_port = settings.text("smartif_host"), settings.whole("smartif_port", 6665, 1, 65535)
    tablet_port, web_port = (settings.whole(name, 0, 0, 65535) for name in ("tablet_port", "web_port"))
    # Of the launch file of a box with ROS, only roslaunch knows which arguments it uses.
    box = parameters_of(settings) if is_without_ros() else read_parameters(settings)
    return CheckedSettings(box, modules_dir, has_devices, smartif_host, smartif_port, tablet_port if has_tablet else 0,
                           web_port if has_web else 0, [bell] if bell == timeout else [bell, timeout])


def findings(settings: CheckedSettings, folder: str, listen_s: float) -> List[Remark]:
    """Return the results of all checks, in the order in which an organiser would check. `folder`: the competition's;
    empty: there is none."""
    files = dict(zip(("benchmarks_file", "schedule_file", "passwords_file"), settings.box.files))
    network, port = settings.box.network, settings.box.network.rsbb_port
    # Pages are for this computer only if robots are on it, and have nothing to do with bind_host.
    pages_host = LOOPBACK if network.rsbb_host.startswith("127.") else ANY_HOST
    own = interfaces()
    reaches_robots = checks.check_network(network.rsbb_host, own)
    cannot_bind = checks.check_bind(network.bind_host, port)
    found = [reaches_robots, *(cannot_bind or checks.check_ports(network.bind_host, port))]
    firewall_file = os.path.join(folder or "COMPETITION", FIREWALL)
    found += checks.check_exposure(network.rsbb_host, own, listeners(), checks.list_firewall(), firewall_file)
    if listen_s and not cannot_bind and reaches_robots.level is not Severity.FAILED:
        found.append(checks.check_other_box(network.rsbb_host, port, network.bind_host, listen_s))
    if is_without_ros():
        found.append(checks.check_door(local_door_file()))
    found.append(checks.check_clock(checks.is_synchronised()))
    found += checks.check_log_dir(settings.box.log_dir)
    found += checks.check_configuration(files, settings.modules_dir)
    loaded = venue.loaded_config(files)
    if loaded is not None:
        found += venue.check_standby(loaded, settings.box.standby_port)
        found += venue.check_ground_truth(loaded, settings.modules_dir, _look())
        found += venue.check_devices(loaded, settings.smartif_host if settings.has_devices else "",
                                     settings.smartif_port)
        if settings.tablet_port:
            found += venue.check_tablet_port(loaded, pages_host, settings.tablet_port)
    if settings.web_port:
        found.append(venue.check_web_port(pages_host, settings.web_port))
    found += [checks.check_player(player) for player in settings.players]
    return found + _check_display()


def _look() -> Optional[venue.Look]:
    """Return who looks at the markers; None: a box without ROS, or a computer without it, sees none."""
    if is_without_ros():
        return None
    try:
        from roah_rsbb.ros.modules.check_ground_truth import look
    except ImportError:
        return None
    return lambda truth: look(truth, _MARKERS_S)


def _check_display() -> List[Remark]:
    """Check that windows can be opened, where there are any."""
    if is_without_ros():
        return []
    try:
        from roah_rsbb.ros.display import has_display
    except ImportError:
        return []
    return [checks.check_display(has_display())]


def main(arguments: Optional[List[str]] = None) -> None:
    """Run the program with these arguments (default: those of the process)."""
    given = sys.argv[1:] if arguments is None else arguments
    options = _parser().parse_args([word for word in given if ":=" not in word])
    folder = options.folder or options.competition or ""
    try:
        settings = read_settings(options, given)
    except BadParams as error:
        # Which files and ports to check is not known.
        found = [Remark(Severity.FAILED, line, "correct the settings, then run this program again")
                 for line in str(error).splitlines()]
    else:
        found = findings(settings, folder, options.listen)
    for finding in found:
        print(f"{_MARKS[finding.level]}  {finding.text}")
        if finding.remedy:
            print(f"         -> {finding.remedy}")
    worst = [sum(f.level is level for f in found) for level in (Severity.FAILED, Severity.WARNING)]
    print(f"{worst[0]} failed, {worst[1]} warnings")
    sys.exit(1 if worst[0] else 0)
