"""The program: its commands, the files that it writes, and its errors."""

import base64
import csv
import io
import json
import os
import pathlib
import shutil
import subprocess
import sys

import pytest

from helpers.journals import UTC0, Writer, spoil
from helpers.results_of import EVIL, full_record, keep_files, task_record, write_competition
from roah_rsbb.journal.contents import superseded_value
from roah_rsbb.journal.log_dir import JOURNAL
from roah_rsbb.journal.records import Batch, Kind, OutcomeRow
from roah_rsbb.model.as_json import to_json
from roah_rsbb.model.messages import LinkSample
from roah_rsbb.model.records import ItemRecord, PhaseTime, RunRecord, ScoreEntry, ScoreValue
from roah_rsbb.model.rules import Attempts
from roah_rsbb.results import export
from roah_rsbb.results.export import RESULT_COLUMNS, STANDING_COLUMNS
from roah_rsbb.results.program import files as writing
from roah_rsbb.results.program import main as program
from roah_rsbb.wording.texts import visible

ROOT = pathlib.Path(__file__).resolve().parents[4]


@pytest.fixture(scope="module")
def journal(tmp_path_factory):
    return write_competition(tmp_path_factory.mktemp("competition"))


@pytest.fixture
def run(journal, capsys):
    """Run the program. Returns its exit status, its output and its errors."""

    def results(*arguments, source=("--journal", journal)):
        with pytest.raises(SystemExit) as ended:
            program.main([str(a) for a in (*source, *arguments)])
        reported = capsys.readouterr()
        return ended.value.code, reported.out, reported.err

    return results


def rows_of(text):
    return list(csv.DictReader(io.StringIO(text)))


# -- commands ---------------------------------------------------------------------------------------


def test_list_and_show(run):
    status, out, err = run("list")
    assert (status, err, len(out.splitlines())) == (0, "", 6)
    status, out, _ = run("show", "1", "--utc")
    assert status == 0
    assert "2025-11-21 12:00:00Z" in out
    assert "\033" not in out, "the output is no terminal"
    assert run("show", "HNF")[1].startswith("HNF, team Alpha")


@pytest.mark.parametrize("change", ({"elapsed_s": "long"}, {"started_utc": [1]}))
def test_a_record_that_cannot_be_read_costs_only_itself(run, tmp_path, change):
    writer = Writer(tmp_path)
    record = task_record("A", 1)
    writer.run(record)
    outcome = OutcomeRow(record.closed_utc, {**to_json(record), **change})
    writer.journal.write(Batch(outcomes={record.identity: outcome}))
    writer.close()
    status, out, err = run("list", source=("--journal", writer.path))
    assert (status, len(out.splitlines())) == (0, 2)
    assert "cannot be read" in err


def test_a_name_may_not_command_the_terminal(run, tmp_path):
    path = _journal(tmp_path, identity="\x1b[2J")
    spoil(path, b'"items"')
    _, out, err = run("list", source=("--journal", path))
    assert "damaged" in err
    assert "\x1b" not in err + out + run("dump", source=("--journal", path))[1]


def test_the_ways_to_count_runs_are_those_of_the_rules():
    assert tuple(how.value for how in Attempts) == program.OF_RUNS


