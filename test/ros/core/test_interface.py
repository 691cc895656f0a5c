"""The core's ROS interface: names, types, latching, rates, parameters, and the reasons in failed calls.

Everything expected here is written out, because teams and referees rely on it: it never follows the code.
"""

import time
import unittest

import rosgraph
import rospy
import rosservice
import yaml
from support.box_case import LISTENER, PACKAGE, BoxCase
from support.box_client import Refusal
from support.programs import Program
from support.robots import BROADCAST, RSBB_PORT
from support.waiting import LIMIT_S, happened, wait_until

from roah_rsbb import msg, srv
from roah_rsbb.msg import CoreToGui, CoreToPublic, Score

CORE = "/roah_rsbb_core"

# Computed from the fixed field names, types and orders (docs/ros_interface.md, "Topics of the core"): a program that
# was built with other messages cannot connect.
MESSAGES = {
    "Benchmark": "cfa4331ce4d1f39790c8c0628c907f86",
    "BenchmarkState": "638cf6eefb7a067a4d944ececf176a87",
    "CoreToGui": "0ef7d82cb8142e19f4ebaf98bde3e591",
    "CoreToPublic": "c1653c7b0f0f141b86d7a3b82a0d19d3",
    "DevicesState": "c3473010fb060fb5c9e320d2700daeec",
    "GoalHGMF": "07dbf37e269caf1d027e61f1714cfbe7",
    "GoalOMF": "1ecb2b723fb091fc72a4100a7999df09",
    "RobotInfo": "00b96804c5959d5bfa7ace65fdfa0964",
    "ScheduleInfo": "0632812e0aba2769c39c5f0d04a14fc0",
    "Score": "dae5eaddb8494f806eb4f392cd53e4e9",
    "TabletState": "e22a07b846b70880201a367bc6f1c8a3",
    "ZoneScoreGroup": "3ae41b4e681f7556093137b622b4456e",
    "ZoneState": "e506e3db006f5d0d2df9aaa5fe1aaddc",
}
SERVICES = {
    "Bool": "8b94c1b53db61fb6aed406028ad6332a",
    "Override": "616a9e24da0705b47816f8443dff5147",
    "Percentage": "7c8164229e7d2c17eb95e9231617fdee",
    "ResultHOPF": "712e1238eeaa80ac069f72dff01feb53",
    "ResultHPPF": "879950a8a93ec363d8385cbe4b6a5d63",
    "String": "992ce8a1687cec8c8bd883ec73ca41d1",
    "UInt8": "7c8164229e7d2c17eb95e9231617fdee",
    "Zone": "34cd609a5b7df6d77150b8546b44302d",
    "ZoneScore": "831897ace4087e0fb480af5f99255606",
    "ZoneUInt8": "f1dc264faced798c658d5238155f83b2",
}
ZONE_COMMANDS = ("connect", "disconnect", "start", "stop", "previous", "next", "manual_operation_complete",
                 "omf_switches/complete")
CORE_SERVICES = {
    **{f"/core/{command}": "roah_rsbb/Zone" for command in ZONE_COMMANDS},
    "/core/set_score": "roah_rsbb/ZoneScore",
    "/core/omf_switches/damaged": "roah_rsbb/ZoneUInt8",
    "/core/omf_switches/button": "roah_rsbb/ZoneUInt8",
}
# Arguments of both main launch files and their defaults (docs/organiser.md, "Arguments and parameters"; bind_host and
# gui are new).
LAUNCH_ARGUMENTS = {
    "rsbb_host": "10.255.255.255", "rsbb_port": 6666, "bind_host": "0.0.0.0", "benchmarks_file": "benchmarks.yaml",
    "schedule_file": "schedule.yaml", "passwords_file": "passwords.yaml",
}


