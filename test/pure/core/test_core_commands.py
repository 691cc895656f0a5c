"""The referee's buttons: when each is enabled, and every reason why not. The same reasons refuse the command."""

import pytest

from helpers.box_driver import BoxDriver
from helpers.commands import COMMANDS
from helpers.competition import competition, event
from roah_rsbb.core import effects
from roah_rsbb.core.actions.table import Target
from roah_rsbb.core.runs.run import IGNORES_STOP
from roah_rsbb.core.settings import Settings
from roah_rsbb.model.reason import Refused, RunName
from roah_rsbb.model.records import EndReason, Phase
from roah_rsbb.protocol import BoxState, RobotState
from roah_rsbb.scoring.sheet import Mark


def _refused(driver, command, zone="tbm"):
    """The reasons of a refusal, after which nothing must have changed."""
    before = _snapshot(driver)
    with pytest.raises(Refused) as refused:
        driver.command(command, zone)
    assert _snapshot(driver) == before
    assert driver.taken() == []
    return refused.value.reasons


def _snapshot(driver):
    driver.taken()
    return [
        (z.index, z.run, z.run and (z.run.phase, z.run.end_reason, z.run.message)) for z in driver.box.zones.values()
    ]


def _all_off(driver):
    return {command: driver.off(command, "tbm") for command in COMMANDS}


NOTHING_CONNECTED = {
    "disconnect": ["No run is connected"],
    "start": ["No run is connected: press connect first"],
    "stop": ["No run is connected, so there is nothing to stop"],
}


WITHOUT_RULES = {
    "continue": ["The run is not in doubt after a restart"],
    "pause": ["The rules of this benchmark do not allow a pause"],
    "resume": ["The clock is not paused"],
    "next_phase": ["This benchmark has no phases"],
    "previous_phase": ["This benchmark has no phases"],
}


def test_there_are_exactly_these_commands():
    assert set(COMMANDS) == {
        "connect", "disconnect", "start", "stop", "previous", "next", "continue", "pause", "resume", "next_phase",
        "previous_phase", "open_sheet", "no_show", "withdrawn",
    }


def test_without_a_robot():
    driver = BoxDriver(competition(tbm=["HGTKMH", "HWV", "HCFGAC"]))
    assert _all_off(driver) == {
        "connect": ["No robot of team Alpha is active: none of its beacons arrives on UDP port 6666"],
        "previous": ["This is the zone's first event"],
        "next": [],
        "open_sheet": [], "no_show": [], "withdrawn": [],
        **NOTHING_CONNECTED, **WITHOUT_RULES,
    }
    driver.command("next")
    assert (driver.off("previous"), driver.off("next")) == ([], [])
    driver.command("next")
    assert (driver.off("previous"), driver.off("next")) == ([], ["This is the zone's last event"])


def test_connected():
    driver = BoxDriver(competition(tbm=["HGTKMH"]))
    driver.connected()
    connected = "A run is connected: disconnect it first"
    assert _all_off(driver) == {
        "connect": ["Already connected"],
        "disconnect": [], "start": [], "stop": ["The run is not started: disconnect to leave it"],
        "previous": [connected, "This is the zone's first event"],
        "next": [connected, "This is the zone's last event"],
        "open_sheet": [connected], "no_show": [], "withdrawn": [],
        **WITHOUT_RULES,
    }


def test_running():
    driver = BoxDriver()
    driver.executing()
    off = _all_off(driver)
    assert (off["start"], off["stop"], off["disconnect"]) == (["Already started"], [], [])


@pytest.mark.parametrize("command", [command for command in COMMANDS if command != "stop"])
def test_whatever_is_off_is_refused_with_the_same_reasons_and_changes_nothing(command):
    scenes = [BoxDriver(competition(tbm=["HGTKMH"])), BoxDriver(), BoxDriver(), BoxDriver(listening=True)]
    scenes[1].connected()
    scenes[2].executing()
    for driver in scenes:
        off = driver.off(command)
        if off:
            assert _refused(driver, command) == off


def test_connect_while_the_box_listens_names_all_that_is_missing():
    config = competition(tbm=[event("HNF")])
    driver = BoxDriver(config, Settings(max_datagram=50), listening=True, last_port=65535)
    driver.robot(skew=0.15).beacon()
    listening, skew, ports, size = _refused(driver, "connect")
    assert listening == "The box is still listening for another box, for 5 s"
    assert skew.startswith("Clock skew of robot r1 of team Alpha is +0.150 s, but must be below 0.100 s")
    assert "synchronise" in skew
    assert ports.startswith("All UDP ports up to 65535 are used up")
    assert size.startswith("The beacon may need 132 bytes with one more robot, and robots may read only 50")


