"""Problems in a run, over real sockets: timeouts, passwords, what cannot be read."""

import os
import pathlib
import socket

from support.box_case import BoxCase
from support.robots import BOX, RSBB_PORT, host_of
from support.waiting import wait_until

from roah_rsbb.protocol import BoxState, RobotState
from roah_rsbb.robot.effects import Problem

PLAYED = pathlib.Path(os.environ.get("ROS_HOME", os.path.expanduser("~/.ros"))) / "played"
STOP, PREPARE, WAITING_RESULT = BoxState.STOP, BoxState.PREPARE, BoxState.WAITING_RESULT


class TestTime(BoxCase):
    """Timeout."""

    def test_a_timeout_ends_the_run_for_good(self) -> None:
        box, robot = self.box, self.robot("Alpha")
        box.wait_timeouts_heard()
        first_port = box.connect("Timeout")
        self.assertEqual(box.timeouts, 0)
        box.start("Timeout")
        box.wait_text("Timeout", "Stopped due to timeout")
        wait_until(lambda: box.timeouts == 1, "/timeout is published once")
        wait_until(PLAYED.exists, "its sound is played")
        robot.wait_did("stop")
        box.wait_details("Timeout", lambda d: (d.phase, d.end_reason, d.box_state) == ("ended", "timeout", "STOP"),
                         "the run ended by timeout")
        robot.wait_state(RobotState.STOP)
        why = "The run ended by timeout: disconnect, and connect for a new run"
        box.wait_details(
            "Timeout", lambda d: list(d.off("start")) == [why],
            "that is the only reason why start is off")
        self.assertFalse(box.zone("Timeout").start_enabled)
        self.assertEqual(box.refusal("start", "Timeout"), why)
        log = self.leave("Timeout")
        states = log.values("/rsbb_log/rsbb_state")
        # On a busy machine the time may be up before the robot has prepared.
        self.assertEqual([state for state in states if state != WAITING_RESULT], [STOP, PREPARE, STOP])
        self.assertEqual(log.values("/rsbb_log/rsbb_state_desc")[-1], "Stopped due to timeout")

        self.assertGreater(box.connect("Timeout"), first_port)
        box.wait_zone("Timeout", lambda z: z.start_enabled and z.code == "HWV", "a new run of the same event is there")
        self.assertEqual(box.timeouts, 1)


class TestRobots(BoxCase):
    """Robots that are strangers."""

    def test_a_wrong_password(self) -> None:
        box, robot = self.box, self.robot("Theta", password="guessed")
        port = box.connect("Stranger")
        wait_until(lambda: Problem.WRONG_PASSWORD in robot.reports, lambda: f"the robot notices: {robot.reports}")
        box.wait_details(
            "Stranger",
            lambda d: any("password" in reason for reason in d.off("start")), "the referee sees the reason"
        )
        refusal = box.refusal("start", "Stranger")
        self.assertIn("Robot has not answered on the private channel yet", refusal)
        self.assertRegex(refusal, rf"private channel {port}.*{host_of('Theta')}.*password")
        self.assertFalse(box.zone("Stranger").start_enabled)
        self.assertEqual(robot.did, [])
        self.assertNotIn("client_state", " ".join(self.leave("Stranger").types))

    def test_datagrams_that_cannot_be_read(self) -> None:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as stranger:
            stranger.bind(("127.0.0.9", 0))
            for datagram in (b"", b"\1", b"hello box" * 9, b"\2\0\0\0\xff\xff\xff\xff", b"\2\2\0\0" + bytes(60)):
                stranger.sendto(datagram, (BOX, RSBB_PORT))
        wait_until(lambda: "127.0.0.9" in " ".join(self.box.warnings), "every referee is warned")
        wait_until(lambda: "127.0.0.9" in self.box.gui.status, "the box's status says it")
        robot = self.robot("Epsilon")
        wait_until(lambda: self.box.robot("Epsilon"), "the box continues")
        robot.close()
