"""Epochs in the journal: who is the box, after takeovers in any order."""

import pytest

from helpers.competition import run_record
from helpers.journals import UTC0, Writer
from roah_rsbb.journal import epochs, kinds
from roah_rsbb.journal.epochs import Standing, raise_epoch, standing_in, superseded_value
from roah_rsbb.journal.previous_session import read_previous_session


@pytest.fixture
def writer(tmp_path):
    made = Writer(tmp_path)
    made.run(run_record())
    made.entry("/notification", "now")
    yield made
    made.journal.close()


def supersede(writer, epoch, cut):
    writer.entry(kinds.EPOCH, superseded_value(epoch, cut, "10.0.0.3"), port=None)


def test_a_journal_of_which_nobody_took_over(writer, tmp_path):
    assert standing_in(writer.path) == Standing(1)
    assert standing_in(str(tmp_path / "missing")) == Standing(1)
    (tmp_path / "nonsense").write_bytes(b"nonsense" * 1000)
    assert standing_in(str(tmp_path / "nonsense")) == Standing(1)


def test_a_takeover_raises_the_epoch(writer):
    assert raise_epoch(writer.path, UTC0 + 100.0, "second") == Standing(2, cut=1)
    writer.entry("/notification", "later")
    assert raise_epoch(writer.path, UTC0 + 200.0, "third") == Standing(3, cut=3) == standing_in(writer.path)


def test_a_takeover_does_not_change_when_the_core_ended(writer):
    """The runs continue by the clock of the core before."""
    connection = writer.journal._connection
    before = read_previous_session(connection).last
    raise_epoch(writer.path, UTC0 + 5000.0, "second")
    assert read_previous_session(connection).last == before


def test_a_superseded_box(writer):
    supersede(writer, 2, cut=1)
    writer.entry("/notification", "only here", identity=run_record().identity)
    standing = standing_in(writer.path)
    assert standing == Standing(1, 2, 1, "10.0.0.3") and standing.is_superseded
    assert epochs.only_here(writer.journal._connection, standing) == [(run_record().identity, 1)]


def test_a_superseded_box_takes_over_again(writer):
    supersede(writer, 2, cut=1)
    assert raise_epoch(writer.path, UTC0, "first") == Standing(3, cut=2)
    assert epochs.only_here(writer.journal._connection, standing_in(writer.path)) == []
    supersede(writer, 2, cut=1)  # late
    assert not standing_in(writer.path).is_superseded
    supersede(writer, 4, cut=2)
    assert standing_in(writer.path).superseded_by == 4


@pytest.mark.parametrize("value", ["no object", [], {"epoch": "no number"}, {"superseded_by": None}, 5, None])
def test_entries_that_say_nothing(writer, value):
    raise_epoch(writer.path, UTC0, "second")
    writer.entry(kinds.EPOCH, value, port=None)
    assert standing_in(writer.path).epoch == 2 and not standing_in(writer.path).is_superseded