@pytest.mark.parametrize("is_alone", (False, True))
def test_every_command_says_whether_a_run_counts(run, tmp_path, is_alone):
    """The best attempt counts here, which is the first one. The files are beside the log_dir, or the box kept them."""
    files = {name: (ROOT / "config" / name).read_text("utf-8") for name in ("benchmarks.yaml", "standings.yaml")}
    files["benchmarks.yaml"] = files["benchmarks.yaml"].replace(
        "code: HGTKMH\n", "code: HGTKMH\n  attempt_counts: best\n", 1)
    files["schedule.yaml"] = (
        "- zone: tbm\n  schedule:\n    - { benchmark: HGTKMH, team: Alpha, round: 1, run: 1, "
        "scheduled_time: 2026-11-28 09:00:00, id: mine }\n")

    def write_files():
        if is_alone:
            keep_files(tmp_path / "log", *map(files.get, ("benchmarks.yaml", "schedule.yaml", "standings.yaml")))
            return
        for name, text in files.items():
            (tmp_path / name).write_text(text, "utf-8")

    write_files()
    writer = Writer(tmp_path / "log")
    best = task_record("Alpha", 1, objects=5, event="mine")
    again = task_record("Alpha", 1, objects=1)._replace(
        identity="again", opened_utc=best.opened_utc + 900.0, scheduled=best.scheduled + 2400.0, event="mine")
    for port, record in ((6667, best), (6668, again)):
        writer.run(record, ((port, "r1"),))
    writer.close()
    source = ("--log-dir", tmp_path / "log")
    words = ["counts", "does not count: a better attempt counts"]
    assert [line.split(", ")[-1] for line in run("list", source=source)[1].splitlines()[1:]] == words
    for number, word in enumerate(words, 1):
        assert f"Counting:     {word}\n" in run("show", number, source=source)[1]
    status, out, _ = run("checklist", source=source)
    assert (status, out.splitlines()[1].split()[-5:-3], len(out.splitlines())) == (1, ["completed,", "counts"], 3)
    run("export", "--csv", tmp_path / "r.csv", "--json", tmp_path / "r.json", "--html", tmp_path / "html", "--dataset",
        tmp_path / "data", source=source)
    codes = {best.identity: "counts", "again": "not_best"}
    assert {row["run_id"]: row["counts"] for row in rows_of((tmp_path / "r.csv").read_text("utf-8-sig"))} == codes
    assert {row["run_id"]: row["counts"] for row in rows_of((tmp_path / "data" / "runs.csv").read_text())} == codes
    value = json.loads((tmp_path / "r.json").read_text("utf-8"))
    assert {each["identity"]: each["counts"] for each in value["runs"]} == codes
    assert [line["numbers"] for standing in value["standings"] for line in standing["teams"]] == [[5.0, 0.0]]
    pages = "".join(path.read_text("utf-8") for path in sorted((tmp_path / "html").iterdir()))
    assert all(pages.count(f"<td>{word}</td>") == 2 for word in words)
    # A file with an error does not hide the list.
    files["benchmarks.yaml"] = "- name: 7\n"
    write_files()
    status, out, err = run("list", source=source)
    assert (status, out.count("completed\n")) == (0, 2)
    assert "whether runs count is not known, because a file of the competition is invalid" in err


def test_times_are_those_of_the_venue(run, journal, tmp_path):
    (tmp_path / "schedule.yaml").write_text("- time_zone: Asia/Tokyo\n", "utf-8")
    shutil.copytree(os.path.dirname(journal), tmp_path / "log")
    source = ("--log-dir", tmp_path / "log")
    assert all("+09:00" in line for line in run("list", source=source)[1].splitlines()[1:])
    assert "+09:00" in run("show", 1, source=source)[1]
    run("report", tmp_path / "log", "--html", tmp_path / "html", "--no-replays", source=())
    pages = [tmp_path / "html" / "index.html", *(tmp_path / "html" / "runs").iterdir()]
    assert all("+09:00" in page.read_text("utf-8") for page in pages)
    assert run("list", "--utc", source=source)[1].count("Z ") == 5
    # Without the competition's folder, it is that of the configuration beside the journal.
    lone = tmp_path / "stick" / "log"
    shutil.copytree(tmp_path / "log", lone)
    keep_files(lone, "", "- time_zone: Asia/Tokyo\n")
    assert run("list", source=("--journal", lone / "roah_rsbb_journal"))[1].count("+09:00") == 5
    assert run("standings", "--time-zone", "America/Lima", source=source)[0] == 2  # days are those of the venue


def test_numbers_for_spreadsheets_with_a_decimal_comma(run, tmp_path):
    """Such a spreadsheet takes 300.015 for three hundred thousand and fifteen."""
    path = tmp_path / "new" / "folder" / "r.csv"
    for command in (("export",), ("standings", "HNF")):
        for options in ((), ("--decimal-comma",)):
            assert run(*command, "--csv", path, *options, "--html", tmp_path / "new" / "page")[0] == 0
            text = path.read_text("utf-8-sig")
            head, *rows = csv.reader(io.StringIO(text), delimiter=";" if options else ",")
            assert head == list(RESULT_COLUMNS if command == ("export",) else STANDING_COLUMNS)
            assert ("0,2" if options else "0.2") in {cell for row in rows for cell in row}
        shutil.rmtree(tmp_path / "new")


def test_the_list_does_not_load_what_writes_files():
    script = ("import sys; import roah_rsbb.results.program.main; "
              "print([name for name in sys.modules if name.startswith(('yaml', 'roah_rsbb.results.standing'))])")
    environment = {**os.environ, "PYTHONPATH": str(ROOT / "src")}
    shown = subprocess.run([sys.executable, "-c", script], check=True, stdout=subprocess.PIPE, env=environment).stdout
    assert shown == b"[]\n"


