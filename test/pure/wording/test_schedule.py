"""The schedule in words: states, delays, filters, and what is missing."""

import pytest

from helpers.time_zones import local_time
from roah_rsbb.model.results import EventSeen
from roah_rsbb.wording import schedule, times
from roah_rsbb.wording.schedule import EventFilter, Show

DAY0 = 1_800_000_000.0 - 1_800_000_000.0 % 86400


def line(zone="A", state="later", identity="", **fields):
    """An event of the schedule."""
    return EventSeen(**{
        "id": "", "number": 1, "zone": zone, "code": "HNF", "benchmark": "Navigation", "team": "Beta", "round": 1,
        "run": 1, "scheduled_utc_s": DAY0, "begins_utc_s": DAY0, "state": state, "identity": identity,
        "current": state in ("next", "running", "connected", "ended"), **fields})


def events(*lines):
    """The events, numbered in their zones."""
    zones = [one.zone for one in lines]
    return [one._replace(number=zones[:place + 1].count(one.zone)) for place, one in enumerate(lines)]


SIGNED = line(state="done", identity="r1", end_reason="completed", signed_utc_s=DAY0 + 9, signed_by="Anna")
UNSIGNED = line(state="done", identity="r2", end_reason="timeout")


@pytest.fixture
def madrid():
    with local_time("Europe/Madrid"):
        yield


@pytest.mark.parametrize("seconds, text", [
    (0, ""), (59, ""), (60, "+1 min"), (3599, "+59 min"), (3600, "+1 h 00 min"), (7500, "+2 h 05 min"),
    (86400, "+24 h 00 min"), (2 * 86400, "+2 days"), (10 * 365 * 86400, "+3650 days"),
])
def test_delays(seconds, text):
    assert schedule.delay_text(seconds) == text


def test_an_early_event_is_not_late():
    assert line(begins_utc_s=DAY0 - 100).late_s == 0.0
    assert line(begins_utc_s=DAY0 + 100).late_s == 100.0


@pytest.mark.parametrize("event, state, sheet", [
    (line(), "later", ""), (line(state="next"), "→ next", ""), (line(state="skipped"), "– skipped", ""),
    (line(state="running"), "▶ running", ""), (line(state="connected"), "● connected", ""),
    (line(state="ended"), "■ ended", "not signed off"), (SIGNED, "✓ done: completed", "signed off"),
    (UNSIGNED, "✓ done: timeout", "not signed off"),
    (line(state="next", identity="r", end_reason="stopped"), "→ next (before: stopped)", "not signed off"),
    (line(state="of a newer version"), "of a newer version", ""),
])
def test_states_and_sheets(event, state, sheet):
    (event,) = events(event)
    assert (schedule.state_text(event), schedule.sheet_text(event)) == (state, sheet)


def test_the_summary_counts_each_event_once():
    every = events(SIGNED, SIGNED, UNSIGNED, line(state="ended"), line(state="next"), line(), line(state="skipped"))
    assert schedule.summary(every) == "2 signed off  ·  2 not signed off  ·  2 to come  ·  1 skipped"
    assert schedule.summary(events(UNSIGNED)) == "1 not signed off"
    assert schedule.summary([]) == "no events"


def shown(filter_, *lines, **options):
    return [event.number for event in events(*lines) if filter_.shows(event, **options)]


def test_filters_by_zone_team_and_day(madrid):
    lines = (line(team="Alpha"), line(), line(scheduled_utc_s=DAY0 + 86400))
    assert shown(EventFilter(), *lines) == [1, 2, 3]
    assert shown(EventFilter(zone="B"), *lines) == []
    assert shown(EventFilter(zone="A", team="Alpha"), *lines) == [1]
    days = [schedule.day_of(event) for event in events(*lines)]
    assert shown(EventFilter(day=days[2]), *lines) == [3]
    assert shown(EventFilter(team="Alpha", day=days[2]), *lines) == []


def test_the_day_of_an_event_around_midnight_is_the_venues_day(madrid):
    late = line(scheduled_utc_s=DAY0 + 23.5 * 3600)
    days = [times.formatted(DAY0 + shift, "%Y-%m-%d", in_utc=True) for shift in (0, 86400)]
    assert schedule.day_of(late, in_utc=True) == days[0]
    assert schedule.day_of(late) == days[1], "23:30 UTC is the next day in Madrid"


def test_filters_by_what_became_of_them():
    lines = (SIGNED, UNSIGNED, line(state="ended"), line(state="next"), line(), line(state="skipped"),
             line(state="next", identity="r", end_reason="stopped"))
    assert shown(EventFilter(show=Show.ALL), *lines) == [1, 2, 3, 4, 5, 6, 7]
    assert shown(EventFilter(show=Show.TO_COME), *lines) == [3, 4, 5, 7]
    assert shown(EventFilter(show=Show.UNSIGNED), *lines) == [2, 3, 7]
    assert shown(EventFilter(show=Show.MISSING), *lines) == [2, 3, 4, 5, 6, 7]


def test_what_is_left_unsigned_is_the_current_run_of_the_same_zone():
    every = events(UNSIGNED, line(state="next", identity="r", current=True), line("B", state="next"))
    assert schedule.left_unsigned(every, "A") == every[1]
    assert schedule.left_unsigned(every, "B") is None
    assert schedule.left_unsigned([], "A") is None
    signed = events(line(state="next", identity="r", signed_utc_s=DAY0))
    assert schedule.left_unsigned(signed, "A") is None


def test_why_an_event_cannot_be_chosen():
    def why(state, chosen=1):
        every = events(line(state=state), line())
        return schedule.why_not(every, every[chosen])

    assert why("running") == "A run is running in A. Stop it first."
    assert why("connected") == "A run is connected in A. Disconnect it first."
    assert why("ended") == why("next") == why("ended", chosen=0) == ""
    assert why("next", chosen=0) == "A is at this event already."


def test_a_clock_that_is_far_off():
    assert times.formatted(1e18, "%H:%M", in_utc=False) == "?"
