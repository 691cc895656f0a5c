"""A zone as its referee sees it: its event, the run in it, and what can be done now.

While only time passes, nothing in these values changes: what counts says since when, and so does a robot that is
silent. Such moments are on the box's monotonic clock, in seconds.
"""

from typing import Dict, List, NamedTuple, Optional, Tuple

from roah_rsbb.model.actions import ACTIONS, Shown
from roah_rsbb.model.fields import Choice, Field
from roah_rsbb.model.reason import Said
from roah_rsbb.model.records import ScoreValue, SheetPoints

# The phase of a zone without a run. The others are the words of `model.records.Phase`.
IDLE, CONNECTED, RUNNING, ENDED = "idle", "connected", "running", "ended"
# How the texts of a zone mark a line that is a warning.
WARNING = "WARNING: "
# A robot that was heard within this time (s) is not called silent: by the rules it sends once a second.
LATELY_S = 1.5
UNKNOWN = Shown(shown=False)


class Count(NamedTuple):
    """Seconds that are counted."""

    seconds: float = 0.0  # until `since`
    since: Optional[float] = None  # the moment from which they are counted on; None: they are not

    @property
    def counting(self) -> bool:
        """Whether they are counted now."""
        return self.since is not None

    def at(self, mono: float) -> float:
        """Return the seconds at a moment."""
        return self.seconds if self.since is None else self.seconds + max(0.0, mono - self.since)


NOTHING = Count()


class RunClock(NamedTuple):
    """The times of a run, or the limits of the next one, in seconds. They do not include pauses. A limit of 0: none."""

    limit: float = 0.0  # from the start to the timeout
    elapsed: Count = NOTHING  # after the end: the final time of the run
    paused: Said = ""  # why the time of a run in progress does not count; empty: it does
    goal_limit: float = 0.0  # of the present goal, or of each goal to come; 0: the benchmark has no goals
    goal: int = 0  # number of the present goal; 0: none with a timeout
    goal_elapsed: Count = NOTHING
    after_stop_until: Optional[float] = None  # the moment at which the time after the end is over; None: not ended
    setup_limit: float = 0.0  # from *connect* to the start
    setup_elapsed: Count = NOTHING  # also beyond the limit
    phases: int = 0  # how many phases the benchmark has
    phase_number: int = 0  # of the current phase; 0: none
    phase_name: str = ""
    phase_limit: float = 0.0
    phase_elapsed: Count = NOTHING  # also beyond the limit; it counts with the run's clock

    def spent(self, mono: float) -> float:
        """Return the counted seconds of the run at a moment, at most its limit."""
        seconds = self.elapsed.at(mono)
        return min(seconds, self.limit) if self.limit else seconds

    def goal_spent(self, mono: float) -> float:
        """Return the counted seconds of the present goal at a moment, at most its limit."""
        seconds = self.goal_elapsed.at(mono)
        return min(seconds, self.goal_limit) if self.goal_limit else seconds

    def after_stop(self, mono: float) -> float:
        """Return the seconds that are left of the time after the end."""
        return 0.0 if self.after_stop_until is None else max(0.0, self.after_stop_until - mono)

    def timer(self, mono: float) -> float:
        """Return what the original panels count down: seconds left of the setup time, of the goal or of the run, or
        after the end. Without a limit: seconds counted."""
        if self.setup_elapsed.counting:
            return max(0.0, self.setup_limit - self.setup_elapsed.at(mono))
        if self.after_stop_until is not None:
            return self.after_stop(mono)
        left = [limit - spent for limit, spent in (
            (self.limit, self.spent(mono)), (self.goal_limit if self.goal else 0.0, self.goal_spent(mono))) if limit]
        return min(left) if left else self.spent(mono)


class Event(NamedTuple):
    """The event of the schedule at which a zone is."""

    id: str  # by which it is known, whatever else changes
    code: str  # of the benchmark
    name: str
    desc: str
    team: str  # ALL: all robots at once
    round: int
    run: int
    scheduled: float  # UTC seconds


class RobotInRun(NamedTuple):
    """The robot of a run and its private channel."""

    robot: str
    port: int  # UDP
    box_state: str  # sent by the box: STOP, PREPARE, GOAL_TX or WAITING_RESULT
    robot_state: str = ""  # last reported by the robot; empty: not yet
    messages_saved: int = 0
    skew: Optional[float] = None  # seconds, robot's clock minus the box's, in steps; None: not known
    heard: bool = False  # whether a message of it ever came
    silent_since: Optional[float] = None  # the moment of its last message, once that is some time ago; None: it is not


class AllRobots(NamedTuple):
    """What the robots do in a run of all robots."""

    port: int  # UDP, of the first robot
    preparing: int
    executing: int
    stopped: int
    robots: Tuple[Said, ...]  # each robot and what it is doing


