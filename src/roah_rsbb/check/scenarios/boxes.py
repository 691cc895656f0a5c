"""The scenarios about boxes: silent, restarted, at another address, and a second one."""

from typing import Tuple

from roah_rsbb.check.bad_network import MUTE, PERFECT
from roah_rsbb.check.box import states_before
from roah_rsbb.check.findings import Cause, Verdict
from roah_rsbb.check.play import LEAVE_S, GaveUp, Play, goals_of
from roah_rsbb.check.scenarios.scenario import Scenario
from roah_rsbb.comm import frame
from roah_rsbb.model.messages import Beacon, DevicesState, TabletState
from roah_rsbb.protocol import BoxState, RobotState
from roah_rsbb.radio import wire_convert

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


SCENARIOS: Tuple[Scenario, ...] = (
    Scenario("silent-3", "The box is silent for 3 s", silent_short),
    Scenario("silent-30", "The box is silent for 30 s", silent_long),
    Scenario("restart", "The box restarts on the same port", restart, bad_network=True),
    Scenario("new-port", "The box restarts, and uses another port", new_port, bad_network=True),
    Scenario("moved", "The box moves to another address", moved, bad_network=True),
    Scenario("other-box", "Another box sends beacons", other_box),
)
