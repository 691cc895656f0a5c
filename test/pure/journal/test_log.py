"""The segments of a journal: what is read back, what is damage, what is a torn tail."""

import os

import pytest

from roah_rsbb.journal import log as logs
from roah_rsbb.journal.log import Files, Hole, Log, read, read_chain, scan, scans


class FailingFiles(Files):
    """Files on a disk that fails when it is asked to."""

    def __init__(self):
        self.fails = ()

    def __getattribute__(self, name):
        if name != "fails" and name in self.fails:
            raise OSError(5, "Input/output error")
        return super().__getattribute__(name)


def begun(folder, files=None):
    """A log that continues what is in a folder, as a core does at its start."""
    log = Log(str(folder), lambda: b"summary", lambda *_: None, files)
    segments = read_chain(str(folder)).segments
    if segments:
        log.continue_after(segments, scan(read(segments[-1].path), segments[-1].head))
    log.begin()
    return log


def add(log, *numbers):
    for number in numbers:
        assert log.append(b"record %d" % number) == number
    log.write()


def found(folder):
    """The numbers of the intact records, and the holes."""
    chain = read_chain(str(folder))
    numbers, holes = [], []
    for _, part in scans(chain.segments):
        assert all(frame.payload == b"record %d" % frame.number for frame in part.records)
        numbers += [frame.number for frame in part.records]
        holes += part.holes
    return numbers, holes, chain.problems


def change(path, at, content=b"\xff"):
    with open(path, "r+b") as file:
        file.seek(at)
        file.write(content)


def places(segment):
    return {frame.number: frame.at for frame in scan(read(segment.path), segment.head).records}


@pytest.fixture
def folder(tmp_path):
    return tmp_path / "journal"


def test_records_are_read_back_from_all_segments(folder):
    log = begun(folder)
    add(log, 1, 2)
    log.sync()
    log.begin()
    add(log, 3)
    assert (log.written, log.saved) == (3, 2)
    log.sync()
    log.close()
    assert found(folder) == ([1, 2, 3], [], [])
    log = begun(folder)
    assert log.last == log.saved == 3
    add(log, 4)
    log.close()
    assert found(folder) == ([1, 2, 3, 4], [], [])
    assert [name.number for name in logs.names_in(str(folder))] == [1, 2, 3]


def test_what_a_killed_process_did_not_sync_is_copied_and_not_only_sealed(folder):
    """It is in the page cache: a later power cut would take it, and the next segment would say that it is there."""
    log = begun(folder)
    add(log, 1)
    log.sync()
    add(log, 2, 3)  # killed here
    log.close()
    begun(folder).close()
    first, second = read_chain(str(folder)).segments
    assert second.head.first == 2
    os.truncate(first.path, second.head.before_bytes)  # the power cut
    assert found(folder) == ([1, 2, 3], [], [])


def test_nothing_has_its_name_before_it_is_on_the_disk(folder):
    """Otherwise an old segment is sealed, and the copy of its records can be lost."""
    files = FailingFiles()
    log = begun(folder, files)
    add(log, 1)
    for step in ("sync", "write", "rename", "create"):
        files.fails = step
        with pytest.raises(OSError):
            log.begin()
        assert len(logs.names_in(str(folder))) == 1
        assert log.saved == 0
    files.fails = ()
    log.sync()
    assert log.saved == 1
    assert found(folder) == ([1], [], [])


@pytest.mark.parametrize("step", ["sync", "sync_folder"])
def test_after_a_failed_fsync_everything_that_is_not_proven_is_written_again(folder, step):
    files = FailingFiles()
    log = begun(folder, files)
    add(log, 1)
    log.sync()
    add(log, 2)
    files.fails = (step,)
    with pytest.raises(OSError):
        log.sync() if step == "sync" else log.begin()
    assert log.saved == 1
    files.fails = ()
    add(log, 3)
    log.sync()
    log.close()
    assert log.saved == 3
    newest = read_chain(str(folder)).segments[-1]
    assert newest.head.first == 2 and list(places(newest)) == [2, 3]
    assert found(folder) == ([1, 2, 3], [], [])


def test_damage_is_named_by_number(folder):
    log = begun(folder)
    for number in range(1, 8):
        add(log, number)
        log.sync()
    log.close()
    segment, = read_chain(str(folder)).segments
    change(segment.path, places(segment)[3])
    change(segment.path, places(segment)[5] + logs.FRAME_BYTES)
    assert found(folder) == ([1, 2, 4, 6, 7], [Hole(3, 3), Hole(5, 5)], [])
    begun(folder).close()
    assert found(folder) == ([1, 2, 4, 6, 7], [Hole(3, 3), Hole(5, 5)], [])


def test_after_a_gap_in_what_was_not_proven_nothing_counts(folder):
    """A power cut may leave any of the latest writes; none of them was acknowledged."""
    log = begun(folder)
    add(log, 1)
    log.sync()
    add(log, 2, 3, 4)
    log.close()
    segment, = read_chain(str(folder)).segments
    change(segment.path, places(segment)[3])
    assert found(folder) == ([1, 2], [], [])
    log = begun(folder)
    add(log, 3)
    log.close()
    assert found(folder) == ([1, 2, 3], [], [])


def test_a_segment_that_lost_its_end_is_damaged(folder):
    log = begun(folder)
    add(log, 1, 2, 3)
    log.sync()
    log.begin()
    log.close()
    first, _ = read_chain(str(folder)).segments
    os.truncate(first.path, places(first)[2] + 5)
    assert found(folder) == ([1], [Hole(2, 3)], [])


def test_a_damaged_head_is_read_from_the_summary(folder):
    begun(folder).close()
    log = begun(folder)
    add(log, 1)
    log.close()
    change(read_chain(str(folder)).segments[-1].path, 20)
    assert found(folder) == ([1], [], [])


@pytest.mark.parametrize("lost, left, hole, problem", [
    (0, [2, 3, 4, 5, 6], [Hole(1, 1)], "the segment before journal-000002-"),
    (1, [1, 2, 4, 5, 6], [Hole(3, 3)], "the segment before journal-000003-"),
    (2, [1, 2, 3, 4], [], "the newest segment journal-000003-"),
])
def test_a_lost_segment_is_named(folder, lost, left, hole, problem):
    for number in (1, 3, 5):
        log = begun(folder)
        for each in (number, number + 1):
            add(log, each)
            log.sync()
        log.close()
    os.remove(read_chain(str(folder)).segments[lost].path)
    numbers, holes, (text,) = found(folder)
    assert (numbers, holes) == (left, hole)
    assert problem in text


def test_a_draft_that_a_killed_process_left_is_removed(folder):
    begun(folder).close()
    (folder / f"journal-000002-00000001.log{logs.DRAFT}").write_bytes(b"x")
    begun(folder).close()
    assert len(os.listdir(folder)) == 2
