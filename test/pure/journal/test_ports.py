"""The record of used private ports."""

import os
import threading

import pytest

from roah_rsbb.journal.log_dir import PortRecord


@pytest.fixture
def record(tmp_path):
    return PortRecord(str(tmp_path), lambda work: work())


def test_new_competition_has_no_ports(record):
    assert record.read() == (None, [])


def test_largest_port_is_remembered_by_the_next_process(record, tmp_path):
    for port in (6667, 6669, 6668):
        record.add(port, pytest.fail)
    assert PortRecord(str(tmp_path)).read() == (6669, [])


def test_a_torn_last_line_hides_nothing(record):
    record.add(6667, pytest.fail)
    with open(record.path, "ab") as file:
        file.write(b"\n66")
    record.add(6668, pytest.fail)
    assert record.read() == (6668, [])


@pytest.mark.parametrize("lines, count", [
    (b"port six\n99999999\n\xff\xfe", 4), ("²".encode(), 1),
    (b"9" * 5000, 1),  # Python refuses to read numbers of more than 4300 digits
])
def test_lines_that_are_no_ports_are_skipped_and_reported(record, lines, count):
    with open(record.path, "wb") as file:
        file.write(b"6667\n" + lines + b"\n")
    largest, (warning,) = record.read()
    assert largest == 6667 and record.path in warning and f"{count} lines" in warning


def test_a_directory_that_is_gone_is_reported(tmp_path):
    problems = []
    PortRecord(os.path.join(str(tmp_path), "gone"), lambda work: work()).add(6667, problems.append)
    assert problems[0].filename == os.path.join(str(tmp_path), "gone", "used_private_ports")


def test_a_slow_disk_does_not_keep_the_caller(tmp_path, monkeypatch):
    record, disk_is_back, synced = PortRecord(str(tmp_path)), threading.Event(), threading.Event()

    def slow(_fd):
        assert disk_is_back.wait(30.0)
        synced.set()

    monkeypatch.setattr("os.fsync", slow)
    record.add(6667, pytest.fail)  # would wait for ever if it synced itself
    disk_is_back.set()
    assert synced.wait(30.0)
    assert record.read() == (6667, [])


def test_a_disk_that_fails_later_is_reported(record, monkeypatch):
    reported = threading.Event()

    def fail(_fd):
        raise OSError(5, "Input/output error")

    monkeypatch.setattr("os.fsync", fail)
    record.add(6667, lambda error: error.errno == 5 and reported.set())
    assert reported.wait(30.0)
