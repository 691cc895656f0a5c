"""A run of all robots at once: a member for each robot, and one clock, score sheet and log for all.

Theory of operation. Each member is a `Run` with its own port, channel, run log and state machine, so one robot's
failure does not end another robot's run. This file has what they share: the referee's commands go to all members, the
run ends with the last of them, and their messages are shown with the robot's name.

*Start* waits briefly for robots that were just connected or just stopped. Robots that are not ready then are left out,
and join as soon as they are ready.
"""

from typing import Dict, List, NamedTuple, Optional, Tuple

from roah_rsbb.core import effects
from roah_rsbb.core.effects import Level
from roah_rsbb.core.link.link import SILENT_S
from roah_rsbb.core.runs.machine import RunEvent
from roah_rsbb.core.runs.run import (
    NO_REVISION,
    AllRobotsState,
    Assignment,
    Consequence,
    Run,
    RunContext,
    RunState,
    UnrecordedStop,
    ZoneRun,
)
from roah_rsbb.core.runs.times import CountdownState, RunTimes
from roah_rsbb.model.clock import Now
from roah_rsbb.model.messages import RobotReport
from roah_rsbb.model.reason import joined, say
from roah_rsbb.model.records import NOBODY, By, EndReason, Occurred, Phase
from roah_rsbb.protocol import BoxState
from roah_rsbb.rulebook.benchmarks import NO_RULES
from roah_rsbb.scoring.book import BookState

# *Start* waits this long for robots that have not answered or stopped yet.
SETTLE_S = SILENT_S


class Counts(NamedTuple):
    """How many robots are doing what, by the states that the box sends. The sum is the number of robots."""

    preparing: int
    executing: int
    stopped: int


OF_ROBOT = say("{robot}: {text}")
LEFT_OUT, WILL_BE_LEFT_OUT = say("left out until it is ready: {why}"), say("will be left out until it is ready: {why}")
NOT_READY, READY = say("not ready: {why}"), say("ready")
DOING = say("{doing}, messages saved: {number}")
STARTED_WITH = say("Started with {number} of {all} robots")
CONNECTED = say("Robots connected: {number} / ready: {ready}")
COUNTS = say("Robots preparing: {preparing} / executing: {executing} / stopped: {stopped}")
COUNTED, WHOLE_END = say("{number} {end}"), say("{end} ({counted})")
# How the ends of the members are worded where they are counted.
ENDS: Dict[EndReason, str] = {
    EndReason.COMPLETED: say("completed"),
    EndReason.STOPPED: say("stopped by the referee"),
    EndReason.TIMEOUT: say("out of time"),
    EndReason.NO_MESSAGES_SAVED: say("saved no offline data"),
}
# How the end of the whole run is worded.
WHOLE_ENDS: Dict[EndReason, str] = {
    EndReason.COMPLETED: say("All robots have ended"),
    EndReason.STOPPED: EndReason.STOPPED.value,
    EndReason.TIMEOUT: EndReason.TIMEOUT.value,
    EndReason.NO_MESSAGES_SAVED: say("Stopped: no robot saves offline data"),
}
DOINGS: Dict[BoxState, str] = {
    BoxState.STOP: say("stopped"), BoxState.PREPARE: say("preparing"), BoxState.WAITING_RESULT: say("executing"),
}


