"""Plays the referee for one robot: finds it, connects, starts, stops, and measures its reactions.

Scenarios are written with these steps. A step that fails records its finding and raises `GaveUp`, which ends the
scenario. All times are those of the loop, so tests run with simulated time.
"""

import asyncio
import contextlib
import time
from typing import Callable, Container, Dict, List, NamedTuple, NoReturn, Optional, Tuple

from roah_rsbb.check.box import PERFECT, BadNetwork, CheckBox, CheckRecord, HeardReport, NetworkInUse
from roah_rsbb.check.report import Cause, Finding, ScenarioResult, Verdict
from roah_rsbb.comm.channels import MakePeer, Network
from roah_rsbb.comm.ciphers import Cipher
from roah_rsbb.comm.sockets import ANY_HOST
from roah_rsbb.core.actions.table import Target
from roah_rsbb.model.messages import RobotReport
from roah_rsbb.model.modules import OutcomeKind
from roah_rsbb.model.reason import Refused
from roah_rsbb.protocol import BoxState, RobotState
from roah_rsbb.rulebook.registry import PROFILES, GoalForm, profile_of

# -- stalls of the check itself -----------------------------------------------------------------------

PERIOD_S = 0.05
# Timers are never exact.
USUAL_S = 0.02
# Stalls so close together add up: a robot's reaction may fall into all of them.
TOGETHER_S = 2.0


class Stalls:
    """The delays of a timer."""

    def __init__(self, loop: asyncio.AbstractEventLoop) -> None:
        self._loop = loop
        self._found: List[Tuple[float, float]] = []  # end (monotonic), seconds
        self._timer: Optional[asyncio.TimerHandle] = None

    def open(self) -> None:
        """Begin to measure."""
        self._timer = self._loop.call_later(PERIOD_S, self._tick, self._loop.time() + PERIOD_S)

    def close(self) -> None:
        """Stop measuring."""
        if self._timer is not None:
            self._timer.cancel()

    def since(self, mono: float) -> float:
        """How long the check was delayed since the monotonic time `mono`, in total (s)."""
        return sum(seconds for end, seconds in self._found if end > mono)

    def worst(self, mono: float) -> float:
        """The largest sum of delays within `TOGETHER_S`, since the monotonic time `mono` (s)."""
        found = [(end, seconds) for end, seconds in self._found if end > mono]
        worst = together = 0.0
        first = 0
        for end, seconds in found:
            together += seconds
            while found[first][0] <= end - TOGETHER_S:
                together -= found[first][1]
                first += 1
            worst = max(worst, together)
        return worst

    def _tick(self, due: float) -> None:
        now = self._loop.time()
        if now - due > USUAL_S:
            self._found.append((now, now - due))
        self._timer = self._loop.call_at(now + PERIOD_S, self._tick, now + PERIOD_S)


# -- the play -----------------------------------------------------------------------------------------

# Seconds. A robot repeats each state in a burst and then each second, so these allow two lost datagrams.
ANSWER_S = 5.0  # the first message on a private channel, after a beacon that lists the robot
OBEY_S = 5.0  # a reaction to PREPARE or to a goal
LEAVE_S = 6.0  # a beacon after the end of the run
STILL_THERE_S = 2.5  # a robot that was heard this recently is still running
SILENT_S = 3.0  # a robot sends each second; the box warns the referee after this silence
GONE_S = 10.0  # after this silence during a run, nothing more is expected
MOST_UNANSWERED = 2  # after this many private channels without an answer, the check opens no more
# If a robot needs longer to report STOP, the referee sees it still moving.
STOP_S = 1.0
STOP_LOST_S = 4.0  # then the robot ignores STOP
STILL_S = 1.2  # for how long the robot must then stay in STOP
# Clocks are not finer than this.
RESOLUTION_S = 1e-4
EXECUTING_S = 0.5  # the robot works this long before a scenario disturbs it

# The check also sends beacons that an original box does not send.
MAX_DATAGRAM = 8192

