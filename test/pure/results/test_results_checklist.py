"""The list for organisers: what is signed off, and what is missing."""

import dataclasses

from helpers.competition import event
from helpers.results_of import UTC0, task_record
from roah_rsbb.model.records import SignOff
from roah_rsbb.results.lists import check_lines, checklist, summary
from roah_rsbb.rulebook.benchmarks import CountingAttempt, EventRules, ZonePlan
from roah_rsbb.scoring.counting import RunChoice, rulings, with_events

SIGNED = SignOff(UTC0 + 5.0, "Anna")


def plan(*runs, zone="tbm"):
    """A zone with these runs of team Alpha, each scheduled as `task_record` has it."""
    return ZonePlan(zone, tuple(planned(run, UTC0 + 3600.0 * run, zone) for run in runs))


def planned(run, scheduled, zone="tbm"):
    return dataclasses.replace(event(team="Alpha", run=run, scheduled=scheduled), id=f"{zone}-{run}-{scheduled}")


def lines(plans, *records, counting=CountingAttempt.LAST, **rules):
    choice = RunChoice(events={"HGTKMH": EventRules(counting=counting, **rules)})
    return checklist(plans, rulings(with_events(records, plans), {}, choice), in_utc=True)


def test_each_event_is_signed_off_or_says_what_is_missing():
    found = lines([plan(1, 2, 3, 4)], task_record("Alpha", 1, sign_off=SIGNED), task_record("Alpha", 2),
                  task_record("Alpha", 3, closed_utc=0.0, end_reason=""))
    assert [(line.is_final, line.number, line.state, line.sheet) for line in found] == [
        (True, 1, "completed, counts", "signed off by Anna at 2025-11-21 11:00:05Z"),
        (False, 2, "completed, counts", "not signed off"),
        (False, 3, "running", "open"), (False, None, "no run", ""),
    ]
    assert summary(found) == "1 of 4 signed off, 2 not signed off, 1 without a run"


def test_of_a_repeated_event_the_last_run_counts():
    again = task_record("Alpha", 1, identity="again")
    (found,) = lines([plan(1)], task_record("Alpha", 1, sign_off=SIGNED), again)
    assert (found.number, found.is_final) == (2, False)
    never_started = again._replace(started_utc=0.0, end_reason="")
    (found,) = lines([plan(1)], task_record("Alpha", 1, sign_off=SIGNED), never_started)
    assert (found.number, found.is_final) == (1, True)


def test_runs_that_the_schedule_does_not_have_follow():
    found = lines([plan(2), plan(1, zone="other")], task_record("Beta", 1, sign_off=SIGNED))
    assert [(line.zone, line.name, line.number) for line in found] == [
        ("other", "HGTKMH, team Alpha, round 1, run 1", None), ("tbm", "HGTKMH, team Alpha, round 1, run 2", None),
        ("tbm", "HGTKMH, team Beta, round 1, run 1", 1),
    ]


def test_a_run_of_another_benchmark_is_no_result_of_its_event():
    """The organiser changed the benchmark of an event, which kept its id. The run counts for its own benchmark."""
    was = task_record("Alpha", 1, sign_off=SIGNED)._replace(event=plan(1).events[0].id, benchmark="HWV")
    found = lines([plan(1)], was)
    assert [(line.name, line.number, line.is_final) for line in found] == [
        ("HGTKMH, team Alpha, round 1, run 1", None, False), ("HWV, team Alpha, round 1, run 1", 1, True)]


def test_an_event_with_a_new_id_in_a_zone_with_a_new_name_keeps_its_run():
    """Its line was deleted, and later written again without an id."""
    was = task_record("Alpha", 1, sign_off=SIGNED)._replace(event="before")
    (found,) = lines([plan(1, zone="other")], was)
    assert (found.number, found.is_final) == (1, True)


def test_the_best_attempt_stands_for_its_event():
    """An unsigned 190 used to vanish behind a signed 40."""
    best = task_record("Alpha", 1, objects=190)
    worse = task_record("Alpha", 1, objects=40, sign_off=SIGNED)._replace(
        identity="again", opened_utc=best.opened_utc + 900.0)
    found, = lines([plan(1)], best, worse, counting=CountingAttempt.BEST)
    assert (found.number, found.state, found.is_final) == (1, "completed, counts", False)
    found, = lines([plan(1)], best._replace(sign_off=SIGNED), worse._replace(sign_off=None),
                   counting=CountingAttempt.BEST)
    assert (found.number, found.is_final) == (1, True)


def test_where_all_attempts_count_all_must_be_signed_off():
    first = task_record("Alpha", 1)
    again = task_record("Alpha", 1, sign_off=SIGNED)._replace(identity="again", opened_utc=first.opened_utc + 900.0)
    found, = lines([plan(1)], first, again, counting=CountingAttempt.ALL)
    assert (found.number, found.is_final, found.sheet) == (1, False, "not signed off")


def test_a_withdrawal_after_a_run_does_not_replace_it():
    first = task_record("Alpha", 1, sign_off=SIGNED)
    gone = task_record("Alpha", 1, end_reason="withdrawn")._replace(
        identity="gone", opened_utc=first.opened_utc + 900.0, started_utc=0.0)
    found, = lines([plan(1)], first, gone)
    assert (found.number, found.state, found.is_final) == (1, "completed, counts", True)
    found, = lines([plan(1)], gone)
    assert (found.number, found.state) == (1, "withdrawn, no score")
    found, = lines([plan(1)], gone, absent=("withdrawn", "no_show"))
    assert found.state == "withdrawn, counts as 0"


def test_the_lines():
    found = lines([plan(1, 2)], task_record("Alpha", 1, sign_off=SIGNED._replace(who="An\x1bna")))
    assert list(check_lines(found, in_utc=True)) == [
        "   Scheduled             Zone  Event                               Run  State              Sheet",
        "✔  2025-11-21 12:00:00Z  tbm   HGTKMH, team Alpha, round 1, run 1  1    completed, counts  "
        "signed off by An\\x1bna at 2025-11-21 11:00:05Z",
        "✘  2025-11-21 13:00:00Z  tbm   HGTKMH, team Alpha, round 1, run 2       no run",
        "1 of 2 signed off, 0 not signed off, 1 without a run",
    ]
    _, missing, last = check_lines(found, in_utc=True, only_missing=True)
    assert missing.startswith("✘") and last == "1 of 2 listed; 1 of 2 signed off, 0 not signed off, 1 without a run"
    assert list(check_lines([], True))[-1] == "0 of 0 signed off, 0 not signed off, 0 without a run"


def test_an_event_that_was_moved_to_another_time_keeps_its_run():
    moved = ZonePlan("tbm", (planned(1, UTC0 + 50_000.0), *plan(2).events))
    found = lines([moved], task_record("Alpha", 1, sign_off=SIGNED), task_record("Alpha", 2))
    assert [(line.number, line.is_final) for line in found] == [(2, False), (1, True)]
    # Another event at the time of the run has it.
    twin = ZonePlan("tbm", (*plan(1).events, planned(1, UTC0 + 50_000.0)))
    found = lines([twin], task_record("Alpha", 1, sign_off=SIGNED))
    assert [(line.number, line.is_final) for line in found] == [(1, True), (None, False)]
