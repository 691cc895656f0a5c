"""The runs explained for spectators."""

from dataclasses import replace

import pytest

from helpers.all_robots import all_robots_box, connect_all, robots_of, start_all
from helpers.box_driver import BoxDriver, public_document
from helpers.competition import competition, event
from helpers.module_player import does_goal, started
from roah_rsbb.core.actions.table import Target
from roah_rsbb.core.runs.reported import MAX_SAID
from roah_rsbb.core.views.public import PublicResults
from roah_rsbb.model.modules import RequestKind
from roah_rsbb.protocol import RobotState

NONE, OUTCOMES = PublicResults.NONE, PublicResults.OUTCOMES


def explained(driver, results=OUTCOMES, with_texts=False):
    (found,) = public_document(driver, results, robot_texts=with_texts).runs_shown()
    return found


def test_what_the_robot_of_a_task_does():
    driver = BoxDriver()
    robot = driver.connected()
    assert explained(driver).doing == "waiting"
    driver.command("start")
    assert explained(driver).doing == "preparing"
    robot.executes()
    assert explained(driver).doing == "executing"
    robot.completes()
    assert explained(driver).doing == "ended"


def test_the_waypoints_of_a_run():
    driver, modules, robot = started()
    modules.lives(1.0, robot)
    assert (explained(driver).doing, explained(driver).are_waypoints) == ("between", True)
    modules.asks(RequestKind.REFEREE, text="Place the secret object")
    modules.lives(1.0, robot)
    assert explained(driver).doing == "referee"
    assert "secret" not in repr(explained(driver, with_texts=True)), "an operation may show what the robots will meet"
    number = modules.run().steps[-1].request.number
    driver.event(driver.box.act, Target("tbm"), "operation", "", {"operation": number})
    modules.asks(goal="[1, 2, 3]", timeout=50.0)
    modules.lives(1.0, robot)
    assert (explained(driver).goals, explained(driver).goals_ended) == (1, 0)
    does_goal(robot)
    modules.lives(1.0, robot)
    found = explained(driver)
    assert (found.goals, found.goals_ended, found.goals_completed) == (1, 1, 1)
    modules.asks(goal="[4, 5, 6]", timeout=2.0)
    modules.lives(3.0, robot)
    found = explained(driver)
    assert (found.goals, found.goals_ended, found.goals_completed) == (2, 2, 1), "the second one timed out"
    assert explained(driver, NONE).goals_completed is None, "how it ended is not for the public"
    assert "[1, 2, 3]" not in repr(found)


def test_what_robots_say_is_for_the_public_only_if_it_is_allowed():
    driver = BoxDriver()
    robot = driver.executing()
    robot.says(notifications=("Hello\n\x1b[31mred\u202e " + "x" * 500,), visitor=("Postman",))
    assert explained(driver).said == ()
    first, second = explained(driver, with_texts=True).said
    assert first.text.startswith("Hello [31mred x") and first.text.isprintable()
    assert len(first.text) == 160 and first.text.endswith("…")
    assert (second.robot, second.kind, second.text) == ("", "visitor", "Postman")
    robot.says(notifications=[str(number) for number in range(20)])
    assert [one.text for one in explained(driver, with_texts=True).said] == [
        str(number) for number in range(20 - MAX_SAID, 20)]


def test_what_a_robot_said_before_a_repeated_start_is_gone():
    driver = BoxDriver()
    robot = driver.executing()
    robot.says(notifications=("before",))
    driver.command("stop")
    assert len(explained(driver, with_texts=True).said) == 1
    robot.says(RobotState.STOP, notifications=("after",))
    driver.run(10.0)
    robot.says(RobotState.STOP)
    driver.command("start")
    assert explained(driver, with_texts=True).said == ()


def test_robots_that_run_together_are_named():
    driver = all_robots_box()
    robots = robots_of(driver)
    connect_all(driver, robots)
    start_all(driver, robots)
    robots[0].says(notifications=("one",))
    robots[1].says(notifications=("two",))
    said = explained(driver, with_texts=True).said
    assert [one.text for one in said] == ["one", "two"]
    assert len({one.robot for one in said}) == 2 and all(one.robot for one in said)
    assert explained(driver).doing == "executing"


def test_what_a_benchmark_is_about():
    about = (("en", "It drives."), ("de", "Er fährt."))
    line = event()
    driver = BoxDriver(competition(tbm=[replace(line, benchmark=replace(line.benchmark, about=about))]))
    driver.connected()
    assert explained(driver).about == dict(about)


@pytest.mark.parametrize("results", [NONE, OUTCOMES])
def test_a_task_has_no_goals(results):
    driver = BoxDriver()
    driver.executing()
    found = explained(driver, results)
    assert (found.goals, found.goals_ended, found.goals_completed or 0) == (0, 0, 0)
