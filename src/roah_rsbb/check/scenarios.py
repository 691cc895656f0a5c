"""What the check does with a robot: one function for each scenario, and the table of all scenarios."""

import enum
import random
from statistics import median
from typing import Awaitable, Callable, List, NamedTuple, Tuple

from roah_rsbb.check.box import BAD, BEACON_HOST, MUTE, PERFECT, UNKNOWN_CODE, states_before
from roah_rsbb.check.play import EXECUTING_S, LEAVE_S, OBEY_S, GaveUp, Play, goals_of
from roah_rsbb.check.report import Cause, Verdict
from roah_rsbb.comm import frame
from roah_rsbb.comm.ciphers import Cipher, Key
from roah_rsbb.core.link.skew import within
from roah_rsbb.core.robots import MAX_NAME
from roah_rsbb.model.messages import Beacon, BenchmarkingRobot, BoxMessage, DevicesState, TabletState
from roah_rsbb.model.modules import OutcomeKind
from roah_rsbb.protocol import BoxState, RobotState
from roah_rsbb.radio import wire_convert
from roah_rsbb.radio.radio import beacon_size
from roah_rsbb.rulebook.registry import PROFILES
from roah_rsbb.wording import times

# -- what a scenario is -------------------------------------------------------------------------------

class Depth(enum.Enum):
    """How thorough a check is."""

    BASIC = "basic"
    FULL = "full"


class Scenario(NamedTuple):
    """One entry of the tables."""

    name: str
    title: str
    run: Callable[[Play, str], Awaitable[None]]  # the play, and the benchmark's code
    level: Depth = Depth.FULL
    code: str = ""  # the benchmark; empty: the first of --benchmarks
    needs_robot: bool = True  # skip it if the robot was not found
    bad_network: bool = False  # the scenario makes the network bad, so times and losses are not judged


# -- the basic level ----------------------------------------------------------------------------------

BEACONS_S = 4.5
LONGEST_GAP_S, SHORTEST_PERIOD_S = 3.0, 0.3
USUAL_PERIOD_S = 1.6
ALLOWED_SKEW_S = 0.1


async def find(play: Play, _code: str) -> None:
    """The robot sends beacons under its team's name."""
    began = play.loop.time()
    await play.find_robot()
    play.measured("first beacon", play.loop.time() - began)
    for name in (play.options.team, play.robot):
        if not 0 < len(name) <= MAX_NAME:
            play.fail(Cause.BAD_NAME, f"names of 1 to {MAX_NAME} characters", f"{len(name)} characters")


async def beacon(play: Play, _code: str) -> None:
    """The robot sends a beacon each second while it has no private channel."""
    began = play.loop.time()
    await play.rest(BEACONS_S)
    mine = [b.mono for b in play.record.beacons if (b.team, b.robot) == (play.options.team, play.robot)]
    moments = [began, *(mono for mono in mine if mono >= began), play.loop.time()]
    longest = max(after - before for before, after in zip(moments, moments[1:])) - play.stalls.since(began)
    if longest > LONGEST_GAP_S:
        play.give_up(Cause.BEACON_PERIOD, "a beacon each second", f"none for {longest:.1f} s")
    gaps = [after - before for before, after in zip(moments[1:-1], moments[2:-1])]
    usual = median(gaps) if gaps else longest
    play.measured("interval of beacons", usual)
    if not SHORTEST_PERIOD_S <= usual <= USUAL_PERIOD_S:
        play.find(Verdict.QUIRK, Cause.BEACON_PERIOD, "a beacon each second", f"one every {usual:.2f} s")


async def clock(play: Play, _code: str) -> None:
    """The robot's clock agrees with the checker's clock."""
    robot = next((r for r in play.box.box.robots.all(play.box.now())
                  if (r.id.team, r.id.robot) == (play.options.team, play.robot)), None)
    if robot is None or robot.skew.seconds is None:
        play.give_up(Cause.BEACON_PERIOD, "a beacon each second", "no beacon in the last seconds")
    play.result.measured.append(f"clock skew: {times.skew(robot.skew.seconds)}")
    if not within(robot.skew.seconds, ALLOWED_SKEW_S):
        play.fail(Cause.CLOCK_SKEW, f"a clock skew below {ALLOWED_SKEW_S:g} s between robot and checker",
                  times.skew(robot.skew.seconds))


