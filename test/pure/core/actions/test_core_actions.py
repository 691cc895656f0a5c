"""The referee's buttons: when each is on, every reason why not, which also refuses the command; and its record."""

import pytest

from helpers.box_driver import BoxDriver
from helpers.commands import COMMANDS
from helpers.competition import competition, event
from roah_rsbb.core import effects
from roah_rsbb.core.actions import table
from roah_rsbb.core.actions.runs import SIGNED_OFF
from roah_rsbb.core.actions.table import KINDS, Target
from roah_rsbb.core.runs.run import IGNORES_STOP
from roah_rsbb.core.settings import Settings
from roah_rsbb.model.actions import ACTIONS, ENTRIES, EVERY, confirmed_by
from roah_rsbb.model.reason import Refused, RunName, decoded, encoded
from roah_rsbb.model.records import EndReason, Phase
from roah_rsbb.protocol import BoxState, RobotState
from roah_rsbb.scoring.sheet import Mark
from roah_rsbb.wording.texts import did_you_mean


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
    driver.event(driver.box.arrivals.on_unreadable, driver.run_in().port, "10.0.0.2: wrong password?")
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


def refusal(driver, target, name, given=None):
    driver.taken()
    with pytest.raises(Refused) as refused:
        driver.event(driver.box.act, target, name, "Anna", given or {})
    return refused.value.reasons


def test_what_faces_show_has_the_order_of_the_table_whatever_that_of_the_code(monkeypatch):
    driver = BoxDriver()
    expected = driver.box.actions.shown(driver.now, driver.box.zones["tbm"])
    monkeypatch.setattr(table, "KINDS", table.KINDS[::-1])
    other = BoxDriver()
    assert other.box.actions.shown(other.now, other.box.zones["tbm"]) == expected


def test_each_row_of_the_table_has_code():
    assert sorted(kind.name for kind in KINDS) == sorted(ACTIONS)
    assert not set(ACTIONS) & set(ENTRIES)


def test_an_unknown_action():
    assert refusal(BoxDriver(), Target("tbm"), "connekt") == ["no action 'connekt': did you mean 'connect'?"]


@pytest.mark.parametrize("name", EVERY)
@pytest.mark.parametrize("given", [{"no such field": 1}, {"robot": [1], "reason": {}, "running": "x", "command": "y"}])
def test_wrong_values_are_refused_and_recorded(name, given):
    driver = BoxDriver()
    reasons = refusal(driver, Target("tbm"), name, given)
    recorded, = driver.taken(effects.Recorded)
    assert recorded.value["refused"] == reasons and recorded.who == "Anna"
    journaled = {kind.name: kind.journaled for kind in KINDS}
    journaled.update(judge_mark="mark", withdraw_sheet="withdraw")
    assert recorded.value["command"] == (journaled.get(name) or name)


@pytest.mark.parametrize("name", [name for name in EVERY if name not in ("connect", "publish")])
def test_an_unknown_zone_is_refused_with_the_zones_that_there_are(name):
    given = {"team": "Alpha", "event": "x", "judge": "Ben", "desc": "door", "number": 1, "entry": 1, "id": "x"}
    fields = {field.name for field in EVERY[name].fields}
    reasons = refusal(BoxDriver(), Target("tmb"), name, {key: value for key, value in given.items() if key in fields})
    assert "no zone 'tmb': did you mean 'tbm'?" in reasons or "name the run" in reasons[0]


@pytest.mark.parametrize("name, more", [
    *((name, more) for name in ("mark", "settle") for more in ({}, {"text": ""}, {"text": "", "not_attempted": False})),
    ("judge_mark", {}),
])
def test_an_item_gets_no_value_that_nobody_gave(name, more):
    driver = BoxDriver()
    driver.executing()
    given = {"group": "Penalized", "desc": "bumps", **({"judge": "Ben"} if name == "judge_mark" else {}), **more}
    reasons = refusal(driver, Target("tbm", driver.run_in().identity), name, given)
    assert reasons == ["The item gets no value: give its value, or say that it was not attempted"]


def test_a_mark_of_an_older_page_that_is_sent_again_is_no_error():
    """It said no value where it meant 0."""
    driver = BoxDriver()
    driver.executing()
    run, mark = RunName("tbm", driver.run_in().identity), {"group": "Penalized", "desc": "bumps", "id": "one"}
    driver.enter("mark", run, value=2, **mark)
    driver.enter("mark", run, **mark)
    other = {**mark, "group": "Achievements", "desc": "detects the door"}
    assert refusal(driver, Target(*run), "mark", {**other, "value": 1}) == [
        "the id 'one' was used for 'bumps': give each mark a new UUID"]
    assert [item.value for item in driver.run_in().sheet.items()][-1] == 2


