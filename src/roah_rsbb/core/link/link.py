"""The box's view of the robot at the other end of a private channel.

This file detects staleness, skew, silence and clock steps. `roah_rsbb.core.runs.run` decides what they mean for the
run.
"""

import enum
from dataclasses import dataclass, field
from typing import Callable, List, NamedTuple, Optional, Tuple

from roah_rsbb.core.link.freshness import Freshness, RobotPast, Timeline, TimelineState
from roah_rsbb.core.link.record import LinkRecorder
from roah_rsbb.core.link.skew import THE_ROBOT, SkewEstimate, SkewSample, skew_off, within
from roah_rsbb.model.clock import Now
from roah_rsbb.model.messages import LinkSample, RobotReport
from roah_rsbb.model.reason import say
from roah_rsbb.protocol import RobotState, wire_ns
from roah_rsbb.wording import times

# A robot sends every second. After this long without a message, something is wrong.
SILENT_S = 3.0
# After this long without any message, beacon or old message, the robot has disappeared. A lost datagram, or a new
# connection to the network, takes less time.
GONE_S = 10.0
# A forward step of the robot's clock shows as a sudden rise of the skew. Nothing else increases the skew.
JUMP_S = 0.1
# After only one sample, a late message looks like a slow clock that then jumps. This many samples are required.
SURE_SAMPLES = 3
# A warning about a single event is shown for this long.
REMEMBER_S = 30.0
# For this long after the robot's last message, another host with its team's password does not replace it.
HERE_S = 2.5
# In a silence, this many messages that are not newer than the last one are not merely delayed.
OLD_REPORTED = 3
# The warning about an unreadable datagram is shown for this long, or until a readable datagram arrives.
BAD_S = 10.0

NO_ANSWER = say("Robot has not answered on the private channel yet")
SILENT = say("No message from the robot for {time} s")
OLD_ONLY = say("No message from the robot for {time} s but old ones: its clock was set back or stopped, or "
               "somebody sends recordings. Set its clock right, and it is heard again")
BEACONS_ONLY = say("No message from the robot for {time} s, but its beacons arrive: its program was restarted, or a "
                   "firewall blocks the private channel. Check whether it moves")
GONE = say("The robot has disappeared: no message for {time} s, and no beacon from its address. It may still be "
           "moving, and STOP may not reach it: check it")
INVALID = say("Robot's times are INVALID: clock skew {skew}, must be below {limit} s: synchronise the robot's clock")
RIVAL = say("Messages for this run also come from {host}. They are ignored: the robot is at {address}. Give the other "
            "robot another robot_name, or switch it off")
MOVED = say("Robot's address changed from {before} to {host}")
SET_BACK = say("Robot's clock was set back")
SET_BACK_BY = say("Robot's clock was set back by {time} s")
JUMPED = say("Robot's clock jumped forward by {time} s")
NOT_STOPPED = say("Robot has not stopped yet: it reports {state}")


class Silent(enum.Enum):
    """What is known of a robot that has been silent for too long."""

    NO_ANSWER = enum.auto()  # it was never heard on its private channel
    NO_MESSAGE = enum.auto()
    OLD_ONLY = enum.auto()  # its messages are not newer than the last one
    BEACONS_ONLY = enum.auto()  # it sends beacons, as robots do that are not in a run
    GONE = enum.auto()  # nothing at all was received from it for `GONE_S`


class TakenReport(NamedTuple):
    """The result of taking a message."""

    fresh: bool
    new_host: bool
    state_changed: bool
    notices: Tuple[str, ...]


STALE = TakenReport(False, False, False, ())
FRESH = TakenReport(True, False, False, ())


@dataclass
class LinkState:
    """The robot's last message and its sender."""

    host: Optional[str] = None
    last: Optional[RobotReport] = None
    last_heard: Optional[Now] = None
    timeline: TimelineState = field(default_factory=TimelineState)
    skew: Optional[SkewSample] = None  # robot's clock minus box's; None: not known
    told_invalid: bool = False

    def clock(self, now: Now) -> Optional[float]:
        """Return what the robot's clock shows by its last message (s); None: it sent none."""
        if self.last is None or self.last_heard is None:
            return None
        return wire_ns(self.last.time) / 1e9 + now.mono - self.last_heard.mono


