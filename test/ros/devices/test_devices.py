"""The home devices, whole: names and types, robots in HCFGAC, a referee, a core that is killed."""

import json
import os
import pathlib
import subprocess
import threading
import unittest
from unittest import mock

import rosnode
import rospy
import rosservice
from std_msgs.msg import Empty
from std_srvs.srv import Empty as EmptySrv
from support.box_case import BoxCase
from support.box_client import Refusal
from support.connections import kill, process_of, wait_sends
from support.programs import own
from support.waiting import LIMIT_S, happened, wait_until

from roah_rsbb.devices.devices import FILE
from roah_rsbb.msg import DevicesState, DevicesStatus
from roah_rsbb.ros import messages
from roah_rsbb.ros.core import devices
from roah_rsbb.srv import Bool, Percentage

HOME = pathlib.Path(os.environ.get("ROS_HOME", os.path.expanduser("~/.ros")))
PLAYED, KEPT = HOME / "played", HOME / "roah_rsbb_test" / FILE
NODE, CORE = "/roah_devices", "/roah_rsbb_core"
SWITCHES, PERCENTAGES = ("switch_1", "switch_2", "switch_3"), ("dimmer", "blinds")
# docs/ros_interface.md, "Devices node".
SERVICES = {
    **{f"/devices/{switch}/{word}": "std_srvs/Empty" for switch in SWITCHES for word in ("on", "off")},
    **{f"/devices/{switch}/set": "roah_rsbb/Bool" for switch in SWITCHES},
    **{f"/devices/{device}/{word}": "std_srvs/Empty" for device in PERCENTAGES for word in ("max", "min")},
    **{f"/devices/{device}/set": "roah_rsbb/Percentage" for device in PERCENTAGES},
    "/devices/bell/mock": "std_srvs/Empty",
    "/devices/door_win_detect/mock": "roah_rsbb/Bool",
}


def call(name, kind=EmptySrv, *request):
    """Call a service; raises `Refusal` if it fails with a reason."""
    rospy.wait_for_service(name, LIMIT_S)
    try:
        rospy.ServiceProxy(name, kind)(*request)
    except rospy.ServiceException as error:
        assert messages.was_answered(str(error)), str(error)
        raise Refusal(messages.reason(str(error))) from None


class DevicesCase(BoxCase):
    def setUp(self):
        super().setUp()
        self.state, self.status, self.rings = None, None, 0
        for topic, kind, hear in (
            ("/devices/state", DevicesState, lambda m: setattr(self, "state", m)),
            ("/devices/status", DevicesStatus, lambda m: setattr(self, "status", m)),
            ("/devices/bell", Empty, lambda _: setattr(self, "rings", self.rings + 1)),
        ):
            subscriber = rospy.Subscriber(topic, kind, lambda m, hear=hear: (hear(m), happened()), queue_size=10)
            self.addCleanup(subscriber.unregister)
        self.bell = subscriber
        # The other two are latched: a late listener has them.
        self.wait_connected()
        for device in SWITCHES:
            call(f"/devices/{device}/off")
        for device in PERCENTAGES:
            call(f"/devices/{device}/min")
        self.wait_state(switch_1=False, switch_2=False, switch_3=False, dimmer=0, blinds=0)

    def wait_connected(self, connected=True):
        wait_until(lambda: self.state and self.status and self.status.connected is connected,
                   lambda: f"connected: {connected}; {self.status}")

    def wait_state(self, **values):
        wait_until(lambda: self.state and all(getattr(self.state, k) == v for k, v in values.items()),
                   lambda: f"{values}; it is\n{self.state}")

    def wait_robot(self, robot, **values):
        """Wait until the robot has received the beacon."""
        wait_until(lambda: robot.devices and all(getattr(robot.devices, k) == v for k, v in values.items()),
                   lambda: f"the robot receives {values}; it has {robot.devices}")


class TestInterface(DevicesCase):
    def test_names_and_types(self):
        for name in SERVICES:
            rospy.wait_for_service(name, LIMIT_S)
        offered = {name: rosservice.get_service_type(name) for name in rosservice.get_service_list("/roah_devices")
                   if name.startswith("/devices/")}
        self.assertEqual(offered, SERVICES)

    def test_each_service(self):
        for switch in SWITCHES:
            for word, request, value in (("on", (), True), ("off", (), False), ("set", (Bool, True), True)):
                call(f"/devices/{switch}/{word}", *request)
                self.wait_state(**{switch: value})
        for device in PERCENTAGES:
            for word, request, value in (("max", (), 100), ("min", (), 0), ("set", (Percentage, 35), 35)):
                call(f"/devices/{device}/{word}", *request)
                self.wait_state(**{device: value})
        for opened in (True, False):
            call("/devices/door_win_detect/mock", Bool, opened)
            self.wait_state(door_win_detect=opened)

    def test_the_node_is_there_and_cannot_be_ended_alone(self):
        self.assertIn(NODE, rosnode.get_node_names())
        self.assertEqual(process_of(NODE), process_of(CORE))
        self.assertEqual(rospy.get_param(f"{NODE}/smartif_host"), "127.0.0.1")
        rosnode.kill_nodes([NODE])
        call("/devices/dimmer/set", Percentage, 35)
        self.wait_state(dimmer=35)

    def test_its_calls_at_the_door_of_the_box(self):
        self.box.ask("set_device", device="dimmer", value=35)
        self.wait_state(dimmer=35)
        self.wait_connected()
        found = self.box.ask("devices")
        self.assertEqual((found["devices"]["dimmer"], found["connected"]), (35, True))
        with self.assertRaisesRegex(Refusal, "dimmer .* 101: it takes 0 to 100 per cent"):
            self.box.ask("set_device", device="dimmer", value=101)

    def test_more_than_100_per_cent_fails_with_the_reason(self):
        for device in PERCENTAGES:
            with self.subTest(device), self.assertRaisesRegex(Refusal, f"{device} .* 101: it takes 0 to 100 per "
                                                                       f"cent"):
                call(f"/devices/{device}/set", Percentage, 101)
        call("/devices/dimmer/max")
        self.wait_state(dimmer=100, blinds=0)


