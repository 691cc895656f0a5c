"""A tablet on the command line: `python -m roah_rsbb.tablet.dummy --help`, `rosrun roah_rsbb dummy_tablet`.

It needs no ROS. Arguments that roslaunch adds for nodes are ignored.
"""

import argparse
import asyncio
import contextlib
import logging
import math
import sys
import time
from typing import List, Optional, Tuple

from roah_rsbb.comm.channels import Network
from roah_rsbb.ground import linux
from roah_rsbb.ground.arguments import Parser, add_network, read_by
from roah_rsbb.tablet.radio import ShownTablet, TabletRadio

PROGRAM = "dummy_tablet"
# Time limit of --once.
ANSWER_S = 10.0
_LONGEST_LINE = 4096  # bytes

_log = logging.getLogger(PROGRAM)

_DESCRIPTION = """\
A tablet without a screen. It sends its beacon every second and reports which view the box requests. Type

  call          Granny Annie calls the robot
  1.5 -2.0      Granny Annie selects the position x 1.5 m, y -2.0 m

Ctrl-C or the end of the input ends the program. Until then, the box shows that the tablet is present.
"""

_EPILOG = f"""\
In scripts: '{PROGRAM} --call --once' calls, waits until the box has published the call, and ends. The exit status is 1
if that takes more than {ANSWER_S:.0f} s. On the same machine as the box, add --host 127.255.255.255.
"""


def _position(text: str) -> Tuple[float, float]:
    """Read two numbers, such as 1.5,-2.0 or 1.5 -2.0; ValueError for anything else."""
    words = text.replace(",", " ").split()
    x, y = (float(word) for word in words) if len(words) == 2 else (math.nan, math.nan)
    if not (math.isfinite(x) and math.isfinite(y)):
        raise ValueError(f"'{text}' is not a position: type x and y in metres, such as 1.5 -2.0")
    return x, y


def _parser() -> argparse.ArgumentParser:
    parser = Parser(PROGRAM, _DESCRIPTION, _EPILOG)
    parser.add_argument("--call", action="store_true", help="call at the start")
    parser.add_argument("--position", type=read_by(_position), metavar="X,Y",
                        help="select a position at the start, in metres (--position=-1,2 if it begins with a minus)")
    parser.add_argument("--once", action="store_true", help="end when the box has published it")
    add_network(parser.add_argument_group("network"))
    return parser


class DummyTablet:
    """The tablet, controlled by lines of text."""

    def __init__(self, loop: asyncio.AbstractEventLoop, host: str, port: int, bind: str) -> None:
        self._state = ShownTablet()
        self._loop = loop
        self._heard = asyncio.Event()
        self._shown: Optional[bool] = None
        self._acknowledged: Tuple[bool, bool] = (False, False)
        self._radio = TabletRadio(loop, self._state, self._on_box, _log.warning, Network(host, port, bind))
        self._radio.present = True

    def open(self) -> None:
        """Start to send. Raises OSError whose text names the remedy."""
        self._radio.open()

    def close(self) -> None:
        """Stop sending."""
        self._radio.close()

    def call(self) -> None:
        """Granny Annie calls."""
        self._state.call(time.time_ns())
        self._touched()

    def place(self, position: Tuple[float, float]) -> None:
        """Granny Annie selects a position."""
        self._state.place(time.time_ns(), *position)
        self._touched()

    def take(self, line: str) -> None:
        """Carry out a line of input."""
        if line == "call":
            self.call()
        elif line:
            try:
                self.place(_position(line))
            except ValueError as error:
                _log.error("%s; or 'call'", error)

    async def until_acknowledged(self) -> bool:
        """Wait until the box has acknowledged all touches; returns False after the timeout."""
        async def acknowledged() -> None:
            while not self._is_acknowledged():
                self._heard.clear()
                await self._heard.wait()
        try:
            await asyncio.wait_for(acknowledged(), ANSWER_S)
        except asyncio.TimeoutError:
            return False
        return True

    def _is_acknowledged(self) -> bool:
        state = self._state
        return (state.hears_box(self._loop.time())
                and (state.call_is_acknowledged or state.call_time == (0, 0))
                and (state.position_is_acknowledged or state.position_time == (0, 0)))

    def _touched(self) -> None:
        self._acknowledged = (self._state.call_is_acknowledged, self._state.position_is_acknowledged)
        self._radio.changed()

    def _on_box(self, changed: bool) -> None:
        self._heard.set()
        if not changed:
            return
        if self._state.display_map != self._shown:
            self._shown = self._state.display_map
            _log.info("the box requests the view: %s", "map" if self._shown else "call button")
        acknowledged = (self._state.call_is_acknowledged, self._state.position_is_acknowledged)
        for what, before, now in zip(("call", "position"), self._acknowledged, acknowledged):
            if now and not before:
                _log.info("the box has published the %s", what)
        self._acknowledged = acknowledged


def _follow_input(loop: asyncio.AbstractEventLoop, tablet: DummyTablet, ended: asyncio.Event) -> None:
    """Follow lines from a terminal or pipe. Their end ends the program."""
    pending = b""

    def take(data: bytes) -> None:
        nonlocal pending
        *lines, pending = (pending + data).split(b"\n")
        for line in lines:
            tablet.take(line.decode(errors="replace").strip())
        pending = pending[-_LONGEST_LINE:]
        if not data:
            ended.set()
    with contextlib.suppress(OSError, ValueError):  # a file or no input, as in a launch: only send beacons
        linux.on_input(loop, sys.stdin, take)


async def _run(options: argparse.Namespace) -> int:
    loop = asyncio.get_event_loop()
    tablet = DummyTablet(loop, options.host, options.port, options.bind)
    ended = asyncio.Event()
    linux.on_end(loop, ended.set)
    tablet.open()
    try:
        if options.call:
            tablet.call()
        if options.position is not None:
            tablet.place(options.position)
        if options.once:
            if await tablet.until_acknowledged():
                return 0
            _log.error("the box did not publish it: check that the box is running, and that there is no other tablet")
            return 1
        _follow_input(loop, tablet, ended)
        await ended.wait()
        return 0
    finally:
        tablet.close()


def main(arguments: Optional[List[str]] = None) -> None:
    """Run the program with these arguments (default: those of the process)."""
    given = sys.argv[1:] if arguments is None else arguments
    # roslaunch appends __name:=... and __log:=..., and may add other remappings.
    options = _parser().parse_args([argument for argument in given if ":=" not in argument])
    logging.basicConfig(level=logging.INFO, stream=sys.stdout, format="%(asctime)s %(message)s", datefmt="%H:%M:%S")
    try:
        status = asyncio.run(_run(options))
    except OSError as error:
        sys.exit(f"{PROGRAM}: {error}")
    sys.exit(status)


if __name__ == "__main__":
    main()
