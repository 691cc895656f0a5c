"""Node dummy_robots: dummy robots of different teams on one machine, in one process.

Each robot has its own loopback address. Teams and passwords come from the box's files, so that no password appears in a
launch file, a parameter or the list of processes.

Parameters (private): robots (number of robots), execute_duration (s, for each goal), rsbb_host, rsbb_port, and the
box's files: benchmarks_file, schedule_file, passwords_file.
"""

import asyncio
import ipaddress

import rospy

from roah_rsbb.ground.params import BadParams
from roah_rsbb.robot.client import RobotClient
from roah_rsbb.robot.dummy import DummyOptions, dummy_client
from roah_rsbb.ros.node import NodeParams, RosLoop, run_node
from roah_rsbb.ros.team.dummy_glue import log_to_ros
from roah_rsbb.rulebook.benchmarks import teams_of
from roah_rsbb.rulebook.config import ConfigErrors, load

# The box has 127.0.0.1.
FIRST_HOST = ipaddress.IPv4Address("127.0.0.2")
MOST = 200


class DummyRobotsNode:
    """The robots, from the node's parameters to its end. Raises BadParams at the start."""

    def __init__(self) -> None:
        log_to_ros()
        params = NodeParams()
        count = params.whole("robots", 1, 1, MOST)
        options = DummyOptions(execute_duration=params.number("execute_duration", DummyOptions.execute_duration))
        host, port = params.text("rsbb_host", "127.255.255.255"), params.whole("rsbb_port", 6666, 1, 65535)
        files = [params.path(f"{name}_file") for name in ("benchmarks", "schedule", "passwords")]
        params.done()
        try:
            config, _ = load(*files)  # the core reports the warnings
        except ConfigErrors:
            raise BadParams("no dummy robots: the configuration is invalid, see the errors of the core") from None
        teams = teams_of(config)
        if count > len(teams):
            rospy.logwarn("%d dummy robots instead of %d: %s has no more teams", len(teams), count, files[2])
        self._status = 0
        self._ros = RosLoop()
        for number, team in enumerate(teams[:count]):
            bind_host = str(FIRST_HOST + number)
            self._add(team, bind_host, dummy_client(
                team, config.passwords[team], options=options, rsbb_host=host, rsbb_port=port, bind_host=bind_host,
                name_in_log=team if count > 1 else "",
            ))

    def run(self) -> int:
        """Run until shut down, or until a robot ends; returns the exit status."""
        self._ros.run()
        self._ros.close()
        return self._status

    def _add(self, team: str, bind_host: str, client: RobotClient) -> None:
        rospy.loginfo("A dummy robot of team %s at %s", team, bind_host)
        self._ros.loop.create_task(client.run()).add_done_callback(lambda task: self._ended(team, task))

    def _ended(self, team: str, task: asyncio.Task) -> None:
        error = None if task.cancelled() else task.exception()
        if error is not None:
            rospy.logfatal("the dummy robot of team %s ended: %s", team, error)
            self._status = 1
            self._ros.stop("a dummy robot ended")


def main() -> None:
    """Entry point of the node."""
    run_node("dummy_robots", __doc__, DummyRobotsNode, disable_signals=True)