class MemberRun(Run):
    """One robot's part in a run of all robots. It is left out while it is in phase *connected* and others run."""

    def __init__(
        self, now: Now, whole: "AllRobotsRun", assignment: Assignment, context: RunContext,
        state: Optional[RunState] = None,
    ) -> None:
        super().__init__(now, assignment, context, state)
        self._whole = whole
        self.left_out_s = 0.0  # seconds before its end that are not counted, as the box was away
        self.clock, self.state.clock = whole.clock, whole.clock.state
        self.times = RunTimes(NO_RULES, self.state.times)  # the whole run follows the rules

    @property
    def _is_in_progress(self) -> bool:
        """One that was left out may have joined the others, and been stopped, while the box before was the box."""
        return self._whole.phase is Phase.RUNNING and self.phase is not Phase.ENDED

    def _begin_again(self, now: Now) -> None:
        """See `Run._begin_again`. One that was left out joins the others with its next message."""
        if self.phase is Phase.RUNNING:
            super()._begin_again(now)

    def leave_out(self, now: Now) -> None:
        """Note that the others start without this robot, which is not ready."""
        self._enter(RunEvent.LEAVE_OUT)
        self.state.doubted = self.state.asks = False
        self.say(now, Level.WARNING, LEFT_OUT(why=self.why_not_ready(now)))

    def why_not_ready(self, now: Now) -> str:
        """Return why the robot cannot be started now; empty: it can."""
        return joined(self.link.not_ready(now))

    def on_report(self, now: Now, host: str, report: RobotReport, arrival: Now) -> Consequence:
        """See `Run.on_report`."""
        taken = super().on_report(now, host, report, arrival)
        self._whole.on_member_heard(now, self)
        return taken

    def _leave_out_outage(self, now: Now, away_s: float) -> float:
        """See `Run._leave_out_outage`. The whole run has the outages, and leaves this one out if this robot is the
        last to end."""
        self.left_out_s = away_s
        return away_s

    @property
    def settled_at(self) -> int:
        """See `Run.settled_at`. A robot that was left out joins the others as soon as it is ready."""
        is_awaited = self._whole.phase is Phase.RUNNING and self.phase is Phase.CONNECTED
        return NO_REVISION if is_awaited else super().settled_at

    def doing(self, now: Now) -> str:
        """Return what the robot is doing, in a few words."""
        if self.phase is Phase.CONNECTED:
            why = self.why_not_ready(now)
            return NOT_READY(why=why) if why else READY
        done = DOINGS[self.message.state] if self.end_reason is None else ENDS[self.end_reason]
        return DOING(doing=done, number=self.link.messages_saved)

    def _stop_clock(self, now: Now) -> None:
        """Do nothing: others may continue. The whole run stops it with the last one."""

    def _set_pauses(self, now: Now, by: By = NOBODY) -> None:
        """Do nothing: the whole run knows whether the clock is paused."""

    def _time_out(self, now: Now) -> None:
        """Do nothing: the whole run rings the bell, once."""
        self._end(now, EndReason.TIMEOUT)

    def happened(self, now: Now, what: Occurred, who: str = "", text: str = "") -> None:
        """Do nothing: the whole run has the only timeline."""

    def _record_changed(self, now: Now) -> None:
        """Report the change to the whole run, which has the only record."""

    def say(self, now: Now, level: Level, text: str) -> None:
        """Log a line in the shared log, with the robot's name."""
        self._whole.say(now, level, f"{self.robot}: {text}")

    def show_online(self, now: Now, text: str) -> None:
        """Like `say`, for online data."""
        self._whole.show_online(now, f"{self.robot}: {text}")