class RobotLink:
    """One robot's messages on its private channel."""

    def __init__(
        self, allowed_skew: float, now: Now, state: Optional[LinkState] = None,
        last_beacon: Optional[Callable[[], Optional[float]]] = None, past: Optional[RobotPast] = None,
    ) -> None:
        """The channel is opened `now`. `allowed_skew` is in seconds. After a restart, the silence counts from `now`,
        because the box did not listen before. `last_beacon` returns when a beacon of the robot arrived last, in
        monotonic seconds; None: nothing is known of its beacons. `past`: of the robot; None: none."""
        self.state = state or LinkState()
        self._allowed_skew = allowed_skew
        self._timeline = Timeline(self.state.timeline)
        self.past = past or RobotPast(allowed_skew)
        self._skew = SkewEstimate(self.state.skew)
        self._listens_since = now.mono
        self._last_beacon = last_beacon
        self._old = 0  # messages since the last fresh one that were not newer than it
        self._old_mono = float("-inf")  # when the last of them arrived
        self._looks = 0  # at this silence; see `deadline`
        self._looked_mono = float("-inf")  # when the last of them was
        self._reported: Optional[Silent] = None  # at the last of them
        self._step: Optional[str] = None
        self._step_mono = 0.0
        self._rival: Optional[str] = None
        self._rival_mono = 0.0
        self._moved: Optional[str] = None
        self._moved_mono = 0.0
        self._bad: Optional[str] = None
        self._bad_mono = 0.0
        self.record = LinkRecorder(now)

    @property
    def host(self) -> Optional[str]:
        """The robot's address; None: not known yet."""
        return self.state.host

    @property
    def last(self) -> Optional[RobotReport]:
        """The robot's last message; None: no message yet."""
        return self.state.last

    @property
    def last_heard(self) -> Optional[Now]:
        """When the last message arrived; None: no message yet."""
        return self.state.last_heard

    @property
    def skew(self) -> Optional[float]:
        """The robot's clock minus the box's, in seconds; None: not known."""
        skew = self.state.skew
        return None if skew is None else skew.seconds

    @property
    def times_valid(self) -> bool:
        """Whether the robot's times are meaningful: only within the allowed skew (docs/protocol.md, "Timing")."""
        return within(self.skew, self._allowed_skew)

    @property
    def calm_skews(self) -> Tuple[float, float]:
        """Between these (s), the skew of the next message has no notice: neither the robot's clock nor the box's jumps,
        and the robot's times stay valid, because the estimate is the greatest of the latest skews."""
        last, heard = self.state.last, self.state.last_heard
        if last is None or heard is None or not self.times_valid:
            return 0.0, 0.0
        latest = wire_ns(last.time) / 1e9 - heard.utc  # not more than the estimate
        return -self._allowed_skew, min(latest + JUMP_S, self._allowed_skew)

    @property
    def robot_state(self) -> Optional[RobotState]:
        """The state that the robot reported last; None: no report yet."""
        return None if self.last is None else self.last.state

    @property
    def messages_saved(self) -> int:
        """The number of saved messages of offline data that the robot reports."""
        return 0 if self.last is None else self.last.messages_saved

    def hear(self, now: Now, host: str, report: RobotReport) -> TakenReport:
        """Judge a message from `host`, and keep it if it is fresh."""
        state = self.state
        before, new_host = state.last, host != state.host
        if new_host and self._is_elsewhere(now):
            return STALE._replace(notices=self._note_rival(now, host))
        time_ns = wire_ns(report.time)
        if time_ns != state.timeline.newest and not self.past.is_new(now.utc, time_ns):
            verdict = Freshness.STALE
        else:  # a clock that was set back is believed only where the robot is known to be
            verdict = self._timeline.judge(now.mono, time_ns, can_begin=state.host in (None, host))
        if verdict is Freshness.DUPLICATE or verdict is Freshness.STALE:
            self._old += 1
            self._old_mono = now.mono
            self.record.old(duplicate=verdict is Freshness.DUPLICATE)
            return STALE
        self.past.take(now.utc, time_ns)
        notices = self._note_clock(now, verdict, report, time_ns)
        if new_host and state.host is not None:
            notices.extend(self._note_host(now, state.host, host))
            self._rival = None  # it names the address where the robot was
        state.host, state.last, state.last_heard = host, report, now
        self._old = 0
        if now.mono + SILENT_S > self._looked_mono:  # a box that reads late has reported the silence after older ones
            self._looks, self._reported = 0, None
        self._bad = None
        state_changed = before is None or report.state != before.state
        if not (new_host or state_changed or notices):
            return FRESH
        return TakenReport(True, new_host, state_changed, tuple(notices))

    def hear_copy(self, now: Now, host: str, count: int = 1) -> Tuple[str, ...]:
        """Handle copies of messages that arrived before, the last from `host`. Return notices.

        Networks duplicate datagrams. A copy from another host is a recording, even while the robot is silent.
        """
        self._old += count
        self._old_mono = now.mono
        self.record.old(duplicate=True, count=count)
        return () if self.host in (None, host) else self._note_rival(now, host)

    def on_bad_datagram(self, now: Now, text: str) -> None:
        """Note an unreadable datagram. `text` says from whom it came, and the likely cause."""
        self._bad, self._bad_mono = text, now.mono

    def restart_skew(self) -> None:
        """Drop all skew samples, because the box's clock was set."""
        self._skew.restart()
        self.state.skew = None
        self.record.clock_set()

    def sample(self, now: Now, unreadable: int) -> LinkSample:
        """The link record since the last sample. `unreadable`: all unreadable datagrams of this channel so far."""
        return self.record.sample(now, self.skew, self.host, unreadable)

    def show_heard(self, heard: Optional[Now], skew: Optional[float]) -> None:
        """Set when the robot was heard last, and the skew of its clock (s), for a replay."""
        if heard is not None:
            self.state.last_heard, self._listens_since = heard, heard.mono
            self.state.skew = None if skew is None else SkewSample(heard.mono, skew)

    def tick(self, now: Now) -> List[str]:
        """Return the notices that are due by now."""
        notices: List[str] = []
        due = self.deadline()
        while due is not None and now.mono >= due:
            silence = self.silence(now)
            assert silence is not None, "its deadline is over"
            if self._looks == 0 or (silence in (Silent.BEACONS_ONLY, Silent.GONE) and silence is not self._reported):
                notices.append(self._silence_text(now, silence))
            self._reported = silence
            self._looks += 1
            self._looked_mono = now.mono
            due = self.deadline()
        return notices

    def deadline(self) -> Optional[float]:
        """Monotonic time (s) at which `tick` may have a notice unless a message comes first; None: all were given.

        A silence is looked at three times: when it begins to matter, after `GONE_S`, and when the robot is gone. What
        the log says must not depend on when else the box looks.
        """
        if self._looks == 0:
            return self._silent_from()
        if self.last_heard is None or self._last_beacon is None or self._reported is Silent.GONE:
            return None
        return self._heard_mono() + GONE_S if self._looks == 1 else self._gone_from()

    def is_silent(self, now: Now) -> bool:
        """Whether the robot has been silent for too long."""
        return now.mono >= self._silent_from()

    def silence(self, now: Now) -> Optional[Silent]:
        """Return what is known of a robot that has been silent for too long; None: it has not."""
        if not self.is_silent(now):
            return None
        if self.last_heard is None:
            return Silent.OLD_ONLY if self._old >= OLD_REPORTED else Silent.NO_ANSWER
        if self._last_beacon is not None:
            beacon = self._last_beacon()
            if beacon is not None and beacon > self.last_heard.mono and now.mono - beacon <= SILENT_S:
                return Silent.BEACONS_ONLY
            if now.mono >= self._gone_from():
                return Silent.GONE
        return Silent.OLD_ONLY if self._old >= OLD_REPORTED else Silent.NO_MESSAGE

    def warnings(self, now: Now) -> List[str]:
        """Return the referee's current warnings about the robot and its link."""
        found: List[str] = []
        silence = self.silence(now)
        if silence is not None:
            found.append(self._silence_text(now, silence))
        if self._bad is not None and now.mono - self._bad_mono <= BAD_S:
            found.append(self._bad)
        if self.last is not None and not self.times_valid and self.skew is not None:
            found.append(INVALID(skew=times.skew(self.skew), limit=f"{self._allowed_skew:.3f}"))
        if self._step is not None and now.mono - self._step_mono <= REMEMBER_S:
            found.append(self._step)
        if self._moved is not None and now.mono - self._moved_mono <= REMEMBER_S:
            found.append(self._moved)
        if self._rival is not None and now.mono - self._rival_mono <= REMEMBER_S:
            found.append(self._rival)
        return found

    def not_ready(self, now: Now) -> List[str]:
        """Return every reason why the robot cannot be started now; empty: it can."""
        if self.last is None:
            reasons: List[str] = [NO_ANSWER]
            return reasons + [w for w in self.warnings(now) if w not in reasons]
        reasons = self.warnings(now)[:1] if self.is_silent(now) else []
        reasons += skew_off(THE_ROBOT, self.skew, self._allowed_skew)
        if self.robot_state is not RobotState.STOP:
            reasons.append(NOT_STOPPED(state=self.last.state.name))
        return reasons

    def _heard_mono(self) -> float:
        """Return the monotonic time (s) from which the silence counts."""
        return self._listens_since if self.last_heard is None else max(self.last_heard.mono, self._listens_since)

    def _silent_from(self) -> float:
        return self._heard_mono() + SILENT_S

    def _gone_from(self) -> float:
        beacon = None if self._last_beacon is None else self._last_beacon()
        signs = [self._heard_mono(), self._old_mono]
        return max(signs if beacon is None else [*signs, beacon]) + GONE_S

    def _silence_text(self, now: Now, silence: Silent) -> str:
        if silence is Silent.NO_ANSWER:
            return NO_ANSWER
        since = self._listens_since if self.last_heard is None else self.last_heard.mono
        time = times.in_sentence(now.mono - since)
        text = {Silent.OLD_ONLY: OLD_ONLY, Silent.BEACONS_ONLY: BEACONS_ONLY, Silent.GONE: GONE}.get(silence, SILENT)
        return text(time=time)

    def _is_elsewhere(self, now: Now) -> bool:
        """Whether a message from another host than the robot's comes while the robot is still heard."""
        return self.last_heard is not None and now.mono - self.last_heard.mono < HERE_S

    def _note_rival(self, now: Now, host: str) -> Tuple[str, ...]:
        """Report another robot of the team, or a recording, that uses this channel, at most once per interval."""
        if self._rival is not None and now.mono - self._rival_mono <= REMEMBER_S:
            return ()
        self._rival_mono = now.mono
        self._rival = RIVAL(host=host, address=self.host)
        return (self._rival,)

    def _note_host(self, now: Now, before: str, host: str) -> List[str]:
        """Report a changed address, at most once per interval: two robots of one name change it with every message."""
        is_new = self._moved is None or now.mono - self._moved_mono > REMEMBER_S
        self._moved = MOVED(before=before, host=host)
        if not is_new:
            return []
        self._moved_mono = now.mono
        return [self._moved]

    def _note_clock(self, now: Now, verdict: Freshness, report: RobotReport, time_ns: int) -> List[str]:
        """Take the skew sample, and update the link record. Return what to report of the robot's clock."""
        sample = time_ns / 1e9 - now.utc
        before = self.skew
        step: Optional[str] = None
        if verdict is Freshness.CLOCK_SET_BACK:
            step = SET_BACK if before is None else SET_BACK_BY(time=f"{before - sample:.3f}")
        elif before is not None and self._skew.count >= SURE_SAMPLES and sample - before > JUMP_S:
            step = JUMPED(time=f"{sample - before:.3f}")
        if step is not None:
            self._step, self._step_mono = step, now.mono
            self._skew.restart()
        skew = self._skew.sample(now.mono, sample)
        self.state.skew = SkewSample(now.mono, skew)
        self.record.heard(now, report, time_ns, late_s=skew - sample, clock_set=step is not None)
        found = [] if step is None else [step]
        return found if within(skew, self._allowed_skew) != self.state.told_invalid else found + self._note_validity()

    def _note_validity(self) -> List[str]:
        """Report that the robot's times have become valid, or invalid."""
        self.state.told_invalid = not self.times_valid
        if self.state.told_invalid:
            return [f"Robot's times are invalid from here on: clock skew {times.skew(self.skew or 0.0)}"]
        return [f"Robot's times are valid again: clock skew {times.skew(self.skew or 0.0)}"]
