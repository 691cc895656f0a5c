"""The order of records and messages, and the contents of run logs (docs/ros_interface.md, "Run log")."""

import pytest

from helpers.box_driver import BoxDriver, EffectRules
from helpers.competition import DOOR, competition, event
from roah_rsbb.core import effects
from roah_rsbb.core.effects import How
from roah_rsbb.model import run_log
from roah_rsbb.model.messages import BoxMessage
from roah_rsbb.model.run_log import KINDS, LogKind
from roah_rsbb.protocol import BoxState, RobotState


def _names(driver, *left_out):
    return [type(e).__name__ for e in driver.taken() if not isinstance(e, (effects.Notice, *left_out))]


STATE_SENT = ["RecordChanged", *["RunLogged"] * 5, "SendState"]


@pytest.mark.parametrize("command, before, expected", [
    ("connect", (), ["Recorded", "PortTaken", "OpenChannel", "RunOpened", *STATE_SENT, "SendBeacon"]),
    ("start", ("connected",), ["Recorded", *STATE_SENT]),
    ("stop", ("connected", "start"), ["Recorded", *STATE_SENT]),
    ("disconnect", ("connected",), [
        "Recorded", "RecordChanged", "RunLogged", "CloseChannel", "RunClosed", "SendBeacon"]),
])
def test_the_order_of_effects_of_a_command(command, before, expected):
    driver = BoxDriver()
    driver.robot().beacon()
    if "connected" in before:
        driver.connected()
    if "start" in before:
        driver.command("start")
    driver.taken()
    driver.command(command)
    assert _names(driver) == expected


def test_a_robots_first_message_aims_the_channel():
    driver = BoxDriver()
    robot = driver.connected()
    aims = driver.taken(effects.AimChannel)
    assert aims == [(robot.port, robot.host)]
    robot.says()
    assert driver.taken(effects.AimChannel) == []
    robot.host = "10.0.0.77"
    robot.says(after=3.0)
    assert driver.taken(effects.AimChannel) == [(robot.port, "10.0.0.77")]
    robot.host = "10.0.0.99"
    robot.send(robot.last)  # somebody else replays it
    assert driver.taken(effects.AimChannel) == []


def test_a_device_is_set_after_that_is_logged():
    driver = BoxDriver(competition(tbm=["HCFGAC"]))
    robot = driver.executing()
    driver.taken()
    robot.says(switch_1=True, display_map=True)
    order = [e for e in driver.taken() if not isinstance(e, effects.Notice)]
    device = order.index(effects.RunLogged(robot.port, run_log.device_topic("switch_1"), 1))
    assert order[device + 1] == effects.SetDevice("tbm", "switch_1", 1)
    display = order.index(effects.RunLogged(robot.port, run_log.DISPLAY_MAP, 1))
    assert order[display + 1] == effects.SendBeacon()


def test_a_timeout_rings_after_that_is_logged():
    driver = BoxDriver(competition(tbm=[event(timeout=10)]))
    driver.connected()
    driver.command("start")
    driver.taken()
    driver.run(10)
    names = _names(driver)
    assert names[-2:] == ["SendState", "TimeoutRung"]


def test_when_states_leave():
    """Changes are sent at once and in a burst, answers at once. Other messages wait for the next regular one."""
    driver = BoxDriver()
    robot = driver.connected()
    driver.command("start")
    driver.taken()

    def hows(**fields):
        robot.says(**fields)
        return [effect.how for effect in driver.taken(effects.SendState)]

    assert hows(state=RobotState.PREPARING) == [How.REPLY]
    assert hows() == [How.QUIET]
    assert hows(state=RobotState.WAITING_GOAL) == [How.CHANGE]
    for _ in range(4):  # it still waits for the acknowledgement
        assert hows(notifications=("a",)) == [How.REPLY]
    assert hows() == [How.QUIET]


