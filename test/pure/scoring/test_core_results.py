"""Finished runs, what the referee may still change in them, and what is shown as not saved yet."""

from dataclasses import replace

import pytest

from helpers.box_driver import BoxDriver, public_document
from helpers.competition import BUMPS, DOOR, OBJECTS, UTC0, competition, event, run_record
from roah_rsbb.core.settings import Settings
from roah_rsbb.model.as_json import from_json, to_json
from roah_rsbb.model.clock import Now
from roah_rsbb.model.reason import Refused, RunName
from roah_rsbb.model.records import By, RunRecord, ScoreEntry, SheetPoints, SignOff, StopRecord
from roah_rsbb.rulebook.benchmarks import NO_RULES, CountingAttempt
from roah_rsbb.rulebook.standing_rules import BY_POINTS
from roah_rsbb.scoring import book, counting
from roah_rsbb.scoring.book import MAX_KEPT, FinishedRuns, left_behind
from roah_rsbb.scoring.counting import RunChoice, Why, rulings
from roah_rsbb.scoring.sheet import Mark
from roah_rsbb.scoring.unsaved import SHOWN_AFTER_S, Unsaved, UnsavedParts
from roah_rsbb.wording import times

BENCHMARKS = competition(tbm=["HGTKMH"]).benchmarks
NOW = Now(5000.0, UTC0 + 4000.0)
OF_ATTEMPTS = counting._of_attempts


def _kept(driver):
    return [(run.zone, run.benchmark, run.end_reason) for run in driver.box.finished.records()]


def _runs(*records):
    runs = FinishedRuns(BENCHMARKS)
    for record in records:
        runs.add(record)
    return runs


# -- which runs are kept ----------------------------------------------------------------------------


def test_a_run_is_kept_with_its_score_when_it_is_left():
    driver = BoxDriver()
    driver.executing().completes()
    assert _kept(driver) == []
    driver.score(DOOR.group, DOOR.desc, 1)
    driver.run(10.0)
    driver.command("disconnect")
    (run,) = driver.box.finished.records()
    planned = driver.box.zones["tbm"].event
    assert (run.zone, run.event, run.run, run.end_reason) == ("tbm", planned.id, planned.run, "completed")
    assert run.closed_utc == driver.now.utc
    assert {item.desc: item.value for item in run.items} == {DOOR.desc: 1, OBJECTS.desc: 0, BUMPS.desc: 0}
    assert run.module_scores == ()


def test_what_was_entered_for_a_run_is_kept_though_it_was_never_started():
    """Its start may be what a power failure took."""
    driver = BoxDriver()
    driver.connected()
    driver.score(*BUMPS.key, 2)
    identity = driver.run_in().identity
    driver.command("disconnect")
    record, = driver.box.finished.records()
    assert (record.identity, record.started_utc) == (identity, 0.0)
    assert {item.desc: item.value for item in record.items}[BUMPS.desc] == 2
    assert driver.box.scores.why(driver.now, identity) is Why.NEVER_STARTED
    assert public_document(driver).public_results == {}
    driver.enter("sign_off", RunName("tbm", identity), "Anna")


def test_a_run_that_is_repeated_is_shown_instead_of_the_one_before_and_both_are_kept():
    driver = BoxDriver(competition(tbm=["HGTKMH"], other=[event("HWV", team="Beta")]))
    driver.executing()
    driver.command("disconnect")
    driver.executing("other", team="Beta", name="r2", host="10.0.0.3")
    driver.command("disconnect", "other")
    driver.executing().completes()
    driver.command("disconnect")
    shown = public_document(driver).results_shown(signed=False)
    assert [(run.event.zone, run.end_reason) for run in shown] == [("tbm", "completed"), ("other", "stopped")]
    assert [record.end_reason for record in driver.box.finished.records()] == ["completed", "stopped", "stopped"]


