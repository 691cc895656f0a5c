"""Two computers that can be the box, robots and a witness: a network without the process of the test."""

import contextlib
import os
import pathlib
import re
import shutil
import signal
import socket
import subprocess
import sys
import time
from typing import Any, Dict, Iterator, List, NamedTuple, Optional, Sequence, Union

from crew import RSBB_PORT, Robot, password_of
from namespaces import BROADCAST, INTERFACE, Host, Station, Switch, address, other_address, run_ip
from support.programs import Program, own
from support.waiting import happened, wait_until

from box import WITH_ROS, WITHOUT_ROS
from roah_rsbb.journal.log_dir import JOURNAL, holder_of
from roah_rsbb.robot.effects import Problem

BOX, STANDBY, WITNESS, FIRST_ROBOT = 1, 2, 3, 11
TEAMS = ("Alpha", "Beta", "Gamma", "Delta", "Epsilon", "Zeta", "Eta", "Theta", "Iota", "Kappa")
STANDBY_PORT = 8083
LIMIT_S = 120.0
EXECUTE_S = 0.5
# The referee of these tests is a program in the box's namespace, with its own ROS master.
ROS = {"ROS_MASTER_URI": "http://127.0.0.1:11311", "ROS_IP": "127.0.0.1"}
WITHOUT = ("gui:=none", "modules:=false", "tablet:=false", "web:=false", "devices:=false")
_ETH_P_ALL = 3
_ARP, _IPV4 = 0x0806, 0x0800
_UDP = 17


class Frame(NamedTuple):
    """What a host sent to the switch."""

    mono: float
    number: int  # of the host
    source: str  # address of the sender
    port: int  # UDP port that it is for; 0: it announces the sender's address by ARP


class Capture:
    """All that comes to the switch: UDP datagrams, and announcements of addresses."""

    def __init__(self, switch: Host) -> None:
        self.frames: List[Frame] = []
        self._switch = switch
        self._socket = switch.do(self._open)

    def _open(self) -> socket.socket:
        found = socket.socket(socket.AF_PACKET, socket.SOCK_RAW, socket.htons(_ETH_P_ALL))
        found.setblocking(False)
        self._switch.loop.add_reader(found, self._read)
        return found

    def _read(self) -> None:
        with contextlib.suppress(BlockingIOError):
            while True:
                data, (interface, kind, way, *_) = self._socket.recvfrom(65536)
                if way != socket.PACKET_OUTGOING and interface.startswith("port"):
                    self._take(int(interface[4:]), kind, data[14:])

    def _take(self, number: int, kind: int, data: bytes) -> None:
        now = time.monotonic()
        if kind == _ARP and data[14:18] == data[24:28]:
            self.frames.append(Frame(now, number, socket.inet_ntoa(data[14:18]), 0))
        elif kind == _IPV4 and data[9] == _UDP:
            begin = 4 * (data[0] & 0x0F)
            self.frames.append(Frame(now, number, socket.inet_ntoa(data[12:16]),
                                     int.from_bytes(data[begin + 2:begin + 4], "big")))
        else:
            return
        happened()

    def of(self, number: int, port: int, since_mono: float = 0.0) -> List[Frame]:
        """What this host sent to that UDP port."""
        return [frame for frame in list(self.frames)
                if (frame.number, frame.port) == (number, port) and frame.mono >= since_mono]

    def announced(self, number: int, host: str) -> bool:
        """Whether this host announced that address."""
        return any(frame.source == host for frame in self.of(number, 0))

    def close(self) -> None:
        """Stop."""
        self._switch.do(lambda: (self._switch.loop.remove_reader(self._socket), self._socket.close()))