class TestTypes(unittest.TestCase):
    def test_md5_sums(self) -> None:
        self.assertEqual({name: getattr(msg, name)._md5sum for name in MESSAGES}, MESSAGES)
        self.assertEqual({name: getattr(srv, name)._md5sum for name in SERVICES}, SERVICES)

    def test_constants(self) -> None:
        codes = ("NONE", "HGTKMH", "HWV", "HCFGAC", "HOPF", "HNF", "HSUF", "STB", "HPPF", "HPFF", "HGMF")
        self.assertEqual([getattr(msg.Benchmark, code) for code in codes], list(range(11)))
        states = [getattr(msg.BenchmarkState, state) for state in ("STOP", "PREPARE", "EXECUTE")]
        self.assertEqual(states, [0, 1, 2])
        self.assertEqual((msg.ZoneScoreGroup.SCORING_BOOL, msg.ZoneScoreGroup.SCORING_UINT), (0, 1))
        request = srv.OverrideRequest
        self.assertEqual((request.STOP, request.PREPARE, request.GOAL_TX, request.WAITING_RESULT), (0, 1, 2, 3))


class TestTopics(BoxCase):
    def test_names_types_and_direction(self) -> None:
        master = rosgraph.Master("/test_core_interface")
        types = dict(master.getTopicTypes())
        published, subscribed, _ = ({name: set(nodes) for name, nodes in part} for part in master.getSystemState())
        for name, kind in (("/core/to_gui", "roah_rsbb/CoreToGui"), ("/core/to_public", "roah_rsbb/CoreToPublic"),
                           ("/timeout", "std_msgs/Empty")):
            with self.subTest(name):
                self.assertEqual(types[name], kind)
                self.assertEqual(published[name], {CORE})
        self.assertEqual(types["/devices/state"], "roah_rsbb/DevicesState")
        self.assertIn(CORE, subscribed["/devices/state"])

    def test_another_node_may_have_the_home_devices(self) -> None:
        listener = self.participant(LISTENER)
        publisher = rospy.Publisher("/devices/state", msg.DevicesState, queue_size=1, latch=True)
        self.addCleanup(publisher.unregister)
        publisher.publish(msg.DevicesState(dimmer=33))
        listener.wait_beacon(lambda beacon: beacon.devices_dimmer == 33, "robots are sent its state")

    def test_states_are_latched(self) -> None:
        for topic, kind in (("gui", CoreToGui), ("public", CoreToPublic)):
            with self.subTest(topic):
                header = getattr(self.box, topic)._connection_header
                self.assertEqual((header["latching"], header["type"]), ("1", kind._type))

    def test_rates(self) -> None:
        """10 Hz for the panels, by the messages' own clocks; 2 Hz for the public, which is every fifth time.

        A busy machine delays and drops some of them, so the usual interval counts.
        """
        clocks, publics = [], []
        for topic, kind, hear in (("/core/to_gui", CoreToGui, lambda m: clocks.append(m.clock.to_sec())),
                                  ("/core/to_public", CoreToPublic, publics.append)):
            self.addCleanup(rospy.Subscriber(topic, kind, lambda m, hear=hear: (hear(m), happened())).unregister)
        wait_until(lambda: len(clocks) > 30 and len(publics) > 6, lambda: f"{len(clocks)} and {len(publics)} messages")
        intervals = sorted(later - clock for clock, later in zip(clocks[1:], clocks[2:]))
        self.assertGreater(intervals[len(intervals) // 2], 0.05)
        self.assertLess(intervals[len(intervals) // 4], 0.2)
        self.assertGreater(len(clocks), 2 * len(publics))


class TestLatched(unittest.TestCase):
    """No client of another case listens."""

    def test_who_subscribes_again_is_sent_nothing_old(self) -> None:
        """While nobody subscribes, nothing is made: a latched message of before would be old."""
        master = rosgraph.Master("/test_core_interface")
        for _ in range(2):
            wait_until(lambda: "/core/to_gui" not in dict(master.getSystemState()[1]), "nobody subscribes")
            asked = time.time()
            first = rospy.wait_for_message("/core/to_gui", CoreToGui, LIMIT_S)
            self.assertGreaterEqual(first.clock.to_sec(), asked)


class TestServices(BoxCase):
    def test_names_and_types(self) -> None:
        for name, kind in CORE_SERVICES.items():
            with self.subTest(name):
                rospy.wait_for_service(name, 30)
                self.assertEqual(rosservice.get_service_type(name), kind)
                self.assertEqual(rosservice.get_service_node(name), CORE)

    def test_shutdown_services(self) -> None:
        names = wait_until(
            lambda: [name for name in rosservice.get_service_list() if name.endswith("/roah_rsbb_shutdown")][1:]
            and sorted(name for name in rosservice.get_service_list() if name.endswith("/roah_rsbb_shutdown")),
            "both shutdown services are there",
        )
        self.assertEqual([rosservice.get_service_type(name) for name in names], ["std_srvs/Empty"] * 2)
        client, core = names
        self.assertRegex(client, "^/roah_rsbb_client_[^/]+/roah_rsbb_shutdown$")
        self.assertEqual(rosservice.get_service_node(client), client)
        self.assertEqual((core, rosservice.get_service_node(core)), ("/roah_rsbb_shutdown", "/roah_rsbb_core_shutdown"))

    def test_an_unknown_zone_is_named_with_the_nearest_known(self) -> None:
        for name, kind in CORE_SERVICES.items():
            kind = getattr(srv, kind.split("/")[1])
            rest = {srv.Zone: (), srv.ZoneScore: (Score("g", "d", 1),), srv.ZoneUInt8: (1,)}[kind]
            for zone, why in (("Task Benchmark", "no zone 'Task Benchmark': did you mean 'Task Benchmarks'?"),
                              ("", "no zone '': there is 'Testing TestingTeam', 'Task Benchmarks', "
                                   "'Functionality Benchmarks'")):
                with self.subTest(name, zone=zone):
                    with self.assertRaises(Refusal) as raised:
                        self.box.call(name[len("/core/"):], kind, zone, *rest)
                    self.assertEqual(str(raised.exception), why)

    def test_strange_requests_do_no_harm(self) -> None:
        for zone, why in (("x" * 100_000, "zone has 100000 characters"), ("ßü\n\t'\"", "no zone '"),
                          ("%s%n{}", "no zone '")):
            self.assertIn(why, self.box.refusal("start", zone))
        clock = self.box.gui.clock
        wait_until(lambda: self.box.gui.clock > clock, "the core publishes on")


class TestWhatIsPublished(BoxCase):
    def test_of_the_installed_configuration(self) -> None:
        wait_until(lambda: self.box.gui.status == "OK", lambda: f"the status is OK, not {self.box.gui.status}")
        gui = self.box.gui
        self.assertEqual((gui.addr, gui.port), (BROADCAST, str(RSBB_PORT)))
        zones = ["Testing TestingTeam", "Task Benchmarks", "Functionality Benchmarks"]
        self.assertEqual([zone.zone for zone in gui.zones], zones)
        self.assertEqual(list(self.box.document.box.zones), zones)
        self.assertEqual([zone.code for zone in gui.zones], ["HGTKMH", "HGTKMH", "HOPF"])
        wait_until(lambda: len(self.box.public.schedule) == 11 + 12 + 11, "the public sees the whole schedule")
        times = [line.time for line in self.box.public.schedule]
        self.assertEqual(times, sorted(times))
        self.assertEqual({line.running for line in self.box.public.schedule}, {False})


class TestParameters(unittest.TestCase):
    def test_launch_arguments_and_their_defaults(self) -> None:
        for launch_file in ("roah_rsbb.launch", "roah_rsbb_dummy.launch"):
            dump = Program("roslaunch", "--dump-params", PACKAGE, launch_file)
            self.addCleanup(dump.close)
            self.assertEqual(dump.wait_ended(), 0, dump.text)
            params = yaml.safe_load(dump.text)
            for name, value in LAUNCH_ARGUMENTS.items():
                found = params[f"{CORE}/{name}"]
                with self.subTest(launch_file, argument=name):
                    if name.endswith("_file"):
                        self.assertTrue(found.endswith(f"/config/{value}"), found)
                    else:
                        self.assertEqual(found, value)
            self.assertIn(f"{CORE}/log_dir", params)
