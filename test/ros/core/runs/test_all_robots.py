"""HSUF: robots of several teams at once, over real sockets."""

from support.box_case import LISTENER, BoxCase
from support.robots import listed

from roah_rsbb.protocol import RobotState

TEAMS = ("Alpha", "Beta", "Gamma")


class TestStop(BoxCase):
    """The referee's stop is for all."""

    def test_stop_ends_all_and_all_may_start_again(self) -> None:
        box, zone = self.box, "Again"
        robots = [self.robot(team) for team in TEAMS]
        box.wait_text(zone, "3 robots ready to accept connection")
        box.connect(zone)
        listener = self.participant(LISTENER)
        listener.wait_beacon(lambda b: len(listed(b)) == len(robots), "the beacon lists all robots")
        box.wait_text(zone, "Robots connected: 3 / ready: 3")
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
