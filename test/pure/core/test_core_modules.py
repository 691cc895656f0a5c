"""Modules that crash and restart, and several at once: no run is lost, and no run is driven by two modules."""

import pytest

from helpers.box_driver import BoxDriver
from helpers.competition import competition, event
from helpers.module_player import FakeModules, does_goal, started
from roah_rsbb.core.actions.table import Target
from roah_rsbb.core.effects import Level
from roah_rsbb.core.modules import GONE_S, MAX_NODES, Modules
from roah_rsbb.model.clock import Now
from roah_rsbb.model.modules import ModuleInfo, ModulesState, OutcomeKind, RequestKind, ScoreValue
from roah_rsbb.model.records import EndReason, Phase
from roah_rsbb.protocol import BoxState, RobotState

GOAL = {"goal": "[1, 2, 3]", "timeout": 60.0}
SCORE = ScoreValue("", "reached", "1", "")


def rejoined(driver, modules, node="n2"):
    """Another process of the same modules, which has got all steps back and has arrived where it was."""
    again = FakeModules(driver, *[info.benchmark for info in modules.infos], node=node)
    again.progress = dict(modules.progress)
    return again


def test_a_run_whose_module_is_gone_is_held_and_its_clocks_stand():
    driver, modules, robot = started()
    modules.asks(**GOAL)
    driver.notices()
    driver.run(1.99)
    robot.says(after=0.0)
    assert not driver.run_in().held
    driver.run(0.01)
    assert driver.run_in().held
    assert driver.notices(Level.ERROR) == [
        "Benchmarking module is missing: the run is paused"
    ]
    run_left, goal_left = driver.run_in().clock.left(driver.now), driver.view().timer
    driver.run(500.0)
    robot.says(after=0.0)
    assert driver.run_in().clock.left(driver.now) == pytest.approx(run_left) == pytest.approx(598.0)
    assert driver.view().timer == pytest.approx(goal_left) == pytest.approx(58.0)
    assert "Benchmarking module not connected: the run is paused until it is back" in driver.view().state
    again = rejoined(driver, modules)
    again.beat()
    assert not driver.run_in().held
    assert driver.notices(Level.WARNING)[-1] == "Benchmarking module is back, at step 1: the run continues"
    again.lives(10.0, robot)
    assert driver.view().timer == pytest.approx(48.0)
    assert driver.run_in().phase is Phase.RUNNING


def test_the_same_module_that_was_only_slow_continues():
    driver, modules, robot = started()
    modules.asks(**GOAL)
    driver.run(3.0)
    modules.beat()
    assert not driver.run_in().held
    assert driver.notices(Level.WARNING)[-1] == "Benchmarking module is heard again: the run continues"
    does_goal(robot)
    assert modules.outcome().kind is OutcomeKind.DONE


def test_what_the_robot_does_meanwhile_is_taken():
    driver, modules, robot = started()
    modules.asks(**GOAL)
    driver.run(3.0)
    does_goal(robot, generic_result="found")
    assert driver.run_in().held
    assert modules.outcome().result == "found"
    again = rejoined(driver, modules)
    again.asks(RequestKind.REFEREE, text="next")
    assert driver.run_in().asked.text == "next"


def test_the_referee_may_work_while_the_module_is_gone():
    driver, modules, robot = started()
    modules.asks(RequestKind.REFEREE, text="Place it")
    driver.run(3.0)
    driver.event(driver.box.act, Target("tbm"), "operation")
    driver.run(100.0)
    assert driver.run_in().clock.left(driver.now) == pytest.approx(600.0), "held, though nothing is asked any more"
    rejoined(driver, modules).beat()
    driver.run(1.0)
    assert driver.run_in().clock.left(driver.now) == pytest.approx(599.0)


def test_a_module_that_has_not_arrived_where_it_was_changes_nothing():
    driver, modules, robot = started()
    first = modules.asks(RequestKind.REFEREE, text="first")
    driver.event(driver.box.act, Target("tbm"), "operation")
    modules.asks(**GOAL)
    modules.says(scores=(SCORE,), kept="{}")
    driver.run(3.0)
    again = FakeModules(driver, "HNF", node="n2")
    again.says(request=first, scores=(), finished=True)
    run = driver.run_in()
    assert (len(run.steps), run.scores, run.phase) == (2, (SCORE,), Phase.RUNNING)
    assert again.run().kept == "{}", "it gets back what it kept"


@pytest.mark.parametrize("known", [0, 1, 2])
def test_a_module_that_fails_on_its_way_back_leaves_the_scores(known):
    """Its rules or parameters were changed meanwhile: it has no scores of the steps that it does not know."""
    driver, modules, _ = started()
    requests = [modules.asks(RequestKind.REFEREE, text="first")]
    driver.event(driver.box.act, Target("tbm"), "operation")
    requests.append(modules.asks(**GOAL))
    modules.says(scores=(SCORE,))
    driver.run(3.0)
    again = FakeModules(driver, "HNF", node="n2")
    other = requests[known - 1]._replace(text="other") if known else None
    again.says(request=other, scores=(SCORE._replace(value="0"),), failed="its rules changed")
    run = driver.run_in()
    assert (run.end_reason, run.scores) == (EndReason.MODULE_FAILED, (SCORE,))


def test_a_module_that_fails_after_its_way_back_counts():
    driver, modules, _ = started()
    asked = modules.asks(**GOAL)
    driver.run(3.0)
    again = FakeModules(driver, "HNF", node="n2")
    again.says(request=asked, scores=(SCORE,), failed="a fault of the rules")
    assert (driver.run_in().end_reason, driver.run_in().scores) == (EndReason.MODULE_FAILED, (SCORE,))


