"""dummy_robot.launch, as a program of the test: a comm node, and a dummy that uses its topics and services."""

from support.box_case import PACKAGE
from support.programs import Program
from support.robots import BROADCAST, PASSWORDS, RSBB_PORT, host_of


def launch_dummy(team: str, **arguments: object) -> Program:
    """The dummy robot of a team; there is one at a time, as each has the same names in ROS."""
    usual = {
        "team_name": team, "robot_name": "Dummy", "rsbb_key": PASSWORDS[team], "rsbb_host": BROADCAST,
        "rsbb_port": RSBB_PORT, "bind_host": host_of(team), "prepare_duration": 0.3, "execute_duration": 1.0,
    }
    given = (f"{argument}:={value}" for argument, value in {**usual, **arguments}.items())
    return Program("roslaunch", PACKAGE, "dummy_robot.launch", *given)
