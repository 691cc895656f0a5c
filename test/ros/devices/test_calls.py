"""Robots' device commands on their way to the devices node: the latest first; failures are reported."""

import threading
import unittest

import rospy
from support.waiting import wait_until

from roah_rsbb.core.effects import SetDevice
from roah_rsbb.ros.core import devices
from roah_rsbb.ros.core.devices import DeviceCalls
from roah_rsbb.srv import Bool, BoolResponse, Percentage, PercentageResponse


class DeviceCallsTest(unittest.TestCase):
    def setUp(self) -> None:
        self.addCleanup(setattr, devices, "ANSWER_TIMEOUT_S", devices.ANSWER_TIMEOUT_S)
        self.set_limit(60.0)
        self.reported = []
        self.calls = DeviceCalls(lambda wish, reason: self.reported.append((wish, reason)))
        self.done = []
        self.gate = threading.Event()
        self.gate.set()
        self.refuse = ""
        self.services = [
            rospy.Service("/devices/dimmer/set", Percentage, self._dimmer),
            rospy.Service("/devices/switch_1/set", Bool, self._switch),
        ]

    def tearDown(self) -> None:
        self.gate.set()
        for service in self.services:
            service.shutdown()

    def _dimmer(self, request: object) -> PercentageResponse:
        return self._serve("dimmer", request.data, PercentageResponse())

    def _switch(self, request: object) -> BoolResponse:
        return self._serve("switch_1", request.data, BoolResponse())

    def _serve(self, device: str, value: object, response: object) -> object:
        self.done.append((device, value))
        self.gate.wait()
        if self.refuse:
            raise rospy.ServiceException(self.refuse)
        return response

    @staticmethod
    def set_limit(seconds: float) -> None:
        """How long calls from now on may take until they are reported."""
        devices.ANSWER_TIMEOUT_S = seconds

    def set(self, device: str, value: int) -> SetDevice:
        wish = SetDevice("zone", device, value)
        self.calls.set(wish)
        return wish

    def test_a_wish_is_carried_out_with_its_type(self) -> None:
        self.set("dimmer", 70)
        self.set("switch_1", 1)
        wait_until(lambda: sorted(self.done) == [("dimmer", 70), ("switch_1", True)], "both are set")
        self.assertEqual(self.reported, [])

    def test_while_a_call_hangs_only_the_latest_wish_waits_and_other_devices_continue(self) -> None:
        self.gate.clear()
        self.set("dimmer", 1)
        wait_until(lambda: self.done == [("dimmer", 1)], "the first call is made")
        for value in (2, 3, 4):
            self.set("dimmer", value)
        self.set("switch_1", 1)
        wait_until(lambda: ("switch_1", True) in self.done, "another device does not wait for this one")
        self.gate.set()
        wait_until(lambda: self.done[-1] == ("dimmer", 4), "the latest wish follows")
        self.assertEqual([value for device, value in self.done if device == "dimmer"], [1, 4])

    def test_a_refusal_is_reported_with_its_reason(self) -> None:
        self.refuse = "the controller is on fire"
        wish = self.set("dimmer", 5)
        wait_until(lambda: self.reported, "the refusal is reported")
        self.assertEqual(self.reported, [(wish, "the controller is on fire")])
        self.refuse = ""
        self.set("dimmer", 6)
        wait_until(lambda: self.done[-1] == ("dimmer", 6), "the next wish has its chance")

    def test_no_devices_node_is_reported(self) -> None:
        wish = self.set("blinds", 5)
        wait_until(lambda: self.reported, "it is reported")
        self.assertEqual(self.reported[0][0], wish)
        self.assertIn("no devices node answers", self.reported[0][1])

    def test_a_node_that_hangs_is_reported_once_and_while_it_hangs(self) -> None:
        self.set_limit(0.2)
        self.gate.clear()
        wish = self.set("dimmer", 7)
        wait_until(lambda: self.reported, "it is reported")
        self.assertEqual(self.reported[0][0], wish)
        self.assertIn("/devices/dimmer/set has not answered within", self.reported[0][1])
        self.set_limit(60.0)
        self.gate.set()
        self.set("dimmer", 8)
        wait_until(lambda: self.done[-1] == ("dimmer", 8), "it answers again")
        self.assertEqual(len(self.reported), 1)