def test_a_held_run_can_be_stopped_and_is_not_started_without_a_module():
    driver, modules, robot = started()
    modules.asks(**GOAL)
    driver.run(3.0)
    driver.command("stop")
    assert (driver.run_in().end_reason, driver.run_in().held) == (EndReason.STOPPED, False)
    left = driver.run_in().clock.left(driver.now)
    driver.run(10.0)
    robot.says(RobotState.STOP)
    assert driver.run_in().clock.left(driver.now) == pytest.approx(left - 10.0, abs=0.01)
    assert driver.off("start")[0].startswith("Benchmarking module not connected")
    modules.beat()
    driver.command("start")
    assert modules.run().attempt == 2


def test_of_two_nodes_only_the_first_is_listened_to():
    driver, modules, robot = started()
    modules.asks(RequestKind.REFEREE, text="of the first")
    other = FakeModules(driver, "HNF", node="n2")
    other.beat()
    driver.event(driver.box.act, Target("tbm"), "operation")
    other.asks(RequestKind.REFEREE, text="of the second")
    assert len(modules.run().steps) == 1
    assert any("2 nodes drive HNF" in warning for warning in driver.view().warnings)
    modules.asks(RequestKind.REFEREE, text="of the first again")
    assert driver.run_in().asked.text == "of the first again"


def test_two_zones_with_the_same_benchmark_are_distinguished():
    driver = BoxDriver(competition(a=[event("STB")], b=[event("STB", team="Beta")]))
    modules = FakeModules(driver, "STB")
    modules.beat()
    robots = {zone: driver.connected(zone, team=team) for zone, team in (("a", "Alpha"), ("b", "Beta"))}
    for zone in robots:
        driver.command("start", zone)
    modules.asks(RequestKind.REFEREE, zone="a", text="in a")
    modules.asks(RequestKind.GOAL, zone="b", goal="x")
    assert driver.run_in("a").asked.text == "in a"
    assert driver.box_state("b") is BoxState.PREPARE
    assert driver.box_state("a") is BoxState.STOP


# -- who is there -------------------------------------------------------------------------------------


def at(mono):
    return Now(mono, 0.0)


def test_a_node_is_gone_when_it_was_not_heard_for_two_seconds():
    modules = Modules()
    assert modules.deadline() is None
    modules.hear(at(10.0), ModulesState("n", (ModuleInfo("STB"), ModuleInfo("HNF"))))
    assert modules.deadline() == 10.0 + GONE_S
    assert modules.driver(at(11.9), "HNF", "zone").node == "n"
    assert modules.driver(at(12.0), "HNF", "zone") is None
    assert modules.driver(at(11.0), "HOPF", "zone") is None


def test_a_node_that_drives_nothing_more_has_left():
    modules = Modules()
    for node in ("first", "second"):
        modules.hear(at(0.0), ModulesState(node, (ModuleInfo("STB"),)))
    modules.hear(at(0.1), ModulesState("first", ()))
    assert modules.driver(at(0.1), "STB", "zone").node == "second"
    modules.hear(at(0.1), ModulesState("second", ()))
    assert modules.driver(at(0.1), "STB", "zone") is None
    assert modules.deadline() is None


def test_a_node_that_comes_back_comes_after_the_one_that_took_over():
    modules = Modules()
    for mono, node in ((0.0, "first"), (1.0, "second")):
        modules.hear(at(mono), ModulesState(node, (ModuleInfo("STB"),)))
    assert modules.driver(at(1.0), "STB", "zone").node == "first"
    modules.forget_gone(at(2.5))
    modules.hear(at(2.6), ModulesState("first", (ModuleInfo("STB"),)))
    assert modules.driver(at(2.7), "STB", "zone").node == "second"


def test_a_module_that_repeats_itself_stays_there_and_nothing_happens():
    driver = BoxDriver(competition(a=[event("STB")]))
    modules = FakeModules(driver, "STB")
    modules.beat()
    for _ in range(10):
        driver.run(GONE_S / 2)
        before = driver.box.happenings
        modules.beat()
        assert driver.box.happenings == before
    driver.connected("a")
    assert driver.off("start", "a") == []
    again = FakeModules(driver, "STB", problems=["no file"])
    again.beat()
    assert driver.box.happenings != before
    assert driver.off("start", "a") == ["no file"]


def test_a_flood_of_nodes_does_not_grow():
    modules = Modules()
    for i in range(1000):
        modules.hear(at(0.0), ModulesState(str(i), (ModuleInfo("STB"),)))
    assert f"{MAX_NODES} nodes drive STB" in modules.warnings(at(0.0), "STB", "zone")[0]
    modules.hear(at(5.0), ModulesState("later", (ModuleInfo("STB"),)))
    assert modules.driver(at(5.0), "STB", "zone").node == "later"


def test_problems_and_warnings_of_a_zone_replace_those_of_all_zones():
    modules = Modules()
    modules.hear(at(0.0), ModulesState("n", (
        ModuleInfo("HNF", ("HNF.yaml:1: wrong",)), ModuleInfo("HNF", (), ("marker lost",), zone="North"),
        ModuleInfo("STB"), ModuleInfo("STB", ("North/STB.yaml:2: wrong",), zone="North"),
    )))
    assert modules.start_off(at(0.5), "HNF", "South") == ["HNF.yaml:1: wrong"]
    assert modules.start_off(at(0.5), "HNF", "North") == []
    assert modules.warnings(at(0.5), "HNF", "North") == ["marker lost"]
    assert modules.start_off(at(0.5), "STB", "South") == []
    assert modules.start_off(at(0.5), "STB", "North") == ["North/STB.yaml:2: wrong"]
