"""What organisers answer: read, or refused with what was expected."""

import datetime
import functools

import pytest

from helpers.config_files import SHIPPED
from helpers.time_zones import local_time
from roah_rsbb.model.rules import Decision
from roah_rsbb.rulebook.errors import Place, Report
from roah_rsbb.rulebook.registry import PROFILES
from roah_rsbb.tools.competition import answers, plan
from roah_rsbb.tools.competition.plan import Break
from roah_rsbb.tools.competition.rulebooks import read_rulebook

BENCHMARKS = read_rulebook(Report(), str(SHIPPED)).benchmarks
READ_BENCHMARKS, READ_ZONES, READ_DAILY = (
    functools.partial(reader, BENCHMARKS)
    for reader in (answers.read_benchmarks, answers.read_zones, answers.read_daily))
PLACE = Place("--option", 0, 0)


def read(reader, text):
    """What a reader makes of a text that is right."""
    report = Report()
    value = reader(report, PLACE, text)
    assert report.errors == []
    return value


def refused(reader, text):
    """All that a reader says against a text."""
    report = Report()
    reader(report, PLACE, text)
    assert report.errors
    assert all(error.file == "--option" for error in report.errors)
    return [f"found {error.found}; expected {error.expected}" for error in report.errors]


def test_teams():
    assert read(answers.read_teams, " Brass Butlers ,CopperKettle, 123") == ("Brass Butlers", "CopperKettle", "123")


@pytest.mark.parametrize("text, reported", [
    ("a,,b", "found an empty text as a team's name"),
    ("a,ALL", "found ALL as a team's name; expected another name"),
    ("a:b", "found 'a:b' as a team's name; expected a name without a colon"),
    ("a,b,a", "found team 'a' twice; expected each once"),
    ("é" * 51, "expected a text of at most 100 bytes; it has 102"),
    ("a\x07b", "expected a text of one line"),
])
def test_wrong_teams(text, reported):
    assert len(refused(answers.read_teams, text)) == 1
    assert reported in refused(answers.read_teams, text)[0]


def test_all_wrong_teams_are_reported_at_once():
    assert len(refused(answers.read_teams, "a:b,ALL,c,c")) == 3


def test_benchmarks():
    assert read(READ_BENCHMARKS, "hnf, HWV") == ("HNF", "HWV")
    assert read(READ_BENCHMARKS, "Tasks") == ("HGTKMH", "HWV", "HCFGAC")
    assert read(READ_BENCHMARKS, "all") == tuple(PROFILES)
    assert "did you mean 'HGTKMH'?" in refused(READ_BENCHMARKS, "HGTKM")[0]
    assert refused(READ_BENCHMARKS, "HNF,HNF") == ["found benchmark 'HNF' twice; expected each once"]


def test_zones():
    assert read(READ_ZONES, "Home A: HNF hwv, Arena") == (("Home A", ("HNF", "HWV")), ("Arena", ()))
    assert refused(READ_ZONES, "A, A") == ["found zone 'A' twice; expected each once"]
    assert "found an empty text as a zone's name" in refused(READ_ZONES, ": HNF")[0]
    assert "'HNV' as benchmark" in refused(READ_ZONES, "A: HNV")[0]


def shared(zones, codes):
    return read(lambda report, place, _: answers.share(report, place, zones, codes), "")


def not_shared(zones, codes):
    return refused(lambda report, place, _: answers.share(report, place, zones, codes), "")


def test_benchmarks_are_shared_out():
    assert shared([("A", ()), ("B", ())], ["HNF", "HWV", "STB"]) == {"A": ["HNF", "STB"], "B": ["HWV"]}
    assert shared([("A", ("STB",)), ("B", ())], ["HNF", "HWV", "STB"]) == {"A": ("STB",), "B": ["HNF", "HWV"]}


def test_the_benchmarks_of_each_day():
    assert read(READ_DAILY, "HNF hwv, STB, all") == (("HNF", "HWV"), ("STB",), tuple(BENCHMARKS))
    assert refused(READ_DAILY, "HNF HNF,")[0] == "found benchmark 'HNF' twice; expected each once"
    assert "expected a benchmark code" in refused(READ_DAILY, "HNF,")[0]


def test_breaks():
    assert read(answers.read_breaks, "15:00 - 15:15,12:30-13:30") == (
        Break(datetime.time(12, 30), datetime.time(13, 30)), Break(datetime.time(15), datetime.time(15, 15)))
    for text in ("13:30-12:30", "12-13", "12:30", "12:30-12:30", ""):
        assert len(refused(answers.read_breaks, text)) >= 1


def test_rounds():
    rounds = functools.partial(answers.read_rounds, BENCHMARKS)
    assert read(rounds, "3") == {"": 3}
    assert read(rounds, "HNF: 1, 3") == {"HNF": 1, "": 3}
    for text in ("0", "256", "x", "HNF: 0"):
        assert refused(rounds, text)[0].endswith("expected a whole number from 1 to 255")
    assert "did you mean 'HNF'?" in refused(rounds, "HNE: 1")[0]


