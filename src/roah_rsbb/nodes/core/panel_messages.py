"""The messages for the referees' panels: /core/to_gui ten times a second, /core/details when something changed.

Most of a zone's content stays the same for many ticks, so it is cached until it changes. Only times are always new.
"""

from typing import Dict, List, Mapping, NamedTuple, Optional, Tuple

from roah_rsbb.core.box import Box
from roah_rsbb.core.robots import RobotId
from roah_rsbb.core.views import views
from roah_rsbb.core.zones import Zone
from roah_rsbb.model import shown
from roah_rsbb.model.actions import ACTIONS
from roah_rsbb.model.clock import Now
from roah_rsbb.model.reason import is_made
from roah_rsbb.msg import CoreDetails, CoreToGui, RobotInfo, RunClock, RunClocks, ZoneDetails, ZoneState
from roah_rsbb.nodes.core.score_convert import group_message, has_old_form, points_message, score_message, sheet_items
from roah_rsbb.nodes.core.serialised import (
    NO_DURATION,
    Serialised,
    SerialisedClocks,
    SerialisedDetails,
    SerialisedToGui,
    bool_bytes,
    duration_bytes,
    time_bytes,
)
from roah_rsbb.ros.times import ros_duration, ros_limit, ros_time, ros_wire_time


class _Zone(NamedTuple):
    """The cached messages of a zone."""

    view: views.ZoneView
    shown: Tuple[views.ZoneView, str]  # view without time, and path of the run's log
    state: Serialised
    details: Serialised
    clock: Serialised


class PanelMessages:
    """Makes the messages of one box."""

    # Clock skew and time of the latest message always change. If nothing else does, they wait for this many ticks.
    DETAILS_EVERY = 10

    def __init__(self, box: Box, box_uuid: str, addr: str) -> None:
        """`addr`: the broadcast address in use."""
        self._box = box
        self._box_uuid = box_uuid
        self._addr = addr
        self._views = views.ZoneViews(box)
        self._robots: Dict[RobotId, Serialised] = {}
        self._zones: Dict[str, _Zone] = {}
        self._warnings: Tuple[List[str], str] = [], ""
        self._details_due_in = self._clocks_due_in = 0  # ticks

    def to_gui(self, now: Now, log_files: Mapping[int, str]) -> CoreToGui:
        """The message of this tick. `log_files`: path of each run's log by its port."""
        box = self._box
        tablet = box.tablet.state
        self._look_at_zones(now, log_files)
        return SerialisedToGui(
            self._robot_infos(now),
            [kept.state.with_values(duration_bytes(views.timer_of(box.zones[name], now)))
             for name, kept in self._zones.items()],
            clock=ros_time(now.utc),
            status=views.box_status(box, now),
            addr=self._addr,
            port=str(box.settings.rsbb_port),
            tablet_last_beacon=ros_time(0.0 if box.tablet.heard is None else box.tablet.heard.utc),
            tablet_display_map=tablet.display_map,
            tablet_call_time=ros_wire_time(tablet.call_time),
            tablet_position_time=ros_wire_time(tablet.position_time),
            tablet_position_x=tablet.position_x,
            tablet_position_y=tablet.position_y,
        )

    def details(self, now: Now) -> Optional[CoreDetails]:
        """Return the message with everything for which `to_gui` has no field; None: unchanged since the last one.

        Call `to_gui` with the same `now` first.
        """
        warnings = self._box.warnings(now)
        status = views.box_status(self._box, now)
        if (warnings, status) != self._warnings:
            self._warnings, self._details_due_in = (warnings, status), 0
        self._details_due_in -= 1
        if self._details_due_in >= 0:
            return None
        self._details_due_in = self.DETAILS_EVERY - 1
        return SerialisedDetails(
            [kept.details.with_values(*_robot_bytes(views.robot_of(self._box.zones[name].run)))
             for name, kept in self._zones.items()],
            clock=ros_time(now.utc),
            box_uuid=self._box_uuid,
            warnings=warnings,
            said=shown.said(filter(is_made, [*warnings, status])),
        )

    def renew(self) -> None:
        """Let the next tick publish details and clocks, also if nothing has changed: somebody waits for newer ones."""
        self._details_due_in = self._clocks_due_in = 0

    def clocks(self, now: Now) -> Optional[RunClocks]:
        """Return the times of all runs; None: only time has passed. Call `to_gui` with the same `now` first."""
        self._clocks_due_in -= 1
        if self._clocks_due_in >= 0:
            return None
        self._clocks_due_in = self.DETAILS_EVERY - 1
        return SerialisedClocks(
            [kept.clock.with_values(*_clock_bytes(self._box.zones[name], now)) for name, kept in self._zones.items()],
            clock=ros_time(now.utc),
            box_uuid=self._box_uuid,
        )

    def _robot_infos(self, now: Now) -> List[bytes]:
        robots = views.robots(self._box, now)
        before, self._robots = self._robots, {}
        for robot in robots:
            name = RobotId(robot.team, robot.robot)
            self._robots[name] = before.get(name) or Serialised(RobotInfo(*name, ros_duration(0.0), ros_time(0.0)),
                                                                "skew", "beacon")
        return [kept.with_values(duration_bytes(robot.skew), time_bytes(robot.last_heard))
                for robot, kept in zip(robots, self._robots.values())]

    def _look_at_zones(self, now: Now, log_files: Mapping[int, str]) -> None:
        """Make the messages of the zones that changed."""
        before, self._zones = self._zones, {}
        for view in self._views.look(now):
            self._zones[view.zone] = self._zone(view, before.get(view.zone), log_files)
        if list(before) != list(self._zones):
            self._details_due_in = self._clocks_due_in = 0

    def _zone(self, view: views.ZoneView, kept: Optional[_Zone], log_files: Mapping[int, str]) -> _Zone:
        log_file = "" if view.robot is None else log_files.get(view.robot.port, "")
        if kept is not None and view is kept.view and log_file == kept.shown[1]:
            return kept
        shown = view.without_time(), log_file
        if kept is not None and kept.shown == shown:
            return kept._replace(view=view)
        self._details_due_in = 0
        clock = kept.clock if kept is not None and _of_clock(kept.shown[0]) == _of_clock(shown[0]) else None
        if clock is None:
            self._clocks_due_in = 0
            clock = Serialised(
                _run_clock(view), "elapsed", "goal_elapsed", "after_stop", "setup_elapsed", "phase_elapsed")
        return _Zone(
            view, shown, Serialised(_zone_state(view), "timer"),
            Serialised(_zone_details(*shown), "skew_known", "skew", "last_message"), clock,
        )