_GOALS: Dict[GoalForm, Tuple[dict, ...]] = {
    GoalForm.WAYPOINT: ({"goal": "[1.0, 2.0, 0.5]", "pose": (1.0, 2.0, 0.5)},
                        {"goal": "[-1.5, 0.25, -3.0]", "pose": (-1.5, 0.25, -3.0)}),
    GoalForm.PLACEMENT: ({"goal": "[0.4, 0.3, 5]"}, {"goal": "[0.2, 0.6, 2]"}),
    GoalForm.SWITCHES: ({"initial_state": (True, False, False), "switches": (1, 3)},
                        {"initial_state": (False, False, True), "switches": (2,)}),
    GoalForm.STRING: ({"goal": "{goal: GOAL 1, details: 4}"}, {"goal": "{goal: GOAL 2, details: 4}"}),
}


class Options(NamedTuple):
    """What the team asks for. Durations in seconds."""

    team: str
    password: str
    robot: str = ""  # empty: any robot of the team
    rsbb_host: str = "10.255.255.255"
    rsbb_port: int = 6666
    bind_host: str = ANY_HOST
    second_host: str = ""  # another address of this machine, for a second box; empty: none
    cipher: Cipher = Cipher.AES_128_CBC
    benchmarks: Tuple[str, ...] = ("HGTKMH",)
    patience: float = 60.0  # for the robot to prepare, and to execute a goal
    wait: float = 15.0  # for the robot's first beacon
    seed: int = 1


class GaveUp(Exception):
    """The scenario cannot continue. Its finding is recorded."""


