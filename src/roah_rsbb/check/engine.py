"""Runs scenarios one after the other, and collects their results."""

import asyncio
from typing import Callable, Dict, FrozenSet, Iterable, List, NamedTuple, Optional, Sequence, Tuple

from roah_rsbb.bmbox.framework.results import BadResult, read_record
from roah_rsbb.check.box import STILL_VALID_S, HeardReport, states_before
from roah_rsbb.check.play import SILENT_S, GaveUp, Play
from roah_rsbb.check.report import Cause, Finding, ScenarioResult, Verdict
from roah_rsbb.check.scenarios import SCENARIOS, Depth, Scenario
from roah_rsbb.comm.frame import FrameFault
from roah_rsbb.core.modules import result_text
from roah_rsbb.model.messages import RobotReport
from roah_rsbb.protocol import BoxState, RobotState, wire_seconds
from roah_rsbb.robot.machine import BOX_TABLE, EVENT_TABLE, box_transition
from roah_rsbb.rulebook.registry import DEVICES, PROFILES, ResultForm, profile_of

# -- what is watched in every scenario ----------------------------------------------------------------

# Several reports, and this share of all, must be old: a network may deliver a few out of order.
STALE, STALE_SHARE = 5, 0.2
# The box stops a run without saved messages after this many seconds of EXECUTING.
SAVING_S = 5.0
# Messages in a second of the robot's clock. Correct robots send about 20, and one more at each change.
MOST_MESSAGES = 100
MAX_DATAGRAM = 1024
_RESULTS = {
    ResultForm.OBJECT: {"class": str, "instance": str, "x": float, "y": float, "theta": float},
    ResultForm.PERSON: {"person_name": str, "x": float, "y": float},
}
_USUAL_RATE = "at most about 20 messages a second"
_FRAMES = {FrameFault.UNDECRYPTABLE: Cause.WRONG_PASSWORD, FrameFault.PLAIN: Cause.PLAIN_FRAMES}

# After these findings, the robot left its state for a known reason.
_EXPLAIN = {Cause.GIVES_UP, Cause.RESULT_LEFT, Cause.RESTART_NOT_FOLLOWED, Cause.FOREIGN_BOX, Cause.STALE_OBEYED,
            Cause.DIES_OF_GARBAGE}


class RecordMark(NamedTuple):
    """How far the record was at the beginning of a scenario."""

    reports: int
    unreadable: int
    stale: int
    overload: int


def mark(play: Play) -> RecordMark:
    """Note the beginning of a scenario."""
    record = play.record
    return RecordMark(len(record.reports), len(record.unreadable), record.stale, record.overload)


def judge(play: Play, since: RecordMark, code: str) -> None:
    """Record what is wrong with the messages since the beginning of the scenario. `code`: its benchmark."""
    record, reports = play.record, play.record.reports[since.reports:]
    for _, text in record.unreadable[since.unreadable:]:
        _judge_frame(play, text)
    if play.network.largest > MAX_DATAGRAM:
        play.fail(Cause.TOO_LARGE, f"at most {MAX_DATAGRAM} bytes in a datagram", f"{play.network.largest} bytes")
        play.network.largest = 0
    if record.overload > since.overload:
        play.fail(Cause.FLOOD, _USUAL_RATE, f"{record.overload - since.overload} messages more than the box reads")
    old = record.stale - since.stale
    if play.judges_times and old >= max(STALE, STALE_SHARE * (len(reports) + old)):
        play.fail(Cause.TIME_NOT_RISING, "a later time in each message",
                  f"{old} messages with the time of an earlier one, or an older time")
    for port in sorted({heard.port for heard in reports}):
        _judge_channel(play, [heard for heard in reports if heard.port == port], code)


def _judge_frame(play: Play, text: str) -> None:
    reason = next((reason for reason in FrameFault if f": {reason.value}: " in text), None)
    cause = _FRAMES.get(reason, Cause.BAD_FRAMES) if reason is not None else Cause.BAD_FRAMES
    play.fail(cause, "frames that the box can read", text)