def test_the_journal_is_found_in_the_log_dir(run, journal, monkeypatch, tmp_path):
    assert run("list", source=("--log-dir", os.path.dirname(journal)))[0] == 0
    assert run("list", "--log-dir", os.path.dirname(journal), source=())[0] == 0
    monkeypatch.setenv("HOME", str(tmp_path))
    status, _, err = run("list", source=())
    assert status == 1
    assert f"{tmp_path}/.ros/roah_rsbb/roah_rsbb_journal: " in err


def test_a_journal_without_runs(run, tmp_path):
    Writer(tmp_path).close()
    source = ("--log-dir", tmp_path)
    assert run("list", source=source)[:2] == (0, "There are no runs yet.\n")
    assert "No run has started yet" in run("standings", source=source)[1]
    assert run("export", "--html", tmp_path / "html", source=source)[0] == 0


@pytest.mark.parametrize(("arguments", "status", "reported"), [
    (("show", "9"), 1, "there is no run '9': there are 1 to 5"),
    (("export",), 1, "choose what to write"),
    (("export", "--csv", "/dev/null/x"), 1, "/dev/null: File exists: choose another place"),
    (("standings", "HOPF"), 1, "there are no runs of HOPF; there are some of HGTKMH, HNF"),
    (("standings", "--without", "77"), 1, "there is no run '77'"),
    (("standings", "--rules", "/nowhere/rules"), 1, "a file of the competition is invalid:\n/nowhere/rules"),
    (("standings", "--runs", "2"), 2, "best"),
    ((), 2, "COMMAND"),
    (("--journal", "/nowhere/j", "list"), 1, "the journal is missing"),
])
def test_an_impossible_request_is_reported(run, arguments, status, reported):
    found, out, err = run(*arguments)
    assert (found, out) == (status, "")
    assert reported in err
    assert err.startswith("results")


def test_every_command_has_help(run):
    for command in ((), ("list",), ("show",), ("export",), ("standings",), ("bag",), ("journals",),
                    ("verify",), ("dump",)):
        status, out, _ = run(*command, "--help")
        assert status == 0
        assert "--journal" in out


@pytest.mark.long
def test_a_reader_that_closes_early_is_not_an_error(journal):
    script = "import sys; from roah_rsbb.results.program.main import main; main()"
    command = [sys.executable, "-c", script, "--journal", journal, "export", "--json", "-"]
    environment = {**os.environ, "PYTHONPATH": str(ROOT / "src")}
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=environment)
    process.stdout.read(10)
    process.stdout.close()
    assert process.stderr.read() == b""
    process.stderr.close()
    assert process.wait() == 0


def test_a_terminal_that_knows_only_ascii(journal):
    script = "import sys; from roah_rsbb.results.program.main import main; main()"
    command = [sys.executable, "-c", script, "--journal", journal, "list"]
    environment = {**os.environ, "PYTHONPATH": str(ROOT / "src"), "PYTHONIOENCODING": "ascii"}
    shown = subprocess.run(command, stdout=subprocess.PIPE, env=environment, check=True).stdout.decode("ascii")
    assert "\\u2013" in shown, "the dash of a run that was never started"


def test_verify_and_dump(run, tmp_path):
    path = _journal(tmp_path)
    status, out, err = run("verify", source=("--journal", path))
    assert (status, err) == (0, "")
    assert "in 1 segments are intact" in out
    everything, of_run = (run("dump", *which, source=("--journal", path))[1] for which in ((), ("1",)))
    assert "  start: [" in everything and "  start: [" not in of_run
    assert '  runs: [["HGTKMH-6667-' in of_run
    spoil(path, b'"items"')
    status, out, err = run("verify", source=("--journal", path))
    assert (status, out) == (1, "")
    assert "damaged or missing, between 2025-11-21" in err
    status, _, err = run("show", "1", source=("--journal", path))
    assert status == 0 and "A copy of the journal may have it" in err


def test_the_bags_of_all_runs(run, tmp_path):
    writer = Writer(tmp_path / "log")
    for number in (1, 2):
        writer.run(task_record("Team" + EVIL, number), ((6666 + number, "r1"),))
    writer.run(task_record("None", 3), ())
    writer.close()
    (tmp_path / "log" / "6667.bag").write_bytes(bytes(2_000_000))  # the journal has another folder: it was copied
    status, out, _ = run("bags", source=("--log-dir", tmp_path / "log"))
    heading, first, second, summary = out.splitlines()
    assert status == 0
    assert [line.split()[0] for line in (first, second)] == ["1", "2"]
    assert first.endswith(f"2.0 MB   {tmp_path / 'log' / '6667.bag'}")
    assert second.endswith("missing  /logs/6668.bag")
    assert summary.startswith("1 of 2 bags found")
    assert "\x1b" not in out