@pytest.mark.parametrize("given", [{"reason": 5}, {"reason": None}, {"reason": "\ud800"}, {"foo": 1}])
def test_nothing_that_is_given_with_stop_prevents_it(given):
    driver = BoxDriver()
    driver.executing()
    driver.event(driver.box.act, Target("tbm"), "stop", "Anna", given)
    assert driver.run_in().phase is Phase.ENDED


def test_an_unknown_zone_is_the_reason_also_where_a_run_is_named():
    assert refusal(BoxDriver(), Target("tmb", "HGTKMH-1-2.000"), "sign_off") == [
        "no zone 'tmb': did you mean 'tbm'?"]


def test_a_call_that_means_another_run_or_event_changes_nothing():
    driver = BoxDriver(competition(tbm=["HGTKMH", "HWV"]))
    driver.connected()
    assert refusal(driver, Target("tbm", "HGTKMH-1-2.000"), "start") == [
        "run HGTKMH-1-2.000 is not connected in zone 'tbm'"]
    assert refusal(driver, Target("tbm", event="other"), "next") == [
        "Zone 'tbm' is at another event of team Alpha now: choose the event first"]
    driver.event(driver.box.act, Target("tbm", driver.run_in().identity), "start")


@pytest.mark.parametrize("code", ["HGTKMH", "HOMF", "HSUF"])
def test_what_is_kept_of_zones_without_a_run_is_as_it_would_be_made(code):
    driver = BoxDriver(competition(tbm=[code]))
    zone, actions = driver.box.zones["tbm"], driver.box.actions
    kept = [name for name in ACTIONS if actions[name].off_without_run is not None]
    assert len(kept) == 9
    shown = actions.shown(driver.now, zone)
    assert list(shown) == list(ACTIONS)
    for name, found in shown.items():
        action, form = actions[name], actions[name].form(driver.now, zone)
        nothing = {field.name: field.nothing for field in action.action.fields}
        assert found == (
            tuple(action.off(driver.now, zone, nothing)), action.shown(zone),
            None if form is action.action.fields else form, action.text(zone), action.question(driver.now, zone)), name


@pytest.mark.parametrize("name", ["connect", "open_sheet", "no_show", "withdrawn"])
def test_a_result_that_is_signed_off_is_replaced_only_by_who_says_so(name):
    driver = BoxDriver(competition(tbm=["HGTKMH", "HWV"]))
    driver.executing()
    driver.command("stop")
    driver.command("disconnect")
    assert driver.view().action(name).question == ""
    record = driver.box.finished.records()[0]
    driver.event(driver.box.scores.sign_off, RunName("tbm", record.identity), "Anna")
    shown = driver.view()
    assert shown.action(name).question == SIGNED_OFF in shown.state
    with pytest.raises(Refused, match=f"^{SIGNED_OFF}. For another attempt, press the button again and confirm$") as e:
        driver.command(name)
    assert confirmed_by(decoded(encoded(e.value.reasons)), "Give it") == [f"{SIGNED_OFF}. Give it"]
    assert confirmed_by([SIGNED_OFF], "Give it") == [SIGNED_OFF]
    assert driver.run_in() is None and len(driver.box.finished.records()) == 1
    driver.command("next")
    assert driver.view().action(name).question == ""
    driver.command("previous")
    driver.robot().beacon()
    driver.command(name, again=True)
    assert driver.view().action(name).question == "", "the run that there is now is asked for"
    assert len(driver.box.finished.records()) + (driver.run_in() is not None) == 2


def test_a_run_in_progress_is_left_only_by_who_knows_it():
    driver = BoxDriver()
    driver.executing()
    shown = Target("tbm", driver.run_in().identity)
    assert "is running: stop it first" in refusal(driver, shown, "disconnect")[0]
    driver.event(driver.box.act, shown, "disconnect", "Anna", {"running": True})
    assert driver.run_in() is None


def test_a_refusal_has_every_reason():
    refused = Refused(["no robot", "no port"])
    assert refused.reasons == ["no robot", "no port"]
    assert str(refused) == "no robot; no port"


def test_the_nearest_choice_or_else_all():
    assert did_you_mean("tmb", ["tbm", "fbm"]) == ": did you mean 'tbm'?"
    assert did_you_mean("xyz", ["tbm", "fbm"]) == ": there is 'tbm', 'fbm'"
    assert did_you_mean("", iter(["tbm"])) == ": there is 'tbm'"
