#!/usr/bin/env python3
"""A short robot that takes part in every run. Ctrl-C ends it.

    ROAH_RSBB_KEY=PASSWORD python3 my_robot.py MyTeam 192.168.1.255
"""

import argparse
import asyncio
import logging
import os

from roah_rsbb.robot.client import Behaviour, RobotClient
from roah_rsbb.robot.goals import HopfResult, HppfResult, Pose

WORK_S = 1.0  # seconds that this robot waits instead of working


class MyRobot(Behaviour):
    async def prepare(self, benchmark):
        print(f"{benchmark}: preparing", flush=True)
        self.client.messages_saved += 1  # offline data is being recorded: the box stops a run without it
        await asyncio.sleep(WORK_S)

    async def execute(self, benchmark, goal):
        print(f"{benchmark}: executing {goal}", flush=True)
        if benchmark == "HWV":
            self.client.notify("going to the door")
        await asyncio.sleep(WORK_S)
        if benchmark == "HPFF":
            await asyncio.Event().wait()  # follow the person until the box stops us
        return {  # None: the other benchmarks have no result
            "HOPF": HopfResult("cups", "red_cup", Pose(0.42, 0.17, 1.57)),
            "HPPF": HppfResult("Annie", Pose(1.2, 0.8, 3.14)),
        }.get(benchmark)

    def stop(self, why):
        print(f"stopped: {why}", flush=True)  # stop the motors at once


def main():
    parser = argparse.ArgumentParser(description="A short robot. Set its password in the variable ROAH_RSBB_KEY.")
    parser.add_argument("team", help="name of the team, as in the schedule")
    parser.add_argument("host", help="the network's broadcast address ('ip -4 addr' shows it as brd), or the box's")
    parser.add_argument("--port", type=int, default=6666, help="public UDP port (default: %(default)s)")
    parser.add_argument("--bind", default="0.0.0.0", help="own address, if box and robot share a machine")
    given = parser.parse_args()
    logging.basicConfig(level=logging.INFO, format="%(message)s")
    client = RobotClient(given.team, os.environ.get("ROAH_RSBB_KEY", ""), MyRobot(), rsbb_host=given.host,
                         rsbb_port=given.port, bind_host=given.bind)
    try:
        asyncio.run(client.run())
    except (ValueError, OSError) as error:
        parser.exit(1, f"my_robot: {error}\n")
    except KeyboardInterrupt:
        pass


if __name__ == "__main__":
    main()
