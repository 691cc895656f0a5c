"""Errors and warnings of the schedule file, also against the two other files."""

import calendar

import pytest

from helpers.config_files import TEXTS, changed, line_of
from roah_rsbb.rulebook.benchmarks import Durable

EVENT = "{ benchmark: HWV,    team: TestingTeam, round: 1, run: 1, scheduled_time: 2015-12-31 00:01:00 }"
LINE = line_of(TEXTS["schedule"], EVENT)
UTC = "expected a date and time in UTC such as 2015-12-31 14:30:00"
EXIST = "expected an existing day and time of day"
LINES = len(TEXTS["schedule"].splitlines())
WHOLE = "expected a whole number from 1 to 255"


def with_event(old: str, new: str) -> str:
    assert old in EVENT
    return changed("schedule", EVENT, EVENT.replace(old, new))


def times_text(time: str) -> str:
    return with_event("2015-12-31 00:01:00", time)


MISTAKES = [
    ("round: 1", "round: 0", ["the number '0' as round", WHOLE]),
    ("round: 1", "round: 256", ["the number '256' as round", WHOLE]),
    ("run: 1", "run: -1", ["the number '-1' as run", WHOLE]),
    ("run: 1", "run: 1.5", ["the number '1.5' as run", WHOLE]),
    ("run: 1", "run: one", ["the text 'one' as run", WHOLE]),
    ("run: 1", "run: true", ["'true'", WHOLE]),
    ("run: 1", "run: '1'", ["the quoted text '1'", WHOLE, "remove the quotes"]),
    ("run: 1", "run: " + "9" * 9000, ["as run", WHOLE]),
    ("run: 1, ", "", ["an event without run", "'run: 1'"]),
    ("run: 1", "run:1", ["the unknown key 'run:1'", "a space after the colon"]),
    ("team:", "taem:", ["the unknown key 'taem' in an event", "did you mean 'team'?"]),
    ("HWV", "HVW", ["'HVW' as benchmark", "did you mean 'HWV'?"]),
    ("TestingTeam", "ALL", ["team ALL in HWV", "the name of one team"]),
    ("HWV", "HSUF", ["team 'TestingTeam' in HSUF", "team ALL"]),
    ("TestingTeam", "2015", ["the number '2015' as team", "put it in quotes"]),
    ("TestingTeam", "''", ["an empty text as team"]),
    ("TestingTeam", "[a, b]", ["a sequence", "as team"]),
    ("TestingTeam", "TestngTeam", ["team 'TestngTeam', which is not in", "did you mean 'TestingTeam'?"]),
    ("TestingTeam", "testingteam", ["did you mean 'TestingTeam'?"]),
    ("TestingTeam", "Zwölf", ["team 'Zwölf', which is not in", "a line 'team: password' for it"]),
    ("2015-12-31 00:01:00", "tomorrow", ["the text 'tomorrow' as scheduled_time", UTC]),
    ("2015-12-31 00:01:00", "31.12.2015 10:00", ["'31.12.2015 10:00'", UTC]),
    ("2015-12-31 00:01:00", "10:00", ["'10:00'", UTC]),
    ("2015-12-31 00:01:00", "12", ["the number '12'", UTC]),
    ("2015-12-31 00:01:00", "", ["nothing as scheduled_time", UTC]),
    ("2015-12-31 00:01:00", "2015-12-31 00:01:00 CET", [UTC]),
    ("2015-12-31 00:01:00", "٢٠١٥-12-31", [UTC]),
    ("2015-12-31 00:01:00", "2015-02-30 10:00:00", ["the date '2015-02-30 10:00:00'", EXIST]),
    ("2015-12-31 00:01:00", "2015-12-31 25:00:00", [EXIST]),
    ("2015-12-31 00:01:00", "2015-12-31 10:00:60", [EXIST]),
    ("2015-12-31 00:01:00", "2015-12-31 10:00:00 +24:00", [EXIST]),
    ("2015-12-31 00:01:00", "9999-12-31 23:59:59 -23:00", [EXIST]),
    ("2015-12-31 00:01:00", "0001-01-01 00:00:00 +10:00", [EXIST]),
    ("2015-12-31 00:01:00", "1969-12-31 23:59:59", ["a date from 1970 to 2105"]),
    ("2015-12-31 00:01:00", "2106-12-31", ["a date from 1970 to 2105"]),
]


