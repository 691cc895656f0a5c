"""The dummy robot as a program: `python -m roah_rsbb.robot.dummy --help`, `rosrun roah_rsbb dummy_robot`.

No ROS is needed; what roslaunch adds to the arguments of a node is left aside.
"""

import argparse
import asyncio
import contextlib
import logging
import signal
import sys
from typing import List, Optional

from roah_rsbb.arguments import Parser, number
from roah_rsbb.comm.ciphers import Cipher, cipher_by_label
from roah_rsbb.comm.passwords import PASSWORD_VARIABLE, own_password
from roah_rsbb.comm.sockets import ANY_HOST
from roah_rsbb.robot.client import RobotClient
from roah_rsbb.robot.dummy_robot import PHASES, DummyOptions, dummy_client

PROGRAM = "dummy_robot"

_DESCRIPTION = """\
A robot that only pretends: it joins every run that the box gives it, prepares and executes for as long as
you say, and sends what a robot would send. It needs no ROS. Ctrl-C ends it.
"""

_EPILOG = f"""\
The team's password comes from --password-file, from the environment variable {PASSWORD_VARIABLE}, or from
--password; the last one shows it to everybody who can list this machine's processes.

On one machine with the box give each participant an address of its own, for example the box 127.0.0.1 and
  {PROGRAM} --team TestingTeam --host 127.255.255.255 --bind 127.0.0.2
"""


def _cipher(label: str) -> Cipher:
    try:
        return cipher_by_label(label)
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def _parser() -> argparse.ArgumentParser:
    parser = Parser(PROGRAM, _DESCRIPTION, _EPILOG)
    who = parser.add_argument_group("who it is")
    who.add_argument("--team", required=True, help="team name, as in the box's schedule and passwords")
    who.add_argument("--robot", default="DummyRobot", help="robot name (default: %(default)s)")
    password = who.add_mutually_exclusive_group()
    password.add_argument("--password", help="the team's password, for tests (see below)")
    password.add_argument("--password-file", metavar="FILE", help="a file whose first line is the password")
    network = parser.add_argument_group("network")
    network.add_argument("--host", default="10.255.255.255",
                         help="the network's broadcast address, or the box's address (default: %(default)s)")
    network.add_argument("--port", type=int, default=6666, help="public UDP port (default: %(default)s)")
    network.add_argument("--bind", default=ANY_HOST, metavar="HOST",
                         help="own address, where participants share a machine (default: %(default)s)")
    network.add_argument("--cipher", type=_cipher, default=Cipher.AES_128_CBC, metavar="NAME",
                         help="for what it sends, such as aes-256-cbc (default: aes-128-cbc)")
    _add_behaviour(parser)
    return parser


def _add_behaviour(parser: argparse.ArgumentParser) -> None:
    usual = DummyOptions()
    work = parser.add_argument_group("how it works")
    work.add_argument("--prepare-duration", type=number(0, 1e6), default=usual.prepare_duration, metavar="S",
                      help="seconds from PREPARE until it is ready (default: %(default)s)")
    work.add_argument("--execute-duration", type=number(0, 1e6), default=usual.execute_duration, metavar="S",
                      help="seconds for each goal (default: %(default)s)")
    wrong = parser.add_argument_group("how it misbehaves")
    wrong.add_argument("--never-end", action="store_true", help="execute until the box stops it")
    wrong.add_argument("--crash-in", choices=PHASES, help="die in the middle of preparing or executing")
    wrong.add_argument("--skew", type=number(-1e9, 1e9), default=usual.skew, metavar="S",
                       help="seconds by which its clock is ahead (default: %(default)s)")
    wrong.add_argument("--save-nothing", action="store_true", help="say that no offline data is saved")
    wrong.add_argument("--loss", type=number(0, 1), default=usual.loss, metavar="SHARE",
                       help="share of the datagrams that are lost, both ways (default: %(default)s)")
    wrong.add_argument("--seed", type=int, help="makes its losses and results the same each time")


def _password(options: argparse.Namespace) -> str:
    """The password from wherever it is; ValueError when it is nowhere."""
    password = own_password(options.password, options.password_file)
    if password is None:
        raise ValueError(f"no password: give --password-file or the environment variable {PASSWORD_VARIABLE}")
    return password


async def _run(client: RobotClient) -> None:
    """Run until SIGINT or SIGTERM."""
    loop = asyncio.get_event_loop()
    running = loop.create_task(client.run())
    for which in (signal.SIGINT, signal.SIGTERM):
        loop.add_signal_handler(which, running.cancel)
    with contextlib.suppress(asyncio.CancelledError):
        await running


def main(arguments: Optional[List[str]] = None) -> None:
    """Run the program with these arguments (default: those of the process)."""
    given = sys.argv[1:] if arguments is None else arguments
    # roslaunch appends __name:=... and __log:=..., and may be given any other remapping.
    options = _parser().parse_args([argument for argument in given if ":=" not in argument])
    robot = options.robot.replace("%", "%%")
    logging.basicConfig(
        level=logging.INFO, stream=sys.stdout, format=f"%(asctime)s {robot}: %(message)s", datefmt="%H:%M:%S"
    )
    behaviour = DummyOptions(
        options.prepare_duration, options.execute_duration, options.never_end, options.crash_in,
        options.skew, options.save_nothing, options.loss, options.seed,
    )
    try:
        client = dummy_client(
            options.team, _password(options), options.robot, behaviour,
            options.host, options.port, options.bind, options.cipher,
        )
        asyncio.run(_run(client))
    except (ValueError, OSError) as error:
        sys.exit(f"{PROGRAM}: {error}")


if __name__ == "__main__":
    main()
