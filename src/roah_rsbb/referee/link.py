"""The terminal referee's connection to the core: receives what the core publishes, and sends commands.

rospy waits forever for a master, a service or a core that does not answer. Here, every call that may wait runs in its
own thread with a time limit, and the error names what does not answer, with the remedy.
"""

import queue
import threading
import time
from typing import Any, Callable, List, Optional

import rosgraph
import rospy

from roah_rsbb.core.referee import Refused
from roah_rsbb.msg import CoreDetails, CoreToGui, Results, RunSheet, Schedule, ScheduleEvent, Score
from roah_rsbb.referee.changes import SILENT_S
from roah_rsbb.referee.exits import NoCore
from roah_rsbb.referee.sheets import RunLine, run_of
from roah_rsbb.referee.state import BoxSnapshot, SheetItem, box_of
from roah_rsbb.ros import connections, refusals
from roah_rsbb.ros.feed import Feed
from roah_rsbb.srv import (
    ChooseEvent,
    GetClock,
    GetRunSheet,
    LeaveRun,
    ManualOperationAnswer,
    ScoreMark,
    ScoreWithdraw,
    SignOff,
    StopReason,
    StopRun,
    Zone,
    ZoneScore,
    ZoneUInt8,
)

GUI_TOPIC, DETAILS_TOPIC, RESULTS_TOPIC = "/core/to_gui", "/core/details", "/core/results"
SCHEDULE_TOPIC = "/core/schedule"

# Interval of polling for messages. The core publishes every 100 ms.
POLL_S = 0.02


# Time limits: for the master, for the core's first messages, for a service, for closing.
MASTER_S, CORE_S, ANSWER_S, CLOSE_S = 2.0, 2.0, 6.0, 1.5
# A missing master is tried again after this time.
AGAIN_S = 0.2
# An older first message may be the latched one of a core that hangs: wait for a second one.
FRESH_S = 1.0
# Subscribe again to a silent core at this interval. After a restart of the master, nothing else finds the core.
RENEW_S = 5.0
# The core publishes details at least every second. After this long without newer ones, something is wrong.
DETAILS_S = 10.0

NO_DETAILS = f"the core publishes {GUI_TOPIC}, but {DETAILS_TOPIC} does not arrive: check the network"
START = "start the box with 'roslaunch roah_rsbb roah_rsbb.launch'"


