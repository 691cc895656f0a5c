"""Box and standby as two linked ends: the copy is right whatever is lost, and whenever."""

import contextlib
import pathlib
import tempfile
from unittest import mock

import pytest
from hypothesis import given
from hypothesis import strategies as st

from helpers.competition import run_record
from helpers.copied import COMPETITION, contents
from helpers.examples import examples
from helpers.journals import Writer
from roah_rsbb.ground.linux import boot_id
from roah_rsbb.journal import copy_follower
from roah_rsbb.journal.copy_folder import CannotWriteCopy, Part
from roah_rsbb.journal.copy_follower import Follower
from roah_rsbb.journal.log_dir import JOURNAL
from roah_rsbb.model.messages import LinkSample
from roah_rsbb.standby.beside_copy import SAMPLES, Ahead, ahead_of
from roah_rsbb.standby.channel import BadMessage, decode, encode
from roah_rsbb.standby.remote import BEAT_S, Receiver, RemoteCopy


class Link:
    """Connects both ends, with the messages as bytes. `faults` says for each message what happens to it."""

    def __init__(self, receiver):
        self.receiver = receiver
        self.faults = []
        self.is_down = False
        self.passing_s = BEAT_S  # from one look at the clock to the next
        self._mono = 0.0

    def now(self):
        self._mono += self.passing_s
        return self._mono

    def open_copy(self):
        return RemoteCopy(lambda message: self.request(message), self.now)

    def request(self, message):
        fault = self.faults.pop(0) if self.faults else ""
        if self.is_down or fault == "lost":
            raise CannotWriteCopy("lost")
        answer = self._answer(message)
        if fault == "doubled":
            answer = self._answer(message)
        if fault == "standby restarts":
            self.receiver.close()
        if fault == "answer lost":
            raise CannotWriteCopy("answer lost")
        return answer

    def _answer(self, message):
        return decode(encode(self.receiver.answer(decode(encode(message)))))


class Pair:
    def __init__(self, folder):
        self.log_dir, self.far = folder / "log", folder / "far"
        self.far.mkdir()
        self.writer = Writer(self.log_dir, COMPETITION)
        self.receiver = Receiver(str(self.far))
        self.link = Link(self.receiver)
        self.follower = Follower(str(self.log_dir), self.link.open_copy)

    def close(self):
        self.follower.close()
        self.receiver.close()
        self.writer.journal.close()

    def is_complete(self):
        self.follower.step()
        return not self.follower.progress.trouble and contents(self.far) == contents(self.log_dir)


@pytest.fixture
def ends(tmp_path):
    made = Pair(tmp_path)
    yield made
    made.close()


def files_in(folder):
    return {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}


FAULTS = st.sampled_from(["", "", "", "lost", "answer lost", "doubled", "standby restarts"])


@examples(60)
@given(st.lists(st.sampled_from([
    "entry", "link", "outcome", "step", "step", "down", "up", "box restarts", "core restarts"]), max_size=30),
    st.lists(FAULTS, max_size=60))
def test_no_fault_of_the_link_makes_a_wrong_copy(story, faults):
    with tempfile.TemporaryDirectory() as folder, mock.patch.object(copy_follower, "PART_BYTES", 300), \
            contextlib.closing(Pair(pathlib.Path(folder))) as ends:
        ends.link.faults = list(faults)
        ends.writer.run(run_record())
        for number, what in enumerate(story):
            if what == "entry":
                for _ in range(4):
                    ends.writer.entry("/notification", number, identity=run_record().identity)
            elif what == "link":
                ends.writer.link(LinkSample(float(number)))
            elif what == "outcome":
                ends.writer.entry("command", {}, identity=run_record().identity)
                ends.writer.outcome(run_record(elapsed_s=float(number)))
            elif what == "step":
                ends.follower.step()
            elif what == "box restarts":
                ends.follower.close()
                ends.follower = Follower(str(ends.log_dir), ends.link.open_copy)
            elif what == "core restarts":
                ends.writer.close()
                ends.writer = Writer(ends.log_dir, COMPETITION)
            else:
                ends.link.is_down = what == "down"
        ends.link.is_down, ends.link.faults = False, []
        for _ in range(2):  # the first attempt may find that the other end restarted
            ends.follower.step()
        assert ends.is_complete()
        assert not [path for path in ends.far.iterdir() if "_aside_" in path.name]


def test_the_standby_reports_its_own_trouble(ends):
    assert ends.is_complete()
    ends.far.rename(ends.far.with_name("away"))
    ends.follower.step()
    assert "the standby reports: it was removed" in ends.follower.progress.trouble
    ends.far.with_name("away").rename(ends.far)
    assert ends.is_complete()


@pytest.mark.parametrize("version", [2, [5, 2], [4, 1], None])
def test_another_version_of_the_program(ends, version):
    """Both computers say so, and nothing is written."""
    request = ends.link.request
    ends.link.request = lambda message: request({**message, "version": version})
    ends.follower.step()
    assert "the standby reports: box and standby have different versions" in ends.follower.progress.trouble
    assert list(ends.far.iterdir()) == []


