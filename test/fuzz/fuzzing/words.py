"""Input of people and browsers: command lines, lines to the dummy tablet, messages of the tablet's page."""

import contextlib
import io
import json
import logging
from typing import Callable, Iterator, List

from fuzzing.reader import Reader
from fuzzing.target import Step, Target
from roah_rsbb.capture.program import parse_options as parse_capture_options
from roah_rsbb.referee import commands
from roah_rsbb.robot import dummy
from roah_rsbb.tablet import dummy as dummy_tablet
from roah_rsbb.tablet.maps import Map
from roah_rsbb.tablet.radio import BoxPart, ShownTablet
from roah_rsbb.tablet.server import Pages, Refusal, refusal_text

_MOST_WORDS = 30
_PLAN = Map(b"\x89PNG image", 200, 100, 0.05, (0.0, 0.0, 0.0), False)
# The largest message that the server takes from a page (tornado closes the connection after it).
_LARGEST_MESSAGE = 1024


def _dummy_robot(words: List[str]) -> None:
    """Like `dummy.main`, without running the robot."""
    def never(running) -> None:
        running.close()

    run, dummy.asyncio = dummy.asyncio, _Namespace(run=never)
    try:
        dummy.main(words)
    finally:
        dummy.asyncio = run


class _Namespace:
    def __init__(self, **fields: object) -> None:
        self.__dict__.update(fields)


_TAKE_PASSWORDS = (0, 3)
_PROGRAMS: List[Callable[[List[str]], object]] = [
    _dummy_robot,
    lambda words: dummy_tablet._parser().parse_args(words),
    lambda words: commands.parser().parse_args(words),
    parse_capture_options,
]


def line_steps(data: bytes) -> Iterator[Step]:
    """A command line is taken, or ends the program with a text; a password in it is never part of that."""
    which, *words = data.decode("utf-8", "surrogateescape").split("\0")[:_MOST_WORDS + 1]
    number = (ord(which[0]) if which else 0) % len(_PROGRAMS)
    program = _PROGRAMS[number]
    words = [word[:2000] for word in words]
    logging.disable(logging.CRITICAL)
    said = io.StringIO()

    def take() -> None:
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            try:
                program(words)
            except SystemExit as ended:
                said.write(str(ended.code))

    yield take
    logging.disable(logging.NOTSET)
    holding = [word for word in words if "secret1234" in word]
    if number in _TAKE_PASSWORDS and holding == ["--password=secret1234"]:
        assert "secret1234" not in said.getvalue()


class _Touched(dummy_tablet.DummyTablet):
    """The dummy tablet without a radio."""

    def __init__(self) -> None:
        self._state = ShownTablet()
        self._reported = (False, False)

    def _touched(self) -> None:
        for time in (self._state.call_time, self._state.position_time):
            assert 0 <= time[0] < 2**32
        assert max(abs(self._state.x), abs(self._state.y)) < float("inf")


def typed_steps(data: bytes) -> Iterator[Step]:
    """A line that somebody types to the dummy tablet."""
    tablet = _Touched()
    logging.disable(logging.CRITICAL)
    yield lambda: tablet.take(data[:4096].decode(errors="replace").strip())
    logging.disable(logging.NOTSET)


def page_steps(data: bytes) -> Iterator[Step]:
    """A message of a browser to the tablet's server: it is done, or refused."""
    reader = Reader(data)
    state = ShownTablet()
    if reader.flag():
        state.on_box(0.0, BoxPart(True, (0, 0), (0, 0)))
    pages = Pages(state, _PLAN if reader.flag() else None)
    raw = reader.rest()[:_LARGEST_MESSAGE]
    text = raw if reader.flag() else raw.decode("utf-8", "ignore")

    def do() -> None:
        try:
            pages.do(1.0, 1_800_000_000_000_000_000, text)
        except Refusal as refusal:
            refusal_text(refusal)
        json.dumps(json.loads(pages.text(1.0)), allow_nan=False)

    yield do


