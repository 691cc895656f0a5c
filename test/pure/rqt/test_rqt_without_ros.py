"""The referee's window without ROS: its start, and what its host keeps and asks of the box."""

import os
import subprocess
import sys

import pytest

START = "from roah_rsbb.tools.team import main; main(['window'])"
NO_QT = "import importlib.util; importlib.util.find_spec = lambda name, *_: None\n"


def started(program, **environment):
    done = subprocess.run(
        [sys.executable, "-c", program], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False,
        env={"PATH": os.environ["PATH"], "PYTHONPATH": os.environ["PYTHONPATH"], **environment}, timeout=300)
    return done.returncode, done.stdout


@pytest.mark.parametrize("program, environment, remedy", [
    (START, {}, "Use 'roah-rsbb referee'"),
    (NO_QT + START, {"DISPLAY": ":1"}, "pip install 'roah-rsbb[window]'"),
])
def test_what_is_missing_is_named_with_its_remedy(program, environment, remedy):
    status, text = started(program, **environment)
    assert status == 1 and remedy in text and len(text.splitlines()) == 1, text


# Everything of the panels, in a process that has no ROS, and then what the host does with a box that this answers.
HOST = """
import sys, types
for name in ("rospy", "rosgraph", "rospkg", "genpy", "std_srvs"):
    sys.modules[name] = None
from roah_rsbb.rqt.app import window, standalone
from roah_rsbb.rqt.app.without_ros import HostWithoutRos
from roah_rsbb.client.client import UNANSWERED, Answer

host = HostWithoutRos("window")
print(repr(host.zone.value))
host.zone.choose("Home B")
print(HostWithoutRos("window").zone.value, host.node, host.ends_box())

asked = []
devices = host.devices
devices.start(types.SimpleNamespace(call=lambda name, done: asked.append((name, done))))
values = dict(bell=[7, 500000000], switch_1=True, switch_2=False, switch_3=False, dimmer=40, blinds=0,
              door_win_detect=False)

def answered(answer):
    devices._due_mono = 0.0
    devices.look()
    asked.pop()[1](answer)
    devices.look()
    print(devices.state and devices.state.dimmer, devices.status and devices.status.text, devices.why_missing)

answered(UNANSWERED)
answered(Answer(1, {"devices": values, "connected": True, "text": "connected"}))
before = devices.state, devices.status
answered(Answer(1, {"devices": values, "connected": True, "text": "connected"}))
print(before[0] is devices.state, before[1] is devices.status)
answered(Answer(1, None, ("none here",)))
devices.set(types.SimpleNamespace(call=lambda owner, name, done, **given: print(name, given)), None, "dimmer", 3, print)
host.exit(types.SimpleNamespace(call=lambda owner, name, done, **given: print(name, given)), None, True, print)
host.end()
print(host.has_ended)
"""


def test_a_window_keeps_its_zone_and_asks_the_box_for_all_else(tmp_path):
    pytest.importorskip("PyQt5.QtWidgets")
    status, text = started(HOST, QT_QPA_PLATFORM="offscreen", XDG_CONFIG_HOME=str(tmp_path), HOME=str(tmp_path))
    assert status == 0, text
    missing = "is the core running? Check the state when it is back."
    assert text.splitlines() == [
        "''", "Home B window True", f"None None {missing}", "40 connected ", "40 connected ", "True True",
        "40 connected none here", "set_device {'device': 'dimmer', 'value': 3}", "exit {'anyway': True}", "True"]
