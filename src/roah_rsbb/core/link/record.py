"""The link record: the quality of the wireless link in each second, for analysis after the run.

The box sees only its own end of the link. Everything here follows from the arrival of messages, from the robot's time
in them, and from the rules by which both sides send (docs/protocol.md, "Timing"): each second, and ten times at 50 ms
after a change of state. `LinkSample` explains for each number what it is based on and what it cannot show. If the rules
allow two numbers, the smaller one is taken: the original client's ten begin with the change, while those of this
project's client follow it. A robot that follows the rules therefore never shows losses that did not happen, but some
losses remain unseen.

A busy robot looks like a slow network. If only one robot is affected, check that robot and its radio. If all robots are
affected in the same second, check the access point.
"""

from typing import FrozenSet, List, NamedTuple, Optional, Tuple, TypeVar

from roah_rsbb.model.clock import Now
from roah_rsbb.model.messages import ANSWER_S, LinkSample, RobotReport
from roah_rsbb.protocol import BURST_COUNT, BURST_INTERVAL_S, PERIOD_S, BoxState, RobotState, sent_after_change

S = TypeVar("S", float, Optional[float])

# A robot's burst ends after this many seconds: one and a half times its regular length, for slow robots.
BURST_OVER_S = 1.5 * BURST_COUNT * BURST_INTERVAL_S
# The interval (s) between a slow robot's datagrams, for a burst that the next change cuts short.
SLOW_INTERVAL_S = 1.25 * BURST_INTERVAL_S
# A robot from which this many datagrams of a burst arrived is known to send bursts.
IS_BURST = 6
# No datagram travels longer (s). If it seems so, the robot's clock jumped.
MOST_LATE_S = 5.0
# Maximum number of acknowledgements that are remembered.
MAX_ACKNOWLEDGED = 64

# The robot's states (docs/protocol.md, "Robot's next state") in which it must react to the box's new state at once, and
# the states that show that it reacted.
_MUST_ANSWER = {
    BoxState.STOP: frozenset(RobotState) - {RobotState.STOP},
    BoxState.PREPARE: frozenset({RobotState.STOP, RobotState.RESULT_TX}),
    BoxState.GOAL_TX: frozenset({RobotState.WAITING_GOAL}),
    BoxState.WAITING_RESULT: frozenset({RobotState.WAITING_GOAL}),
}
_ANSWERS = {
    BoxState.STOP: frozenset({RobotState.STOP}),
    BoxState.PREPARE: frozenset({RobotState.PREPARING, RobotState.WAITING_GOAL}),
    BoxState.GOAL_TX: frozenset({RobotState.EXECUTING, RobotState.RESULT_TX}),
    BoxState.WAITING_RESULT: frozenset({RobotState.EXECUTING, RobotState.RESULT_TX}),
}


def skipped_states(before: RobotState, state: RobotState) -> int:
    """Return the least number of states that a robot skipped between two successive reports.

    It may stop or prepare again from any state (docs/protocol.md, "Robot's next state").
    """
    if state is RobotState.STOP or state == before:
        return 0
    return state - (before if before < state else RobotState.STOP) - 1


class _Burst:
    """A robot's datagrams after a change of its state, by its own clock. No burst is open when `got` is 0."""

    __slots__ = ("age_s", "got", "sends_bursts")

    def __init__(self) -> None:
        self.age_s = 0.0  # from the change to the last message
        self.got = 0  # datagrams so far
        self.sends_bursts = False  # a burst of this robot was received

    def lost(self, passed: float, changed: bool) -> int:
        """Return the number of datagrams missing before a message sent `passed` seconds after the previous one."""
        lost = 0
        if self.got:
            self.age_s += passed
            if not changed and self.age_s < BURST_OVER_S:
                self.got += 1
                passed = 0.0
            else:
                lost = self._close()
                passed = min(passed, self.age_s - BURST_COUNT * BURST_INTERVAL_S)
        if changed:
            self.age_s, self.got = 0.0, 1
        return lost + max(0, int(passed / PERIOD_S + 0.5) - 1)

    def _close(self) -> int:
        """End the burst: it is over, or cut short by another one."""
        due = min(BURST_COUNT, 1 + int(self.age_s / SLOW_INTERVAL_S))
        self.sends_bursts = self.sends_bursts or self.got >= IS_BURST
        lost = max(0, due - self.got) if self.sends_bursts else 0
        self.got = 0
        return lost


class _Question(NamedTuple):
    """A change of state that the robot must react to."""

    asked: Now
    state: BoxState


