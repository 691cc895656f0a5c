"""The scenarios of the basic level: the robot's beacon, clock and channel, one benchmark, and STOP in every state."""

from statistics import median
from typing import Tuple

from roah_rsbb.check.findings import Cause, Verdict
from roah_rsbb.check.play import EXECUTING_S, GaveUp, Play, goals_of
from roah_rsbb.check.scenarios.scenario import Depth, Scenario
from roah_rsbb.core.link.skew import within
from roah_rsbb.core.robots import MAX_NAME
from roah_rsbb.protocol import RobotState
from roah_rsbb.wording import times

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


SCENARIOS: Tuple[Scenario, ...] = (
    Scenario("find", "Find the robot", find, Depth.BASIC, needs_robot=False),
    Scenario("beacon", "The robot's beacon", beacon, Depth.BASIC),
    Scenario("clock", "The robot's clock", clock, Depth.BASIC),
    Scenario("channel", "Open and leave the private channel", channel, Depth.BASIC),
    Scenario("run", "A whole run", run, Depth.BASIC),
    Scenario("stop-preparing", "STOP in PREPARING", stop_preparing, Depth.BASIC),
    Scenario("stop-waiting", "STOP in WAITING_GOAL", stop_waiting, Depth.BASIC),
    Scenario("stop-executing", "STOP in EXECUTING, and start again", stop_executing, Depth.BASIC),
)
