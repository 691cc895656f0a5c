"""The whole dummy set-up with the referee's window: a task and a functionality benchmark, done by clicks only."""

import json
import os
import pathlib
import unittest
from typing import Any, Callable, Dict

import rospy
from std_msgs.msg import String as StringMsg
from support import gui_testing  # gives this process, and all that it starts, a virtual display
from support.box_case import PACKAGE
from support.programs import Program
from support.robots import BOX, BROADCAST, CONFIG, RSBB_PORT
from support.waiting import happened, wait_until

from roah_rsbb.client.client import Client
from roah_rsbb.client.places import DoorPlaces
from roah_rsbb.model.document import Document
from roah_rsbb.srv import String

INSIDE = str(pathlib.Path(__file__).resolve().parents[1] / "support" / "inside")
LOG_DIR = os.path.join(os.environ.get("ROS_HOME", os.path.expanduser("~/.ros")), "roah_rsbb_test")
ZONE = "Clicks"
DOOR = "Detects the door whose state has changed"
LAUNCH_S = 60.0
COMPLETE = "ManualOperationPanel/0"


class TestClicks(unittest.TestCase):
    def setUp(self) -> None:
        self.window: Dict[str, Any] = {}
        self.box = Client(Document, DoorPlaces().find, happened)
        self.box.start()
        self.addCleanup(self.box.close)
        self.addCleanup(rospy.Subscriber("/test/window", StringMsg, self._on_window).unregister)
        os.environ["PYTHONPATH"] = os.pathsep.join([INSIDE, os.environ["PYTHONPATH"]])
        self.launch = Program(
            "roslaunch", PACKAGE, "roah_rsbb_dummy.launch", "gui:=window", f"rsbb_host:={BROADCAST}",
            f"rsbb_port:={RSBB_PORT}", f"bind_host:={BOX}", f"schedule_file:={CONFIG / 'clicks.yaml'}",
            f"log_dir:={LOG_DIR}", "tablet:=false", "web:=false", "devices:=false", "ground_truth:=false",
            "bell_ring_command:=true", "timeout_ring_command:=true",
        )
        self.addCleanup(self.launch.close)
        self.wait_window("the core is heard", lambda w: w["zone"] == "Quiet", LAUNCH_S)

    def _on_window(self, message: StringMsg) -> None:
        self.window = json.loads(message.data)
        happened()

    def scores(self) -> Dict[str, int]:
        """What the core has of the zone's sheet."""
        document = self.box.document
        return {} if document is None else {item.desc: item.value for item in document.zones[ZONE].items}

    def wait_window(self, what: str, condition: Callable[[Dict[str, Any]], bool], limit_s: float = 30.0) -> None:
        """Wait until the window shows this."""
        wait_until(
            lambda: self.window and condition(self.window),
            lambda: f"{what}; the window shows {self.window}; it printed\n{self.launch.text[-3000:]}", limit_s,
        )

    def click(self, path: str) -> None:
        """Click as soon as a referee could."""
        failures = []

        def clicked() -> bool:
            try:
                rospy.ServiceProxy("/test/click", String)(path)
                return True
            except rospy.ServiceException as error:
                failures[:] = [str(error)]
                return False

        wait_until(clicked, lambda: f"{path} can be clicked: {failures}; the window shows {self.window}")

    def to_phase(self, command: str, phase: str) -> None:
        self.click(f"BenchmarkControlPanel/{command}")
        self.wait_window(f"the phase is {phase}", lambda w: phase in w["phase"])

    def wait_completed(self) -> None:
        """Until the robot has stopped, the window asks before it leaves the run."""
        self.wait_window("it is completed", lambda w: "ENDED: completed" in w["phase"] and w["leaves_at_once"])

    def test_a_task_and_a_functionality_benchmark(self) -> None:
        self.assert_shown()
        self.click(f"OverviewPanel/{ZONE}")
        self.wait_window("the zone is chosen", lambda w: w["zone"] == ZONE and "HGTKMH" in w["event"])
        for button, event in (("next", "STB"), ("previous", "HGTKMH")):
            self.click(f"BenchmarkControlPanel/{button}")
            self.wait_window("the event is shown", lambda w, e=event: e in w["event"])
        self.to_phase("connect", "CONNECTED")
        self.click(f"ScoringPanel/{DOOR}")
        wait_until(lambda: self.scores().get(DOOR) == 1, lambda: f"the core has the score, in {self.scores()}")
        self.click("BenchmarkControlPanel/start")
        self.wait_completed()
        self.to_phase("disconnect", "NOT CONNECTED")

        # The box went to the zone's next event by itself.
        self.wait_window("the next event is shown", lambda w: "STB" in w["event"])
        self.to_phase("connect", "CONNECTED")
        self.to_phase("start", "PAUSED: manual operation")
        for request in ("First Manual Operation", "Last Manual Operation"):
            # The panel comes to the front by itself.
            self.wait_window(request, lambda w, r=request: w["operation"] == r and w["operation_seen"])
            head = f"☛ DO NOW: {ZONE}   ▶ RUNNING: {ZONE}"
            self.wait_window("the overview says so", lambda w, h=head: w["head"] == h)
            self.click(COMPLETE)
            self.wait_window("it is done", lambda w, r=request: w["operation"] != r)
        self.wait_completed()
        self.assertIn("First Manual Operation", self.window["log"])
        # Scoring comes back to the front by itself.
        self.wait_window("the panel is at the back again", lambda w: not w["operation_seen"])
        self.to_phase("disconnect", "NOT CONNECTED")

    def assert_shown(self) -> None:
        """The window of that other process is on the screen."""
        screen = gui_testing.app.primaryScreen()

        def colours() -> int:
            image = screen.grabWindow(0).toImage()
            points = ((x, y) for x in range(20, image.width(), 40) for y in range(20, image.height(), 40))
            return len({image.pixel(x, y) for x, y in points})

        gui_testing.wait_until(lambda: colours() >= 5, "there is a window on the screen")
