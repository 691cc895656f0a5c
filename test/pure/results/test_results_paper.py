"""Score sheets on paper: one A4 page each, filled in or blank, and nothing of it cut; printed by a real Chromium."""

import base64
import html
import json
import os
import pathlib
import re
import select
import subprocess
from decimal import Decimal

import pytest

from helpers.results_of import ACHIEVED, DISQUALIFYING, DOOR, EVIL, PENALIZED, full_record, module_record, task_record
from roah_rsbb.model.records import GroupPoints, ItemRecord, ScoreEntry, ScoreValue, SheetPoints, SignOff, StopRecord
from roah_rsbb.model.rules import AttemptsRule, Item, Measure, Sheet
from roah_rsbb.model.scoring import INCIDENTS, rows
from roah_rsbb.results import paper, printing
from roah_rsbb.results.page import LONGEST_WORD, Competition, breakable, page, tag
from roah_rsbb.results.paper import blank_front, cut, front_markup, front_of, layout_of, wrapped_lines
from roah_rsbb.results.printing import Printer, print_pdf, without_font
from roah_rsbb.results.runs import NotPossible, RunResult
from roah_rsbb.results.sheet import sheet_page
from roah_rsbb.rulebook.benchmarks import Benchmark, ScheduledEvent
from roah_rsbb.rulebook.config import load_benchmarks
from roah_rsbb.rulebook.standing_rules import Criterion, Rules, Term, read_rules
from roah_rsbb.scoring.tree import LATE, TOO_OFTEN, TOTAL

CONFIG = pathlib.Path(__file__).resolve().parents[3] / "config"
BENCHMARKS = load_benchmarks(str(CONFIG / "benchmarks.yaml"))
RULES = read_rules(str(CONFIG / "standings.yaml"))
POINTS = Rules(AttemptsRule(), (DISQUALIFYING,), (Criterion(
    "Points", True, (Term(group=ACHIEVED, weight=10.0), Term(group=PENALIZED, weight=-3.0))),))


def navigation(waypoints):
    """A run of HNF with so many waypoints."""
    each = [ScoreValue(f"waypoint {n}", name, "0.1234", unit)
            for n in range(1, waypoints + 1) for name, unit in (("distance_error", "m"), ("angle_error", "rad"))]
    whole = ScoreValue("", "position_accuracy", "0.12345", "m", "Position accuracy")
    return module_record("Alpha", 2, "HNF", reached=waypoints)._replace(module_scores=(whole, *each))


def enormous():
    """A run with more data than fits on a page, and with the longest words."""
    items = tuple(ItemRecord(f"Group {n // 40}", f"Item {n}: {'a rather long description ' * 4}", "uint", n)
                  for n in range(200))
    stops = tuple(StopRecord(1.0, "x", "stopped", "Stopped", "W" * 500 + " long" * 90) for _ in range(20))
    notes = tuple(ScoreEntry(n, 1.0, "x", "g", "d" * 200, 0, 1, note="n" * 500) for n in range(100))
    evil = tuple(ScoreValue(EVIL * 5, EVIL * 5, "9" * 400, "m" * 40) for _ in range(50))
    return task_record("T" * 120, 3)._replace(
        items=items, stops=stops, history=notes, module_scores=evil, robots=("robot" * 20,) * 40, zone="Z" * 200,
        sign_off=SignOff(1.0, "S" * 200), identity="i" * 200)


def shipped(code):
    """A run of a benchmark of the shipped file, with all its items."""
    items = tuple(ItemRecord(i.group, i.desc, i.kind.name.lower(), 1) for i in BENCHMARKS[code].scoring)
    return task_record("CopperKettle", 4, benchmark=code)._replace(items=items)


def front(record, rules=None, title="A title"):
    return front_of(record, rules, title, in_utc=True)


def values(found):
    return {line.what: (line.value, line.points) for group in found.groups for line in group.lines}


# -- texts ------------------------------------------------------------------------------------------


