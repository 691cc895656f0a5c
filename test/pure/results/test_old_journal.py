"""A whole journal that an older version wrote (test/data/README.md): this version continues and reads it."""

import dataclasses
import json
import lzma
import pathlib
from fractions import Fraction

import pytest

from helpers.competition import OBJECTS, UTC0, competition, event
from helpers.journaled import NO_LISTENING, JournaledDriver
from roah_rsbb.core.views.schedule import schedule
from roah_rsbb.journal.log_dir import JOURNAL
from roah_rsbb.model.clock import Now
from roah_rsbb.model.reason import RunName
from roah_rsbb.model.records import Phase
from roah_rsbb.results.program import main as program
from roah_rsbb.rulebook.standing_rules import DEFAULT
from roah_rsbb.scoring.counting import ANY, Why
from roah_rsbb.scoring.sheet import Mark
from roah_rsbb.scoring.standings import standings

ROOT = pathlib.Path(__file__).resolve().parents[3]
OLD = ROOT / "test" / "data" / "journal_2026-11-23.log.xz"
SEGMENT = "journal-000001-a49f4ed9.log"
# When that core ended.
ENDED = Now(1147.527, UTC0 + 147.527)
# Its runs, the oldest first, and what today's rules make of them. The last one is in progress.
RUNS = [
    ("HGTKMH-6667-1800000000.000", "a1", "stopped", "Anna", [1, 0, 2], Why.NOT_LAST),
    ("HGTKMH-6668-1800000042.506", "a1", "completed", "Bea", [1, 4, 0], Why.COUNTS),
    ("HGTKMH-6669-1800000085.013", "a2", "completed", "", [0, 0, 5], Why.COUNTS),
    ("HWV-6670-1800000127.520", "v1", "no_show", "", [0, 0, 0], Why.NO_SCORE),
    ("HWV-6671-1800000127.520", "v2", "withdrawn", "", [0, 0, 0], Why.NO_SCORE),
    ("HNF-6672-1800000127.520", "n1", "completed", "Anna", [0, 0, 0], Why.COUNTS),
    ("HNF-6673-1800000127.526", "n2", "", "", [0, 0, 0], Why.NOT_OVER),
]
UNSIGNED, PRESENT = RUNS[2][0], RUNS[6][0]


def _event(number, *what, **of_event):
    return dataclasses.replace(event(*what, **of_event), id=number)


def _config():
    """The schedule of that competition, in which today's programs wrote ids."""
    navigation = {"team": "Beta", "timeout": 60.0, "total_timeout": 300.0}
    return competition(
        tbm=[_event("a1", "HGTKMH", run=1), _event("a2", "HGTKMH", run=2), _event("v1", "HWV", team="Beta"),
             _event("v2", "HWV")],
        fbm=[_event("n1", "HNF", run=1, **navigation), _event("n2", "HNF", run=2, **navigation)],
    )


@pytest.fixture
def folder(tmp_path):
    directory = tmp_path / "0" / JOURNAL
    directory.mkdir(parents=True)
    (directory / SEGMENT).write_bytes(lzma.decompress(OLD.read_bytes()))
    return tmp_path


class Continued(JournaledDriver):
    """Today's core, seconds after that one ended, and with its journal."""

    def _begin(self, listening):
        self.now = ENDED.later(2.0)
        super()._begin(listening)


@pytest.fixture
def driver(folder):
    return Continued(folder, _config(), NO_LISTENING)


def _ruled(driver):
    return [(r.record.identity, r.record.event, r.record.end_reason, "" if r.record.sign_off is None else
             r.record.sign_off.who, [item.value for item in r.record.items], r.why)
            for r in driver.box.scores.rulings(driver.now)]


def test_all_runs_are_there_with_the_ids_of_their_events(driver):
    assert driver.troubles == []
    finished, present = _ruled(driver)[:-1], _ruled(driver)[-1]
    assert sorted(finished) == sorted(RUNS[:-1])
    assert present == RUNS[-1]
    lines = {line.event.id: line.last.identity for line in schedule(driver.box, driver.now) if line.last is not None}
    assert lines == {"a1": RUNS[1][0], "a2": UNSIGNED, "v1": RUNS[3][0], "v2": RUNS[4][0], "n1": RUNS[5][0]}


def test_a_run_in_progress_continues(driver):
    run = driver.run_in("fbm")
    assert (run.identity, run.phase, run.port) == (PRESENT, Phase.RUNNING, 6673)
    assert run.clock.elapsed(driver.now) == pytest.approx(2.0), "it is paused: its module is missing"


def test_an_old_run_is_corrected_and_signed_off(driver):
    name = RunName("tbm", UNSIGNED)
    driver.mark(name, Mark(OBJECTS.group, OBJECTS.desc, 2), "Cleo")
    driver.enter("sign_off", name, "Cleo")
    driver.kill()
    again = driver.box.finished.find(UNSIGNED).record
    assert (again.event, again.sign_off.who, [item.value for item in again.items]) == ("a2", "Cleo", [0, 2, 5])
    assert len(again.history) == 2, "the old mark and the new one"


def test_standings_are_made_of_the_old_runs(driver):
    records = [ruling.record for ruling in driver.box.scores.rulings(driver.now)]
    found = {each.benchmark: each for each in standings(records, {"HGTKMH": DEFAULT}, ANY)}
    line, = found["HGTKMH"].lines
    assert line.team == "Alpha"
    assert line.numbers == (Fraction(5),)


def _results(folder, capsys, *arguments):
    with pytest.raises(SystemExit) as ended:
        program.main(["--journal", str(folder / "0" / JOURNAL), *arguments])
    found = capsys.readouterr()
    assert (ended.value.code, "damage" in found.err) == (0, False)
    return found.out


def test_results_reads_it(folder, capsys):
    before = (folder / "0" / JOURNAL / SEGMENT).read_bytes()
    listed = _results(folder, capsys, "list").splitlines()
    assert len(listed) == 1 + len(RUNS)
    runs = json.loads(_results(folder, capsys, "export", "--json", "-"))["runs"]
    assert {(run["identity"], run["end_reason"], run["counts"], *(item["value"] for item in run["items"]))
            for run in runs} == {(run[0], run[2], run[5].value, *run[4]) for run in RUNS}
    for identity, _, _, who, _, _ in RUNS:
        shown = _results(folder, capsys, "show", identity)
        assert identity in shown
        assert (f"signed off by {who}" in shown) is bool(who)
    assert (folder / "0" / JOURNAL / SEGMENT).read_bytes() == before, "reading changes nothing"
