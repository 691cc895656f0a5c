"""Reads result files of tests (JUnit's XML, as pytest and rostest write it): what failed, why and where."""

import pathlib
import re
import xml.etree.ElementTree as ElementTree
from typing import List, NamedTuple

# "test/pure/x.py:12: AssertionError" (pytest) and 'File "test/ros/x.py", line 12' (a traceback).
_PLACE = re.compile(r'(?:File ")?([\w/.+-]*test/[\w/.-]+\.py)(?:", line |:)(\d+)')
_SHOWN_LINES = 4


class Failure(NamedTuple):
    """A test case that failed."""

    case: str
    why: str  # the assertion
    place: str  # file and line; empty: not known


def failures(path: pathlib.Path) -> List[Failure]:
    """The failures in a result file; raises OSError or ElementTree.ParseError."""
    found = []
    for case in ElementTree.parse(path).getroot().iter("testcase"):
        for kind in ("failure", "error"):
            for problem in case.iter(kind):
                text = problem.text or problem.get("message") or ""
                found.append(Failure(_name(case), _why(text), _place(text)))
    return found


def _name(case: ElementTree.Element) -> str:
    kind = case.get("classname", "").rpartition(".")[2]
    return f"{kind}.{case.get('name')}" if kind else str(case.get("name"))


def _why(text: str) -> str:
    """Return the assertion: pytest's lines that begin with E, or everything before a traceback."""
    lines = [line[1:].strip() for line in text.splitlines() if line.startswith("E ")]
    if not lines:
        lines = text.partition('\n  File "')[0].splitlines()
    kept = [line for line in lines if line.strip()]
    return "\n".join(kept[:_SHOWN_LINES])


def _place(text: str) -> str:
    """Return the last line of a test in the traceback of the failure."""
    places = [place for place in _PLACE.findall(text) if "/python3" not in place[0]]
    if not places:
        return ""
    file, line = places[-1]
    return f"{file[file.index('test/'):]}:{line}"


def listed(failure: Failure) -> str:
    """A failure in lines of a report."""
    why = failure.why.replace("\n", "\n      ")
    return f"  {failure.case}" + (f" ({failure.place})" if failure.place else "") + f"\n      {why}"