def test_the_missing_bags_of_runs_that_are_over_are_made(run, tmp_path):
    writer = Writer(tmp_path / "log")
    for number in (1, 2, 3):
        record = task_record("Alpha", number)
        writer.run(record._replace(closed_utc=0.0) if number == 3 else record, ((6666 + number, "r1"),))
    writer.close()
    (tmp_path / "log" / "6667.bag").write_bytes(b"there")
    status, out, _ = run("bags", "--make", source=("--log-dir", tmp_path / "log"))
    assert (status, out.splitlines()[-1].split(";")[0]) == (0, "2 of 3 bags found")
    assert "not over" in out.splitlines()[3]
    assert (tmp_path / "log" / "6667.bag").read_bytes() == b"there"
    assert (tmp_path / "log" / "6668.bag").read_bytes().startswith(b"#ROSBAG V2.0")


def test_a_data_set(run, journal, tmp_path):
    status, out, _ = run("export", "--dataset", tmp_path / "set", "--licence", "CC0-1.0", "--anonymous")
    assert (status, out) == (0, f"the data set of 5 runs is in {tmp_path / 'set'}\n")
    assert "CC0-1.0" in (tmp_path / "set" / "datapackage.json").read_text(encoding="utf-8")
    assert "Alpha" not in (tmp_path / "set" / "runs.csv").read_text(encoding="utf-8")
    status, _, err = run("export", "--csv", "-", "--anonymous")
    assert (status, "--dataset" in err) == (1, True), "a CSV with names must not look anonymous"


def test_the_journals_of_a_log_dir(run, journal, tmp_path):
    Writer(tmp_path).close()
    shutil.copytree(journal, tmp_path / "roah_rsbb_journal_aside_2025-11-22_10-00-00")
    status, out, _ = run("journals", "--utc", "--log-dir", tmp_path, source=())
    assert status == 0
    first, segment, aside, *_ = out.splitlines()
    assert aside.endswith("started 2025-11-21 11:00:00Z, 5 runs, last connected 2025-11-21 16:00:00Z")
    assert first.endswith("roah_rsbb_journal: started 2025-11-21 11:00:00Z, 0 runs")
    assert "journal-000001-" in segment and segment.endswith("1 records, from 2025-11-21 11:00:00Z")
    assert "there are no journals in" in run("journals", "--log-dir", tmp_path / "none", source=())[2]


def test_a_bag_is_written_from_the_journal_into_a_file_that_is_not_there(run, tmp_path):
    path = tmp_path / "x.bag"
    assert run("bag", "1", path)[0] == 0
    from helpers import bags  # without rosbag, this skips

    found = bags.read(path)
    assert ("/rsbb_log/rsbb_state_str", "STOP") in found
    assert ("/notification", EVIL) in found
    assert not {"command", "address", "notice", "something_new"} & {topic for topic, _ in found}
    before = path.read_bytes()
    assert "with --port: 6667 (r1 of team Alpha)" in run("bag", "1", tmp_path / "y.bag", "--port", "1")[2]
    assert "already" in run("bag", "1", path)[2]
    assert path.read_bytes() == before


# -- spreadsheets -----------------------------------------------------------------------------------


def test_a_row_for_each_item_and_value(run, tmp_path):
    path = tmp_path / "results.csv"
    assert run("export", "--csv", path)[0] == 0
    assert path.read_bytes().startswith(b"\xef\xbb\xbf"), "by this spreadsheet programs know UTF-8"
    rows = rows_of(path.read_text(encoding="utf-8-sig"))
    assert tuple(rows[0]) == export.RESULT_COLUMNS
    first = [row for row in rows if row["run_id"] == full_record().identity]
    assert [(row["kind"], row["name"], row["value"]) for row in first[:5]] == [
        ("item", "Detects the door", "0"), ("item", "Detects a changed object", "2"),
        ("item", "Bumps into the furniture", "0"), ("item", "Hits a person", "0"), ("module", "reached", "2"),
    ]
    assert (first[0]["not_attempted"], first[1]["corrected"], first[1]["changed_by"]) == ("true", "true", "bert")
    assert (first[5]["group"], first[5]["value"], first[5]["unit"]) == ("waypoint 1", "0.12345", "m")
    assert (first[0]["elapsed_s"], first[0]["end_reason"], first[0]["signed_off_by"]) == ("600.5", "stopped", "chief")


