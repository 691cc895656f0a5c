"""Between protobuf and the core's plain values: every field, both ways."""

from roah_rsbb.comm import frame
from roah_rsbb.model.messages import Beacon, BenchmarkingRobot, BoxMessage, DevicesState, TabletState
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.protocol import BoxState, RobotState
from roah_rsbb.radio import wire_convert
from roah_rsbb.radio.wire_convert import BYTES_AT_ONCE, BYTES_PER_SECOND, ReportReader, Unread

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


# -- reading a robot's payloads within its budget -----------------------------------------------------

HEADER = 8


def payload(time=(1447000001, 987654000), **fields):
    values = {"messages_saved": 7, "robot_state": pb.RobotState.EXECUTING, **fields}
    return frame.encode(pb.RobotState(time=pb.Time(sec=time[0], nsec=time[1]), **values))[HEADER:]


def test_a_report_and_another_boxs_state():
    reader = ReportReader()
    foreign = pb.BenchmarkState(benchmark_type="HNF", benchmark_state=pb.BenchmarkState.STOP,
                                acknowledgement=pb.Time(sec=1, nsec=2))
    assert reader(payload((5, 6))) == wire_convert.report_of(frame.private_message(payload((5, 6))))
    assert reader(frame.encode(foreign)[HEADER:]) == foreign


def test_a_robot_that_sends_too_much_is_read_as_far_as_its_budget_goes():
    now = 100.0
    reader = ReportReader(lambda: now)
    data = payload(notifications=["x" * 979])
    read = [reader(data) for _ in range(3 * BYTES_AT_ONCE // len(data))]
    taken = [report for report in read if not isinstance(report, Unread)]
    assert read[:len(taken)] == taken
    assert len(taken) == BYTES_AT_ONCE // len(data)
    assert [unread.count for unread in read[len(taken):]] == [1] + [0] * (len(read) - len(taken) - 1)
    now += 1.0
    again = [reader(data) for _ in range(BYTES_PER_SECOND // len(data) + 2)]
    assert not isinstance(again[0], Unread)
    assert next(unread.count for unread in again if isinstance(unread, Unread)) == len(read) - len(taken)
    left = sum(not isinstance(report, Unread) for report in again) - BYTES_PER_SECOND // len(data)
    assert left in (0, 1)  # what was too little for one message before


def test_a_usual_robot_is_always_read():
    now = 100.0
    reader = ReportReader(lambda: now)
    for i in range(20 * 60):
        now += 0.05
        assert not isinstance(reader(payload((1447000001 + i, 0), notifications=[f"{i}" * 100])), Unread)


def outcome(read, data):
    """What reading a payload gives: a report, a message, or why it is invalid."""
    try:
        result = read(data)
    except frame.BadDatagram as bad:
        return bad.reason, bad.detail
    return wire_convert.report_of(result) if isinstance(result, pb.RobotState) else result


TIME = payload()[:4 + 2 + payload()[5]]  # ids and time
REST = payload()[len(TIME):]
SECOND_TIME = pb.RobotState(time=pb.Time(sec=1447000001, nsec=987654000)).SerializePartialToString()
REPEATED = {
    "another time": payload((1447000002, 1)),
    "a time before 1970": payload((-1, 5)),
    "the largest time": payload((2**63 - 1, 0)),
    "a time beyond the largest": TIME[:5] + b"\x0d\x08" + b"\xff" * 9 + b"\x7f\x10\x00" + REST,
    "another state": payload(robot_state=pb.RobotState.RESULT_TX),
    "more messages saved": payload(messages_saved=8),
    "a string": payload(notifications=["one"]),
    "a command": payload(devices_dimmer=0),
    "two times, the second one counts": TIME + REST + SECOND_TIME,
    "two times, with another first one": payload((3, 4))[:-len(REST)] + REST + SECOND_TIME,
    "a time without nanoseconds": TIME[:5] + b"\x02\x08\x07" + REST,
    "a time of nanoseconds only": TIME[:5] + b"\x02\x10\x07" + REST,
    "a time in reverse order": TIME[:5] + b"\x04\x10\x01\x08\x02" + REST,
    "a time with another field": TIME[:5] + b"\x06\x08\x01\x10\x02\x18\x03" + REST,
    "a time that is too long": TIME[:5] + b"\x05\x08\x01\x10\x02" + REST,
    "a time that is too short": TIME[:5] + b"\x03\x08\x01\x10\x02" + REST,
    "no time": TIME[:4] + REST,
    "only a time": TIME,
    "only ids": TIME[:4],
    "cut in the time": TIME[:-1],
    "cut in the length": TIME[:5],
    "another box": frame.encode(pb.BenchmarkState(
        benchmark_type="HNF", benchmark_state=pb.BenchmarkState.STOP, acknowledgement=pb.Time(sec=1, nsec=2)))[HEADER:],
    "the same fields of another type": payload()[:3] + b"\x63" + payload()[4:],
}


def test_a_message_after_any_other_is_read_as_if_it_were_the_first():
    for before, first in REPEATED.items():
        reader = ReportReader(lambda: 100.0)
        for name, data in [("usual", payload()), (before, first), *REPEATED.items(), (before, first)]:
            assert outcome(reader, data) == outcome(frame.private_message, data), (before, name)
            again = outcome(reader, data)
            assert again == outcome(frame.private_message, data), (before, name)


def test_a_repeated_state_is_not_parsed_again(monkeypatch):
    reader = ReportReader()
    first = reader(payload((5, 6)))
    monkeypatch.setattr(frame, "private_message", None)
    assert reader(payload((7, 8))) == first._replace(time=(7, 8))
