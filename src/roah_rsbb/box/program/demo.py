"""A demonstration in one program, without ROS, a network or a configuration: a box, and dummy robots. With the folder
of a competition, it is a rehearsal: a dummy robot of each of its teams, and nothing in the folder is changed.

The organiser's page opens in a browser. Choose the zone, connect, start, and mark scores while the dummy robot works.
With --scripted, and where there is no browser, a scripted referee takes a dummy robot through a task benchmark and a
functionality benchmark instead. The exit status then says whether both runs were completed.
"""

import argparse
import asyncio
import logging
import os
import shlex
import shutil
import socket
import subprocess
import sys
from typing import Dict, List, Optional

from roah_rsbb.box import settings as settings_of
from roah_rsbb.box.program.main import log_to_terminal, serve
from roah_rsbb.client.places import OWN_VARIABLE
from roah_rsbb.comm.peer import MemoryAir
from roah_rsbb.comm.sockets import LOOPBACK_BROADCAST
from roah_rsbb.ground.arguments import Parser, called, number, without_ros
from roah_rsbb.ground.durable import close_to_others, write_file
from roah_rsbb.ground.installed import shipped_folder
from roah_rsbb.ground.params import BadParams

ZONE = "Testing TestingTeam"
# For each benchmark, further options of the scripted referee.
RUNS: Dict[str, List[str]] = {
    "HGTKMH": ["--score", "door=1", "--score", "moved furniture=2"],
    "HNF": ["--operations", "automatic"],
}
BOX_HOST = "127.0.0.1"
FIRST_WEB_PORT = 8081
WAIT_FOR_ROBOT_S = 40
LOOK_S = 0.05
MOST_ROBOTS = 200


def _parser() -> argparse.ArgumentParser:
    parser = Parser(called("demo"), str(__doc__).strip())
    parser.add_argument("folder", nargs="?", default="", metavar="FOLDER",
                        help="rehearse the competition in this folder: with a copy of it")
    parser.add_argument("--scripted", action="store_true", help="use the scripted referee")
    parser.add_argument("--robots", type=int, choices=range(1, MOST_ROBOTS + 1), metavar="N",
                        help="number of dummy robots, each of another team (default: 1; in a rehearsal: all teams)")
    parser.add_argument("--duration", type=number(0, 1e6), default=3.0, metavar="S",
                        help="seconds that a dummy robot takes to prepare, and for each goal (default: %(default)s)")
    parser.add_argument("--log-dir", default=os.path.join("~", ".roah_rsbb", "demo"), metavar="DIR",
                        help="where the runs are kept (default: %(default)s)")
    return parser


def _free_port(first: int) -> int:
    """Return a TCP port that no program uses: the first one from `first`, if one of some is free."""
    for port in range(first, first + 100):
        with socket.socket() as probe:
            if probe.connect_ex((BOX_HOST, port)) != 0:
                return port
    return 0


def _own_passwords(log_dir: str) -> str:
    """Return the path of a copy of the included passwords, which others may not read: nobody is warned then."""
    path = os.path.join(log_dir, "passwords.yaml")
    os.makedirs(log_dir, exist_ok=True)
    write_file(path, (shipped_folder() / "passwords.yaml").read_bytes())
    return path


def copied(folder: str, log_dir: str) -> str:
    """Return a copy of a competition's folder, without its log: a rehearsal changes its schedule. Raises OSError."""
    copy = os.path.join(log_dir, "rehearsed")
    shutil.rmtree(copy, ignore_errors=True)
    return str(shutil.copytree(folder, copy, ignore=shutil.ignore_patterns("log")))


def settings(log_dir: str, folder: str = "", **changes: str) -> settings_of.BoxSettings:
    """Return the settings of the demonstration's box, or of that of a competition's folder. `changes`: others than
    usual. Raises `BadParams`."""
    web_port = _free_port(FIRST_WEB_PORT)
    return settings_of.of_competition(folder, {
        "rsbb_host": LOOPBACK_BROADCAST, "bind_host": BOX_HOST, "log_dir": log_dir,
        "listen_duration": "0.2", "web_port": str(web_port), "tablet_port": str(_free_port(web_port + 1)),
        "devices": "false", **changes})


def main(arguments: Optional[List[str]] = None) -> None:
    """Run the program with these arguments (default: those of the process)."""
    options = _parser().parse_args(arguments)
    close_to_others()
    log_dir = os.path.expanduser(options.log_dir)
    log_to_terminal(logging.WARNING if options.scripted else logging.INFO, log_dir)
    try:
        own = {} if options.folder else {"passwords_file": _own_passwords(log_dir)}
        # Each demonstration begins with the first event.
        found = settings(log_dir, options.folder and copied(options.folder, log_dir), **own, resume="never")
    except (BadParams, OSError, shutil.Error) as error:
        sys.exit(f"{called('demo')}: {error}")
    robots = options.robots or (MOST_ROBOTS if options.folder else 1)
    # Imported late: help needs none of it.
    from roah_rsbb.box.program.program import BoxProgram
    from roah_rsbb.robot.dummy import DummyOptions, dummy_client
    from roah_rsbb.rulebook.benchmarks import teams_of

    air = MemoryAir()

    def make(loop: asyncio.AbstractEventLoop) -> BoxProgram:
        return BoxProgram(loop, found, "", air.peer, is_dummy=True)

    async def work(program: BoxProgram) -> int:
        door = os.path.join(log_dir, "door.json")  # terminals are not to take it for the box of a competition
        await program.start(door)
        config = program.config
        behaviour = DummyOptions(options.duration, options.duration)
        for number_, team in enumerate(teams_of(config)[:robots]):
            robot = dummy_client(
                team, config.passwords[team], options=behaviour, rsbb_host=LOOPBACK_BROADCAST,
                bind_host=f"127.0.0.{number_ + 2}", name_in_log=team, make_peer=air.peer)
            program.keep(robot.run())
        if not options.scripted and (await program.open_pages(in_browser=True) or options.folder):
            await asyncio.get_event_loop().create_future()
        return await _scripted(door, log_dir)

    sys.exit(serve(make, work))


async def _scripted(door: str, log_dir: str) -> int:
    """Let a scripted referee lead the runs; returns the exit status."""
    print(f"A scripted referee takes a dummy robot through {' and '.join(RUNS)}.", flush=True)
    for benchmark, does in RUNS.items():
        print(f"\n--- {benchmark}", flush=True)
        referee = subprocess.Popen(
            without_ros("referee", "run", ZONE, "--benchmark", benchmark, "--wait", str(WAIT_FOR_ROBOT_S), *does),
            env={**os.environ, OWN_VARIABLE: door})
        try:
            while referee.poll() is None:
                await asyncio.sleep(LOOK_S)
        finally:
            referee.kill()  # of a demonstration that is ended
        status = referee.wait()
        if status != 0:
            print(f"{called('demo')}: {benchmark} was not completed (the referee's exit status is {status})",
                  file=sys.stderr)
            return status
    print(f"The logs of the runs (rosbags) are in {log_dir}")
    program = "roah-rsbb" if shutil.which("roah-rsbb") else shlex.join(without_ros())
    print(f"To print both score sheets: {program} results export --html sheets --log-dir {log_dir}")
    return 0