def test_the_last_entry_that_counts_is_who_changed_an_item():
    record = task_record("A", 1)
    history = tuple(
        ScoreEntry(n, UTC0 + n, f"who{n} (/referee_desk_1)", "Achievements", "Detects the door", 0, 1,
                   withdrawn_utc=withdrawn)
        for n, withdrawn in ((1, 0.0), (2, 9.0))
    )
    rows = list(export.result_rows([record._replace(history=history)], in_utc=True))
    assert (rows[0]["changed_by"], rows[0]["changed"]) == ("who1", "2025-11-21T11:00:01.000+00:00")
    assert "changed_by" not in rows[1]


@pytest.mark.parametrize("name", ["fully", "007", "1e3", "1_000", "inf", "nan", ""])
def test_a_choice_is_never_a_number(name):
    record = task_record("Alpha", 1, items=(ItemRecord("g", "way", "choice", 3, text=name),))
    row, = export.result_rows([record], in_utc=True)
    assert (row["value"], type(row["value"])) == (name, str)


def test_a_row_for_each_phase():
    phases = (PhaseTime("Enter", 1.0, 12.3456), PhaseTime("=1", 2.0, 3))
    record = task_record("Alpha", 1)._replace(items=(), phases=phases)
    rows = [(row["kind"], row["name"], row["value"], row["unit"]) for row in export.result_rows([record], in_utc=True)]
    assert rows == [("phase", "Enter", 12.346, "s"), ("phase", "=1", 3, "s")]


def test_a_run_with_nothing_has_a_row_of_its_own():
    record = RunRecord("x", "z", "HSUF", "ALL", 1, 1, UTC0, UTC0)
    [row] = export.result_rows([record], in_utc=True)
    assert (row["kind"], row["run_id"], row["started"], row["elapsed_s"]) == ("none", "x", None, None)


@pytest.mark.parametrize(("cell", "shown"), [
    ("=1+1", "'=1+1"), ("+1", "'+1"), ("-1", "'-1"), ("@SUM(A1)", "'@SUM(A1)"), ("  =1", "'  =1"), ("\t=1", "\\t=1"),
    ("\r=1", "\\r=1"), ("＝1", "'＝1"), ("a=1", "a=1"), ("", ""), ("'=1", "''=1"), ("'", "''"), ("''", "'''"),
    ("\x1b[1m", "\\x1b[1m"), ("a\nb", "a\nb"), ("a,b", "a,b"), ('"; DROP', '"; DROP'),
    (-1.5, -1.5), (3, 3), (None, ""), (True, "true"), (False, "false"),
])
def test_no_cell_is_a_formula_and_the_rule_restores_the_text(cell, shown):
    assert export.safe(cell) == shown
    if isinstance(cell, str):
        assert shown[shown.startswith("'"):] == visible(cell)


# -- JSON and pages ---------------------------------------------------------------------------------


def test_json_has_all(run, tmp_path):
    path = tmp_path / "results.json"
    assert run("export", "--json", path)[0] == 0
    data = json.loads(path.read_text(encoding="utf-8"))
    assert (data["format"], data["version"], len(data["runs"])) == ("roah_rsbb results", 2, 5)
    assert data["journal"] == JOURNAL, "no path: the same journal gives the same bytes"
    first = data["runs"][0]
    assert set(RunRecord._fields) <= set(first)
    assert first["history"][1]["withdrawn_by"] == "bert"
    assert set(ScoreEntry._fields) == set(first["history"][0])
    assert first["items"][0]["not_attempted"] is True
    assert first["sign_off"]["who"] == "chief"
    [robot] = first["robot_parts"]
    assert (robot["port"], len(robot["link"])) == (6667, 300)
    assert set(robot["link"][0]) == {"utc", *LinkSample._fields}
    reported = next(entry for entry in first["entries"] if entry["kind"] == "/notification")
    assert (reported["value"], reported["who"], reported["port"]) == (EVIL, "10.0.0.7", 6667)
    table = data["standings"][0]
    assert (table["benchmark"], [team["team"] for team in table["teams"]]) == ("HGTKMH", ["Beta", "Alpha"])
    assert table["teams"][0]["runs"][0]["counts"] is True


def test_only_the_runs_that_are_named(run):
    data = json.loads(run("export", "--json", "-", "4", "2", "2")[1])
    assert [r["team"] for r in data["runs"]] == ["Beta", "Alpha"]
    assert len(rows_of(run("export", "--csv", "-", "4")[1])) == 4