def _of_clock(view: views.ZoneView) -> Tuple[object, ...]:
    """Return the part of a view that a RunClock shows."""
    return view.identity, view.phase, view.clock


def _robot_bytes(robot: Optional[views.RobotInRunView]) -> Tuple[bytes, bytes, bytes]:
    """Return the present values of a zone's details."""
    skew, heard = (None, None) if robot is None else (robot.skew, robot.last_heard)
    return bool_bytes(skew is not None), duration_bytes(skew or 0.0), time_bytes(heard or 0.0)


def _clock_bytes(zone: Zone, now: Now) -> Tuple[bytes, ...]:
    """Return the present values of a run's clock."""
    clock = views.clock_of(zone.run, zone.event.benchmark, now)
    times = (clock.elapsed, clock.goal_elapsed, clock.after_stop, clock.setup_elapsed, clock.phase_elapsed)
    return tuple(duration_bytes(seconds) if seconds else NO_DURATION for seconds in times)


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
        event=view.event.id,
        phase=view.phase,
        actions=shown.written(zip(ACTIONS, view.actions)),
        said=shown.said(view.said),
        by_hand=view.by_hand,
        attempt=view.attempt,
        attempts=view.event.benchmark.rules.attempts,
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
    message.not_stopped = view.not_stopped
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


def _add_all_robots(message: ZoneDetails, view: views.AllRobotsView) -> None:
    count = len(view.robots)
    message.robot = "1 robot" if count == 1 else f"{count} robots"
    message.port = view.first_port
    message.robots_preparing, message.robots_executing, message.robots_stopped = view.counts
    message.robots = view.robots


def _add_module(message: ZoneDetails, module: views.ModuleView) -> None:
    if module.operation is not None:
        message.operation = module.operation.number
    message.held = module.held
    message.module_status = module.status
    message.module_scores = [score_message(score) for score in module.scores]