# -- inputs to begin with ---------------------------------------------------------------------------------


def line_seeds() -> List[bytes]:
    """A few of each program."""
    robot = [
        b"--team\0A\0--password=secret1234", b"--team\0A", b"--team\0\0--password=secret1234",
        b"--team\0A\0--password=secret1234\0--port\0" + b"9" * 30, b"--team\0A\0--password=\xff", b"--help",
        b"--team\0A\0--password=secret1234\0--skew\0nan\0--loss\01e9", b"--team\0A\0--password-file\0/dev/null",
        b"--team\0A\0--password-file\0a\xffb", b"--team\0A\0--password=secret1234\0--cipher\0none",
        b"--team\0A\0--password=secret1234\0--robot\0%s%%\0--seed\0" + b"9" * 5000,
        b"--team\0A\0--password=secret1234\0--bind\0\0--host\0\xff", b"--team\0A\0--password=secret1234\0__name:=x",
        b"--team\0A\0--password=secret1234\0--secret1234", b"--team\0A\0--password=secret1234\0x",
    ]
    tablet = [b"--position=1,2\0--once", b"--position\0nan,1", b"--call\0--port\0x",
              b"--position\0" + b"1" * 400 + b",1"]
    referee = [
        b"status", b"score\0Home A\03\0+1", b"done\0Home A\0skip\0--operation\03",
        b"switches\0A\0--press\0300", b"run\0A",
        b"watch\0--zone\0\xff", b"--json\0score\0A\0door\0yes", b"run\0A\0--wait\01e999\0--score\0x=1",
    ]
    capture = [b"--host\0127.0.0.1", b"--read\0x\0--passwords\0y", b"--team\0A\0--password\0secret1234", b"--port\0-1"]
    return [
        bytes([which]) + b"\0" + line
        for which, lines in enumerate((robot, tablet, referee, capture)) for line in lines
    ]


def typed_seeds() -> List[bytes]:
    """Valid and invalid input."""
    return [b"call", b"1.5 -2.0", b"1,2", b"1 2 3", b"nan inf", b"1e308 -1e308", b"\xff\xfe",
            b"1" * 4096, b"", b"1e999,1"]


def page_seeds() -> List[bytes]:
    """Valid and invalid messages of a page."""
    texts = (
        '{"do": "here"}', '{"do": "call"}', '{"do": "place", "u": 0.25, "v": 0.5}',
        '{"do": "place", "u": 1e999, "v": NaN}',
        '{"do": ["call"]}', '{"do": {"a": 1}}', "[", "[" * 1000, '{"do": "place", "u": true, "v": null}', "1" * 1000,
        '{"do": "place", "u": 5e-324, "v": 1}', "null", '"call"',
    )
    return [bytes([box, plan]) + text.encode() for text in texts for box in (0, 1) for plan in (0, 1)]


_WORDS = tuple(word.encode() for word in (
    "\0--team", "\0--password=secret1234", "\0--robot", "\0--host", "\0--bind", "\0--port", "\0--cipher", "\0--skew",
    "\0--loss", "\0--seed", "\0--crash-in", "\0prepare", "\0--position", "\0--wait", "\0--zone", "\0--press",
    "\0--json", "\0--", "\0-", "%s", "nan", "1e999", "-1", "aes-256-cbc",
)) + (b"\xff",)

LINES = Target("lines", line_steps, line_seeds, _WORDS, is_timed=False)
TYPED = Target("typed", typed_steps, typed_seeds, (b"call", b"nan", b"inf", b"1e308", b",", b" ", b"-"))
PAGES = Target("pages", page_steps, page_seeds, (
    b'{"do": ', b'"place"', b'"call"', b'"here"', b'"u": ', b'"v": ', b"NaN", b"1e999", b"-0.0", b"[", b"\\ud800",
))
