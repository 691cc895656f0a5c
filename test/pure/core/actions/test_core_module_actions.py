"""What a benchmarking module asks for: a form of any fields, which the core reads and faces show."""

import json
import math

import pytest

from helpers.forms import MEASURED, ODD, ODD_ASKED, ODD_VALUES, form
from helpers.module_player import started
from roah_rsbb.core import effects
from roah_rsbb.core.actions.table import Target
from roah_rsbb.model import run_log
from roah_rsbb.model.actions import ACTIONS, Row
from roah_rsbb.model.fields import entered, fixed, form_text
from roah_rsbb.model.modules import RequestKind
from roah_rsbb.model.reason import Refused
from roah_rsbb.protocol import RobotState

NAMES = [name for name, action in ACTIONS.items() if action.row is Row.MODULE]
SWITCHES = {"initial_state": (True, False, False), "switches": (2, 3)}


def asked(driver):
    """The actions of the module's row that faces show, as they arrive there."""
    view = driver.view()
    return {name: view.action(name)._replace(fields=view.fields(name)) for name in NAMES if view.action(name).shown}


def answer(driver, given, run=""):
    driver.event(driver.box.act, Target("tbm", run), "operation", "Anna", given)


def refusal(driver, given, run=""):
    with pytest.raises(Refused) as refused:
        answer(driver, given, run)
    assert driver.run_in().asked is not None
    return str(refused.value)


@pytest.fixture
def odd():
    driver, modules, _ = started()
    modules.asks(RequestKind.REFEREE, text=ODD_ASKED, form=form_text(ODD))
    return driver, modules


def test_nothing_is_shown_while_nothing_is_asked():
    driver, modules, _ = started()
    assert asked(driver) == {}
    modules.asks()
    assert asked(driver) == {}
    driver.command("stop")
    driver.command("disconnect")
    assert asked(driver) == {}


def test_a_face_is_given_the_form_and_what_to_do(odd):
    driver, _ = odd
    (name, action), = asked(driver).items()
    assert (name, action.text, action.off) == ("operation", ODD_ASKED, ())
    assert (entered(action.fields), fixed(action.fields)) == (ODD, {"operation": 1})


def test_the_values_of_a_form_come_to_the_module(odd):
    driver, modules = odd
    driver.taken()
    answer(driver, {"operation": 1, **ODD_VALUES}, driver.run_in().identity)
    pose = [1.25, 0.4, math.pi / 2]
    values = {"held": True, "drops": 2, "place": "floor", "pose": pytest.approx(pose)}
    assert json.loads(modules.outcome().values) == values
    taken = driver.taken()
    recorded, = [effect for effect in taken if isinstance(effect, effects.Recorded) and effect.kind == "command"]
    assert recorded.value == {"command": "manual_operation", "operation": 1, **values}
    logged, = [effect.value for effect in taken
               if isinstance(effect, effects.RunLogged) and effect.topic == run_log.MANUAL_OPERATION]
    assert logged.startswith(f"{ODD_ASKED}: done Did the robot hold it?: true, How often did it fall?: 2, Where is ")
    assert asked(driver) == {}


@pytest.mark.parametrize("changed, reason", [
    ({"held": "perhaps"}, "Did the robot hold it?: true or false is expected"), ({"held": None}, "hold it?"),
    ({"drops": 10}, "a whole number from 0 to 9"), ({"place": "shelf"}, "choose one of table, floor"),
    ({"pose": "1 2"}, "x and y in metres"), ({"pose": [1, 2, math.inf]}, "[x, y, theta] is expected"),
    ({"more": 1}, "no field 'more'"), ({"operation": "1"}, "Number: a whole number"),
    ({"operation": 2}, f"that manual operation is over; the current one is: {ODD_ASKED}"),
])
def test_a_value_that_does_not_fit_is_refused_and_the_module_waits(odd, changed, reason):
    driver, modules = odd
    assert reason in refusal(driver, {"operation": 1, **ODD_VALUES, **changed})
    assert modules.outcome() is None


def test_only_a_choice_has_a_usual_value(odd):
    driver, modules = odd
    assert refusal(driver, {}) == "Did the robot hold it? is missing"
    answer(driver, {name: value for name, value in ODD_VALUES.items() if name != "place"})
    assert json.loads(modules.outcome().values)["place"] == "table"


def test_a_late_answer_to_the_form_of_another_request_names_the_present_one(odd):
    driver, modules = odd
    answer(driver, {"operation": 1, **ODD_VALUES})
    modules.asks(RequestKind.REFEREE, text="How high?", form=form_text([MEASURED]))
    assert refusal(driver, {"operation": 1, **ODD_VALUES}) == (
        "that manual operation is over; the current one is: How high?")
    assert "another run is not connected" in refusal(driver, {"operation": 2, "width": 1}, "another run")
    answer(driver, {"operation": 2, "height": "1,25"})
    assert json.loads(modules.outcome().values) == {"height": 1.25}


def test_an_empty_text_is_no_answer():
    """Programs of earlier versions send it with each operation."""
    driver, modules, _ = started()
    for one in ("", form(asks_text=True), form("yes", "no")):
        modules.asks(RequestKind.REFEREE, text="Ready?", form=one)
        answer(driver, {"answer": ""})
    assert json.loads(modules.outcome().values) == {"answer": "yes"}


def test_switches_are_numbered_and_confirmed_when_the_module_asks():
    driver, modules, robot = started("HOMF")
    modules.asks(**SWITCHES)
    switch = asked(driver)["switch"].fields[0]
    assert (list(asked(driver)), switch.low, switch.high) == (["switch", "damaged"], 1, 3)
    for state in (RobotState.PREPARING, RobotState.WAITING_GOAL, RobotState.EXECUTING, RobotState.RESULT_TX):
        robot.says(state)
    modules.asks(RequestKind.SWITCHES, text="Enter the switches")
    assert asked(driver)["confirm_switches"].text == "Enter the switches"
    with pytest.raises(Refused, match="a whole number from 0 to 255"):
        driver.event(driver.box.act, Target("tbm"), "damaged", "", {"number": 256})