def test_letters_without_a_font_are_named(monkeypatch, tmp_path):
    """The robot of a team's name was a box in the PDF, without a word."""
    fonts = tmp_path / "fc-list"
    fonts.write_text('#!/bin/sh\n[ "$1" = :charset=1f916 ] || echo Sans\n', "utf-8")
    fonts.chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path), prepend=os.pathsep)
    assert without_font("Team \U0001f916 M\u00fcller \u2713") == "\U0001f916"


def test_the_page_has_what_is_signed():
    found = front(full_record(), RULES["HGTKMH"], "Getting to know my home")
    assert found.title == "Getting to know my home (HGTKMH)"
    assert found.state == "Score sheet"
    facts = dict(found.facts)
    assert (facts["Team"], facts["Robot"], facts["Round, run"], facts["Zone"]) == ("Alpha", "r1", "1, 1", "tbm")
    assert facts["Started"] == "2025-11-21 12:00:30Z"
    assert facts["End"] == "stopped, after 10:00.5 min"
    assert facts["Sheet"] == "signed off by chief at 2025-11-21 12:15:00Z"
    assert found.remarks == (f"Benchmark stopped by the referee: cable {EVIL}",
                             "Detects a changed object: from the video")
    markup = front_markup(found)
    for text in (*facts.values(), *paper.SIGNERS, "Remarks"):
        assert html.escape(text) in re.sub("<wbr>", "", markup)


def test_values_have_units_and_points():
    record = task_record("Alpha", 1, door=1, objects=2, bumps=3, hits=0)._replace(module_scores=(
        ScoreValue("", "distance_error", "0.12345", "m", "Distance error"),))
    found = values(front(record, POINTS))
    assert found[DOOR] == ("yes", "10")
    assert found["Detects a changed object"] == ("2 ×", "20")
    assert found["Total of Achievements"] == ("", "30")
    assert found["Bumps into the furniture"] == ("3 ×", "-9")
    assert found["Hits a person"] == ("0 ×", ""), "it gives no points"
    assert found["Distance error"] == ("0.123 m", "")
    assert dict(front(record, POINTS).totals) == {"Points": "21"}
    assert values(front(full_record()))[f"{DOOR}"][0] == "not attempted"
    assert "Detects a changed object (corrected)" in values(front(full_record()))


def test_the_points_of_decimals_and_ratings_are_exact():
    """The record also has the nearest whole numbers of these, for programs that only know such."""
    record = task_record("Alpha", 1)._replace(items=(
        ItemRecord(ACHIEVED, "Litres", "decimal", 2, text="2.5"),
        ItemRecord(ACHIEVED, "Poster", "rating", 8, text="7.6"),
        ItemRecord(ACHIEVED, "Way", "choice", 1, text="alone"),
    ))
    found = values(front(record, POINTS))
    assert found["Litres"] == ("2.5", "25")
    assert found["Poster"] == ("7.6", "76")
    assert found["Way"] == ("alone", "0")
    assert found["Total of Achievements"] == ("", "101")
    assert front(record, POINTS).totals == (("Points", "101"),)


def test_totals_are_the_numbers_of_the_ranking():
    hit = front(task_record("Alpha", 1, door=1, hits=1), POINTS)
    assert hit.totals == (("Points", "10"), ("Result", "disqualified"))
    record = navigation(2)
    assert ("Position accuracy (less is better)", "0.123 m") in front(record, RULES["HNF"]).totals
    assert ("Execution time (less is better)", "–") in front(record, RULES["HNF"]).totals
    never = task_record("Alpha", 1, started_utc=0.0, end_reason="")
    assert front(never, POINTS).totals == ()


def test_a_sheet_without_a_title_or_rules():
    found = front(task_record("Alpha", 1, door=1), title="")
    assert found.title == "HGTKMH"
    assert found.totals == (("Sum of the sheet", "1"),)
    assert "not signed off" in found.state


