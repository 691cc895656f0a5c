"""`rosrun roah_rsbb check_robot` and `roah-rsbb check-robot`: the conformance check of a team's robot."""

import argparse
import asyncio
import contextlib
import enum
import os
import sys
import time
from typing import Callable, List, Optional, Sequence, Tuple

from roah_rsbb.check import report
from roah_rsbb.check.box import NetworkInUse
from roah_rsbb.check.engine import Engine, scenarios_of
from roah_rsbb.check.play import Options, Play
from roah_rsbb.check.report import ScenarioResult, Verdict
from roah_rsbb.check.scenarios import SCENARIOS, Depth, Scenario
from roah_rsbb.comm import sockets
from roah_rsbb.comm.ciphers import PASSWORD_VARIABLE, Cipher, cipher_by_label, own_password
from roah_rsbb.ground import linux
from roah_rsbb.ground.arguments import Parser, add_network, add_password, called, number, read_by
from roah_rsbb.ground.installed import pages_folder, warn_if_replaced
from roah_rsbb.rulebook.registry import PROFILES
from roah_rsbb.wording.texts import did_you_mean

PROGRAM = called("check_robot")
# Another box sends a beacon each second.
LISTEN_S = 2.5


class CheckExit(enum.IntEnum):
    """Exit statuses. `--help` lists them, and scripts rely on them."""

    PASSED = 0
    FAILED = 1
    USAGE = 2
    NOT_STARTED = 3
    UNJUDGED = 4
    INTERRUPTED = 130


_DESCRIPTION = """\
Plays the referee's box against one robot and reports what works. The robot's program runs as in a competition, with ROS
or without. The check stops the robot again and again: keep the emergency stop at hand, or lift the robot's wheels.
It needs no ROS. Ctrl-C ends it: the robot is stopped, and the results so far are printed and written.
"""

_EPILOG = f"""\
The team's password comes from --password-file, the environment variable {PASSWORD_VARIABLE}, or --password, which is
visible in this machine's list of processes.

Robot and check on one machine: give each its own address, for example
  {PROGRAM} --team TestingTeam --password-file key.txt --host 127.255.255.255 --bind 127.0.0.1
and 127.0.0.2 for the robot.

exit status: 0 passed, 1 the robot has faults, 2 wrong arguments, 3 the check could not start,
  4 the checker's machine was too busy to judge, 130 interrupted
"""


def _some_of(known: Sequence[str], what: str, remedy: str) -> Callable[[str], Tuple[str, ...]]:
    """Return what reads names that are separated by commas."""
    def read(text: str) -> Tuple[str, ...]:
        names = tuple(name.strip() for name in text.split(",") if name.strip())
        for name in names:
            if name not in known:
                raise argparse.ArgumentTypeError(f"no {what} {name!r}{did_you_mean(name, known)}")
        if not names:
            raise argparse.ArgumentTypeError(f"no {what} is given: {remedy}")
        return names
    return read


_codes = _some_of(tuple(PROFILES), "benchmark", f"choose from {', '.join(PROFILES)}")
_names = _some_of([one.name for one in SCENARIOS], "scenario", "--list shows all of them")


def _parser() -> argparse.ArgumentParser:
    parser = Parser(PROGRAM, _DESCRIPTION, _EPILOG)
    who = parser.add_argument_group("robot")
    who.add_argument("--team", help="team name, exactly as the robot sends it")
    who.add_argument("--robot", default="", help="robot name, if the team has several robots (default: any)")
    add_password(who)
    network = parser.add_argument_group("network")
    add_network(network)
    network.add_argument("--second-bind", default="", metavar="HOST",
                         help="another address of this machine, for the scenarios with a second box (default: none; on "
                              "loopback 100 after --bind, such as 127.0.0.101)")
    network.add_argument("--cipher", type=read_by(cipher_by_label), default=Cipher.AES_128_CBC, metavar="NAME",
                         help="cipher of the box's messages, such as aes-256-cbc (default: aes-128-cbc)")
    what = parser.add_argument_group("what is checked")
    what.add_argument("--level", choices=[level.value for level in Depth], default=Depth.BASIC.value,
                      help="basic: beacon, clock, one benchmark, STOP in all states (about a minute). full: all "
                           "scenarios (about eight minutes) (default: %(default)s)")
    what.add_argument("--benchmarks", type=_codes, default=None, metavar="CODES",
                      help="codes separated by commas. Level basic uses only the first one (default: HGTKMH; with "
                           "level full: all)")
    what.add_argument("--only", type=_names, default=None, metavar="NAMES",
                      help="only these scenarios, separated by commas, whatever the level")
    what.add_argument("--list", action="store_true", help="list all scenarios, and end")
    what.add_argument("--patience", type=number(1, 3600), default=60.0, metavar="S",
                      help="seconds that the robot may take to prepare, and to execute a goal (default: %(default)g)")
    what.add_argument("--wait", type=number(1, 3600), default=15.0, metavar="S",
                      help="seconds to wait for the robot's first beacon (default: %(default)g)")
    what.add_argument("--seed", type=int, default=1, help="random seed of the bad network (default: %(default)s)")
    output = parser.add_argument_group("reports")
    output.add_argument("--json", metavar="FILE", help="write the results as JSON")
    output.add_argument("--junit", metavar="FILE", help="write the results as JUnit XML, for CI servers")
    output.add_argument("--html", metavar="FILE", help="write the results as a page")
    return parser


