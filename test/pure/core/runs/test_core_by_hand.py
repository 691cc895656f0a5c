"""A score sheet without a robot: scored by hand, no-show, withdrawn; and the choice of one of several robots."""

import dataclasses

import pytest

from helpers.box_driver import BoxDriver, public_document
from helpers.competition import DOOR, UTC0, competition, event
from roah_rsbb.core import effects
from roah_rsbb.core.actions.table import Target
from roah_rsbb.core.views.document import coming_events
from roah_rsbb.core.views.schedule import EventState, schedule
from roah_rsbb.model.reason import Refused, RunName
from roah_rsbb.model.records import EndReason
from roah_rsbb.protocol import RobotState
from roah_rsbb.rulebook.benchmarks import EventRules, PhaseRule
from roah_rsbb.scoring.counting import Why

TWO = {"tbm": [event(timeout=60.0), event("HWV", scheduled=UTC0 + 600)]}


def last_record(driver):
    return driver.box.finished.records()[0]


# -- scored by hand -----------------------------------------------------------------------------------


def test_the_referee_alone_starts_and_stops_the_clock():
    driver = BoxDriver(competition(**TWO))
    driver.command("open_sheet")
    view = driver.view()
    assert (view.phase, view.by_hand, view.robot, view.timer) == ("connected", True, None, 60.0)
    assert "Without a robot: only the referee starts and stops the clock" in view.state
    assert driver.box.beacon().robots == ()
    driver.command("start")
    driver.run(20.0)
    assert driver.view().timer == pytest.approx(40.0)
    driver.score(DOOR.group, DOOR.desc, 1)
    driver.command("stop")
    driver.command("start")
    driver.run(5.0)
    driver.command("stop")
    driver.command("disconnect")
    record = last_record(driver)
    assert (record.end_reason, record.elapsed_s, record.robots) == ("stopped", pytest.approx(25.0), ())
    assert (record.items[0].value, record.team, record.zone) == (1, "Alpha", "tbm")
    assert record.identity.startswith("HGTKMH-6667-")
    assert driver.taken(effects.OpenChannel, effects.RunOpened, effects.RunLogged) == []


def test_the_clock_of_a_run_by_hand_times_out():
    driver = BoxDriver(competition(**TWO))
    driver.command("open_sheet")
    driver.command("start")
    driver.taken()
    driver.run(61.0)
    assert driver.run_in().end_reason is EndReason.TIMEOUT
    assert len(driver.taken(effects.TimeoutRung)) == 1
    assert driver.off("start")[0].startswith("The run ended by timeout")


def test_a_run_by_hand_follows_the_rules():
    rules = EventRules(setup_time=10.0, pause=True, phases=(PhaseRule("A", 20.0), PhaseRule("B")))
    driver = BoxDriver(competition(tbm=[event(rules=rules)]))
    driver.command("open_sheet")
    driver.run(11.0)
    assert driver.view().warnings == ("The setup time of 0:10 is over",)
    driver.command("start")
    assert driver.view().state.splitlines()[0] == "Phase 1 of 2, A: Started by the referee"
    driver.run(21.0)
    assert driver.view().warnings == ("The 0:20 of phase 1 of 2, A are over",)
    driver.command("next_phase")
    assert driver.view().state.splitlines()[0] == "Phase 2 of 2, B: begun by the referee"
    driver.command("pause")
    driver.run(30.0)
    driver.command("stop")
    driver.command("disconnect")
    assert [(p.name, p.elapsed_s) for p in last_record(driver).phases] == [("A", pytest.approx(21.0)), ("B", 0.0)]


def test_the_public_sees_the_team_of_a_run_by_hand():
    driver = BoxDriver(competition(**TWO))
    driver.command("open_sheet")
    driver.command("start")
    run, = public_document(driver).runs_shown()
    assert (run.teams, run.phase, run.elapsed.counting) == (("Alpha",), "running", True)