class AllRobotsRun(ZoneRun):
    """See `ZoneRun`. It always has at least one member outside its constructor."""

    state: AllRobotsState

    def __init__(
        self, now: Now, first: Assignment, context: RunContext, state: Optional[AllRobotsState] = None
    ) -> None:
        """`first`: the first robot. `state`: of a run that continues after a restart of the core."""
        super().__init__(first.zone, first.event, context, state or AllRobotsState(
            first.identity(now), now.utc, Phase.CONNECTED, None, "", CountdownState(), BookState()))
        self._context = context
        self._settled_mono = now.mono + SETTLE_S
        self._hint_mono: Optional[float] = self._settled_mono  # when the reasons against a start may change
        self._members: List[MemberRun] = []
        if state is None:
            self.times.connected(now)
        for of_member in self.state.members:
            assignment = Assignment(self.zone, self.event, of_member.robot, of_member.port)
            self._members.append(MemberRun(now, self, assignment, context, of_member))

    # -- members ------------------------------------------------------------------------------------

    def add(self, now: Now, assignment: Assignment) -> None:
        """Add a robot whose channel is being opened."""
        member = MemberRun(now, self, assignment, self._context)
        self._members.append(member)
        self.state.members.append(member.state)
        self._record_changed(now)
        member.open(now)

    def resume(self) -> None:
        """Continue in the saved state."""
        for member in self._members:
            member.resume()

    def members(self) -> Tuple[MemberRun, ...]:
        """See `ZoneRun`."""
        return tuple(self._members)

    def without(self, member: Run) -> Optional["AllRobotsRun"]:
        """See `ZoneRun`."""
        self._members = [other for other in self._members if other is not member]
        self.state.members = [other.state for other in self._members]
        return self if self._members else None

    def on_member_heard(self, now: Now, member: MemberRun) -> None:
        """Handle a message that a member took. The member may now join the others, or be the last to end."""
        is_awaited = member.phase is Phase.CONNECTED and not member.state.doubted
        if self.phase is Phase.RUNNING and is_awaited and not member.why_not_ready(now):
            self.say(now, Level.INFO, f"{member.robot} is ready now, and joins the run")
            member.start(now)
        self._end_with_the_last(now, member.left_out_s)

    def note_outage(self, now: Now, down_s: float) -> None:
        """See `ZoneRun`."""
        super().note_outage(now, down_s)
        for member in self._in_phase(Phase.RUNNING):
            member.state.away_s += down_s

    # -- the referee --------------------------------------------------------------------------------

    def start(self, now: Now, by: By = NOBODY) -> None:
        """See `ZoneRun`. All members share the clock: they start it, and stop it when they end."""
        self._enter(RunEvent.START)
        self._note_start(now, by)
        for member in self._members:
            if member.why_not_ready(now):
                member.leave_out(now)
            else:
                member.start(now)
        self.state.desc = STARTED_WITH(number=len(self._in_phase(Phase.RUNNING)), all=len(self._members))
        self.say(now, Level.INFO, self.desc)

    def stop(self, now: Now, by: By = NOBODY) -> None:
        """See `ZoneRun`."""
        for member in self._in_phase(Phase.RUNNING):
            member.stop(now)
        self._end(now, EndReason.STOPPED, by)

    def take_stop(self, sent: UnrecordedStop) -> None:
        """See `ZoneRun`."""
        for member in self._in_phase(Phase.RUNNING):
            member.take_stop(sent)
        self._end(sent.at, sent.reason, sent.by)

    def close(self, now: Now, by: By = NOBODY) -> None:
        """See `ZoneRun`."""
        self._note_close(now, by)
        for member in self._members:
            member.close(now)

    # -- time ---------------------------------------------------------------------------------------

    def deadline(self) -> Optional[float]:
        """See `ZoneRun`. Any running member knows when the shared clock is over."""
        found = [self.times.deadline(), self._hint_mono, *(member.deadline() for member in self._members)]
        return min((t for t in found if t is not None), default=None)

    def tick(self, now: Now) -> None:
        """See `ZoneRun`."""
        if self._hint_mono is not None and now.mono >= self._hint_mono:
            self._hint_mono = None  # whoever shows the reasons against a start looks after each tick
        self._tick_times(now)
        for member in self._members:
            member.tick(now)
        self._end_with_the_last(now)

    def _end_with_the_last(self, now: Now, left_out_s: float = 0.0) -> None:
        if self.phase is not Phase.RUNNING or self._in_phase(Phase.RUNNING):
            return
        ends = [member.end_reason for member in self._in_phase(Phase.ENDED)]
        if EndReason.TIMEOUT in ends:
            self._end(now, EndReason.TIMEOUT)
            self._emit(effects.TimeoutRung(self.zone))
        elif EndReason.COMPLETED in ends:
            self._end(now, EndReason.COMPLETED, left_out_s=left_out_s)
        else:
            self._end(now, EndReason.NO_MESSAGES_SAVED)

    def _end(self, now: Now, reason: EndReason, by: By = NOBODY, left_out_s: float = 0.0) -> None:
        self._enter(RunEvent.END, reason)
        self._settled_mono = self._hint_mono = now.mono + SETTLE_S
        ends = [member.end_reason for member in self._in_phase(Phase.ENDED)]
        counted = [COUNTED(number=ends.count(end), end=text) for end, text in ENDS.items() if end in ends]
        self.state.desc = WHOLE_END(end=WHOLE_ENDS[reason], counted=joined(counted, ", "))
        self.clock.stop(now)
        self._note_end(now, self.desc, by, self._leave_out_outage(now, left_out_s))
        self.say(now, Level.INFO, self.desc)

    # -- for the referee ------------------------------------------------------------------------------

    def start_off(self, now: Now) -> List[str]:
        """See `ZoneRun`. A robot that is not ready delays the start only for a moment, unless no robot is ready."""
        waiting = [member for member in self._members if member.why_not_ready(now)]
        if now.mono >= self._settled_mono and len(waiting) < len(self._members):
            return []
        return [OF_ROBOT(robot=str(member.robot), text=member.why_not_ready(now)) for member in waiting]

    def warnings(self, now: Now) -> List[str]:
        """See `ZoneRun`; each with its robot's name."""
        return [OF_ROBOT(robot=str(member.robot), text=text)
                for member in self._members for text in self._warnings_of(member, now)]

    def _warnings_of(self, member: MemberRun, now: Now) -> List[str]:
        if self.phase is Phase.RUNNING:
            if member.phase is Phase.CONNECTED:
                doubt = member.doubt(now)
                return [doubt or LEFT_OUT(why=member.why_not_ready(now))]
        elif now.mono >= self._settled_mono and not self.clock.is_over(now) and member.why_not_ready(now):
            return member.ignores_stop(now) + [WILL_BE_LEFT_OUT(why=member.why_not_ready(now))]
        saved_nothing = member.end_reason is EndReason.NO_MESSAGES_SAVED
        return ([member.desc] if saved_nothing else []) + member.warnings(now)

    def status_lines(self, now: Now) -> List[str]:
        """See `ZoneRun`."""
        if self.phase is Phase.CONNECTED:
            ready = sum(1 for member in self._members if not member.why_not_ready(now))
            return [CONNECTED(number=len(self._members), ready=ready)]
        counts = self.counts()
        return [
            COUNTS(preparing=counts.preparing, executing=counts.executing, stopped=counts.stopped)
        ]

    def counts(self) -> Counts:
        """Return how many robots are doing what."""
        states = [member.message.state for member in self._members]
        preparing, stopped = states.count(BoxState.PREPARE), states.count(BoxState.STOP)
        return Counts(preparing, len(states) - preparing - stopped, stopped)

    def robots(self, now: Now) -> List[str]:
        """Return a line for each robot: its name and what it is doing."""
        return [OF_ROBOT(robot=str(member.robot), text=member.doing(now)) for member in self._members]

    def _robot_names(self) -> Tuple[str, ...]:
        return tuple(str(member.robot) for member in self._members)

    def _in_phase(self, phase: Phase) -> List[MemberRun]:
        return [member for member in self._members if member.phase is phase]
