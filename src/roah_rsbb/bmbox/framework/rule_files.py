"""The files of rules: finds those of the package in `bmbox/` and those of a competition in `modules/`, and loads them.

A competition's rules, parameters and ground truth may differ from zone to zone, and may change at any time.
"""

import ast
import contextlib
import importlib
import inspect
import multiprocessing
import os
import pkgutil
import sys
import traceback
import types
from typing import Callable, Dict, Generic, List, Optional, Tuple, Type, TypeVar

from roah_rsbb import bmbox
from roah_rsbb.bmbox.framework.module import Module
from roah_rsbb.bmbox.framework.parameters import Parameter
from roah_rsbb.bmbox.framework.score import Value
from roah_rsbb.rulebook.errors import ConfigErrors, Place, Report, quote, read_text
from roah_rsbb.rulebook.registry import CODE

# -- the rules of the package -------------------------------------------------------------------------

def modules(report: Optional[Callable[[str], None]] = None) -> Dict[str, Type[Module]]:
    """Return the modules by code.

    An invalid file, or a second file for the same code, raises an exception. If `report` is given, it is called with
    the reason instead, and only that file is omitted.
    """
    found: Dict[str, Type[Module]] = {}
    for info in pkgutil.iter_modules(bmbox.__path__):
        try:
            for kind in _of_file(info.name).values():
                if kind.CODE in found:
                    raise ValueError(f"{kind.__module__} and {found[kind.CODE].__module__} both define {kind.CODE}")
                found[kind.CODE] = kind
        except Exception as error:  # the file may contain any error
            if report is None:
                raise
            trace = "".join(traceback.format_exception(type(error), error, error.__traceback__))
            report(f"{info.name}.py cannot be used. Repair it and restart: {error}\n{trace}")
    return found


def _of_file(name: str) -> Dict[str, Type[Module]]:
    file = importlib.import_module(f"{bmbox.__name__}.{name}")
    return {
        name: kind for name, kind in inspect.getmembers(file, inspect.isclass)
        if issubclass(kind, Module) and kind.CODE and kind.__module__ == file.__name__
    }


# -- the rules of a competition -----------------------------------------------------------------------

# `modules/CODE.py` is the organiser's own code. Each fault in it is reported like an error in a configuration file,
# with file and line. It does not affect other benchmarks.

_PAGE = "docs/write_a_benchmark.md"
# Seconds in which rules must be loaded.
TRIAL_S = 10.0


def own_files(folder: str) -> Dict[str, str]:
    """Return the paths of the files with rules in a folder, by code. Files whose names begin with _ are not rules."""
    try:
        names = sorted(os.listdir(folder))
    except OSError:
        return {}
    codes = [name[:-len(".py")] for name in names if name.endswith(".py")]
    return {code: os.path.join(folder, f"{code}.py") for code in codes if CODE.fullmatch(code)}


def load_rules(path: str) -> Type[Module]:
    """Load the benchmarking module from a file that is named after the benchmark's code; raises ConfigErrors."""
    report = Report()
    code = os.path.splitext(os.path.basename(path))[0]
    text = read_text(path, report, f"the rules of {code}")
    report.raise_errors()
    found = _classes(report, path, code, text)
    report.raise_errors()
    lines = {node.name: node.lineno for node in ast.walk(ast.parse(text)) if isinstance(node, ast.ClassDef)}
    kinds = [kind for kind in found if code == kind.CODE]
    if not kinds:
        others = ", ".join(f"{kind.__name__} with CODE = {kind.CODE!r}" for kind in found) or "no class with a CODE"
        line = lines.get(found[0].__name__, 0) if found else 0
        report.error(Place(path, line, 0), others, f"a class derived from Module with CODE = {code!r}")
    for kind in kinds[1:]:
        report.error(Place(path, lines.get(kind.__name__, 0), 0), f"a second class with CODE = {code!r}", "one")
    report.raise_errors()
    _check(report, Place(path, lines.get(kinds[0].__name__, 0), 0), kinds[0])
    report.raise_errors()
    kinds[0].FILE = path
    return kinds[0]


def load_tried(path: str) -> Type[Module]:
    """As `load_rules`, for a program that must not end with the rules: another process loads them first."""
    trial = multiprocessing.get_context("fork").Process(target=_try, args=[path], daemon=True)
    trial.start()
    trial.join(TRIAL_S)
    if trial.exitcode != 0:
        trial.kill()
        refuse_ending(path)
    return load_rules(path)


def _try(path: str) -> None:
    with contextlib.suppress(ConfigErrors):
        load_rules(path)


def refuse_ending(path: str) -> None:
    """Raise the ConfigErrors of a file that cannot even be tried."""
    report = Report()
    report.error(Place(path, 0, 0), "rules that end their process, or hang, while they are loaded",
                 "rules that can be loaded: correct the file, then save it")
    report.raise_errors()


