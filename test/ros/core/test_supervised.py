"""The core's program and the node in it: whichever is killed, the node is as it was."""

import os
import pathlib
import signal
import tempfile

import rospy
import rosservice
from support.connections import process_of
from support.own_core import OTHER_CORE, PARAMS, OwnCoreCase
from support.programs import Program, own
from support.waiting import wait_until

from roah_rsbb.journal.file import holder_of

NODE = "/field/other_core"


class TestSupervisedCore(OwnCoreCase):
    def test_the_node_is_started_again_with_all_that_it_was_given(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        log_dir = str(pathlib.Path(folder.name, "log"))
        program = self._leaving(Program(own("roah_rsbb_core"), *OTHER_CORE, *(
            f"_{name}:={value}" for name, value in {**PARAMS, "log_dir": log_dir}.items()), ROS_NAMESPACE="/field"))
        parent, before = program.pid, [0]

        def next_core() -> int:
            pid = holder_of(log_dir) if os.path.isdir(log_dir) else 0
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
        self.assertEqual(program.wait_ended(), 0, "as without a supervisor: roslaunch starts the next one")
        self.assertIn("The box has ended unexpectedly (-9)", program.text)

    def test_nothing_is_left_of_a_program_that_is_killed_or_interrupted(self) -> None:
        for number in (signal.SIGKILL, signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            with self.subTest(number), tempfile.TemporaryDirectory() as folder:
                program = self._leaving(Program(own("roah_rsbb_core"), *OTHER_CORE, *(
                    f"_{name}:={value}" for name, value in {**PARAMS, "log_dir": folder}.items())))
                core = wait_until(lambda: process_of("/other_core"), "the node runs")
                wait_until(lambda: holder_of(folder), "it has the journal")
                program.signal(number)
                self.assertEqual(program.wait_ended(), -number if number == signal.SIGKILL else 0)
                wait_until(lambda: not os.path.exists(f"/proc/{core}"), "the node has ended")  # noqa: B023