class Computer:
    """A computer that can be the box. Its programs are in its namespace."""

    def __init__(self, station: Station, folder: pathlib.Path, kind: str) -> None:
        self.station = station
        self.folder = folder
        self.kind = kind  # WITH_ROS, WITHOUT_ROS
        folder.mkdir(parents=True)
        self._programs: List[Program] = []

    @property
    def log_dir(self) -> pathlib.Path:
        """Of the box, or the folder of the copy."""
        return self.folder / "log"

    @property
    def copy_dir(self) -> pathlib.Path:
        """The folder of the copy after the computer was the box."""
        return self.folder / "copy"

    def start(self, *command: str) -> Program:
        """Start a program of this package, or roslaunch."""
        if self.kind == WITHOUT_ROS:
            words, environment = ("-m", "roah_rsbb.tools.team", *command), {
                "HOME": str(self.folder), "ROS_MASTER_URI": ""}
        else:
            path = shutil.which(command[0]) if command[0] == "roslaunch" else own(command[0])
            words, environment = (path, *command[1:]), {
                **ROS, "ROS_HOME": str(self.folder), "ROS_LOG_DIR": str(self.folder / "ros")}
        # Executed and not forked: the process that forks is in another namespace.
        program = self.station.host.do(lambda: Program(sys.executable, *words, **environment))
        self._programs.append(program)
        return program

    def run(self, *command: str) -> Program:
        """Run a program to its end."""
        program = self.start(*command)
        program.wait_ended(LIMIT_S)
        return program

    def box(self) -> Program:
        """Start the box as an organiser does."""
        start = ("run", "--no-browser") if self.kind == WITHOUT_ROS else ("roslaunch", "roah_rsbb", "roah_rsbb.launch")
        return self.start(*start, f"log_dir:={self.log_dir}",
                          f"rsbb_host:={BROADCAST}", f"standby_port:={STANDBY_PORT}",
                          f"schedule_file:={self.folder}/schedule.yaml",
                          f"passwords_file:={self.folder}/passwords.yaml", *WITHOUT)

    def follow(self, *options: str) -> Program:
        """Start to keep a copy."""
        return self.start("standby", "follow", "--log-dir", str(self.log_dir), *options, *WITHOUT)

    def takeover(self, *options: str) -> Program:
        """Request a takeover; returns at once."""
        return self.start("standby", "takeover", "--log-dir", str(self.log_dir), *options)

    def rejoin(self) -> Program:
        """Become the standby of the computer that took over."""
        return self.start("standby", "rejoin", str(self.log_dir), "--log-dir", str(self.copy_dir), *WITHOUT)

    def shows(self, *command: str) -> str:
        """What the referee's program shows."""
        program = self.run("referee", *command)
        assert program.wait_ended() == 0, program.text
        return program.text

    def wait_shows(self, texts: Union[str, Sequence[str]], *command: str) -> str:
        """Wait until the referee's program shows a text, or one of these; returns all of it. The box may just be
        starting."""
        deadline = time.monotonic() + LIMIT_S
        while True:
            shown = self.run("referee", *command).text
            if any(text in shown for text in ([texts] if isinstance(texts, str) else texts)):
                return shown
            assert time.monotonic() < deadline, shown

    def referee(self, *command: str) -> None:
        """Do something as the referee, again and again until the box accepts it."""
        deadline = time.monotonic() + LIMIT_S
        while True:
            program = self.run("referee", *command)
            if not program.wait_ended():
                return
            assert time.monotonic() < deadline, program.text

    def cut(self) -> None:
        """Its link goes down."""
        self.station.host.do(run_ip, f"link set {INTERFACE} down")

    def plug(self) -> None:
        """Its link comes up again."""
        self.station.host.do(run_ip, f"link set {INTERFACE} up")

    def readdress(self) -> None:
        """Give it another address: its first one belongs to another computer now."""
        old, new = address(self.station.number), other_address(self.station.number)
        self.station.host.do(run_ip, f"address del {old}/24 dev {INTERFACE}",
                             f"address add {new}/24 brd {BROADCAST} dev {INTERFACE}")

    def addresses(self) -> List[str]:
        """Its addresses on the network."""
        return self.station.host.do(addresses_of)

    def burn(self) -> None:
        """Kill all its processes."""
        self.signal(signal.SIGKILL)
        for program in self._programs:
            program.wait_ended(LIMIT_S)

    def _processes(self) -> Iterator[int]:
        mine = os.stat(self.station.host.path).st_ino
        for pid in [int(name) for name in os.listdir("/proc") if name.isdigit() and int(name) != os.getpid()]:
            with contextlib.suppress(OSError):
                if os.stat(f"/proc/{pid}/ns/net").st_ino == mine:
                    yield pid

    def signal(self, number: int, *but: str) -> None:
        """Send a signal to all its processes, but not to those with one of these words in their command."""
        for pid in self._processes():
            with contextlib.suppress(OSError):
                if not {*pathlib.Path(f"/proc/{pid}/cmdline").read_bytes().decode().split("\0")}.intersection(but):
                    os.kill(pid, number)

    def let_only_copy(self) -> None:
        """Stop all its processes, except the one that copies the journal."""
        self.signal(signal.SIGSTOP, "copies")

    def core(self) -> int:
        """The process of its core."""
        return holder_of(str(self.log_dir))

    def close(self) -> None:
        """End all its programs, also those that a test stopped."""
        self.signal(signal.SIGCONT)
        for program in reversed(self._programs):
            program.signal(signal.SIGINT)
        for program in self._programs:
            program.close()
        for place, program in enumerate(self._programs):
            (self.folder / f"output{place}.txt").write_text(program.text, encoding="utf-8")
        self.burn()


