"""The report of a competition: its pages, and that all outputs of a journal agree."""

import csv
import hashlib
import html.parser
import itertools
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys

import pytest

from helpers.box_driver import MONO0
from helpers.golden import DATA
from helpers.journaled import NO_LISTENING, JournaledDriver
from helpers.journals import UTC0, Writer
from helpers.many_runs import write_journal
from helpers.recorded_session import Replay, goals_of, waypoint
from helpers.replayed import ReplayedCompetition
from helpers.results_of import ACHIEVED, DOOR, EVIL, full_record, runs_in, task_record, write_competition
from roah_rsbb.journal.log_dir import JOURNAL
from roah_rsbb.model.messages import LinkSample
from roah_rsbb.model.records import ItemRecord, PhaseTime, ScoreEntry, ScoreValue, StopRecord
from roah_rsbb.results import report_numbers
from roah_rsbb.results.program import files as writing
from roah_rsbb.results.program import main as program
from roah_rsbb.results.report import PAGES, Axes, plot
from roah_rsbb.results.report_numbers import facts_of, link_period_s
from roah_rsbb.rulebook.standing_rules import read_rules
from roah_rsbb.scoring.counting import RunChoice
from roah_rsbb.scoring.standings import standings

ROOT = pathlib.Path(__file__).resolve().parents[4]
RESOURCES = ROOT / "resource" / "report"


def run_program(*arguments):
    with pytest.raises(SystemExit) as ended:
        program.main([str(a) for a in arguments])
    assert ended.value.code == 0


def report(journal, folder, *options):
    """Write a report; returns its pages by their names."""
    run_program("--journal", journal, "report", "--html", folder, "--utc", *options)
    return {str(path.relative_to(folder)): path.read_text(encoding="utf-8") for path in sorted(folder.rglob("*.html"))}


def facts(journal):
    results = runs_in(journal)
    return [result.record for result in results], [facts_of(result) for result in results]


class Texts(html.parser.HTMLParser):
    """The texts and tags of a page."""

    def __init__(self, page):
        super().__init__()
        self.texts, self.tags, self.attributes, self._hidden, self._open = [], [], set(), 0, []
        self.feed(page)
        self.close()
        assert self._open == [], "every element is closed"

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        self.attributes.update(name for name, _ in attrs)
        self._hidden += tag in ("script", "style")
        if tag not in ("br", "img", "meta", "wbr"):
            self._open.append(tag)

    def handle_endtag(self, tag):
        self._hidden -= tag in ("script", "style")
        assert self._open.pop() == tag

    def handle_data(self, data):
        if not self._hidden and data.strip():
            self.texts.append(data.strip())


# -- golden reports ---------------------------------------------------------------------------------


def recorded(log_dir):
    """The journal of a box in the place of the original one, in a session of the original client."""

    def make(competition):
        driver = JournaledDriver(log_dir, competition, NO_LISTENING)
        driver.run(MONO0 + 10 - driver.now.mono)
        return driver

    replay = Replay("HNF_2020", "HNF", timeout=600.0, script=[waypoint(goal) for goal in goals_of("HNF_2020")],
                    make=make)
    assert replay.refused == []
    replay.driver.journal.close()
    return replay.driver.journal.path


def simulated(log_dir):
    return ReplayedCompetition(log_dir).play()


@pytest.mark.parametrize("make", [recorded, simulated])
def test_golden_reports(make, tmp_path):
    pages = report(make(tmp_path / "log"), tmp_path / "report", "--no-replays")
    texts = [f"== {name}\n" + "\n".join(Texts(text).texts) + "\n" for name, text in pages.items() if "/" not in name]
    expected = DATA / "reports" / f"{make.__name__}.txt"
    found = "\n".join(texts)
    if found != expected.read_text(encoding="utf-8"):
        (tmp_path / "actual.txt").write_text(found, encoding="utf-8")
        subprocess.run(["diff", "-u", str(expected), str(tmp_path / "actual.txt")], check=False)
    assert found == expected.read_text(encoding="utf-8"), "compare them, then replace the file in test/data/reports"


