"""A competition as new_competition makes it starts without an edit, and its teams' robots take part."""

import os
import shutil
import signal
import tempfile
import xmlrpc.client

import rosgraph
import rosnode
import rospy
import yaml
from support.box_case import NetworkCase
from support.box_client import BoxClient
from support.programs import Program, own
from support.robots import BOX, BROADCAST, RSBB_PORT
from support.waiting import LIMIT_S, wait_until

from roah_rsbb.journal.log_dir import JOURNAL

ZONES = ["Task Benchmarks", "Functionality Benchmarks"]
# A team that has an address in the tests; its password is a new one.
TEAM = "Alpha"
NETWORK = {"rsbb_port": RSBB_PORT, "bind_host": BOX, "devices": "false", "gui": "none", "tablet_port": 0,
           "web_port": 0}
MADE = ("--teams", f"{TEAM}, Copper Kettle", "--benchmarks", "HCFGAC,HNF,HSUF", "--days", "2026-11-28",
        "--rsbb-host", BROADCAST)


def pid_of(node: str) -> int:
    """The process of a node; 0: it does not answer."""
    try:
        uri = rosgraph.Master("/test").lookupNode(node)
        return xmlrpc.client.ServerProxy(uri).getPid("/test")[2]
    except (OSError, rosgraph.MasterException):
        return 0


class TestNewCompetition(NetworkCase):
    def setUp(self) -> None:
        super().setUp()
        # A blank is what a path on somebody's desktop has.
        self.directory = os.path.join(tempfile.mkdtemp(), "the competition")
        self.addCleanup(shutil.rmtree, os.path.dirname(self.directory))

    def new_competition(self, *arguments: str) -> Program:
        made = self._leaving(Program(own("new_competition"), self.directory, *arguments))
        made.status = made.wait_ended()
        return made

    def helpers_come_back_after_a_crash(self) -> None:
        """Neither the box's nor the client's ends the launch."""
        helpers = [node for node in rosnode.get_node_names() if node.endswith("_shutdown")]
        self.assertEqual(len(helpers), 2, helpers)
        for helper in helpers:
            first = pid_of(helper)
            os.kill(first, signal.SIGKILL)
            wait_until(lambda: pid_of(helper) not in (0, first), f"{helper} is started again")  # noqa: B023

    def others_may_not_read(self, log_dir: str) -> None:
        """Only the owner writes, and only the group reads."""
        modes = {name: os.stat(os.path.join(log_dir, name)).st_mode & 0o777 for name in (".", *os.listdir(log_dir))}
        self.assertEqual((modes.pop("."), modes.pop(JOURNAL)), (0o750, 0o750))
        self.assertLessEqual({"configuration.json", "used_private_ports"}, set(modes))
        for name in os.listdir(os.path.join(log_dir, JOURNAL)):
            modes[name] = os.stat(os.path.join(log_dir, JOURNAL, name)).st_mode & 0o777
        self.assertEqual(modes.pop("door.json"), 0o600)
        self.assertEqual(set(modes.values()), {0o640}, modes)

    def test_from_nothing_to_a_robot_in_a_run(self) -> None:
        made = self.new_competition(*MADE)
        self.assertEqual(made.status, 0, made.text)
        launched = self._leaving(Program(
            "roslaunch", os.path.join(self.directory, "competition.launch"),
            *(f"{name}:={value}" for name, value in NETWORK.items())))
        box = BoxClient()
        self.addCleanup(box.close)
        box.wait_heard()
        self.assertEqual([zone.zone for zone in box.gui.zones], ZONES)
        self.assertEqual((box.gui.addr, box.gui.port), (BROADCAST, str(RSBB_PORT)))
        with open(os.path.join(self.directory, "passwords.yaml"), encoding="utf-8") as file:
            password = yaml.safe_load(file)[TEAM]
        robot = self.robot(TEAM, password=password)
        box.wait_details(ZONES[0], lambda details: not details.off("connect"), "connect is possible")
        self.assertEqual(box.zone(ZONES[0]).team, TEAM)
        box.connect(ZONES[0])
        robot.wait_said()
        self.assertEqual(os.path.dirname(box.zone_details(ZONES[0]).log_file), os.path.join(self.directory, "log"))

        self.helpers_come_back_after_a_crash()
        self.others_may_not_read(os.path.join(self.directory, "log"))
        self.assertEqual(box.zone(ZONES[0]).team, TEAM)
        self.assertEqual(launched.text.count("process[roah_rsbb_core-"), 1, launched.text)

        rospy.wait_for_service("/roah_rsbb_shutdown", LIMIT_S)
        box.ask("exit")
        self.assertEqual(launched.wait_ended(), 0)
        self.assertNotIn("Traceback", launched.text)
        self.assertEqual(launched.warnings, [])
