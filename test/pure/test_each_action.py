"""Each action, each of its fields, each face: a value that fits arrives, and one that does not is refused alike."""

import pytest

from helpers.box_driver import BoxDriver
from roah_rsbb.core.actions.table import Target
from roah_rsbb.model import actions
from roah_rsbb.model.actions import ACTIONS, EVERY, STOP
from roah_rsbb.model.fields import Choice, Number, Team, Toggle, entered, read
from roah_rsbb.model.reason import Refused
from roah_rsbb.web.commands import BadCommand, call_of, command_of, may
from roah_rsbb.web.pairing import DeviceSession, Grant

DEVICE = DeviceSession("id", Grant("referee", ""), "Anna", "phone", 0.0)
# A form that changes has its own tests: test/pure/core/actions.
FIXED = [action for action in EVERY.values() if not action.is_open]
EACH = [pytest.param(action, field, id=f"{action.name}-{field.name}") for action in FIXED for field in action.fields]
OF_TABLE = [pytest.param(action, id=action.name) for action in ACTIONS.values() if not action.is_open]


def fitting(field):
    """A value that fits, and that no field has by itself."""
    if isinstance(field, Choice):
        return field.choices[-1]
    return True if isinstance(field, Toggle) else max(field.low, 1) if isinstance(field, Number) else "Alpha"


def refusal(action, given):
    """What the box answers."""
    driver = BoxDriver()
    with pytest.raises(Refused) as refused:
        driver.event(driver.box.act, Target("tbm"), action.name, "Anna", given)
    return str(refused.value)


@pytest.mark.parametrize("action, field", EACH)
def test_a_value_that_does_not_fit_is_refused_by_the_box_and_by_the_page(action, field):
    given = {**{other.name: fitting(other) for other in action.fields}, field.name: [1]}
    if action.name == STOP:  # nothing prevents it
        assert refusal(action, given) == "No run is connected, so there is nothing to stop"
        return
    assert f"{field.label}: " in refusal(action, given)
    try:
        sent = call_of(command_of(action.name, {"zone": "tbm", "given": given}, DEVICE))[1]["given"]
    except BadCommand as bad:
        assert f"{field.label}: " in str(bad)
    else:  # what the device says itself
        assert sent[field.name] in (DEVICE.device_id, "referee", "Anna", 0)


@pytest.mark.parametrize("action", [pytest.param(action, id=action.name) for action in FIXED if action.name != STOP])
def test_values_that_fit_come_from_the_page_to_the_box(action):
    given = {field.name: fitting(field) for field in action.fields}
    name, call = call_of(command_of(action.name, {"zone": "tbm", **given}, DEVICE))
    own = {"device": DEVICE.device_id, "role": "referee", "judge": "Anna" if action.roles == ("judge",) else "Alpha",
           "ago_ms": 0}
    expected = {name: own.get(name, value) for name, value in given.items()}
    assert (name, call["action"], call["given"]) == ("act", action.name, expected)
    assert read(action.fields, call["given"]) == expected


MARKING, KEEPING = {"mark", "take_back", "note"}, {"start", "pause", "resume", "next_phase", "previous_phase", "note"}
JUDGING = {"mark", "judge_mark", "submit"}
ROLES = {
    "referee": set(EVERY) - JUDGING | {"mark"}, "organiser": set(EVERY) - JUDGING | {"mark"}, "judge": JUDGING,
    "assistant": MARKING | {STOP}, "timekeeper": KEEPING | {STOP}, "observer": set(),
}


@pytest.mark.parametrize("role", actions.ROLES)
def test_a_role_may_do_what_its_name_says_in_its_zone(role):
    device = DEVICE._replace(grant=Grant(role, "tbm"))
    for zone, expected in (("tbm", ROLES[role]), ("other", set())):
        assert expected == {name for name, action in EVERY.items() if may(command_of(name, {"zone": zone, "given": {
            field.name: fitting(field) if field.name != "judge" else "Anna" for field in action.fields
            if field.required or field.name == "judge"}}, device))}
    assert set(actions.allowed(role)) == ROLES[role]


@pytest.mark.parametrize("action", OF_TABLE)
def test_the_terminal_takes_each_field(action):
    pytest.importorskip("rospy")
    from roah_rsbb.referee import commands, terminal
    from roah_rsbb.referee.words import PLACED

    if action.name in PLACED:
        assert PLACED[action.name] in commands.COMMANDS
        return
    words, expected = [], dict(terminal.ALWAYS.get(action.name, {}))
    for field in action.fields:
        if field.name in expected:
            continue
        value = expected[field.name] = fitting(field)
        option = f"--{field.name.replace('_', '-')}"
        is_word = field.required or isinstance(field, Team)
        words += [option] if value is True else [str(value)] if is_word else [option, str(value)]
    assert terminal.given_in(commands.parser().parse_args([action.words, "tbm", *words]), action) == expected


@pytest.mark.parametrize("action", [pytest.param(action, id=action.name) for action in FIXED])
def test_a_panel_has_an_editor_for_each_field_that_somebody_enters(action, monkeypatch):
    pytest.importorskip("PyQt5.QtWidgets")
    pytest.importorskip("rospy")
    monkeypatch.setenv("QT_QPA_PLATFORM", "offscreen")
    from roah_rsbb.rqt.panels.actions import FieldEditors
    from roah_rsbb.rqt.qt import QApplication

    app = QApplication.instance() or QApplication([])
    editors = FieldEditors(action.fields)
    assert list(editors.editors) == [field.name for field in entered(action.fields)]
    assert (editors.given() is None) == any(
        field.required and field.nothing == "" and not isinstance(field, Choice) for field in entered(action.fields))
    del app