def test_decisions():
    decisions = functools.partial(answers.read_decisions, [Decision("Posters", ("award only", "count"), "award only")])
    assert read(decisions, "Posters: count;") == {"Posters": "count"}
    assert read(decisions, "Posters") == {}
    assert "did you mean 'Posters'?" in refused(decisions, "Poster: count")[0]
    assert "as reading of 'Posters'; expected one of its readings: did you mean" in refused(
        decisions, "Posters: conut")[0]


def test_benchmarks_that_cannot_be_shared_out():
    assert not_shared([("A", ("STB",))], ["STB", "HNF"]) == [
        "found no zone for HNF; expected each benchmark in a zone, or a zone without benchmarks"]
    assert not_shared([("A", ("HNF",))], ["STB"])[0] == (
        "found benchmark HNF in a zone; expected one of the competition's benchmarks: STB")
    assert not_shared([("A", ()), ("B", ())], ["STB"])[0].startswith("found no benchmark left for zone 'B'")


def test_usual_zones():
    assert answers.usual_zones(BENCHMARKS, ["HNF", "HWV", "HSUF"]) == {
        "Task Benchmarks": ["HWV"], "Functionality Benchmarks": ["HNF", "HSUF"]}
    assert answers.usual_zones(BENCHMARKS, ["HWV"]) == {"Task Benchmarks": ["HWV"]}


def test_days_are_in_their_order():
    assert read(answers.read_days, "2026-11-29, 2026-11-28") == (
        datetime.date(2026, 11, 28), datetime.date(2026, 11, 29))


@pytest.mark.parametrize("text, expected", [
    ("28.11.2026", "year-month-day, such as 2026-11-28"), ("2026-02-30", "a day that exists"),
    ("1926-02-03", "a year from 2000 to 2100"), ("2026-11-28,2026-11-28", "each once"), ("", "year-month-day"),
])
def test_wrong_days(text, expected):
    assert expected in refused(answers.read_days, text)[0]


def test_minutes():
    assert read(answers.read_minutes, "90") == datetime.timedelta(minutes=90)
    for text in ("0", "1441", "-5", "5.5", "", "²", "9" * 5000):
        assert "expected a whole number from 1 to 1440" in refused(answers.read_minutes, text)[0]


def test_addresses():
    assert read(answers.read_address, "192.168.1.255") == "192.168.1.255"
    for text in ("192.168.1", "box", "192.168.1.256", "::1"):
        assert "expected an IPv4 address such as" in refused(answers.read_address, text)[0]


def test_times_of_day():
    def read_time(report, place, text):
        return plan.read_time(report, place, text, "time")

    assert read(read_time, "9:05") == datetime.time(9, 5)
    assert read(read_time, "23:59:58") == datetime.time(23, 59, 58)
    for text in ("24:00", "9", "9.30", "12:60", "9:30 PM", ""):
        assert "expected a time of day from 0:00 to 23:59, such as 09:30" in refused(read_time, text)[0]


@pytest.mark.parametrize("zone, hour", [("UTC", 9), ("utc", 9), ("+01:30", 7), ("-2:00", 11)])
def test_time_zones(zone, hour):
    clock = read(plan.read_clock, zone)
    moment = clock.utc(datetime.date(2026, 11, 28), datetime.time(9))
    assert (moment.tzinfo, moment.hour) == (datetime.timezone.utc, hour)
    assert clock.local(moment).time() == datetime.time(9)


def test_the_local_time_zone_has_summers():
    with local_time("Europe/Berlin"):
        clock = read(plan.read_clock, "local")
        for month, hour in ((1, 8), (7, 7)):
            moment = clock.utc(datetime.date(2026, month, 10), datetime.time(9))
            assert moment.hour == hour
            assert clock.local(moment).hour == 9


@pytest.mark.parametrize("rule, name", [("JST-9", "+09:00"), ("XYZ3:30", "-03:30"), (":Asia/Tokyo", "Asia/Tokyo")])
def test_what_this_computer_calls_its_time_zone(rule, name):
    with local_time(rule):
        assert read(plan.read_clock, "local").name == name


@pytest.mark.parametrize("error, name", [(FileNotFoundError(), "UTC"), (OSError(), "+00:00")])
def test_a_computer_without_a_link_to_its_time_zone(monkeypatch, error, name):
    def readlink(path):
        raise error

    with local_time("UTC"), monkeypatch.context() as patched:
        patched.delenv("TZ")
        patched.setattr("os.readlink", readlink)
        assert plan.local_zone() == name


def test_a_time_zone_with_summers_and_without_a_name():
    with local_time("XYZ-1ZYX,M3.5.0,M10.5.0/3"):
        assert "the venue's: a name such as Asia/Tokyo" in refused(plan.read_clock, "local")[0]


def test_wrong_time_zones():
    for zone in ("Tokyo", "asia/tokyo", "Asia", "localtime", "../zoneinfo/UTC", "EST-5", "+1", "+15:00", "+01:60"):
        assert "such as +01:00" in refused(plan.read_clock, zone)[0]
