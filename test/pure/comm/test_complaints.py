"""Bad datagrams are counted, bounded, and reported rarely and usefully."""

import pytest

from roah_rsbb.comm.complaints import OTHERS, Complaints, OnceASecond
from roah_rsbb.comm.frame import BadDatagram, FrameFault

PASSWORD = BadDatagram(FrameFault.UNDECRYPTABLE, "the padding is wrong")
SIZE = BadDatagram(FrameFault.SIZE, "3 bytes")
ROBOT = ("10.0.0.5", 6667)


def test_the_first_one_is_reported_at_once():
    text = Complaints().add(100.0, "private channel 6667", ROBOT, PASSWORD)
    assert text.startswith("private channel 6667: a bad datagram from 10.0.0.5:6667: "
                           "does not decrypt: the padding is wrong. ")
    assert "wrong password" in text


@pytest.mark.parametrize("reason", list(FrameFault))
def test_every_reason_has_a_likely_cause(reason):
    text = Complaints().add(0.0, "public channel", ROBOT, BadDatagram(reason, "detail"))
    assert ": detail. Likely " in text


def test_the_next_report_comes_after_a_second_and_counts():
    complaints = Complaints()
    texts = [complaints.add(100.0 + 0.05 * tick, "x", ROBOT, PASSWORD) for tick in range(42)]
    assert [tick for tick, text in enumerate(texts) if text] == [0, 20, 40]
    assert "20 bad datagrams" in texts[20]
    assert "20 bad datagrams" in texts[40]


def test_another_reason_or_sender_is_reported_by_itself():
    complaints = Complaints()
    assert complaints.add(0.0, "x", ROBOT, PASSWORD)
    assert complaints.add(0.0, "x", ROBOT, SIZE)
    assert complaints.add(0.0, "x", ("10.0.0.6", 6667), SIZE)
    assert complaints.add(0.0, "x", (ROBOT[0], 9999), SIZE) is None  # the same host: ports come and go


def test_a_flood_of_senders_is_bounded_and_not_lost():
    complaints = Complaints(max_entries=5)
    for number in range(1000):
        for _ in range(2):
            complaints.add(0.0, "x", (f"10.0.{number // 250}.{number % 250}", 1), SIZE)
    totals = complaints.totals()
    assert len(totals) == 6
    assert totals[OTHERS, "wrong size"] == 2 * 995
    assert totals["10.0.3.249", "wrong size"] == 2


def test_a_sender_that_continues_is_not_the_one_forgotten():
    complaints = Complaints(max_entries=3)
    for number in range(20):
        complaints.add(0.0, "x", ROBOT, PASSWORD)
        complaints.add(0.0, "x", (f"10.1.0.{number}", 1), SIZE)
    assert complaints.totals()["10.0.0.5", "does not decrypt"] == 20


def test_a_flood_of_senders_gets_few_reports_a_second():
    complaints = Complaints(max_reports_per_second=10)
    times = []
    for number in range(3000):
        now = number / 1000
        if complaints.add(now, "x", (f"10.0.{number // 250}.{number % 250}", 1), SIZE):
            times.append(now)
    assert len(times) == 30
    assert sum(1 for time in times if time < 1.0) == 10


def test_withheld_complaints_are_counted_in_the_next_report():
    complaints = Complaints(max_reports_per_second=1)
    complaints.add(0.0, "x", ROBOT, PASSWORD)
    assert complaints.add(0.1, "x", ROBOT, SIZE) is None
    assert "2 bad datagrams" in complaints.add(1.1, "x", ROBOT, SIZE)


def test_once_a_second():
    reports = OnceASecond()
    taken = []
    for tick in range(25):
        reports.count()
        taken.append(reports.take(5.0 + tick / 10))
    assert [(tick, count) for tick, count in enumerate(taken) if count] == [(0, 1), (10, 10), (20, 10)]