@pytest.mark.parametrize("old, new, parts", MISTAKES, ids=[(old + new)[:40] for old, new, _ in MISTAKES])
def test_one_mistake_is_one_error_in_its_line(files, old, new, parts):
    name, line, message = files.error(schedule=with_event(old, new))
    assert (name, line) == ("schedule", LINE)
    assert [part for part in parts if part not in message] == [], message


@pytest.mark.parametrize(
    "time, expected",
    [
        ("2015-12-31", (2015, 12, 31, 0, 0, 0)),
        ("'2015-12-31'", (2015, 12, 31, 0, 0, 0)),
        ("2015-12-31 14:30", (2015, 12, 31, 14, 30, 0)),
        ("2015-12-31 14:30:05", (2015, 12, 31, 14, 30, 5)),
        ('"2015-12-31 14:30:05"', (2015, 12, 31, 14, 30, 5)),
        ("2015-12-31T14:30:05Z", (2015, 12, 31, 14, 30, 5)),
        ("2015-12-31 14:30:05 +01:00", (2015, 12, 31, 13, 30, 5)),
        ("2015-12-31t14:30:05-5", (2015, 12, 31, 19, 30, 5)),
        ("2015-12-31 23:30:05 -01:30", (2016, 1, 1, 1, 0, 5)),
        ("2016-2-9 4:30:05", (2016, 2, 9, 4, 30, 5)),
    ],
)
def test_times_are_utc_seconds(files, time, expected):
    events = files.load(schedule=times_text(time))[0].zones[0].events
    found = next(event for event in events if event.benchmark.code == "HWV")
    assert found.scheduled == calendar.timegm(expected)


def test_fractions_of_a_second(files):
    events = files.load(schedule=times_text("2015-12-30 14:30:05.25"))[0].zones[0].events
    assert events[0].scheduled % 60 == 5.25


def test_events_are_sorted_by_time_and_keep_the_order_of_equal_times(files):
    codes = [("STB", "10:00"), ("HNF", "09:00"), ("HWV", "10:00"), ("HOPF", "09:00"), ("HGMF", "08:00")]
    lines = [
        f"    - {{benchmark: {code}, team: DumpTeam, round: 1, run: 1, scheduled_time: 2020-01-01 {time}:00}}"
        for code, time in codes
    ]
    zones = files.load(schedule="- zone: Z\n  schedule:\n" + "\n".join(lines))[0].zones
    assert [event.benchmark.code for event in zones[0].events] == ["HGMF", "HNF", "HOPF", "STB", "HWV"]


def test_rounds_and_runs_up_to_255(files):
    text = with_event("round: 1, run: 1", "round: 255, run: 255")
    events = files.load(schedule=text)[0].zones[0].events
    assert (255, 255) in [(event.round, event.run) for event in events]


def test_an_unknown_team_is_one_error_that_names_every_line(files):
    text = TEXTS["schedule"].replace("HomeAlone", "HomeAlon")
    _, line, message = files.error(schedule=text)
    lines = [i for i, content in enumerate(text.splitlines(), 1) if "HomeAlon," in content]
    assert line == lines[0]
    others = ", ".join(map(str, lines[1:-1])) + f" and {lines[-1]}"
    assert f"team 'HomeAlon' (also in line {others}), which is not in" in message


def test_a_benchmark_that_the_benchmarks_file_lacks(files):
    benchmarks = TEXTS["benchmarks"]
    begin, end = benchmarks.index("- name: Functionality Benchmark 6"), benchmarks.index("- name: Object")
    name, line, message = files.error(benchmarks=benchmarks[:begin] + benchmarks[end:])
    assert (name, line) == ("schedule", line_of(TEXTS["schedule"], "benchmark: HGMF"))
    assert "benchmark 'HGMF' (also in line" in message and "or an entry for it there" in message


@pytest.mark.parametrize(
    "old, new, parts",
    [
        ("zone: Task", "zone: Functionality", ["a second zone 'Functionality Benchmarks'", "already in line"]),
        ("zone: Task Benchmarks", "zone: ''", ["an empty text as zone"]),
        ("zone: Task Benchmarks", "zone: 7", ["the number '7' as zone", "put it in quotes"]),
        ("zone: Task Benchmarks", "zones: Task Benchmarks", ["unknown key 'zones'", "did you mean 'zone'?"]),
    ],
)
def test_zone_names(files, old, new, parts):
    text = changed("schedule", old, new)
    _, line, message = files.error(schedule=text)
    # Of two zones of one name the second is the error.
    assert line == (55 if "second zone" in parts[0] else line_of(text, new))
    assert [part for part in parts if part not in message] == [], message