def test_the_oldest_become_final_where_there_are_too_many():
    runs = _runs(*(run_record(number) for number in range(MAX_KEPT + 2)))
    assert [run.record.run for run in runs.newest_runs()] == list(range(MAX_KEPT + 1, 1, -1))
    assert [run.record.run for run in runs.newest_runs(2)] == [MAX_KEPT + 1, MAX_KEPT]
    with pytest.raises(Refused, match=f"newest {MAX_KEPT} runs"):
        runs.find(run_record(1).identity)


def test_a_run_counts_however_many_followed_it(monkeypatch):
    """The decision and the numbers are the same whether a run can still be corrected or not."""
    rules = {"HGTKMH": replace(NO_RULES, counting=CountingAttempt.BEST)}
    attempts = [
        run_record(opened_utc=UTC0 + n, identity=f"HGTKMH {n}", event="e", points=SheetPoints(points, ()))
        for n, points in enumerate(("3", "9", "5", "1", "2"))
    ]

    def ruled():
        ruled = rulings(_runs(*attempts).records()[::-1], {}, RunChoice(events=rules))
        return [(r.record.identity, r.why, r.numbers(BY_POINTS)) for r in ruled]

    expected = ruled()
    assert [why for _, why, _ in expected] == [
        Why.NOT_BEST, Why.COUNTS, Why.NOT_BEST, Why.NOT_BEST, Why.NOT_BEST]
    monkeypatch.setattr(book, "MAX_KEPT", 1)
    assert ruled() == expected


def test_only_events_of_which_a_run_changed_are_decided_again(monkeypatch):
    """It would take longer with each run of the competition, and STOP in other zones would wait for it."""
    driver = BoxDriver(competition(tbm=[event(run=run) for run in range(1, 6)], other=[event("HWV", team="Beta")]))
    for _ in range(4):
        driver.executing().completes()
        driver.command("disconnect")
    assert driver.box.zones["tbm"].event.run == 5
    driver.executing("other", team="Beta", name="r2", host="10.0.0.3")
    before = driver.box.scores.rulings(driver.now)
    decided = []
    monkeypatch.setattr(counting, "_of_attempts", lambda attempts, *rules: decided.append(attempts) or OF_ATTEMPTS(
        attempts, *rules))
    driver.run(5.0)
    driver.score(BUMPS.group, BUMPS.desc, 1, "other")
    after = driver.box.scores.rulings(driver.now)
    assert [[record.benchmark for record in attempts] for attempts in decided] == [["HWV"]]
    assert after[:-1] == before[:-1] and after[-1] != before[-1]


def test_attempts_are_limited_however_many_runs_followed(monkeypatch):
    monkeypatch.setattr(book, "MAX_KEPT", 1)
    once = replace(NO_RULES, attempts=1)
    events = [event(run=run, rules=once) for run in (1, 2)]
    driver = BoxDriver(competition(tbm=events), Settings(auto_next=False))
    for way in ("next", "previous"):
        driver.executing().completes()
        driver.command("disconnect")
        driver.command(way)
    assert driver.off("connect") and "The only attempt" in driver.off("connect")[0]


# -- restart ----------------------------------------------------------------------------------------


def test_after_a_restart_they_are_there_again_the_last_one_first():
    records = [run_record(number) for number in (3, 1, 2)]
    runs = FinishedRuns(BENCHMARKS)
    runs.restore(records)
    assert [record.run for record in runs.records()] == [3, 2, 1]


def test_runs_that_were_not_left_or_never_started_are_not_over():
    runs = FinishedRuns(BENCHMARKS)
    runs.restore([run_record(1, closed_utc=0.0), run_record(2, end_reason=""), run_record(3)])
    assert [record.run for record in runs.records()] == [3]


