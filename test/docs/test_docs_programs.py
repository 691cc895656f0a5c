"""Programs and launch files explain themselves."""

import re

import programs
import pytest
from pages import ROOT


@pytest.mark.parametrize("script", programs.SCRIPTS)
def test_every_script_has_help(script):
    status, text = programs.helps()[script]
    assert status == 0, text
    assert text.startswith("usage: " + script), text
    assert len(text.splitlines()) > 4, text
    assert "Traceback" not in text
    assert "register with master" not in text


def node_of(script):
    """The module of a script's node, or None if it is none."""
    found = re.search(r"^from roah_rsbb\.ros\.(\w+) import main", (ROOT / "scripts" / script).read_text("utf-8"),
                      re.MULTILINE)
    return found and ROOT / "src" / "roah_rsbb" / "ros" / f"{found.group(1)}.py"


@pytest.mark.parametrize("script", [script for script in programs.SCRIPTS if node_of(script)])
def test_help_names_every_parameter(script):
    source = node_of(script).read_text("utf-8")
    read = set(re.findall(r"""params\.(?:text|number|whole|flag|choice|path)\(\s*"(\w+)\"""", source))
    text = programs.helps()[script].text
    missing = {name for name in read if not re.search(rf"\b{name}\b", text)}
    assert missing == set(), text


@pytest.mark.parametrize("name", programs.LAUNCH_FILES)
def test_every_launch_file_begins_with_what_it_starts(name):
    text = (ROOT / "launch" / name).read_text("utf-8")
    assert re.match(r"<launch>\s*<!-- \S", text)


@pytest.mark.parametrize("name", programs.LAUNCH_FILES)
def test_every_argument_is_explained(name):
    said = programs.ros_args(name)
    assert set(said) == programs.arguments(name)
    assert [argument for argument, doc in said.items() if not doc or doc == "undocumented"] == []
