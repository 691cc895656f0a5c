"""The core's published state as plain values. The terminal referee shows them, and `--json` prints them.

The names of the fields are the names in the JSON output (docs/referee.md) and never change. Times are UTC seconds since
1970, durations are seconds.
"""

import json
from typing import Any, Dict, List, NamedTuple, Optional, Tuple

from roah_rsbb.model import shown
from roah_rsbb.model.actions import ACTIONS, Row
from roah_rsbb.model.fields import Choice, Field, Text, entered
from roah_rsbb.wording import sheets
from roah_rsbb.wording.clock import clock_of, lines

IDLE, CONNECTED, RUNNING, ENDED = "idle", "connected", "running", "ended"  # ZoneDetails.phase
COMPLETED, STOPPED = "completed", "stopped"  # ZoneDetails.end_reason
# They are of no interest in a zone without such a module.
_OF_MODULES = [action.name for action in ACTIONS.values() if action.row is Row.MODULE]


class SheetItem(NamedTuple):
    """A scoring item. Its number counts from 1 through the whole sheet, in the order of the groups."""

    number: int
    group: str
    item: str
    type: str
    value: int  # 0 where it was not attempted
    not_attempted: bool = False  # the robot did not try
    text: str = ""  # of a decimal, a choice or a rating
    points: str = ""  # a decimal number; empty: the item gives none
    choices: Tuple[str, ...] = ()
    judges: Tuple[str, ...] = ()
    ratings: Tuple[str, ...] = ()  # by each judge; an empty text: none yet


class ManualOperation(NamedTuple):
    """A manual operation that a benchmarking module requests."""

    number: int  # in the attempt; an operation with the same text as the one before has another number
    text: str
    choices: Tuple[str, ...] = ()  # of its first choice, the usual one first
    asks_text: bool = False  # it has a text
    fields: Tuple[Field, ...] = ()  # of its form


class SwitchesSnapshot(NamedTuple):
    """HOMF: what the referee entered."""

    on: Tuple[int, ...]  # numbers of the switches that are on
    damaged: int
    to_confirm: bool  # the robot has finished


class ModuleScoreLine(NamedTuple):
    """A line of a benchmarking module's score."""

    group: str  # such as "waypoint 2"; empty: of the whole run
    name: str
    value: Any  # a number, a bool, a text, or None if not known yet
    unit: str
    desc: str


class AllRobotsSnapshot(NamedTuple):
    """HSUF: how many robots prepare, execute and have stopped, and what each robot does."""

    preparing: int
    executing: int
    stopped: int
    robots: Tuple[str, ...]  # "<robot> of team <team>: <what it is doing>"


class EventSnapshot(NamedTuple):
    """An event of the schedule."""

    code: str
    name: str
    desc: str
    team: str
    round: int
    run: int
    scheduled_utc_s: float
    timeout_s: float


class RunTimes(NamedTuple):
    """The times of a run, or the limits of the next one. They do not count pauses."""

    text: Tuple[str, ...]  # each time with its label, as the panels show them
    pause: str  # that the run is paused, and why; empty: it is not
    limit_s: float  # 0: no limit
    elapsed_s: float  # after the end: the final time of the run
    counting: bool
    goal: int  # number of the current goal; 0: there is none with a timeout
    goal_limit_s: float
    goal_elapsed_s: float
    goal_counting: bool
    after_stop_s: float  # after the end: time left
    setup_limit_s: float = 0.0  # 0: the rules have no setup time
    setup_elapsed_s: float = 0.0
    setup_counting: bool = False
    phase: int = 0  # number of the current phase of a task; 0: none
    phase_name: str = ""
    phase_limit_s: float = 0.0  # 0: no limit
    phase_elapsed_s: float = 0.0


