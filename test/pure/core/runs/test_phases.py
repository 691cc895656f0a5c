"""The phases of a run: the table, its page, and that all kinds of runs follow it."""

import ast
import itertools
import pathlib
import re

import pytest

from helpers.all_robots import all_robots_box, connect_all, robots_of
from helpers.box_driver import BoxDriver
from helpers.competition import competition
from roah_rsbb.core.actions.table import Target
from roah_rsbb.core.runs.machine import PHASES, RunEvent, WrongPhase, following, is_possible
from roah_rsbb.model.records import NOBODY, EndReason, Phase

ROOT = pathlib.Path(__file__).parents[4]
RUNS = ROOT / "src" / "roah_rsbb" / "core" / "runs"


def test_the_table_is_that_of_the_page():
    page = (ROOT / "docs" / "protocol.md").read_text(encoding="utf-8")
    section = page.split("### Phases of a run")[1].split("\n###")[0]
    header, _, *rows = [[cell.strip() for cell in line.strip("|").split("|")]
                        for line in re.findall(r"^\|.*\|$", section, re.MULTILINE)]
    assert header[1:] == [phase.value for phase in Phase]
    assert [row[0] for row in rows] == [event.value for event in RunEvent]
    assert {(Phase(phase), RunEvent(row[0])): Phase(cell)
            for row in rows for phase, cell in zip(header[1:], row[1:]) if cell} == PHASES


def test_only_one_place_changes_the_phase():
    """`RunTimes` has phases of a task, which are others."""
    found = []
    for path in RUNS.parent.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            targets = node.targets if isinstance(node, ast.Assign) else []
            names = [name for target in targets for name in getattr(target, "elts", [target])]
            if any(_is_phase(name) for name in names) and path.name != "times.py":
                found.append(path.name)
    assert found == ["run.py"]


def _is_phase(name):
    """Whether it is `….state.phase`."""
    return (isinstance(name, ast.Attribute) and name.attr == "phase" and isinstance(name.value, ast.Attribute)
            and name.value.attr == "state")


KINDS = {
    "by hand": lambda: _by_hand(BoxDriver()),
    "one robot": lambda: _connected(BoxDriver()),
    "functionality": lambda: _connected(BoxDriver(competition(tbm=["HOPF"]))),
    "all robots": lambda: _all_connected(all_robots_box()),
}
EVENTS = {
    RunEvent.START: lambda run, now: run.start(now),
    RunEvent.END: lambda run, now: run.stop(now),
    RunEvent.GIVE_UP: lambda run, now: run.give_up(now, EndReason.WITHDRAWN, NOBODY),
}


def _by_hand(driver):
    driver.event(driver.box.act, Target("tbm"), "open_sheet")
    return driver


def _connected(driver):
    driver.connected()
    return driver


def _all_connected(driver):
    connect_all(driver, robots_of(driver))
    return driver


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("phase, event", itertools.product(Phase, EVENTS))
def test_every_pair_in_every_kind_of_run(kind, phase, event):
    driver = KINDS[kind]()
    run = driver.run_in()
    for step in {Phase.CONNECTED: [], Phase.RUNNING: [RunEvent.START],
                 Phase.ENDED: [RunEvent.START, RunEvent.END]}[phase]:
        EVENTS[step](run, driver.now)
    assert run.phase is phase
    if is_possible(phase, event):
        EVENTS[event](run, driver.now)
        assert run.phase is following(phase, event)
        assert (run.end_reason is None) == (run.phase is not Phase.ENDED)
        return
    with pytest.raises(WrongPhase, match=f"'{event.value}' in phase {phase.value}"):
        EVENTS[event](run, driver.now)
    assert run.phase is phase
