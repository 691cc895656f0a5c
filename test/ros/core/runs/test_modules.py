"""The core with modules that come and go, or send nonsense."""

import math

import rospy
from support.fakes.modules import ModulesCase

from roah_rsbb.model.modules import Progress, Request, RequestKind
from roah_rsbb.msg import ModulesState
from roah_rsbb.protocol import RobotState
from roah_rsbb.robot.goals import Pose

REFEREE = RequestKind.REFEREE


class TestModulesThatComeAndGo(ModulesCase):
    def test_a_run_without_its_module(self) -> None:
        robot = self.robot("Zeta")
        self.box.connect("Gone")
        off = "Benchmarking module not connected: nothing drives HGMF"
        self.box.wait_details(
            "Gone", lambda d: d.robot_state == "STOP" and len(d.off("start")) == 1 and off in d.off("start")[0],
            "the robot is heard, and start is off for the module only",
        )
        self.assertIn("nothing drives HGMF", self.box.refusal("start", "Gone"))
        problem = "HGMF.yaml:7: found x; expected y"
        self.fbm = self.modules("HGMF", problems=(problem,))
        self.box.wait_details(
            "Gone", lambda d: list(d.off("start")) == [problem],
            "start is off for what is wrong")
        self.fbm.drives("HGMF")
        self.box.start("Gone")
        self.fbm.wait_attempt("Gone")

        self.fbm.asks("Gone", goal="[0.1, 0.2, 3]", timeout=100.0)
        robot.wait_did("execute HGMF")
        self.assertEqual((robot.goals[0].object_id, robot.goals[0].pose), (3, Pose(0.1, 0.2, 0.0)))
        self.fbm.close()
        details = self.box.wait_details("Gone", lambda d: d.held and d, "the run is held")
        self.assertIn("Benchmarking module not connected: the run is paused", details.warnings[0])
        left = self.box.zone("Gone").timer
        robot.let("execute")
        self.box.wait_zone("Gone", lambda z: "Goal completed by the robot" in z.log, "the robot's result is taken")
        robot.wait_state(RobotState.RESULT_TX)
        self.assertGreater((self.box.zone("Gone").timer - left).to_sec(), 400, "of the run, no more of the goal")

        self.fbm = self.modules("HGMF", node="another process")
        run = self.fbm.wait_run("Gone", lambda run: run.steps[-1].outcome, "everything is published again")
        self.assertEqual(len(run.steps), 1)
        self.box.wait_details("Gone", lambda d: not d.held, "the run continues")
        self.fbm.says("Gone", request=run.steps[0].request)
        self.fbm.asks("Gone", REFEREE, text="next")
        self.wait_asked("Gone", "next")

    def test_nonsense_on_the_topic(self) -> None:
        self.fbm = self.modules("STB")
        self.robot("Eta")
        self.started("Late")
        good = Progress(self.fbm.runs["Late"].run, 1, Request(1, RequestKind.GOAL, "go", pose=(1.0, 2.0, 3.0)))
        # From the same process, so it is connected.
        rospy.Publisher("/modules/state", ModulesState, queue_size=10).publish(ModulesState(node="empty"))
        self.fbm.send(good._replace(request=good.request._replace(pose=(math.nan, 0.0, 0.0))))
        self.box.wait_text("Late", "x, y and theta must be finite numbers")
        self.wait_phase("Late", "ended", "module_failed")
        self.box.start("Late")
        self.fbm.wait_attempt("Late", 2)
        self.fbm.send(good._replace(attempt=2, request=good.request._replace(pose=None, goal="x" * 900)))
        self.box.wait_text("Late", "its goal takes 900 bytes")
