#!/usr/bin/python3
"""A core that dies in the middle of a run: it comes back, gives no port twice, and its log can be read."""

import contextlib
import os
import pathlib
import shutil
import signal
import socket
import xmlrpc.client

import rosbag
import rosgraph
from box_case import LISTENER, BoxCase, main
from robots import BOX, listed
from run_logs import RunLog
from waiting import wait_until

CORE = "/roah_rsbb_core"
DOOR = ("Achievements", "Detects the door whose state has changed")


class TestRestart(BoxCase):
    def kill_core(self, number: signal.Signals) -> None:
        """Kill the core's process, and wait until another one runs."""
        uuid = self.box.details.box_uuid
        node = xmlrpc.client.ServerProxy(rosgraph.Master("/test_core_restart").lookupNode(CORE))
        os.kill(node.getPid("/test_core_restart")[2], number)
        wait_until(lambda: self.box.details.box_uuid != uuid, "another core runs")

    def test_a_core_that_is_killed_in_a_run(self) -> None:
        robot, listener = self.robot("Alpha"), self.participant(LISTENER)
        port = self.box.connect("Home")
        self.box.start("Home")
        robot.wait_did("execute HGTKMH")
        self.box.set_score("Home", *DOOR, 1)
        path = pathlib.Path(self.box.zone_details("Home").log_file)
        # The log is safe in the file after a second or so.
        wait_until(lambda: recovered(path).messages("/rsbb_log/score"), "the score is in the file")
        self.kill_core(signal.SIGKILL)

        log = recovered(path)
        self.assertEqual(log.values("/rsbb_log/rsbb_state_str"), ["STOP", "PREPARE", "WAITING_RESULT"])
        self.assertEqual([(score.group, score.desc, score.value) for score in log.messages("/rsbb_log/score")],
                         [(*DOOR, 1)])
        self.assertEqual(self.box.zone_details("Home").phase, "idle")
        listener.wait_beacon(lambda b: not listed(b), "the beacon lists nobody")
        robot.wait_did("stop")
        again = self.box.connect("Home")
        self.assertGreater(again, port)
        self.box.start("Home")
        robot.wait_did("execute HGTKMH", times=2)
        robot.let("execute")
        self.box.wait_text("Home", "Benchmark completed by the robot")
        self.leave("Home")
        self.box.command("previous", "Home")

    def test_a_core_that_is_ended_in_a_run(self) -> None:
        self.robot("Alpha")
        port = self.box.connect("Home")
        path = self.box.wait_details("Home", lambda d: d.log_file, "the run has a log")
        self.kill_core(signal.SIGTERM)
        self.assertEqual(self.read_log(path).values("/rsbb_log/rsbb_state_str"), ["STOP"])
        self.assertGreater(self.box.connect("Home"), port)

    def test_a_private_port_that_another_program_uses(self) -> None:
        robot = self.robot("Alpha")
        port = self.box.connect("Home")
        self.box.command("disconnect", "Home")
        with contextlib.ExitStack() as stack:
            for taken in (port + 1, port + 2):
                stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM)).bind((BOX, taken))
            self.assertEqual(self.box.connect("Home"), port + 3)
        self.box.start("Home")
        robot.wait_did("execute HGTKMH")


def recovered(path: pathlib.Path) -> RunLog:
    """What `rosbag reindex` would save of a log that was not closed."""
    copy = path.with_suffix(".copy.bag")
    shutil.copy(str(path), str(copy))
    try:
        with rosbag.Bag(str(copy), "a", allow_unindexed=True) as bag:
            for _ in bag.reindex():
                pass
        return RunLog.complete(copy)
    except rosbag.ROSBagException:
        return RunLog(copy, [])  # not even its beginning is in the file


if __name__ == "__main__":
    main("test_core_restart")