class Link:
    """One connection. Use it from the main thread. Call `open` first and `close` at the end."""

    def __init__(self) -> None:
        self._feed: Optional[Feed] = None
        self._gui: Optional[CoreToGui] = None
        self._details: Optional[CoreDetails] = None
        self._heard = self._renewed = time.monotonic()
        self._count = 0  # CoreToGui messages so far
        self.box: Optional[BoxSnapshot] = None

    def open(self, wait_s: float = 0.0) -> BoxSnapshot:
        """Connect; raises `NoCore` in 2 to 3 s, or after `wait_s` if master and core may still be starting."""
        deadline = self.now() + wait_s
        while True:
            problem = _master_problem() or _core_problem()
            if not problem:
                break
            if self.now() + AGAIN_S > deadline:
                raise NoCore(problem)
            time.sleep(AGAIN_S)  # there is no event for the start of a master
        deadline = max(deadline, self.now() + CORE_S)
        try:
            _limited(MASTER_S, _init_node)
        except _Late:
            raise NoCore(f"the ROS master at {_master_uri()} no longer answers") from None
        self._feed = Feed({GUI_TOPIC: CoreToGui, DETAILS_TOPIC: CoreDetails})
        self._feed.start()
        while not self._is_current():
            left = deadline - self.now()
            if left <= 0:
                raise NoCore(self._why_silent())
            self.next(left)
        assert self.box is not None, "it is current"
        return self.box

    def close(self) -> None:
        """Leave the ROS network. Does not wait for a master that does not answer."""
        if self._feed is None:
            return
        # This hook runs last: everything is unregistered then, and only threads remain.
        unregistered = threading.Event()
        rospy.core.add_shutdown_hook(lambda _reason: unregistered.set())
        threading.Thread(target=rospy.signal_shutdown, args=["the referee leaves"], daemon=True).start()
        unregistered.wait(CLOSE_S)

    # -- listening ----------------------------------------------------------------------------------

    @staticmethod
    def now() -> float:
        """Monotonic seconds."""
        return time.monotonic()

    @property
    def silence_s(self) -> float:
        """Seconds since the core's last message."""
        return self.now() - self._heard

    def next(self, limit_s: float) -> Optional[BoxSnapshot]:
        """Return the next snapshot; None if nothing came for `limit_s`."""
        deadline = self.now() + limit_s
        while True:
            if self._take():
                return self.box
            left = deadline - self.now()
            if left <= 0:
                return None
            time.sleep(min(POLL_S, left))

    def settle(self) -> BoxSnapshot:
        """A snapshot that shows the effect of every command so far; raises `NoCore` if none comes.

        Both topics of the snapshot must have been published after the last command. A message that was published
        before may arrive later than the command's answer, so the core's clock decides, not the order of arrival.
        """
        clock = self._call("/core/clock", GetClock).clock
        deadline = self.now() + DETAILS_S
        while self._gui.clock <= clock or self._details.clock <= clock:
            if self.next(min(SILENT_S, max(0.0, deadline - self.now()))) is None:
                raise NoCore(NO_DETAILS if self.silence_s < SILENT_S else self._why_silent())
        assert self.box is not None, "both topics were heard"
        return self.box

    def _take(self) -> bool:
        """Take new messages. Returns whether they gave a new snapshot."""
        now = self.now()
        gui, details = self._feed.take(GUI_TOPIC), self._feed.take(DETAILS_TOPIC)
        # The same clock again is the latched message, which a core that may hang sends to each new subscription.
        is_news = gui is not None and (self._gui is None or gui.message.clock != self._gui.clock)
        if is_news:
            self._gui, self._heard, self._count = gui.message, gui.mono, self._count + 1
        elif self.silence_s > RENEW_S and now - self._renewed > RENEW_S:
            self._renewed = now
            self._feed.renew()
        if details is not None:
            self._details = details.message
        if self._gui is None or self._details is None or not (is_news or details):
            return False
        if self._gui.clock < self._details.clock:
            return False  # the other topic's message of the same moment has not arrived yet
        box = box_of(self._gui, self._details)
        self.box = box or self.box
        return box is not None

    def _is_current(self) -> bool:
        if self.box is None:
            return False
        return self._count > 1 or abs(time.time() - self.box.clock_utc_s) < FRESH_S

    def _why_silent(self) -> str:
        problem = _core_problem()
        if problem:
            return problem
        if self._gui is not None and self._details is None:
            return NO_DETAILS
        return ("the core is known to the ROS master, but silent: it hangs or has died (restart it), or its "
                "computer cannot be reached by its name (set ROS_IP on both computers)")

    # -- commands -----------------------------------------------------------------------------------

    def command(self, command: str, zone: str) -> None:
        """Give a command to a zone; raises `Refused` with the core's reasons, or `NoCore`."""
        self._call(f"/core/{command}", Zone, zone)

    def stop_run(self, zone: str, identity: str) -> None:
        """Stop the run of that identity; raises as `command` does."""
        self._call("/core/stop_run", StopRun, zone, identity)

    def leave_run(self, zone: str, identity: str) -> None:
        """Disconnect the run of that identity, unless it is running; raises as `command` does."""
        self._call("/core/leave_run", LeaveRun, zone, identity)

    def set_score(self, zone: str, group: str, item: str, value: int) -> None:
        """Set a scoring item; raises as `command` does."""
        self._call("/core/set_score", ZoneScore, zone, Score(group, item, value))

    def mark(
        self, zone: str, identity: str, item: SheetItem, value: int, not_attempted: bool, note: str, referee: str
    ) -> None:
        """Set an item with a note, in the run of that identity; empty: the connected one. Raises as `command` does."""
        self._call(
            "/core/score", ScoreMark, zone, identity, item.group, item.item, value, not_attempted, note, referee
        )

    def withdraw(self, zone: str, identity: str, entry: int, note: str, referee: str) -> None:
        """Withdraw an entry of the score sheet; see `mark`."""
        self._call("/core/score/withdraw", ScoreWithdraw, zone, identity, entry, note, referee)

    def give_reason(self, zone: str, identity: str, end: int, reason: str, referee: str) -> None:
        """Record why the run was stopped; `end` counts from 1, 0: the last one. See `mark`."""
        self._call("/core/stop_reason", StopReason, zone, identity, end, reason, referee)

    def sign_off(self, zone: str, identity: str, referee: str) -> None:
        """Sign a score sheet off; see `mark`."""
        self._call("/core/sign_off", SignOff, zone, identity, referee)

    def run_sheet(self, zone: str, identity: str) -> RunSheet:
        """Return a run's score sheet; see `mark`."""
        return self._call("/core/run_sheet", GetRunSheet, zone, identity).sheet

    def runs(self) -> List[RunLine]:
        """Return all runs that the core knows; raises `NoCore`."""
        return [run_of(summary) for summary in self._latched(RESULTS_TOPIC, Results).runs]

    def schedule(self) -> Schedule:
        """Return the schedule; raises `NoCore`."""
        return self._latched(SCHEDULE_TOPIC, Schedule)

    def choose_event(self, event: ScheduleEvent, unsigned: bool) -> None:
        """Make an event the current one of its zone; raises as `command` does."""
        self._call("/core/choose_event", ChooseEvent, event.zone, event.code, event.team, event.round, event.run,
                   event.schedule, unsigned)

    def _latched(self, topic: str, kind: type) -> Any:
        try:
            return rospy.wait_for_message(topic, kind, CORE_S)
        except rospy.ROSException as error:
            raise NoCore(f"{topic} was not heard ({error}): {self._why_silent()}") from None

    def complete_operation(self, zone: str, operation: int, answer: str) -> None:
        """Complete the manual operation of this number; 0: the current one. Raises as `command` does."""
        self._call("/core/manual_operation_answer", ManualOperationAnswer, zone, operation, answer)

    def press_switch(self, zone: str, switch: int) -> None:
        """HOMF: a switch changed; raises as `command` does."""
        self._call("/core/omf_switches/button", ZoneUInt8, zone, switch)

    def set_damaged(self, zone: str, damaged: int) -> None:
        """HOMF: set the number of damaged switches; raises as `command` does."""
        self._call("/core/omf_switches/damaged", ZoneUInt8, zone, damaged)

    def confirm_switches(self, zone: str) -> None:
        """HOMF: confirm what was entered; raises as `command` does."""
        self._call("/core/omf_switches/complete", Zone, zone)

    def _call(self, name: str, kind: type, *request: object) -> Any:
        try:
            return _limited(ANSWER_S, lambda: rospy.ServiceProxy(name, kind)(*request))
        except _Late:
            raise NoCore(f"{name} did not answer within {ANSWER_S:.0f} s: the core hangs, restart it") from None
        except rospy.ServiceException as error:
            if refusals.was_answered(str(error)):
                raise Refused(refusals.reasons(str(error))) from None
            raise NoCore(f"{name} could not be called ({error}): {self._why_silent()}") from None
        except (rospy.ROSException, OSError) as error:
            raise NoCore(f"{name} could not be called ({error}): {self._why_silent()}") from None


