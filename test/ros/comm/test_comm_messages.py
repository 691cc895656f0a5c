"""The comm node's reports of problems: silence, passwords, impostors of the robot or the box."""

from rosgraph_msgs.msg import Log
from std_msgs.msg import String as StringMsg
from support.box_case import TABLET
from support.comm_case import ALWAYS, NUMBERS, SAYS_PREPARE, ChannelCase
from support.robots import wire
from support.waiting import wait_until

from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.protocol import BoxState


class TestTroubles(ChannelCase):
    """Problems are reported with their remedy."""

    def test_a_box_that_falls_silent(self) -> None:
        self.begin("HGTKMH")
        port = self.box.beacon_message.benchmarking_teams[0].rsbb_port
        self.box.close_channel()
        # Nothing is sent for 5 s, on no channel.
        self.wait_logged(
            Log.WARN, f"the box at 127.0.0.1 has sent nothing on port {port} for 5 s: check that no firewall blocks "
            "this port")
        self.wait_logged(
            Log.WARN, "no beacon of a box for 5 s: check that the box runs on this network and public port, and that "
                      "no "
            "firewall blocks its broadcasts")
        self.assertEqual(self.benchmarks.messages[-1].benchmark, NUMBERS["HGTKMH"], "the run is not given up")
        self.box.listen(port)
        self.box.beacon(port)
        self.box.send("HGTKMH", BoxState.STOP)
        self.wait_logged(Log.INFO, f"the box at 127.0.0.1 is received again on port {port}")
        self.wait_logged(Log.INFO, "the box at 127.0.0.1 is received")

    def test_a_wrong_password(self) -> None:
        self.box.close()
        self.box = self.new_box(password="another one")
        port = self.new_port()
        self.box.wait_robot()
        self.box.listen(port)
        self.box.beacon(port)
        wait_until(lambda: self.box.complaints, "the robot sends what the box cannot read")
        self.box.send("HGTKMH", BoxState.STOP)
        self.wait_logged(
            Log.WARN, f"messages of the box at 127.0.0.1 on port {port} cannot be decrypted: this robot's password of "
            "team Alpha differs from the one in the box's passwords file")
        self.assertEqual(self.benchmarks.messages[-1].benchmark, 0)

    def test_another_robot_of_the_same_name(self) -> None:
        twin = self.participant(TABLET)
        twin.send(pb.RobotBeacon(team_name="Alpha", robot_name="Another", time=wire(0)))
        twin.send(pb.RobotBeacon(team_name="Alpha", robot_name="Robot", time=wire(0)))
        self.wait_logged(
            Log.WARN, f"another robot at {TABLET} also has the name Robot of team Alpha: the box cannot distinguish "
            "them. Stop one of them, or change its robot name")
        self.assertEqual(sum("also has the name" in text for text in self.logged(Log.WARN)), 1)

    def test_another_box(self) -> None:
        self.box.beacon()
        other = self.new_box(host=TABLET)
        other.beacon()
        self.wait_logged(Log.WARN, f"there is another box at {TABLET} besides the one at 127.0.0.1")

    def test_an_unknown_benchmark(self) -> None:
        """It has a name, and everything that a robot can use."""
        names = self.heard("benchmark/name", StringMsg)
        self.begin("HWV")
        self.box.send("HNEW", BoxState.PREPARE)
        self.wait_logged(Log.INFO, "The box runs benchmark 'HNEW', which is not one of the shipped ones")
        self.wait_benchmark(255)
        names.wait_last(lambda m: m.data == "HNEW", "its name")
        self.wait_said(SAYS_PREPARE)
        strings = {"notifications", "activation_event", "visitor", "final_command"}
        self.assertLessEqual({*strings, "devices/dimmer/set", "tablet/map", "end_prepare"}, self.services)
        self.assertEqual(self.published["goal/text"], "std_msgs/String")
        self.box.beacon()  # the run is over
        self.wait_benchmark(0)
        self.assertEqual((self.services, self.published), (set(), ALWAYS))
        self.begin("HWV")
        self.assertEqual([m.benchmark for m in self.benchmarks.messages[-4:]], [NUMBERS["HWV"], 255, 0, NUMBERS["HWV"]])
