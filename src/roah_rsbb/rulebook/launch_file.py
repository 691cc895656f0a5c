"""The launch file of a competition's folder, read as data."""

from typing import Dict, List, NamedTuple, Tuple
from xml.parsers import expat

from roah_rsbb.rulebook.errors import Place, Report
from roah_rsbb.rulebook.text_files import read_text

# An element's name, its attributes, and its line.
Element = Tuple[str, Dict[str, str], int]


class LaunchArgument(NamedTuple):
    """An argument of a launch file, as it is written there."""

    default: str
    doc: str


def elements(report: Report, path: str) -> List[Element]:
    """Return all elements of a file; those before an error, which is in the report."""
    found: List[Element] = []
    text = read_text(path, report, "the launch file")
    if text is None:
        return found
    parser = expat.ParserCreate()
    parser.StartElementHandler = lambda name, given: found.append((name, given, parser.CurrentLineNumber))
    try:
        parser.Parse(text, True)
    except expat.ExpatError as error:
        report.error(Place(path, error.lineno, error.offset + 1), f"invalid XML ({expat.ErrorString(error.code)})",
                     "each <tag> closed with </tag> or />, values in quotes, no -- within a comment")
    return found


def arguments(report: Report, path: str) -> Dict[str, LaunchArgument]:
    """Return the arguments of a file that have a default, by name; see `elements`."""
    return {given["name"]: LaunchArgument(given["default"], given.get("doc", ""))
            for name, given, _ in elements(report, path) if name == "arg" and {"name", "default"} <= given.keys()}