# -- totals -----------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def many(tmp_path_factory):
    return write_journal(tmp_path_factory.mktemp("many"), 24, zones=6, seconds=8)


@pytest.fixture(scope="module", params=["many", "replayed", "full"])
def journal(request, many, tmp_path_factory):
    if request.param == "many":
        return many
    folder = tmp_path_factory.mktemp(request.param)
    return write_competition(folder) if request.param == "full" else ReplayedCompetition(folder, 2).play()


def number(cell):
    return float(cell) if cell else 0.0


def test_report_sheets_data_set_and_standings_agree(journal, tmp_path):
    known, runs = facts(journal)
    run_program("--journal", journal, "export", "--dataset", tmp_path, "--csv", tmp_path / "results.csv", "--json",
                tmp_path / "results.json", "--html", tmp_path / "sheets", "--utc")
    tables = {}
    for name in ("runs", "scores", "goals", "events", "link"):
        with open(str(tmp_path / f"{name}.csv"), encoding="utf-8", newline="") as file:
            tables[name] = list(csv.DictReader(file))
    with open(str(tmp_path / "results.csv"), encoding="utf-8-sig", newline="") as file:
        rows = list(csv.DictReader(file))
    exported = json.loads((tmp_path / "results.json").read_text(encoding="utf-8"))
    assert [run["identity"] for run in exported["runs"]] == [row["run_id"] for row in tables["runs"]]
    assert len(tables["runs"]) == len(known) == len(os.listdir(str(tmp_path / "sheets"))) - 1
    for run in runs:
        _assert_same_run(run, tables, rows)
    over = {row["run_id"] for row in tables["runs"] if row["started"] and row["end_reason"]}
    codes = {row["run_id"]: row["benchmark"] for row in tables["runs"]}
    items = [row for row in tables["scores"] if row["kind"] == "item" and row["run_id"] in over]
    lines = report_numbers.item_lines(runs)
    assert sum(line.runs for line in lines) == len(items)
    for line in lines:
        of_line = [row for row in items if (codes[row["run_id"]], row["group"], row["name"])
                   == (line.benchmark, line.group, line.name)]
        assert line.achieved == sum(number(row["value"]) != 0 for row in of_line)
        assert line.not_attempted == sum(row["not_attempted"] == "true" for row in of_line)
    assert sum(line.runs for line in report_numbers.end_lines(runs)) == len(known)
    assert len(report_numbers.unsigned(runs)) == sum(
        bool(row["end_reason"]) and not row["signed_off"] for row in tables["runs"])
    links = report_numbers.links(runs).values()
    for name in ("received", "lost"):
        assert sum(getattr(link, name) for link in links) == sum(int(row[name]) for row in tables["link"])
    assert sum(line.runs for line in report_numbers.goal_lines(runs)) == len(tables["goals"])
    assert sum(run.warnings for run in runs) == sum(row["bad"] == "true" for row in tables["events"])


def _assert_same_run(run, tables, rows):
    record = run.record
    scores = [row for row in tables["scores"] if row["run_id"] == record.identity]
    of_csv = [row for row in rows if row["run_id"] == record.identity and row["kind"] != "none"]
    assert [(row["kind"], row["group"], row["name"], row["points"]) for row in scores] == [
        (row["kind"], row["group"], row["name"], row["points"]) for row in of_csv]
    assert [row["value"] or row["text"] for row in scores] == [
        {"true": "1", "false": "0"}.get(row["value"], row["value"]) for row in of_csv]
    if record.points is not None:
        total, = (row["points"] for row in scores if row["kind"] == "total")
        assert number(total) == float(record.points.total)
        assert number(total) == pytest.approx(sum(number(row["points"]) for row in scores if row["kind"] == "group"))
    assert sum(number(row["value"]) for row in scores if row["kind"] == "phase") == pytest.approx(
        sum(phase.elapsed_s for phase in record.phases), abs=0.002 * len(record.phases) + 1e-9)


