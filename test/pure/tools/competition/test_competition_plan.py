"""The timetable: everybody does everything once a day, nobody is in two places at once."""

import collections
import datetime

import pytest
from hypothesis import given
from hypothesis import strategies as st

from helpers.examples import examples
from roah_rsbb.rulebook.benchmarks import ALL_TEAMS
from roah_rsbb.rulebook.errors import Report
from roah_rsbb.tools.competition.plan import Break, PlannedDay, VenueClock, timetable

UTC = VenueClock("UTC")


def days(count=1, first="09:00", last="18:00", minutes=15):
    times = [datetime.time(*map(int, text.split(":"))) for text in (first, last)]
    return [PlannedDay(datetime.date(2026, 11, 28 + number), *times, datetime.timedelta(minutes=minutes))
            for number in range(count)]


def plan(teams, zones, wanted=None):
    report = Report()
    made = timetable(report, teams, zones, wanted or days(), UTC)
    assert report.errors == []
    return made


def by_time(made):
    """The runs of all zones by the moment when they begin."""
    found = collections.defaultdict(list)
    for zone in made.zones:
        for run in zone.runs:
            found[run.begins].append(run)
    return found


@pytest.mark.parametrize("teams", [1, 2, 3, 7])
@pytest.mark.parametrize("zones", [
    {"X": ["HWV", "HCFGAC"], "Y": ["HNF", "HOPF", "STB"]},
    {"X": ["HWV"], "Y": ["HSUF", "HNF"], "Z": ["HOPF"]},
    {"X": ["HSUF"], "Y": ["HWV", "HGTKMH"]},
    {"X": ["HWV", "HGTKMH"], "Y": ["HSUF"]},
])
def test_every_team_does_every_benchmark_once_a_day(teams, zones):
    names = [f"T{number}" for number in range(teams)]
    made = plan(names, zones, days(2))
    for zone in made.zones:
        expected = collections.Counter(
            (code, team, number, 1) for code in zones[zone.name] for number in (1, 2)
            for team in ([ALL_TEAMS] if code == "HSUF" else names))
        assert collections.Counter(run[:4] for run in zone.runs) == expected
        assert [run.begins for run in zone.runs] == sorted(run.begins for run in zone.runs)
        assert len({run.begins for run in zone.runs}) == len(zone.runs)
    for runs in by_time(made).values():
        busy = [run.team for run in runs]
        assert len(set(busy)) == len(busy)
        assert busy == [ALL_TEAMS] or ALL_TEAMS not in busy


def test_a_benchmark_is_not_torn_apart():
    made = plan(["A", "B", "C"], {"X": ["HWV", "HCFGAC"], "Y": ["HNF", "HOPF"]}, days(2))
    for zone in made.zones:
        blocks = [run.code + str(run.round) for run in zone.runs]
        changes = sum(before != after for before, after in zip(blocks, blocks[1:]))
        assert changes == len(set(blocks)) - 1


def test_all_robots_at_once_come_last_in_a_zone():
    made = plan(["A", "B"], {"X": ["HSUF", "HNF"]}, days(2))
    assert [run.code for run in made.zones[0].runs] == ["HNF", "HNF", "HSUF"] * 2


def test_it_is_not_always_the_same_team_that_begins():
    made = plan(["A", "B", "C"], {"X": ["HWV", "HGTKMH", "HCFGAC"]}, days(3))
    first = [run.team for number, run in enumerate(made.zones[0].runs) if number % 3 == 0]
    assert collections.Counter(first) == {"A": 3, "B": 3, "C": 3}


def test_the_last_run_may_end_when_the_day_does():
    assert len(plan(["A", "B"], {"X": ["HWV"]}, days(last="09:30")).zones[0].runs) == 2


def test_a_day_that_is_too_short_is_reported_with_what_would_help():
    report = Report()
    timetable(report, ["A", "B"], {"X": ["HWV"]}, days(2, last="09:29"), UTC)
    assert [error.found for error in report.errors] == [
        "runs on 2026-11-28 until 09:30", "runs on 2026-11-29 until 09:30"]
    for option in ("--begin", "--every", "--end"):
        assert option in report.errors[0].expected


def test_a_day_that_continues_at_night():
    report = Report()
    timetable(report, ["A"] * 5, {"X": ["HWV"]}, days(minutes=300), UTC)
    assert report.errors[0].found == "runs on 2026-11-28 until 10:00 the next day"


def test_times_are_the_venues():
    report = Report()
    made = timetable(report, ["A"], {"X": ["HWV"]}, days(), VenueClock("+02:00"))
    assert made.zones[0].runs[0].begins == datetime.datetime(2026, 11, 28, 7, tzinfo=datetime.timezone.utc)


# -- chosen days, rounds, breaks, shared benchmarks ---------------------------------------------------

def starts(made, zone=0):
    return [run.begins.strftime("%d %H:%M") for run in made.zones[zone].runs]


