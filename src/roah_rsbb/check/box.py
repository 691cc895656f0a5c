"""The box that the check plays: the core of this package, with its own radio, and a record of all that happens."""

import asyncio
import random
import time
from dataclasses import dataclass, field
from typing import Any, Callable, Dict, List, NamedTuple, Optional, Tuple

from roah_rsbb.comm.channels import MakePeer, Network
from roah_rsbb.comm.peer import Address, Peer
from roah_rsbb.core import effects
from roah_rsbb.core.arrivals import Arrivals
from roah_rsbb.core.box import Box
from roah_rsbb.core.continuing import Saved
from roah_rsbb.core.effects import Effect
from roah_rsbb.core.runs.functionality import FunctionalityRun
from roah_rsbb.core.runs.run import Run
from roah_rsbb.core.settings import Settings
from roah_rsbb.model.clock import Now
from roah_rsbb.model.messages import Beacon, BenchmarkingRobot, BoxMessage, RobotReport
from roah_rsbb.model.modules import ModuleInfo, ModulesState, OutcomeKind, Progress, Request, RequestKind, RunForModule
from roah_rsbb.protocol import BoxState, WireTime, wire_seconds
from roah_rsbb.radio.driver import NetworkDriver
from roah_rsbb.radio.radio import beacon_size
from roah_rsbb.rulebook.benchmarks import ALL_TEAMS, NO_LIMIT, Benchmark, Config, ScheduledEvent, ZonePlan
from roah_rsbb.rulebook.registry import PROFILES, BenchmarkKind, new_profile

# -- the bad network ----------------------------------------------------------------------------------

# What happens to each datagram depends on the seed and on the datagram's number only.


class Impairment(NamedTuple):
    """How datagrams are treated. Shares from 0 to 1; seconds."""

    loss: float = 0.0
    duplicate: float = 0.0
    late: float = 0.0  # share that is delayed by `late_s`, so that others overtake them
    late_s: float = 0.0


PERFECT = Impairment()
MUTE = Impairment(loss=1.0)
# Real wireless networks in a hall are better than this.
BAD = Impairment(loss=0.2, duplicate=0.2, late=0.2, late_s=0.15)


class BadNetwork:
    """All peers of the check. `out` and `back` impair what the box sends, and what it receives."""

    def __init__(self, loop: asyncio.AbstractEventLoop, seed: int, make_peer: Optional[MakePeer] = None) -> None:
        self.out = self.back = PERFECT
        self.largest = 0  # bytes of the largest datagram that was received
        self.sent: List[bytes] = []  # datagrams on private channels, while `keep` is set
        self.keep = False
        self._peers: Dict[int, BadPeer] = {}  # the latest by port
        self._loop = loop
        self._random = random.Random(seed)
        self._make_peer = make_peer or Peer

    def peer(
        self, loop: asyncio.AbstractEventLoop, rsbb_host: str, port: int,
        on_datagram: Callable[[bytes, Address], None], *args: Any, **kwargs: Any,
    ) -> "BadPeer":
        """Make a peer, with the arguments of `Peer`."""
        is_private = not kwargs.get("shared", True)

        def receive(datagram: bytes, sender: Address) -> None:
            self.largest = max(self.largest, len(datagram))
            # What this network adds is a delay on the way.
            received_utc = made.real_received_utc if self.back is PERFECT else None

            def deliver() -> None:
                made.received_utc = received_utc
                on_datagram(datagram, sender)

            self.treat(self.back, deliver)

        made = BadPeer(self, self._make_peer(loop, rsbb_host, port, receive, *args, **kwargs), is_private)
        if self._peers.get(port) is None or not self._peers[port].is_open:
            self._peers[port] = made
        return made

    def resend(self, port: int, datagram: bytes, host: str) -> None:
        """Send any bytes from the box's socket on a port."""
        self._peers[port].send(datagram, host)

    def treat(self, how: Impairment, deliver: Callable[[], Any]) -> None:
        """Deliver a datagram not at all, once or twice, now or later."""
        if how is PERFECT:
            deliver()
            return
        lost, doubled, *late = (self._random.random() for _ in range(4))
        if lost < how.loss:
            return
        for one in late[:1 + (doubled < how.duplicate)]:
            if one < how.late:
                self._loop.call_later(how.late_s, deliver)
            else:
                deliver()


class BadPeer:
    """A `Peer` on a bad network."""

    def __init__(self, network: BadNetwork, peer: Peer, is_private: bool) -> None:
        self._network = network
        self._peer = peer
        self._is_private = is_private
        self.received_utc: Optional[float] = None  # see `Peer`

    @property
    def real_received_utc(self) -> Optional[float]:
        """When the system received the datagram that is being read, in UTC seconds; None: unknown."""
        return self._peer.received_utc

    def __getattr__(self, name: str) -> Any:
        return getattr(self._peer, name)

    def send(self, datagram: bytes, host: str) -> bool:
        """Send like `Peer.send`. A datagram that the bad network loses counts as sent."""
        if self._is_private and self._network.keep:
            self._network.sent.append(datagram)
        self._network.treat(self._network.out, lambda: self._peer.send(datagram, host))
        return True


