"""The measured processes: a ROS master, the box, and programs beside it, with their load on the machine."""

import os
import pathlib
import random
import shutil
import socket
import sys
import tempfile
import time
import xml.etree.ElementTree
from typing import Dict, List

import rosgraph
import rospy
from addresses import BOX_HOST, BROADCAST
from support.programs import Program

from roah_rsbb.srv import Zone

ROOT = pathlib.Path(__file__).resolve().parent.parent
# Below the ports of the tests (from 20000), so that both can run at the same time.
PORTS = range(10000, 19800, 200)
START_S = 30.0
CORE = "/roah_rsbb_core"
# Linux makes the number of a process's clock from its id and this one (CPUCLOCK_SCHED). /proc only counts in 10 ms.
_SCHEDULED = 2


class Measured(Program):
    """A program whose resource usage can be read."""

    @property
    def pid(self) -> int:
        return self._process.pid

    def cpu_s(self) -> float:
        """Processor time in seconds, in user and kernel mode."""
        return time.clock_gettime(~self.pid << 3 | _SCHEDULED)

    def cpu_percent(self, seconds: float) -> float:
        """Share of one processor (per cent) that it uses in the next `seconds`."""
        began, used = time.monotonic(), self.cpu_s()
        time.sleep(seconds)
        return 100.0 * (self.cpu_s() - used) / (time.monotonic() - began)

    def waited_s(self) -> float:
        """Seconds in which its main thread was ready but had to wait for a processor."""
        return int(pathlib.Path(f"/proc/{self.pid}/schedstat").read_text(encoding="ascii").split()[1]) / 1e9

    def memory_mb(self) -> float:
        """Resident memory, MB."""
        status = pathlib.Path(f"/proc/{self.pid}/status").read_text(encoding="ascii")
        return next(int(line.split()[1]) for line in status.splitlines() if line.startswith("VmRSS")) / 1000.0


def start_master() -> Program:
    """The bench's own ROS master, which this process also uses."""
    with socket.socket() as free:
        free.bind((BOX_HOST, 0))
        port = free.getsockname()[1]
    os.environ.update(ROS_MASTER_URI=f"http://127.0.0.1:{port}", ROS_IP="127.0.0.1")
    os.environ.pop("ROS_HOSTNAME", None)
    master = Program("rosmaster", "--core", "-p", str(port))
    wait(rosgraph.is_master_online, "the ROS master answers")
    return master


def wait(condition, what: str, limit_s: float = START_S) -> None:
    """Wait until a condition holds. It is checked often, because no event signals it."""
    until = time.monotonic() + limit_s
    while not condition():
        if time.monotonic() > until:
            raise SystemExit(f"bench: after {limit_s:.0f} s still not: {what}")
        time.sleep(0.01)


def free_port() -> int:
    """The first of 200 unused UDP ports on this machine. Only the first one is checked."""
    for port in random.sample(PORTS, len(PORTS)):
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            try:
                probe.bind(("", port))
            except OSError:
                continue
            return port
    raise SystemExit(f"bench: all UDP ports from {PORTS.start} on are in use: what runs on this machine?")


