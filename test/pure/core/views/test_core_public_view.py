"""The box as the public may see it, and the runs explained for spectators."""

import dataclasses
from dataclasses import replace

import pytest

from helpers.all_robots import all_robots_box, connect_all, robots_of, start_all
from helpers.box_driver import BoxDriver, public_document
from helpers.competition import DOOR, UTC0, competition, event, run_record
from helpers.module_player import does_goal, started
from roah_rsbb.core.actions.table import Target
from roah_rsbb.core.runs.reported import MAX_SAID
from roah_rsbb.core.views.document import Documents
from roah_rsbb.core.views.public import MAX_FINISHED, MAX_FOLLOWING, Publicity, PublicResults
from roah_rsbb.model.modules import RequestKind, ScoreValue
from roah_rsbb.model.reason import RunName
from roah_rsbb.model.records import ItemRecord, SignOff
from roah_rsbb.model.rules import Stage, StageColumn
from roah_rsbb.protocol import RobotState
from roah_rsbb.results.standings import public_standings
from roah_rsbb.rulebook.standing_rules import StandingRules
from roah_rsbb.wording import times

NONE, OUTCOMES, SCORES = PublicResults.NONE, PublicResults.OUTCOMES, PublicResults.SCORES


def _view(driver, results=NONE, provisional=False):
    return public_document(driver, results, provisional)


def _run(driver, results=NONE):
    (run,) = _view(driver, results).runs_shown()
    return run


def _finished(driver, results, provisional=False):
    return _view(driver, results, provisional).results_shown(signed=True)


def _left(driver):
    return _run(driver).shown_s(driver.now.mono)


def _following(driver):
    return [(event.zone, event.team, event.run) for event in _view(driver).public.following]


def test_the_time_zone_of_the_venue():
    here = competition(tbm=["HWV"])
    driver = BoxDriver(dataclasses.replace(here, time_zone="Asia/Tokyo"))
    assert _view(driver).public.time_zone == "Asia/Tokyo"
    assert times.date_time(UTC0).endswith("+09:00")
    driver.event(driver.box.reload.take, dataclasses.replace(here, time_zone="America/Lima"), 1, ["time zone"], "Olga")
    assert _view(driver).public.time_zone == "America/Lima"
    assert times.date_time(UTC0).endswith("-05:00")


def test_a_run_from_connect_to_its_end():
    driver = BoxDriver(competition(tbm=[event(timeout=60.0)], other=["HWV"]))
    assert _view(driver).runs_shown() == ()
    robot = driver.connected()
    run = _run(driver)
    assert (run.event.zone, run.event.benchmark, run.teams) == ("tbm", "About HGTKMH", ("Alpha",))
    assert (run.phase, run.elapsed.counting, _left(driver), run.end_reason) == ("connected", False, 60.0, "")
    driver.command("start")
    robot.lives(20)
    run = _run(driver)
    assert (run.phase, run.elapsed.counting) == ("running", True)
    assert _left(driver) == pytest.approx(40.0, abs=0.1)
    driver.command("stop")
    run = _run(driver, OUTCOMES)
    assert (run.phase, run.elapsed.counting, run.end_reason) == ("ended", False, "stopped")


def test_the_time_of_the_whole_run_counts_and_pauses_during_a_manual_operation():
    driver, modules, robot = started()
    modules.asks(goal="[1, 2, 3]", timeout=5.0)
    modules.lives(2.0, robot)
    assert _left(driver) == pytest.approx(driver.run_in().clock.left(driver.now)) == pytest.approx(598.0, abs=1.0)
    driver, modules, robot = started()
    modules.asks(RequestKind.REFEREE, text="Place the object")
    left = _left(driver)
    modules.lives(10.0, robot)
    assert _run(driver).is_paused
    assert _left(driver) == pytest.approx(left)


def test_all_robots_at_once_name_their_teams():
    driver = all_robots_box()
    robots = robots_of(driver)
    connect_all(driver, robots)
    start_all(driver, robots)
    run = _run(driver)
    assert (run.event.team, run.teams, run.elapsed.counting) == ("ALL", ("Alpha", "Beta", "Gamma"), True)


def test_what_follows_is_sorted_over_all_zones_and_is_not_what_runs():
    driver = BoxDriver(competition(
        tbm=[event("HGTKMH", scheduled=UTC0), event("HCFGAC", run=2, scheduled=UTC0 + 200.0)],
        other=[event("HWV", team="Beta", scheduled=UTC0 + 100.0)],
    ))
    first, second, other = ("tbm", "Alpha", 1), ("tbm", "Alpha", 2), ("other", "Beta", 1)
    assert _following(driver) == [first, other, second]
    robot = driver.executing()
    assert _following(driver) == [other, second]
    driver.command("stop")
    driver.command("disconnect")
    assert _following(driver)[0] == first, "stopped: the referee may repeat it"
    robot = driver.executing()
    robot.completes()
    driver.command("disconnect")
    assert _following(driver) == [other, second]


def test_the_public_sees_how_late_the_next_event_is():
    driver = BoxDriver(competition(tbm=[event(scheduled=UTC0 + 60.0)]))
    assert [one.begins_utc_s for one in _view(driver).public.following] == [UTC0 + 60.0]
    driver.run(600.0)
    (late,) = _view(driver).public.following
    assert late.begins_utc_s >= UTC0 + 600.0 > late.scheduled_utc_s