class ZoneSnapshot(NamedTuple):
    """A zone, its event and its run. Unknown values are None or empty."""

    zone: str
    event: EventSnapshot
    phase: str
    identity: str  # of the run; empty: there is none
    end_reason: str
    timer_s: float
    state: Tuple[str, ...]
    robot: str
    port: int
    box_state: str
    robot_state: str
    skew_s: Optional[float]
    last_message_utc_s: Optional[float]
    messages_saved: int
    manual_operation: str
    warnings: Tuple[str, ...]
    off: Dict[str, List[str]]
    score: Tuple[SheetItem, ...]
    log_file: str
    log: str
    online_data: str
    operation: Optional[ManualOperation] = None
    switches: Optional[SwitchesSnapshot] = None
    held: bool = False
    module_status: str = ""
    module_score: Tuple[ModuleScoreLine, ...] = ()
    points: str = ""  # of the score sheet, such as "85 points: Achievements 100 · Penalties -15"; empty: it gives none
    all_robots: Optional[AllRobotsSnapshot] = None
    times: Optional[RunTimes] = None
    by_hand: bool = False  # the run has no robot
    attempt: int = 0  # number of this or the next run of the event; 0: the rules do not count attempts
    attempts: int = 0  # how many the rules allow
    robots_to_choose: Tuple[str, ...] = ()  # the team's robots if there are several
    not_stopped: Tuple[str, ...] = ()  # robots of the run that do not report STOP


class RobotSnapshot(NamedTuple):
    """An active robot."""

    team: str
    robot: str
    skew_s: float
    last_heard_utc_s: float
    age_s: float


class BoxSnapshot(NamedTuple):
    """The whole box at one moment of its clock."""

    clock_utc_s: float
    status: str
    host: str
    port: str
    box_uuid: str
    warnings: Tuple[str, ...]
    robots: Tuple[RobotSnapshot, ...]
    zones: Tuple[ZoneSnapshot, ...]

    def zone(self, name: str) -> Optional[ZoneSnapshot]:
        """Return the zone of that name, or None."""
        return next((zone for zone in self.zones if zone.zone == name), None)


def box_of(gui, details, clocks) -> Optional[BoxSnapshot]:
    """Combine a CoreToGui, a CoreDetails and RunClocks; None: their zones or runs differ."""
    details_of = {zone.zone: zone for zone in details.zones}
    times_of = {zone.zone: zone for zone in clocks.zones}
    if [zone.zone for zone in gui.zones] != list(details_of) or _runs(details_of) != _runs(times_of):
        return None
    passed_s = max(0.0, (gui.clock - clocks.clock).to_sec())
    clock = gui.clock.to_sec()
    robots = [
        RobotSnapshot(r.team, r.robot, r.skew.to_sec(), r.beacon.to_sec(), max(0.0, clock - r.beacon.to_sec()))
        for r in gui.active_robots
    ]
    return BoxSnapshot(
        clock_utc_s=clock,
        status=gui.status,
        host=gui.addr,
        port=gui.port,
        box_uuid=details.box_uuid,
        warnings=tuple(details.warnings),
        robots=tuple(robots),
        zones=tuple(_zone(zone, details_of[zone.zone], _times(times_of[zone.zone], passed_s)) for zone in gui.zones),
    )


def _runs(zones: Dict[str, Any]) -> Dict[str, Tuple[str, str]]:
    return {name: (zone.identity, zone.phase) for name, zone in zones.items()}


def _times(message, passed_s: float) -> RunTimes:
    shown = clock_of(message, passed_s)
    return RunTimes(
        text=tuple(lines(shown._replace(pause=""))),
        pause=shown.pause,
        limit_s=message.limit.to_sec(),
        elapsed_s=message.elapsed.to_sec() + message.counting * passed_s,
        counting=message.counting,
        goal=message.goal,
        goal_limit_s=message.goal_limit.to_sec(),
        goal_elapsed_s=message.goal_elapsed.to_sec() + message.goal_counting * passed_s,
        goal_counting=message.goal_counting,
        after_stop_s=max(0.0, message.after_stop.to_sec() - passed_s) if message.phase == ENDED else 0.0,
        setup_limit_s=message.setup_limit.to_sec(),
        setup_elapsed_s=message.setup_elapsed.to_sec() + message.setup_counting * passed_s,
        setup_counting=message.setup_counting,
        phase=message.phase_number,
        phase_name=message.phase_name,
        phase_limit_s=message.phase_limit.to_sec(),
        phase_elapsed_s=message.phase_elapsed.to_sec() + message.counting * bool(message.phase_number) * passed_s,
    )


