"""The checks before a competition. Each gives a line for what it found, with the remedy.

A check returns its findings and raises nothing. `roah_rsbb.tools.preflight` is the program. `check_exposure` and
`check_clock` are for Linux only.
"""

import asyncio
import ctypes
import enum
import errno
import os
import shutil
import subprocess
import tempfile
from typing import Callable, Dict, List, NamedTuple, Optional

from roah_rsbb.client.places import OWN_VARIABLE, is_answering
from roah_rsbb.comm import sockets
from roah_rsbb.comm.channels import Network, PublicChannel
from roah_rsbb.ground.arguments import is_without_ros
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.rulebook import config
from roah_rsbb.rulebook.benchmarks import Config
from roah_rsbb.tools.competition import firewall
from roah_rsbb.tools.competition.check import module_errors, scheduled_modules, warnings_of_days
from roah_rsbb.tools.interfaces import Interface
from roah_rsbb.tools.open_ports import Listener, command_that_shows, open_to

# GiB. The run logs of a competition take megabytes. Below the first value, warn; below the second, the disk will fill.
ENOUGH_BYTES = 2 * 1024**3
FULL_BYTES = 200 * 1024**2
# Number of private ports above the public port to check: no port is used twice in a competition.
PORTS = 50
# The passwords of the included config/passwords.yaml, which may have been edited in place since.
SHIPPED_PASSWORDS = frozenset({"PASSWORD", "DefaultKey", "randomkey", "t9Kd2wQx", "Hb7mZ4pe", "vR3sY8nu", "J6cfW1ga"})
# Maximum number of open TCP ports in a line.
MAX_SHOWN = 10
_TIME_ERROR = 5  # result of adjtimex: the clock is not synchronised


class Severity(enum.IntEnum):
    """Severity of a finding."""

    OK = 0
    WARNING = 1
    FAILED = 2


class Remark(NamedTuple):
    """A line of the report."""

    level: Severity
    text: str
    remedy: str = ""


def check_network(rsbb_host: str, found: List[Interface]) -> Remark:
    """Check that robots can be reached at `rsbb_host`."""
    there_are = ", ".join(f"{i.broadcast} ({i.name}, {i.address})" for i in found
                          if i.broadcast and not i.address.startswith("127.")) or "none"
    for interface in found:
        if rsbb_host == interface.broadcast:
            if interface.address.startswith("127."):
                return Remark(Severity.WARNING, f"rsbb_host {rsbb_host} reaches this computer only",
                              f"good for a test; for robots in a network, use its broadcast address: {there_are}")
            return Remark(Severity.OK, f"rsbb_host {rsbb_host} is the broadcast address of {interface.name}")
    return Remark(Severity.FAILED, f"rsbb_host {rsbb_host} is not a broadcast address of this computer's networks",
                  f"connect the network with the robots, or set rsbb_host to one of: {there_are}")


def list_firewall() -> Optional[str]:
    """Return the loaded firewall table as nft prints it; "": it is not loaded; None: this user may not see it."""
    for nft in ("nft", "/usr/sbin/nft"):
        try:
            asked = subprocess.run([nft, "list", "table", "inet", firewall.TABLE], capture_output=True, timeout=10,
                                   check=False)
        except (OSError, subprocess.TimeoutExpired):
            continue
        if asked.returncode == 0:
            return asked.stdout.decode("utf-8", "replace")
        return None if b"not permitted" in asked.stderr else ""
    return ""


def check_exposure(
    rsbb_host: str, found: List[Interface], listening: List[Listener], loaded: Optional[str], file: str
) -> List[Remark]:
    """Check that the robots' network reaches nothing on this computer except the box.

    `listening`: all open TCP ports; `loaded`: see `list_firewall`; `file`: the firewall's file.
    """
    interface = next((i for i in found if i.broadcast == rsbb_host and not i.address.startswith("127.")), None)
    if interface is None:
        return []
    if loaded and interface.name in firewall.loaded_for(loaded):
        return [Remark(Severity.OK, f"the firewall is loaded: {interface.name} reaches only the box's ports")]
    remedy = f"load the firewall: sudo nft -f {file}"
    if loaded:
        return [Remark(Severity.WARNING, f"the firewall is loaded, but not for {interface.name}",
                       f"write that name into {file}, and load the file again: sudo nft -f {file}")]
    if loaded is None:
        remedy += f", or check whether it is loaded: sudo nft list table inet {firewall.TABLE}"
    reached = [port for port in open_to(listening, interface.address) if port.port != firewall.TABLET_PORT]
    shown = ", ".join(map(str, reached[:MAX_SHOWN])) + (", …" if len(reached) > MAX_SHOWN else "")
    text = f"robots' network on {interface.name}: the box's firewall was not found there"
    if not is_without_ros():
        text += ", and ROS has no password"
    if reached:
        text += f"; open now: TCP {shown}"
    return [Remark(Severity.WARNING, text, remedy)]


