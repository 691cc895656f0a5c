"""The comm node's start, or its report of why it cannot start."""

import os
import pathlib
import shutil
import tempfile
from typing import Dict

import rosgraph
import rospy
from support.box_case import NetworkCase
from support.comm_case import reported_with
from support.programs import Program, own
from support.robots import BROADCAST, RSBB_PORT
from support.waiting import wait_until

# Not in any other file.
SECRET = "qWq7-never-shown"


class TestParameters(NetworkCase):
    """A node that cannot start reports all errors in its parameters, and ends."""

    def node(self, program: str, name: str, **params: str) -> Program:
        """A node with a unique name."""
        usual = {"rsbb_host": BROADCAST, "rsbb_port": str(RSBB_PORT), "bind_host": "127.0.1.1"}
        chosen: Dict[str, str] = {**(usual if program == "comm" else {}), **params}
        return self._leaving(Program(own(program), f"__name:={name}",
                                     *(f"_{key}:={value}" for key, value in chosen.items())))

    def file(self, name: str, text: str, mode: int) -> str:
        """A new file; returns its path."""
        folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, folder)
        path = os.path.join(folder, name)
        pathlib.Path(path).write_text(text, encoding="utf-8")
        os.chmod(path, mode)
        return path

    def test_errors_are_reported_at_once(self) -> None:
        nodes = {
            self.node("comm", "nameless", rsbb_key="key"): ["/nameless/team_name: found nothing, expected a text"],
            self.node("comm", "empty", team_name="''", rsbb_key="key"): ["/empty/team_name: found '', expected a text"],
            self.node("comm", "wrong", team_name="A", rsbb_key="key", rsbb_port="70000", rsbb_cypher="des", loss="2"): [
                "/wrong/rsbb_port: found 70000, expected a whole number from 1 to 65535",
                "/wrong/rsbb_cypher: found 'des', expected one of aes-128-ecb, aes-128-cbc, aes-256-ecb, aes-256-cbc",
                "/wrong/loss: found 2, expected a number from 0 to 1",
            ],
            self.node("comm", "nowhere", team_name="A", rsbb_key="key", bind_host="127.0.0.300"): ["127.0.0.300"],
            self.node("comm", "whereto", team_name="A", rsbb_key="key", rsbb_host="the box"): ["the box"],
            self.node("dummy_glue", "dummy", crash_in="stop", never_end="2"): [
                "/dummy/crash_in: found 'stop', expected one of , prepare, execute",
                "/dummy/never_end: found 2, expected true or false",
            ],
        }
        for node, texts in nodes.items():
            with reported_with(texts[0]):
                self.assertEqual(node.wait_ended(), 1, node.text)
                for text in texts:
                    self.assertIn(text, node.text)
                self.assertEqual(node.text.count("[FATAL]"), len(texts), node.text)
                self.assertNotIn("Traceback", node.text)

    def test_without_a_key_it_asks_for_it_and_continues(self) -> None:
        node = self.node("comm", "keyless", team_name="KeylessTeam")
        node.wait_printed("[ERROR]")
        node.wait_printed("Set the parameter rsbb_key_file to a file with the team's password from the organisers")
        node.wait_printed("Robot Robot of team KeylessTeam looks for the RSBB on 127.255.255.255")
        wait_until(lambda: "/keyless" in str(rosgraph.Master("/test").getSystemState()[0]), "it publishes its topics")

    def test_the_password_is_in_a_file(self) -> None:
        file = self.file("key.txt", SECRET + "\n", 0o640)
        node = self.node("comm", "filed", team_name="FiledTeam", rsbb_key="another", rsbb_key_file=file)
        node.wait_printed("of team FiledTeam looks for the RSBB")
        self.assertEqual(len(node.warnings), 1, node.text)
        self.assertIn(f"Other users of this computer can read the password in {file} (mode 0640): chmod 600 {file}",
                      node.text)
        os.chmod(file, 0o600)
        private = self.node("comm", "private", team_name="PrivateTeam", rsbb_key_file=file)
        private.wait_printed("of team PrivateTeam looks for the RSBB")
        self.assertEqual(private.warnings, [])

    def test_a_password_file_that_cannot_be_read(self) -> None:
        for name, file, text in (
            ("missing", "/nowhere/key.txt", "cannot read the password file /nowhere/key.txt: No such file"),
            ("blank", self.file("blank.txt", "\n", 0o600), "blank.txt is empty, expected the password"),
        ):
            node = self.node("comm", name, team_name="A", rsbb_key_file=file)
            self.assertEqual(node.wait_ended(), 1, node.text)
            self.assertIn(text, node.text)

    def test_a_launch_file_gives_the_password_away_to_no_log(self) -> None:
        """The launch files of the original package and ours, as a team includes them."""
        for package, name in (("roah_rsbb", "robot_comm.launch"), ("roah_rsbb_comm_ros", "test.launch")):
            arguments = {"team_name": "Launched", "rsbb_key": SECRET, "rsbb_host": BROADCAST, "rsbb_port": RSBB_PORT,
                         "bind_host": "127.0.1.1"}
            given = "".join(f'<arg name="{key}" value="{value}"/>' for key, value in arguments.items())
            launch = self.file(name, f'<launch><include file="$(find {package})/launch/{name}">{given}</include>'
                                     "</launch>", 0o600)
            launched = self._leaving(Program("roslaunch", launch))
            launched.wait_printed("of team Launched looks for the RSBB")
            self.assertTrue(rospy.get_param("/roah_rsbb_comm/rsbb_key").endswith(SECRET))
            launched.close()
            self.assertNotIn(SECRET, launched.text)
            logs = [path for path in pathlib.Path(os.environ["ROS_LOG_DIR"]).rglob("*.log") if path.is_file()]
            self.assertTrue([path for path in logs if path.name.startswith("roslaunch-")], logs)
            self.assertEqual([path for path in logs if SECRET in path.read_text(errors="replace")], [])
            self.assertIn("Everybody on this ROS master can read the password in the parameter rsbb_key", launched.text)

    def test_numbers_are_names_too(self) -> None:
        """rosrun and roslaunch make a number of 1234."""
        node = self.node("comm", "numbers", team_name="1234", robot_name="56", rsbb_key="789")
        node.wait_printed("Robot 56 of team 1234 looks for the RSBB")
        self.assertNotIn("[ERROR]", node.text)
