"""The scenarios about goals: each benchmark, timeouts of goals, a benchmark that no robot knows."""

from typing import Tuple

from roah_rsbb.check.box import UNKNOWN_CODE
from roah_rsbb.check.findings import Cause, Verdict
from roah_rsbb.check.play import OBEY_S, GaveUp, Play, goals_of
from roah_rsbb.check.scenarios import basic
from roah_rsbb.check.scenarios.scenario import Scenario
from roah_rsbb.model.modules import OutcomeKind
from roah_rsbb.protocol import BoxState, RobotState
from roah_rsbb.rulebook.registry import PROFILES

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


SCENARIOS: Tuple[Scenario, ...] = (
    *(Scenario(f"run-{code.lower()}", f"A whole run of {code}", basic.run, code=code) for code in PROFILES),
    Scenario("next-waypoint", "PREPARE in the middle of EXECUTING (HNF)", next_waypoint, code="HNF"),
    Scenario("goal-timeout", "A goal times out (HOPF)", goal_timeout, code="HOPF"),
    Scenario("unknown-code", "A benchmark that the robot does not know", unknown_code, code=UNKNOWN_CODE),
)
