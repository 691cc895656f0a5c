"""The checks of what a venue has besides its network: motion capture, home devices, the tablet's page.

Each check looks only at what the schedule needs. It returns its findings and raises nothing.
"""

import errno
import os
import socket
from typing import Callable, Dict, List, Optional, Sequence, Tuple

from roah_rsbb.bmbox.framework.ground_truth import Source
from roah_rsbb.bmbox.framework.rule_files import file_in, load_rules, modules, own_files
from roah_rsbb.bmbox.host.ground_truth_of_frames import FILE_NAME, FrameState, GroundTruthConfig, NoFrames, load
from roah_rsbb.core.copies import NO_PORT
from roah_rsbb.ground.arguments import is_without_ros
from roah_rsbb.rulebook import config
from roah_rsbb.rulebook.benchmarks import Config, Durable
from roah_rsbb.rulebook.errors import ConfigErrors
from roah_rsbb.rulebook.registry import BELL, DEVICES, TABLET, BenchmarkKind
from roah_rsbb.tools.open_ports import command_that_shows
from roah_rsbb.tools.preflight_checks import Remark, Severity

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
        kind = load_rules(own[code]) if code in own else modules().get(code)
    except ConfigErrors:
        return ()
    return () if kind is None else tuple(kind.SUBJECTS)