def test_standings_are_those_of_the_scores(many, tmp_path):
    known, _ = facts(many)
    rules = read_rules(str(ROOT / "config" / "standings.yaml"))
    run_program("--journal", many, "export", "--dataset", tmp_path / "set")
    with open(str(tmp_path / "set" / "scores.csv"), encoding="utf-8", newline="") as file:
        scores = list(csv.DictReader(file))
    checked = 0
    for standing in standings(known, rules, RunChoice()):
        assert [c.name for c in standing.criteria] == ["Achievements", "Penalties"]
        for run in itertools.chain.from_iterable(line.runs for line in standing.lines):
            for place, group in enumerate(("Achievements", "Penalized Behaviors")):
                assert run.numbers[place] == sum(
                    number(row["value"]) for row in scores
                    if (row["run_id"], row["kind"], row["group"]) == (run.record.identity, "item", group))
                checked += 1
    assert checked >= 20


# -- statistics, worked out by hand -----------------------------------------------------------------


def _statistics_of(log_dir):
    writer = Writer(log_dir)
    for place, (door, end, delay, marked) in enumerate((
        (1, "completed", 60.0, 10.0), (0, "stopped", -30.0, None), (1, "completed", 400.0, 30.0),
        (1, "timeout", 0.0, 20.0),
    ), 1):
        record = task_record("Alpha" if place < 3 else "Beta", place, door=door, end_reason=end)
        history = () if marked is None else (
            ScoreEntry(1, record.started_utc + 5.0, "anna", ACHIEVED, DOOR, 0, 1, withdrawn_utc=1.0),
            ScoreEntry(2, record.started_utc + marked, "anna", ACHIEVED, DOOR, 0, 1),
            ScoreEntry(3, record.started_utc + 900.0, "anna", ACHIEVED, DOOR, 0, 1, correction=True))
        stop = StopRecord(record.started_utc, "anna", "stopped", "")
        writer.run(record._replace(
            scheduled=record.started_utc - delay, history=history, stops=(stop,) * place,
            phases=(PhaseTime("kitchen", 0.0, 10.0 * place),)), ((6666 + place, "r1"),))
        writer.utc = record.opened_utc
        for second in range(place):
            writer.link(LinkSample(1.0, received=9, lost=1, gap_s=float(second)), 6666 + place)
    writer.run(task_record("Beta", 5, started_utc=0.0, end_reason="", elapsed_s=0.0), ((6671, "r1"),))
    writer.close()
    return facts(writer.path)[1]


def test_statistics_by_hand(tmp_path):
    runs = _statistics_of(tmp_path)
    door = report_numbers.item_lines(runs)[0]
    assert (door.runs, door.achieved, door.share) == (4, 3, 0.75)
    assert door.after_s == (3, 10.0, 20.0, 30.0)
    phase, = report_numbers.phase_lines(runs)
    assert (phase.name, phase.runs, phase.seconds) == ("kitchen", 4, (4, 10.0, 25.0, 40.0))
    ends, = report_numbers.end_lines(runs)
    assert ends.ends == {"": 1, "completed": 2, "stopped": 1, "timeout": 1}
    assert (ends.runs, ends.restarts, ends.repeated) == (5, 0 + 1 + 2 + 3, 0)
    delays, = report_numbers.delay_lines(runs)
    assert (delays.delays_s, delays.late) == ((4, -30.0, 30.0, 400.0), 1)
    links = report_numbers.link_of_teams(runs)
    assert (links["Alpha"].received, links["Alpha"].lost, links["Alpha"].longest_gap_s) == (27, 3, 1.0)
    assert links["Beta"].lost_share == pytest.approx(0.1)
    assert len(report_numbers.unsigned(runs)) == 4


@pytest.mark.parametrize("minutes, period_s", [(0.5, 60), (12, 60), (13, 300), (59, 300), (110, 600), (480, 3600),
                                               (5000, 3600)])
def test_a_short_competition_has_short_periods(minutes, period_s):
    runs = [task_record("Alpha", 1), task_record("Beta", 2, opened_utc=task_record("Alpha", 1).opened_utc + 9.0)]
    as_of = runs[0].opened_utc + 60.0 * minutes
    runs[0] = runs[0]._replace(closed_utc=runs[0].opened_utc + 10.0)
    assert link_period_s([runs[0], runs[1]._replace(closed_utc=0.0)], as_of) == period_s
    assert link_period_s([runs[0], runs[1]._replace(closed_utc=as_of)], as_of + 1e6) == period_s
    assert link_period_s([], as_of) == 60


