"""Run logs that a killed process left open are repaired at the next start. Nothing else is changed."""

from helpers.bags import NAME, entries, plain, read, rosbag
from helpers.run_log_loop import OTHER, PORT, Loop, complete
from roah_rsbb.run_logs.bag_file import DRAFT, GrowingBag, write_whole
from roah_rsbb.run_logs.messages import message_of


def left_open(path, count):
    path.parent.mkdir(exist_ok=True)
    bag = GrowingBag(str(path))
    for entry in entries(count):
        bag.write(message_of(entry))
    bag.abandon()
    return path


def name(number):
    return NAME.replace("_run1_", f"_run{number}_")


def test_logs_that_were_left_open_are_indexed_again(loop, log_dir):
    paths = [left_open(log_dir / name(number), number) for number in range(1, 4)]
    loop.writer.repair({})
    for number, path in enumerate(paths, 1):
        assert complete(path) == plain(entries(number))
    assert sorted(log_dir.iterdir()) == paths
    assert loop.troubles == []


def test_of_runs_in_the_journal_the_whole_log_is_written(loop, log_dir):
    path = left_open(log_dir / NAME, 2)
    loop.journal[PORT] = entries(5)
    loop.writer.repair({PORT: f"/elsewhere/{NAME}", OTHER: str(log_dir / name(2))})
    loop.answer()
    assert complete(path) == plain(entries(5))
    loop.settle()
    assert sorted(log_dir.iterdir()) == [path]


def _untouched(path):
    """Return values that change when a file is written, but not when it is read."""
    status = path.stat()
    return status.st_ino, status.st_size, status.st_mtime_ns


def test_only_our_own_unclosed_logs_without_a_writer_are_repaired(loop, log_dir, tmp_path):
    closed = log_dir / name(1)
    log_dir.mkdir()
    write_whole(str(closed), entries(2))
    before = _untouched(closed)
    foreign = left_open(log_dir / "somebody_elses.bag", 2)
    torn = foreign.read_bytes()
    another_core = Loop(log_dir)
    live = another_core.open()
    another_core.log(entries(2))
    another_core.settle()
    loop.journal[PORT] = entries(2)
    loop.writer.resumed(PORT, name(3))
    own = left_open(log_dir / name(3), 1)
    (log_dir / name(4)).mkdir()
    last = left_open(log_dir / name(9), 4)
    draft = log_dir / (name(5) + DRAFT)
    draft.write_bytes(b"half of one")
    other_draft = log_dir / ("notes" + DRAFT)
    other_draft.write_text("notes")

    loop.writer.repair({PORT: str(own)})
    assert complete(last) == plain(entries(4))
    loop.settle()
    assert _untouched(closed) == before
    assert foreign.read_bytes() == torn
    assert not draft.exists() and other_draft.exists()
    another_core.log(entries(2, first=2))
    another_core.close()
    assert complete(live) == plain(entries(4))
    another_core.writer.stop()
    assert another_core.troubles == []
    loop.answer()
    loop.log(entries(2, first=2))
    loop.close()
    assert complete(own) == plain(entries(4))
    assert loop.troubles == []


def test_a_log_that_cannot_be_repaired_stays_and_is_reported(loop, log_dir):
    log_dir.mkdir()
    (log_dir / name(1)).write_text("no bag")
    after = left_open(log_dir / name(2), 3)
    loop.writer.repair({})
    assert complete(after) == plain(entries(3))
    assert len(loop.troubles) == 1
    assert str(log_dir / name(1)) in loop.troubles[0] and "rosbag reindex" in loop.troubles[0]
    assert (log_dir / name(1)).read_text() == "no bag"


def test_of_a_damaged_log_what_can_be_read_is_saved_and_all_of_it_kept(loop, log_dir):
    path = left_open(log_dir / NAME, 3)
    data = path.read_bytes() + b"\xee" * 100
    path.write_bytes(data)
    loop.writer.repair({})
    loop.wait(loop.troubles)
    assert complete(path) == plain(entries(3))
    kept = log_dir / (NAME + ".damaged")
    assert kept.read_bytes() == data
    assert str(kept) in loop.troubles[0] and "rosbag reindex" in loop.troubles[0]


def test_runs_are_logged_before_old_logs_are_repaired(loop, log_dir):
    for number in range(2, 40):
        left_open(log_dir / name(number), 50)
    path = loop.open()
    loop.writer.repair({})
    loop.log(entries(100))
    loop.settle()
    assert not complete_yet(log_dir / name(39))
    loop.close()
    assert complete(path) == plain(entries(100))
    assert complete(log_dir / name(39)) == plain(entries(50))


def complete_yet(path):
    try:
        return bool(read(path))
    except rosbag.ROSBagException:
        return False