@pytest.mark.parametrize("skew, fits", [
    (0.05, True), (-0.05, True), (0.15, False), (-0.15, False), (0.125, False), (-0.125, False), (0.124, True),
])
def test_connect_and_start_need_a_skew_below_the_allowed_one(skew, fits):
    driver = BoxDriver(settings=Settings(allowed_skew=0.125))  # exact in binary
    robot = driver.robot(skew=skew)
    robot.beacon()
    if not fits:
        reason, = _refused(driver, "connect")
        assert f"is {skew:+.3f} s, but must be below 0.125 s" in reason
        robot.skew = 0.0
        robot.beacon()  # the clock was put right: believed after the window
        driver.run(3.0)
        robot.beacon()
    driver.command("connect")
    robot.port = driver.run_in().port
    robot.skew = skew
    robot.lives(4)  # a clock that is behind its own beacon is believed after a while
    if fits:
        driver.command("start")
    else:
        reason, = _refused(driver, "start")
        assert reason.startswith(f"Clock skew of the robot is {skew:+.3f} s, but must be below 0.125 s")


def test_the_command_itself_checks_the_skew_not_what_the_button_showed():
    driver = BoxDriver()
    robot = driver.robot()
    robot.beacon(3)
    assert driver.off("connect") == []
    robot.skew = 0.5
    robot.beacon(4)
    assert "Clock skew" in _refused(driver, "connect")[0]


def test_connect_needs_a_robot_that_was_heard_within_the_timeout():
    driver = BoxDriver(settings=Settings(robot_timeout=30.0))
    driver.robot().beacon()
    driver.run(30.0)
    assert driver.off("connect") == []
    driver.run(0.1)
    assert "No robot of team Alpha is active" in _refused(driver, "connect")[0]


def test_a_skew_that_is_not_known_is_reported():
    driver = BoxDriver()
    robot = driver.robot()
    robot.beacon(3)
    driver.set_clock(+0.02)
    assert driver.off("connect") == []
    driver.set_clock(+1.0)
    assert _refused(driver, "connect") == ["Clock skew of robot r1 of team Alpha is not known yet"]


def test_start_needs_an_answer_of_the_robot():
    driver = BoxDriver()
    driver.robot().beacon()
    driver.command("connect")
    assert _refused(driver, "start") == ["Robot has not answered on the private channel yet"]
    driver.run(10)
    assert _refused(driver, "start") == ["Robot has not answered on the private channel yet"]
    driver.event(driver.box.on_unreadable, driver.run_in().port, "10.0.0.2: wrong password?")
    assert _refused(driver, "start") == [
        "Robot has not answered on the private channel yet", "10.0.0.2: wrong password?"
    ]


def test_every_reason_against_a_start_is_listed():
    driver = BoxDriver(competition(tbm=[event(timeout=60)]))
    robot = driver.executing()
    driver.command("stop")
    robot.skew = +200
    for _ in range(3):
        robot.says(RobotState.EXECUTING, after=1.5)
    driver.run(60)
    over, silent, skew, state = _refused(driver, "start")
    assert over.startswith("The run's time is up (the clock kept running after the stop)")
    assert silent == ("The robot has disappeared: no message for 60 s, and no beacon from its address. It may "
                      "still be moving, and STOP may not reach it: check it")
    assert skew.startswith("Clock skew of the robot is +200")
    assert state == "Robot has not stopped yet: it reports EXECUTING"


def test_start_after_the_boxs_clock_was_set_waits_for_the_next_message():
    driver = BoxDriver()
    robot = driver.connected()
    driver.set_clock(100)
    robot.skew -= 100
    assert "Clock skew of the robot is not known" in _refused(driver, "start")[0]
    robot.skew = 0.0
    robot.says()
    driver.command("start")


def test_the_first_stop_ends_the_run_and_the_second_changes_nothing():
    driver = BoxDriver()
    driver.executing()
    driver.command("stop")
    run = driver.run_in()
    assert (run.phase, run.end_reason, run.message.state) == (Phase.ENDED, EndReason.STOPPED, BoxState.STOP)
    driver.command("stop")
    assert driver.run_in() is run
    assert len(run.record(driver.now).stops) == 1
    assert driver.off("stop") == ["The run is over: disconnect to leave it"]


def test_a_robot_that_does_not_answer_stop_is_the_first_warning_and_the_reason_why_stop_is_off():
    driver = BoxDriver(competition(tbm=["HGTKMH", "HWV"]))
    robot = driver.executing()
    driver.command("stop")
    driver.run(0.9)
    assert (driver.view().warnings, driver.view().not_stopped) == ((), ("r1 of team Alpha",))
    driver.run(0.2)
    assert driver.view().warnings == (IGNORES_STOP,)
    assert driver.off("stop") == ["The run is over, but the robot did not answer STOP: stop it by hand"]
    driver.run(30.0)
    assert driver.view().warnings[0] == IGNORES_STOP
    assert driver.view().warnings[1].startswith("The robot has disappeared")
    with pytest.raises(Refused, match=f"{IGNORES_STOP}; The run of HGTKMH"):
        driver.choose(1)
    robot.says(RobotState.STOP)
    assert driver.view().warnings == ()
    assert driver.off("stop") == ["The run is over: disconnect to leave it"]