def addresses_of() -> List[str]:
    """The addresses of the calling thread's host."""
    shown = subprocess.run(["ip", "-4", "-o", "address", "show", "dev", INTERFACE], capture_output=True, text=True)
    return re.findall(r"inet ([0-9.]+)/", shown.stdout)


class Pair:
    """Box, standby, witness and robots, on one switch. Use it as a context."""

    def __init__(self, folder: pathlib.Path, robots: int = 2, kind: str = WITH_ROS) -> None:
        """`folder` is emptied. `kind`: WITH_ROS, or WITHOUT_ROS. Raises `NoRight`."""
        shutil.rmtree(folder, ignore_errors=True)
        self._cleanup = contextlib.ExitStack()
        self.switch = Switch()
        self._cleanup.callback(self.switch.close)
        self.stations: Dict[int, Station] = {}
        for number in (BOX, STANDBY, WITNESS, *range(FIRST_ROBOT, FIRST_ROBOT + robots)):
            station = self.stations[number] = self.switch.station(number)
            self._cleanup.callback(station.host.close)
        self.capture = Capture(self.switch.host)
        self._cleanup.callback(self.capture.close)
        self.box, self.standby = (Computer(self.stations[number], folder / name, kind)
                                  for number, name in ((BOX, "box"), (STANDBY, "standby")))
        self.teams = TEAMS[:robots]
        self.robots: List[Robot] = []
        _write_competition(self.box.folder, self.teams)
        self.follower: Optional[Program] = None

    def __enter__(self) -> "Pair":
        return self

    def __exit__(self, *_: object) -> None:
        for robot in self.robots:
            robot.end()
        for computer in (self.standby, self.box):
            computer.close()
        self._cleanup.close()

    def begin(self, *follow: str, host: str = BROADCAST, has_robots: bool = True) -> Program:
        """Start box, standby and robots; returns the box's program. `follow`: options of the standby. `host`: to which
        robots send."""
        box = self.box.box()
        for ready in ("For a code, enter", "Listening on UDP"):
            box.wait_printed(ready)
        shown = self.box.run("standby", "code", "--log-dir", str(self.box.log_dir)).text
        code = re.search("The code is ([A-Z0-9-]+)", shown).group(1)
        self.follower = self.standby.follow(address(BOX), "--code", code, *follow)
        if has_robots:
            self.robots = [Robot(self.stations[FIRST_ROBOT + place], team, EXECUTE_S, 1, host=host)
                           for place, team in enumerate(self.teams)]
        for robot in self.robots:
            robot.held = True
        return box

    def run(self) -> None:
        """Start a run in each zone, and wait until its robot executes."""
        for team in self.teams:
            self.box.referee("connect", zone_of(team))
            self.box.referee("start", zone_of(team))
        wait_until(lambda: all(robot.did("EXECUTING") for robot in self.robots), "all robots execute", LIMIT_S)

    def wait_ready(self) -> None:
        """Wait until the standby has a copy, and a core that waits."""
        wait_until(lambda: "waiting for a takeover" in self.follower.text,
                   lambda: f"the standby is ready; it printed\n{self.follower.text}", LIMIT_S)

    def wait_copied(self) -> None:
        """Wait until the copy has all that is in the journal now."""
        sizes = _sizes(self.box.log_dir)
        wait_until(lambda: all(_sizes(self.standby.log_dir).get(name, 0) >= size for name, size in sizes.items()),
                   "the copy is complete", LIMIT_S)

    def release(self) -> None:
        """The robots complete their goals."""
        for robot in self.robots:
            robot.held = False

    def lose_box(self) -> None:
        """The box's link goes down, and then all its processes are killed."""
        self.box.cut()
        self.box.burn()

    def separate(self, *numbers: int) -> None:
        """From now on, nothing passes between these hosts. All others hear everybody."""
        self.switch.host.do(run_ip, *(
            f"link set port{number} type bridge_slave isolated {'on' if number in numbers else 'off'}"
            for number in self.stations))

    def lose_frames(self, number: int, other: int) -> None:
        """From now on, what this host sends to the other one alone gets lost. Broadcasts pass."""
        self.stations[number].host.do(
            run_ip, f"neigh replace {address(other)} lladdr 02:00:00:00:00:99 dev {INTERFACE} nud permanent")

    @staticmethod
    def now() -> float:
        """Seconds of the capture's clock."""
        return time.monotonic()

    def wait_robots_silent(self) -> None:
        """Wait until each robot reports that its box is silent."""
        wait_until(lambda: all(any(each.problem is Problem.BOX_SILENT for each in robot.troubles)
                               for robot in self.robots), "robots hear no box", LIMIT_S)

    def wait_followed(self, since_mono: float, ports: List[int]) -> float:
        """Wait until each robot sends to the standby on its private channel; returns the seconds since that time."""
        return wait_until(
            lambda: self.followed(since_mono, ports),
            lambda: f"robots follow the standby; it printed\n{self.follower.text}", LIMIT_S) - since_mono

    def wait_beacon(self, number: int, since_mono: float) -> None:
        """Wait for a beacon of a box."""
        wait_until(lambda: self.capture.of(number, RSBB_PORT, since_mono), f"a beacon of box {number}", LIMIT_S)

    def sent_to_robots(self, number: int, since_mono: float = 0.0) -> List[Frame]:
        """What a box sent to robots, with its beacons."""
        return [frame for frame in list(self.capture.frames)
                if frame.number == number and RSBB_PORT <= frame.port < RSBB_PORT + 1000 and frame.mono >= since_mono]

    def assert_box_stops(self, box: Program, since_mono: float, ports: List[int]) -> float:
        """The box that hears its successor since that time says so, and sends nothing more.

        Returns for how many seconds both sent to robots."""
        box.wait_printed("This box is superseded")
        # What is captured is read by another thread, a moment later.
        self.wait_beacon(STANDBY, self.now())
        stopped = self.now()
        self.wait_beacon(STANDBY, stopped)
        assert self.sent_to_robots(BOX, stopped) == []
        both = [frame.mono - since_mono for port in ports for frame in self.capture.of(BOX, port, since_mono)]
        return max(both, default=0.0)

    def private_ports(self, number: int) -> List[int]:
        """The ports above the public one to which a box sent."""
        return sorted({frame.port for frame in list(self.capture.frames) if frame.number == number
                       and RSBB_PORT < frame.port < RSBB_PORT + 1000})

    def followed(self, since_mono: float, ports: List[int]) -> Optional[float]:
        """When the last robot sent to the standby on its private channel, after that time; None: not yet."""
        begun = []
        for port, place in zip(ports, range(len(self.teams))):
            answers = self.capture.of(STANDBY, port, since_mono)
            replies = self.capture.of(FIRST_ROBOT + place, port, answers[0].mono) if answers else []
            if not replies:
                return None
            begun.append(replies[0].mono)
        return max(begun)


def _sizes(log_dir: pathlib.Path) -> Dict[str, int]:
    """The bytes of the segments of a journal."""
    return {segment.name: segment.stat().st_size for segment in (log_dir / JOURNAL).glob("*.log")}


def zone_of(team: str) -> str:
    """The zone of a team."""
    return f"Home {team}"


def _write_competition(folder: pathlib.Path, teams: Any) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    zones = "".join(
        f"- zone: {zone_of(team)}\n  schedule:\n" + "".join(
            f"    - {{benchmark: HWV, team: {team}, round: 1, run: {run}, scheduled_time: 2026-01-01 0{run}:00:00}}\n"
            for run in (1, 2)) for team in teams)
    (folder / "schedule.yaml").write_text(zones, encoding="utf-8")
    (folder / "passwords.yaml").write_text(
        "".join(f"{team}: {password_of(team)}\n" for team in teams), encoding="utf-8")

