"""Judges, settlements and objections: on the sheet, in the export, in the data set, and what is not shown too early."""

import csv
import io
import json
from decimal import Decimal

import pytest

from helpers import journaled
from helpers.competition import BUMPS, DOOR
from helpers.jury import Jury, judged
from helpers.results_of import runs_in
from roah_rsbb.core.settings import Settings
from roah_rsbb.core.views.sheets import run_sheet
from roah_rsbb.journal.reader import JournalReader
from roah_rsbb.journal.records import Kind
from roah_rsbb.model.scoring import ScoreKind, ScoringItem
from roah_rsbb.results.dataset import DatasetOptions, names_of, write_dataset
from roah_rsbb.results.export import RESULT_COLUMNS, exported, result_rows, write_table
from roah_rsbb.results.sheet import sheet_lines, sheet_page


@pytest.fixture
def jury(tmp_path):
    jury = Jury(journaled.box(
        tmp_path, judged(objection_time=60.0), Settings(auto_next=False, listen_duration=0.0)))
    jury.mark("Ann", BUMPS, 41)
    jury.mark("Ben", BUMPS, 43)
    jury.mark("Ann", DOOR, 1)
    jury.mark("Ben", DOOR, 1)
    jury.submit("Ann")
    yield jury
    jury.driver.journal.close()


def _read(jury, then):
    reader = JournalReader(jury.driver.journal.path)
    return then(*runs_in(reader.path), reader)


def _texts(result, _reader=None):
    return "\n".join(sheet_lines(result, True, False)), sheet_page(result, True).partition("</style>")[2]


def test_the_sheet_shows_no_proposal_before_all_judges_have_submitted(jury):
    for text in _read(jury, _texts):
        assert "41" not in text
        assert "43" not in text
        assert "submitted" in text


def test_the_sheet_has_proposals_settlements_and_objections(jury):
    jury.submit("Ben")
    jury.settle(BUMPS, 42)
    jury.finish()
    driver = jury.driver
    driver.enter("publish", jury.name, "Olga", seconds=5)
    driver.enter("object", jury.name, "Olga", by="Alpha", text="too many bumps")
    driver.enter("answer", jury.name, "Hugo", number=1, text="the video shows them")
    lines, page = _read(jury, _texts)
    rows = [" ".join(text.split()) for text in lines.splitlines()]
    assert {"Item Ann Ben Counts Settled", "bumps 41 43 42 Hugo: the video shows it",
            "detects the door yes yes yes"} <= {*rows}
    assert "Published as provisional, 5 s for objections" in lines
    assert "Objection 1 rejected: the video shows them" in lines
    for text in ("41", "43", "Hugo: the video shows it", "Objection 1 of Alpha: too many bumps"):
        assert text in page
    value = _read(jury, lambda result, reader: exported([result], [], "j", 0.0))["runs"][0]
    assert value["judging"]["settlements"][0]["proposals"] == [["Ann", "41"], ["Ben", "43"]]
    assert value["publication"]["objections"][0]["answer"] == "the video shows them"
    json.dumps(value)
    assert [e["kind"] for e in value["entries"] if e["kind"] == Kind.PUBLICATION] == [Kind.PUBLICATION] * 3


def test_ratings_are_what_each_judge_gave_also_where_they_were_settled(tmp_path):
    """Ben's sheet was withdrawn. What counts of the settlement is entered for each place in the run's sheet."""
    show = ScoringItem("Jury", "show", ScoreKind.RATING, Decimal(1), Decimal(0), Decimal(10), judges=("1", "2"))
    jury = Jury(journaled.box(tmp_path, judged(items=(show,)), Settings(auto_next=False, listen_duration=0.0)))
    for judge, text in (("Ann", "7.5"), ("Ben", "9.5")):
        jury.mark(judge, show, text=text)
        jury.submit(judge)
    jury.driver.enter("withdraw_sheet", jury.name, "Hugo", judge="Ben", reason="left")
    jury.driver.event(jury.desk.waive, jury.name, "Ben had to leave", "Hugo")
    jury.settle(show, 0, text="7.25")
    shown = run_sheet(jury.driver.box.scores.record_of(jury.driver.now, jury.name), None).items[0]
    assert (shown.text, shown.judges, shown.ratings) == ("7.25", ("Ann",), ("7.5",))
    jury.finish()
    jury.driver.journal.close()
    lines, page = _read(jury, _texts)
    assert "7.25  show (Ann 7.5)" in lines
    assert "show (Ann 7.5)" in page
    for decimal_comma, separator, shown in ((False, ",", "Ann 7.5"), (True, ";", "Ann 7,5")):
        table = io.StringIO()
        rows = _read(jury, lambda result, _: result_rows([result.record], True))
        write_table(table, RESULT_COLUMNS, rows, decimal_comma)
        (row, *_) = csv.DictReader(io.StringIO(table.getvalue()), delimiter=separator)
        assert (row["name"], row["ratings"]) == ("show", shown)
    (run,) = _read(jury, lambda result, _: exported([result], [], "journal", 0.0))["runs"]
    assert run["items"][0]["ratings"] == [{"judge": "Ann", "text": "7.5"}]


@pytest.mark.parametrize("is_anonymous", [False, True])
def test_the_data_set_has_a_row_for_each_proposal(jury, tmp_path, is_anonymous):
    jury.submit("Ben")
    jury.settle(BUMPS, 42)
    folder = tmp_path / "set"
    folder.mkdir()
    _read(jury, lambda result, reader: write_dataset(
        str(folder), [result], DatasetOptions(names_of(reader) if is_anonymous else None)))
    with open(str(folder / "judges.csv"), encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [(row["proposal"], row["settled"]) for row in rows if row["name"] == BUMPS.desc] == [
        ("41", "true"), ("43", "true")]
    whole = "".join(path.read_text(encoding="utf-8") for path in folder.iterdir())
    for text in ("Ann", "Hugo", "the video"):
        assert (text in whole) is not is_anonymous