# -- no-show, withdrawn -------------------------------------------------------------------------------


@pytest.mark.parametrize("command, end", [("no_show", "no_show"), ("withdrawn", "withdrawn")])
def test_an_event_without_its_team(command, end):
    driver = BoxDriver(competition(**TWO))
    driver.taken()
    driver.command(command)
    record = last_record(driver)
    assert (record.end_reason, record.started_utc, record.elapsed_s) == (end, 0.0, 0.0)
    assert record.closed_utc == driver.now.utc
    assert [stop.end_reason for stop in record.stops] == [end]
    assert driver.run_in() is None
    assert driver.view().event.code == "HWV"
    assert [e.value["command"] for e in driver.taken(effects.Recorded)] == [command]
    driver.enter("sign_off", RunName(record.zone, record.identity), "Anna")
    assert last_record(driver).sign_off.who == "Anna"
    line = schedule(driver.box, driver.now)[0]
    assert (line.state, line.begins) == (EventState.DONE, record.opened_utc)


def test_a_team_whose_robot_is_connected_may_still_be_missing():
    driver = BoxDriver(competition(**TWO))
    driver.connected()
    driver.command("no_show")
    assert (last_record(driver).end_reason, last_record(driver).robots) == ("no_show", ("r1",))
    assert driver.box.beacon().robots == ()


def test_a_team_that_withdraws_after_a_stop_keeps_its_time_and_sheet():
    driver = BoxDriver(competition(**TWO))
    robot = driver.executing()
    robot.lives(20)
    driver.score(DOOR.group, DOOR.desc, 1)
    assert driver.off("withdrawn") == ["A run is running: stop it first"]
    assert driver.off("no_show") == ["The run was started, so its team appeared"]
    driver.command("stop")
    robot.lives(10)
    driver.command("withdrawn")
    record = last_record(driver)
    assert (record.end_reason, round(record.elapsed_s), record.items[0].value) == ("withdrawn", 20, 1)
    assert [stop.end_reason for stop in record.stops] == ["stopped", "withdrawn"]


def test_a_team_that_appears_after_all_gets_its_run():
    driver = BoxDriver(competition(tbm=[event(rules=EventRules(attempts=1))]))
    driver.command("no_show")
    assert driver.off("open_sheet") == []
    driver.connected()
    assert driver.off("start") == []


# -- two robots of a team -----------------------------------------------------------------------------


def two_robots():
    driver = BoxDriver(competition(**TWO))
    for name, host in (("r1", "10.0.0.2"), ("r2", "10.0.0.3")):
        driver.robot(name=name, host=host).beacon()
    return driver


def test_the_referee_chooses_one_of_several_robots():
    driver = two_robots()
    assert driver.view().robots_to_choose == ("r1", "r2")
    assert "Several robots of team Alpha are active (r1, r2): choose which one connects" in driver.view().state
    driver.taken()
    driver.event(driver.box.act, Target("tbm"), "connect", "Anna", {"robot": "r2"})
    assert driver.run_in().robot == ("Alpha", "r2")
    assert driver.view().robots_to_choose == ()
    recorded, = driver.taken(effects.Recorded)
    assert recorded.value == {"command": "connect", "robot": "r2"}


def test_a_robot_that_does_not_exist_is_refused():
    driver = two_robots()
    with pytest.raises(Refused, match="No robot 'r3' of team Alpha is ready to connect: there is 'r1', 'r2'"):
        driver.event(driver.box.act, Target("tbm"), "connect", "", {"robot": "r3"})
    with pytest.raises(Refused, match="for all robots at once"):
        all_robots = BoxDriver(competition(all=[event("HSUF", team="ALL")]))
        all_robots.event(all_robots.box.act, Target("all"), "connect", "", {"robot": "r1"})
    assert driver.run_in() is None


