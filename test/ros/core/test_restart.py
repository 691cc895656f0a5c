"""A core that is ended in a run comes back, and the run continues; no port is used twice."""

import contextlib
import signal
import socket

from support.box_case import BoxCase
from support.robots import BOX


class TestRestart(BoxCase):
    def test_a_core_that_is_ended_in_a_run(self) -> None:
        self.robot("Alpha")
        port = self.box.connect("Home")
        path = self.box.wait_details("Home", lambda d: d.log_file, "the run has a log")
        self.kill_core(signal.SIGTERM)
        details = self.box.zone_details("Home")
        self.assertEqual((details.phase, details.port, details.log_file), ("connected", port, path))
        self.assertEqual(self.leave("Home").values("/rsbb_log/rsbb_state_str"), ["STOP"])

    def test_a_private_port_that_another_program_uses(self) -> None:
        robot = self.robot("Alpha")
        port = self.box.connect("Home")
        self.box.command("disconnect", "Home")
        with contextlib.ExitStack() as stack:
            for taken in (port + 1, port + 2):
                stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM)).bind((BOX, taken))
            self.box.connect("Home")  # the ports are tried one after the other
            self.box.wait_details("Home", lambda d: d.port == port + 3, "the run has the next free port")
        self.box.start("Home")
        robot.wait_did("execute HGTKMH")
