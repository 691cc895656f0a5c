"""The messages for the referees' panels: /core/to_gui ten times a second, /core/details when something changed.

Most of a zone's content stays the same for many ticks, so it is cached until it changes. Only times are always new.
"""

from typing import Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple

from roah_rsbb.core.box import Box
from roah_rsbb.core.robots import RobotId
from roah_rsbb.model import shown
from roah_rsbb.model.clock import Now
from roah_rsbb.model.document import BoxState, Document
from roah_rsbb.model.reason import is_made
from roah_rsbb.model.zone import RobotInRun, Zone
from roah_rsbb.model.zone import RunClock as Clock
from roah_rsbb.msg import CoreDetails, CoreToGui, RobotInfo, RunClock, RunClocks, ZoneDetails, ZoneState
from roah_rsbb.nodes.core.score_convert import has_old_form, item_message, old_groups, points_message, score_message
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
from roah_rsbb.ros.times import ros_duration, ros_time, ros_wire_time


class _Zone(NamedTuple):
    """The cached messages of a zone."""

    view: Zone
    state: Serialised
    details: Serialised
    clock: Serialised


class PanelMessages:
    """Makes the messages of one box."""

    # Clock skew and time of the latest message always change. If nothing else does, they wait for this many ticks.
    DETAILS_EVERY = 10

    def __init__(self, box: Box, box_uuid: str) -> None:
        self._box = box
        self._box_uuid = box_uuid
        self._box_state = BoxState(box_uuid, "", 0)
        self._robots: Dict[RobotId, Serialised] = {}
        self._zones: Dict[str, _Zone] = {}
        self._warnings: Tuple[Sequence[str], str] = (), ""
        self._details_due_in = self._clocks_due_in = 0  # ticks

    def to_gui(self, now: Now, document: Document) -> CoreToGui:
        """The message of this tick."""
        box, self._box_state = self._box, document.box
        tablet = box.tablet.state
        self._look_at_zones(now, document.zones)
        return SerialisedToGui(
            self._robot_infos(now),
            [kept.state.with_values(duration_bytes(kept.view.clock.timer(now.mono))) for kept in self._zones.values()],
            clock=ros_time(now.utc),
            status=document.box.status,
            addr=document.box.host,
            port=str(document.box.port),
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
        warnings, status = self._box_state.warnings, self._box_state.status
        if (warnings, status) != self._warnings:
            self._warnings, self._details_due_in = (warnings, status), 0
        self._details_due_in -= 1
        if self._details_due_in >= 0:
            return None
        self._details_due_in = self.DETAILS_EVERY - 1
        return SerialisedDetails(
            [kept.details.with_values(*_robot_bytes(kept.view.robot, now)) for kept in self._zones.values()],
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
            [kept.clock.with_values(*_clock_bytes(kept.view, now)) for kept in self._zones.values()],
            clock=ros_time(now.utc),
            box_uuid=self._box_uuid,
        )

    def _robot_infos(self, now: Now) -> List[bytes]:
        robots = self._box.robots.all(now)
        before, self._robots = self._robots, {}
        for robot in robots:
            name = robot.id
            self._robots[name] = before.get(name) or Serialised(RobotInfo(*name, ros_duration(0.0), ros_time(0.0)),
                                                                "skew", "beacon")
        return [kept.with_values(duration_bytes(robot.skew.seconds or 0.0), time_bytes(robot.last_heard.utc))
                for robot, kept in zip(robots, self._robots.values())]

    def _look_at_zones(self, now: Now, zones: Mapping[str, Zone]) -> None:
        """Make the messages of the zones that changed."""
        before, self._zones = self._zones, {}
        for name, view in zones.items():
            self._zones[name] = self._zone(view, before.get(name), now)
        if list(before) != list(self._zones):
            self._details_due_in = self._clocks_due_in = 0

    def _zone(self, view: Zone, kept: Optional[_Zone], now: Now) -> _Zone:
        if kept is not None and view is kept.view:
            return kept
        self._details_due_in = 0
        clock = kept.clock if kept is not None and _of_clock(kept.view) == _of_clock(view) else None
        if clock is None:
            self._clocks_due_in = 0
            clock = Serialised(
                _run_clock(view, now), "elapsed", "goal_elapsed", "after_stop", "setup_elapsed", "phase_elapsed")
        return _Zone(
            view, Serialised(_zone_state(view), "timer"),
            Serialised(_zone_details(view), "skew_known", "skew", "last_message"), clock,
        )


def _of_clock(view: Zone) -> Tuple[object, ...]:
    """Return the part of a zone that a RunClock shows."""
    return view.identity, view.phase, view.clock


def _robot_bytes(robot: Optional[RobotInRun], now: Now) -> Tuple[bytes, bytes, bytes]:
    """Return the present values of a zone's details."""
    if robot is None:
        return bool_bytes(False), duration_bytes(0.0), time_bytes(0.0)
    heard = 0.0 if not robot.heard else now.utc - (
        0.0 if robot.silent_since is None else now.mono - robot.silent_since)
    return bool_bytes(robot.skew is not None), duration_bytes(robot.skew or 0.0), time_bytes(heard)


def _times(clock: Clock, now: Now) -> Tuple[float, ...]:
    return (clock.spent(now.mono), clock.goal_spent(now.mono) if clock.goal else 0.0, clock.after_stop(now.mono),
            clock.setup_elapsed.at(now.mono), clock.phase_elapsed.at(now.mono))


def _clock_bytes(view: Zone, now: Now) -> Tuple[bytes, ...]:
    """Return the present values of a run's clock."""
    return tuple(duration_bytes(seconds) if seconds else NO_DURATION for seconds in _times(view.clock, now))


def _run_clock(view: Zone, now: Now) -> RunClock:
    clock = view.clock
    elapsed, goal_elapsed, after_stop, setup_elapsed, phase_elapsed = map(ros_duration, _times(clock, now))
    return RunClock(
        zone=view.zone,
        identity=view.identity,
        phase=view.phase,
        limit=ros_duration(clock.limit),
        elapsed=elapsed,
        counting=clock.elapsed.counting,
        paused=clock.paused,
        goal_limit=ros_duration(clock.goal_limit),
        goal=clock.goal,
        goal_elapsed=goal_elapsed,
        goal_counting=clock.goal_elapsed.counting,
        after_stop=after_stop,
        setup_limit=ros_duration(clock.setup_limit),
        setup_elapsed=setup_elapsed,
        setup_counting=clock.setup_elapsed.counting,
        phases=clock.phases,
        phase_number=clock.phase_number,
        phase_name=clock.phase_name,
        phase_limit=ros_duration(clock.phase_limit),
        phase_elapsed=phase_elapsed,
    )


def _zone_state(view: Zone) -> ZoneState:
    event = view.event
    message = ZoneState(
        zone=view.zone,
        name=event.name,
        desc=event.desc,
        code=event.code,
        timeout=ros_duration(view.timeout),
        team=event.team,
        round=event.round,
        run=event.run,
        schedule=ros_time(event.scheduled),
        state="\n".join(view.lines),
        log=view.log,
        online_data=view.online_data,
        scoring=old_groups(view.items),
    )
    message.connect_enabled = view.is_on("connect")
    message.disconnect_enabled = view.is_on("disconnect")
    message.start_enabled = view.is_on("start")
    message.stop_enabled = view.is_on("stop")
    message.prev_enabled = view.is_on("previous")
    message.next_enabled = view.is_on("next")
    message.manual_operation = view.manual_operation
    message.omf = view.switches is not None
    if view.switches is not None:
        message.omf_switches = bytes(view.switches.on)
        message.omf_damaged = view.switches.damaged
        message.omf_complete = view.switches.to_confirm
    return message


def _zone_details(view: Zone) -> ZoneDetails:
    robots = view.all_robots
    message = ZoneDetails(
        zone=view.zone,
        event=view.event.id,
        phase=view.phase,
        actions=shown.written(view.actions.items()),
        said=shown.said(filter(is_made, [*view.state, *view.warnings])),
        by_hand=view.by_hand,
        attempt=view.attempt,
        attempts=view.attempts,
        warnings=view.warnings,
        identity=view.identity,
        not_attempted=[item.not_attempted for item in view.items if has_old_form(item)],
        items=list(map(item_message, view.items)),
        points=points_message(view.points),
        end_reason=view.end_reason,
        not_stopped=view.not_stopped,
        robot=view.robot_name,
        port=view.port,
        log_file=view.log_file,
        operation=view.operation,
        held=view.held,
        module_status=view.module_status,
        module_scores=[score_message(score) for score in view.module_scores],
    )
    if view.robot is not None:
        message.box_state = view.robot.box_state
        message.robot_state = view.robot.robot_state
        message.messages_saved = view.robot.messages_saved
    if robots is not None:
        message.robots_preparing, message.robots_executing, message.robots_stopped = (
            robots.preparing, robots.executing, robots.stopped)
        message.robots = robots.robots
    return message
