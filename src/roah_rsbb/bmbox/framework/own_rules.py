"""Loads the rules of a functionality benchmark from a file of the competition: `modules/CODE.py`.

The file is the organiser's own code. Each fault in it is reported like an error in a configuration file, with file and
line. It does not affect other benchmarks.
"""

import ast
import inspect
import os
import sys
import traceback
import types
from typing import Dict, List, Optional, Type

from roah_rsbb.bmbox.framework.module import Module
from roah_rsbb.bmbox.framework.parameters import Parameter
from roah_rsbb.bmbox.framework.score import Value
from roah_rsbb.rulebook.errors import Place, Report, quote
from roah_rsbb.rulebook.registry import CODE
from roah_rsbb.rulebook.text_files import read_text

_PAGE = "docs/write_a_benchmark.md"


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