def _classes(report: Report, path: str, code: str, text: str) -> List[Type[Module]]:
    """Run the file and return its benchmarking modules."""
    name = f"roah_rsbb_rules_{code}"
    file = types.ModuleType(name)
    file.__file__ = path
    sys.modules[name] = file  # dataclasses and others look up a class's module there
    try:
        exec(compile(text, path, "exec"), file.__dict__)
    except SyntaxError as error:
        if error.filename == path:
            place = Place(path, error.lineno or 0, error.offset or 0)
            report.error(place, f"invalid Python ({error.msg})", f"rules as in {_PAGE}")
        else:
            report.error(Place(path, _line(path, error), 0), _words(error), f"rules that can be loaded ({_PAGE})")
        return []
    except (Exception, SystemExit) as error:
        report.error(Place(path, _line(path, error), 0), _words(error), f"rules that can be loaded ({_PAGE})")
        return []
    return [kind for _, kind in inspect.getmembers(file, inspect.isclass)
            if issubclass(kind, Module) and kind.CODE and kind.__module__ == name]


def _check(report: Report, place: Place, kind: Type[Module]) -> None:
    """Check what the rules declare."""
    if not inspect.iscoroutinefunction(kind.execute) or kind.execute is Module.execute:
        report.error(place, f"no rules in {kind.__name__}", "a method 'async def execute(self)'")
    for name, of, example in (("PARAMETERS", Parameter, "Seconds()"), ("SCORES", Value, 'Value("Reached")'),
                              ("EACH", Value, 'Value("Time", "s")')):
        declared = getattr(kind, name)
        if not isinstance(declared, dict):
            report.error(place, f"{quote(repr(declared))} as {name}", f'a dict, such as {{"name": {example}}}')
            continue
        for key, value in declared.items():
            if not isinstance(key, str) or not isinstance(value, of):
                report.error(place, f"{quote(f'{key!r}: {value!r}')} in {name}", f'something like "name": {example}')


def place_of(path: str, error: BaseException) -> str:
    """Return ``file:line`` of an exception in the rules of a file."""
    line = _line(path, error)
    return f"{path}:{line}" if line else path


def _line(path: str, error: BaseException) -> int:
    """Return the line in this file that an exception comes from; 0 if it comes from another file."""
    lines: List[Optional[int]] = [
        frame.lineno for frame in traceback.extract_tb(error.__traceback__) if frame.filename == path]
    return lines[-1] or 0 if lines else 0


def _words(error: BaseException) -> str:
    return f"{type(error).__name__}: {error}"


# -- files of a zone ----------------------------------------------------------------------------------

# A file `modules/ZONE/NAME` replaces `modules/NAME` for the runs in that zone, as a whole. So two arenas can run the
# same benchmark at once, with their own waypoints and markers.

# Folders with such names belong to tools, such as editors.
_NOT_ZONES = (".", "_")


def zone_folders(folder: str) -> List[str]:
    """Return the names of the zones that have files of their own, sorted."""
    try:
        names = sorted(os.listdir(folder))
    except OSError:
        return []
    return [name for name in names if not name.startswith(_NOT_ZONES) and os.path.isdir(os.path.join(folder, name))]


def file_in(folder: str, zone: str, name: str) -> str:
    """Return the path of the file that applies in a zone: its own, or else the one of all zones."""
    own = own_file(folder, zone, name)
    return own if own and os.path.lexists(own) else os.path.join(folder, name)


def own_file(folder: str, zone: str, name: str) -> str:
    """Return the path of a zone's own file, whether it exists or not; empty if no folder can have the zone's name."""
    if not zone or "/" in zone or "\0" in zone or zone.startswith(_NOT_ZONES):
        return ""
    return os.path.join(folder, zone, name)


# -- files that change --------------------------------------------------------------------------------

T = TypeVar("T")


class WatchedFile(Generic[T]):
    """A file with its content, as returned by `read` (which raises ConfigErrors)."""

    def __init__(self, path: str, read: Callable[[], T]) -> None:
        self.path = path
        self._read = read
        self._seen: Optional[Tuple[int, ...]] = None
        self._content: Optional[T] = None
        self._errors: Optional[ConfigErrors] = None
        self.reload()

    def forget(self) -> None:
        """Read the file at the next opportunity, whether it changed or not."""
        self._seen = None

    def reload(self) -> bool:
        """Read the file if it changed; returns whether it was read."""
        seen = signature(self.path)
        if seen == self._seen:
            return False
        self._seen = seen
        try:
            self._content, self._errors = self._read(), None
        except ConfigErrors as errors:
            self._content, self._errors = None, errors
        return True

    def content(self) -> T:
        """The present content; raises ConfigErrors."""
        self.reload()
        if self._errors is not None:
            raise self._errors
        return self._content

    @property
    def problems(self) -> List[str]:
        """The errors in the file, one per line."""
        return [] if self._errors is None else str(self._errors).splitlines()


def signature(path: str) -> Tuple[int, ...]:
    """A value that changes with the file's content; empty if the file is not accessible."""
    try:
        found = os.stat(path)
    except OSError:
        return ()
    return found.st_ino, found.st_size, found.st_mtime_ns
