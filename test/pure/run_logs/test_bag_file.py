"""The file of a run log: written entries survive a kill, and earlier content stays."""

import pathlib
import signal
import subprocess
import sys

import pytest

from helpers.bags import END, NAME, SCORE, STATE, TEXT, UTC, entries, plain, read, rosbag
from roah_rsbb.model.run_log import LogKind
from roah_rsbb.run_logs.bag_file import DAMAGED, DRAFT, GrowingBag, write_whole
from roah_rsbb.run_logs.messages import HEADERS, message_of
from roah_rsbb.run_logs.salvage import NotABag, Salvage, is_closed

ALL_KINDS = [(STATE, 3, UTC), (TEXT, "Grüße", UTC), (SCORE, ["Group", "Item", -2], UTC + 1), (END, None, UTC + 1)]


@pytest.fixture
def path(tmp_path):
    return tmp_path / NAME


def grown(path, logged, chunks=3):
    """An unclosed bag of a killed process."""
    bag = GrowingBag(str(path))
    for number, entry in enumerate(logged):
        bag.write(message_of(entry))
        if number % chunks == chunks - 1:
            bag.flush()
    bag.abandon()
    return path


def salvaged(path):
    with open(str(path), "rb") as file:
        salvage = Salvage(file)
        return [(message.topic, message.stamp) for message in salvage], salvage.damage


def test_a_whole_log_holds_entries_of_all_kinds_in_their_order(path):
    write_whole(str(path), ALL_KINDS)
    assert read(path) == [(STATE, 3), (TEXT, "Grüße"), (SCORE, ("Group", "Item", -2)), (END, None)]
    with rosbag.Bag(str(path)) as bag:
        kinds = bag.get_type_and_topic_info().topics
        assert kinds[SCORE].msg_type == "roah_rsbb/Score"
        assert abs(bag.get_start_time() - UTC) < 1e-6
    assert not path.with_name(path.name + DRAFT).exists()


def test_entries_of_one_moment_stay_in_their_order(path):
    logged = [(topic, value, UTC) for topic, value in ((END, None), (TEXT, "b"), (STATE, 1), (TEXT, "a"), (END, None))]
    write_whole(str(path), logged)
    assert read(path) == plain(logged)


def test_an_entry_that_no_message_can_hold_is_left_out(path):
    write_whole(str(path), [(STATE, 300, UTC), ("/unknown", 1, UTC), (STATE, "text", UTC), (SCORE, ["a"], UTC),
                            (STATE, 1, -1.0), (TEXT, "good", UTC)])
    assert read(path) == [(TEXT, "good")]


def test_a_whole_log_continues_in_its_file(path):
    bag, _ = write_whole(str(path), entries(5), stays_open=True)
    bag.write(message_of(entries(1, first=5)[0]))
    bag.close()
    assert read(path) == plain(entries(6))


@pytest.mark.parametrize("closed", [False, True])
def test_existing_entries_are_not_written_twice(path, closed):
    if closed:
        write_whole(str(path), entries(7))
    else:
        grown(path, entries(7))
    write_whole(str(path), entries(9))
    assert read(path) == plain(entries(9))


def test_equal_entries_are_all_kept(path):
    same = [(TEXT, "same", UTC + number) for number in range(3)]
    grown(path, same)
    write_whole(str(path), same[:2])
    assert read(path) == plain(same)


def test_what_was_there_and_is_in_no_journal_stays_where_it_was(path):
    grown(path, entries(7))
    _, kept = write_whole(str(path), entries(2) + entries(3, first=4))
    assert read(path) == plain(entries(7))
    assert kept == ""


def test_every_torn_file_costs_only_the_torn_entry(path):
    whole = [(topic, stamp) for topic, stamp in salvaged(grown(path, entries(12)))[0]]
    data = path.read_bytes()
    begin = 4096
    counts = set()
    for size in [0, 5, 13, 100, *range(begin, len(data), 7)]:
        path.write_bytes(data[:size])
        found, damage = salvaged(path)
        assert damage == ""
        assert found == whole[:len(found)]
        # Every message whose last byte is there is found.
        assert len(found) == sum(1 for number in range(12) if _end(data, number) <= size)
        counts.add(len(found))
    assert counts == set(range(13))


def _end(data, number):
    text = f"entry {number}".encode()
    return data.index(bytes([len(text), 0, 0, 0]) + text) + 4 + len(text)


@pytest.mark.parametrize("size", [0, 7, 13, 4000, 5000])
def test_a_torn_file_becomes_a_bag(path, size):
    data = grown(path, entries(12)).read_bytes()
    path.write_bytes(data[:size])
    found = salvaged(path)[0]
    write_whole(str(path), ())
    assert read(path) == plain(entries(len(found)))


