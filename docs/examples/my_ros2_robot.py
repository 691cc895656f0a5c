#!/usr/bin/env python3
"""A short robot with ROS 2: the client without ROS, with prepare and execute as tasks of a ROS 2 executor.

Not run against ROS 2: the tests of this page use an executor of their own with rclpy's methods.

    ROAH_RSBB_KEY=PASSWORD python3 my_ros2_robot.py MyTeam 192.168.1.255
"""

import asyncio
import os
import sys
import threading

from roah_rsbb.robot.client import Behaviour, RobotClient


class InExecutor(Behaviour):
    """Runs the methods of `robot` in an rclpy executor, so that they can use all of ROS 2.

    `robot` has `prepare(benchmark)` and `execute(benchmark, goal)`, which may be coroutines, and `stop(why)`. The
    executor's threads call the first two. The client's thread calls `stop`, at once, also while they block: it must
    only set events or publish.
    """

    def __init__(self, executor, robot):
        self._executor, self._robot = executor, robot

    async def prepare(self, benchmark):
        await self._run(self._robot.prepare, benchmark)

    async def execute(self, benchmark, goal):
        return await self._run(self._robot.execute, benchmark, goal)

    def stop(self, why):
        self._robot.stop(why)

    async def _run(self, method, *arguments):
        loop = asyncio.get_running_loop()
        ended = asyncio.Event()
        task = self._executor.create_task(method, *arguments)
        task.add_done_callback(lambda _: loop.call_soon_threadsafe(ended.set))
        try:
            await ended.wait()
        except asyncio.CancelledError:
            task.cancel()  # a coroutine is not resumed; `stop` ends what blocks
            raise
        if task.exception() is not None:
            raise task.exception()
        return task.result()


class MyRobot:
    def __init__(self, node):
        self.node = node
        self.stopped = threading.Event()

    def prepare(self, benchmark):
        self.stopped.clear()
        self.node.get_logger().info(f"{benchmark}: preparing")

    def execute(self, benchmark, goal):
        self.node.get_logger().info(f"{benchmark}: executing {goal}")
        self.stopped.wait(1.0)  # instead of working; HOPF and HPPF return a result: see my_robot.py

    def stop(self, why):
        self.stopped.set()
        self.node.get_logger().info(f"stopped: {why}")  # stop the motors at once


def main():
    import rclpy
    from rclpy.executors import MultiThreadedExecutor

    rclpy.init()
    node = rclpy.create_node("my_robot")
    executor = MultiThreadedExecutor()
    executor.add_node(node)
    client = RobotClient(sys.argv[1], os.environ.get("ROAH_RSBB_KEY", ""), InExecutor(executor, MyRobot(node)),
                         rsbb_host=sys.argv[2])
    client.messages_saved = 1  # offline data is being recorded: the box stops a run without it
    threading.Thread(target=asyncio.run, args=(client.run(),), daemon=True).start()
    executor.spin()


if __name__ == "__main__":
    main()