def test_the_difference_between_the_clocks(tmp_path):
    """The message that took the shortest time counts, and a clock that is set."""
    clocks, monos = {"box": 1000.0, "standby": 1007.0}, iter(range(1000))
    receiver = Receiver(str(tmp_path), lambda: clocks["standby"], lambda: 500.0 + clocks["box"])
    copy = RemoteCopy(lambda message: decode(encode(receiver.answer(decode(encode(message))))),
                      monos.__next__, lambda: clocks["box"])
    here = boot_id()
    assert ahead_of(str(tmp_path), here, here).utc_s == 7.0
    for late_s in (3.0, 0.5, 2.0):
        clocks["standby"] = clocks["box"] + late_s
        copy.check()
    assert ahead_of(str(tmp_path), here, here).utc_s == 0.5
    clocks["standby"] = clocks["box"] + 60.0
    for _ in range(SAMPLES):
        copy.check()
    utc_s, mono_s = ahead_of(str(tmp_path), here, here)
    assert utc_s == 60.0 and 1500.0 - next(monos) < mono_s < 1500.0
    assert ahead_of(str(tmp_path), here, "another start") == Ahead(60.0), "this computer was started again"
    assert ahead_of(str(tmp_path), "another start", here) == Ahead(), "the box's computer was"
    assert ahead_of(str(tmp_path / "none"), here, here) == Ahead()
    receiver.close()


def test_files_are_copied_for_their_owner_only(ends):
    (ends.log_dir / "secret").write_text("team: password")
    ends.follower = Follower(str(ends.log_dir), ends.link.open_copy,
                             {"passwords.yaml": str(ends.log_dir / "secret")})
    assert ends.is_complete()
    assert (ends.far / "passwords.yaml").read_text() == "team: password"
    assert (ends.far / "passwords.yaml").stat().st_mode & 0o777 == 0o600


PART = Part("journal-000009-00000001.log", 0, b"x", True)._asdict()


@pytest.mark.parametrize("message", [
    {}, {"do": "x"}, {"do": "write"}, {"do": "write", **PART, "segment": "../x"},
    {"do": "write", **PART, "segment": "journal-000009-00000001.log.new"}, {"do": "write", **PART, "segment": 5},
    {"do": "write", **PART, "at": -1}, {"do": "write", **PART, "at": "0"}, {"do": "write", **PART, "content": "x"},
    {"do": "write", **PART, "is_last": 5}, {"do": "write_files"}, {"do": "write_files", "files": {"../x": b""}},
    {"do": "write_files", "files": {"passwords.yaml": "x"}}, {"do": "write_files", "files": [b""]},
])
def test_nonsense_is_refused_and_writes_nothing(ends, message):
    assert ends.is_complete()
    before = files_in(ends.far.parent)
    with pytest.raises(BadMessage):
        ends.receiver.answer({**message, "utc": 0.0})
    assert files_in(ends.far.parent) == before


def test_a_message_without_a_time(ends):
    assert ends.is_complete()
    with pytest.raises(BadMessage, match="it has no time"):
        ends.receiver.answer({"do": "beat"})


@pytest.mark.parametrize("data", [
    b"", b"[]", b"\xff", b"5", b"[" * 100_000, b'{"x":{"bytes":5}}', b'{"x":{"bytes":5}}\n1234',
    b'{"x":{"bytes":5}}\n123456', b'{"x":{"bytes":-5}}\n', b'{"x":{"bytes":"5"}}\n', b'{"x":5}\n1'])
def test_data_that_cannot_be_read(data):
    with pytest.raises(BadMessage):
        decode(data)


def test_values_pass_unchanged():
    message = {"a": [1, 1.5, None, "\u00e4\n", float("inf")], "b": b"\n\0{}", "c": {"d": b"", "e": b"2"}, "f": [b"3"]}
    assert decode(encode(message)) == message


def test_a_standby_that_answered_lately_is_only_asked_to_write(ends):
    assert ends.is_complete()
    requests, request = [], ends.link.request
    ends.link.request = lambda message: (requests.append(message["do"]), request(message))[1]
    ends.link.passing_s = BEAT_S / 10
    ends.follower.step()
    ends.writer.entry("/notification", 1)
    assert ends.is_complete()
    assert requests == ["write"]
    ends.link.passing_s = BEAT_S
    assert ends.is_complete()
    assert requests == ["write", "beat"]


def test_a_removed_copy_is_not_written(ends):
    assert ends.is_complete()
    ends.link.passing_s = 0.0
    ends.far.rename(ends.far.with_name("away"))
    ends.writer.entry("/notification", 1)
    ends.follower.step()
    assert "the standby reports: it was removed" in ends.follower.progress.trouble


def test_a_part_that_comes_again(ends):
    """It changes nothing, also if it was the last one of a segment."""
    assert ends.is_complete()
    ends.link.faults = ["doubled"] * 100
    for number in range(3):
        ends.writer.entry("/notification", number)
        assert ends.is_complete()
    ends.writer.close()
    ends.writer = Writer(ends.log_dir, COMPETITION)
    assert ends.is_complete()


def test_a_part_that_does_not_continue_the_copy(ends):
    """Something else wrote into the folder of the standby."""
    assert ends.is_complete()
    for path in (ends.far / JOURNAL).iterdir():
        path.write_bytes(b"")
    ends.writer.entry("/notification", 1)
    ends.follower.step()
    assert "the standby reports: it was replaced" in ends.follower.progress.trouble
    assert ends.is_complete()
