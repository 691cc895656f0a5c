"""Schedules from CSV sheets: what spreadsheet programs write is read; each bad cell is named."""

import pytest

from roah_rsbb.rulebook.errors import ConfigErrors, Report
from roah_rsbb.tools.competition.plan import VenueClock
from roah_rsbb.tools.competition.sheet import Known, column_name, read_sheet

UTC = VenueClock("UTC")
HEAD = "zone,benchmark,team,date,time\n"


@pytest.fixture
def sheet(tmp_path):
    path = tmp_path / "plan.csv"

    def read(text, clock=UTC, **known):
        data = text if isinstance(text, bytes) else text.encode("utf-8")
        path.write_bytes(data)
        report = Report()
        return read_sheet(str(path), report, clock, **known), report

    return read


@pytest.fixture
def good(sheet):
    def read(text, **options):
        made, report = sheet(text, **options)
        assert report.errors == []
        return made
    return read


@pytest.fixture
def errors(sheet):
    def read(text, **options):
        made, report = sheet(text, **options)
        assert made is None
        assert report.errors
        return [(error.line, error.column, f"found {error.found}; expected {error.expected}")
                for error in report.errors]
    return read


def runs(made):
    return [(zone.name, run.code, run.team, run.round, run.run, run.begins.strftime("%m-%d %H:%M"))
            for zone in made.zones for run in zone.runs]


def test_a_sheet(good):
    made = good(HEAD + "Home,HGTKMH,A,2026-11-28,09:00\nArena,HNF,B,2026-11-28,9:15\nHome,hwv,B,2026-11-29,10:00:00\n")
    assert runs(made) == [
        ("Home", "HGTKMH", "A", 1, 1, "11-28 09:00"), ("Home", "HWV", "B", 2, 1, "11-29 10:00"),
        ("Arena", "HNF", "B", 1, 1, "11-28 09:15")]
    assert made.teams == ("A", "B")


def test_rounds_and_runs_that_are_given(good):
    made = good("run,round,time,date,team,benchmark,zone\n3,2,09:00,2026-11-28,A,HNF,Home\n")
    assert runs(made) == [("Home", "HNF", "A", 2, 3, "11-28 09:00")]


def test_runs_are_counted_in_order_of_time(good):
    made = good(HEAD + "X,HNF,A,2026-11-28,10:00\nY,HNF,A,2026-11-28,09:00\nX,HNF,A,2026-11-28,11:00\n")
    assert [(zone, run) for zone, _, _, _, run, _ in runs(made)] == [("X", 2), ("X", 3), ("Y", 1)]


def test_all_robots_at_once(good):
    made = good(HEAD + "X,HSUF,,2026-11-28,10:00\nX,HSUF,ALL,2026-11-28,11:00\nX,HNF,A,2026-11-28,12:00\n")
    assert [run[2:5] for run in runs(made)] == [("ALL", 1, 1), ("ALL", 1, 2), ("A", 1, 1)]
    assert made.teams == ("A",)


@pytest.mark.parametrize("line", ["sep=;", "SEP=;", '"sep=;"'])
def test_a_line_that_names_the_separator(good, errors, line):
    rows = f"{line}\r\nzone;benchmark;team;date;time;round\r\nX,Y;HNF;A;2026-11-28;10:00;010\r\n"
    assert runs(good(rows)) == [("X,Y", "HNF", "A", 10, 1, "11-28 10:00")]
    assert errors(rows.replace("10:00", "1000"))[0][0] == 3


def test_times_are_the_venues(good):
    made = good(HEAD + "X,HNF,A,2026-11-28,00:30\n", clock=VenueClock("+01:00"))
    assert runs(made)[0][5] == "11-27 23:30"
    assert runs(made)[0][3] == 1


BERLIN = VenueClock("Europe/Berlin")


