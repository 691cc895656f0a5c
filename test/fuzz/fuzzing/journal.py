"""A journal that is damaged, torn, of another program, or has foreign values. The box must start."""

import atexit
import contextlib
import copy
import functools
import os
import pathlib
import shutil
import tempfile
from typing import Any, Dict, Iterator, List, Tuple

from fuzzing.reader import Reader
from fuzzing.target import Step, Target
from helpers.box_driver import BoxDriver, beacon_bytes
from helpers.competition import competition, event
from helpers.forms import form
from helpers.journaled import JournaledDriver
from helpers.module_player import FakeModules
from roah_rsbb.box.journal import competition as competition_of
from roah_rsbb.box.journal import saved_state
from roah_rsbb.box.run_logs import log_name
from roah_rsbb.core.actions import table
from roah_rsbb.core.box import Box
from roah_rsbb.core.settings import Settings
from roah_rsbb.journal import log_dir as log_dirs
from roah_rsbb.journal.contents import open_journal
from roah_rsbb.journal.log_dir import JOURNAL, CoreSession, DamagedJournal, PortRecord, Resume
from roah_rsbb.journal.reader import JournalError, JournalReader
from roah_rsbb.journal.records import Batch
from roah_rsbb.journal.store import Journal
from roah_rsbb.model.modules import RequestKind
from roah_rsbb.protocol import RobotState

_LARGEST = 300_000
_VALUES: Tuple[Any, ...] = (
    None, 0, 1, -1, 2**63 - 1, 65536, 6667, 0.0, 1.5, -1e300, float("inf"), "", "x", "NaN", "[]", "{}", "null", "[[1]]",
    "[[{}]]", '["a"]', "{", b"", b"\xff", "[" * 5000, '{"event": {}}', "PREPARE", "RUNNING", True, False, "é" * 50,
    "\ud800",
)

_CONFIG = competition(
    catering=["HCFGAC"], waypoints=[event("HNF", team="Gamma", timeout=60.0)], switches=[event("HOMF", team="Beta")],
    all=[event("HSUF", team="ALL", timeout=30.0)],
)


class _Folders:
    """Makes an empty folder for each input, in memory where the system has such a place."""

    def __init__(self) -> None:
        place = "/dev/shm" if os.access("/dev/shm", os.W_OK) else None
        self._top = functools.lru_cache(maxsize=1)(lambda: tempfile.mkdtemp(prefix="roah_rsbb_fuzz_", dir=place))

    def fresh(self) -> pathlib.Path:
        if not self._top.cache_info().currsize:
            atexit.register(shutil.rmtree, self._top(), ignore_errors=True)
        path = pathlib.Path(self._top()) / "log"
        shutil.rmtree(path, ignore_errors=True)
        path.mkdir()
        return path


_FOLDERS = _Folders()


@functools.lru_cache(maxsize=None)
def _good() -> Dict[str, bytes]:
    """The segments of a journal as a box leaves it that is ended in the middle of things."""
    folder = _FOLDERS.fresh()
    driver = JournaledDriver(folder, _CONFIG)
    driver.executing("catering")
    modules = FakeModules(driver, "HNF", "HOMF")
    modules.beat()
    robot = driver.connected("waypoints", team="Gamma", host="10.0.0.3")
    driver.command("start", "waypoints")
    modules.asks(RequestKind.REFEREE, "waypoints", text="Doors open", form=form("Done", "Skip"))
    driver.event(driver.box.act, table.Target("waypoints"), "operation")
    modules.asks(RequestKind.GOAL, "waypoints", goal="[1, 2, 3]", pose=(1.0, 2.0, 3.0), timeout=30.0)
    for state in (RobotState.PREPARING, RobotState.WAITING_GOAL):
        robot.says(state, notifications=("hello",))
    driver.connected("switches", team="Beta", host="10.0.0.4")
    driver.command("start", "switches")
    modules.asks(RequestKind.GOAL, "switches", initial_state=(True, False), switches=(2,))
    driver.score("Achievements", "detects the door", 1, "catering")
    driver.kill()
    driver.run(1.0)
    driver.journal.close()
    return {path.name: path.read_bytes() for path in (folder / "1" / JOURNAL).glob("*.log")}


