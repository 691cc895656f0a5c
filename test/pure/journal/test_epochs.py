"""Epochs in the journal: who is the box, after takeovers in any order."""

import pathlib

import pytest

from helpers.competition import run_record
from helpers.journals import UTC0, Writer, spoil
from roah_rsbb.journal.contents import BoxEpoch, open_journal, superseded_value
from roah_rsbb.journal.epochs import hand_over, raise_epoch, standing_in
from roah_rsbb.journal.reader import JournalReader
from roah_rsbb.journal.records import Kind


class Box:
    """A box that ends before another program changes its journal."""

    def __init__(self, log_dir):
        self._log_dir, self._utc = log_dir, UTC0
        self.path = self.writes(lambda writer: (writer.run(run_record()), writer.entry("/notification", "now")))

    def writes(self, write):
        writer = Writer(self._log_dir)
        writer.utc = self._utc
        write(writer)
        writer.close()
        self._utc = writer.utc
        return writer.path

    def superseded(self, epoch, cut):
        value = superseded_value(epoch, cut, "10.0.0.3")
        self.writes(lambda writer: writer.entry(Kind.EPOCH, value, port=None))

    @property
    def last(self):
        """The number of the newest record."""
        return open_journal(self.path).newest.last

    def only_here(self):
        return JournalReader(self.path).only_here()


@pytest.fixture
def box(tmp_path):
    return Box(tmp_path)


def test_a_journal_of_which_nobody_took_over(box, tmp_path):
    assert standing_in(box.path) == BoxEpoch(1)
    assert standing_in(str(tmp_path / "missing")) == BoxEpoch(1)
    (tmp_path / "nonsense").mkdir()
    (tmp_path / "nonsense" / "journal-000001-00000001.log").write_bytes(b"nonsense" * 1000)
    assert standing_in(str(tmp_path / "nonsense")) == BoxEpoch(1)


def test_a_takeover_raises_the_epoch(box):
    first = box.last
    assert raise_epoch(box.path, UTC0 + 100.0, "second") == BoxEpoch(2, cut=first) == standing_in(box.path)
    assert open_journal(box.path).segments[-1].head.epoch == 2
    box.writes(lambda writer: writer.entry("/notification", "later"))
    second = box.last
    assert raise_epoch(box.path, UTC0 + 200.0, "third") == BoxEpoch(3, cut=second) == standing_in(box.path)


def test_the_epoch_of_a_segment_counts_even_if_its_entry_is_damaged(box):
    cut = box.last
    raise_epoch(box.path, UTC0 + 100.0, "second")
    spoil(box.path, b'{"epoch"')
    assert open_journal(box.path).contents.standing == BoxEpoch(2, cut=cut)


def test_a_standing_that_changes_while_it_is_looked_at(box):
    """It is read once a second; what was read before is not read again."""
    writer = Writer(box._log_dir)
    for _ in range(3):
        writer.entry("/notification", "x" * 1000)
        assert not standing_in(box.path).is_superseded
    writer.entry(Kind.EPOCH, superseded_value(2, 1, "10.0.0.3"), port=None)
    assert standing_in(box.path) == BoxEpoch(1, 2, 1, "10.0.0.3")
    writer.close()
    assert standing_in(box.path) == BoxEpoch(1, 2, 1, "10.0.0.3")
    segment = max(pathlib.Path(box.path).glob("*.log"))
    content = segment.read_bytes()
    segment.write_bytes(content[:content.index(b'{"superseded_by"')])  # an earlier copy in its place
    assert standing_in(box.path) == BoxEpoch(1)


def test_a_superseded_box(box):
    cut = box.last
    box.superseded(2, cut)
    box.writes(lambda writer: writer.entry("/notification", "only here", identity=run_record().identity))
    standing = standing_in(box.path)
    assert standing == BoxEpoch(1, 2, cut, "10.0.0.3") and standing.is_superseded
    assert box.only_here() == [(run_record().identity, 1)]


def test_a_box_that_hands_over(box):
    cut = box.last
    assert hand_over(box.path, UTC0, "10.0.0.3") == BoxEpoch(1, 2, cut, "10.0.0.3") == standing_in(box.path)


def test_a_superseded_box_takes_over_again(box):
    box.superseded(2, cut=1)
    cut = box.last
    assert raise_epoch(box.path, UTC0, "first") == BoxEpoch(3, cut=cut)
    assert box.only_here() == []
    box.superseded(2, cut=1)  # late
    assert not standing_in(box.path).is_superseded
    box.superseded(4, cut=2)
    assert standing_in(box.path).superseded_by == 4


@pytest.mark.parametrize("value", ["no object", [], {"epoch": "no number"}, {"superseded_by": None}, 5, None])
def test_entries_that_say_nothing(box, value):
    raise_epoch(box.path, UTC0, "second")
    box.writes(lambda writer: writer.entry(Kind.EPOCH, value, port=None))
    assert standing_in(box.path).epoch == 2 and not standing_in(box.path).is_superseded
