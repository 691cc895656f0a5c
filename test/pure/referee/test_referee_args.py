"""The command line."""

import argparse

import pytest

from roah_rsbb.model.actions import Action
from roah_rsbb.model.fields import Choice
from roah_rsbb.model.reason import say
from roah_rsbb.referee import terminal
from roah_rsbb.referee.commands import parser

COMMANDS = ("status", "watch", "connect", "start", "stop", "disconnect", "previous", "next", "pause", "resume",
            "next-phase", "previous-phase", "open-sheet", "no-show", "withdrawn", "score", "runs",
            "sheet", "schedule", "choose", "withdraw", "reason", "sign-off", "done", "switch", "damaged",
            "confirm-switches", "run", "reload")


def _parse(line):
    return parser().parse_args(line)


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_has_help_with_examples_and_exit_statuses(command, capsys):
    with pytest.raises(SystemExit) as end:
        _parse([command, "--help"])
    text = capsys.readouterr().out
    assert end.value.code == 0
    assert f"examples:\n  referee {command}" in text
    assert "exit status:" in text
    assert "--json" in text


@pytest.mark.parametrize("line", [
    ["--json", "status"], ["status", "--json"], ["--json", "score", "A", "1", "-1"], ["watch", "--json", "--zone", "A"],
])
def test_json_may_come_before_or_after_the_command(line):
    assert _parse(line).json is True


def test_a_choice_that_may_be_left_out_is_left_out():
    kind = Choice("kind", say("Kind"), required=False, choices=("late", "rude"))
    action = Action("yellow_card", say("Yellow card"), say("Warn the team"), (kind,))
    commands = argparse.ArgumentParser().add_subparsers(dest="command")
    terminal.add_to(commands, {"": terminal.of_action(action, lambda call: None)}, "referee")
    command = commands.choices["yellow-card"]
    assert terminal.given_in(command.parse_args(["Hall"]), action) == {}
    assert terminal.given_in(command.parse_args(["Hall", "--kind", "late"]), action) == {"kind": "late"}
    assert "Kind: late / rude" in command.format_help()


@pytest.mark.parametrize("value", ["+1", "-1", "-1,5", "-.5", "=-17", "3", "yes"])
def test_values_with_a_sign_are_values(value):
    options = _parse(["score", "Home A", "2", value])
    assert (options.zone, options.item, options.value) == ("Home A", "2", value)


def test_minutes_with_a_decimal_comma():
    assert _parse(["judges", "publish", "Hall", "--minutes", "0,1"]).seconds == 6


@pytest.mark.parametrize("action", [
    "list", "settle", "hand-back", "withdraw", "end-waiting", "publish", "object", "answer"])
def test_each_action_of_judges_has_examples(action, capsys):
    with pytest.raises(SystemExit):
        _parse(["judges", action, "--help"])
    assert f"examples:\n  referee judges {action}" in capsys.readouterr().out


def test_a_run_takes_all_its_options():
    options = _parse(["run", "Home A", "--wait", "5", "--benchmark", "HWV/1/2", "--score", "door=1", "--score", "x=+2",
                      "--keep", "--team", "Beta", "--robot", "b2"])
    assert (options.team, options.robot) == ("Beta", "b2")
    assert (options.wait, options.event, options.keep) == (5.0, ("HWV", 1, 2, ""), True)
    assert options.score == [("door", "1"), ("x", "+2")]


@pytest.mark.parametrize("line, hint", [
    (["run", "A", "--score", "door"], "ITEM=VALUE"),
    (["run", "A", "--event", "HWV/x"], "CODE/ROUND"),
    (["run", "A", "--wait", "-1"], "is not a number from 0"),
    (["run", "A", "--wait", "nan"], "is not a number from 0"),
    (["run", "A", "--wait", "soon"], "soon"),
    (["run"], "ZONE"),
    (["schedule", "--show", "some"], "to-come"),
    (["choose", "A", "0"], "is not a number of 1 or more"),
    (["withdraw", "A", "0"], "is not a number of 1 or more"),
    (["withdraw", "A", "-1"], "1"),
    (["sign-off", "A"], "--by"),
    (["dance", "A"], "dance"),
    (["conect", "A"], "no 'conect': did you mean 'connect'?"), (["STATUS"], "no 'STATUS': did you mean 'status'?"),
    (["switch", "A", "0"], "a whole number from 1 to"),
    (["judges"], "ACTION"),
    (["judges", "settle", "A", "1", "3", "--by", "Hugo"], "--reason"),
    (["judges", "withdraw", "A", "Ben", "--reason", "ill"], "--by"),
    (["judges", "publish", "A", "--minutes", "1441"], "is not a number from 0 to 1440"),
    (["judges", "publish", "A", "--minutes", "1,000"], "is not a number from 0 to 1440"),
    (["judges", "answer", "A", "1", "maybe", "x"], "uphold"),
])
def test_wrong_usage_ends_with_2_and_says_what_was_expected(line, hint, capsys):
    with pytest.raises(SystemExit) as end:
        _parse(line)
    assert end.value.code == 2
    assert hint in capsys.readouterr().err
