"""docs/ros_interface.md names every type, topic, service and parameter of the package, with the right type."""

import ast
import pathlib
import re

import pytest

from roah_rsbb.core.settings import Settings
from roah_rsbb.model import run_log
from roah_rsbb.model.actions import ACTIONS, EDITS, ENTRIES
from roah_rsbb.model.fields import Number, OfSchedule

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs" / "ros_interface.md").read_text(encoding="utf-8")
TYPES = sorted(path.name for folder in ("msg", "srv") for path in (ROOT / folder).iterdir())
SOURCES = sorted((ROOT / "src" / "roah_rsbb").rglob("*.py"))
MAKERS = {"Publisher", "Subscriber", "Service"}
OWNERS = ("rospy", "params")
READERS = {"text", "number", "whole", "flag", "choice", "path"}


def calls():
    """Each call in the sources whose first argument is a text that is written there: function, text, where."""
    for path in SOURCES:
        source = path.read_text("utf-8")
        if not any(f"{owner}." in source for owner in OWNERS):
            continue  # to parse all files takes seconds
        for node in ast.walk(ast.parse(source)):
            if (isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.args
                    and isinstance(node.args[0], ast.Constant) and isinstance(node.args[0].value, str)):
                owner = node.func.value.id if isinstance(node.func.value, ast.Name) else ""
                yield owner, node.func.attr, node.args[0].value, f"{path.relative_to(ROOT)}:{node.lineno}"


CALLS = list(calls())
NAMES = sorted({(name, where) for owner, call, name, where in CALLS if owner == "rospy" and call in MAKERS})
PARAMETERS = sorted({(name, where) for owner, call, name, where in CALLS if owner == "params" and call in READERS})


@pytest.mark.parametrize("name", TYPES)
def test_every_type_is_linked(name):
    folder = name.rpartition(".")[2]
    assert f"[{name.rpartition('.')[0]}](../{folder}/{name})" in PAGE


@pytest.mark.parametrize("name, where", NAMES)
def test_every_topic_and_service_is_named(name, where):
    short = name[len("/roah_rsbb/"):] if name.startswith("/roah_rsbb/") else name
    assert f"`{short}`" in PAGE, where


@pytest.mark.parametrize("name, where", PARAMETERS)
def test_every_parameter_is_named(name, where):
    assert f"`{name}`" in PAGE, where


@pytest.mark.parametrize("command", ["connect", "stop", "set_score", "omf_switches/button"])
def test_services_of_the_core_are_named(command):
    assert f"`/core/{command}`" in PAGE


def test_every_topic_of_the_run_log_is_named():
    part = PAGE[PAGE.index("\n## Run log"):PAGE.index("\n## Parameters")]
    named = re.findall(r"`(/?[\w/]+)`", part)
    devices = {f"/rsbb_log/devices/{name}" for name in named if "/" not in name}
    assert set(run_log.KINDS) <= set(named) | devices


def test_files_to_check_are_found():
    assert len(TYPES) > 30 and len(NAMES) > 20 and len(PARAMETERS) > 30


@pytest.mark.parametrize("name", Settings._fields)
def test_the_default_of_a_setting_is_what_the_page_says(name):
    said = re.search(rf"^\| `{name}` \| (\S+)", PAGE, re.MULTILINE).group(1)
    default = getattr(Settings(), name)
    assert said == (str(default).lower() if isinstance(default, bool) else f"{default:g}")


# -- actions ------------------------------------------------------------------------------------------


def _row(action):
    """The line of an action in the table."""
    fields = ", ".join(
        f"`{field.name}` ({_kind(field)}{'' if field.required else '; optional'})" for field in action.fields)
    return f"| `{action.name}`{'*' if action.aims else ''} | {action.label} | {fields} | {action.explanation} |"


def _kind(field):
    if isinstance(field, Number):
        bounds = f"from {field.low}" if field.high >= 2**31 - 1 else f"{field.low} to {field.high}"
        return f"number {bounds if field.low > -2**31 else ''} {field.unit}".strip()
    if isinstance(field, OfSchedule):
        return field.of
    return {"choice": ", ".join(getattr(field, "choices", ())), "toggle": "true or false"}.get(field.kind, field.kind)


@pytest.mark.parametrize("number, actions", [(0, ACTIONS), (1, ENTRIES), (2, EDITS)])
def test_the_tables_of_actions_are_those_of_the_code(number, actions):
    """A failure? Copy the lines that it prints into the page."""
    rows = ["| action | label | fields | |", "|---|---|---|---|", *map(_row, actions.values())]
    section = re.search(r"^### Actions\n(.*?)^## ", PAGE, re.MULTILINE | re.DOTALL).group(1)
    tables = re.findall(r"(?:^\|.*\n)+", section, re.MULTILINE)
    assert tables[number].splitlines() == rows, "\n" + "\n".join(rows)
