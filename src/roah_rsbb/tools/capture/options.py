"""The arguments of the program."""

import argparse
from typing import List, Optional

from roah_rsbb.arguments import Parser, number
from roah_rsbb.comm.frame import PRIVATE_TYPES, PUBLIC_TYPES
from roah_rsbb.comm.passwords import PASSWORD_VARIABLE

PROGRAM = "capture_comm"
MESSAGES = tuple(kind.DESCRIPTOR.name for kind in PUBLIC_TYPES + PRIVATE_TYPES)

_DESCRIPTION = """\
Shows every datagram that passes between box, robots and tablet: time (UTC), channel, address, who speaks, the
message with its fields, and for what is no message the reason. It only listens. Ctrl-C ends it.
"""

_EPILOG = f"""\
what can be heard
  With root's rights (or CAP_NET_RAW) on Linux: everything that reaches or leaves this machine, and what its own
  programs send to each other. Without them: broadcasts, which is the public channel.
  States of a run are unicast between box and robot: hear them, with root's rights, on the box's machine or on the
  robot's. A third machine gets none of them: a switch or access point does not deliver them there. It gets the
  box's if the core has the parameter private_mode:=broadcast, as the original box had it, and still not the robot's.
  The private ports of runs are learned from the box's beacons.

passwords
  --passwords FILE is the box's passwords file. With the password of one team (--password-file, the environment
  variable {PASSWORD_VARIABLE}, or --password, which everybody sees who can list this machine's processes) give
  --team, too; without it the password is tried on every channel.

examples
  on the box's machine:  {PROGRAM} --host 192.168.1.255 --passwords config/passwords.yaml
  on a robot:            {PROGRAM} --host 192.168.1.255 --team MyTeam --password-file key.txt
  all on one machine:    {PROGRAM} --host 127.255.255.255 --passwords config/passwords.yaml
  only what is wrong:    {PROGRAM} --host 192.168.1.255 --passwords config/passwords.yaml --errors-only
  keep it, read it:      {PROGRAM} --host 192.168.1.255 --write run.jsonl
                         {PROGRAM} --read run.jsonl --passwords config/passwords.yaml --changes-only
  for other programs:    {PROGRAM} --read run.jsonl --json | jq 'select(.message == "RobotState").fields'
"""


def _port(text: str) -> int:
    if not text.isdecimal() or not 1 <= int(text) <= 65535:
        raise argparse.ArgumentTypeError(f"{text!r} is no UDP port, a number from 1 to 65535")
    return int(text)


def parse(arguments: Optional[List[str]]) -> argparse.Namespace:
    """The arguments; ends the program with one line where they make no sense."""
    parser = Parser(PROGRAM, _DESCRIPTION, _EPILOG)
    source = parser.add_argument_group("what to hear")
    source.add_argument("--host", default="10.255.255.255",
                        help="the network's broadcast address, as the box's rsbb_host (default: %(default)s)")
    source.add_argument("--port", type=_port, default=6666, help="public UDP port (default: %(default)s)")
    source.add_argument("--plain", action="store_true", help="hear broadcasts only, also where more is allowed")
    source.add_argument("--duration", type=number(0, 1e9), metavar="S", help="end after so many seconds")
    keep = source.add_mutually_exclusive_group()
    keep.add_argument("--write", metavar="FILE", help="keep every datagram in a new file (they stay encrypted)")
    keep.add_argument("--read", metavar="FILE", help="show a file that --write made, and listen to nothing")
    secrets = parser.add_argument_group("passwords, for private channels")
    secrets.add_argument("--passwords", metavar="FILE", help="a file with a line 'team: password' for each team")
    password = secrets.add_mutually_exclusive_group()
    password.add_argument("--password-file", metavar="FILE", help="a file whose first line is a team's password")
    password.add_argument("--password", help="a team's password, for tests")
    show = parser.add_argument_group("what to show")
    show.add_argument("--team", metavar="NAME", help="only that team's robots, and beacons that list one")
    show.add_argument("--message", choices=MESSAGES, metavar="TYPE", help="only: " + ", ".join(MESSAGES))
    show.add_argument("--errors-only", action="store_true", help="only what is no message")
    show.add_argument("--changes-only", action="store_true", help="not what repeats, but for its times, the last one")
    show.add_argument("--json", action="store_true", help="one JSON object a line")
    return parser.parse_args(arguments)
