"""The messages for the referees' panels: /core/to_gui ten times a second, /core/details when something changed.

Most of a zone's content stays the same for many ticks, so it is cached until it changes.
"""

from typing import Dict, List, Mapping, NamedTuple, Optional, Tuple

from roah_rsbb.core.box import Box
from roah_rsbb.core.clock import Now
from roah_rsbb.core.commands import OWN_COMMANDS
from roah_rsbb.core.views import views
from roah_rsbb.msg import CoreDetails, CoreToGui, RobotInfo, RunClock, RunClocks, ZoneDetails, ZoneState
from roah_rsbb.nodes.core.score_convert import group_message, has_old_form, points_message, score_message, sheet_items
from roah_rsbb.nodes.core.serialised import SerialisedToGui, SerialisedZone
from roah_rsbb.ros.times import ros_duration, ros_limit, ros_time, ros_wire_time


class _Zone(NamedTuple):
    """The cached messages of a zone."""

    shown: Tuple[views.ZoneView, str]  # view without time, and path of the run's log
    state: SerialisedZone
    details: ZoneDetails
    robot: Optional[views.RobotInRunView]


class PanelMessages:
    """Makes the messages of one box."""

    # Clock skew and time of the latest message always change. Alone, they are only published after this many ticks.
    DETAILS_EVERY = 10

    def __init__(self, box: Box, box_uuid: str, addr: str) -> None:
        """`addr`: the broadcast address in use."""
        self._box = box
        self._box_uuid = box_uuid
        self._addr = addr
        self._robots: Dict[views.RobotView, RobotInfo] = {}
        self._zones: Dict[str, _Zone] = {}
        self._warnings: List[str] = []
        self._details_due_in = 0  # ticks
        self._views: List[views.ZoneView] = []  # of this tick
        self._timeless: Tuple[object, ...] = ()  # the published clocks
        self._clocks_due_in = 0  # ticks

    def to_gui(self, now: Now, log_files: Mapping[int, str]) -> CoreToGui:
        """The message of this tick. `log_files`: path of each run's log by its port."""
        box = self._box
        tablet = box.tablet.state
        self._views = views.zones(box, now)
        return SerialisedToGui(
            [self._zone(view, log_files) for view in self._views],
            clock=ros_time(now.utc),
            status=views.box_status(box, now),
            addr=self._addr,
            port=str(box.settings.rsbb_port),
            active_robots=self._robot_infos(now),
            tablet_last_beacon=ros_time(0.0 if box.tablet.heard is None else box.tablet.heard.utc),
            tablet_display_map=tablet.display_map,
            tablet_call_time=ros_wire_time(tablet.call_time),
            tablet_position_time=ros_wire_time(tablet.position_time),
            tablet_position_x=tablet.position_x,
            tablet_position_y=tablet.position_y,
        )

    def details(self, now: Now) -> Optional[CoreDetails]:
        """Return what `to_gui`, which was called before, has no field for; None: unchanged since the last message."""
        warnings = self._box.warnings(now)
        if warnings != self._warnings:
            self._warnings, self._details_due_in = warnings, 0
        self._details_due_in -= 1
        if self._details_due_in >= 0:
            return None
        self._details_due_in = self.DETAILS_EVERY - 1
        for zone in self._zones.values():
            if zone.robot is not None:
                _set_times(zone.details, zone.robot)
        return CoreDetails(
            clock=ros_time(now.utc),
            box_uuid=self._box_uuid,
            warnings=warnings,
            zones=[zone.details for zone in self._zones.values()],
        )

    def clocks(self, now: Now) -> Optional[RunClocks]:
        """Return the times of all runs at `now`, for which `to_gui` was called before; None: they are unchanged."""
        timeless = tuple((view.zone, view.identity, view.phase, view.clock.without_time()) for view in self._views)
        self._clocks_due_in -= 1
        if timeless == self._timeless and self._clocks_due_in > 0:
            return None
        self._timeless, self._clocks_due_in = timeless, self.DETAILS_EVERY
        return RunClocks(ros_time(now.utc), self._box_uuid, [_run_clock(view) for view in self._views])

    def _robot_infos(self, now: Now) -> List[RobotInfo]:
        robots = views.robots(self._box, now)
        self._robots = {robot: self._robots.get(robot) or _robot_info(robot) for robot in robots}
        return list(self._robots.values())

    def _zone(self, view: views.ZoneView, log_files: Mapping[int, str]) -> bytes:
        shown = view.without_time(), "" if view.robot is None else log_files.get(view.robot.port, "")
        kept = self._zones.get(view.zone)
        if kept is None or kept.shown != shown:
            kept = _Zone(shown, SerialisedZone(_zone_state(view)), _zone_details(*shown), view.robot)
            self._details_due_in = 0
        self._zones[view.zone] = kept._replace(robot=view.robot)
        return kept.state.with_timer(ros_duration(view.timer))