def _put(path: pathlib.Path, segments: Dict[str, bytes]) -> None:
    path.mkdir()
    for name, content in segments.items():
        (path / name).write_bytes(content)


# -- ways in which a journal is not as it was ------------------------------------------------------------


def _written(folder: pathlib.Path, data: bytes) -> pathlib.Path:
    """Write a journal that is damaged in one of several ways that the input selects; returns its path."""
    reader = Reader(data)
    way = reader.choice((_whole, _bytes, _bytes, _torn, _state, _state))
    segments = dict(_good())
    if way is not _state:
        name = reader.choice(sorted(segments))
        segments[name] = way(segments[name], reader)
    _put(folder / JOURNAL, segments)
    if way is _state:
        _state(folder, reader)
    return folder / JOURNAL


def _whole(_good: bytes, reader: Reader) -> bytes:
    """Any file."""
    return reader.rest()[:_LARGEST]


def _bytes(good: bytes, reader: Reader) -> bytes:
    """Some bytes are wrong."""
    spoilt = bytearray(good)
    while reader:
        at = int.from_bytes(reader.take(3), "big") % len(spoilt)
        piece = reader.take(1 + reader.byte() % 16)
        spoilt[at:at + len(piece)] = piece
    return bytes(spoilt[:_LARGEST])


def _torn(good: bytes, reader: Reader) -> bytes:
    """Its end is missing, or is nothing."""
    size = int.from_bytes(reader.take(3), "big") % len(good)
    return good[:size] + (bytes(len(good) - size) if reader.flag() else b"")


def _state(folder: pathlib.Path, reader: Reader) -> None:
    """Replace a saved state by other JSON."""
    journal = _opened(folder, [])
    states = copy.deepcopy(journal.previous.states)
    while reader:
        name = reader.choice(sorted(states))
        _change(states[name], reader)
        journal.write(Batch(states={name: copy.deepcopy(states[name])}))
    journal.close()


def _change(value: Any, reader: Reader) -> None:
    """Put another value somewhere inside of it."""
    while isinstance(value, (dict, list)) and value:
        key = reader.choice(sorted(value)) if isinstance(value, dict) else reader.byte() % len(value)
        if not isinstance(value[key], (dict, list)) or not value[key] or reader.byte() > 224:
            new = reader.choice([other for other in _VALUES if not isinstance(other, bytes)])
            if reader.byte() > 224:
                del value[key]
            else:
                value[key] = new
            return
        value = value[key]


# -- targets -----------------------------------------------------------------------------------------------


def start_steps(data: bytes) -> Iterator[Step]:
    """A core starts with this journal, continues it or sets it aside, and writes."""
    folder = _FOLDERS.fresh()
    _written(folder, data)
    yield lambda: _start(folder)


def _opened(folder: pathlib.Path, troubles: List[str]) -> Journal:
    driver = BoxDriver(_CONFIG)
    session = CoreSession(driver.now.utc, driver.now.mono, "boot 1", 1, "uuid", "")
    return Journal(str(folder), session, competition_of(_CONFIG), Resume.ALWAYS, troubles.append)


def _start(folder: pathlib.Path) -> None:
    driver = BoxDriver(_CONFIG)
    troubles: List[str] = []
    try:
        journal = _opened(folder, troubles)
    except DamagedJournal:  # the core does not begin an empty journal beside one of which nothing is left
        return
    try:
        driver.box = Box(_CONFIG, Settings(), beacon_bytes, journal.previous.last_port)
        driver._rules.restart()
        saved, _ = saved_state(journal.previous, driver.now, "boot 1")
        driver.event(driver.box.restart.resume, saved)
        driver.run(5.0)
        journal.write(Batch(states={"box": {"n": 1}}))
        assert not troubles, troubles
    finally:
        journal.close()
    assert open_journal(str(folder / JOURNAL)).contents.states["box"].state == {"n": 1}


