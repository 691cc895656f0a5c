"""A benchmark that the comm node does not know."""

from rosgraph_msgs.msg import Log
from std_msgs.msg import String as StringMsg
from support.comm_case import ALWAYS, NUMBERS, SAYS_PREPARE, ChannelCase

from roah_rsbb.protocol import BoxState


class TestUnknown(ChannelCase):
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
