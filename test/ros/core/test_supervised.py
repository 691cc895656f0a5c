"""The core's program and the node in it: whichever is killed, the node is as it was."""

import contextlib
import os
import pathlib
import shutil
import signal
import tempfile
from typing import List

import rosgraph
import rospy
import rosservice
from support.box_case import NetworkCase
from support.connections import process_of
from support.door_client import PASSING, DoorClient, Refusal
from support.own_core import OTHER_CORE, PARAMS, OwnCoreCase
from support.programs import Program, own
from support.robots import CONFIG, RSBB_PORT
from support.waiting import wait_until

from roah_rsbb.client.places import read_place
from roah_rsbb.journal.log_dir import holder_of
from roah_rsbb.ros.core.node import NO_MASTER
from roah_rsbb.standby.program.copying import LOCK

NODE = "/field/other_core"


def commands_with(text: str) -> List[str]:
    """The command lines of programs with this text."""
    found = []
    for path in pathlib.Path("/proc").glob("[0-9]*/cmdline"):
        with contextlib.suppress(OSError):  # processes end meanwhile
            found.append(path.read_text(errors="replace").replace("\0", " "))
    return [line for line in found if text in line]


class TestSupervisedCore(OwnCoreCase):
    def test_the_node_is_started_again_with_all_that_it_was_given(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        log_dir, stick = (pathlib.Path(folder.name, name) for name in ("log", "stick"))
        stick.mkdir()
        program = self._leaving(Program(own("roah_rsbb_core"), *OTHER_CORE, *(
            f"_{name}:={value}" for name, value in {**PARAMS, "log_dir": log_dir, "backup_dir": stick}.items()),
            ROS_NAMESPACE="/field"))
        parent, before, copying = program.pid, [0], set()

        def next_core() -> int:
            pid = holder_of(str(log_dir)) if log_dir.is_dir() else 0
            return pid if pid not in before and process_of(NODE) == pid else 0

        for number in (0, signal.SIGKILL, signal.SIGTERM):
            if number:
                os.kill(before[-1], number)
            if number == signal.SIGTERM:
                break
            core = wait_until(next_core, lambda: f"the node runs; it printed\n{program.text}")
            self.assertNotEqual(core, parent)
            before.append(core)
            rospy.wait_for_service("/other/core/stop")
            self.assertEqual(rosservice.get_service_node("/other/core/stop"), NODE)
            wait_until(lambda: rospy.has_param("/other/roah_rsbb_door"), "the door is published")
            rospy.delete_param("/other/roah_rsbb_door")  # the next node publishes it again, when it handles signals
            wait_until(lambda: list(stick.rglob("*.log")), "the journal is copied")
            copying.add((log_dir / LOCK).read_text("ascii"))
        self.assertEqual(program.wait_ended(), 0, "as without a supervisor: roslaunch starts the next one")
        self.assertIn("The box has ended unexpectedly (-9)", program.text)
        pid, of = copying.pop().split()
        self.assertEqual((int(of), copying), (parent, set()), "one program copies for all cores")
        self.assertFalse(os.path.exists(f"/proc/{pid}"), "and ends with the supervisor")

    def test_nothing_is_left_of_a_program_that_is_killed_or_interrupted(self) -> None:
        for number in (signal.SIGKILL, signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            with self.subTest(number), tempfile.TemporaryDirectory() as folder:
                given = {**PARAMS, "log_dir": folder, "backup_dir": f"{folder}/stick", "modules": True,
                         "modules_dir": f"{folder}/modules", "schedule_file": CONFIG / "modules_schedule.yaml"}
                os.mkdir(given["backup_dir"])
                shutil.copytree(CONFIG / "modules", given["modules_dir"])
                program = self._leaving(Program("env", own("roah_rsbb_core"), *OTHER_CORE, *(
                    f"_{name}:={value}" for name, value in given.items())))
                wait_until(lambda: process_of("/roah_rsbb_modules"), "the modules run")
                wait_until(lambda: len(commands_with(folder)) == 4,
                           lambda: f"program, node, modules and copies run: {commands_with(folder)}")
                program.signal(number)
                self.assertEqual(program.wait_ended(), -number if number == signal.SIGKILL else 0)
                wait_until(lambda: not commands_with(folder), "all of them have ended")


class TestNoMaster(NetworkCase):
    """A core that comes back serves robots and STOP, whatever its ROS master does."""

    def setUp(self) -> None:
        super().setUp()
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.log_dir = str(pathlib.Path(folder.name, "log"))
        self.port = str(RSBB_PORT + 50)
        self.uri = f"http://{os.environ.get('ROS_IP', '127.0.0.1')}:{self.port}"
        self.start_master()
        self.schedule = pathlib.Path(folder.name, "schedule.yaml")
        shutil.copy(PARAMS["schedule_file"], self.schedule)
        self.program = self._leaving(Program(own("roah_rsbb_core"), *(
            f"_{name}:={value}" for name, value in {
                **PARAMS, "schedule_file": self.schedule, "log_dir": self.log_dir, "end_launch": True}.items()),
            ROS_MASTER_URI=self.uri, ROS_HOME=folder.name))
        self.door = os.path.join(folder.name, f"roah_rsbb_door_{self.port}.json")
        self.box = self._leaving(DoorClient(lambda: read_place(self.door)))
        wait_until(lambda: self.box.uuid, lambda: f"the core is there; it printed\n{self.program.text}")

    def start_master(self) -> None:
        self.master = Program("rosmaster", "--core", "-p", self.port, ROS_MASTER_URI=self.uri)
        self.addCleanup(self.master.close)
        self.addCleanup(self.master.kill)  # it may be stopped
        wait_until(lambda: rosgraph.is_master_online(self.uri), "the master answers")

    def press(self, command: str) -> None:
        """Give a command as soon as its button is on."""
        def is_done() -> bool:
            try:
                if self.box.document.zones["Home"].is_on(command):
                    self.box.command(command, "Home")
                    return True
            except Refusal as refused:
                if not PASSING.search(str(refused)):
                    raise
            return False

        wait_until(is_done, lambda: f"{command} is possible: {self.box.document.zones['Home']}")

    def is_registered(self) -> bool:
        """Whether the present core is at the master."""
        master = rosgraph.Master("/test", self.uri)
        return "/core/stop" in dict(master.getSystemState()[2]) and master.hasParam("/roah_rsbb_door") and (
            master.getParam("/roah_rsbb_door")["token"] == read_place(self.door).token)

    def test_it_is_served_while_the_master_is_stopped_or_gone(self) -> None:
        robot = self.robot("Alpha")
        for number in (signal.SIGSTOP, signal.SIGKILL):
            with self.subTest(number):
                self.press("connect")
                self.press("start")
                wait_until(lambda: robot.did and robot.did[-1].startswith("execute"), "the robot executes")
                before, core = self.box.uuid, holder_of(self.log_dir)
                self.master.signal(number)
                os.kill(core, signal.SIGKILL)
                wait_until(lambda: self.box.uuid not in ("", before),  # noqa: B023
                           lambda: f"the next core is there; it printed\n{self.program.text}")
                self.assertEqual(self.box.document.zones["Home"].phase, "running")
                self.press("stop")
                robot.wait_did("stop")
                wait_until(lambda: NO_MASTER in self.box.warnings, lambda: f"it says so: {self.box.warnings}")
                if number == signal.SIGSTOP:
                    self.master.signal(signal.SIGCONT)
                else:
                    self.start_master()
                wait_until(lambda: NO_MASTER not in self.box.warnings, "it says that it answers")
                wait_until(self.is_registered, "the core is at the master")
                self.press("disconnect")

    def test_one_that_cannot_start_again_leaves_no_robot_executing(self) -> None:
        """It neither waits for a master, nor ends the launch: the barest core stops the robots."""
        robot = self.robot("Alpha")
        self.press("connect")
        self.press("start")
        wait_until(lambda: robot.did and robot.did[-1].startswith("execute"), "the robot executes")
        self.schedule.write_text("damaged", "utf-8")
        self.master.kill()
        os.kill(holder_of(self.log_dir), signal.SIGKILL)
        wait_until(lambda: robot.did[-1] == "stop", lambda: f"it is stopped; the core printed\n{self.program.text}")
        wait_until(lambda: "This box only sends STOP" in self.program.text, "it says so")