def test_a_run_interrupted_by_a_restart_counts_as_stopped_at_the_restart():
    in_progress = run_record(1, closed_utc=0.0, end_reason="", stops=(), elapsed_s=12.0)
    left = left_behind(in_progress, UTC0 + 50.0)
    assert (left.closed_utc, left.end_reason, left.elapsed_s) == (UTC0 + 50.0, "stopped", 12.0)
    assert [stop[:4] for stop in left.stops] == [
        (UTC0 + 50.0, "", "stopped", "The run did not continue after a restart of the core")
    ]
    ended = run_record(1, closed_utc=0.0, end_reason="timeout")
    assert left_behind(ended, UTC0 + 50.0) == ended._replace(closed_utc=UTC0 + 50.0)
    never = run_record(1, closed_utc=0.0, end_reason="", started_utc=0.0, stops=())
    assert left_behind(never, UTC0 + 50.0).end_reason == ""


def test_a_removed_benchmark_is_shown_by_its_code():
    driver = BoxDriver()
    driver.box.finished.add(run_record(benchmark="HOLD"))
    (result,) = public_document(driver).results_shown(signed=False)
    assert result.event.benchmark == "HOLD"


# -- corrections ------------------------------------------------------------------------------------


def test_a_withdrawal_and_not_attempted_are_corrections_too():
    runs = _runs(run_record(1))
    run = runs.find(runs.records()[0].identity)
    run.mark(NOW, "Ben", Mark(OBJECTS.group, OBJECTS.desc, not_attempted=True))
    assert [(item.not_attempted, item.corrected) for item in run.record.items][1] == (True, True)
    text = run.withdraw_score(NOW, By("Cleo", "it did try"), 1)
    assert text == "Correction: Score: Achievements: changed objects not attempted -> 0 (entry 1 withdrawn, it did try)"
    assert [(item.not_attempted, item.corrected) for item in run.record.items][1] == (False, False)
    assert run.record.history[0].withdrawal_corrects


def test_the_sheet_of_a_run_keeps_its_items():
    other = competition(tbm=[event(scoring=())]).benchmarks
    runs = FinishedRuns(other)
    runs.add(run_record(1))
    run = runs.find(run_record(1).identity)
    run.mark(NOW, "Ben", Mark(DOOR.group, DOOR.desc, 1))
    assert [item.value for item in run.record.items] == [1, 0, 0]
    with pytest.raises(Refused, match="is yes or no"):
        run.mark(NOW, "Ben", Mark(DOOR.group, DOOR.desc, 2))


def test_a_signed_off_sheet_is_final():
    runs = _runs(run_record(1))
    run = runs.find(run_record(1).identity)
    run.mark(NOW, "Ben", Mark(BUMPS.group, BUMPS.desc, 2))
    for nameless in ("", "/roah_rsbb_window"):
        with pytest.raises(Refused, match="needs the name of the referee"):
            run.sign_off(NOW, nameless)
    assert run.record.sign_off is None
    run.sign_off(NOW, "Cleo")
    signed = run.record
    assert signed.sign_off == SignOff(NOW.utc, "Cleo")
    again = FinishedRuns(BENCHMARKS)
    again.restore([from_json(type(signed), to_json(signed))])
    for finished in (run, again.find(signed.identity)):
        for change in (
            lambda run: run.mark(NOW, "Ben", Mark(BUMPS.group, BUMPS.desc, 3)),
            lambda run: run.withdraw_score(NOW, By("Ben"), 1),
            lambda run: run.give_stop_reason(NOW, By("Ben", "x"), 0),
            lambda run: run.sign_off(NOW, "Ben"),
        ):
            with pytest.raises(Refused, match=f"signed off by Cleo at {times.at_venue(NOW.utc)}: it is final"):
                change(finished)
        assert finished.record == signed


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
    unsaved, whole = Unsaved(), RECORD._replace(stops=(STOP,))
    unsaved.restore([whole])
    unsaved.changed(100.0, 2, whole._replace(elapsed_s=7.0))
    assert unsaved.look(LATER, 0) == ()


def test_of_a_run_that_is_not_saved_all_is_shown():
    unsaved = Unsaved()
    unsaved.changed(100.0, 1, RECORD._replace(history=(FIRST,), stops=(STOP,)))
    assert unsaved.look(LATER, 0) == parts((1,), (1,))