def _judge_channel(play: Play, reports: List[HeardReport], code: str) -> None:
    """Judge the reports of one private channel."""
    for before, after in zip(reports, reports[1:]):
        _judge_step(play, before, after, code)
        if play.judges_times and after.mono - before.mono > SILENT_S:
            stalled = play.stalls.since(before.mono)
            if after.mono - before.mono - stalled > SILENT_S:
                play.fail(Cause.SILENT, "a RobotState each second", f"none for {after.mono - before.mono:.1f} s")
    _judge_rate(play, reports)
    _judge_saving(play, reports, code)
    _judge_results(play, reports, code)
    _judge_commands(play, reports, code)


def _judge_rate(play: Play, reports: List[HeardReport]) -> None:
    times = [wire_seconds(heard.report.time) for heard in reports]
    if any(0.0 <= last - first < 1.0 for first, last in zip(times, times[MOST_MESSAGES:])):
        play.fail(Cause.FLOOD, _USUAL_RATE, f"more than {MOST_MESSAGES} in a second")


def _judge_step(play: Play, before: HeardReport, after: HeardReport, code: str) -> None:
    old, new = before.report.state, after.report.state
    if old is new:
        return
    asked = states_before(play.record, after, before.mono - STILL_VALID_S)
    if new in _reachable(code, old, asked):
        return
    if any(finding.cause in _EXPLAIN for finding in play.result.findings):
        return
    expected = f"a step of the protocol's table from {old.name}, after {_names(asked)}"
    play.fail(_wrong_step(old, new), expected, f"{old.name}, then {new.name}")


def _reachable(code: str, state: RobotState, asked: Iterable[BoxState]) -> FrozenSet[RobotState]:
    """The states that a correct robot may report next, if it received some of these states of the box."""
    found, fresh = {state}, [state]
    asked = set(asked)
    while fresh:
        here = fresh.pop()
        following = {box_transition(code, box, here).state for box in asked if (box, here) in BOX_TABLE}
        following |= {after for (_, before), after in EVENT_TABLE.items() if before is here}
        fresh += following - found
        found |= following
    return frozenset(found)


def _wrong_step(old: RobotState, new: RobotState) -> Cause:
    if old is RobotState.RESULT_TX:
        return Cause.RESULT_LEFT
    if new is RobotState.EXECUTING or (new is RobotState.RESULT_TX and old is not RobotState.EXECUTING):
        return Cause.EXECUTES_EARLY
    return Cause.FELL_TO_STOP if new is RobotState.STOP else Cause.ILLEGAL_STATE


def _names(states: Iterable[BoxState]) -> str:
    names: List[str] = []
    for state in states:
        if state.name not in names:
            names.append(state.name)
    return ", ".join(names) or "nothing"


def _judge_saving(play: Play, reports: List[HeardReport], code: str) -> None:
    if not profile_of(code).offline_data:
        return
    began: Optional[float] = None
    for heard in reports:
        report = heard.report
        if report.messages_saved or report.state not in (RobotState.EXECUTING, RobotState.RESULT_TX):
            began = None
            continue
        began = heard.mono if began is None else began
        if report.state is RobotState.RESULT_TX or heard.mono - began > SAVING_S:
            play.fail(Cause.NOTHING_SAVED, "messages_saved above 0 while the robot executes",
                      f"0 in {report.state.name}, {heard.mono - began:.1f} s after EXECUTING")
            return


def _judge_results(play: Play, reports: List[HeardReport], code: str) -> None:
    shape = _RESULTS.get(profile_of(code).result)
    if shape is None:
        return
    for heard in reports:
        if heard.report.state is RobotState.RESULT_TX:
            cause, came = _wrong_result(heard.report, shape)
            if cause is not None:
                play.fail(cause, "{" + ", ".join(shape) + "} in every RESULT_TX message", came)
                return


def _wrong_result(report: RobotReport, shape: Dict[str, type]) -> Tuple[Optional[Cause], str]:
    text = result_text(report)
    if not text:
        return Cause.RESULT_MISSING, "a message without a result"
    try:
        read_record(text, shape)
    except BadResult as bad:
        return Cause.RESULT_INCOMPLETE, str(bad)
    return None, ""