async def channel(play: Play, code: str) -> None:
    """The robot opens its private channel, reports STOP each second, and leaves the channel."""
    await play.connect(code)
    await play.rest(3.0)
    await play.leave()


async def run(play: Play, code: str) -> None:
    """The robot goes through all states of the benchmark."""
    await play.connect(code)
    await play.start()
    await play.complete()
    await play.leave()


async def stop_preparing(play: Play, code: str) -> None:
    """STOP while the robot prepares."""
    await play.connect(code)
    await play.start()
    if play.state is not RobotState.PREPARING:
        play.find(Verdict.SKIPPED, None, "", "The robot prepares too quickly to be stopped in PREPARING")
        raise GaveUp
    await play.stop("in PREPARING")
    await play.leave()


async def stop_waiting(play: Play, code: str) -> None:
    """STOP at the moment when the robot waits for its goal."""
    await play.connect(code)
    play.trap(RobotState.WAITING_GOAL, lambda: play.press("stop"))
    await play.start()
    if not await play.until_robot(lambda: play.over, play.options.patience):
        play.give_up(Cause.NEVER_READY, f"WAITING_GOAL within {play.options.patience:g} s", play.state_name)
    await play.after_stop("in WAITING_GOAL")
    await play.leave()


async def stop_executing(play: Play, code: str) -> None:
    """STOP while the robot executes, and a new start."""
    await play.connect(code, goals_of(code, 1))
    await play.start()
    await play.executing()
    await play.rest(EXECUTING_S)
    if play.over or play.state is not RobotState.EXECUTING:
        play.find(Verdict.SKIPPED, None, "", "The robot executes too quickly to be stopped in EXECUTING")
        raise GaveUp
    await play.stop("in EXECUTING")
    await play.start(again=True)
    await play.complete()
    await play.leave()


# -- goals --------------------------------------------------------------------------------------------

# A goal ends this long after the robot began to execute it.
INTO_EXECUTING_S = 0.5
# The robot may complete its goal at the same moment.
SAME_MOMENT_S = 0.3
UNKNOWN_S = 3.0


async def _time_out(play: Play, code: str) -> None:
    """Lead the robot into a goal that times out while it executes. Skips the scenario if the robot is too quick."""
    first, second = goals_of(code)
    # The first goal shows how long the robot prepares. The timeout of the second one counts from PREPARE on.
    goals = [dict(first), dict(second), dict(first)]
    await play.connect(code, tuple(goals))
    await play.start()
    began = play.record.states[-1].mono
    await play.executing()
    prepare_s = play.loop.time() - began
    play.box.goals.requests[1]["timeout"] = round(1.1 * prepare_s + INTO_EXECUTING_S, 2)
    limit_s = 2 * (play.options.patience + prepare_s)
    state = play.state  # before the timeout: afterwards, the robot may have obeyed before this check looks

    def ended() -> bool:
        nonlocal state
        if play.over or len(play.box.outcomes(code)) > 1:
            return True
        state = play.state
        return False

    if not await play.until_robot(ended, limit_s):
        play.give_up(Cause.NEVER_DONE, f"RESULT_TX within {play.options.patience:g} s", play.state_name)
    if play.box.outcomes(code)[1:2] != [OutcomeKind.TIMED_OUT] or state is not RobotState.EXECUTING:
        play.skip("The robot completes its goals too quickly for a timeout in EXECUTING")


async def next_waypoint(play: Play, code: str) -> None:
    """PREPARE in the middle of EXECUTING: the waypoint timed out."""
    await _time_out(play, code)
    await play.until(lambda: play.state is not RobotState.EXECUTING, OBEY_S)
    began = next(said.mono for said in reversed(play.record.states) if said.state is BoxState.PREPARE)
    seconds = max(0.0, play.record.reports[-1].mono - began)
    if play.state is RobotState.EXECUTING or (play.state is RobotState.RESULT_TX and seconds > SAME_MOMENT_S):
        play.give_up(Cause.TIMEOUT_IGNORED, f"PREPARING within {OBEY_S:g} s of PREPARE in EXECUTING",
                     f"{play.state.name} after {seconds:.1f} s")
    play.measured("PREPARE in EXECUTING to PREPARING", seconds)
    await _finish_last(play)