def test_pages(run, tmp_path):
    directory = tmp_path / "a" / "html"
    assert run("export", "--html", directory)[0] == 0
    assert sorted(os.listdir(directory)) == [
        "001_HGTKMH_Alpha_round1_run1.html", "002_HGTKMH_Beta_round1_run2.html", "003_HGTKMH_Gamma_round1_run3.html",
        "004_HNF_Alpha_round1_run4.html", "005_HGTKMH_Alpha_round1_run5.html", "index.html",
    ]
    index = (directory / "index.html").read_text(encoding="utf-8")
    assert 'href="001_HGTKMH_Alpha_round1_run1.html"' in index
    assert "never started" in index
    assert run("export", "--html", directory)[0] == 0, "again, over what is there"


def test_a_file_is_written_whole_or_not_at_all(run, tmp_path, monkeypatch):
    path = tmp_path / "results.csv"
    path.write_text("old")
    monkeypatch.setattr(export, "safe", lambda _: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        program.main(["--log-dir", str(tmp_path), "--journal", _journal(tmp_path), "export",
                                            "--csv", str(path)])
    assert path.read_text() == "old"
    assert not (tmp_path / "results.csv.draft").exists()


def _journal(tmp_path, **fields):
    writer = Writer(tmp_path / "log")
    writer.run(task_record("A", 1)._replace(**fields))
    writer.close()
    return writer.path


# -- standings --------------------------------------------------------------------------------------


def test_standings_and_their_options(run, tmp_path):
    status, out, _ = run("standings", "HGTKMH")
    assert status == 0
    assert [line.split()[1] for line in out.splitlines()[2:4]] == ["Beta", "Alpha"]
    assert "HNF" not in out
    assert "Beta   5" not in run("standings", "HGTKMH", "--signed-off")[1]
    assert "Beta   5" not in run("standings", "HGTKMH", "--without", "2")[1]
    assert "the mean of each" in run("standings", "--runs", "mean")[1]
    rules = tmp_path / "rules.yaml"
    rules.write_text("HGTKMH: {criteria: [{name: Least, better: less, of: [{group: Achievements}]}]}")
    out = run("standings", "HGTKMH", "--rules", rules)[1]
    assert [line.split()[1] for line in out.splitlines()[2:4]] == ["Alpha", "Beta"]


def test_standings_as_files(run, tmp_path):
    files = (option for kind in ("csv", "json", "html") for option in (f"--{kind}", tmp_path / f"s.{kind}"))
    assert run("standings", *files, "--tables", tmp_path / "tables")[0] == 0
    rows = rows_of((tmp_path / "s.csv").read_text(encoding="utf-8-sig"))
    assert tuple(rows[0]) == export.STANDING_COLUMNS
    assert [(r["rank"], r["team"], r["criterion"], r["number"]) for r in rows[:2]] == [
        ("1", "Beta", "Achievements", "5.0"), ("1", "Beta", "Penalties", "1.0")
    ]
    data = json.loads((tmp_path / "s.json").read_text())
    assert [s["benchmark"] for s in data["standings"]] == ["HGTKMH", "HNF"]
    assert "Beta" in (tmp_path / "s.html").read_text()
    scores, attempts, stages = ((tmp_path / "tables" / name).read_text("utf-8")
                                for name in ("scores.csv", "scores.md", "standings.md"))
    held = [row["Score"] for row in rows_of(scores) if (row["Task"], row["Team"]) == ("HGTKMH", "Beta")]
    assert "5" in held and attempts.count("| Beta ") == scores.count(",Beta,") and stages == ""  # no rules: no stages


# -- paper and the checklist ------------------------------------------------------------------------


@pytest.fixture
def folder(tmp_path):
    """The folder of a competition, with its journal in `log`."""
    for name in ("benchmarks.yaml", "schedule.yaml"):
        shutil.copyfile(ROOT / "config" / name, tmp_path / name)
    write_competition(tmp_path / "log")
    return tmp_path


@pytest.mark.long
def test_titles_come_from_the_competitions_folder(run, folder):
    text = (folder / "benchmarks.yaml").read_text().replace("desc: Getting to know my home", "desc: Our own title")
    (folder / "benchmarks.yaml").write_text(text)
    source = ("--log-dir", folder / "log")
    assert "Our own title (HGTKMH): the best run" in run("standings", "HGTKMH", source=source)[1]
    shipped = run("standings", "--benchmarks-file", ROOT / "config" / "benchmarks.yaml", source=source)[1]
    assert "Getting to know my home (HGTKMH)" in shipped
    assert run("export", "--html", folder / "out", source=source)[0] == 0
    assert "Our own title (HGTKMH)" in (folder / "out" / "index.html").read_text()
    (folder / "benchmarks.yaml").write_text("nonsense: [")
    status, _, err = run("standings", source=source)
    assert status == 1
    assert f"{folder}/benchmarks.yaml:1" in err


@pytest.mark.long
def test_pages_without_the_appendix(run, tmp_path):
    assert run("export", "1", "--html", tmp_path, "--no-appendix")[0] == 0
    (name,) = [name for name in os.listdir(tmp_path) if name.startswith("001")]
    assert "Appendix" not in (tmp_path / name).read_text()
    assert run("export", "1", "--html", tmp_path)[0] == 0
    assert "Appendix" in (tmp_path / name).read_text()


def test_pdf(run, tmp_path, monkeypatch):
    printed = {}
    monkeypatch.setattr(writing, "browser", lambda: "chromium")

    class Printer:
        """Notes what is printed."""

        started = 0

        def __enter__(self):
            Printer.started += 1
            return self

        def __exit__(self, *_):
            pass

        @staticmethod
        def print(text, path):
            printed[os.path.basename(path)] = text

    monkeypatch.setattr(writing, "Printer", Printer)
    monkeypatch.setattr(writing, "print_pdf", Printer.print)
    status, out, _ = run("export", "1", "2", "--pdf", tmp_path / "pdf")
    assert (status, out) == (0, f"2 score sheets and index.pdf are in {tmp_path}/pdf\n")
    assert sorted(printed) == ["001_HGTKMH_Alpha_round1_run1.pdf", "002_HGTKMH_Beta_round1_run2.pdf", "index.pdf"]
    assert 'href="002_HGTKMH_Beta_round1_run2.pdf"' in printed["index.pdf"]
    assert Printer.started == 1
    assert run("standings", "--pdf", tmp_path / "s.pdf")[0] == 0
    assert "Standings" in printed["s.pdf"]


LOGO = base64.b64decode("iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAQAAAC1HAwCAAAAC0lEQVR42mNk+A8AAQUBAScY42YAAAAASUVORK5CYII=")


def test_title_and_logo_of_the_competition(run, tmp_path):
    (tmp_path / "logo.PNG").write_bytes(LOGO)
    brand = ("--title", "Erl <2026> & Co", "--logo", tmp_path / "logo.PNG")
    assert run("export", "1", "--html", tmp_path / "html", *brand)[0] == 0
    assert run("standings", "--html", tmp_path / "standings.html", *brand)[0] == 0
    assert run("blank", "HGTKMH", "--html", tmp_path / "blank.html", *brand)[0] == 0
    pages = [*(tmp_path / "html").iterdir(), tmp_path / "standings.html", tmp_path / "blank.html"]
    assert len(pages) == 4
    head = ('<div class="competition"><img src="data:image/png;base64,' + base64.b64encode(LOGO).decode()
            + '" alt=""><p>Erl &lt;2026&gt; &amp; Co</p></div>')
    for path in pages:
        text = path.read_text()
        assert head in text and "img-src data:;" in text
    assert 'class="competition"' not in _html_of(run, tmp_path, "standings")


def _html_of(run, tmp_path, command):
    assert run(command, "--html", tmp_path / "plain.html")[0] == 0
    return (tmp_path / "plain.html").read_text()


@pytest.mark.parametrize("name, content, reason", [
    ("logo.png", b"no picture", "is not a picture: give a PNG, JPEG or SVG file"),
    ("logo.gif", b"GIF89a", "is not a picture"), ("missing.svg", None, "No such file or directory: choose another"),
])
def test_a_logo_that_is_not_a_picture_is_refused_before_anything_is_written(run, tmp_path, name, content, reason):
    if content is not None:
        (tmp_path / name).write_bytes(content)
    status, _, err = run("export", "--html", tmp_path / "html", "--csv", tmp_path / "csv", "--logo", tmp_path / name)
    assert (status, err.count(reason)) == (1, 1)
    assert not (tmp_path / "html").exists() and not (tmp_path / "csv").exists()


def test_without_a_browser_nothing_is_written(run, tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    status, _, err = run("export", "--html", tmp_path / "html", "--pdf", tmp_path / "pdf")
    assert (status, os.listdir(tmp_path)) == (1, [])
    assert "install it (sudo apt install chromium)" in err


def test_without_the_library_of_mcap_nothing_is_written(run, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "mcap.writer", None)
    status, _, err = run("export", "--mcap", tmp_path / "mcap", "--csv", tmp_path / "csv")
    assert (status, os.listdir(tmp_path)) == (1, [])
    assert "pip install mcap-ros2-support" in err


@pytest.mark.long
def test_blank_sheets(run, folder):
    source = ("--log-dir", folder / "log")
    assert "choose what to write" in run("blank", source=source)[2]
    unknown = run("blank", "X", "--html", folder / "b.html", source=source)
    assert "there is no benchmark X; there are HGTKMH" in unknown[2]
    status, out, _ = run("blank", "--html", folder / "b.html", source=source)
    assert (status, out) == (0, f"34 empty score sheets are in {folder}/b.html\n")
    text = (folder / "b.html").read_text()
    assert text.count('class="front"') == 34
    assert "CopperKettle" in text
    run("blank", "HWV", "--html", folder / "b.html", source=source)
    text = (folder / "b.html").read_text()
    assert text.count("Welcoming visitors (HWV)") == text.count('class="front"') == 5
    one = "{benchmark: HWV, team: T, round: 1, run: 1, scheduled_time: 2026-01-01 10:00:00}"
    (folder / "schedule.yaml").write_text(f"- zone: A\n  schedule:\n    - {one}\n")
    status, out, _ = run("blank", "--html", folder / "b.html", source=source)
    assert out.startswith("11 empty"), "one event, and each other benchmark"


@pytest.mark.long
def test_the_checklist(run, folder):
    source = ("--log-dir", folder / "log")
    status, out, _ = run("checklist", "--utc", source=source)
    assert status == 1
    assert "✘  2015-12-31 00:00:00Z  Testing TestingTeam" in out
    assert out.splitlines()[-1] == "1 of 38 signed off, 3 not signed off, 34 without a run"
    assert "✔" in out
    assert "✔" not in run("checklist", "--missing", source=source)[1]
    (folder / "schedule.yaml").write_text("- zone: A\n  schedule: 3\n")
    status, _, err = run("checklist", source=source)
    assert status == 1
    assert f"{folder}/schedule.yaml:2" in err


def test_a_code_that_this_installation_does_not_know_is_shown_all_the_same(run, tmp_path):
    """The journal alone is enough: here is neither the competition's benchmarks.yaml nor its rules. Where these matter,
    one line says which are used."""
    log_dir = tmp_path / "elsewhere" / "log"
    log_dir.mkdir(parents=True)
    writer = Writer(log_dir)
    for number, points in ((1, 3), (2, 5)):
        record = task_record("Alpha" if number == 1 else "Beta", number, objects=points, benchmark="FetchMug")
        value = ScoreValue("", "mugs", "2", "", "Mugs fetched")
        writer.run(record._replace(module_scores=(value,)), ((6666 + number, "r1"),))
    writer.close()
    source = ("--journal", writer.path)
    status, out, err = run("list", source=source)
    assert (status, out.count("FetchMug")) == (0, 2)
    assert err.count("\n") == 1
    assert f"there is no configuration.json in {log_dir}, and no file of the competition beside it: those of " in err
    assert run("verify", source=source)[2] == ""
    assert run("show", "1", source=source)[::2] == (0, err)
    out = run("show", "1", source=source)[1]
    assert out.startswith("FetchMug, team Alpha")
    assert "Mugs fetched" in out
    assert run("standings", source=source)[::2] == (0, err)
    out = run("standings", source=source)[1]
    assert out.index("Beta") < out.index("Alpha")
    to = ("--json", tmp_path / "runs.json", "--html", tmp_path / "sheets")
    assert run("export", *to, source=source)[::2] == (0, err)
    assert "FetchMug" in (tmp_path / "sheets" / "index.html").read_text("utf-8")
    assert "FetchMug" in (tmp_path / "runs.json").read_text("utf-8")


# -- a journal that forks ---------------------------------------------------------------------------


def test_the_runs_that_only_the_old_box_has_are_named(run, tmp_path):
    """They are never merged."""
    writer = Writer(tmp_path)
    for number in (1, 2):
        writer.run(task_record("Alpha", number), robots=((6666 + number, "r1"),))
    writer.entry("/notification", "in both")
    source = ("--log-dir", tmp_path)
    assert "took over" not in run("list", source=source)[2]
    both = writer.journal.number_of(writer.journal.committed)
    writer.entry("/notification", "only here", identity=task_record("Alpha", 2).identity)
    writer.entry(Kind.EPOCH, superseded_value(2, both, "10.0.0.3"), port=None)
    writer.close()
    warning = run("list", source=source)[2]
    assert "the box at 10.0.0.3 took over" in warning and f"after record {both}: run 2 (1 entries)" in warning