def test_zeros_at_the_end_as_after_a_power_cut_are_not_damage(path):
    grown(path, entries(4))
    with open(str(path), "ab") as file:
        file.write(bytes(100_000))
    _, kept = write_whole(str(path), ())
    assert (read(path), kept) == (plain(entries(4)), "")


def test_of_a_damaged_file_all_that_can_be_read_is_saved_and_all_of_it_kept(path):
    data = bytearray(grown(path, entries(12)).read_bytes())
    at = _end(data, 5)
    data[at:at + 40] = b"\xee" * 40
    path.write_bytes(data)
    for number in ("", "2"):
        _, kept = write_whole(str(path), ())
        assert read(path) == plain(entries(6))
        assert kept == str(path) + DAMAGED + number
        assert pathlib.Path(kept).read_bytes() == data
        path.write_bytes(data)


def test_of_a_damaged_file_nothing_is_missing_that_the_journal_has(path):
    data = bytearray(grown(path, entries(12)).read_bytes())
    data[_end(data, 5):] = b"\xee" * 400
    path.write_bytes(data)
    _, kept = write_whole(str(path), entries(12))
    assert read(path) == plain(entries(12))
    assert pathlib.Path(kept).read_bytes() == data


def test_a_file_that_is_not_a_bag_is_left_alone(path):
    path.write_text("notes of a referee")
    with pytest.raises(NotABag):
        write_whole(str(path), ())
    assert path.read_text() == "notes of a referee"
    assert list(path.parent.iterdir()) == [path]
    _, kept = write_whole(str(path), entries(1))
    assert pathlib.Path(kept).read_text() == "notes of a referee"
    assert read(path) == plain(entries(1))


def test_a_log_of_another_version_is_kept_beside_the_new_one(path, monkeypatch):
    monkeypatch.setitem(HEADERS, LogKind.SCORE, {**HEADERS[LogKind.SCORE], "md5sum": b"0" * 32})
    grown(path, [(SCORE, ["g", "i", 1], UTC)])
    monkeypatch.undo()
    _, kept = write_whole(str(path), [(SCORE, ["g", "i", 2], UTC)])
    assert read(path) == [(SCORE, ("g", "i", 2))]
    assert salvaged(kept)[0] == [(SCORE, (int(UTC), 250000000))]


def test_when_it_cannot_be_rewritten_the_old_file_stays(path, monkeypatch):
    before = grown(path, entries(5)).read_bytes()

    def full(*_):
        raise OSError(28, "No space left on device")

    for step in ("write", "settle", "move"):
        with monkeypatch.context() as context:
            context.setattr(GrowingBag, step, full)
            with pytest.raises(OSError, match="No space"):
                write_whole(str(path), entries(9), stays_open=True)
        assert path.read_bytes() == before
        assert list(path.parent.iterdir()) == [path]


def test_whether_a_bag_is_closed(path):
    def closed():
        with open(str(path), "rb") as file:
            return is_closed(file)

    data = grown(path, entries(3)).read_bytes()
    assert not closed()
    for size in (0, 5, 15, 40, 4100):
        path.write_bytes(data[:size])
        assert not closed()
    path.write_text("notes of a referee")
    assert not closed()
    path.unlink()
    write_whole(str(path), entries(3))
    assert closed()
    path.write_bytes(path.read_bytes()[:4200])
    assert not closed()


def test_a_bag_knows_that_its_file_was_removed_or_replaced(path):
    bag = GrowingBag(str(path))
    assert bag.is_in_place()
    path.rename(path.with_suffix(".elsewhere"))
    assert not bag.is_in_place()
    path.touch()
    assert not bag.is_in_place()
    bag.abandon()


def test_no_log_is_written_over(path):
    write_whole(str(path), entries(1))
    with pytest.raises(FileExistsError):
        GrowingBag(str(path))
    assert read(path) == plain(entries(1))


WRITER = """
import sys
sys.path[:0] = {paths!r}
import roah_rsbb
roah_rsbb.__path__ = {package!r}
from helpers.bags import entries
from roah_rsbb.run_logs.bag_file import GrowingBag
from roah_rsbb.run_logs.messages import message_of
bag = GrowingBag(sys.argv[1])
for number, entry in enumerate(entries(100_000)):
    bag.write(message_of(entry))
    print(number, flush=True)
    if number % 20 == 19:
        bag.flush()
"""


@pytest.mark.parametrize("lines", [1, 20, 130])
def test_a_process_that_is_killed_loses_nothing_that_it_had_written(path, lines):
    import roah_rsbb
    code = WRITER.format(paths=sys.path, package=list(roah_rsbb.__path__))
    with subprocess.Popen([sys.executable, "-c", code, str(path)], stdout=subprocess.PIPE, text=True) as process:
        for _ in range(lines):
            process.stdout.readline()
        process.send_signal(signal.SIGKILL)
    write_whole(str(path), ())
    found = read(path)
    assert len(found) >= lines
    assert found == plain(entries(len(found)))
