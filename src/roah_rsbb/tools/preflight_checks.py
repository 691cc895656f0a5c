"""The checks before a competition. Each gives a line for what it found, with the remedy.

A check returns its findings and raises nothing. `roah_rsbb.tools.preflight` is the program. Those of what a venue has
besides its network (motion capture, home devices, the tablet's page) look only at what the schedule needs.
"""

import asyncio
import ctypes
import enum
import errno
import os
import shlex
import shutil
import socket
import subprocess
import tempfile
from typing import Callable, Dict, List, NamedTuple, Optional, Sequence, Tuple

from roah_rsbb.bmbox.framework.ground_truth import Source
from roah_rsbb.bmbox.framework.rule_files import file_in, load_tried, modules, own_files
from roah_rsbb.bmbox.host.ground_truth_of_frames import FILE_NAME, FrameState, GroundTruthConfig, NoFrames, load
from roah_rsbb.client.places import OWN_VARIABLE, is_answering
from roah_rsbb.comm import sockets
from roah_rsbb.comm.channels import Network, PublicChannel
from roah_rsbb.core.copies import NO_PORT
from roah_rsbb.devices.sounds import BELL as BELL_FILE
from roah_rsbb.devices.sounds import SILENCE
from roah_rsbb.ground.arguments import is_without_ros
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.rulebook import config
from roah_rsbb.rulebook.benchmarks import Config, Durable
from roah_rsbb.rulebook.errors import ConfigErrors
from roah_rsbb.rulebook.registry import BELL, DEVICES, TABLET, BenchmarkKind
from roah_rsbb.tools.competition import files
from roah_rsbb.tools.competition.check import module_errors, scheduled_modules, warnings_of_days
from roah_rsbb.tools.ports import Interface, Listener, command_that_shows, open_to

# GiB. The run logs of a competition take megabytes. Below the first value, warn; below the second, the disk will fill.
ENOUGH_BYTES = 2 * 1024**3
FULL_BYTES = 200 * 1024**2
# Number of private ports above the public port to check: no port is used twice in a competition.
PORTS = 50
# The passwords of the included config/passwords.yaml, which may have been edited in place since.
SHIPPED_PASSWORDS = frozenset({"PASSWORD", "DefaultKey", "randomkey", "t9Kd2wQx", "Hb7mZ4pe", "vR3sY8nu", "J6cfW1ga"})
# Maximum number of open TCP ports in a line.
MAX_SHOWN = 10
# Seconds in which a player plays silence.
PLAYER_S = 5.0
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
            asked = subprocess.run([nft, "list", "table", "inet", files.TABLE], capture_output=True, timeout=10,
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
    if loaded and interface.name in files.loaded_for(loaded):
        return [Remark(Severity.OK, f"the firewall is loaded: {interface.name} reaches only the box's ports")]
    remedy = f"load the firewall: sudo nft -f {file}"
    if loaded:
        return [Remark(Severity.WARNING, f"the firewall is loaded, but not for {interface.name}",
                       f"write that name into {file}, and load the file again: sudo nft -f {file}")]
    if loaded is None:
        remedy += f", or check whether it is loaded: sudo nft list table inet {files.TABLE}"
    reached = [port for port in open_to(listening, interface.address) if port.port != files.TABLET_PORT]
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


def check_player(command: Sequence[str], limit_s: float = PLAYER_S) -> Remark:
    """Check that the bell and the timeout can be heard. `command`: plays one of them, or silence; only that is tried.
    """
    player, remedy = command[0], "set bell_ring_command and timeout_ring_command"
    if not shutil.which(player):
        return Remark(Severity.WARNING, f"{player} is not installed: the sounds that it plays will not be heard",
                      f"install alsa-utils, or {remedy}")
    if not command[-1].endswith(SILENCE):
        return Remark(Severity.OK, f"sounds are played by {player}. It was not tried, because that can be heard")
    try:
        tried = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, timeout=limit_s, check=False)
    except subprocess.TimeoutExpired:
        why = f"it did not end within {limit_s:g} s"
    except OSError as error:
        why = str(error.strerror)
    else:
        if tried.returncode == 0:
            return Remark(Severity.OK, f"sounds are played by {player}")
        said = tried.stderr.decode("utf-8", "replace").strip().splitlines()
        why = said[-1] if said else f"it failed with status {tried.returncode}"
    audible = shlex.join([*command[:-1], command[-1][:-len(SILENCE)] + BELL_FILE])
    return Remark(Severity.WARNING, f"{player} cannot play the sounds, so nobody will hear them: {why}",
                  f"connect and choose a sound device, then try it: {audible}. Or {remedy}")


def check_display(there_is_one: bool) -> Remark:
    """Check that the referee's window can open."""
    if there_is_one:
        return Remark(Severity.OK, "windows can be opened here")
    return Remark(Severity.WARNING, "no window can be opened here", "log in at a desktop, or let referees use other "
                  "computers (roah_rsbb_client.launch) or a terminal (rosrun roah_rsbb referee)")


CONNECT_S = 3.0

# Returns the state of all markers; None: there is no ROS master.
Look = Callable[[GroundTruthConfig], Optional[Sequence[FrameState]]]


def loaded_config(files: Dict[str, str]) -> Optional[Config]:
    """Return the configuration; None: it has errors, which another check reports."""
    try:
        return config.load(files["benchmarks_file"], files["schedule_file"], files["passwords_file"])[0]
    except ConfigErrors:
        return None


def _needing(loaded: Config, *uses: str) -> List[str]:
    """Return the codes of the scheduled benchmarks that use one of these."""
    found = {event.benchmark for zone in loaded.zones for event in zone.events}
    return sorted(benchmark.code for benchmark in found if benchmark.profile.uses.intersection(uses))