class RobotWatch:
    """What the check sees of one robot, waits for, and finds."""

    def __init__(
        self,
        loop: asyncio.AbstractEventLoop,
        options: Options,
        utc: Callable[[], float] = time.time,
        make_peer: Optional[MakePeer] = None,
    ) -> None:
        self.loop = loop
        self.options = options
        self.record = CheckRecord()
        self.network = BadNetwork(loop, options.seed, make_peer)
        self.stalls = Stalls(loop)
        self.result = ScenarioResult("", "", 0.0)  # of the present scenario
        self.robot = options.robot  # its name, once it was found
        self.code = ""  # of the benchmark that is connected
        self._unanswered = 0  # private channels before the robot's first readable message
        self._closed = loop.time()  # when the last private channel was closed
        self._is_gone = False  # the robot's beacons ended
        self.began = loop.time()
        self.judges_times = True  # False: the present scenario makes the network bad on purpose
        self._utc = utc
        self._offset = utc() - loop.time()
        self._news = asyncio.Event()
        self.box = self._make_box(options.bind_host, None)

    def _make_box(self, bind_host: str, last_port: Optional[int], listen_duration: float = 0.0) -> CheckBox:
        options = self.options
        network = Network(options.rsbb_host, options.rsbb_port, bind_host, options.cipher, False, MAX_DATAGRAM)
        return CheckBox(self.loop, network, self.network, options.team, options.password, self.record,
                        self._news.set, last_port, self._utc, listen_duration)

    # -- findings -----------------------------------------------------------------------------------

    @property
    def now(self) -> float:
        """Seconds since the beginning of the check."""
        return self.loop.time() - self.began

    def find(self, verdict: Verdict, cause: Optional[Cause], expected: str, came: str) -> None:
        """Record a finding, once for each cause."""
        if cause is None or all(finding.cause is not cause for finding in self.result.findings):
            self.result.findings.append(Finding(verdict, cause, expected, came, self.now))

    def fail(self, cause: Cause, expected: str, came: str) -> None:
        """Record a failure."""
        self.find(Verdict.FAILED, cause, expected, came)

    def give_up(self, cause: Cause, expected: str, came: str) -> NoReturn:
        """Record a failure that ends the scenario."""
        self.fail(cause, expected, came)
        raise GaveUp

    def skip(self, why: str) -> NoReturn:
        """End the scenario, which is not possible here."""
        self.find(Verdict.SKIPPED, None, "", why)
        raise GaveUp

    def measured(self, what: str, seconds: float) -> None:
        """Note a measured duration."""
        self.result.measured.append(f"{what}: {seconds * 1000:.0f} ms" if seconds < 10 else f"{what}: {seconds:.1f} s")

    def clock_step(self) -> float:
        """By how much the checker's own clock was set since the beginning (s)."""
        return self._utc() - self.loop.time() - self._offset

    # -- waiting ------------------------------------------------------------------------------------

    async def until(self, is_true: Callable[[], bool], limit_s: float) -> bool:
        """Wait until a condition holds. Returns whether it does within the limit. Raises NetworkInUse.

        The checker's own stalls extend the limit.
        """
        begin = self.loop.time()
        while not is_true():
            if self.box.another is not None:
                raise NetworkInUse(self.box.another)
            left = begin + limit_s + self.stalls.since(begin) - self.loop.time()
            if left <= RESOLUTION_S:
                return False
            self._news.clear()
            with contextlib.suppress(asyncio.TimeoutError):
                await asyncio.wait_for(self._news.wait(), left)
        return True

    async def until_robot(self, is_true: Callable[[], bool], limit_s: float) -> bool:
        """Wait like `until`, for a robot in a run. Raises GaveUp if nothing more is heard from the robot."""
        waited = 0.0
        while waited < limit_s:
            step = min(1.0, limit_s - waited)
            if await self.until(is_true, step):
                return True
            waited += step
            if self.last is not None and self._silence() > (GONE_S if waited < limit_s else SILENT_S):
                self.give_up(Cause.SILENT, "a RobotState each second",
                             f"none for {self._silence():.0f} s. The last one was {self.state.name}")
        return False

    def _silence(self) -> float:
        """For how long the robot has not been heard on private channels (s)."""
        last = self.record.reports[-1].mono
        return self.loop.time() - last - self.stalls.since(last)

    async def rest(self, seconds: float) -> None:
        """Let the time pass."""
        await asyncio.sleep(seconds)

    # -- looking ------------------------------------------------------------------------------------

    @property
    def last(self) -> Optional[HeardReport]:
        """The robot's newest report on the private channel that is open; None: none yet."""
        run = self.box.run_in(self.code) if self.code else None
        if run is None or not self.record.reports or self.record.reports[-1].port != run.port:
            return None
        return self.record.reports[-1]

    @property
    def state(self) -> Optional[RobotState]:
        """The state that the robot reported last; None: no report yet."""
        return None if self.last is None else self.last.report.state

    @property
    def box_state(self) -> Optional[BoxState]:
        """The state that the box sends; None: no run is connected."""
        run = self.box.run_in(self.code) if self.code else None
        return None if run is None else run.message.state

    def seen(self, states: Container[RobotState], since: int) -> bool:
        """Whether the robot reported one of these states, in the reports from this index on."""
        return any(heard.report.state in states for heard in self.record.reports[since:])

    @property
    def over(self) -> bool:
        """Whether the box has ended the run."""
        run = self.box.run_in(self.code)
        return run is None or run.end_reason is not None

    @property
    def state_name(self) -> str:
        """The robot's state for a text."""
        return "no message" if self.state is None else f"the robot stays in {self.state.name}"

    def last_sign(self) -> float:
        """When the robot was heard last, on any channel."""
        beacons, reports = self.record.beacons, self.record.reports
        beacon = next((one.mono for one in reversed(beacons) if one.robot == self.robot), self.began)
        return max(beacon, reports[-1].mono if reports else self.began)

    def first_stop(self) -> int:
        """The index of the report with which the robot's present series of STOPs began."""
        index = len(self.record.reports) - 1
        port = self.record.reports[index].port
        while index and self.record.reports[index - 1].port == port and (
                self.record.reports[index - 1].report.state is RobotState.STOP):
            index -= 1
        return index


