"""Files that people write: configuration, passwords, maps. Errors are those that are documented, and nothing else."""

import atexit
import os
import pathlib
import shutil
import tempfile
from typing import Callable, Iterator, List, Optional

from fuzzing.target import Step, Target
from roah_rsbb.bmbox.framework.parameters import read_parameters
from roah_rsbb.bmbox.hopf import HOPF
from roah_rsbb.bmbox.host import ground_truth_of_frames
from roah_rsbb.rulebook import config
from roah_rsbb.rulebook.errors import MAX_ERRORS, ConfigErrors, Report
from roah_rsbb.tablet import maps
from roah_rsbb.tools.competition.plan import VenueClock
from roah_rsbb.tools.competition.sheet import read_sheet

_ROOT = pathlib.Path(__file__).resolve().parents[3]
# Between the files in an input.
_CUT = b"\n=====\n"
# What is larger takes longer, and says no more.
_LONGEST = 20_000
_NAMES = ("benchmarks", "schedule", "passwords")
_SMALL = {
    "benchmarks": b"- code: HGTKMH\n  name: Tour\n  desc: A tour\n  timeout: 600\n  scoring:\n"
                  b"    - Achievements:\n        - {desc: finds the door, type: bool}\n",
    "schedule": b"- zone: Home\n  schedule:\n    - {benchmark: HGTKMH, team: Alpha, round: 1, run: 1, "
                b"scheduled_time: 2026-01-01 10:00:00}\n",
    "passwords": b"Alpha: secret1234\n",
}


class _Folder:
    """A folder for the files of one input after the other."""

    def __init__(self) -> None:
        self._path: Optional[str] = None

    def file(self, name: str, data: bytes) -> str:
        """The path of a file with this content."""
        if self._path is None:
            self._path = tempfile.mkdtemp(prefix="roah_rsbb_fuzz_")
            atexit.register(shutil.rmtree, self._path, ignore_errors=True)
        path = os.path.join(self._path, name)
        with open(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600), "wb") as file:
            file.write(data[:_LONGEST])
        return path


_FOLDER = _Folder()


def _load_all(data: bytes) -> None:
    """The three files of the box: those that the input has not are small ones in order."""
    parts = dict(zip(_NAMES, data.split(_CUT)))
    paths = [_FOLDER.file(name, parts.get(name) or _SMALL[name]) for name in _NAMES]
    try:
        loaded, warnings = config.load(*paths)
    except ConfigErrors as errors:
        assert errors.errors
        report = str(errors)
    else:
        assert all(zone.events for zone in loaded.zones)
        report = "\n".join(warnings)
    assert "secret1234" not in report or any(b"secret1234" in parts.get(name, b"") for name in _NAMES[:2])


def _load_ground_truth(data: bytes) -> None:
    try:
        loaded = ground_truth_of_frames.load(_FOLDER.file("ground_truth.yaml", data))
    except ConfigErrors as errors:
        assert errors.errors
    else:
        loaded.all_markers()


def _load_parameters(data: bytes) -> None:
    try:
        loaded = read_parameters(_FOLDER.file("hopf.yaml", data), HOPF.CODE, HOPF.PARAMETERS)
    except ConfigErrors as errors:
        assert errors.errors
    else:
        assert loaded.items


def _load_sheet(data: bytes) -> None:
    report = Report()
    try:
        plan = read_sheet(_FOLDER.file("sheet.csv", data), report, VenueClock("+01:00"))
    except ConfigErrors:
        assert len(report.errors) >= MAX_ERRORS
        return
    assert (plan is None) is bool(report.errors)
    assert all(error.found and error.expected and "\n" not in str(error) for error in report.errors)


def _load_map(data: bytes) -> None:
    parts = data.split(_CUT, 1)
    _FOLDER.file("map.pgm", parts[1] if len(parts) > 1 else b"P5 2 1 255\n\x00\xff")
    try:
        loaded = maps.load(_FOLDER.file("map.yaml", parts[0]))
    except maps.MapError as error:
        assert "\n" not in str(error)
        return
    x, y = loaded.to_metres(0.5, 0.5)
    assert abs(x) < float("inf")
    assert abs(y) < float("inf")
    loaded.to_image(x, y)


def _steps(load: Callable[[bytes], None]) -> Callable[[bytes], Iterator[Step]]:
    def steps(data: bytes) -> Iterator[Step]:
        yield lambda: load(data)
    return steps


# -- inputs to begin with ---------------------------------------------------------------------------------


def _joined(*parts: bytes) -> bytes:
    return _CUT.join(parts)


_PASSWORDS = (
    b"Alpha: secret1234\nBeta: 'it''s'\nGamma: \"a\\\"b\"\n", b"--- \nAlpha: x # y\n", b"# c\n\nAlpha: a:b\n",
    b"a b : c d\n", "Ä: ö\n".encode(), b"Alpha: x\nAlpha: y\n", b"Alpha: 12\n", b"Alpha: 0x_\n", b"Alpha: 1:2\n",
    b"Alpha: =\n", b"Alpha: <<\n", b"'<<': x\n", b"ALL: x\n", b"\xef\xbb\xbfAlpha: x\n", b"A: " + b"b:" * 500,
    b"A: b\x85c\n", "A: b\u2028c\n".encode(), b"A: \x07\n", b"x" * 101 + b": y\n", b"A: y\n", b"y: n\n",
)


