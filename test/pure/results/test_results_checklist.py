"""The list for organisers: what is signed off, and what is missing."""

from helpers.competition import event
from helpers.results_of import UTC0, task_record
from roah_rsbb.core.scoring.records import SignOff
from roah_rsbb.results.checklist import check_lines, checklist, summary
from roah_rsbb.rulebook.benchmarks import ZonePlan

SIGNED = SignOff(UTC0 + 5.0, "Anna")


def plan(*runs, zone="tbm"):
    """A zone with these runs of team Alpha, each scheduled as `task_record` has it."""
    return ZonePlan(zone, tuple(event(team="Alpha", run=run, scheduled=UTC0 + 3600.0 * run) for run in runs))


def lines(plans, *records):
    return checklist(plans, records, in_utc=True)


def test_each_event_is_signed_off_or_says_what_is_missing():
    found = lines([plan(1, 2, 3, 4)], task_record("Alpha", 1, sign_off=SIGNED), task_record("Alpha", 2),
                  task_record("Alpha", 3, closed_utc=0.0, end_reason=""))
    assert [(line.is_final, line.number, line.state, line.sheet) for line in found] == [
        (True, 1, "completed", "signed off by Anna at 2025-11-21 11:00:05Z"), (False, 2, "completed", "not signed off"),
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


def test_the_lines():
    found = lines([plan(1, 2)], task_record("Alpha", 1, sign_off=SIGNED._replace(who="An\x1bna")))
    assert list(check_lines(found, in_utc=True)) == [
        "   Scheduled             Zone  Event                               Run  State      Sheet",
        "✔  2025-11-21 12:00:00Z  tbm   HGTKMH, team Alpha, round 1, run 1  1    completed  signed off by An\\x1bna at "
        "2025-11-21 11:00:05Z",
        "✘  2025-11-21 13:00:00Z  tbm   HGTKMH, team Alpha, round 1, run 2       no run",
        "1 of 2 signed off, 0 not signed off, 1 without a run",
    ]
    assert list(check_lines([], True))[-1] == "0 of 0 signed off, 0 not signed off, 0 without a run"


def test_an_event_that_was_moved_to_another_time_keeps_its_run():
    moved = ZonePlan("tbm", (event(team="Alpha", run=1, scheduled=UTC0 + 50_000.0), *plan(2).events))
    found = lines([moved], task_record("Alpha", 1, sign_off=SIGNED), task_record("Alpha", 2))
    assert [(line.number, line.is_final) for line in found] == [(2, False), (1, True)]
    # Another event at the time of the run has it.
    twin = ZonePlan("tbm", (*plan(1).events, event(team="Alpha", run=1, scheduled=UTC0 + 50_000.0)))
    found = lines([twin], task_record("Alpha", 1, sign_off=SIGNED))
    assert [(line.number, line.is_final) for line in found] == [(1, True), (None, False)]