def test_a_blank_sheet_of_an_event_and_of_a_benchmark():
    benchmark = BENCHMARKS["HGTKMH"]
    found = blank_front(benchmark, "Home A", ScheduledEvent(benchmark, "Beta", 2, 3, 1763722800.0), in_utc=True)
    facts = dict(found.facts)
    assert (facts["Team"], facts["Round, run"], facts["Zone"]) == ("Beta", "2, 3", "Home A")
    assert facts["Scheduled"] == "2025-11-21 11:00:00Z"
    assert facts["Robot"] == facts["Started"] == ""
    assert values(found)["Stops working"] == ("", "")
    assert values(found)["Detects the door whose state has changed"] == ("☐\u00a0yes ☐\u00a0no", "")
    assert dict(blank_front(benchmark).facts)["Team"] == ""
    assert [group.title for group in found.groups] == list(dict.fromkeys(i.group for i in benchmark.scoring))


PERCENT = Item("folds", "Folds", "test", Measure.PERCENT, Decimal(400), times=1)
COUNT = Item("finds", "Finds", "test", points=Decimal(20), times=3)
OTHER = Item("other", "Another decision", "test", Measure.POINTS, Decimal(1))


def test_a_blank_sheet_says_what_is_written_where():
    sheet = Sheet((Item("test", "Test", amount=Measure.SECTION), PERCENT, COUNT, OTHER))
    benchmark = Benchmark("X", "X", "X", 300.0, 300.0, rows(sheet), sheet=sheet)
    lines = [(line.what, line.value) for group in blank_front(benchmark).groups for line in group.lines]
    assert lines == [("Folds (400)", "%"), ("Finds (20)", "≤ 3"), ("Another decision", "points")]


def test_only_incidents_that_happened_are_printed_and_the_points_once():
    points = SheetPoints("20", (GroupPoints("Test", "20"),))
    items = (ItemRecord("Test", "Finds", "uint", 1, points="20"), ItemRecord(INCIDENTS, "absent", "uint", 0))
    record = task_record("Alpha", 1)._replace(items=items, points=points)
    found = front(record)
    assert [group.title for group in found.groups] == ["Test"]
    assert found.totals == (("Points", "20"),)
    found = front(record._replace(items=(*items, ItemRecord(INCIDENTS, "restart", "uint", 1))))
    assert [(group.title, [line.what for line in group.lines]) for group in found.groups] == [
        ("Test", ["Finds"]), (INCIDENTS, ["restart"])]
    steps = (*(LATE(item=name, time="7:05.0", limit="7:00.0") for name in ("Finds", "Folds")), TOTAL(points="20"),
             TOO_OFTEN(incident="Restart", time="", number=2, times=1))
    assert front(record._replace(points=points._replace(steps=steps))).remarks == (
        "After the limit of 7:00.0, so not counted: Finds (7:05.0), Folds (7:05.0)",
        "Restart: time 2, 1 allowed: it has no effect")


# -- what does not fit ------------------------------------------------------------------------------


def test_a_long_sheet_gets_columns_then_the_rest_is_in_the_appendix():
    names = [layout_of(front(navigation(waypoints)))[0].name for waypoints in (1, 8, 18)]
    assert names == ["one", "two", "three"]
    layout, groups = layout_of(front(navigation(8)))
    assert groups == front(navigation(8)).groups
    layout, groups = layout_of(front(enormous()))
    shown = sum(len(group.lines) for group in groups)
    total = sum(len(group.lines) for group in front(enormous()).groups)
    assert 0 < shown < total
    assert groups[-1].title == f"… {total - shown} more in the appendix"


def test_remarks_and_texts_are_cut():
    markup = front_markup(front(enormous()))
    assert markup.count('class="remark"') == paper.MAX_REMARKS
    assert "… 115 more in the appendix" in markup
    assert cut("x" * 10, 10) == "x" * 10
    assert cut("x" * 11, 10) == "x" * 9 + "…"
    assert cut("a\nb\x1b", 10) == "a b\\x1b"


@pytest.mark.parametrize("text, lines", [("", 1), ("a bb ccc", 1), ("aaaa bbbb ccc", 2), ("aaaaaaaaaaaaaaaaa b", 2)])
def test_lines_break_between_words(text, lines):
    assert wrapped_lines(text, 10) == lines