def _config_seeds() -> List[bytes]:
    small = _joined(*(_SMALL[name] for name in _NAMES))
    bad = (
        b"", b"\0", b"\xff\xfe", b"[" * 30, b"&a [*a]", b"a: &a b\nc: *a", b"!!python/object:os.system {}", b"a: a: a",
        b"\ta: 1", b"? [a]\n: b\n", b"- 1\n- 2", b"9" * 5000, b"Alpha: [secret1234", b"Alpha: 'secret1234\n",
        b"Alpha: \"\\ud800\"\n", b"Alpha: \"\\UFFFFFFFF\"\n", b"%YAML 1.99999999999999999999\n---\nAlpha: x\n",
    )
    files = [(_ROOT / "config" / f"{name}.yaml").read_bytes()[:1500] for name in _NAMES]
    return [small, _joined(*files)] + [
        _joined(*(wrong if name == at else _SMALL[name] for name in _NAMES)) for wrong in bad for at in _NAMES
    ] + [_joined(_SMALL["benchmarks"], _SMALL["schedule"], passwords) for passwords in _PASSWORDS]


def _shipped(*names: str) -> List[bytes]:
    found = [path for name in names for path in sorted((_ROOT / "config").rglob(name))]
    assert found, names
    return [path.read_bytes()[:3000] for path in found] + [b"", b"[" * 100, b"a: 1\na: 2\n", b"&a [*a]", b"!!int 1"]


def _sheet_seeds() -> List[bytes]:
    head = b"zone,benchmark,team,date,time\n"
    row = b"Home,HGTKMH,A,2026-11-28,09:00\n"
    last = row.replace(b"2026-11-28", b"9999-12-31")
    return [
        head + row, head.replace(b",", b";") + row.replace(b",", b";"), b"", head, row, head + b'"Home\n',
        head + b"\0\n", b"round,run," + head + b"1,999999999999999999999," + row, b"\xef\xbb\xbf" + head + row,
        head + b"," * 5000, last, head + last, head + last.replace(b"09:00", b"99:99"), head + row * 200,
        head + row.replace(b"2026", b"0001"), head + row.replace(b"HGTKMH", b"=1+1"),
        head + b'"' + b"x" * 140_000 + b'"', head + last.replace(b"09:00", b"23:59"), head + b"\r" + row,
        b"zone\tteam\n\t",
    ]


def _map_seeds() -> List[bytes]:
    yaml = b"image: map.pgm\nresolution: 0.05\norigin: [-1.0, 2.0, 0.5]\nnegate: 0\n"
    pgm = (
        b"P5 2 2 255\n\x00\x01\x02\x03", b"P2\n# c\n2 2 15\n0 1 2 15\n", b"P5 8192 8192 65535\n",
        b"P2 1 1 65535\n99999",
        b"P5 99999999999999999999 1 1\n", b"P5 1 1 0\n\0", b"P6 1 1 255\n", maps.PNG_SIGNATURE + b"\0" * 20,
        maps.write_png(maps.Grey(2, 1, b"\0\xff")), b"P2 2 1 255\n" + b"9" * 5000, b"P5\n#",
    )
    wrong = (
        b"", b"image: map.pgm\nresolution: 1e999\norigin: [0,0,0]", b"[" * 300, b"&a [*a]", b"resolution: .nan",
        b"image: [1]\nresolution: 1\norigin: [1,2,3]", b"image: /dev/zero\nresolution: 1\norigin: [1,2,3]",
        b"image: \"a\\0b\"\nresolution: 1\norigin: [1,2,3]", b"resolution: 1\norigin: [1,2," + b"9" * 400 + b"]",
        b"a: 2015-99-99\n", b"!!python/object/apply:os.system [ls]", b"!!timestamp x", b"? {a: 1}\n: 2\n",
        b"negate: [1]\nimage: map.pgm\nresolution: 1\norigin: [1,2,3]",
        b"a: &a [x,x]\nb: &b [*a,*a]\nc: &c [*b,*b]\nresolution: *c\n", b"resolution: " + b"9" * 5000,
        b"image: \"\\ud800\"\nresolution: 1\norigin: [1,2,3]", b"!!int ''", b"!!float x", b"!!int 1_:2",
    )
    return [_joined(yaml, image) for image in pgm] + [_joined(text, pgm[0]) for text in wrong]


_YAML = tuple(token.encode() for token in (
    "- ", ": ", "  ", "[", "]", "{", "}", "&a ", "*a", "!!int ", "!!python/name:os ", "'", '"', "|\n", ">-\n", "\n",
    "#", "---\n", "<<: ", ".nan", "1e999", "0x1f", "%YAML 1.1\n", "\u2028", "\ufeff", "\\ud800", "\t", "null",
    "2015-01-01",
    "benchmark", "code", "team", "zone", "schedule", "scoring", "timeout", "round", "time", "frame", "markers",
    "transform", "items", "goals", "resolution", "origin", "image", "negate",
)) + (_CUT, b"P5 ", b"P2 ", b"9" * 5000)

CONFIGURATION = Target("configuration", _steps(_load_all), _config_seeds, _YAML, is_timed=False)
GROUND_TRUTH = Target(
    "ground_truth", _steps(_load_ground_truth), lambda: _shipped("ground_truth.yaml"), _YAML, is_timed=False)
PARAMETERS = Target("parameters", _steps(_load_parameters), lambda: _shipped("HOPF.yaml"), _YAML, is_timed=False)
SHEET = Target("sheet", _steps(_load_sheet), _sheet_seeds, (
    b",", b";", b"\t", b'"', b"\n", b"\r", b"2026-11-28", b"0001-01-01", b"9999-12-31", b"23:59", b"HWV", b"ALL",
    b"round", b"run", b"zone", b"team", b"\0", "\u2028".encode(),
), is_timed=False)
MAP = Target("map", _steps(_load_map), _map_seeds, _YAML, is_timed=False)
