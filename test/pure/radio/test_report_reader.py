"""Reading a robot's payloads within its budget."""

from roah_rsbb.comm import frame
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.radio import wire_convert
from roah_rsbb.radio.wire_convert import BYTES_AT_ONCE, BYTES_PER_SECOND, ReportReader, Unread

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