@pytest.mark.parametrize("text, marked", [
    ("Disqualifying internationalisation", "Disqualifying internationalisation"),
    ("x" * LONGEST_WORD, "x" * LONGEST_WORD),
    ("x" * (LONGEST_WORD + 1), "x" * LONGEST_WORD + "<wbr>x"),
    ("W" * (LONGEST_WORD + 1), "W" * 13 + "<wbr>" + "W" * 10),
    ("/roah_rsbb_window_4711_1763722800", "/<wbr>roah_<wbr>rsbb_<wbr>window_<wbr>4711_<wbr>1763722800"),
    ("a < b  c\n" + "&" * 30, "a &lt; b  c\n" + "&amp;" * 22 + "<wbr>" + "&amp;" * 8),
])
def test_no_word_is_broken_but_the_longest_ones(text, marked):
    assert breakable(text) == marked
    assert "wbr" not in tag("title", text), "a title is no markup"


def test_the_style_breaks_no_word():
    text = page("t")
    for breaking in ("overflow-wrap", "word-wrap", "word-break", "hyphens"):
        assert breaking not in text


# -- printed ----------------------------------------------------------------------------------------

# Every kind of page; several of them are one document.
FRONTS = [
    front_of(full_record(), RULES["HGTKMH"], "Getting to know my home", True), front(enormous(), POINTS, "t" * 200),
    *(front_of(shipped(code), RULES[code], BENCHMARKS[code].desc, True) for code in ("HGTKMH", "HWV", "HCFGAC")),
    *(front(navigation(waypoints), RULES["HNF"]) for waypoints in (0, 3, 5, 8, 10, 12, 14, 16, 18, 25, 60)),
    *(blank_front(benchmark) for benchmark in BENCHMARKS.values()),
]
# A tall logo, which is made smaller, and a title of the greatest width.
LOGO = '<svg xmlns="http://www.w3.org/2000/svg" width="900" height="2000"><rect width="900" height="2000"/></svg>'
COMPETITION = Competition("W" * 200, "data:image/svg+xml;base64," + base64.b64encode(LOGO.encode()).decode())
# They leave less room. Some of the pages have neither.
FRONTS = [*FRONTS[:3], *(front._replace(competition=COMPETITION) for front in FRONTS)]


@pytest.fixture(scope="module")
def document():
    return page("All", *map(front_markup, FRONTS))


@pytest.fixture(scope="module")
def chromium():
    try:
        return printing.browser()
    except NotPossible as missing:
        pytest.skip(str(missing))


@pytest.mark.long
def test_each_sheet_is_one_page(document, chromium, tmp_path):
    path = tmp_path / "all.pdf"
    print_pdf(document, str(path))
    assert len(re.findall(rb"/Type\s*/Page\b(?!s)", path.read_bytes())) == len(FRONTS)
    assert os.listdir(tmp_path) == ["all.pdf"]


@pytest.fixture
def measured(chromium, tmp_path):
    """What a script returns of a page as on paper: the width of the page, and the rules for print."""
    def measure(text, script):
        ends = ("<style>body { width: 184mm !important; padding: 0 !important }</style>"
                f"<script>document.title = JSON.stringify({script})</script></body>")
        plain = re.sub(r"<meta http-equiv[^>]*>", "", text).replace("@media print", "@media screen")
        (tmp_path / "all.html").write_text(plain.replace("</body>", ends), encoding="utf-8")
        done = subprocess.run(
            [chromium, "--headless", "--no-sandbox", "--disable-gpu", f"--user-data-dir={tmp_path / 'profile'}",
             "--window-size=1000,1400", "--dump-dom", (tmp_path / "all.html").as_uri()],
            stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, timeout=120, check=True, text=True)
        return json.loads(html.unescape(re.search("<title>(.*?)</title>", done.stdout)[1]))
    return measure


