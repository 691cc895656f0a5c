"""Programs and launch files that open windows, with a core in another process that is killed, too."""

import os
import pathlib
import signal
import sys
import tempfile
import unittest
import xmlrpc.client
from typing import List, Tuple

import rosgraph
import rosnode
import rospy
from std_srvs.srv import Empty
from support.fakes.core import FakeCore
from support.gui_testing import wait_until
from support.programs import Program, own
from support.real_input import close_all_windows
from support.robots import RSBB_PORT
from support.waiting import LIMIT_S

from roah_rsbb.rqt.client import RefereeClient
from roah_rsbb.rqt.node import WindowNode
from roah_rsbb.rqt.panels import PANELS

ROS_TESTS = pathlib.Path(__file__).resolve().parents[1]
PURE_TESTS = ROS_TESTS.parent / "pure"
LAUNCH = ROS_TESTS.parents[1] / "launch"
PYTHONPATH = os.environ["PYTHONPATH"]
# The other cases in this folder open each panel but this one without a window around it, and
# test_rqt_launch_files.py compares the programs with the list.
ALONE = PANELS if os.environ.get("ROAH_TEST_ALL") == "yes" else ("core_status",)
AT_A_TIME = 3  # panels


def _names(end: str) -> list:
    return [name for name in rosnode.get_node_names() if name.endswith(end)]


def _listeners() -> set:
    """The nodes that listen to the devices, as all clients do, without the unique part of anonymous names."""
    listening = dict(rosgraph.Master("/t").getSystemState()[1])
    return {name.rsplit("_", 2)[0] for name in listening.get("/devices/state", ())}