def _judge_commands(play: Play, reports: List[HeardReport], code: str) -> None:
    if DEVICES not in profile_of(code).uses:
        return
    first = reports[0].report if reports else None
    if first is not None and _commands(first):
        play.find(Verdict.QUIRK, Cause.OLD_COMMANDS, "no device commands in the first message of a run",
                  ", ".join(_commands(first)))
    for heard in reports:
        for name in ("dimmer", "blinds"):
            value = getattr(heard.report, name)
            if value is not None and value > 100:
                play.fail(Cause.BAD_COMMAND, f"{name} from 0 to 100", str(value))


def _commands(report: RobotReport) -> List[str]:
    names = ("switch_1", "switch_2", "switch_3", "dimmer", "blinds", "display_map")
    return [f"{name} {getattr(report, name)}" for name in names if getattr(report, name) is not None]


# -- the engine ---------------------------------------------------------------------------------------

# If the check itself was stopped for longer than this (s) during a scenario, it does not judge the robot's times in it.
BUSY_S = 0.3
# Datagrams that a bad network delayed must not arrive in the next scenario.
LATE_S = 0.5

OnResult = Callable[[ScenarioResult], None]


def scenarios_of(level: Depth, benchmarks: Sequence[str], names: Optional[Sequence[str]] = None) -> List[Scenario]:
    """Return the scenarios of a level, in order. `names`: only these, and the search for the robot."""
    if names is not None:
        return [one for one in SCENARIOS if one.name in names or not one.needs_robot]
    if level is Depth.BASIC:
        return [one for one in SCENARIOS if one.level is Depth.BASIC]
    others = {code for code in PROFILES if code not in benchmarks}
    done = f"run-{benchmarks[0].lower()}"  # by the scenario "run"
    return [one for one in SCENARIOS if one.code not in others and one.name != done]


class Engine:
    """One check from its beginning to its end."""

    def __init__(
        self, play: Play, scenarios: Sequence[Scenario], on_begin: OnResult = lambda result: None,
        on_end: OnResult = lambda result: None,
    ) -> None:
        """`on_begin` and `on_end` are called around each scenario, for the display."""
        self.play = play
        self.results: List[ScenarioResult] = []
        self._scenarios = scenarios
        self._on_begin = on_begin
        self._on_end = on_end

    async def run(self) -> None:
        """Run all scenarios. If cancelled, stop the robot, keep the results so far, and raise CancelledError."""
        play = self.play
        try:
            for scenario in self._scenarios:
                await self._run(scenario)
        except asyncio.CancelledError:
            await play.tidy()
            raise

    async def _run(self, scenario: Scenario) -> None:
        play = self.play
        code = scenario.code or play.options.benchmarks[0]
        result = play.result = ScenarioResult(scenario.name, scenario.title, play.now)
        began, since = play.loop.time(), mark(play)
        play.judges_times = not scenario.bad_network
        self._on_begin(result)
        try:
            if scenario.needs_robot and not play.robot:
                play.skip("The robot was not found")
            await scenario.run(play, code)
        except GaveUp:
            pass
        except asyncio.CancelledError:
            result.findings.append(Finding(Verdict.SKIPPED, None, "", "The check was interrupted", play.now))
            self._end(result, began)
            raise
        judge(play, since, code)
        await play.tidy()
        if scenario.bad_network:
            await play.rest(LATE_S)
        if play.stalls.worst(began) > BUSY_S:
            _unjudge(result)
        self._end(result, began)

    def _end(self, result: ScenarioResult, began: float) -> None:
        result.seconds = self.play.loop.time() - began
        self.results.append(result)
        self._on_end(result)


def _unjudge(result: ScenarioResult) -> None:
    """Turn failures that the checker's busy machine may have caused into "not judged"."""
    result.findings = [
        one._replace(verdict=Verdict.UNJUDGED, came=f"{one.came}; but the checker's machine was too busy to judge")
        if one.verdict is Verdict.FAILED and one.cause is not None and one.cause.timed else one
        for one in result.findings]