@pytest.mark.parametrize(
    "zone, part",
    [
        ("  schedule:\n", "found nothing as schedule of zone 'New'; expected a sequence of at least one event"),
        ("  schedule: []\n", "an empty sequence as schedule of zone 'New'"),
        ("  schedule: {benchmark: HWV}\n", "a map ('key: value') as schedule of zone 'New'"),
        ("", "a zone without schedule"),
    ],
)
def test_a_zone_without_events(files, zone, part):
    text = TEXTS["schedule"] + "\n- zone: New\n" + zone
    _, line, message = files.error(schedule=text)
    assert line in (line_of(text, "zone: New"), line_of(text, "zone: New") + 1)
    assert part in message


@pytest.mark.parametrize("before, after, wish, line", [
    ("", "", Durable.ONE, None), ("", "\n- durable: one\n", Durable.ONE, LINES + 2),
    ("", "\n- durable: two\n", Durable.TWO, LINES + 2), ("- { durable: two }\n", "", Durable.TWO, 1)])
def test_how_many_computers_must_have_an_entry(files, before, after, wish, line):
    loaded, _ = files.load(schedule=before + TEXTS["schedule"] + after)
    assert loaded.durable is wish
    assert len(loaded.zones) == len(files.load()[0].zones)
    assert (loaded.durable_at.line if line else loaded.durable_at) == line


@pytest.mark.parametrize("number, warned", [("010", True), ("07", False), ("10", False)])
def test_a_number_that_others_read_as_octal(files, number, warned):
    loaded, warnings = files.load(schedule=TEXTS["schedule"].replace("round: 1,", f"round: {number},", 1))
    assert int(number) in {event.round for zone in loaded.zones for event in zone.events}
    assert sum("round 010 is 10 here, but another number" in warning for warning in warnings) == warned


@pytest.mark.parametrize("setting, zone", [("", ""), ("- time_zone: Asia/Tokyo\n", "Asia/Tokyo"),
                                           ("- time_zone: '-03:30'\n", "-03:30")])
def test_the_time_zone_of_the_venue(files, setting, zone):
    assert files.load(schedule=setting + TEXTS["schedule"])[0].time_zone == zone


@pytest.mark.parametrize("setting, parts", [
    ("time_zone: Tokyo", ["'Tokyo' as time_zone", "such as Asia/Tokyo, UTC, or the offset"]),
    ("time_zone: [UTC]", ["as time_zone"]),
    ("durable: 2", ["the number '2' as durable", "one or two", "'one', 'two'"]),
    ("durable: tow", ["the text 'tow' as durable", "did you mean 'two'?"]),
    ("durable:", ["nothing as durable"]),
    ("durabel: two", ["the unknown key 'durabel' in a setting", "did you mean 'durable'?"]),
    ("{ durable: two, zone: Home }", ["the unknown key 'zone' in a setting"]),
])
def test_a_wrong_setting(files, setting, parts):
    text = f"{TEXTS['schedule']}\n- {setting}\n"
    _, line, message = files.error(schedule=text)
    assert line == LINES + 2
    assert [part for part in parts if part not in message] == [], message


def test_a_setting_twice(files):
    _, line, message = files.error(schedule=TEXTS["schedule"] + "\n- durable: two\n- durable: one\n")
    assert line == LINES + 3
    assert message.startswith("found the setting 'durable' again; expected each setting once: it is already in line")


def test_settings_without_a_zone(files):
    assert "no zone" in files.error(schedule="- durable: two\n")[2]


def test_the_same_event_in_two_zones_is_a_warning(files):
    event = "{ benchmark: HWV, team: TestingTeam, round: 1, run: 1, scheduled_time: 2016-01-01 }"
    text = TEXTS["schedule"] + f"\n- zone: New\n  schedule:\n    - {event}\n"
    loaded, warnings = files.load(schedule=text)
    assert len(warnings) == 1
    assert f"schedule.yaml:{line_of(text, event)}: HWV, team 'TestingTeam', round 1, run 1" in warnings[0]
    assert f"already in line {LINE}" in warnings[0]
    assert len(loaded.zones[-1].events) == 1