class LinkRecorder:
    """Keeps the record of one robot's link. It must be fast, because it runs between a datagram and its answer."""

    def __init__(self, now: Now) -> None:
        """The box listens from `now` on."""
        self._burst = _Burst()
        self._last_ns: Optional[int] = None  # robot's time of the last message that was newer
        self._heard_mono = now.mono
        self._state: Optional[RobotState] = None
        self._said: Optional[BoxState] = None
        self._question: Optional[_Question] = None
        self._no_answer_to = 0  # datagrams of the question that were counted as unanswered
        self._had_strings = False
        self._strings: FrozenSet[Tuple[int, str]] = frozenset()  # acknowledged, and not dropped yet
        self._acknowledged: List[Now] = []  # the times of acknowledgements
        self._first_acknowledged: Optional[Now] = None
        self._unreadable = 0  # at the last sample
        self._sampled_mono = now.mono
        self._begin_sample()

    def _begin_sample(self) -> None:
        self._received = self._lost = self._skipped = self._duplicates = self._stale = 0
        self._answers = self._unanswered = 0
        self._gap_s = self._late_s = 0.0
        self._round_trip_s: Optional[float] = None
        self._round_trip_max_s: Optional[float] = None
        self._skew_max_s: Optional[float] = None

    # -- events ---------------------------------------------------------------------------------------

    def old(self, duplicate: bool, count: int = 1) -> None:
        """Count messages that were not newer than all before."""
        if duplicate:
            self._duplicates += count
        else:
            self._stale += count

    def heard(self, now: Now, report: RobotReport, time_ns: int, late_s: float, clock_set: bool) -> None:
        """Take a message that was newer, with its time. `late_s`: its delay compared with the fastest one. `clock_set`:
        the robot's clock was set since the previous message, so their times cannot be compared."""
        self._received += 1
        if late_s > self._late_s:
            self._late_s = late_s
        state = report.state
        changed = self._state is not None and state is not self._state
        silence = now.mono - self._heard_mono
        if silence > self._gap_s:
            self._gap_s = silence
        if self._last_ns is not None:
            passed = silence if clock_set else min((time_ns - self._last_ns) / 1e9, silence + MOST_LATE_S)
            self._lost += self._burst.lost(passed, changed)
        if changed and self._state is not None:
            self._skipped += skipped_states(self._state, state)
        if self._question is not None:
            self._look_for_answer(now, time_ns, state, self._question)
        self._look_at_strings(now, time_ns, report, changed)
        self._last_ns, self._heard_mono, self._state = time_ns, now.mono, state

    def box_says(self, now: Now, state: BoxState) -> None:
        """Note that the box sends this state at once, and then its burst."""
        if state is self._said:
            return
        self._said = state
        self._question = _Question(now, state) if self._state in _MUST_ANSWER[state] else None
        self._no_answer_to = 0

    def clock_set(self) -> None:
        """Drop open questions: the box's clock was set, so their times cannot be compared with the robot's."""
        self._question, self._strings = None, frozenset()

    def sample(self, now: Now, skew_s: Optional[float], host: Optional[str], unreadable: int) -> LinkSample:
        """Return the measurements since the last sample. `unreadable`: the channel's total so far."""
        sample = LinkSample(
            seconds=_rounded(now.mono - self._sampled_mono), received=self._received, lost=self._lost,
            skipped_states=self._skipped, duplicates=self._duplicates, stale=self._stale,
            unreadable=max(0, unreadable - self._unreadable),
            gap_s=_rounded(max(self._gap_s, now.mono - self._heard_mono)), late_s=_rounded(self._late_s),
            answers=self._answers, unanswered=self._unanswered, round_trip_s=_rounded(self._round_trip_s),
            round_trip_max_s=_rounded(self._round_trip_max_s), skew_s=_rounded(skew_s),
            skew_max_s=_rounded(self._skew_max_s), host=host or "",
        )
        self._unreadable, self._sampled_mono = unreadable, now.mono
        self._begin_sample()
        return sample

    # -- reactions ----------------------------------------------------------------------------------

    def _look_for_answer(self, now: Now, time_ns: int, state: RobotState, question: _Question) -> None:
        asked = question.asked
        if state in _ANSWERS[question.state]:
            self._question = None
            if now.mono >= asked.mono:  # else it arrived before, and was read afterwards
                self._answered(now, time_ns, asked)
            return
        known = sent_after_change(now.mono - asked.mono - ANSWER_S)
        self._unanswered += known - self._no_answer_to
        self._no_answer_to = known

    def _look_at_strings(self, now: Now, time_ns: int, report: RobotReport, changed: bool) -> None:
        """Take reactions to acknowledgements. Robots send online data until it is acknowledged, and the box
        acknowledges each message that contains any at once.

        Only strings that follow a message without any are considered, because only for those is the time of the first
        acknowledgement known. With a change of its state, a robot may drop strings for another reason.
        """
        has_strings = bool(report.notifications or report.activation_event or report.visitor or report.final_command)
        if not has_strings and not self._strings:
            self._had_strings = False
            return
        strings = _strings_of(report) if has_strings else frozenset()
        if self._strings:
            if self._strings.isdisjoint(strings):
                if not changed and self._first_acknowledged is not None:
                    self._answered(now, time_ns, self._first_acknowledged)
                self._strings = frozenset()
            else:
                self._note_unheard(now)
        elif has_strings and not self._had_strings:
            self._strings, self._first_acknowledged, self._acknowledged = strings, now, [now]
        self._had_strings = has_strings

    def _note_unheard(self, now: Now) -> None:
        """Count acknowledgements as lost that the robot should have by now, because it repeats acknowledged data."""
        unheard = [then for then in self._acknowledged if then.mono <= now.mono - ANSWER_S]
        self._unanswered += len(unheard)
        self._acknowledged = [*self._acknowledged[len(unheard):], now][-MAX_ACKNOWLEDGED:]

    def _answered(self, now: Now, time_ns: int, since: Now) -> None:
        seconds = now.mono - since.mono
        self._answers += 1
        if self._round_trip_s is None or seconds < self._round_trip_s:
            self._round_trip_s = seconds
        if self._round_trip_max_s is None or seconds > self._round_trip_max_s:
            self._round_trip_max_s = seconds
        skew_max = time_ns / 1e9 - since.utc
        if self._skew_max_s is None or skew_max < self._skew_max_s:
            self._skew_max_s = skew_max


def _strings_of(report: RobotReport) -> FrozenSet[Tuple[int, str]]:
    fields = (report.notifications, report.activation_event, report.visitor, report.final_command)
    return frozenset((number, text) for number, texts in enumerate(fields) for text in texts)


def _rounded(seconds: S) -> S:
    """Round to microseconds, to write less."""
    return None if seconds is None else round(seconds, 6)