@pytest.mark.long
def test_nothing_is_cut_and_the_signatures_are_at_the_bottom(document, measured):
    found = measured(document, """[...document.querySelectorAll('.front')].map(front => {
        const content = front.querySelector('.content'), sign = front.querySelector('.signatures');
        const right = content.getBoundingClientRect().right + 1;
        const wide = [...content.querySelectorAll('td, th, p')].filter(e => e.getBoundingClientRect().right > right);
        return [content.scrollHeight - content.clientHeight, wide.length, front.clientHeight,
                sign.getBoundingClientRect().bottom - front.getBoundingClientRect().bottom]; })""")
    assert len(found) == len(FRONTS)
    for each, (cut_off, too_wide, height, below) in zip(FRONTS, found):
        assert (cut_off <= 0, too_wide) == (True, 0), (each.title, each.groups[:1], cut_off, layout_of(each)[0])
        assert 980 < height < 1000, "262 mm"
        assert abs(below) < 2


@pytest.mark.long
def test_no_table_of_the_appendix_is_wider_than_the_page(measured):
    """A withdrawal with a long reason was."""
    record = full_record()
    history = tuple(entry._replace(withdrawn_utc=1.0, withdrawn_by="bert", withdrawn_note="seen twice, " * 20,
                                   note="W" * 90, correction=True) for entry in record.history)
    text = sheet_page(RunResult(1, record._replace(history=history), (), ()), True)
    widths = measured(text, "[...document.querySelectorAll('.annex table')].map(e => e.scrollWidth - e.clientWidth "
                            "+ Math.max(0, e.clientWidth - document.body.clientWidth))")
    assert set(widths) == {0}


@pytest.mark.long
def test_many_pages_need_one_browser(chromium, monkeypatch, tmp_path):
    counting = tmp_path / "bin" / printing.BROWSERS[0]
    counting.parent.mkdir()
    counting.write_text(f'#!/bin/sh\necho >> {tmp_path}/starts\nexec {chromium} "$@"\n')
    counting.chmod(0o755)
    monkeypatch.setenv("PATH", f"{counting.parent}:{os.environ['PATH']}")
    with Printer() as printer:
        for number, front in enumerate(FRONTS[:3] + FRONTS[-1:]):
            printer.print(page("One", front_markup(front)), str(tmp_path / f"{number}.pdf"))
    assert (tmp_path / "starts").read_text() == "\n"
    printed = [(tmp_path / f"{number}.pdf").read_bytes() for number in range(4)]
    assert [len(re.findall(rb"/Type\s*/Page\b(?!s)", data)) for data in printed] == [1, 1, 1, 1]
    assert len(set(printed)) == 4
    assert all(re.search(rb"/MediaBox\s*\[0 0 59[45][.\d]* 84[12][.\d]*\]", data) for data in printed), "A4"


def test_a_browser_that_hangs(monkeypatch, tmp_path):
    fake = tmp_path / printing.BROWSERS[0]
    # As on Debian: a script starts the browser, and stays. The browser holds the named pipe as long as it lives.
    alive = tmp_path / "alive"
    os.mkfifo(alive)
    living = os.open(alive, os.O_RDONLY | os.O_NONBLOCK)
    fake.write_text(f"#!/bin/sh\nsleep 1000 > {alive}\n")
    fake.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}:/usr/bin:/bin")
    monkeypatch.setattr(printing, "TIMEOUT_S", 0.1)
    monkeypatch.setattr(printing, "CLOSE_S", 0.1)
    with pytest.raises(NotPossible, match="did not print within 0 s"):
        print_pdf("", str(tmp_path / "x.pdf"))
    assert not (tmp_path / "x.pdf").exists()
    assert select.select([living], [], [], 60)[0] and os.read(living, 1) == b"", "the browser has ended"
    os.close(living)


def test_without_a_browser_the_remedy_is_reported(monkeypatch, tmp_path):
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(NotPossible, match="sudo apt install chromium.*--html"):
        print_pdf("", str(tmp_path / "x.pdf"))


def test_a_browser_that_prints_nothing(monkeypatch, tmp_path):
    fake = tmp_path / printing.BROWSERS[0]
    fake.write_text("#!/bin/sh\necho 'it broke' >&2\nexit 3\n")
    fake.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}:/usr/bin:/bin")
    old = tmp_path / "x.pdf"
    old.write_text("old")
    with pytest.raises(NotPossible, match="printed nothing .it broke.: export with --html"):
        print_pdf("", str(old))
    assert old.read_text() == "old"
