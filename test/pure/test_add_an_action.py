"""The walk "Add an action" of docs/architecture.md, on a copy of the sources: a new action touches no face."""

import pytest

from helpers.walks import BUILT, ROOT, changed_copy, run, steps


@pytest.fixture(scope="module", name="tree")
def _tree(tmp_path_factory):
    """A copy of the sources with the new action."""
    return changed_copy(tmp_path_factory.mktemp("tree"), "Add an action")


needs_ros = pytest.mark.skipif(not (BUILT / "msg").exists(), reason="the package is not built")
pytestmark = pytest.mark.long


def test_the_walk_changes_no_face():
    files = {step.file for step in steps("Add an action")}
    assert {file.split("/")[0] for file in files} == {"model", "core"}
    assert len(files) <= 4


def test_the_core_does_it_records_it_and_keeps_it_over_a_restart(tree):
    found = run(tree, """
        from helpers.box_driver import BoxDriver
        from helpers.competition import competition
        from roah_rsbb.core import effects
        from roah_rsbb.core.actions.table import Target
        from roah_rsbb.model.reason import Refused
        from roah_rsbb.model.as_json import to_json, from_json
        from roah_rsbb.core.zones import ZoneState
        driver = BoxDriver(competition(tbm=["HGTKMH"]))
        found = {"idle": driver.off("extend")}
        driver.executing()
        driver.taken()
        driver.event(driver.box.act, Target("tbm"), "extend", "Anna", {"seconds": 60, "reason": "the door was stuck"})
        found["recorded"] = [e.value for e in driver.taken(effects.Recorded)]
        found["limit"] = driver.view().clock.limit
        for given in ({"seconds": 601, "reason": "x"}, {"seconds": 60}, {"seconds": True, "reason": "x"}):
            try:
                driver.event(driver.box.act, Target("tbm"), "extend", "Anna", given)
            except Refused as refused:
                found.setdefault("refused", []).append(refused.reasons)
        driver.run(630.0)
        found["after the old limit"] = driver.view().phase
        state = from_json(ZoneState, json.loads(json.dumps(to_json(driver.box.zones["tbm"].saved()))))
        found["kept"] = state.run.clock.extra
        driver.run(40.0)
        found["after the new one"] = driver.view().phase
        print(json.dumps(found))
    """)
    assert found == {
        "idle": ["No run is running"], "limit": 660.0, "kept": 60.0,
        "recorded": [{"command": "extend", "seconds": 60, "reason": "the door was stuck"}],
        "refused": [["How long: a whole number from 1 to 600 is expected"], ["Reason is missing"],
                    ["How long: a whole number from 1 to 600 is expected"]],
        "after the old limit": "running", "after the new one": "ended",
    }


@needs_ros
def test_the_terminal_has_it_with_its_arguments_and_help(tree):
    found = run(tree, """
        import contextlib, io
        from roah_rsbb.model.actions import ACTIONS
        from roah_rsbb.referee import commands, terminal
        typed = commands.parser().parse_args(["extend", "Home", "60", "the door was stuck"])
        said = io.StringIO()
        for words in (["extend", "--help"], ["extend", "Home", "601", "x"]):
            with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
                with contextlib.suppress(SystemExit):
                    commands.parser().parse_args(words)
        given = terminal.given_in(typed, ACTIONS["extend"])
        print(json.dumps([given, commands.COMMANDS["extend"].do.__name__, said.getvalue()]))
    """)
    assert found[:2] == [{"seconds": 60, "reason": "the door was stuck"}, "_act"]
    assert "Give the run more time." in found[2] and "How long: 1 to 600 s" in found[2]
    assert "How long: a whole number from 1 to 600 is expected" in found[2]


@needs_ros
def test_the_gateway_takes_it_and_gives_the_page_its_form(tree):
    found = run(tree, """
        from roah_rsbb.web.commands import call_of
        from roah_rsbb.web.commands import command_of, may
        from roah_rsbb.web.pairing import Grant, DeviceSession
        from roah_rsbb.wording.device import page_words
        body = {"zone": "Home", "identity": "run 1", "seconds": 60, "reason": "why"}
        answers = []
        for role in ("referee", "judge"):
            session = DeviceSession("id", Grant(role, ""), "Anna", "phone", 0.0)
            command = command_of("extend", body, session)
            answers.append(may(command))
        print(json.dumps([answers, call_of(command), page_words()["actions"]["extend"]]))
    """)
    answers, request, words = found
    assert answers == [True, False]
    assert request == ["act", {
        "zone": "Home", "run": "run 1", "by": "Anna, judge, phone id", "action": "extend", "event": "",
        "given": {"seconds": 60, "reason": "why"}}]
    assert (words["label"], words["row"]) == ("More time", "clock")
    assert [(field["kind"], field["label"]) for field in words["fields"]] == [
        ("number", "How long"), ("text", "Reason")]


@needs_ros
def test_the_panel_has_a_button_and_a_form(tree):
    found = run(tree, """
        from roah_rsbb.model.actions import ACTIONS, Action, Row
        from roah_rsbb.model.fields import Choice
        from roah_rsbb.model.reason import say
        from roah_rsbb.rqt.panels.actions import ActionForm, RuleButtons, entered, what_text
        from roah_rsbb.rqt.qt import QApplication
        app = QApplication([])
        ACTIONS["weigh"] = Action("weigh", say("Weigh it"), say("A module asks for it"), row=Row.MODULE)
        pressed, given = [], []
        row = RuleButtons(pressed.append)
        row.buttons["extend"].setEnabled(True)
        row.buttons["extend"].click()
        action = pressed[0]
        form = ActionForm(None, action, what_text(action, "Home"), entered(action.fields), given.append)
        form.inside.editors["seconds"].setValue(90)
        form.yes.click()
        problem = form.inside.problem.text()
        form.inside.editors["reason"].setText("the door")
        form.yes.click()
        who = Choice("who", say("Who"), required=False, choices=("team", "jury"))
        other = ActionForm(None, action, "Who", (who,), given.append)
        other.yes.click()
        print(json.dumps([action.name, form.windowTitle(), row.buttons["extend"].text(), problem, given,
                          sorted({"weigh", "operation", "switch"} & set(row.buttons))]))
    """)
    assert found == ["extend", "More time in Home", "More time …", "⚠ Reason is missing",
                     [{"seconds": 90, "reason": "the door"}, {"who": ""}], ["weigh"]]


def test_what_is_not_translated_and_not_in_the_documentation_is_missed(tree):
    """The tests of catalogues and pages compare with these."""
    found = run(tree, """
        from roah_rsbb.model.actions import ACTIONS
        print(json.dumps([str(ACTIONS["extend"].label), str(ACTIONS["extend"].explanation)]))
    """)
    catalogue = (ROOT / "resource" / "languages" / "de.ts").read_text("utf-8")
    assert not any(f"<source>{text}</source>" in catalogue for text in found)