def test_links_in_periods(tmp_path):
    writer = Writer(tmp_path)
    record = task_record("Alpha", 1, opened_utc=UTC0)
    writer.run(record, ((6667, "r1"),))
    writer.utc = UTC0 - 1.0
    for second in range(150):
        writer.link(LinkSample(1.0, received=9, lost=int(second == 70), gap_s=float(second == 130)))
    writer.close()
    found = facts_of(runs_in(writer.path)[0], 60).link
    assert {utc - UTC0: (link.received, link.lost, link.longest_gap_s, link.seconds) for (_, utc), link in found.items()
            } == {0.0: (540, 0, 0.0, 60.0), 60.0: (540, 1, 0.0, 60.0), 120.0: (270, 0, 1.0, 30.0)}


# -- pages ------------------------------------------------------------------------------------------


def test_labels_of_an_axis_do_not_overlap():
    """Also if there are few of them, but most at the same place: a day of runs, and one of the day before."""
    hour = 3600.0
    markup = plot("delays", Axes("x", "y"), [str(i) for i in range(10)], {}, [0.0, *(24 * hour + i for i in range(9))])
    data = json.loads(re.search(r">(\{.*\})<", markup).group(1))
    assert data["ticks"] == [[0.0, "0"], [24 * hour, "1"]]
    assert plot("empty", Axes("x", "y"), [], {})
    even = plot("even", Axes("x", "y"), [str(i) for i in range(24)], {})
    assert len(json.loads(re.search(r">(\{.*\})<", even).group(1))["ticks"]) == 24


def test_every_page_is_linked_and_every_link_leads_somewhere(journal, tmp_path):
    pages = report(journal, tmp_path / "report")
    linked = set()
    for name, text in pages.items():
        for target in re.findall(r'href="([^"#]+)"', text):
            assert (tmp_path / "report" / os.path.dirname(name) / target).is_file(), (name, target)
            linked.add(os.path.normpath(os.path.join(os.path.dirname(name), target)))
    assert linked == set(pages)


def test_no_line_of_the_link_crosses_a_night(tmp_path):
    writer = Writer(tmp_path / "log")
    for number, hour in enumerate((0, 1, 15, 24), 1):
        writer.run(task_record("Alpha", number, opened_utc=UTC0 + 3600.0 * hour, closed_utc=UTC0 + 3600.0 * hour + 9.0),
                   ((6666 + number, "r1"),))
        writer.utc = UTC0 + 3600.0 * hour
        writer.link(LinkSample(1.0, received=3, lost=1), 6666 + number)
    writer.close()
    text = report(writer.path, tmp_path / "report", "--no-replays")["link.html"]
    data = json.loads(re.search(r'id="lost">(\{.*?\})<', text).group(1))
    hours, lost = data["data"]
    assert [hour / 3600 for hour in hours] == [0, 1, 2, 15, 16, 24]
    assert lost == [25.0, 25.0, None, 25.0, None, 25.0]


def test_several_competitions(tmp_path, capsys):
    first, second = tmp_path / "first", tmp_path / "second"
    write_journal(first / "log", 6, zones=3, seconds=4)
    (tmp_path / "second").mkdir()
    write_competition(second)
    run_program("report", first / "log" / JOURNAL, second, "--html", tmp_path / "report", "--no-replays")
    assert "2 competitions" in capsys.readouterr().out
    page = (tmp_path / "report" / "index.html").read_text(encoding="utf-8")
    texts = Texts(page).texts
    assert "1. first" in texts and "2. second" in texts
    for number_, runs in (("1", "6 runs."), ("2", "5 runs.")):
        own = (tmp_path / "report" / f"competition{number_}" / "index.html").read_text(encoding="utf-8")
        assert 'href="../index.html"' in own and runs in own
    with pytest.raises(SystemExit):
        program.main(["report", str(tmp_path / "nothing")])
    assert "there is no journal" in capsys.readouterr().err


