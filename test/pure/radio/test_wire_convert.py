"""Between protobuf and the core's plain values: every field, both ways."""

from roah_rsbb.model.messages import Beacon, BenchmarkingRobot, BoxMessage, DevicesState, TabletState
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.protocol import BoxState, RobotState
from roah_rsbb.radio import wire_convert

WIRE_TIME = (1447000001, 987654000)


def robot_state(**fields):
    return pb.RobotState(
        time=pb.Time(sec=WIRE_TIME[0], nsec=WIRE_TIME[1]),
        messages_saved=7,
        robot_state=pb.RobotState.EXECUTING,
        **fields,
    )


def test_numbers_of_the_states_are_those_on_the_wire():
    assert {s.name: s.value for s in BoxState} == dict(pb.BenchmarkState.State.items())
    assert {s.name: s.value for s in RobotState} == dict(pb.RobotState.State.items())


def test_fields_that_a_robot_does_not_send_differ_from_zeros():
    report = wire_convert.report_of(robot_state())
    assert (report.time, report.messages_saved, report.state) == (WIRE_TIME, 7, RobotState.EXECUTING)
    assert report[3:7] == ((), (), (), ())
    assert set(report[7:]) == {None}


def test_every_field_of_a_robot_state_arrives():
    sent = {
        "notifications": ["a", "b"], "activation_event": ["bell"], "visitor": ["postman"], "final_command": ["tea"],
        "devices_switch_1": True, "devices_switch_2": False, "devices_switch_3": True, "devices_dimmer": 0,
        "devices_blinds": 100, "tablet_display_map": False, "generic_result": "{x: 1}", "object_class": "cups",
        "object_name": "red", "object_pose_x": 1.5, "object_pose_y": -2.0, "object_pose_theta": 0.0,
    }
    report = wire_convert.report_of(robot_state(**sent))
    values = [tuple(value) if isinstance(value, list) else value for value in sent.values()]
    assert list(report[3:]) == values


def test_every_field_of_a_robot_state_is_known_to_the_core():
    in_proto = set(pb.RobotState.DESCRIPTOR.fields_by_name)
    filled = robot_state(
        generic_result="", object_class="", object_name="", object_pose_x=0.0, object_pose_y=0.0, object_pose_theta=0.0,
        devices_switch_1=False, devices_switch_2=False, devices_switch_3=False, devices_dimmer=0, devices_blinds=0,
        tablet_display_map=False,
    )
    assert len(wire_convert.report_of(filled)) == len(in_proto)
    assert None not in wire_convert.report_of(filled)


def test_the_box_always_sends_an_acknowledgement_like_the_original():
    sent = wire_convert.state_message(BoxMessage("HWV", BoxState.PREPARE))
    assert (sent.benchmark_type, sent.benchmark_state) == ("HWV", pb.BenchmarkState.PREPARE)
    assert sent.HasField("acknowledgement")
    assert wire_convert.time_of(sent.acknowledgement) == (0, 0)


def test_beacon_holds_robots_devices_and_tablet():
    devices = DevicesState((5, 6), True, False, True, 40, 60, True)
    tablet = TabletState(True, (1, 2), (3, 4), 1.25, -0.5)
    sent = wire_convert.beacon_message(Beacon((BenchmarkingRobot("T", "R", 6667),), devices, tablet))
    assert [(t.team_name, t.robot_name, t.rsbb_port) for t in sent.benchmarking_teams] == [("T", "R", 6667)]
    assert wire_convert.time_of(sent.devices_bell) == (5, 6)
    assert (sent.devices_switch_1, sent.devices_switch_2, sent.devices_switch_3) == (True, False, True)
    assert (sent.devices_dimmer, sent.devices_blinds, sent.devices_door_win_detect) == (40, 60, True)
    assert sent.tablet_display_map
    assert wire_convert.time_of(sent.tablet_call_time) == (1, 2)
    assert wire_convert.time_of(sent.tablet_position_time) == (3, 4)
    assert (sent.tablet_position_x, sent.tablet_position_y) == (1.25, -0.5)


def test_an_empty_beacon_has_everything_that_robots_require():
    sent = wire_convert.beacon_message(Beacon((), DevicesState(), TabletState()))
    assert sent.IsInitialized()
    assert sent.HasField("devices_door_win_detect"), "robots of 2019 require it"


def test_a_tablet_beacon_does_not_say_which_view_it_shows():
    message = pb.TabletBeacon(last_call=pb.Time(sec=1, nsec=2), last_pos=pb.Time(sec=3, nsec=4), x=0.5, y=-1.0)
    assert wire_convert.tablet_of(message) == TabletState(False, (1, 2), (3, 4), 0.5, -1.0)
