"""A comm node, and a dummy that uses its topics and services: as two programs, or as dummy_robot.launch."""

import json
import os
from typing import Dict, List

from roah_rsbb.ground import durable
from support.box_case import PACKAGE
from support.programs import Program, own
from support.robots import BROADCAST, PASSWORDS, RSBB_PORT, host_of

# Printed when its topics are offered. A program with plain rospy starts after it: rospy can lose a publisher that
# starts in the moment in which a subscriber registers (roah_rsbb.ros.connections).
COMM_IS_READY = "looks for the RSBB"


def _comm(team: str) -> Dict[str, object]:
    return {"team_name": team, "robot_name": "Dummy", "rsbb_key_file": key_file(team), "rsbb_host": BROADCAST,
            "rsbb_port": RSBB_PORT, "bind_host": host_of(team), "clock_offset": 0.0, "loss": 0.0}


def key_file(team: str) -> str:
    """A file with the team's password, which only this user can read; returns its path."""
    path = os.path.join(os.environ["ROS_HOME"], f"{team}_key.txt")
    durable.write_file(path, PASSWORDS[team].encode("utf-8"))
    return path


def _dummy() -> Dict[str, object]:
    return {"prepare_duration": 0.3, "execute_duration": 1.0, "never_end": False, "crash_in": "",
            "save_nothing": False}


def comm_node(team: str, **arguments: object) -> Program:
    """The comm node of a team."""
    return _node("comm", "roah_rsbb_comm", {**_comm(team), "generation": "2020", **arguments})


def dummy(**arguments: object) -> Program:
    """The dummy behind the comm node that the test's launch file starts."""
    return _node("dummy_glue", "dummy_robot", {**_dummy(), **arguments})


def _node(program: str, name: str, params: Dict[str, object]) -> Program:
    given = (f"_{param}:={json.dumps(value)}" for param, value in params.items())  # a password may look like YAML
    return Program(own(program), f"__name:={name}", *given)


class DummyRobot:
    """The dummy robot of a team. There is one at a time, because each has the same names in ROS.

    All parameters are set each time: the master keeps those of the robot before.
    """

    def __init__(self, team: str, **arguments: object) -> None:
        comm = {name: arguments.pop(name) for name in list(arguments) if name in _comm(team)}
        self.comm = comm_node(team, **comm)
        self._dummy = dummy(**arguments)

    def close(self) -> None:
        """End both programs."""
        self._dummy.close()
        self.comm.close()

    @property
    def text(self) -> str:
        """All that both printed so far."""
        return f"{self.comm.text}\n{self._dummy.text}"

    @property
    def warnings(self) -> List[str]:
        """The warnings of both: see `Program.warnings`."""
        return [*self.comm.warnings, *self._dummy.warnings]

    def wait_printed(self, text: str, times: int = 1) -> None:
        """Wait until the dummy has printed a text."""
        self._dummy.wait_printed(text, times)


def launch_dummy(team: str, **arguments: object) -> Program:
    """The dummy robot of a team by its launch file, which restarts what ends."""
    given = {**_comm(team), "prepare_duration": 0.3, "execute_duration": 1.0, **arguments}
    return Program("roslaunch", PACKAGE, "dummy_robot.launch", *(f"{name}:={value}" for name, value in given.items()))