async def goal_timeout(play: Play, code: str) -> None:
    """A goal without a waypoint times out: the robot may finish it, then prepares for the next one."""
    await _time_out(play, code)
    if not await play.until_robot(lambda: play.state in (RobotState.PREPARING, RobotState.WAITING_GOAL),
                                  play.options.patience):
        play.give_up(Cause.NEXT_GOAL_IGNORED, "PREPARING after the goal that timed out", play.state_name)
    await _finish_last(play)


async def _finish_last(play: Play) -> None:
    if not await play.until_robot(lambda: play.over, 2 * play.options.patience):
        play.give_up(Cause.NEVER_DONE, f"RESULT_TX within {play.options.patience:g} s", play.state_name)
    await play.after_stop("at the end of the run")
    await play.leave()


async def unknown_code(play: Play, code: str) -> None:
    """A benchmark that the robot does not know: its program must survive."""
    await play.connect(code)
    since = len(play.record.reports)
    play.press("start")
    await play.rest(UNKNOWN_S)
    if not await play.until(lambda: len(play.record.reports) > since, OBEY_S):
        play.give_up(Cause.UNKNOWN_CODE, f"a RobotState each second in benchmark {code}", "none")
    if not play.seen(frozenset(RobotState) - {RobotState.STOP}, since):
        play.find(Verdict.QUIRK, Cause.UNKNOWN_CODE, f"PREPARING in benchmark {code}, as in every other one",
                  "the robot stays in STOP")
        raise GaveUp
    if not play.over:
        await play.stop("in an unknown benchmark")
    await play.leave()


# -- boxes --------------------------------------------------------------------------------------------

SHORT_S, LONG_S = 3.0, 30.0
# The robot hears nothing for less than 3 s, after which a box warns the referee.
GAP_S = 1.5
# The robot must hear another box alone for some seconds before it follows it (docs/robot_without_ros.md, "In Python").
MOVE_S, BACK_S = 15.0, 20.0
FOREIGN_BEACONS, FOREIGN_PERIOD_S = 5, 0.4
# The box repeats its state each second.
REPEATED_S = 4.0


async def _begin(play: Play, code: str) -> int:
    """Lead the robot into EXECUTING. Returns the number of reports so far."""
    await play.connect(code, goals_of(code, 1))
    await play.start()
    await play.executing()
    if play.over:
        play.skip("The robot completes its goal too quickly to be disturbed")
    return len(play.record.reports)


def _fell(play: Play, since: int) -> bool:
    """Whether the robot stopped although the box had not sent STOP."""
    return any(heard.report.state is RobotState.STOP and BoxState.STOP not in states_before(
        play.record, heard, heard.mono) for heard in play.record.reports[since:])


async def _finish(play: Play, cause: Cause, since: int, what: str) -> None:
    """Check that the robot completes its goal in spite of what happened."""
    is_over = await play.until(lambda: play.over, 2 * play.options.patience)
    if _fell(play, since):
        play.fail(cause, f"the robot keeps its state {what}", "STOP")
    if not is_over:
        play.give_up(cause, f"the robot completes its goal {what}", play.state_name)
    if not await play.until(lambda: play.state is RobotState.STOP, REPEATED_S):
        play.give_up(cause, f"STOP at the end of the run {what}", play.state_name)
    await play.leave()


async def _silent(play: Play, code: str, seconds: float) -> None:
    since = await _begin(play, code)
    play.network.out = MUTE
    await play.rest(seconds)
    _judge_silence(play, since, seconds)
    play.network.out = PERFECT
    if not await play.until_robot(lambda: play.over, 2 * play.options.patience) or (
            not await play.until(lambda: play.state is RobotState.STOP, REPEATED_S)):
        play.give_up(Cause.GIVES_UP, f"the robot continues after {seconds:g} s without the box", play.state_name)
    await play.leave()


def _judge_silence(play: Play, since: int, seconds: float) -> None:
    """A robot may complete its goal in the meantime, and must then wait in RESULT_TX."""
    states = [heard.report.state for heard in play.record.reports[since - 1:]]
    if RobotState.STOP in states:
        before = states[states.index(RobotState.STOP) - 1]
        play.fail(Cause.RESULT_LEFT if before is RobotState.RESULT_TX else Cause.GIVES_UP,
                  f"the robot keeps its state while the box is silent for {seconds:g} s", f"{before.name}, then STOP")


async def silent_short(play: Play, code: str) -> None:
    """The box is not heard for 3 s."""
    await _silent(play, code, SHORT_S)


async def silent_long(play: Play, code: str) -> None:
    """The box is not heard for 30 s."""
    await _silent(play, code, LONG_S)