@pytest.mark.parametrize("begin", ["connected", "executing"])
def test_a_robot_need_not_report_stop_before_the_end_of_the_run(begin):
    driver = BoxDriver()
    robot = getattr(driver, begin)()
    robot.says(RobotState.EXECUTING)
    driver.run(2.0)
    assert IGNORES_STOP not in driver.view().warnings


def test_a_run_by_its_name_is_stopped_and_never_left():
    driver = BoxDriver(competition(tbm=["HGTKMH", "HWV"]))
    robot = driver.connected()
    run = driver.run_in()
    name = RunName("tbm", run.identity)
    driver.event(driver.box.scores.stop, name)
    assert run.phase is Phase.CONNECTED
    driver.command("start")
    robot.executes()
    driver.event(driver.box.scores.stop, name, "Anna")
    assert (run.phase, run.end_reason, run.message.state) == (Phase.ENDED, EndReason.STOPPED, BoxState.STOP)
    assert run.record(driver.now).stops[0].who == "Anna"
    driver.event(driver.box.scores.stop, name)
    driver.event(driver.box.scores.stop, RunName("tbm"))
    assert driver.run_in() is run
    driver.command("disconnect")
    driver.event(driver.box.scores.stop, name)  # it is over: that is what was wanted
    with pytest.raises(Refused, match="'HWV-1' is not one of the newest"):
        driver.event(driver.box.scores.stop, RunName("tbm", "HWV-1"))


def test_a_stop_that_was_meant_for_the_run_before_does_not_stop_this_one():
    driver = BoxDriver(competition(tbm=["HGTKMH", "HWV"]))
    driver.executing()
    before = RunName("tbm", driver.run_in().identity)
    driver.command("stop")
    driver.command("disconnect")
    driver.run(2.0)
    driver.executing()
    with pytest.raises(Refused, match="is over, but run .* is running in zone 'tbm': stop again"):
        driver.event(driver.box.scores.stop, before)
    assert driver.run_in().phase is Phase.RUNNING


def test_stop_does_not_leave_a_run_that_never_started():
    driver = BoxDriver()
    driver.connected()
    driver.command("stop")
    assert driver.run_in().phase is Phase.CONNECTED


@pytest.mark.parametrize("command", COMMANDS)
def test_an_unknown_zone_is_refused_with_the_nearest(command):
    driver = BoxDriver(competition(tbm=["HGTKMH"], fbm=["HWV"]))
    assert _refused(driver, command, "tmb") == ["no zone 'tmb': did you mean 'tbm'?"]
    assert _refused(driver, command, "nowhere") == ["no zone 'nowhere': there is 'tbm', 'fbm'"]


SWITCHES = (("switch", "", {"number": 1}), ("damaged", "", {"number": 1}), ("confirm_switches",))


def test_scores_and_other_calls_need_a_run_in_a_zone():
    driver = BoxDriver()
    box = driver.box
    for method in (
        lambda now, zone: box.scores.mark(now, RunName(zone), Mark("Penalized", "bumps", 1)),
        *(lambda now, zone, call=call: box.act(now, Target(zone), *call) for call in (("operation",), *SWITCHES)),
    ):
        with pytest.raises(Refused, match="No run is connected: press connect first"):
            driver.event(method, "tbm")
        with pytest.raises(Refused, match="no zone 'tmb': did you mean 'tbm'"):
            driver.event(method, "tmb")


def test_a_stop_without_a_run_does_not_ask_for_one():
    driver = BoxDriver()
    with pytest.raises(Refused, match="No run is connected, so there is nothing to stop"):
        driver.event(driver.box.scores.stop, RunName("tbm"))


def test_calls_that_make_no_sense_in_a_task_benchmark():
    driver = BoxDriver()
    driver.connected()
    with pytest.raises(Refused, match="zone 'tbm' has no manual operation now"):
        driver.event(driver.box.act, Target("tbm"), "operation")
    for call in SWITCHES:
        with pytest.raises(Refused, match="zone 'tbm' runs HGTKMH, which has no switches"):
            driver.event(driver.box.act, Target("tbm"), *call)


@pytest.mark.parametrize("is_running", [True, False])
def test_disconnect_ends_the_channel_with_no_last_message_but_stop(is_running):
    driver = BoxDriver()
    robot = driver.executing() if is_running else driver.connected()
    driver.taken()
    driver.command("disconnect")
    taken = driver.taken()
    sent = [effect.message.state for effect in taken if isinstance(effect, effects.SendState)]
    assert sent == [BoxState.STOP] * is_running
    assert effects.CloseChannel(robot.port) in taken
    assert driver.box.beacon().robots == ()
    assert driver.channels == {}
