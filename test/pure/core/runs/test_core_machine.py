"""Every entry of the box's state table (docs/protocol.md, "State machines")."""

import itertools

import pytest

from helpers.box_driver import BoxDriver
from helpers.competition import competition
from roah_rsbb.core.runs.machine import REACTIONS, Reaction, react
from roah_rsbb.model.records import EndReason, Phase
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
            for explicit_goal, following in ((True, with_goal), (False, without or with_goal)):
                yield BoxState[column], RobotState[row[0]], explicit_goal, following


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


@pytest.mark.parametrize("box, robot, explicit_goal, following", ENTRIES)
def test_every_entry(box, robot, explicit_goal, following):
    assert _following(box, explicit_goal, react(box, robot, explicit_goal)) == following


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


@pytest.mark.parametrize("box, robot, following", [
    (box, robot, following) for box, robot, explicit_goal, following in ENTRIES
    if not explicit_goal and box is not BoxState.GOAL_TX
])
def test_every_entry_in_a_run(box, robot, following):
    driver, fake = _run_in_state(box)
    before = driver.run_in().phase
    fake.says(robot)
    done = following == "DONE"
    assert driver.box_state() is (BoxState.STOP if done else BoxState[following])
    assert driver.run_in().phase is (Phase.ENDED if done else before)
    assert driver.run_in().end_reason is (EndReason.COMPLETED if done else None)


@pytest.mark.parametrize("robot", RobotState)
def test_the_referee_can_start_a_robot_that_stopped_and_no_other(robot):
    driver, fake = _run_in_state(BoxState.STOP)
    fake.says(robot)
    assert (driver.off("start") == []) is (robot is RobotState.STOP)