def check_tablet_port(loaded: Config, host: str, port: int) -> List[Remark]:
    """Check that the tablet's page can be served, if a benchmark needs it."""
    codes = _needing(loaded, TABLET)
    if not codes:
        return []
    return [_check_tcp_port(host, port, "the tablet's page", "tablet_port", Severity.FAILED,
                            f". The page is for {', '.join(codes)}")]


def check_web_port(host: str, port: int) -> Remark:
    """Check that the web pages can be served. With ROS, there are panels, and runs do not need the pages."""
    level = Severity.FAILED if is_without_ros() else Severity.WARNING
    return _check_tcp_port(host, port, "the web pages", "web_port", level, "")


def _check_tcp_port(host: str, port: int, what: str, parameter: str, level: Severity, purpose: str) -> Remark:
    with socket.socket(socket.AF_INET, socket.SOCK_STREAM) as trial:
        trial.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            trial.bind((host, port))
        except OSError as error:
            in_use = f"end the program that uses it ('{command_that_shows('tcp', port)}' shows it), or "
            return Remark(level, f"TCP port {port} of {what} cannot be used: {os.strerror(error.errno or 0)}",
                          f"{in_use if error.errno == errno.EADDRINUSE else ''}choose another {parameter}{purpose}")
    return Remark(Severity.OK, f"TCP port {port} of {what} is free")


def check_standby(loaded: Config, port: int) -> List[Remark]:
    """Check that the box will start: with `durable: two`, it needs a port for a standby."""
    if loaded.durable is not Durable.TWO or port:
        return []
    text, _, remedy = NO_PORT.format(place=loaded.durable_at).rpartition(": ")
    return [Remark(Severity.FAILED, f"the box will not start. {text}", remedy)]


def check_devices(loaded: Config, host: str, port: int) -> List[Remark]:
    """Check that the controller of the home devices can be reached, if a benchmark needs it. `host`: empty: the box
    does not control them."""
    codes = _needing(loaded, DEVICES, BELL)
    if not codes:
        return []
    if not host:
        return [Remark(Severity.WARNING, f"the home devices are off, and {', '.join(codes)} may need them",
                       "start the box with devices:=true smartif_host:=ADDRESS of their controller")]
    try:
        socket.create_connection((host, port), CONNECT_S).close()
    except OSError as error:
        why = error.strerror or str(error) or "no answer"
        return [Remark(Severity.FAILED, f"the SmartIF controller at {host}:{port} cannot be reached: {why}",
                       f"switch it on, check its cable and smartif_host. The home devices are for {', '.join(codes)}")]
    return [Remark(Severity.OK, f"the SmartIF controller at {host}:{port} can be reached")]


def check_ground_truth(loaded: Config, modules_dir: str, look: Optional[Look]) -> List[Remark]:
    """Check that the motion-capture system sees the markers that the scheduled benchmarks need. `look`: None: without
    ROS nobody can look."""
    found: List[Remark] = []
    for path, subjects in _subjects_by_file(loaded, modules_dir).items():
        try:
            truth = load(path)
        except ConfigErrors:
            continue  # another check reports the errors
        if truth.source is not Source.MOTION_CAPTURE:
            who = "the referee enters all poses" if truth.source is Source.REFEREE else "poses are not scored"
            found.append(Remark(Severity.OK, f"no motion capture in {path}: {who}"))
            continue
        if look is None:
            found.append(_not_seen(path))
            continue
        states = look(truth)
        if states is None:
            found.append(Remark(Severity.WARNING, f"the markers of {path} were not checked: no ROS master",
                                "start roscore and the motion capture, then: rosrun roah_rsbb check_ground_truth "
                                + path))
            continue
        missing = [s for s in states if s.subject in subjects and s.pose is None]
        found += [Remark(Severity.WARNING, f"marker not seen: {state.trouble}", f"its frame is in {path}")
                  for state in missing]
        if not missing:
            found.append(Remark(Severity.OK, f"the motion capture sees all markers of {path}"))
    return found


def _not_seen(path: str) -> Remark:
    if is_without_ros():
        return Remark(Severity.WARNING, f"a box without ROS sees no markers of {path}", NoFrames.REMEDY_MARKER)
    return Remark(Severity.WARNING, f"the markers of {path} were not checked: only ROS can see them",
                  "run 'rosrun roah_rsbb preflight' on a computer with ROS")


def _subjects_by_file(loaded: Config, modules_dir: str) -> Dict[str, Tuple[str, ...]]:
    """Return the files with the ground truth of the scheduled benchmarks, each with the needed subjects."""
    found: Dict[str, Tuple[str, ...]] = {}
    subjects: Dict[str, Tuple[str, ...]] = {}
    for zone in loaded.zones:
        for benchmark in {event.benchmark for event in zone.events}:
            if benchmark.kind is BenchmarkKind.FUNCTIONALITY:
                if benchmark.code not in subjects:
                    subjects[benchmark.code] = _subjects(modules_dir, benchmark.code)
                needed = subjects[benchmark.code]
                if needed:
                    path = file_in(modules_dir, zone.name, FILE_NAME)
                    found[path] = tuple(dict.fromkeys((*found.get(path, ()), *needed)))
    return {path: found[path] for path in sorted(found, key=lambda path: (os.path.dirname(path), path))}


def _subjects(modules_dir: str, code: str) -> Tuple[str, ...]:
    """Return whose poses the rules of a benchmark need; none if the rules have errors."""
    own = own_files(modules_dir)
    try:
        kind = load_tried(own[code]) if code in own else modules().get(code)
    except ConfigErrors:
        return ()
    return () if kind is None else tuple(kind.SUBJECTS)
