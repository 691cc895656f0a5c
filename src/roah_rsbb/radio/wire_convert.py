"""Converts between the protobuf messages of `comm` and the values of `core`."""

from roah_rsbb.model.messages import Beacon, BoxMessage, RobotReport, TabletState
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.protocol import RobotState, WireTime

# Optional fields of a RobotState, by their names in a RobotReport.
_OPTIONAL = {
    "switch_1": "devices_switch_1",
    "switch_2": "devices_switch_2",
    "switch_3": "devices_switch_3",
    "dimmer": "devices_dimmer",
    "blinds": "devices_blinds",
    "display_map": "tablet_display_map",
    "generic_result": "generic_result",
    "object_class": "object_class",
    "object_name": "object_name",
    "object_pose_x": "object_pose_x",
    "object_pose_y": "object_pose_y",
    "object_pose_theta": "object_pose_theta",
}


def report_of(message: pb.RobotState) -> RobotReport:
    """Convert a RobotState."""
    return RobotReport(
        time=time_of(message.time),
        messages_saved=message.messages_saved,
        state=RobotState(message.robot_state),
        notifications=tuple(message.notifications),
        activation_event=tuple(message.activation_event),
        visitor=tuple(message.visitor),
        final_command=tuple(message.final_command),
        **{ours: getattr(message, theirs) for ours, theirs in _OPTIONAL.items() if message.HasField(theirs)},
    )


def tablet_of(message: pb.TabletBeacon) -> TabletState:
    """Convert a TabletBeacon, which does not contain the shown view."""
    return TabletState(
        call_time=time_of(message.last_call),
        position_time=time_of(message.last_pos),
        position_x=message.x,
        position_y=message.y,
    )


def acknowledge(message: pb.BenchmarkState, time: WireTime) -> None:
    """Set the `time` of the RobotState that a BenchmarkState acknowledges."""
    _set_time(message.acknowledgement, time)


def state_message(message: BoxMessage) -> pb.BenchmarkState:
    """Build a BenchmarkState."""
    goal = message.goal
    made = pb.BenchmarkState(
        benchmark_type=message.benchmark, benchmark_state=int(message.state), initial_state=goal.initial_state,
        switches=goal.switches,
    )
    acknowledge(made, message.acknowledgement)
    if goal.text:
        made.generic_goal = goal.text
    if goal.pose is not None:
        made.target_pose_x, made.target_pose_y, made.target_pose_theta = goal.pose
    return made


def beacon_message(beacon: Beacon) -> pb.RoahRsbbBeacon:
    """Build a RoahRsbbBeacon."""
    devices, tablet = beacon.devices, beacon.tablet
    made = pb.RoahRsbbBeacon(
        devices_switch_1=devices.switch_1,
        devices_switch_2=devices.switch_2,
        devices_switch_3=devices.switch_3,
        devices_dimmer=devices.dimmer,
        devices_blinds=devices.blinds,
        devices_door_win_detect=devices.door_win_detect,
        tablet_display_map=tablet.display_map,
        tablet_position_x=tablet.position_x,
        tablet_position_y=tablet.position_y,
    )
    for robot in beacon.robots:
        made.benchmarking_teams.add(team_name=robot.team, robot_name=robot.robot, rsbb_port=robot.port)
    _set_time(made.devices_bell, devices.bell)
    _set_time(made.tablet_call_time, tablet.call_time)
    _set_time(made.tablet_position_time, tablet.position_time)
    return made


def time_of(message: pb.Time) -> WireTime:
    """A wire time as an exact pair."""
    return message.sec, message.nsec


def _set_time(field: pb.Time, time: WireTime) -> None:
    field.sec, field.nsec = time