def _robot_info(view: views.RobotView) -> RobotInfo:
    return RobotInfo(view.team, view.robot, ros_duration(view.skew), ros_time(view.last_heard))


def _run_clock(view: views.ZoneView) -> RunClock:
    clock = view.clock
    return RunClock(
        zone=view.zone,
        identity=view.identity,
        phase=view.phase,
        limit=ros_limit(clock.limit),
        elapsed=ros_duration(clock.elapsed),
        counting=clock.counting,
        paused=clock.paused,
        goal_limit=ros_limit(clock.goal_limit),
        goal=clock.goal,
        goal_elapsed=ros_duration(clock.goal_elapsed),
        goal_counting=clock.goal_counting,
        after_stop=ros_duration(clock.after_stop),
        setup_limit=ros_duration(clock.setup_limit),
        setup_elapsed=ros_duration(clock.setup_elapsed),
        setup_counting=clock.setup_counting,
        phases=clock.phases,
        phase_number=clock.phase_number,
        phase_name=clock.phase_name,
        phase_limit=ros_limit(clock.phase_limit),
        phase_elapsed=ros_duration(clock.phase_elapsed),
    )


def _zone_state(view: views.ZoneView) -> ZoneState:
    event = view.event
    message = ZoneState(
        zone=view.zone,
        name=event.benchmark.name,
        desc=event.benchmark.desc,
        code=event.benchmark.code,
        timeout=ros_limit(view.timeout),
        team=event.team,
        round=event.round,
        run=event.run,
        schedule=ros_time(event.scheduled),
        state=view.state,
        log=view.log,
        online_data=view.online_data,
        scoring=[group_message(group) for group in view.scoring],
    )
    message.connect_enabled = not view.reasons_off("connect")
    message.disconnect_enabled = not view.reasons_off("disconnect")
    message.start_enabled = not view.reasons_off("start")
    message.stop_enabled = not view.reasons_off("stop")
    message.prev_enabled = not view.reasons_off("previous")
    message.next_enabled = not view.reasons_off("next")
    module = view.module
    message.manual_operation = "" if module.operation is None else module.operation.text
    message.omf = module.switches is not None
    if module.switches is not None:
        message.omf_switches = bytes(module.switches.on)
        message.omf_damaged = module.switches.damaged
        message.omf_complete = module.switches_asked
    return message


def _zone_details(view: views.ZoneView, log_file: str) -> ZoneDetails:
    message = ZoneDetails(
        zone=view.zone,
        phase=view.phase,
        connect_off=view.reasons_off("connect"),
        disconnect_off=view.reasons_off("disconnect"),
        start_off=view.reasons_off("start"),
        stop_off=view.reasons_off("stop"),
        prev_off=view.reasons_off("previous"),
        next_off=view.reasons_off("next"),
        **{f"{command}_off": view.reasons_off(command) for command in OWN_COMMANDS},
        pause_allowed=view.event.benchmark.rules.pause,
        by_hand=view.by_hand,
        attempt=view.attempt,
        attempts=view.event.benchmark.rules.attempts,
        robots_to_choose=view.robots_to_choose,
        warnings=view.warnings,
    )
    if not view.identity:
        return message
    message.identity = view.identity
    items = view.sheet.items
    message.not_attempted = [item.not_attempted for item in items if has_old_form(item)]
    message.items = sheet_items(items, None if view.form.is_plain else view.form)
    message.points = points_message(view.sheet.points)
    message.end_reason = view.end_reason
    if view.robot is not None:
        _add_robot(message, view.robot, log_file)
    if view.all_robots is not None:
        _add_all_robots(message, view.all_robots)
    _add_module(message, view.module)
    return message


def _add_robot(message: ZoneDetails, view: views.RobotInRunView, log_file: str) -> None:
    message.robot = view.robot
    message.port = view.port
    message.box_state = view.box_state
    message.robot_state = view.robot_state
    message.messages_saved = view.messages_saved
    message.log_file = log_file


def _set_times(message: ZoneDetails, view: views.RobotInRunView) -> None:
    message.skew_known = view.skew is not None
    message.skew = ros_duration(view.skew or 0.0)
    message.last_message = ros_time(view.last_heard or 0.0)


def _add_all_robots(message: ZoneDetails, view: views.AllRobotsView) -> None:
    count = len(view.robots)
    message.robot = "1 robot" if count == 1 else f"{count} robots"
    message.port = view.first_port
    message.robots_preparing, message.robots_executing, message.robots_stopped = view.counts
    message.robots = view.robots


def _add_module(message: ZoneDetails, module: views.ModuleView) -> None:
    if module.operation is not None:
        message.operation = module.operation.number
        message.operation_choices = list(module.operation.choices)
        message.operation_asks_text = module.operation.asks_text
    message.held = module.held
    message.module_status = module.status
    message.module_scores = [score_message(score) for score in module.scores]