@pytest.mark.parametrize("ends, reported", [
    (lambda: os.kill(os.getpid(), signal.SIGKILL), "ended early: free memory"),
    (lambda: os.listdir("/dev/null/x"), "/dev/null/x: Not a directory"),
])
def test_a_process_that_ends_early_is_reported(many, tmp_path, monkeypatch, capsys, ends, reported):
    monkeypatch.setattr(writing, "facts_of", lambda *_: ends())
    monkeypatch.setattr("os.sched_getaffinity", lambda _: {0, 1})
    with pytest.raises(SystemExit) as ended:
        program.main(["--journal", many, "report", "--html", str(tmp_path)])
    assert ended.value.code == 1 and reported in capsys.readouterr().err
    with pytest.raises(ChildProcessError):
        os.waitpid(-1, os.WNOHANG)


def test_the_library_is_the_original_one():
    """See resource/report/README.md."""
    sums = {
        "uPlot.iife.min.js": "19c8d4c6ad88929a79f4ae49d6f7161566dfd0ba3d15cc495e974f787eb78f1f",
        "uPlot.min.css": "df630c6a8d6f8eeaff264b50f73ce5b114f646ffd9a0bb74f049b0a00135fa04",
        "LICENSE.uPlot": "8f989229699b4fe2f1a0432d0e9edc338a8a911e250e2d1b01ecd770a5f5b1bd",
    }
    for name, digest in sums.items():
        assert hashlib.sha256((RESOURCES / name).read_bytes()).hexdigest() == digest


# -- hostile texts ----------------------------------------------------------------------------------

HOSTILE = f"=cmd()</script></title><svg onload=alert(1)>'\"`{EVIL}\u2028../../{'x' * 300}\n=cmd()"
PLOTTED = {"items.html", "times.html", "link.html"}
TAGS = {"html", "head", "meta", "title", "style", "script", "body", "nav", "b", "a", "h1", "h2", "h3", "p", "div",
        "span", "table", "thead", "tbody", "tr", "th", "td", "meter", "br", "wbr", "del", "svg", "rect", "line", "path",
        "text", "circle", "main"}
ATTRIBUTES = {"lang", "charset", "http-equiv", "content", "name", "href", "class", "id", "type", "min", "max", "value",
              "data-plot"}


def _hostile(log_dir):
    writer = Writer(log_dir)
    record = full_record()
    items = (*record.items, ItemRecord(HOSTILE, HOSTILE, "bool", 1), ItemRecord("g", "way", "choice", 0, text=HOSTILE))
    record = record._replace(
        zone=HOSTILE, team=HOSTILE, benchmark="H" + HOSTILE, robots=(HOSTILE,), items=items, end_reason=HOSTILE,
        sign_off=record.sign_off._replace(who=HOSTILE), phases=(PhaseTime(HOSTILE, 0.0, 1.0),),
        module_scores=(ScoreValue(HOSTILE, HOSTILE, json.dumps(HOSTILE), HOSTILE, HOSTILE),
                       ScoreValue("", "error", "-0.5", "m")),
        history=tuple(entry._replace(who=HOSTILE, note=HOSTILE, group=HOSTILE, desc=HOSTILE, withdrawn_by=HOSTILE)
                      for entry in record.history),
        stops=tuple(stop._replace(who=HOSTILE, reason=HOSTILE, desc=HOSTILE) for stop in record.stops))
    writer.run(record, ((6667, HOSTILE),))
    writer.run(task_record(HOSTILE, 2, sign_off=None), ((6668, HOSTILE),))
    writer.utc = record.opened_utc
    for kind in ("/notification", "/visitor", "/rsbb_log/result", "/rsbb_log/bmbox/goal", "notice", "command", HOSTILE,
                 "/rsbb_log/rsbb_state_str", "/rsbb_log/rsbb_state_desc", "address", "/rsbb_log/manual_operation",
                 "/rsbb_log/client_state"):
        writer.entry(kind, HOSTILE, record.identity, who=HOSTILE)
    writer.link(LinkSample(1.0, received=1, host=HOSTILE))
    writer.close()
    return writer.path


