"""Launch and plugin files contain what the panels rely on."""

import ast
import json
import os
import pathlib
import struct
from xml.etree import ElementTree

import pytest

from roah_rsbb.rqt.panels import PANELS, plugin_name

ROOT = pathlib.Path(__file__).resolve().parents[3]
LAUNCH_FILES = sorted((ROOT / "launch").glob("*.launch"))
PLUGINS = ElementTree.parse(ROOT / "plugin.xml").getroot()


def includes(path):
    """File name to the arguments passed, for all that `path` includes."""
    return {
        include.get("file").rpartition("/")[2]: {a.get("name"): a.get("value") for a in include.iter("arg")}
        for include in ElementTree.parse(path).getroot().iter("include")
    }


@pytest.mark.parametrize("path", LAUNCH_FILES, ids=lambda path: path.name)
def test_a_launch_of_the_box_says_so_to_its_client(path):
    included = includes(path)
    if "core.launch.xml" in included and "roah_rsbb_client.launch" in included:
        # Else the exit button would ask whether to end this client, and end the whole box.
        assert included["roah_rsbb_client.launch"].get("exit_ends_rsbb") == "true"


@pytest.mark.parametrize("path", LAUNCH_FILES, ids=lambda path: path.name)
def test_arguments_are_explained(path):
    undocumented = [a.get("name") for a in ElementTree.parse(path).getroot().findall("arg") if not a.get("doc")]
    assert undocumented == []


def test_each_panel_of_the_list_is_a_plugin():
    named = {element.get("name"): element.get("type") for element in PLUGINS.iter("class")}
    listed = list(map(plugin_name, PANELS))
    assert named == {f"rqt_roah_rsbb/{name}": f"roah_rsbb.rqt.plugins.{name}" for name in listed}
    for said in ("description", "qtgui/statustip"):
        assert {e.get("name").partition("/")[2]: e.findtext(said) for e in PLUGINS.iter("class")} == \
            dict(zip(listed, (panel.what for panel in PANELS.values())))


def test_each_panel_is_in_the_list():
    files = (ROOT / "src" / "roah_rsbb" / "rqt" / "panels").glob("*.py")
    classes = [(file.stem, node) for file in files for node in ast.parse(file.read_text(encoding="utf-8")).body
               if isinstance(node, ast.ClassDef)]
    titled = {(file, node.name) for file, node in classes for line in node.body
              if isinstance(line, ast.Assign) and line.targets[0].id == "TITLE" and isinstance(line.value, ast.Call)}
    assert titled == {(panel.file, f"{plugin_name(name)}Panel") for name, panel in PANELS.items()}


def test_all_plugins_are_in_one_group_of_the_menu():
    assert {e.findtext("qtgui/group/label") for e in PLUGINS.iter("class")} == {"RoAH RSBB"}
    assert {e.get("base_class_type") for e in PLUGINS.iter("class")} == {"rqt_gui_py::Plugin"}
    export = ElementTree.parse(ROOT / "package.xml").getroot().find("export/rqt_gui")
    assert export.get("plugin") == "${prefix}/plugin.xml"


def test_the_layout_for_rqt_opens_every_plugin_once():
    layout = json.loads((ROOT / "resource" / "roah_rsbb.perspective").read_text(encoding="utf-8"))
    running = ast.literal_eval(layout["groups"]["pluginmanager"]["keys"]["running-plugins"]["repr"])
    assert running == {f"roah_rsbb/{element.get('name')}": [1] for element in PLUGINS.iter("class")}


def test_the_layout_for_rqt_fills_whatever_screen():
    """Qt forgets a window's geometry where the screen's width is not about the one that is saved with it (0: any)."""
    layout = json.loads((ROOT / "resource" / "roah_rsbb.perspective").read_text(encoding="utf-8"))
    text = layout["groups"]["mainwindow"]["keys"]["geometry"]["repr(QByteArray.hex)"]
    saved = bytes.fromhex(text.split("'")[1])
    magic, is_maximized, screen_width = struct.unpack(">I40x?xI16x", saved)
    assert (magic, is_maximized, screen_width) == (0x1D9D0CB, True, 0)


@pytest.mark.parametrize("name", [
    "active_robots", "benchmark_control", "core_status", "log_display", "manual_operation", "omf_switches",
    "online_data", "scoring", "tablet_status",
])
def test_the_programs_of_the_original_open_their_panel(name):
    assert name in PANELS
    assert os.readlink(ROOT / "scripts" / f"roah_rsbb_{name}") == "panel"


@pytest.mark.parametrize("name", ["roah_rsbb.launch", "roah_rsbb_dummy.launch"])
def test_the_public_sees_no_results_unless_the_organisers_say_so(name):
    path = ROOT / "launch" / name
    root = ElementTree.parse(path).getroot()
    defaults = {a.get("name"): a.get("default") for a in root.findall("arg")}
    assert defaults["public_results"] == "none"
    of_core, = (include for include in root.iter("include") if include.get("file").endswith("core.launch.xml"))
    assert of_core.get("pass_all_args") == "true" and "public_results" not in includes(path)["core.launch.xml"]
