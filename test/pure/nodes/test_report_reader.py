"""A robot's payloads, one after the other, read as each of them alone."""

import itertools
import random

import pytest

from roah_rsbb.comm import frame
from roah_rsbb.comm.heartbeat import Heartbeat
from roah_rsbb.nodes.core import wire_convert
from roah_rsbb.nodes.core.report_reader import BYTES_AT_ONCE, BYTES_PER_SECOND, ReportReader, Unread
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb

IDS = frame.ids_of(pb.RobotState)
TIMES = [(0, 0), (1447000001, 987654000), (1, 5), (2**40, 999_999_999), (127, 128), (-1, 0), (5, -1), (2**63 - 1, 0)]


def message(time=(1447000001, 987654000), **fields):
    values = {"messages_saved": 7, "robot_state": pb.RobotState.EXECUTING, **fields}
    return pb.RobotState(time=pb.Time(sec=time[0], nsec=time[1]), **values)


def payload(time=(1447000001, 987654000), **fields):
    return IDS + message(time, **fields).SerializeToString()


def alone(data):
    """What the payload says, without any before it; the reason where it is none."""
    try:
        return wire_convert.report_of(frame.private_message(data))
    except frame.BadDatagram as bad:
        return bad.reason


def read(reader, data):
    try:
        return reader(data)
    except frame.BadDatagram as bad:
        return bad.reason


@pytest.mark.parametrize("fields", [{}, {"notifications": ["a", "ä\n"]}, {"devices_dimmer": 0, "generic_result": "{}"}],
                         ids=["plain", "strings", "optional"])
def test_reports_that_differ_in_their_time_only(fields):
    reader = ReportReader()
    for time in TIMES + TIMES[::-1]:
        data = payload(time, **fields)
        assert reader(data) == alone(data)
        assert reader(data).time == time


def test_a_heartbeat_is_not_parsed(monkeypatch):
    reader = ReportReader()
    reader(payload((5, 6)))
    monkeypatch.setattr(frame, "private_message", None)
    assert reader(payload((7, 8))).time == (7, 8)
    with pytest.raises(TypeError):
        reader(payload((9, 10), messages_saved=8))


def test_whatever_changes_is_read():
    reader = ReportReader()
    rng = random.Random(7)
    for _ in range(300):
        fields = {}
        if rng.random() < 0.3:
            fields["messages_saved"] = rng.randrange(3)
        if rng.random() < 0.3:
            fields["notifications"] = [str(rng.randrange(3))]
        if rng.random() < 0.3:
            fields["robot_state"] = rng.randrange(5)
        data = payload((rng.randrange(300), rng.randrange(300)), **fields)
        assert reader(data) == alone(data)


def test_another_boxs_state_comes_as_it_is():
    reader = ReportReader()
    foreign = pb.BenchmarkState(benchmark_type="HNF", benchmark_state=pb.BenchmarkState.STOP,
                                acknowledgement=pb.Time(sec=1, nsec=2))
    data = frame.ids_of(pb.BenchmarkState) + foreign.SerializeToString()
    assert reader(payload()) == alone(payload())
    assert reader(data) == foreign
    assert reader(payload((1, 2))) == alone(payload((1, 2)))


def test_a_second_time_counts_as_protobuf_has_it():
    """The last of two times is the one that counts: a first one must not be taken for it."""
    second = pb.RobotState(time=pb.Time(sec=50, nsec=60)).SerializePartialToString()
    reader = ReportReader()
    for time in ((1, 2), (3, 4), (5, 6)):
        data = payload(time) + second
        assert reader(data) == alone(data)
        assert reader(data).time == (50, 60)


def test_fields_in_another_order_are_read():
    time = pb.RobotState(time=pb.Time(sec=50, nsec=60)).SerializePartialToString()
    rest = pb.RobotState(messages_saved=3, robot_state=pb.RobotState.STOP).SerializePartialToString()
    reader = ReportReader()
    assert reader(payload((1, 2), messages_saved=3, robot_state=pb.RobotState.STOP)).time == (1, 2)
    assert reader(IDS + rest + time) == alone(IDS + rest + time)
    assert reader(IDS + rest + time).time == (50, 60)


def test_a_time_in_more_bytes_than_it_needs_is_the_same_time():
    reader = ReportReader()
    reader(payload((1, 2)))
    long_one = IDS + b"\x0a\x06\x08\x85\x00\x10\x86\x00" + payload((1, 2))[len(IDS) + 6:]
    assert read(reader, long_one) == alone(long_one)


@pytest.mark.parametrize("seed", range(4))
def test_noise_is_read_as_if_nothing_had_come_before(seed):
    """Bytes changed, removed and doubled, mostly in the beginning, between good payloads."""
    rng, reader, accepted = random.Random(seed), ReportReader(itertools.count().__next__), 0
    good = [payload((rng.randrange(2**31), rng.randrange(10**9)), notifications=["abc"]) for _ in range(4)]
    for _ in range(3000):
        data = bytearray(rng.choice(good))
        for _ in range(rng.randrange(3)):
            at = rng.randrange(min(len(data), rng.choice([6, 14, 100])))
            act = rng.randrange(3)
            if act == 0:
                data[at] = rng.choice([0, 1, 8, 10, 16, 127, 128, 255, rng.randrange(256)])
            elif act == 1:
                del data[at]
            else:
                data[at:at] = data[at:at + rng.randrange(1, 9)]
        expected = alone(bytes(data))
        accepted += not isinstance(expected, frame.Reason)
        assert read(reader, bytes(data)) == expected
    assert 1000 < accepted < 2900


@pytest.mark.parametrize("begin", ["", "0a", "0a80", "0a04", "0a0408", "0a0408011001", "0a020801", "0a0408018010",
                                   "0a0c" + "08" + "ff" * 11, "0a04" + "10011001"])
def test_a_payload_that_ends_early_is_no_heartbeat(begin):
    heartbeat = Heartbeat()
    heartbeat.remember(payload(), message())
    assert heartbeat.time_of(IDS + bytes.fromhex(begin)) is None


def test_nothing_is_a_heartbeat_before_anything_was_remembered():
    assert Heartbeat().time_of(payload()) is None


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