async def restart(play: Play, code: str) -> None:
    """The box restarts and continues the run on the same port."""
    since = await _begin(play, code)
    await play.restart_box(GAP_S)
    await _finish(play, Cause.RESTART_NOT_FOLLOWED, since, "when the box restarts")


async def new_port(play: Play, code: str) -> None:
    """The box restarts without the run, and connects the robot on another port."""
    await _begin(play, code)
    await play.restart_box(GAP_S, keeps_run=False)
    await play.connect(code)
    await play.leave()


async def moved(play: Play, code: str) -> None:
    """The box continues at another address."""
    if not play.options.second_host:
        play.skip("This machine has no second address: give one with --second-bind")
    await play.connect(code)
    since, began = len(play.record.reports), play.loop.time()
    try:
        await play.restart_box(GAP_S, bind_host=play.options.second_host)
        if not await play.until(lambda: len(play.record.reports) > since, MOVE_S):
            play.give_up(Cause.MOVE_NOT_FOLLOWED,
                         f"messages to the box at its new address {play.options.second_host} within {MOVE_S:g} s",
                         "none")
        play.measured("following the box to another address", play.loop.time() - began)
    finally:
        beacons = len(play.record.beacons)
        await play.restart_box(GAP_S, keeps_run=False)
        await play.until(lambda: any(b.robot == play.robot for b in play.record.beacons[beacons:]), BACK_S)


async def other_box(play: Play, code: str) -> None:
    """Another box sends beacons that do not list the robot."""
    if not play.options.second_host:
        play.skip("This machine has no second address: give one with --second-bind")
    since = await _begin(play, code)
    beacon = frame.encode(wire_convert.beacon_message(Beacon((), DevicesState(), TabletState())))
    options = play.options
    other = play.network.peer(play.loop, options.rsbb_host, options.rsbb_port, lambda *_: None, lambda _: None,
                              options.second_host)
    try:
        other.open()
    except OSError as error:
        play.skip(str(error))
    try:
        for _ in range(FOREIGN_BEACONS):
            other.send(beacon, options.rsbb_host)
            await play.rest(FOREIGN_PERIOD_S)
    finally:
        other.close()
    # A robot that left its channel may report so only a second after it opened the channel again.
    await play.until(lambda: play.over or _fell(play, since), 2 * play.options.patience)
    if not _fell(play, since):
        await _finish(play, Cause.FOREIGN_BOX, since, "when another box sends beacons")
        return
    heard = len(play.record.reports)
    if not await play.until(lambda: len(play.record.reports) > heard, LEAVE_S):
        play.give_up(Cause.FOREIGN_BOX, "the robot keeps its private channel when another box sends beacons",
                     "no more messages")
    play.find(Verdict.QUIRK, Cause.FOREIGN_BOX,
              "the robot keeps its private channel when another box sends beacons",
              "the robot left its channel, and opened it again. A second box on the network would disturb its runs")
    raise GaveUp


# -- datagrams ----------------------------------------------------------------------------------------

BURST_S, BURST_PERIOD_S = 2.0, 0.05
ALIVE_S = 4.0
STALE_COPIES, STALE_PERIOD_S = 4, 0.2
USUAL_DATAGRAM, MANY = 1024, 40  # bytes that an original robot reads, robots
DRIFT_S, WINDOW_S = 60.0, 5.0
# Seconds per second. NTP slews a clock by at most 5e-4. A clock that drifts by 1e-3 reaches the allowed skew in 100 s.
NOTED_DRIFT, MOST_DRIFT = 6e-4, 1e-3
CLOCK_SET_S = 0.02


async def bad_network(play: Play, code: str) -> None:
    """A whole run while the network loses, duplicates, delays and reorders datagrams."""
    await play.connect(code, goals_of(code, 1))
    play.network.out = play.network.back = BAD
    await play.start()
    if not await play.until(lambda: play.over, 2 * play.options.patience) or (
            not await play.until(lambda: play.state is RobotState.STOP, 2 * ALIVE_S)):
        play.give_up(Cause.BAD_NETWORK, "a complete run on a bad network", play.state_name)
    play.network.out = play.network.back = PERFECT