def lines_of(text: str) -> List[str]:
    """Return the lines that the core wrote. Only \\n ends a line; a robot's text may contain other line ends."""
    return [line for line in text.split("\n") if line]


def as_json(value: Any) -> Any:
    """Return a value of this module for `json.dumps`. Times and durations are rounded to microseconds."""
    if isinstance(value, Field):
        return value.form()
    if isinstance(value, tuple) and hasattr(value, "_asdict"):
        return {name: as_json(field) for name, field in value._asdict().items()}
    if isinstance(value, (list, tuple)):
        return [as_json(item) for item in value]
    if isinstance(value, dict):
        return {key: as_json(item) for key, item in value.items()}
    return round(value, 6) if isinstance(value, float) else value


def _zone(zone, details, run_times: RunTimes) -> ZoneSnapshot:
    heard = details.last_message.to_sec()
    return ZoneSnapshot(
        zone=zone.zone,
        event=EventSnapshot(
            zone.code, zone.name, zone.desc, zone.team, zone.round, zone.run, zone.schedule.to_sec(),
            zone.timeout.to_sec(),
        ),
        phase=details.phase,
        identity=details.identity,
        end_reason=details.end_reason,
        timer_s=zone.timer.to_sec(),
        state=tuple(lines_of(zone.state)),
        robot=details.robot,
        port=details.port,
        box_state=details.box_state,
        robot_state=details.robot_state,
        skew_s=details.skew.to_sec() if details.skew_known else None,
        last_message_utc_s=heard if heard > 0 else None,
        messages_saved=details.messages_saved,
        manual_operation=zone.manual_operation,
        warnings=tuple(details.warnings),
        off={name: [str(reason) for reason in action.off] for name, action in shown.read(details.actions).items()
             if action.shown or name not in _OF_MODULES},
        score=items_of(details.items),
        points=sheets.points_of(details.points),
        log_file=details.log_file,
        log=zone.log,
        online_data=zone.online_data,
        operation=_operation(details),
        switches=SwitchesSnapshot(tuple(zone.omf_switches), zone.omf_damaged, zone.omf_complete) if zone.omf else None,
        all_robots=_all_robots(details),
        times=run_times,
        by_hand=details.by_hand,
        attempt=details.attempt,
        attempts=details.attempts,
        robots_to_choose=shown.robots_to_choose(details),
        not_stopped=tuple(details.not_stopped),
        held=details.held,
        module_status=details.module_status,
        module_score=tuple(
            ModuleScoreLine(s.group, s.name, _json_value(s.value), s.unit, s.desc) for s in details.module_scores
        ),
    )


def _all_robots(details) -> Optional[AllRobotsSnapshot]:
    if not details.robots:
        return None
    return AllRobotsSnapshot(
        details.robots_preparing, details.robots_executing, details.robots_stopped, tuple(details.robots)
    )


def _operation(details) -> Optional[ManualOperation]:
    action = shown.of(details, "operation")
    if not details.operation or not action.shown:
        return None
    fields = entered(action.fields)
    choices = next((field.choices for field in fields if isinstance(field, Choice)), ())
    return ManualOperation(details.operation, action.text, choices, any(isinstance(f, Text) for f in fields), fields)


def _json_value(text: str) -> Any:
    try:
        return json.loads(text)
    except ValueError:
        return text


def items_of(messages) -> Tuple[SheetItem, ...]:
    """Read ScoreItems."""
    return tuple(
        SheetItem(
            number, item.group, item.desc, sheets.type_word(item.type), item.value, item.not_attempted, item.text,
            item.points, tuple(item.choices), tuple(item.judges), tuple(item.ratings),
        )
        for number, item in enumerate(messages, 1)
    )