def check_bind(bind_host: str, port: int) -> List[Remark]:
    """Check that nothing but another program can keep the box from opening its UDP ports."""
    for number in (port, port + PORTS):
        try:
            sockets.listen(bind_host, number, False, "bind_host").close()
        except OSError as error:
            if error.errno != errno.EADDRINUSE:
                return [Remark(Severity.FAILED, str(error))]
    return []


def check_ports(bind_host: str, port: int) -> List[Remark]:
    """Check that the UDP ports are free."""
    taken = [number for number in range(port, port + PORTS + 1) if not _is_free(bind_host, number)]
    if not taken:
        return [Remark(Severity.OK, f"UDP ports {port} to {port + PORTS} are free")]
    if taken[0] == port:
        return [Remark(Severity.FAILED, f"UDP port {port} is used by another program",
                       f"end it ('{command_that_shows('udp', port)}' shows it; it may be a running box), or choose "
                       "another rsbb_port")]
    numbers = ", ".join(map(str, taken))
    return [Remark(Severity.WARNING, f"UDP ports are used by other programs: {numbers}",
                   "the box will skip them, but a firewall may not allow the ports that it uses instead")]


def _is_free(bind_host: str, port: int) -> bool:
    try:
        sockets.listen(bind_host, port, shared=False).close()
    except OSError as error:
        return error.errno != errno.EADDRINUSE
    return True


def check_other_box(rsbb_host: str, port: int, bind_host: str, seconds: float) -> Remark:
    """Check that no other box transmits: listen for `seconds`, as the box itself does."""
    heard: List[str] = []
    loop = asyncio.new_event_loop()

    def on_message(message: object, sender: tuple) -> None:
        if isinstance(message, pb.RoahRsbbBeacon):
            heard.append(sender[0])
            loop.stop()

    channel = PublicChannel(loop, Network(rsbb_host, port, bind_host), on_message, lambda _: None)
    try:
        channel.open()
        loop.call_later(seconds, loop.stop)
        loop.run_forever()
    except OSError as error:
        return Remark(Severity.FAILED, f"cannot listen to the network: {error}", "see the lines above")
    finally:
        channel.close()
        loop.close()
    if heard:
        return Remark(Severity.FAILED, f"another RSBB transmits from {heard[0]}",
                      "end it: robots obey both. If it is your own box, it is already running")
    return Remark(Severity.OK, f"no other RSBB was heard in {seconds:g} s")


def check_door(path: str) -> Remark:
    """Check that terminals will find the box without ROS. `path`: the file in which it says where its door is."""
    if is_answering(path):
        return Remark(Severity.WARNING, f"a box without ROS runs already: {path} says where its door is",
                      f"end it. If both are to run, start this one with {OWN_VARIABLE} set to another file")
    folder = os.path.dirname(os.path.abspath(path))
    try:
        _try_to_write(folder)
    except OSError as error:
        return Remark(Severity.FAILED,
                      f"{folder} cannot be written: {error.strerror}. Terminals would not find the box",
                      f"give this user write permission, or set {OWN_VARIABLE} to a file in another folder")
    return Remark(Severity.OK, f"terminals will find the box by {path}")


def is_synchronised() -> Optional[bool]:
    """Whether NTP synchronises the kernel's clock; None: unknown."""
    try:
        state = ctypes.CDLL(None).adjtimex(ctypes.create_string_buffer(512))
    except (OSError, AttributeError):
        return None
    return None if state < 0 else state != _TIME_ERROR