def test_the_list_of_next_events_is_bounded():
    driver = BoxDriver(competition(tbm=[event(run=run) for run in range(1, MAX_FOLLOWING + 3)]))
    assert [run for _, _, run in _following(driver)] == list(range(1, MAX_FOLLOWING + 1))


def _sign(driver):
    identity = driver.box.finished.records()[0].identity
    driver.enter("sign_off", RunName("tbm", identity), "Anna")


def _a_run(driver):
    robot = driver.executing()
    driver.score(DOOR.group, DOOR.desc, 1)
    robot.completes()
    driver.command("disconnect")


def test_results_are_public_once_they_are_signed_off():
    driver = BoxDriver()
    _a_run(driver)
    assert _view(driver, SCORES).public_results == {}
    _sign(driver)
    assert len(_finished(driver, SCORES)) == 1
    driver.command("open_sheet", again=True)
    driver.command("start")
    driver.command("stop")
    driver.command("disconnect")
    assert _finished(driver, SCORES) == (), "the run was repeated, and the new one is not signed off"


def test_results_that_are_not_signed_off_are_provisional_if_the_organisers_show_them():
    driver = BoxDriver()
    _a_run(driver)
    (result,) = _view(driver, OUTCOMES, True).results_shown(signed=False)
    assert (result.end_reason, result.groups) == ("completed", ())
    assert _view(driver, NONE, True).public_results == {}
    _sign(driver)
    view = _view(driver, SCORES, True)
    assert [len(view.results_shown(signed)) for signed in (True, False)] == [1, 0]


def test_results_are_published_only_if_allowed():
    driver = BoxDriver()
    _a_run(driver)
    _sign(driver)
    assert _finished(driver, NONE) == ()
    (outcome,) = _finished(driver, OUTCOMES)
    assert (outcome.end_reason, outcome.groups, outcome.module_scores) == ("completed", (), ())
    (score,) = _finished(driver, SCORES)
    assert [(item.kind, item.value) for group in score.groups for item in group.items if item.name == DOOR.desc] == [
        ("bool", 1)]


def test_items_that_are_neither_a_yes_nor_a_number_are_not_shown():
    def item(kind, value=0, text="", not_attempted=False):
        return ItemRecord("Group", f"a {kind}", kind, value, not_attempted, text=text)
    record = run_record(1, sign_off=SignOff(1.0, "Anna"))._replace(items=(
        item("bool", 1), item("int", -2), item("decimal", 1, "1.5"), item("choice", 1, "left"), item("rating", 7, "7"),
        item("later", 4), item("uint", not_attempted=True)))
    driver = BoxDriver()
    driver.box.finished.add(record)
    ((group,),) = [result.groups for result in _finished(driver, SCORES)]
    assert (group.name, group.not_attempted) == ("Group", 1)
    assert [tuple(one) for one in group.items] == [
        ("a bool", "bool", 1), ("a int", "count", 0), ("a decimal", "count", 1), ("a later", "count", 4),
        ("a uint", "count", 0)]


def test_what_a_module_scored_is_a_result():
    driver, modules, _ = started()
    reached = ScoreValue("", "reached", "1", "")
    modules.says(scores=(reached,), finished=True)
    driver.command("disconnect")
    _sign(driver)
    assert _finished(driver, SCORES)[0].module_scores == (reached,)
    assert _finished(driver, OUTCOMES)[0].module_scores == ()


def test_only_the_newest_results_are_published():
    driver = BoxDriver()
    for run in range(MAX_FINISHED + 1):
        driver.box.finished.add(run_record(run, sign_off=SignOff(1.0, "Anna")))
    assert [run.event.run for run in _finished(driver, OUTCOMES)] == list(range(MAX_FINISHED, 0, -1))


def test_while_nothing_happens_nothing_changes():
    driver = BoxDriver()
    robot = driver.executing()
    documents = Documents(driver.box, "uuid", "", Publicity(SCORES, True, True))
    before = documents.look(driver.now)
    robot.lives(3)
    now = documents.look(driver.now)
    assert now.public is before.public and now.public_runs is before.public_runs
    driver.command("stop")
    assert documents.look(driver.now).public_runs != before.public_runs


def _ranked(records, rules, choice, titles):
    rules = StandingRules()
    rules.stages = (Stage("All", (StageColumn("HGTKMH"),)),)
    return public_standings(records, rules, choice, titles)


def test_a_standing_shows_nothing_of_runs_that_are_not_signed_off():
    driver = BoxDriver()
    documents = Documents(driver.box, "uuid", "", Publicity(SCORES, True, ranked=_ranked))
    driver.executing()
    driver.command("stop")
    driver.command("disconnect")
    assert documents.look(driver.now).public.standings == ()
    _sign(driver)
    assert [[rank.team for rank in one.ranks] for one in documents.look(driver.now).public.standings] == [
        ["Alpha"], ["Alpha"]]


def test_what_cannot_be_made_for_the_public_hides_nothing_from_the_referees():
    def fails(*_):
        raise OverflowError("too large")

    driver = BoxDriver()
    documents = Documents(driver.box, "uuid", "", Publicity(SCORES, ranked=fails))
    driver.connected()
    document = documents.look(driver.now)
    assert (document.zones["tbm"].phase, document.public_runs) == ("connected", {})
    assert isinstance(documents.fault, OverflowError)


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
    assert len(driver.box.zones["tbm"].saved().run.said) == MAX_SAID, "no more is written with each change"


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
