"""Reading a robot's payloads within its budget."""

from roah_rsbb.comm import frame
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.radio import wire_convert
from roah_rsbb.radio.report_reader import BYTES_AT_ONCE, BYTES_PER_SECOND, ReportReader, Unread

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