def test_one_robot_is_no_choice():
    driver = two_robots()
    driver.event(driver.box.act, Target("tbm"), "connect", "", {"robot": "r1"})
    driver.command("disconnect")
    driver = BoxDriver(competition(**TWO))
    driver.robot().beacon()
    assert driver.view().robots_to_choose == ()
    robot = driver.robot("Beta")
    robot.beacon()
    robot.state = RobotState.STOP
    assert driver.view().robots_to_choose == ()


# -- the team is named --------------------------------------------------------------------------------


@pytest.mark.parametrize("command", ["no_show", "withdrawn", "open_sheet"])
@pytest.mark.parametrize("team, shown, why", [
    ("Beta", "", "is of team Alpha, not of team Beta: choose the event first"),
    ("Alpha", "y", "is at another event of team Alpha now"),
])
def test_a_command_that_hits_another_team_is_refused(command, team, shown, why):
    """After a refused choose, the wrong team was withdrawn."""
    driver = BoxDriver(competition(tbm=[dataclasses.replace(event(), id="x"), event("HWV", team="Beta", run=2)]))
    with pytest.raises(Refused, match=why):
        driver.event(driver.box.act, Target("tbm", event=shown), command, "Anna", {"team": team})
    assert (driver.run_in(), driver.box.finished.records()) == (None, [])
    driver.event(driver.box.act, Target("tbm", event="x"), command, "Anna", {"team": "Alpha"})
    assert (driver.run_in() is not None) is (command == "open_sheet")


@pytest.mark.parametrize("command", ["no_show", "withdrawn"])
def test_a_final_command_without_a_team_is_refused(command):
    driver = BoxDriver(competition(tbm=[event()]))
    with pytest.raises(Refused, match="Name the team"):
        driver.event(driver.box.act, Target("tbm"), command)


# -- what follows -------------------------------------------------------------------------------------

DAY = [dataclasses.replace(event(code, run=run, scheduled=UTC0 + 600.0 * run), id=f"e{run}")
       for run, code in ((1, "HGTKMH"), (2, "HWV"), (3, "HCFGAC"))]


@pytest.mark.parametrize("command", ["no_show", "withdrawn"])
def test_an_event_without_its_team_is_not_offered_as_the_next_one(command):
    driver = BoxDriver(competition(tbm=DAY))
    driver.choose(1)
    driver.command(command)
    assert driver.box.zones["tbm"].event == DAY[2]
    driver.command("previous")
    driver.command("previous")
    assert [event.run for event in public_document(driver).public.following] == [1, 3]
    assert [line.event.run for line in coming_events(driver.box)] == [1, 3]
    driver.executing().completes()
    driver.command("disconnect")
    assert driver.box.zones["tbm"].event == DAY[2]
    # The team appears after all.
    driver.command("previous")
    assert driver.box.zones["tbm"].event == DAY[1]
    assert driver.off("open_sheet") == []


def test_a_zone_without_another_event_stays_and_keeps_its_log():
    driver = BoxDriver(competition(tbm=DAY[:2]))
    driver.command("next")
    driver.command("withdrawn")
    driver.command("previous")
    driver.executing().completes()
    driver.command("disconnect")
    assert driver.box.zones["tbm"].event == DAY[0]
    assert driver.view().log


def test_a_withdrawal_after_a_run_leaves_the_run_as_the_result():
    """Tables said "withdrawn, 0 points", and standings counted the run."""
    driver = BoxDriver(competition(tbm=DAY))
    driver.executing()
    driver.score(DOOR.group, DOOR.desc, 1)
    driver.command("stop")
    driver.command("disconnect")
    ran = last_record(driver)
    driver.command("withdrawn")
    line = schedule(driver.box, driver.now)[0]
    assert (line.state, line.result.shown.record) == (EventState.DONE, ran)
    assert [run.end_reason for run in public_document(driver).results_shown(signed=False)] == ["stopped"]
    assert [ruling.why for ruling in driver.box.scores.rulings(driver.now)] == [Why.COUNTS, Why.RAN]