# -- the box ------------------------------------------------------------------------------------------

# The check judges clocks itself, so no skew may keep the box from starting a run.
ANY_SKEW_S = 1e12
MODULE_BEAT_S = 0.5
# A code that no robot knows. Competitions may define codes of their own.
UNKNOWN_CODE = "XCHECK"
# The address of the check's tablet, which does not exist.
BEACON_HOST = "192.0.2.1"
# Datagrams take no longer than this. For this long after a change of the box's state, the robot may act on the old one.
STILL_VALID_S = 0.5


class HeardReport(NamedTuple):
    """A RobotState that arrived."""

    mono: float
    host: str
    port: int
    report: RobotReport
    said: int  # number of the box's states (`CheckRecord.states`) before it


class HeardBeacon(NamedTuple):
    """A RobotBeacon that arrived."""

    mono: float
    team: str
    robot: str
    skew: float  # seconds; too small by the delay


class BoxSaid(NamedTuple):
    """A state of the box, from the first datagram on."""

    mono: float
    port: int
    state: BoxState


class NetworkInUse(Exception):
    """Another box runs on this network. The text names its address and the remedy."""


@dataclass
class CheckRecord:
    """Everything that happened, in order. Lists only grow."""

    reports: List[HeardReport] = field(default_factory=list)  # the fresh ones
    beacons: List[HeardBeacon] = field(default_factory=list)  # of all robots
    states: List[BoxSaid] = field(default_factory=list)
    skews: List[Tuple[float, float]] = field(default_factory=list)  # time (monotonic) and sample
    unreadable: List[Tuple[float, str]] = field(default_factory=list)  # on private channels
    complaints: List[Tuple[float, str]] = field(default_factory=list)  # on the public channel
    stale: int = 0  # reports that were not newer than the newest
    overload: int = 0  # reports that were not read


class WatchedArrivals(Arrivals):
    """Records what the box hears."""

    def __init__(self, record: CheckRecord, news: Callable[[], None], *parts: Any) -> None:
        super().__init__(*parts)
        self._log = record
        self._news = news
        self.trap: Optional[Callable[[RobotReport], None]] = None  # called before the box takes a report

    def on_robot_beacon(
        self, now: Now, host: str, team: str, robot: str, time: WireTime, received_utc: Optional[float] = None,
        has_route: bool = True,
    ) -> None:
        """See `Arrivals.on_robot_beacon`."""
        skew = wire_seconds(time) - self._timers.arrival(now, received_utc).utc
        self._log.beacons.append(HeardBeacon(now.mono, team, robot, skew))
        super().on_robot_beacon(now, host, team, robot, time, received_utc, has_route)
        self._news()

    def on_robot_report(
        self, now: Now, port: int, host: str, report: RobotReport, received_utc: Optional[float] = None,
    ) -> Optional[BoxMessage]:
        """See `Arrivals.on_robot_report`."""
        repeated = None
        run = self._zones.run_at(port)
        if run is not None:
            before = run.link.last
            if self.trap is not None and (before is None or report.time > before.time):
                self.trap(report)
            said = len(self._log.states)
            repeated = super().on_robot_report(now, port, host, report, received_utc)
            if run.link.last is report:
                self._log.reports.append(HeardReport(now.mono, host, port, report, said))
                arrival = self._timers.arrival(now, received_utc)
                self._log.skews.append((now.mono, wire_seconds(report.time) - arrival.utc))
            else:
                self._log.stale += 1
        self._news()
        return repeated

    def on_robot_overload(self, now: Now, port: int, count: int) -> None:
        """See `Arrivals.on_robot_overload`."""
        self._log.overload += count
        super().on_robot_overload(now, port, count)

    def on_unreadable(self, now: Now, port: int, text: str) -> None:
        """See `Arrivals.on_unreadable`."""
        self._log.unreadable.append((now.mono, text))
        super().on_unreadable(now, port, text)
        self._news()

    def on_complaint(self, now: Now, text: str) -> None:
        """See `Arrivals.on_complaint`."""
        self._log.complaints.append((now.mono, text))
        super().on_complaint(now, text)
        self._news()


class WatchedBox(Box):
    """The box of the core, which records what it hears, and invents robots."""

    arrivals: WatchedArrivals

    def __init__(self, record: CheckRecord, news: Callable[[], None], *args: Any) -> None:
        super().__init__(*args)
        self.arrivals = WatchedArrivals(
            record, news, self.settings, self.timers, self.zones, self.robots, self.heard, self.tablet, self.watches,
            self.connections, self.outbox)
        self.extra: Tuple[BenchmarkingRobot, ...] = ()  # invented robots, first in the beacon

    def beacon(self) -> Beacon:
        """See `Box.beacon`."""
        found = super().beacon()
        return found._replace(robots=self.extra + found.robots)


class Goals:
    """The benchmarking module of the check: goals in a row, without manual operations."""

    def __init__(self) -> None:
        self.requests: List[Dict[str, Any]] = []  # fields of `Request`

    def progress(self, run: RunForModule) -> Progress:
        """Return what the module requests next."""
        done = sum(step.outcome is not None for step in run.steps)
        if done >= len(self.requests):
            return Progress(run.run, run.attempt, run.steps[-1].request if run.steps else None, finished=True)
        request = Request(done + 1, RequestKind.GOAL, **self.requests[done])
        return Progress(run.run, run.attempt, request)


