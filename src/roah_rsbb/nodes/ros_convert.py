"""From the core's views to the messages of the ROS interface."""

import time
from typing import List

from roah_rsbb.core import views
from roah_rsbb.core.box import Box
from roah_rsbb.core.clock import Now, WireTime
from roah_rsbb.core.messages import DevicesState
from roah_rsbb.core.run import Run
from roah_rsbb.msg import (
    CoreDetails,
    CoreToGui,
    CoreToPublic,
    RobotInfo,
    ScheduleInfo,
    ZoneDetails,
    ZoneState,
)
from roah_rsbb.msg import DevicesState as DevicesStateMsg
from roah_rsbb.nodes.ros_times import ros_duration, ros_duration_kept, ros_time, ros_time_kept, ros_wire_time
from roah_rsbb.nodes.score_convert import groups_message, score_message


def devices_of(message: DevicesStateMsg) -> DevicesState:
    """A DevicesState as the core takes it."""
    bell: WireTime = (message.bell.secs, message.bell.nsecs)
    return DevicesState(
        bell, message.switch_1, message.switch_2, message.switch_3, message.dimmer, message.blinds,
        message.door_win_detect,
    )


def to_gui(box: Box, now: Now, zone_views: List[views.ZoneView], addr: str) -> CoreToGui:
    """The panels' message; `addr` is the broadcast address in use."""
    tablet = box.tablet.state
    return CoreToGui(
        clock=ros_time(now.utc),
        status=views.status(box, now),
        addr=addr,
        port=str(box.settings.rsbb_port),
        active_robots=[
            RobotInfo(r.team, r.robot, ros_duration(r.skew), ros_time(r.last_heard)) for r in views.robots(box, now)
        ],
        zones=[_zone_state(view) for view in zone_views],
        tablet_last_beacon=ros_time(0.0 if box.tablet.heard is None else box.tablet.heard.utc),
        tablet_display_map=tablet.display_map,
        tablet_call_time=ros_wire_time(tablet.call_time),
        tablet_position_time=ros_wire_time(tablet.position_time),
        tablet_position_x=tablet.position_x,
        tablet_position_y=tablet.position_y,
    )


def to_public(box: Box, now: Now) -> CoreToPublic:
    """The public display's message; times are local, the public's."""
    return CoreToPublic(
        clock=_local(now.utc),
        schedule=[
            ScheduleInfo(
                line.event.team, line.event.benchmark.desc, line.event.round, line.event.run,
                _local(line.event.scheduled), line.running,
            )
            for line in views.schedule(box)
        ],
    )


def details(box: Box, now: Now, zone_views: List[views.ZoneView], box_uuid: str, log_files) -> CoreDetails:
    """What the panels' message has no field for; `log_files`: path of each run's log by its port."""
    return CoreDetails(
        clock=ros_time(now.utc),
        box_uuid=box_uuid,
        warnings=box.warnings(now),
        zones=[_zone_details(view, log_files) for view in zone_views],
    )


def _zone_state(view: views.ZoneView) -> ZoneState:
    event = view.event
    message = ZoneState(
        zone=view.zone,
        name=event.benchmark.name,
        desc=event.benchmark.desc,
        code=event.benchmark.code,
        timeout=ros_duration_kept(event.benchmark.timeout),
        team=event.team,
        round=event.round,
        run=event.run,
        schedule=ros_time_kept(event.scheduled),
        timer=ros_duration(view.timer),
        state=view.state,
        log=view.log,
        online_data=view.online_data,
        scoring=groups_message(view.scoring),
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


def _zone_details(view: views.ZoneView, log_files) -> ZoneDetails:
    message = ZoneDetails(
        zone=view.zone,
        phase=view.phase,
        connect_off=view.reasons_off("connect"),
        disconnect_off=view.reasons_off("disconnect"),
        start_off=view.reasons_off("start"),
        stop_off=view.reasons_off("stop"),
        prev_off=view.reasons_off("previous"),
        next_off=view.reasons_off("next"),
        warnings=view.warnings,
    )
    run = view.run
    if run is None:
        return message
    message.identity = run.identity
    message.not_attempted = list(view.not_attempted)
    message.end_reason = "" if run.end_reason is None else run.end_reason.name.lower()
    if view.all_robots is not None:
        _add_all_robots(message, view.all_robots)
    else:
        _add_robot(message, run, log_files)
    _add_module(message, view.module)
    return message


def _add_robot(message: ZoneDetails, run: Run, log_files) -> None:
    message.robot = run.robot.robot
    message.port = run.port
    message.box_state = run.message.state.name
    message.robot_state = "" if run.robot_state is None else run.robot_state.name
    message.skew_known = run.link.skew is not None
    message.skew = ros_duration(run.link.skew or 0.0)
    message.last_message = ros_time(0.0 if run.link.last_heard is None else run.link.last_heard.utc)
    message.messages_saved = run.link.messages_saved
    message.log_file = log_files.get(run.port, "")


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


def _local(utc: float) -> str:
    return time.strftime("%Y-%m-%d %H:%M:%S", time.localtime(utc))