def check_clock(synchronised: Optional[bool]) -> Remark:
    """Check this computer's clock: robots whose clocks differ from it by 0.1 s cannot start."""
    if synchronised:
        return Remark(Severity.OK, "this computer's clock is synchronised")
    what = "is not synchronised" if synchronised is False else "may not be synchronised: the system does not report it"
    return Remark(Severity.WARNING, f"this computer's clock {what}",
                  "synchronise it and all robots with one NTP server (chrony, systemd-timesyncd). Without the "
                  "Internet, this computer can be that server")


def check_log_dir(log_dir: str, usage: Callable[[str], object] = shutil.disk_usage) -> List[Remark]:
    """Check that logs can be written, and that the disk has enough space."""
    try:
        _try_to_write(log_dir)
        free = usage(log_dir).free
    except OSError as error:
        return [Remark(Severity.FAILED, f"log_dir {log_dir} cannot be written: {error.strerror}",
                       "choose another log_dir, or give this user write permission")]
    found = [Remark(Severity.OK, f"log_dir {log_dir} can be written")]
    text = f"{free / 1024**3:.1f} GiB are free there"
    if free < ENOUGH_BYTES:
        level = Severity.FAILED if free < FULL_BYTES else Severity.WARNING
        found.append(Remark(level, f"only {text}", "free some, or choose a log_dir on another disk"))
    else:
        found.append(Remark(Severity.OK, text))
    return found


def _try_to_write(folder: str) -> None:
    """Make a folder, and try to write a file there. Raises OSError."""
    os.makedirs(folder, mode=0o750, exist_ok=True)
    with tempfile.TemporaryFile(dir=folder) as trial:
        trial.write(b"x" * 4096)
        trial.flush()
        os.fsync(trial.fileno())


def check_configuration(files: Dict[str, str], modules_dir: str) -> List[Remark]:
    """Check the configuration files. `files`: benchmarks_file, schedule_file, passwords_file."""
    try:
        loaded, warnings = config.load(files["benchmarks_file"], files["schedule_file"], files["passwords_file"])
    except config.ConfigErrors as errors:
        return [Remark(Severity.FAILED, line, "") for line in str(errors).splitlines()]
    events = sum(len(zone.events) for zone in loaded.zones)
    found = [Remark(Severity.OK, f"the configuration is valid: {len(loaded.zones)} zones, {events} events")]
    found += [Remark(Severity.WARNING, warning, "")
              for warning in [*warnings, *warnings_of_days(files["schedule_file"], loaded)]]
    return [*found, *_check_modules(loaded, modules_dir), _check_passwords(loaded)]


def _check_modules(loaded: Config, modules_dir: str) -> List[Remark]:
    """Check the parameters of the benchmarking modules that the schedule needs."""
    codes = scheduled_modules(loaded)
    if not codes:
        return []
    errors = module_errors(modules_dir, loaded)
    if errors:
        return [Remark(Severity.FAILED, line, "") for line in errors]
    return [Remark(Severity.OK, f"the parameters of the benchmarking modules are valid: {', '.join(codes)}")]


def _check_passwords(loaded: Config) -> Remark:
    """Check that no team uses an included password, which is public."""
    taking_part = {event.team for zone in loaded.zones for event in zone.events}
    weak = sorted(team for team in taking_part if loaded.passwords.get(team) in SHIPPED_PASSWORDS)
    if weak:
        return Remark(Severity.WARNING, f"passwords from the included passwords file: {', '.join(weak)}",
                      "give each team a new password: anybody can read these")
    return Remark(Severity.OK, "no team has a password from the included passwords file")


def check_player(command: str, installed: Callable[[str], Optional[str]] = shutil.which) -> Remark:
    """Check that the bell and the timeout can be heard. `command`: a program that plays sounds."""
    if installed(command):
        return Remark(Severity.OK, f"sounds are played by {command}")
    return Remark(Severity.WARNING, f"{command} is not installed: the sounds that it plays will not be heard",
                  "install alsa-utils, or set bell_ring_command and timeout_ring_command")


def check_display(there_is_one: bool) -> Remark:
    """Check that the referee's window can open."""
    if there_is_one:
        return Remark(Severity.OK, "windows can be opened here")
    return Remark(Severity.WARNING, "no window can be opened here", "log in at a desktop, or let referees use other "
                  "computers (roah_rsbb_client.launch) or a terminal (rosrun roah_rsbb referee)")