def read_steps(data: bytes) -> Iterator[Step]:
    """Read this journal."""
    folder = _FOLDERS.fresh()
    path = _written(folder, data)
    before = {file: file.read_bytes() for file in folder.rglob("*") if file.is_file()}
    yield lambda: _read(str(path))
    assert {file: file.read_bytes() for file in folder.rglob("*") if file.is_file()} == before


def _read(path: str) -> None:
    with contextlib.suppress(JournalError):
        reader = JournalReader(path)
        reader.sessions()
        for run in reader.runs():
            reader.run(run.identity)
            reader.entries(run.identity)
            for member in reader.members(run.identity):
                reader.links(member.port)
        reader.commands("catering")


def port_steps(data: bytes) -> Iterator[Step]:
    """The record of used ports."""
    folder = _FOLDERS.fresh()
    (folder / log_dirs.PORTS).write_bytes(data)
    record = PortRecord(str(folder))

    def read() -> None:
        largest, _ = record.read()
        assert largest is None or 0 <= largest <= 65535

    yield read


def name_steps(data: bytes) -> Iterator[Step]:
    """Check that a file with the name of a run log can be created in its folder."""
    reader = Reader(data)
    team = "".join(reader.text().split())[:100] or "Team"
    while len(team.encode()) > 100:  # as the passwords file has it
        team = team[:-1]
    robot, utc = reader.text(), reader.choice((0.0, 1.8e9, 2.0**32))
    name = ""

    def make() -> None:
        nonlocal name
        name = log_name(utc, team, robot, 255, 255, "u" * 36)

    yield make
    assert os.path.basename(name) == name
    assert "\0" not in name
    assert len(os.fsencode(name)) <= 240, "a port must fit, too"


# -- inputs to begin with ---------------------------------------------------------------------------------


def journal_seeds() -> List[bytes]:
    """Each way of damage, a few times."""
    first = next(iter(_good().values()))
    return [
        b"\x00\x00", b"\x00\x00" + first[:100], b"\x00\x00" + bytes(5000), b"\x00\x00not a journal" * 20,
        b"\x01\0\0\0\x12\1\xff\xff", b"\x01\0\0\x10\x00\x0fxxxxxxxxxxxxxxxx", b"\x01\0\0\x64\x0f" + b"\xff" * 16,
        *(b"\x03\0" + size.to_bytes(3, "big") + bytes([zero]) for size in (0, 1, 99, 4096, 20_000) for zero in (0, 1)),
        *(bytes([4, name, way, value]) for name in range(8) for way in (0, 5) for value in range(0, len(_VALUES), 4)),
        b"\x04\0\xff\xff\xff\xff\4", b"\x05\1\2\3\4",
    ]


def read_seeds() -> List[bytes]:
    """Fewer inputs."""
    return journal_seeds()[::4]


def name_seeds() -> List[bytes]:
    """Names of robots that mean harm, and honest ones."""
    names = ("r1", "../../etc/passwd", "a\0b", "x" * 200, "ä" * 100, "..", "", "-rf", "\u202e", "a/b", "\n")
    return [bytes([2]) + b"Te" + bytes([len(n.encode())]) + n.encode() for n in names] + [
        b"\xff\xf0\x9f\xa4\x96\xffabcd"
    ]


_TOKENS = tuple(bytes([way]) for way in range(9)) + (b"SQLite format 3\0", b"RSBBlog\n", b"RsbR", b"RsbS")

START = Target("start", start_steps, journal_seeds, _TOKENS, is_timed=False)
READ = Target("read", read_steps, read_seeds, _TOKENS, is_timed=False)
PORTS = Target("ports", port_steps, lambda: [
    b"6667\n6668\n", b"\n66", b"\xb2\n", "²\n٣\n".encode(), b"9" * 5000, b"\xff\xfe", b"-1 99999 0x1f", b"",
], (b"\n", b"6667", b"\0"))
NAMES = Target("names", name_steps, name_seeds, (b"/", b"..", b"\0", "é".encode(), b" "))
