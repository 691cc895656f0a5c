"""Runs and score sheets in a terminal."""

from types import SimpleNamespace

import pytest

from helpers.referee_box import ITEMS, UTC0
from helpers.referee_box import NOW as NOW_ON_BOX
from roah_rsbb.model.reason import Refused
from roah_rsbb.model.results import HistoryEntry, JudgedRun, Judging, RunEnd, RunLine, RunSheet
from roah_rsbb.referee import view
from roah_rsbb.referee.sheets import COMMANDS, LAST, pick_run
from roah_rsbb.referee.terminal import Call, Output
from roah_rsbb.referee.view import run_lines, sheet_lines
from roah_rsbb.referee.words import BadWord
from roah_rsbb.wording.times import Moments

UTC = view.Style(moments=Moments(in_utc=True))


def _run(number=1, **fields):
    run = RunLine(f"HWV-{6666 + number}-1447.5", 1, "Home A", "HWV", "TestingTeam", 1, number, UTC0,
                  closed_utc_s=UTC0 + 600 * number, end_reason="stopped", score="Good 3")
    return run._replace(**fields)


NOW = _run(3, closed_utc_s=None, end_reason="")
RUNS = (NOW, _run(2), _run(1))


@pytest.mark.parametrize("word, number", [
    (LAST, 2), ("HWV-6667-1447.5", 1), ("6667", 1), ("6668", 2), ("6669", 3),
])
def test_a_run_is_named_by_a_part_of_its_identity(word, number):
    assert pick_run(word, RUNS).run == number


@pytest.mark.parametrize("word, runs, hint", [
    ("7000", RUNS, "no run '7000'; there are\n  HWV-6669"), ("HWV", RUNS, "3 runs have 'HWV' in their name; there are"),
    ("", RUNS, "no run ''"),
    (LAST, (NOW,), "no run of this zone is over: HWV-6669-1447.5 is still connected. Disconnect it first, or leave"),
    (LAST, (), "no run of this zone is connected or over"),
])
def test_an_unknown_run_lists_the_known_ones(word, runs, hint):
    with pytest.raises(BadWord) as bad:
        pick_run(word, runs)
    assert hint in str(bad.value)


@pytest.mark.parametrize("runs, chosen", [
    (RUNS[1:2], "HWV-6668-1447.5"), ((NOW,), "has no run that is not signed off"), (RUNS, "2 such runs"),
    ((RUNS[1]._replace(signed_utc_s=UTC0),), "has no run that is not signed off"),
])
def test_a_run_without_judges_is_published_too(capsys, runs, chosen):
    """A team withdrew from an event with judges: its sheet has none, but there is a time for objections."""
    done = []
    box = SimpleNamespace(box=SimpleNamespace(zones=["Home A"]), judging={}, results={}, runs=lambda: runs)
    link = SimpleNamespace(
        box=box, now=lambda: NOW_ON_BOX, settle=lambda: None,
        judging=lambda zone, identity: JudgedRun(Judging(zone, identity), (), ()),
        act=lambda action, zone, given, identity, who: done.append((action, identity)))
    options = SimpleNamespace(action="publish", zone="home", run=None, seconds=-1, referee="Hugo")
    try:
        COMMANDS["judges"].do(Call(link, options, Output(True, True)))
    except (BadWord, Refused) as error:
        done.append(str(error))
    assert done == [("publish", chosen)] or chosen in done[0]


def test_runs_are_listed_with_what_became_of_them():
    runs = (NOW, _run(2, corrected=True), _run(1, end_reason="no_messages_saved", signed_utc_s=UTC0, signed_by="C\x1b"))
    assert run_lines(runs, UTC) == [
        "now        HWV-6669-1447.5  HWV, team TestingTeam, round 1, run 3: connected  Good 3",
        "16:46:40Z  HWV-6668-1447.5  HWV, team TestingTeam, round 1, run 2: stopped, corrected, "
        "not signed off  Good 3",
        "16:36:40Z  HWV-6667-1447.5  HWV, team TestingTeam, round 1, run 1: no data saved, signed off by C\\x1b at "
        "16:26:40Z  Good 3",
    ]
    assert run_lines((), UTC) == ["no run is connected or over"]


def test_a_sheet_has_history_and_ends():
    entry = HistoryEntry(1, UTC0, "Anna", "Achievements", "Detects the door", "bool", 0, False, 1, False, "late")
    withdrawn = entry._replace(number=2, old=1, value=0, not_attempted=True, note="", correction=True,
                               withdrawn_utc_s=UTC0 + 60, withdrawn_by="Ben", withdrawn_note="it did")
    items = (ITEMS[0]._replace(value=1, corrected=True), ITEMS[2])
    sheet = RunSheet(_run(1, corrected=True), ("mbot",), 12.0, items, (entry, withdrawn), (
        RunEnd(1, UTC0, "Anna", "stopped", "Stopped by the referee", "fire", "Ben"),
        RunEnd(2, UTC0, "", "timeout", "Time is up", "")))
    assert sheet_lines(sheet, UTC)[1:] == [
        "    time 0:12.0",
        "    Achievements",
        "       1    yes  Detects the door  (corrected)",
        "    Penalized",
        "       2      0  Bumps into the furniture",
        "History",
        "       1  16:26:40Z Anna: Achievements: Detects the door: no → yes (late)",
        "       2  16:26:40Z Anna: Achievements: Detects the door: yes → not attempted; correction; "
        "withdrawn by Ben at 16:27:40Z: it did",
        "Ends",
        "       1  16:26:40Z Stopped by the referee (Anna): fire (Ben)",
        "       2  16:26:40Z Time is up",
    ]