async def stale(play: Play, code: str) -> None:
    """Copies of old datagrams of the box arrive after a STOP."""
    play.network.sent, play.network.keep = [], True
    try:
        await play.connect(code, goals_of(code, 1))
        await play.start()
        await play.executing()
        await play.rest(EXECUTING_S)
    finally:
        play.network.keep = False
    old = play.network.sent[:]
    if play.over:
        await play.after_stop("at the end of the run")
    else:
        await play.stop("in EXECUTING")
    since, run = len(play.record.reports), play.box.run_in(code)
    # The robot has received all of these by now, so each one is a copy.
    chosen = [old[len(old) * part // 4] for part in range(1, 4)]
    for _ in range(STALE_COPIES):
        for datagram in chosen:
            play.network.resend(run.port, datagram, run.link.host)
        await play.rest(STALE_PERIOD_S)
    if play.seen(frozenset(RobotState) - {RobotState.STOP}, since):
        came = "the robot obeyed a copy of an old message"
        if await play.until(lambda: play.state is RobotState.STOP, ALIVE_S):
            play.find(Verdict.QUIRK, Cause.STALE_OBEYED, "old messages of the box change nothing",
                      f"{came}, and stopped again. The original clients do that, too")
            raise GaveUp
        play.give_up(Cause.STALE_OBEYED, "old messages of the box change nothing", came)
    await play.leave()


def invalid_datagrams(seed: int, code: str, password: str) -> List[bytes]:
    """Datagrams that no participant of the protocol sends."""
    rng = random.Random(seed)
    noise = [bytes(rng.getrandbits(8) for _ in range(size)) for size in (1, 7, 8, 24, 200, 1024, 1400)]
    state = wire_convert.state_message(BoxMessage(code, BoxState.PREPARE))
    key, other = Key(password), Key(f"not {password}")
    good = frame.encode(state, Cipher.AES_128_CBC, key)
    return [
        *noise, b"", b"\x1a\x0a\x00\x14" + bytes(8),  # the latter: version 1
        frame.encode(state, Cipher.AES_128_CBC, other),  # another password
        good[:-16], good[:20], good[:1] + b"\x09" + good[2:],  # cut, too short, unknown cipher
        good[:4] + b"\xff\xff\xff\xff" + good[8:],  # a wrong size
        b"\x02\x00\x00\x00\x00\x00\x00\x06\x1a\x0a\x00\x0a\x0a\xff",  # a beacon that ends within a field
        b"\x02\x00\x00\x00\x00\x00\x00\x04\x1a\x0a\x00\x0a",  # a beacon without required fields
    ]


async def garbage(play: Play, code: str) -> None:
    """Invalid datagrams arrive on both channels."""
    await play.connect(code, goals_of(code, 1))
    await play.start()
    await play.executing()
    run, options = play.box.run_in(code), play.options
    for datagram in invalid_datagrams(options.seed, code, options.password):
        play.network.resend(run.port, datagram, run.link.host)
        play.network.resend(options.rsbb_port, datagram, options.rsbb_host)
        await play.rest(0.02)
    since = len(play.record.reports)
    if not await play.until(lambda: len(play.record.reports) > since, ALIVE_S):
        play.give_up(Cause.DIES_OF_GARBAGE, "the robot ignores invalid datagrams", "no more messages of the robot")
    if play.state is RobotState.EXECUTING:
        await play.stop("after invalid datagrams")
    await play.leave()


async def large_beacon(play: Play, code: str) -> None:
    """The beacon lists as many robots as an original robot can read, and then 40."""
    box = play.box.box
    invented = tuple(BenchmarkingRobot(f"Team{n:02}", f"Robot{n:02}", 20_000 + n) for n in range(MANY))
    own = BenchmarkingRobot(play.options.team, play.robot, 65535)
    fits = max(n for n in range(MANY) if beacon_size(
        box.beacon()._replace(robots=(*invented[:n], own))) <= USUAL_DATAGRAM)
    box.extra = invented[:fits]
    await play.connect(code, missing=Cause.LARGE_BEACON)
    box.extra = invented
    await play.rest(ALIVE_S)
    since = len(play.record.reports)
    if not await play.until(lambda: len(play.record.reports) > since, ALIVE_S):
        play.give_up(Cause.LARGE_BEACON, f"the robot survives a beacon with {MANY} robots", "no more messages")
    box.extra = ()
    await play.leave()


async def burst(play: Play, code: str) -> None:
    """Devices and tablet change twenty times a second."""
    await play.connect(code, goals_of(code, 1))
    await play.start()
    await play.executing()
    box, utc = play.box.box, play.box.now().utc
    for number in range(int(BURST_S / BURST_PERIOD_S)):
        moment = (int(utc) + number, 0)
        play.box.event(
            box.devices.on_state, DevicesState(moment, bool(number % 2), True, False, number % 101, 50, False))
        play.box.event(box.arrivals.on_tablet, BEACON_HOST, TabletState(False, moment, moment, 0.1 * number, 1.0))
        await play.rest(BURST_PERIOD_S)
    if not play.over and play.state is RobotState.EXECUTING:
        await play.stop("after a burst of beacons", Cause.BURST)
    since = len(play.record.reports)
    if not await play.until(lambda: len(play.record.reports) > since, ALIVE_S):
        play.give_up(Cause.BURST, "the robot continues after twenty beacons a second", "no more messages of the robot")
    await play.leave()


async def drift(play: Play, _code: str) -> None:
    """The robot's clock keeps its distance to the checker's clock for a minute."""
    record, loop = play.record, play.loop
    if play.now < DRIFT_S:
        await play.rest(DRIFT_S - play.now)
    samples = sorted([*record.skews, *((b.mono, b.skew) for b in record.beacons if b.robot == play.robot)])
    first = [skew for mono, skew in samples if mono <= samples[0][0] + WINDOW_S]
    last = [skew for mono, skew in samples if mono >= samples[-1][0] - WINDOW_S]
    seconds = samples[-1][0] - samples[0][0] - WINDOW_S
    if seconds < DRIFT_S / 2 or loop.time() - samples[-1][0] > WINDOW_S:
        play.give_up(Cause.BEACON_PERIOD, "messages of the robot for a minute", f"messages for {seconds:.0f} s")
    if abs(play.clock_step()) > CLOCK_SET_S:
        play.skip(f"The checker's own clock was set by {play.clock_step():.3f} s")
    speed = (max(last) - max(first)) / seconds
    play.result.measured.append(f"drift: {speed * 1e3:+.3f} ms each second")
    if abs(speed) > NOTED_DRIFT:
        play.find(Verdict.FAILED if abs(speed) > MOST_DRIFT else Verdict.QUIRK, Cause.CLOCK_DRIFT,
                  "a drift of at most 0.5 ms each second", f"{speed * 1e3:+.2f} ms each second")


# In their order.
SCENARIOS: Tuple[Scenario, ...] = (
    Scenario("find", "Find the robot", find, Depth.BASIC, needs_robot=False),
    Scenario("beacon", "The robot's beacon", beacon, Depth.BASIC),
    Scenario("clock", "The robot's clock", clock, Depth.BASIC),
    Scenario("channel", "Open and leave the private channel", channel, Depth.BASIC),
    Scenario("run", "A whole run", run, Depth.BASIC),
    Scenario("stop-preparing", "STOP in PREPARING", stop_preparing, Depth.BASIC),
    Scenario("stop-waiting", "STOP in WAITING_GOAL", stop_waiting, Depth.BASIC),
    Scenario("stop-executing", "STOP in EXECUTING, and start again", stop_executing, Depth.BASIC),
    *(Scenario(f"run-{code.lower()}", f"A whole run of {code}", run, code=code) for code in PROFILES),
    Scenario("next-waypoint", "PREPARE in the middle of EXECUTING (HNF)", next_waypoint, code="HNF"),
    Scenario("goal-timeout", "A goal times out (HOPF)", goal_timeout, code="HOPF"),
    Scenario("unknown-code", "A benchmark that the robot does not know", unknown_code, code=UNKNOWN_CODE),
    Scenario("silent-3", "The box is silent for 3 s", silent_short),
    Scenario("silent-30", "The box is silent for 30 s", silent_long),
    Scenario("restart", "The box restarts on the same port", restart, bad_network=True),
    Scenario("new-port", "The box restarts, and uses another port", new_port, bad_network=True),
    Scenario("moved", "The box moves to another address", moved, bad_network=True),
    Scenario("other-box", "Another box sends beacons", other_box),
    Scenario("bad-network", "A bad network", bad_network, bad_network=True),
    Scenario("stale", "Old datagrams", stale),
    Scenario("garbage", "Invalid datagrams", garbage),
    Scenario("large-beacon", "A beacon with many robots", large_beacon),
    Scenario("burst", "A burst of events", burst, code="HCFGAC"),
    Scenario("drift", "The robot's clock over a minute", drift),
)