class TestPrograms(unittest.TestCase):
    """Programs and launch files. The core is in this process, or in one of its own that is killed."""

    def start(self, *command: str, **environment: str) -> Program:
        program = Program(*command, **environment)
        self.addCleanup(program.close)
        return program

    def start_core(self) -> Program:
        paths = f"{ROS_TESTS}:{PURE_TESTS}:{PYTHONPATH}"
        return self.start(sys.executable, "-m", "support.fakes.core", PYTHONPATH=paths)

    def pid_of(self, node: str) -> int:
        return xmlrpc.client.ServerProxy(rosgraph.Master("/t").lookupNode(node)).getPid("/t")[2]

    def test_a_core_that_was_killed_is_found_again(self) -> None:
        core = self.start_core()
        client = RefereeClient.acquire(WindowNode)
        self.addCleanup(RefereeClient.release)
        wait_until(lambda: not client.model.is_old, "the core is heard")
        core.kill()
        wait_until(lambda: client.model.is_old, "it is gone")
        self.start_core()
        wait_until(lambda: not client.model.is_old, "the new one is heard")

    def test_a_client_opens_comes_back_after_a_crash_and_ends_by_its_exit(self) -> None:
        launch = self.start("roslaunch", str(LAUNCH / "roah_rsbb_client.launch"), "gui:=window", "zone:=Home B")
        wait_until(lambda: _names("/roah_rsbb_gui"), "the window is a node")
        node = _names("/roah_rsbb_gui")[0]
        namespace = node.rpartition("/")[0]
        self.assertTrue(namespace.startswith("/roah_rsbb_client"), node)
        self.assertEqual(rospy.get_param(f"{namespace}/current_zone"), "Home B")
        first = self.pid_of(node)
        os.kill(first, signal.SIGKILL)

        def is_back() -> bool:
            try:
                return self.pid_of(node) != first
            except (OSError, rosgraph.MasterException):
                return False

        wait_until(is_back, "the window is opened again")
        rospy.wait_for_service(f"{namespace}/roah_rsbb_shutdown", LIMIT_S)
        rospy.ServiceProxy(f"{namespace}/roah_rsbb_shutdown", Empty)()
        launch.wait_ended()
        self.assertEqual(_names("/roah_rsbb_gui"), [])  # it took its leave of the master

    def test_a_panel_opens_alone_and_ends(self) -> None:
        core = FakeCore()
        self.addCleanup(core.leave)
        names = tuple(ALONE)
        # A few at a time: all of them at once would only wait for one another.
        for first in range(0, len(names), AT_A_TIME):
            self.open_and_end(names[first:first + AT_A_TIME])

    def open_and_end(self, names: Tuple[str, ...]) -> None:
        programs = [self.start(own("panel"), name) for name in names]
        wait_until(lambda: _listeners() >= {f"/roah_rsbb_{name}" for name in names}, f"{names} have a client")
        for program in programs:
            program.signal(signal.SIGINT)
        for name, program in zip(names, programs):
            self.assertEqual(program.wait_ended(), 0, f"{name}: {program.text}")
            self.assertNotIn("Traceback", program.text)

    def test_a_panel_alone_keeps_its_settings(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            kept = pathlib.Path(folder) / "roah_rsbb" / "roah_rsbb_log_display.conf"
            kept.parent.mkdir()
            kept.write_text("[LogDisplayPanel]\nfollow=false\n", encoding="utf-8")
            program = self.start(own("roah_rsbb_log_display"), XDG_CONFIG_HOME=folder)
            wait_until(lambda: "/roah_rsbb_log_display" in _listeners(), "it has a client")
            program.signal(signal.SIGINT)
            self.assertEqual(program.wait_ended(), 0)
            self.assertIn("follow=false", kept.read_text(encoding="utf-8"))
            self.assertIn("geometry=", kept.read_text(encoding="utf-8"))

    def test_without_a_display_one_line_and_no_error(self) -> None:
        gui = self.start(own("roah_rsbb_gui"), "--gui", "auto", DISPLAY="", WAYLAND_DISPLAY="")
        self.assertEqual(gui.wait_ended(), 0)
        self.assertEqual(len(gui.lines), 1, gui.text)
        self.assertIn("No display", gui.text)


class TestEnds(unittest.TestCase):
    """Our window, alone and as a launch file starts it, ends whatever its master does."""

    WINDOW, CLIENT = ("panel", "window"), ("roah_rsbb_gui", "--gui", "window")

    def setUp(self) -> None:
        port = str(RSBB_PORT + 50)
        self.uri = f"http://{os.environ.get('ROS_IP', '127.0.0.1')}:{port}"
        self.master = Program("rosmaster", "--core", "-p", port, ROS_MASTER_URI=self.uri)
        self.addCleanup(self.master.close)
        self.addCleanup(self.master.kill)  # it may be stopped
        wait_until(lambda: rosgraph.is_master_online(self.uri), "the master answers")

    def listeners(self) -> List[str]:
        """The nodes at that master that listen to the devices, as all clients do."""
        return dict(rosgraph.Master("/t", self.uri).getSystemState()[1]).get("/devices/state", [])

    def open(self, *programs: Tuple[str, ...]) -> List[Program]:
        opened = []
        for program, *arguments in programs:
            opened.append(Program(own(program), *arguments, ROS_MASTER_URI=self.uri))
            self.addCleanup(opened[-1].close)
        wait_until(lambda: len(self.listeners()) == len(opened), lambda: f"{programs} have a client")
        return opened

    def assert_ends(self, program: Program) -> None:
        self.assertEqual(program.wait_ended(), 0, program.text)
        self.assertNotIn("Traceback", program.text)

    def assert_all_end(self, terminated: Program, interrupted: Program, closed: Program) -> None:
        terminated.signal(signal.SIGTERM)
        interrupted.signal(signal.SIGINT)
        self.assert_ends(terminated)
        self.assert_ends(interrupted)
        # Now it is the only one that has a window.
        wait_until(lambda: close_all_windows() or closed.ended_mono, lambda: f"it is closed: {closed.text}")
        self.assert_ends(closed)

    def test_it_leaves_a_master_that_answers(self) -> None:
        self.assert_all_end(*self.open(self.WINDOW, self.CLIENT, self.WINDOW))
        self.assertEqual(self.listeners(), [])

    def test_it_does_not_wait_for_a_master_that_hangs(self) -> None:
        programs = self.open(self.CLIENT, self.WINDOW, self.WINDOW)
        starting = Program(own("panel"), "window", "__name:=starting", ROS_MASTER_URI=self.uri)
        self.addCleanup(starting.close)
        self.master.signal(signal.SIGSTOP)
        self.assert_all_end(*programs)
        starting.signal(signal.SIGTERM)
        starting.wait_ended()

    def test_it_does_not_wait_for_a_master_that_is_gone(self) -> None:
        programs = self.open(self.CLIENT, self.WINDOW, self.WINDOW)
        self.master.kill()
        self.assert_all_end(*programs)
