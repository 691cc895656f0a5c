"""The parts of the runs' records that referees see as not saved yet."""

from roah_rsbb.model.records import RunRecord, ScoreEntry, SignOff, StopRecord
from roah_rsbb.scoring.unsaved import SHOWN_AFTER_S, Unsaved, UnsavedParts

FIRST, SECOND = (ScoreEntry(n, 10.0 + n, "/referee", "Achievements", "Objects", 0, n) for n in (1, 2))
STOP = StopRecord(20.0, "/referee", "stopped", "Stopped")
RECORD = RunRecord("HNF-6667-1", "fbm", "HNF", "Alpha", 1, 1, 0.0, 1.0, history=(FIRST,))
LATER = 100.0 + SHOWN_AFTER_S


def parts(entries=(), stops=(), sign_off=False):
    return (UnsavedParts("HNF-6667-1", "fbm", entries, stops, sign_off),)


def test_entries_saved_soon_are_not_shown_as_unsaved():
    unsaved = Unsaved()
    unsaved.changed(100.0, 1, RECORD)
    assert unsaved.look(100.0, 0) == ()
    assert unsaved.look(LATER, 1) == ()


def test_only_unsaved_changes_are_shown():
    unsaved = Unsaved()
    unsaved.restore([RECORD])
    unsaved.changed(100.0, 2, RECORD._replace(history=(FIRST, SECOND)))
    assert unsaved.look(LATER, 1) == parts(entries=(2,))
    unsaved.changed(100.0, 3, RECORD._replace(history=(FIRST, SECOND), stops=(STOP,), sign_off=SignOff(30.0, "chief")))
    assert unsaved.look(LATER, 1) == parts((2,), (1,), True)
    assert unsaved.look(LATER, 2) == parts((), (1,), True)
    assert unsaved.look(LATER, 3) == ()


def test_a_withdrawal_and_a_reason_that_are_not_saved():
    unsaved = Unsaved()
    whole = RECORD._replace(history=(FIRST, SECOND), stops=(STOP,))
    unsaved.changed(100.0, 1, whole)
    assert unsaved.look(LATER, 1) == ()
    withdrawn = FIRST._replace(withdrawn_utc=40.0, withdrawn_by="/referee")
    unsaved.changed(100.0, 2, whole._replace(history=(withdrawn, SECOND), stops=(STOP._replace(reason="fire"),)))
    assert unsaved.look(LATER, 1) == parts((1,), (1,))


def test_a_change_of_nothing_that_a_referee_did_is_not_shown():
    unsaved = Unsaved()
    unsaved.restore([RECORD])
    unsaved.changed(100.0, 2, RECORD._replace(elapsed_s=7.0))
    assert unsaved.look(LATER, 0) == ()
