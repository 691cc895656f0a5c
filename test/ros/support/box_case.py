"""Support for test cases of the core: a client of the box, and participants on the network."""

import contextlib
import pathlib
import signal
import unittest
from typing import Any

from roah_rsbb.protocol import RobotState
from support.box_client import CORE, BoxClient, Refusal
from support.connections import kill
from support.robots import Network, PublicParticipant, RawRobot, Robot
from support.run_logs import RunLog
from support.waiting import wait_until

PACKAGE = "roah_rsbb"
# Whatever is in a test beside box and robots; the teams' robots have their addresses from `robots.host_of`.
LISTENER, TABLET = "127.0.0.3", "127.0.0.4"


class NetworkCase(unittest.TestCase):
    """A test case with participants on the network; they leave it when the case ends."""

    def setUp(self) -> None:
        self.network = Network()
        self.addCleanup(self.network.close)

    def robot(self, team: str, **how: Any) -> Robot:
        """A team's robot; `how`: see `Robot`."""
        return self._leaving(Robot(self.network, team, **how))

    def raw_robot(self, team: str) -> RawRobot:
        """A team's robot of which each datagram is the test's."""
        return self._leaving(RawRobot(self.network, team))

    def participant(self, host: str) -> PublicParticipant:
        """Somebody on the public channel."""
        return self._leaving(PublicParticipant(self.network, host))

    def _leaving(self, participant: Any) -> Any:
        self.addCleanup(participant.close)
        return participant


class BoxCase(NetworkCase):
    """A test case with the box that its .test file launched."""

    def setUp(self) -> None:
        super().setUp()
        self.box = BoxClient()
        self.addCleanup(self.box.close)
        self.box.wait_heard()
        self.addCleanup(self._end_runs)

    def _end_runs(self) -> None:
        """Remove what a failed case left, so that it does not affect the next one."""
        self.box.wait_current()
        for zone in self.box.document.zones.values():
            if zone.phase != "idle":
                with contextlib.suppress(Refusal):
                    self.box.command("disconnect", zone.zone)

    def leave(self, zone: str) -> RunLog:
        """Disconnect; returns the run's log once it is complete."""
        path = self.box.wait_details(zone, lambda d: d.log_file, "the run has a log")
        self.box.command("disconnect", zone)
        return self.read_log(path)

    def join(self, robot: RawRobot, zone: str) -> None:
        """Connect and start a robot of which each datagram is the test's.

        Until each button is on, it repeats itself as any robot does: a single datagram may be late, which looks like a
        slow clock.
        """
        robot.open_private(self.box.connect(zone, meanwhile=robot.beacon))
        self.box.start(zone, meanwhile=lambda: robot.send(RobotState.STOP))

    def kill_core(self, number: signal.Signals = signal.SIGKILL) -> None:
        """Send a signal to the core's process, and wait until roslaunch has restarted it."""
        uuid = self.box.uuid
        kill(CORE, number)
        self.box.wait_other_core(uuid)

    def read_log(self, path: str) -> RunLog:
        """The log of a run that was left, once it is complete."""
        return wait_until(lambda: RunLog.complete(pathlib.Path(path)), f"{path} is complete")
