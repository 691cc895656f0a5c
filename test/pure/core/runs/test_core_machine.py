"""The state machines of a run: the tables, those of docs/protocol.md, and that all kinds of runs follow them."""

import ast
import itertools
import pathlib
import re

import pytest

from helpers.all_robots import all_robots_box, connect_all, robots_of
from helpers.box_driver import BoxDriver
from helpers.competition import competition
from roah_rsbb.core.actions.table import Target
from roah_rsbb.core.runs.machine import PHASES, REACTIONS, Reaction, RunEvent, WrongPhase, following, is_possible, react
from roah_rsbb.model.records import NOBODY, EndReason, Phase
from roah_rsbb.protocol import BoxState, RobotState

# The table as the protocol has it: rows are what the robot reports, columns the box's present state. With an
# explicit goal / without one, where that makes a difference; DONE: a new goal PREPARE, at the end STOP.
PROTOCOL = """
                STOP  PREPARE                 GOAL_TX         WAITING_RESULT
STOP            STOP  PREPARE                 PREPARE         PREPARE
PREPARING       STOP  PREPARE                 PREPARE         PREPARE
WAITING_GOAL    STOP  GOAL_TX/WAITING_RESULT  GOAL_TX         PREPARE/WAITING_RESULT
EXECUTING       STOP  PREPARE                 WAITING_RESULT  WAITING_RESULT
RESULT_TX       STOP  PREPARE                 DONE            DONE
"""


def _entries():
    header, *rows = [line.split() for line in PROTOCOL.strip().splitlines()]
    for row in rows:
        for column, cell in zip(header, row[1:]):
            with_goal, _, without = cell.partition("/")
            for explicit_goal, then in ((True, with_goal), (False, without or with_goal)):
                yield BoxState[column], RobotState[row[0]], explicit_goal, then


ENTRIES = list(_entries())


def _following(box, explicit_goal, taken):
    """The state that a step leads to."""
    return {
        Reaction.KEEP: box.name,
        Reaction.EXECUTE: "GOAL_TX" if explicit_goal else "WAITING_RESULT",
        Reaction.AWAIT_RESULT: "WAITING_RESULT",
        Reaction.RETRY: "PREPARE",
        Reaction.GOAL_DONE: "DONE",
    }[taken]


@pytest.mark.parametrize("box, robot, explicit_goal, then", ENTRIES)
def test_every_entry(box, robot, explicit_goal, then):
    assert _following(box, explicit_goal, react(box, robot, explicit_goal)) == then


def test_the_table_has_exactly_these_entries():
    assert set(REACTIONS) == set(itertools.product(BoxState, RobotState))
    assert len(ENTRIES) == 2 * len(REACTIONS)


# The same entries in a whole run, where no goal is explicit: so GOAL_TX does not occur.


def _run_in_state(box):
    driver = BoxDriver(competition(tbm=["HGTKMH"]))
    robot = driver.connected()
    if box is not BoxState.STOP:
        driver.command("start")
    if box is BoxState.WAITING_RESULT:
        robot.says(RobotState.PREPARING)
        robot.says(RobotState.WAITING_GOAL)
    assert driver.box_state() is box
    return driver, robot


@pytest.mark.parametrize("box, robot, then", [
    (box, robot, then) for box, robot, explicit_goal, then in ENTRIES
    if not explicit_goal and box is not BoxState.GOAL_TX
])
def test_every_entry_in_a_run(box, robot, then):
    driver, fake = _run_in_state(box)
    before = driver.run_in().phase
    fake.says(robot)
    done = then == "DONE"
    assert driver.box_state() is (BoxState.STOP if done else BoxState[then])
    assert driver.run_in().phase is (Phase.ENDED if done else before)
    assert driver.run_in().end_reason is (EndReason.COMPLETED if done else None)


@pytest.mark.parametrize("robot", RobotState)
def test_the_referee_can_start_a_robot_that_stopped_and_no_other(robot):
    driver, fake = _run_in_state(BoxState.STOP)
    fake.says(robot)
    assert (driver.off("start") == []) is (robot is RobotState.STOP)


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
