"""docs/ros_interface.md names every type, topic, service and parameter of the package, with the right type."""

import ast
import functools
import re

import pages
import pytest
from pages import ROOT

PAGE = "docs/ros_interface.md"
TYPES = sorted(path.name for folder in ("msg", "srv") for path in (ROOT / folder).iterdir())
SOURCES = sorted((ROOT / "src" / "roah_rsbb").rglob("*.py"))
MAKERS = {"Publisher", "Subscriber", "Service"}
READERS = {"text", "number", "whole", "flag", "choice", "path"}


@functools.lru_cache(maxsize=None)
def said():
    return pages.prose(PAGE)


def calls():
    """Each call in the sources whose first argument is a text that is written there: function, text, where."""
    for path in SOURCES:
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if (isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.args
                    and isinstance(node.args[0], ast.Constant) and isinstance(node.args[0].value, str)):
                owner = node.func.value.id if isinstance(node.func.value, ast.Name) else ""
                yield owner, node.func.attr, node.args[0].value, f"{path.relative_to(ROOT)}:{node.lineno}"


NAMES = sorted({(name, where) for owner, call, name, where in calls() if owner == "rospy" and call in MAKERS})
PARAMETERS = sorted({(name, where) for owner, call, name, where in calls() if owner == "params" and call in READERS})


@pytest.mark.parametrize("name", TYPES)
def test_every_type_is_linked(name):
    folder = name.rpartition(".")[2]
    assert f"[{name.rpartition('.')[0]}](../{folder}/{name})" in said()


@pytest.mark.parametrize("name, where", NAMES)
def test_every_topic_and_service_is_named(name, where):
    short = name[len("/roah_rsbb/"):] if name.startswith("/roah_rsbb/") else name
    assert f"`{short}`" in said(), where


@pytest.mark.parametrize("name, where", PARAMETERS)
def test_every_parameter_is_named(name, where):
    assert f"`{name}`" in said(), where


@pytest.mark.parametrize("command", ["connect", "stop_run", "score/withdraw", "omf_switches/button"])
def test_services_of_the_core_are_named(command):
    assert f"`/core/{command}`" in said()


def test_every_topic_of_the_run_log_is_named():
    from roah_rsbb.core import run_log

    part = said()[said().index("\n## Run log"):said().index("\n## Parameters")]
    named = re.findall(r"`(/?[\w/]+)`", part)
    devices = {f"/rsbb_log/devices/{name}" for name in named if "/" not in name}
    assert set(run_log.KINDS) <= set(named) | devices


def test_there_is_something_to_look_at():
    assert len(TYPES) > 40 and len(NAMES) > 20 and len(PARAMETERS) > 30