def test_a_time_that_the_clocks_skip(errors):
    (line, column, text), = errors(HEAD + "X,HNF,A,2026-03-29,02:30\n", clock=BERLIN)
    assert (line, column) == (2, 5)
    assert "02:30 on 2026-03-29, which does not exist: the clocks of Europe/Berlin skip it" in text


def test_a_time_that_exists_twice(sheet):
    made, report = sheet(HEAD + "X,HNF,A,2026-10-25,02:30\nX,HNF,B,2026-10-25,03:00\n", clock=BERLIN)
    assert [run[5] for run in runs(made)] == ["10-25 00:30", "10-25 02:00"]
    assert [warning.count("exists twice") for warning in report.warnings] == [1]
    assert ("write 2026-10-25 02:30:00 +01:00 into schedule.yaml instead of 2026-10-25 02:30:00 +02:00"
            in report.warnings[0])


@pytest.mark.parametrize("text", [
    "zone;benchmark;team;date;time\r\nX, the big one;HNF;A;2026-11-28;10:00\r\n",
    "zone\tbenchmark\tteam\tdate\ttime\rX, the big one\tHNF\tA\t2026-11-28\t10:00\r",
    '\ufeffZone , Benchmark,TEAM,date,time\n\n"X, the big one",HNF, A ,2026-11-28,10:00\n,,,,\n',
])
def test_what_spreadsheet_programs_write(good, text):
    assert runs(good(text)) == [("X, the big one", "HNF", "A", 1, 1, "11-28 10:00")]


def test_every_bad_cell_is_named_with_line_column_and_the_expected_form(errors):
    found = errors(
        "zone,benchmark,team,round,run,date,time\n"
        ",HNV,ALL,0,x,28.11.26,9h\n"
        "\n"
        "X,HSUF,A,1,1,2026-11-28,10:00\n")
    assert [(line, column) for line, column, _ in found] == [
        (2, 1), (2, 2), (2, 3), (2, 6), (2, 7), (2, 4), (2, 5), (4, 3)]
    reported = [text for _, _, text in found]
    assert reported[0] == "found an empty text as zone (column A); expected a text that is not empty"
    assert reported[1].startswith("found the text 'HNV' as benchmark (column B); expected a benchmark code")
    assert reported[2].startswith("found ALL as team (column C); expected another name")
    assert reported[3] == ("found '28.11.26' as date (column F); expected a day as year-month-day, such as 2026-11-28")
    assert reported[4] == ("found '9h' as time (column G); expected a time of day from 0:00 to 23:59, such as 09:30")
    assert reported[5] == "found the number '0' as round (column D); expected a whole number from 1 to 255"
    assert reported[6] == "found the text 'x' as run (column E); expected a whole number from 1 to 255"
    assert reported[7] == (
        "found 'A' as team (column C) in HSUF; expected ALL or an empty cell: all robots do it at once")


def test_empty_columns_beside_the_sheet(good):
    assert len(runs(good("zone,benchmark,team,date,time,,\nX,HNF,A,2026-11-28,10:00,,\n"))) == 1


def test_a_column_without_a_name(errors):
    found = errors("zone,benchmark,,team,date,time\nX,HNF,what,A,2026-11-28,10:00\n")
    assert [(line, column) for line, column, _ in found] == [(2, 3)]


def test_a_row_that_is_too_short_or_too_long(errors):
    found = errors(HEAD + "X,HNF,A\nX,HNF,A,2026-11-28,10:00,,more\n")
    assert [(line, column) for line, column, _ in found] == [(2, 4), (2, 5), (3, 7)]
    assert found[2][2] == ("found 'more' in column G, which has no name; expected a name for it in the first row, or "
                           "an empty cell")