def test_no_text_is_markup_a_formula_or_a_command_of_a_terminal(tmp_path, capsys):
    journal = _hostile(tmp_path / "log")
    pages = report(journal, tmp_path / "report")
    run_program("--journal", journal, "export", "--dataset", tmp_path / "set", "--csv", tmp_path / "results.csv",
                "--html", tmp_path / "sheets")
    run_program("--journal", journal, "standings", "--csv", tmp_path / "standings.csv")
    for path in (tmp_path / "sheets").iterdir():
        pages[path.name] = path.read_text(encoding="utf-8")
    for name, text in pages.items():
        if name.endswith("_replay.html"):
            continue  # tested with the replay
        parsed = Texts(text)
        assert set(parsed.tags) <= TAGS, name
        assert "Content-Security-Policy\" content=\"default-src 'none';".replace("'", "&#x27;") in text
        assert name in PLOTTED or not re.search(r"url\(|@import", text)
        svg = "svg" in parsed.tags
        assert svg or parsed.attributes <= ATTRIBUTES, name
        assert not {each for each in parsed.attributes if each.startswith("on") or each in ("src", "style")}, name
        blocks = re.findall(r"<script>|<script type=\"application/json\" id=\"[a-z0-9]+\">", text)
        assert parsed.tags.count("script") == len(blocks)
        assert text.count("\u202e") == text.count("\x1b") == 0
    for path in tmp_path.rglob("*"):
        assert re.fullmatch(r"[\w.-]{1,150}", path.name) and tmp_path in path.resolve().parents
    for path in (*(tmp_path / "set").glob("*.csv"), *tmp_path.glob("*.csv")):
        with open(str(path), encoding="utf-8-sig", newline="") as file:
            for row in csv.reader(file):
                assert not [cell for cell in row if re.match(r" *[=+@\t\r|%]|-[^\d]", cell)], path
    assert "-0.5" in (tmp_path / "results.csv").read_text("utf-8-sig"), "a number is no formula"
    capsys.readouterr()
    for command in (("list",), ("show", "1"), ("standings",), ("bags",)):
        run_program("--journal", journal, *command)
        shown = capsys.readouterr()
        assert all(c.isprintable() or c == "\n" for c in shown.out + shown.err)


# -- determinism ------------------------------------------------------------------------------------

SCRIPT = """
import contextlib
from roah_rsbb.results.program.main import main
for arguments in (
    ["export", "--csv", "results.csv", "--json", "results.json", "--html", "sheets", "--dataset", "set"],
    ["export", "--dataset", "anonymous", "--anonymous"], ["report"],
    ["standings", "--csv", "standings.csv", "--json", "standings.json", "--html", "standings.html"],
):
    with contextlib.suppress(SystemExit):
        main(["--log-dir", "log", "--utc", *arguments])
"""


def _use_one_processor():
    os.sched_setaffinity(0, [min(os.sched_getaffinity(0))])


@pytest.mark.long
def test_the_same_journal_gives_the_same_bytes_in_every_format(tmp_path):
    """In another folder, with another seed of Python's hashes, another time zone and language of the computer, and
    with one processor."""
    ReplayedCompetition(tmp_path / "log").play()
    written = []
    for number_, (seed, zone, language) in enumerate((("1", "UTC", "C.UTF-8"), ("2", "Asia/Tokyo", "C"))):
        folder = tmp_path / f"place {number_}"
        shutil.copytree(str(tmp_path / "log" / "0"), str(folder / "log"))
        environment = {**os.environ, "PYTHONHASHSEED": seed, "TZ": zone, "LC_ALL": language}
        subprocess.run([sys.executable, "-c", SCRIPT], cwd=str(folder), env=environment,
                       check=True, stdout=subprocess.DEVNULL, preexec_fn=_use_one_processor if number_ else None)
        shutil.rmtree(str(folder / "log"))
        written.append({str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*")
                        if path.is_file()})
    first, second = written
    assert sorted(first) == sorted(second)
    assert len(first) > 25 and {name for name, _ in PAGES} <= {os.path.basename(name) for name in first}
    assert [name for name in first if first[name] != second[name]] == []