def test_benchmarks_of_certain_days():
    wanted = [day._replace(codes=codes) for day, codes in zip(days(3), [("HWV",), ("HNF",), ("HWV",)])]
    made = plan(["A", "B"], {"X": ["HWV", "HNF"]}, wanted)
    assert [(run.code, run.round, run.begins.day) for run in made.zones[0].runs] == [
        ("HWV", 1, 28), ("HWV", 1, 28), ("HNF", 1, 29), ("HNF", 1, 29), ("HWV", 2, 30), ("HWV", 2, 30)]


@pytest.mark.parametrize("rounds, on_each_day", [(1, [2, 2, 3]), (2, [4, 5, 5]), (4, [9, 9, 10])])
def test_rounds_are_spread_over_the_days(rounds, on_each_day):
    names = [f"T{number}" for number in range(7)]
    report = Report()
    made = timetable(report, names, {"X": ["HWV"]}, days(3), UTC, {"": rounds})
    runs = made.zones[0].runs
    assert [sum(run.begins.day == day for run in runs) for day in (28, 29, 30)] == on_each_day
    assert collections.Counter((run.team, run.round) for run in runs) == collections.Counter(
        (name, number) for name in names for number in range(1, rounds + 1))


def test_no_run_meets_a_break():
    noon, tea = Break(datetime.time(9, 40), datetime.time(10, 10)), Break(datetime.time(10, 10), datetime.time(10, 20))
    wanted = [day._replace(breaks=(noon, tea)) for day in days()]
    made = plan(["A", "B", "C", "D"], {"X": ["HWV"]}, wanted)
    assert starts(made) == ["28 09:00", "28 09:15", "28 10:20", "28 10:35"]


def test_a_break_makes_a_day_longer():
    report = Report()
    wanted = [day._replace(breaks=(Break(datetime.time(9, 15), datetime.time(9, 45)),)) for day in days(last="09:59")]
    timetable(report, ["A", "B"], {"X": ["HWV"]}, wanted, UTC)
    assert report.errors[0].found == "runs on 2026-11-28 until 10:00"


@pytest.mark.parametrize("teams", [1, 2, 5])
def test_zones_share_the_teams_of_a_benchmark(teams):
    names = [f"T{number}" for number in range(teams)]
    made = plan(names, {"X": ["HWV", "HNF"], "Y": ["HWV", "HSUF"]}, days(2))
    runs = [run[:4] for zone in made.zones for run in zone.runs]
    assert collections.Counter(runs) == collections.Counter(
        (code, team, number, 1) for code in ("HWV", "HNF", "HSUF") for number in (1, 2)
        for team in ([ALL_TEAMS] if code == "HSUF" else names))
    for found in by_time(made).values():
        busy = [run.team for run in found]
        assert len(set(busy)) == len(busy)
    if teams == 5:
        assert [sum(run.code == "HWV" for run in zone.runs) for zone in made.zones] == [6, 4]


CODES = ("HGTKMH", "HWV", "HNF", "HOPF")


@examples(120)
@given(data=st.data(), teams=st.integers(1, 6), rounds=st.one_of(st.none(), st.integers(1, 3)),
       breaks=st.lists(st.integers(9 * 60, 20 * 60), max_size=2), minutes=st.sampled_from([5, 20, 45]))
def test_any_plan(data, teams, rounds, breaks, minutes):
    """Everybody has the right number of turns, spread evenly, never twice at once, and never in a break."""
    names = [f"T{number}" for number in range(teams)]
    codes = data.draw(st.lists(st.sampled_from(CODES), min_size=1, unique=True))
    zones = {"X": codes, "Y": data.draw(st.lists(st.sampled_from(codes), min_size=1, unique=True))}
    pauses = tuple(sorted(Break(datetime.time(*divmod(at, 60)), datetime.time(*divmod(at + 30, 60))) for at in breaks))
    wanted = [day._replace(breaks=pauses, codes=tuple(data.draw(st.lists(st.sampled_from(codes), unique=True))))
              for day in days(data.draw(st.integers(1, 3)), minutes=minutes)]
    wanted[0] = wanted[0]._replace(codes=None)  # each benchmark has a day
    report = Report()
    made = timetable(report, names, zones, wanted, UTC, rounds and {"": rounds})
    runs = [run for zone in made.zones for run in zone.runs]
    for code in codes:
        on = [day.day for day in wanted if day.codes is None or code in day.codes]
        of_code = [run for run in runs if run.code == code]
        assert collections.Counter((run.team, run.round) for run in of_code) == collections.Counter(
            (name, number) for name in names for number in range(1, (rounds or len(on)) + 1))
        if not report.errors:
            counts = [sum(run.begins.date() == day for run in of_code) for day in on]
            assert sum(counts) == len(of_code)
            assert max(counts) - min(counts) <= 1
    for at, found in by_time(made).items():
        assert len({run.team for run in found}) == len(found)
        ends = at + datetime.timedelta(minutes=minutes)
        for pause in pauses:
            begin, end = (UTC.utc(at.date(), time) for time in pause)
            assert ends <= begin or at >= end