class Box:
    """The real core node with the given number of zones and a team for each. Use it as a context manager."""

    def __init__(self, zones: int, profile: str = "", has_pages: bool = False) -> None:
        """`profile`: file for the cProfile data of its main thread. `has_pages`: it serves the web pages."""
        self.zones = zones
        self.port = free_port()
        with socket.socket() as free:
            free.bind((BOX_HOST, 0))
            self.web_port = free.getsockname()[1]
        self._folder = pathlib.Path(tempfile.mkdtemp(prefix="roah_rsbb_bench."))
        self._configure()
        self.process = self._started(profile, {
            "rsbb_host": BROADCAST, "bind_host": BOX_HOST, "rsbb_port": self.port, "listen_duration": 0.3,
            "log_dir": self._folder / "log", "max_datagram": 8000, "robot_timeout": 30.0,
            "web": str(has_pages).lower(), "web_port": self.web_port,
            **{f"{name}_file": self._folder / f"{name}.yaml" for name in ("benchmarks", "schedule", "passwords")},
        })

    @property
    def log_dir(self) -> pathlib.Path:
        """The folder of its journal."""
        return self._folder / "log"

    @property
    def passwords(self) -> pathlib.Path:
        """Its file of passwords."""
        return self._folder / "passwords.yaml"

    def _started(self, profile: str, settings: Dict[str, object]) -> Measured:
        launcher = [sys.executable] if not profile else [sys.executable, "-m", "cProfile", "-o", profile]
        return Measured(
            *launcher, str(ROOT / "scripts" / "roah_rsbb_core"), "--unsupervised",
            *(f"_{k}:={v}" for k, v in settings.items()))

    def _configure(self) -> None:
        # The benchmarks of competitions, with timeouts so long that no run of the bench ends by itself.
        shipped = (ROOT / "config" / "benchmarks.yaml").read_text(encoding="utf-8")
        files = {
            "benchmarks": shipped.replace("timeout: 600", "timeout: 36000"),
            "passwords": "".join(f"Team{i}: password {i}\n" for i in range(self.zones)),
            "schedule": "".join(
                f"- zone: zone {i}\n  schedule:\n" + "".join(
                    f"    - {{benchmark: HWV, team: Team{i}, round: 1, run: {run}, "
                    f"scheduled_time: 2026-01-01 0{run}:00:00}}\n" for run in (1, 2))
                for i in range(self.zones)),
        }
        for name, text in files.items():
            path = self._folder / f"{name}.yaml"
            path.touch(mode=0o600)
            path.write_text(text, encoding="utf-8")

    def __enter__(self) -> "Box":
        for service in ("connect", "start", "stop"):
            try:
                rospy.wait_for_service(f"/core/{service}", START_S)
            except rospy.ROSException:
                raise SystemExit(f"bench: the core did not start:\n{self.process.text}") from None
        return self

    def __exit__(self, *_error: object) -> None:
        self.process.close()
        shutil.rmtree(self._folder, ignore_errors=True)

    def command(self, command: str, zone: int) -> None:
        """A referee's command, called like in a panel. Raises the exception of the service call."""
        rospy.ServiceProxy(f"/core/{command}", Zone)(f"zone {zone}")

    def command_when_allowed(self, command: str, zone: int) -> None:
        """Call the command as soon as the box allows it."""
        until = time.monotonic() + START_S
        while True:
            try:
                self.command(command, zone)
                return
            except rospy.ServiceException as error:
                if time.monotonic() > until:
                    raise SystemExit(f"bench: {command} of zone {zone}: {error}") from None
                time.sleep(0.05)

    def dropped(self) -> int:
        """Datagrams that the kernel dropped because the box did not read them in time."""
        lines = pathlib.Path("/proc/net/udp").read_text(encoding="ascii").splitlines()[1:]
        return sum(int(fields[-1]) for fields in map(str.split, lines) if self._is_ours(fields[1]))

    def _is_ours(self, address: str) -> bool:
        host, _, port = address.partition(":")
        ours: List[str] = ["0100007F", "FFFFFF7F"]
        return host in ours and self.port <= int(port, 16) < self.port + PORTS.step


def _arguments(launch: pathlib.Path) -> Dict[str, str]:
    """The arguments of a launch file, and their defaults."""
    found = xml.etree.ElementTree.parse(str(launch)).getroot().findall("arg")
    return {argument.attrib["name"]: argument.get("default", "") for argument in found}


class LaunchedBox(Box):
    """The core node, started by roslaunch as in `roah_rsbb.launch`, so that it restarts when it dies."""

    def _started(self, profile: str, settings: Dict[str, object]) -> Measured:
        for name in ("listen_duration", "max_datagram"):
            rospy.set_param(f"{CORE}/{name}", settings[name])
        launch = ROOT / "launch" / "core.launch.xml"
        usual = _arguments(ROOT / "launch" / "roah_rsbb.launch")
        given = {name: settings.get(name, usual[name]) for name in _arguments(launch)}
        given["standings_file"] = "none"
        return Measured("roslaunch", str(launch), *(f"{name}:={value}" for name, value in given.items()))