@pytest.mark.parametrize("head, line, reported", [
    ("zone,benchmark,team,day,time", 1, "found 'day' in column D; expected the name of a column"),
    ("zone,benchmark,taem,date,time", 1, "did you mean 'team'?"),
    ("zone,benchmark,team,date,time,zone", 1, "found column zone twice; expected each column once"),
    ("\nzone,benchmark,team", 2, "found no column date and time; expected a row that names the columns: zone, "),
])
def test_a_wrong_head(errors, head, line, reported):
    found = errors(head + "\nX,HNF,A,2026-11-28,10:00\n")
    assert len(found) == 1
    assert found[0][0] == line
    assert reported in found[0][2]


def test_a_quote_that_is_not_closed_is_named_with_its_line(errors):
    found = errors(HEAD + 'X,HNF,A,2026-11-28,10:00\n"X,HNF,A,2026-11-28,10:00\nX,HNF,A,2026-11-28,11:00\n')
    assert (found[0][0], found[0][2][:24]) == (3, "found an unclosed quote,")


def test_lines_are_counted_where_a_cell_has_more(errors):
    found = errors(HEAD + 'X,HNF,"A\nB",2026-11-28,10:00\nX,HNF,A,x,10:00\n')
    assert [line for line, _, _ in found] == [2, 4]


@pytest.mark.parametrize("data, reported", [
    (b"", "found no column zone, "), (HEAD.encode(), "found no runs"),
    ("zone;Übung".encode("latin-1"), "expected UTF-8: choose this encoding"),
    (HEAD.encode("utf-16"), "found UTF-16 text"), (HEAD.encode("utf-32"), "found UTF-32 text"),
    (b"PK\3\4\x14\0", "(.xlsx, .ods), or an archive; expected plain text: open it in its program, and save a sheet"),
    (b"\xd0\xcf\x11\xe0\xa1", "spreadsheet or office program (.xls); expected plain text"),
    (HEAD.encode() + b"X,HNF,A\0,2026-11-28,10:00\n", "found a control character"),
    (HEAD.encode() + b"x" * 1_000_001, "found more than 1000 kB; expected the sheet (option --sheet)"),
])
def test_an_invalid_sheet(errors, data, reported):
    assert reported in errors(data)[0][2]


def test_a_sheet_that_is_not_there(tmp_path):
    report = Report()
    (tmp_path / "plan.csv").write_text(HEAD, encoding="utf-8")
    assert read_sheet(str(tmp_path / "plann.csv"), report, UTC) is None
    assert "did you mean 'plan.csv' there?" in report.errors[0].expected


def test_unknown_names(errors):
    found = errors(HEAD + "X,HNF,BrasButlers,2026-11-28,10:00\nX,HWV,Z,2026-11-28,11:00\n",
                   teams=Known(("BrassButlers",), "the teams in --teams"), codes=Known(("HNF",), "those of b.yaml"))
    assert found == [
        (2, 3, "found 'BrasButlers' as team (column C); expected one of the teams in --teams: did you mean "
               "'BrassButlers'?"),
        (3, 2, "found 'HWV' as benchmark (column B); expected one of those of b.yaml (HNF)"),
        (3, 3, "found 'Z' as team (column C); expected one of the teams in --teams (BrassButlers)"),
    ]


def test_a_run_listed_twice(sheet):
    made, report = sheet("zone,benchmark,team,date,time,run\nX,HNF,A,2026-11-28,10:00,1\nY,HNF,A,2026-11-28,11:00,1\n")
    assert made is None
    assert [(error.line, error.found) for error in report.errors] == [(3, "HNF, team 'A', round 1, run 1")]
    assert "it is already in line 2" in report.errors[0].expected


def test_a_hostile_sheet_ends(sheet):
    with pytest.raises(ConfigErrors) as raised:
        sheet(HEAD + "X,HNF,A,x,y\n" * 60_000)
    assert len(raised.value.errors) == 1000


def test_column_names():
    numbers = (1, 26, 27, 52, 53, 702, 703)
    assert [column_name(number) for number in numbers] == ["A", "Z", "AA", "AZ", "BA", "ZZ", "AAA"]