def read_options(arguments: Optional[Sequence[str]] = None) -> Tuple[argparse.Namespace, Optional[Options]]:
    """Read and check the command line; ends the program with status 2 if something is wrong. None: only --list."""
    parser = _parser()
    given = sys.argv[1:] if arguments is None else arguments
    options = parser.parse_args([argument for argument in given if ":=" not in argument])
    if options.list:
        return options, None
    if not options.team:
        parser.error("--team is missing: give the team's name exactly as the robot sends it")
    try:
        password = own_password(options.password, options.password_file)
        for path in (options.json, options.junit, options.html):
            _check_writable(path)
        host = sockets.resolve(options.host, "--host")
        bind = sockets.resolve(options.bind, "--bind")
        second = sockets.resolve(options.second_bind, "--second-bind") if options.second_bind else _after(bind)
    except (ValueError, OSError) as error:
        parser.error(str(error))
    if not password:
        parser.error(f"the password is missing: use --password-file or the environment variable {PASSWORD_VARIABLE}")
    if options.benchmarks is None:
        options.benchmarks = tuple(PROFILES) if options.level == Depth.FULL.value else ("HGTKMH",)
    return options, Options(
        options.team, password, options.robot, host, options.port, bind, second, options.cipher, options.benchmarks,
        options.patience, options.wait, options.seed)


def _after(bind: str) -> str:
    """A loopback address for the second box, apart from those of robots; empty for other networks."""
    first, *_, last = bind.split(".")
    return f"{bind.rpartition('.')[0]}.{int(last) + 100}" if first == "127" and int(last) < 150 else ""


def _check_writable(path: Optional[str]) -> None:
    """Raise ValueError if a report could not be written at the end."""
    if path is None:
        return
    folder = os.path.dirname(os.path.abspath(path))
    if not os.path.isdir(folder):
        raise ValueError(f"{path} cannot be written: folder {folder} is missing. Create it, or give another path")
    if os.path.isdir(path) or not os.access(path if os.path.exists(path) else folder, os.W_OK):
        raise ValueError(f"{path} cannot be written: give another path, or correct its permissions")


class _Display:
    """Shows the progress in a terminal, or line by line elsewhere."""

    def __init__(self, count: int) -> None:
        self._count = count
        self._number = 0
        self._is_terminal = sys.stdout.isatty()

    def begin(self, result: ScenarioResult) -> None:
        self._number += 1
        if self._is_terminal:
            print(f"{self._number:>3}/{self._count:<3} {result.title} ...", end="\r", flush=True)

    def end(self, result: ScenarioResult) -> None:
        if self._is_terminal:
            print("\x1b[2K", end="")
        print("\n".join(report.scenario_lines(self._number, self._count, result)), flush=True)


async def _run(engine: Engine) -> bool:
    """Run the check until its end, SIGINT or SIGTERM. Returns whether it was interrupted."""
    loop = asyncio.get_event_loop()
    running = loop.create_task(engine.run())
    linux.on_end(loop, running.cancel)
    try:
        await running
    except asyncio.CancelledError:
        return True
    return False


async def _check(options: Options, level: str, scenarios: Sequence[Scenario]) -> report.Check:
    play = Play(asyncio.get_event_loop(), options)
    display = _Display(len(scenarios))
    engine = Engine(play, scenarios, display.begin, display.end)
    began_utc = time.time()
    play.open(LISTEN_S)
    try:
        interrupted = await _run(engine)
    finally:
        play.close()
    return report.Check(
        options.team, play.robot, level, began_utc, play.now, interrupted, len(scenarios), tuple(engine.results))


def _write(path: Optional[str], make: Callable[[report.Check], str], check: report.Check) -> None:
    if path is not None:
        with open(path, "w", encoding="utf-8") as file:
            file.write(make(check))


def _list() -> None:
    for one in SCENARIOS:
        print(f"{one.name:<18} {one.level.value:<6} {one.title}")


def main(arguments: Optional[List[str]] = None) -> None:
    """Run the program with these arguments (default: those of the process)."""
    warn_if_replaced()
    given, options = read_options(arguments)
    if options is None:
        with contextlib.suppress(BrokenPipeError):
            _list()
        return
    scenarios = scenarios_of(Depth(given.level), options.benchmarks, given.only)
    try:
        check = asyncio.run(_check(options, given.level, scenarios))
        print()
        print("\n".join(report.table_lines(check, pages_folder())))
        _write(given.json, report.as_json, check)
        _write(given.junit, report.as_junit, check)
        _write(given.html, report.as_html, check)
    except (OSError, ValueError, NetworkInUse) as error:
        print(f"{PROGRAM}: {error}", file=sys.stderr)
        sys.exit(CheckExit.NOT_STARTED)
    sys.exit(_status(check))


def _status(check: report.Check) -> CheckExit:
    if check.interrupted:
        return CheckExit.INTERRUPTED
    return {Verdict.FAILED: CheckExit.FAILED, Verdict.UNJUDGED: CheckExit.UNJUDGED}.get(check.verdict, CheckExit.PASSED)