# -- limits ---------------------------------------------------------------------------------------


class _Late(Exception):
    """A job took too long."""


def _limited(limit_s: float, job: Callable[[], Any]) -> Any:
    """Return or raise what `job` does, or raise `_Late` after `limit_s`. A late job continues in its thread."""
    done: queue.Queue = queue.Queue()

    def work() -> None:
        try:
            done.put((job(), None))
        except Exception as error:
            done.put((None, error))

    threading.Thread(target=work, daemon=True).start()
    try:
        result, error = done.get(timeout=limit_s)
    except queue.Empty:
        raise _Late from None
    if error is not None:
        raise error
    return result


def _master_uri() -> str:
    return rosgraph.rosenv.get_master_uri() or "(ROS_MASTER_URI is not set)"


def _master_problem() -> str:
    """Return why the ROS master cannot be used; empty: it can."""
    try:
        _limited(MASTER_S, rosgraph.Master("/referee").getPid)
    except _Late:
        why = "does not answer"
    except Exception as error:  # a wrong URI raises in many ways
        why = f"cannot be reached ({error})"
    else:
        return ""
    return f"ROS master at {_master_uri()} {why}: {START}, or set ROS_MASTER_URI to the box's computer"


def _core_problem() -> str:
    """Return why there is no core; empty: the master knows one."""
    uri = _master_uri()
    try:
        publishers = dict(_limited(MASTER_S, rosgraph.Master("/referee").getSystemState)[0])
    except Exception:  # any error means that the master cannot say more
        return f"the ROS master at {uri} no longer answers: {START}"
    return "" if GUI_TOPIC in publishers else f"no core at the ROS master {uri}: {START}"


def _init_node() -> None:
    """Start without signal handlers (Ctrl-C stops a run first), /rosout and simulated time."""
    connections.init_node("referee", anonymous=True, disable_rosout=True, disable_rostime=True, disable_signals=True)