class TestNode(unittest.TestCase):
    def test_its_address_is_waited_for(self):
        begun = []

        class Late(devices.XmlRpcNode):
            """A node whose thread begins when it is waited for, as on a busy computer."""

            def start(self):
                begun.append(threading.Timer(0.5, self.run))
                begun[-1].daemon = True
                begun[-1].start()

        with mock.patch.object(devices, "XmlRpcNode", Late):
            self.assertTrue(devices._show_node().startswith("http://"))

    def test_without_a_port_it_says_so(self):
        with mock.patch.object(devices, "SHOWN_S", 0.0), mock.patch.object(devices.XmlRpcNode, "start"), \
                self.assertRaisesRegex(OSError, "no port for the node roah_devices"):
            devices._show_node()


class TestBell(DevicesCase):
    def setUp(self):
        super().setUp()
        wait_sends(CORE, self.bell)

    def played(self, what):
        return PLAYED.read_text(encoding="utf-8").split().count(what) if PLAYED.exists() else 0

    def test_rings_are_published_shown_and_heard(self):
        self.ring_and_check(lambda: call("/devices/bell/mock"))

    def test_rings_of_the_dummy_server(self):
        self.ring_and_check(lambda: call("/roah_devices_dummy/ring"))

    def test_the_door_and_the_bell_from_the_command_line(self):
        def command(word):
            subprocess.run([own("roah_devices_dummy"), word], check=True, timeout=LIMIT_S)
        command("open")
        self.wait_state(door_win_detect=True)
        command("close")
        self.wait_state(door_win_detect=False)
        self.ring_and_check(lambda: command("ring"))

    def ring_and_check(self, ring):
        heard, before, rings = self.played("bell"), self.state.bell, self.rings
        ring()
        wait_until(lambda: self.state.bell > before and self.rings == rings + 1 and self.played("bell") > heard,
                   lambda: f"a ring; state:\n{self.state}\nrings {self.rings}, played {self.played('bell')}")


class TestCatering(DevicesCase):
    def run_of(self, team, zone):
        robot = self.robot(team)
        self.box.connect(zone)
        self.box.start(zone)
        robot.wait_did(f"execute {self.box.last_zone(zone).code}")
        return robot

    def wait_log(self, zone, text):
        self.box.wait_zone(zone, lambda z: text in z.log, f"'{text}' is in the log")

    def test_a_robot_operates_each_device_and_the_referee_has_the_last_word(self):
        robot = self.run_of("Alpha", "Catering")
        for device, value in (("switch_1", True), ("switch_2", True), ("switch_3", True), ("dimmer", 70),
                              ("blinds", 100), ("switch_3", False), ("blinds", 5)):
            robot.request("set_device", device, value)
            self.wait_robot(robot, **{device: value})
            self.wait_state(**{device: value})
            self.wait_log("Catering", f"Robot sets {device} to {int(value)}")
        call("/devices/dimmer/set", Percentage, 20)
        self.wait_robot(robot, dimmer=20)
        robot.request("set_device", "dimmer", 70)  # as before: no change
        robot.request("set_device", "switch_2", False)  # this one comes after it
        self.wait_robot(robot, switch_2=False)
        self.assertEqual((robot.devices.dimmer, self.state.dimmer), (20, 20))
        log = self.leave("Catering")
        self.assertEqual(log.values("/rsbb_log/devices/dimmer"), [70])
        self.assertEqual(log.values("/rsbb_log/devices/blinds"), [100, 5])

    def test_a_core_that_follows_a_killed_one_holds_all_values(self):
        robot = self.run_of("Alpha", "Catering")
        robot.request("set_device", "dimmer", 33)
        self.wait_robot(robot, dimmer=33)
        before = self.state.bell
        call("/devices/bell/mock")
        bell = wait_until(lambda: self.state.bell > before and self.state.bell, "the bell")
        wait_until(lambda: json.loads(KEPT.read_text("utf-8"))["bell"] == [str(bell.secs), str(bell.nsecs)],
                   "it is kept")
        headers = [message._connection_header for message in (self.state, self.status)]
        kill(CORE)
        wait_until(lambda: not any(message._connection_header is header for header in headers
                                   for message in (self.state, self.status)), "another core publishes both")
        self.wait_connected()
        self.assertEqual((self.state.dimmer, self.state.bell, self.state.blinds), (33, bell, 0))
        robot.request("set_device", "blinds", 45)
        self.wait_robot(robot, blinds=45, dimmer=33)