OF_FUNCTIONALITY = {f"/rsbb_log/{t}" for t in (
    "bmbox/goal", "bmbox/score", "manual_operation", "opf_result", "result", "omf_switches",
    "omf_button", "omf_damaged", "omf_complete",
)}


def test_the_log_of_a_whole_run_has_every_topic_of_a_task_benchmark():
    driver = BoxDriver(competition(tbm=["HCFGAC"]))
    robot = driver.executing()
    robot.says(
        notifications=("n",), activation_event=("a",), visitor=("v",), final_command=("c",),
        switch_1=True, switch_2=False, switch_3=True, dimmer=100, blinds=0, display_map=True,
    )
    driver.score("Achievements", DOOR.desc, 1)
    robot.completes()
    driver.command("disconnect")
    bag = driver.bags[robot.port]
    assert {topic for topic, _ in bag} == set(KINDS) - OF_FUNCTIONALITY - {run_log.SCORE_TEXT}  # no such item
    assert driver.logged(robot.port, run_log.STATE) == [0, 1, 3, 0]
    assert driver.logged(robot.port, run_log.STATE_NAME) == ["STOP", "PREPARE", "WAITING_RESULT", "STOP"]
    assert driver.logged(robot.port, run_log.BOX_STATE) == [0, 1, 3, 0]
    assert driver.logged(robot.port, run_log.CLIENT_STATE) == [0, 1, 2, 3, 3, 4, 0]
    assert driver.logged(robot.port, run_log.SCORE) == [("Achievements", DOOR.desc, 1)]
    assert driver.logged(robot.port, run_log.DISPLAY_MAP) == [1]
    assert [driver.logged(robot.port, f"/rsbb_log/devices/{d}") for d in (
        "switch_1", "switch_2", "switch_3", "dimmer", "blinds"
    )] == [[1], [0], [1], [100], [0]]
    assert [driver.logged(robot.port, t) for t in ("/notification", "/activation_event", "/visitor", "/command")] == [
        ["n"], ["a"], ["v"], ["c"]
    ]
    assert bag[-1] == ("/rsbb_log/end", None)


def test_the_topics_are_those_of_the_interface():
    devices = {f"/rsbb_log/devices/{d}" for d in ("switch_1", "switch_2", "switch_3", "blinds", "dimmer")}
    uint8 = {f"/rsbb_log/{t}" for t in (
        "rsbb_state", "tablet/display_map", "client_state", "refbox_state", "omf_button", "omf_damaged"
    )} | devices
    texts = {f"/rsbb_log/{t}" for t in (
        "rsbb_state_str", "rsbb_state_desc", "score_text", "client_state_payload", "refbox_state_payload"
    )} | {"/notification", "/activation_event", "/visitor", "/command"} | OF_FUNCTIONALITY - uint8
    by_kind = {kind: {topic for topic, k in KINDS.items() if k is kind} for kind in LogKind}
    assert by_kind == {
        LogKind.UINT8: uint8, LogKind.STRING: texts, LogKind.SCORE: {"/rsbb_log/score"},
        LogKind.EMPTY: {"/rsbb_log/end"},
    }


@pytest.mark.parametrize("bad", [
    [effects.OpenChannel(1, "t", None)],
    [effects.PortTaken(1), effects.PortTaken(1)],
    [effects.PortTaken(1), effects.RunLogged(1, run_log.END, None)],
    [effects.PortTaken(1), effects.RunOpened(1, "t", 1, 1), effects.RunLogged(1, "/unknown", 1)],
    [effects.PortTaken(1), effects.RunOpened(1, "t", 1, 1), effects.RunLogged(1, run_log.STATE, True)],
    [effects.PortTaken(1), effects.SendState(1, BoxMessage("X", BoxState.STOP), How.CHANGE)],
    [effects.TimeoutRung("tbm")],
])
def test_the_rules_of_these_tests_find_what_breaks_them(bad):
    rules = EffectRules()
    with pytest.raises(AssertionError):
        for effect in bad:
            rules.see(effect)