class SheetItem(NamedTuple):
    """A scoring item with its value, and what it takes. Numbers in texts are decimal; empty: none."""

    group: str
    desc: str
    type: str  # bool, uint, int, decimal, choice or rating
    value: int = 0  # of a bool, uint or int; of other types the nearest whole number, or the choice's from 1
    not_attempted: bool = False  # the robot did not try; the value is then 0
    corrected: bool = False  # its value has changed since the run ended
    text: str = ""  # of other types: a number, a choice, or the jury's result; empty: none yet
    points: str = ""  # for the value
    each: str = ""  # points for a yes or for each one; those of a choice are in `choice_points`
    min: str = ""  # of the value; empty: that of the type
    max: str = ""
    choices: Tuple[str, ...] = ()
    choice_points: Tuple[str, ...] = ()  # for each choice
    judges: Tuple[str, ...] = ()  # of a rating
    ratings: Tuple[str, ...] = ()  # by each judge; an empty text: none yet
    jury: str = ""  # how ratings become one: mean, median or without extremes
    needs: Tuple[str, ...] = ()  # desc of each item that must be given for this one to count
    unit: str = ""  # of the value, such as %
    late: Tuple[int, ...] = ()  # numbers of its entries that do not count, because they came after the time limit
    void: Said = ""  # why the newest mark of the sheet, which is one of it, does not count; empty: it does
    under: str = ""  # desc of the item that it modifies; empty: none
    percent: str = ""  # what it is worth, of what the items before it left, instead of points
    incident: str = ""  # what the rules call an incident
    after: str = ""  # of an incident: seconds after which another one follows by itself
    until: Tuple[str, ...] = ()  # of an incident: desc of each that ends it
    help: str = ""  # when to mark it, as the rules say
    decided: Tuple[str, ...] = ()  # what the competition decided about it: choice and reading


class Switches(NamedTuple):
    """HOMF: what the referee entered."""

    on: Tuple[int, ...]  # numbers of the switches that changed
    damaged: int
    to_confirm: bool  # the robot has finished


class ZoneSeen(NamedTuple):
    """A zone, its event and the run in it."""

    zone: str  # its name
    event: Event
    phase: str = IDLE
    identity: str = ""  # of the run, unique among all competitions; empty: no run
    end_reason: str = ""  # name of an `EndReason`, in lower case; empty: it has not ended
    state: Tuple[Said, ...] = ()  # what the referee should know, in lines, without warnings
    warnings: Tuple[Said, ...] = ()  # what the referee should check now, the most urgent first
    actions: Dict[str, Shown] = {}  # by the names in `ACTIONS`
    timeout: float = 0.0  # seconds: of a goal or of the run; 0: none
    clock: RunClock = RunClock()
    attempt: int = 0  # number of this or the next run of the event; 0: the rules do not count attempts
    attempts: int = 0  # how many the rules allow
    by_hand: bool = False  # the run has no robot
    robot: Optional[RobotInRun] = None  # of a run of one robot
    all_robots: Optional[AllRobots] = None  # of a run of all robots
    not_stopped: Tuple[str, ...] = ()  # robots of the run that do not report STOP
    items: Tuple[SheetItem, ...] = ()  # of the referee's score sheet
    points: Optional[SheetPoints] = None  # None: the sheet gives none
    operation: int = 0  # number of the manual operation that a benchmarking module asks for; 0: none
    manual_operation: Said = ""  # what it asks for
    switches: Optional[Switches] = None  # None: there are none to enter
    held: bool = False  # the benchmarking module is missing, so the run is paused
    module_status: str = ""  # what the module reports that it is doing
    module_scores: Tuple[ScoreValue, ...] = ()
    log_file: str = ""  # run log that is being written
    log: str = ""  # its last characters
    online_data: str = ""  # the last characters

    def action(self, name: str) -> Shown:
        """Return an action. One that the box does not know is off, without a reason."""
        return self.actions.get(name, UNKNOWN)

    def off(self, name: str) -> Tuple[Said, ...]:
        """Return why the button of an action is off; empty: it is on."""
        return self.action(name).off

    def is_on(self, name: str) -> bool:
        """Whether the button of an action is on."""
        return name in self.actions and not self.actions[name].off

    def fields(self, name: str) -> Tuple[Field, ...]:
        """Return the fields of an action as they are now."""
        found = self.action(name).fields
        return ACTIONS[name].fields if found is None and name in ACTIONS else found or ()

    @property
    def robots_to_choose(self) -> Tuple[str, ...]:
        """The team's robots of which the referee chooses one; empty: there is no choice."""
        return next((field.choices for field in self.fields("connect") if isinstance(field, Choice)), ())

    @property
    def lines(self) -> List[str]:
        """Everything that the referee should know, in lines."""
        return [*self.state, *(f"{WARNING}{text}" for text in self.unsaid)]

    @property
    def unsaid(self) -> List[str]:
        """The warnings that are not among the lines of `state`."""
        return [text for text in self.warnings if text not in self.state]

    @property
    def port(self) -> int:
        """UDP port of the private channel, of the first robot's; 0: there is none."""
        of_run = self.robot or self.all_robots
        return 0 if of_run is None else of_run.port

    @property
    def robot_name(self) -> str:
        """The name of the robot in the run, or how many there are; empty: none."""
        if self.all_robots is not None:
            count = len(self.all_robots.robots)
            return "1 robot" if count == 1 else f"{count} robots"
        return "" if self.robot is None else self.robot.robot
