"""HSUF: robots of several teams at once, over real sockets."""

import pathlib

import rospy
from support.box_case import LISTENER, BoxCase
from support.referee_program import Referee
from support.robots import Robot, listed
from support.waiting import wait_until

from roah_rsbb.protocol import BoxState, RobotState

STOP, PREPARE, WAITING_RESULT = BoxState.STOP, BoxState.PREPARE, BoxState.WAITING_RESULT
TEAMS = ("Alpha", "Beta", "Gamma")


class AllRobotsCase(BoxCase):
    """A test case with a robot of each team."""

    def robots_of(self, *teams: str, **how) -> list:
        return [self.robot(team, **how) for team in teams]

    def connected(self, zone: str, robots: list) -> list:
        """Connect these robots and no other ones; returns their ports."""
        self.box.wait_text(zone, f"{len(robots)} robots ready to accept connection")
        self.box.connect(zone)
        listener = self.participant(LISTENER)
        listener.wait_beacon(lambda b: len(listed(b)) == len(robots), "the beacon lists all robots")
        ports = {team: port for team, _, port in listed(listener.beacon)}
        self.box.wait_text(zone, f"Robots connected: {len(robots)} / ready: {len(robots)}")
        return [ports[robot.team] for robot in robots]

    def wait_counts(self, zone: str, preparing: int, executing: int, stopped: int) -> None:
        """Wait until the referee sees these numbers of robots in each state."""
        self.box.wait_text(zone, f"Robots preparing: {preparing} / executing: {executing} / stopped: {stopped}")
        counts = (preparing, executing, stopped)
        self.box.wait_details(
            zone, lambda d: (d.preparing, d.executing, d.stopped) == counts,
            "the details count the same",
        )

    def wait_doing(self, zone: str, robot: Robot, doing: str) -> None:
        """Wait until the details say what a robot is doing."""
        line = f"{robot.name} of team {robot.team}: {doing}"
        self.box.wait_details(zone, lambda d: any(r.startswith(line) for r in d.robots), line)


class TestOneFails(AllRobotsCase):
    """One robot's failure is not the others'."""

    def test_one_is_killed_and_the_others_complete(self) -> None:
        box, zone = self.box, "All"
        box.wait_timeouts_heard()
        self.killed, *self.others = robots = self.robots_of(*TEAMS, prepares=False)
        ports = self.connected(zone, robots)
        self.assertEqual(len(set(ports)), 3)
        details = box.zone_details(zone)
        self.assertEqual((details.robot_name, details.port, len(details.robots)), ("3 robots", ports[0], 3))
        box.start(zone)
        for robot in robots:
            robot.wait_did("prepare HSUF")
        self.wait_counts(zone, 3, 0, 0)
        for robot in robots:
            robot.let("prepare")
            robot.wait_did("execute HSUF")
        self.wait_counts(zone, 0, 3, 0)
        self.one_is_killed(zone)
        self.others_complete(zone)
        self.all_is_over(zone, ports)

    def one_is_killed(self, zone: str) -> None:
        self.killed.close()
        self.box.wait_text(zone, "WARNING: Robot of team Alpha: No message from the robot for")
        self.box.wait_details(
            zone, lambda d: d.phase == "running" and [w.split(":")[0] for w in d.warnings] == ["Robot of team Alpha"],
            "the run continues, and only that robot is silent",
        )

    def others_complete(self, zone: str) -> None:
        for number, robot in enumerate(self.others):
            robot.request("notify", f"heard by {robot.team}")
            robot.wait_said()
            robot.let("execute")
            robot.wait_state(RobotState.STOP)
            self.wait_doing(zone, robot, "completed")
            self.wait_counts(zone, 0, 2 - number, 1 + number)
            line = f"Robot of team {robot.team}: notifications: heard by {robot.team}"
            self.box.wait_zone(zone, lambda z, line=line: line in z.online_data, "online data have the robot's name")

    def all_is_over(self, zone: str, ports: list) -> None:
        box = self.box
        box.wait_details(zone, lambda d: (d.phase, d.end_reason) == ("ended", "timeout"), "time ends the run", 60.0)
        wait_until(lambda: box.timeouts, "/timeout is published")
        self.wait_counts(zone, 0, 0, 3)
        box.wait_text(zone, "Stopped due to timeout (2 completed, 1 out of time)")
        box.command("disconnect", zone)
        box.wait_phase(zone, "idle")
        self.assertEqual(box.timeouts, 1)
        for team in TEAMS:
            log = self.read_log(self.log_file(team))
            states = [STOP, PREPARE, WAITING_RESULT, STOP]
            self.assertEqual(log.values("/rsbb_log/rsbb_state"), states, team)
            said = [] if team == "Alpha" else [f"heard by {team}"]
            self.assertEqual(log.values("/notification"), said)

    @staticmethod
    def log_file(team: str) -> str:
        """The log of a robot's part, which has its name."""
        folder = pathlib.Path(rospy.get_param("/roah_rsbb_core/log_dir"))
        path, = folder.glob(f"online_log_*_{team}_Robot_round1_run1_*.bag")
        return str(path)


class TestStop(AllRobotsCase):
    """The referee's stop is for all."""

    def test_stop_ends_all_and_all_may_start_again(self) -> None:
        box, zone = self.box, "Again"
        robots = self.robots_of(*TEAMS)
        self.connected(zone, robots)
        box.start(zone)
        for robot in robots:
            robot.wait_did("execute HSUF")
        box.command("stop", zone)
        for robot in robots:
            robot.wait_did("stop")
            robot.wait_state(RobotState.STOP)
        box.wait_details(zone, lambda d: (d.phase, d.end_reason) == ("ended", "stopped"), "the run is stopped")
        box.start(zone)
        for robot in robots:
            robot.wait_did("execute HSUF", times=2)
            robot.let("execute")
        box.wait_details(zone, lambda d: (d.phase, d.end_reason) == ("ended", "completed"), "all have completed")
        box.wait_text(zone, "All robots have ended (3 completed)")
        box.command("disconnect", zone)
        box.wait_zone(zone, lambda z: z.code == "HGTKMH", "the next event follows")


class TestScript(AllRobotsCase):
    """A referee at the terminal."""

    def test_robots_out_of_skew_are_named_and_the_others_run(self) -> None:
        robots = self.robots_of(*TEAMS[:2])
        self.robot("Gamma", skew=0.5)
        self.box.wait_text("Script", "WARNING: Robot of team Gamma cannot take part: Clock skew of the robot is +0.")
        self.box.wait_text("Script", "2 robots ready to accept connection: Robot of team Alpha, Robot of team Beta")
        run = Referee("run", "Script", "--json")
        self.addCleanup(run.close)
        for robot in robots:
            robot.wait_did("execute HSUF")
            robot.let("execute")
        result = run.event("result")
        self.assertEqual(run.wait_ended(), 0)
        self.assertEqual((result["ok"], result["end_reason"], result["robot"]), (True, "completed", "2 robots"))