class Play(RobotWatch):
    """One check of one robot: the steps of a referee. All methods belong to the loop's thread."""

    def open(self, listen_duration: float = 0.0) -> None:
        """Start, and listen for another box first. Raises OSError whose text names the remedy."""
        self.box = self._make_box(self.options.bind_host, None, listen_duration)
        self.box.open(listen_duration)
        self.stalls.open()

    def close(self) -> None:
        """Release all ports."""
        self.box.close()
        self.stalls.close()

    async def find_robot(self) -> None:
        """Wait for the robot's beacon."""
        options, beacons = self.options, self.record.beacons

        def mine() -> List[str]:
            return [b.robot for b in beacons if b.team == options.team and options.robot in ("", b.robot)]

        if not await self.until(lambda: bool(mine()), options.wait):
            self._not_found()
        self.robot = mine()[0]

    def _not_found(self) -> NoReturn:
        options, beacons = self.options, self.record.beacons
        expected = f"a RobotBeacon of team {options.team} on UDP port {options.rsbb_port} within {options.wait:g} s"
        robots = sorted({b.robot for b in beacons if b.team == options.team})
        if robots:
            self.give_up(Cause.OTHER_ROBOT, f"a beacon of robot {options.robot}", f"beacons of {', '.join(robots)}")
        teams = sorted({b.team for b in beacons})
        if teams:
            self.give_up(Cause.OTHER_TEAM, expected,
                         f"beacons of {'team' if len(teams) == 1 else 'the teams'} {', '.join(teams)}")
        complaints = [text for _, text in self.record.complaints]
        if complaints:
            self.give_up(Cause.BAD_FRAMES, expected, complaints[-1])
        self.give_up(Cause.NO_BEACON, expected, "no beacon of any robot")

    async def connect(
        self, code: str, goals: Optional[Tuple[dict, ...]] = None, missing: Optional[Cause] = None
    ) -> None:
        """Connect the robot to a run of this benchmark, and wait for its first message.

        `missing`: the cause to report if no message comes. Raises GaveUp.
        """
        if not self.robot:
            self.skip("The robot was not found")
        if self._unanswered >= MOST_UNANSWERED:
            self.skip("The robot never sent a readable message on a private channel")
        self.box.goals.requests = list(goals_of(code) if goals is None else goals)
        if not await self.until(lambda: self._may_connect(code), LEAVE_S):
            self._not_known()
        silence = self.loop.time() - self.last_sign()
        self.code = code
        unreadable = len(self.record.unreadable)
        began = self.loop.time()
        robot = {} if profile_of(code).kind.value == "all robots" else {"robot": self.robot}
        self.box.event(self.box.box.act, Target(code), "connect", "", robot)
        if not await self.until(lambda: self.last is not None, ANSWER_S):
            if silence > LEAVE_S:
                self._not_known()  # the robot was gone already, but the box still listed it
            if not self.record.reports:
                self._unanswered += 1
            if len(self.record.unreadable) > unreadable:
                raise GaveUp  # the frames are judged at the end of the scenario
            usual = Cause.PORT_NOT_FOLLOWED if self.record.reports else Cause.NO_PRIVATE_CHANNEL
            self.give_up(missing or usual,
                         f"a RobotState on UDP port {self.box.run_in(code).port} within {ANSWER_S:g} s of the beacon "
                         "that lists the robot", "none")
        self._is_gone = False
        self.measured("first message on the private channel", self.loop.time() - began)
        await self.until(lambda: self.state is RobotState.STOP, 2.0)
        if self.state is not RobotState.STOP:
            self.give_up(Cause.OLD_STATE, "STOP at the beginning of a channel", f"{self.state.name}")

    def _not_known(self) -> NoReturn:
        """Give up on a robot that sends no beacon.

        If it was still using its private channel when the run was left, the fault is that it did not leave the channel.
        """
        if self._is_gone:
            self.skip("The robot's beacons ended")
        reports, sign = self.record.reports, self.last_sign()
        if reports and sign == reports[-1].mono > self._closed - STILL_THERE_S:
            self.give_up(Cause.CHANNEL_NOT_LEFT, "the robot's beacon before a run", "no beacon of the robot")
        self._is_gone = True
        self.give_up(Cause.NO_BEACON, "the robot's beacon before a run",
                     f"no message of the robot for {self.loop.time() - sign:.0f} s")

    def _may_connect(self, code: str) -> bool:
        return not self.box.box.actions.off(self.box.now(), self.box.box.zones[code], "connect")

    def press(self, command: str) -> None:
        """Give a referee's command, such as "start", in the connected run. Raises Refused."""
        given = {"running": True} if command == "disconnect" else {}
        self.box.event(self.box.box.act, Target(self.code), command, "", given)

    async def start(self, again: bool = False) -> None:
        """Start the run, and wait until the robot obeys. `again`: after a stop."""
        since = len(self.record.reports)
        try:
            self.press("start")
        except Refused as refused:
            self.give_up(Cause.STOP_IGNORED, "a robot in STOP that can be started", str(refused))
        await self.until(lambda: self.box_state is not BoxState.STOP, 2.0)  # a module begins first
        began = self.loop.time()
        moved = frozenset(RobotState) - {RobotState.STOP}
        if not await self.until(lambda: self.seen(moved, since), OBEY_S):
            self.give_up(
                Cause.NO_RESTART if again else Cause.PREPARE_IGNORED,
                f"PREPARING within {OBEY_S:g} s of PREPARE{' after a stop' if again else ''}",
                "the robot stays in STOP")
        self.measured("PREPARE to PREPARING", self.loop.time() - began)

    async def ready(self) -> None:
        """Wait until the robot has prepared."""
        done = (RobotState.WAITING_GOAL, RobotState.EXECUTING, RobotState.RESULT_TX)
        if not await self.until_robot(lambda: self.state in done or self.over, self.options.patience):
            self.give_up(Cause.NEVER_READY, f"WAITING_GOAL within {self.options.patience:g} s", self.state_name)

    async def executing(self) -> None:
        """Wait until the robot has prepared and executes."""
        await self.ready()
        done = (RobotState.EXECUTING, RobotState.RESULT_TX)
        if not await self.until(lambda: self.state in done or self.over, OBEY_S):
            asked = "GOAL_TX" if self.box_state is BoxState.GOAL_TX else "WAITING_RESULT"
            self.give_up(Cause.GOAL_IGNORED, f"EXECUTING within {OBEY_S:g} s of {asked}", self.state_name)

    async def complete(self) -> None:
        """Lead a started robot through all its goals, up to the STOP at the end."""
        run = self.box.run_in(self.code)
        goals = max(1, len(self.box.goals.requests)) if run is not None else 1
        for number in range(goals):
            await self.executing()
            if profile_of(self.code).runs_until_timeout:
                await self.rest(EXECUTING_S)
                if self.state is not RobotState.EXECUTING:
                    self.fail(Cause.ILLEGAL_STATE, f"EXECUTING until STOP in {self.code}", self.state_name)
                await self.stop("in EXECUTING")
                return
            await self._done(number)
            if number + 1 < goals:
                await self._next_goal(number + 2)
        # The robot's last result and the box's STOP are two events; asyncio may resume this in between (3.13 does).
        await self.until(lambda: self.record.states[-1].state is BoxState.STOP, OBEY_S)
        await self.after_stop("at the end of the run")

    async def _done(self, number: int) -> None:
        """Wait until goal `number` (from 0) is complete."""
        def is_done() -> bool:
            return self.over or len(self.box.outcomes(self.code)) > number
        if not await self.until_robot(is_done, self.options.patience):
            self.give_up(Cause.NEVER_DONE, f"RESULT_TX within {self.options.patience:g} s", self.state_name)
        if OutcomeKind.TIMED_OUT in self.box.outcomes(self.code):
            raise AssertionError("these goals have no timeout")

    async def _next_goal(self, number: int) -> None:
        if not await self.until(lambda: self.state is not RobotState.RESULT_TX, OBEY_S):
            self.give_up(Cause.NEXT_GOAL_IGNORED, f"PREPARING within {OBEY_S:g} s of PREPARE for goal {number}",
                         self.state_name)

    async def stop(self, where: str, cause: Optional[Cause] = None) -> None:
        """Stop the run, measure the robot's reaction, and check that it stays in STOP. `cause`: of a late reaction."""
        self.press("stop")
        await self.after_stop(where, cause)

    async def after_stop(self, where: str, cause: Optional[Cause] = None) -> None:
        """Measure the reaction to the box's STOP."""
        said = next(said.mono for said in reversed(self.record.states) if said.state is BoxState.STOP)
        if not await self.until(lambda: self.state is RobotState.STOP, STOP_LOST_S):
            is_heard = self.last is not None and self.last.mono > said
            self.give_up(cause or (Cause.STOP_IGNORED if is_heard else Cause.SILENT),
                         f"STOP within {STOP_S:g} s of the box's STOP {where}",
                         f"after {STOP_LOST_S:g} s {self.state_name if is_heard else 'no message since then'}")
        heard = next(heard.mono for heard in self.record.reports[self.first_stop():])
        seconds = max(0.0, heard - said)
        self.measured(f"STOP {where}", seconds)
        if seconds > STOP_S and self.judges_times:
            self.fail(cause or Cause.STOP_LATE, f"STOP within {STOP_S:g} s of the box's STOP {where}",
                      f"{seconds:.1f} s")
        await self.rest(STILL_S)
        if self.state is not RobotState.STOP:
            self.fail(Cause.STOP_IGNORED, f"the robot stays in STOP after a stop {where}", self.state_name)

    async def leave(self) -> None:
        """Disconnect, and check that the robot leaves its private channel."""
        beacons = len(self.record.beacons)
        self._disconnect()
        if not await self.until(lambda: any(b.robot == self.robot and b.team == self.options.team
                                            for b in self.record.beacons[beacons:]), LEAVE_S):
            self.fail(Cause.CHANNEL_NOT_LEFT, f"the robot's beacon within {LEAVE_S:g} s of the end of the run",
                      "no beacon")

    def _disconnect(self) -> None:
        self.press("disconnect")
        self.code, self._closed = "", self.loop.time()

    def trap(self, state: RobotState, act: Callable[[], None]) -> None:
        """Do something at the moment when the robot reports a state, before the box reacts to it."""
        def on_report(report: RobotReport) -> None:
            if report.state is state:
                self.box.box.arrivals.trap = None
                act()
        self.box.box.arrivals.trap = on_report

    # -- boxes --------------------------------------------------------------------------------------

    async def restart_box(self, gap_s: float, keeps_run: bool = True, bind_host: str = "") -> None:
        """End the box, and start another one after `gap_s`, perhaps at another address."""
        saved = self.box.saved()
        port = max([self.options.rsbb_port, *(heard.port for heard in self.record.states)])
        goals = self.box.goals.requests
        self.box.close()
        await self.rest(gap_s)
        self.box = self._make_box(bind_host or self.options.bind_host, port)
        self.box.goals.requests = goals
        self.box.open()
        if keeps_run:
            self.box.resume(saved)
        else:
            self.code = ""

    # -- the end ------------------------------------------------------------------------------------

    async def tidy(self) -> None:
        """Leave the robot stopped and without a run, whatever happened before."""
        self.network.out = self.network.back = PERFECT
        self.box.box.arrivals.trap, self.box.box.extra = None, ()
        if not self.code or self.box.run_in(self.code) is None:
            return
        if not self.over:
            with contextlib.suppress(Refused):
                self.press("stop")
        if self.last is not None:
            await self.until(lambda: self.state is RobotState.STOP, STOP_LOST_S)
        with contextlib.suppress(Refused):
            self._disconnect()
        self.code = ""


def goals_of(code: str, count: int = 2) -> Tuple[dict, ...]:
    """The goals that the check sends in a benchmark; none in a task benchmark."""
    profile = PROFILES.get(code)
    if profile is None or profile.kind.value != "functionality":
        return ()
    goals = _GOALS.get(profile.goal, ({}, {}))
    return goals[:1] if profile.runs_until_timeout else goals[:count]