class CheckBox(NetworkDriver):
    """One box from its start to its end. A restart makes another one."""

    box: WatchedBox

    def __init__(
        self,
        loop: asyncio.AbstractEventLoop,
        network: Network,
        bad: BadNetwork,
        team: str,
        password: str,
        record: CheckRecord,
        news: Callable[[], None],
        last_port: Optional[int] = None,
        utc: Callable[[], float] = time.time,
        listen_duration: float = 0.0,
    ) -> None:
        """`listen_duration`: seconds for which the box first only listens for another box; 0.0: it ignores others."""
        config = configuration(team, password)
        settings = Settings(
            network.rsbb_port, allowed_skew=ANY_SKEW_S, check_messages_saved=False, max_datagram=network.max_datagram,
            auto_next=False, listen_duration=listen_duration,
            take_over=not listen_duration)
        box = WatchedBox(record, news, config, settings, beacon_size, last_port)
        super().__init__(loop, box, network, config.passwords, lambda text: None, utc, bad.peer)
        self.goals = Goals()
        self.another: Optional[str] = None  # why the check must not run beside another box; None: there is none
        self._record = record
        self._news = news
        self._beat: Optional[asyncio.TimerHandle] = None

    def open(self, listen_duration: float = 0.0) -> None:
        """See `NetworkDriver.open`."""
        super().open(listen_duration)
        self._on_beat()

    def close(self) -> None:
        """See `NetworkDriver.close`."""
        if self._beat is not None:
            self._beat.cancel()
            self._beat = None
        super().close()

    def on_effect(self, effect: Effect) -> None:
        """Record what the box sends, and let the module answer."""
        if isinstance(effect, effects.SendState):
            said = BoxSaid(self.now().mono, effect.port, effect.message.state)
            last = next((one for one in reversed(self._record.states) if one.port == effect.port), None)
            if last is None or last.state is not said.state:
                self._record.states.append(said)
                self._news()
        elif isinstance(effect, effects.AnotherBox):
            self.another = another_box(effect.host)
            self._news()
        elif isinstance(effect, effects.ModuleRunsChanged):
            self._loop.call_soon(self._publish)

    def run_in(self, code: str) -> Optional[Run]:
        """The connected run of a benchmark; None: no run of it is connected."""
        run = self.box.zones[code].run
        return None if run is None else run.members()[0]

    def outcomes(self, code: str) -> List[OutcomeKind]:
        """How the goals of the connected run of a benchmark ended; empty: no run, or no goal has ended."""
        run = self.run_in(code)
        steps = run.steps if isinstance(run, FunctionalityRun) else ()
        return [step.outcome.kind for step in steps if step.outcome is not None]

    def saved(self) -> Saved:
        """Return the state with which another box continues."""
        zones = {zone.name: zone.saved() for zone in self.box.zones.values()}
        return Saved(self.now().utc, self.box.restart.saved(), zones)

    def resume(self, saved: Saved) -> None:
        """Continue the runs of a box that has ended."""
        self.event(self.box.restart.resume, saved)

    def _on_beat(self) -> None:
        self._beat = self._loop.call_later(MODULE_BEAT_S, self._on_beat)
        self._publish()

    def _publish(self) -> None:
        if self._beat is None:
            return
        infos = tuple(ModuleInfo(code) for code in PROFILES)
        progress = tuple(self.goals.progress(run) for run in self.box.modules.runs() if run.running)
        self.event(self.box.modules.on_modules, ModulesState("check", infos, progress))


def another_box(host: str) -> str:
    """Why a program of a team must not run beside another box, and the remedy."""
    return (f"Another box is running at {host}, and two boxes disturb each other: end that one, or give this program "
            "and the robot another public port")


def configuration(team: str, password: str) -> Config:
    """A competition of one team: a zone for each benchmark, without limits."""
    unknown = Benchmark(UNKNOWN_CODE, UNKNOWN_CODE, "", NO_LIMIT, NO_LIMIT, (), new_profile(BenchmarkKind.TASK))
    found = {code: Benchmark(code, code, "", NO_LIMIT, NO_LIMIT, ()) for code in PROFILES}
    found[UNKNOWN_CODE] = unknown
    zones = tuple(
        ZonePlan(code, (ScheduledEvent(
            one, ALL_TEAMS if one.kind is BenchmarkKind.ALL_ROBOTS else team, 1, 1, 0.0),))
        for code, one in found.items())
    return Config(found, {team: password}, zones)


def states_before(record: CheckRecord, heard: HeardReport, begin: float) -> List[BoxState]:
    """The states that the box sent on a report's port from `begin` (monotonic, s) until the report.

    The first one is the state in force at `begin`.
    """
    found = [said for said in record.states[:heard.said] if said.port == heard.port]
    first = max((index for index, said in enumerate(found) if said.mono <= begin), default=0)
    return [said.state for said in found[first:]]
