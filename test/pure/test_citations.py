"""Every citation of a page, such as `docs/protocol.md, "Timing"`, names a page and a heading that exist."""

import functools
import pathlib
import re
from typing import Iterator, NamedTuple, Set

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
SUFFIXES = {".py", ".msg", ".srv", ".proto", ".launch", ".xml", ".test", ".yaml", ".js", ".html", ".css", ""}
FOLDERS = ("src", "scripts", "msg", "srv", "proto", "launch", "config", "resource", "tools", "bench", "test",
           "roah_rsbb_comm_ros")
# In a comment of several lines, a citation may continue after the sign of the next comment line.
_BREAK = re.compile(r"\s*\n\s*(?:#|//)?\s*")
_CITATION = re.compile(r'(?<![\w$/.-])((?:[\w-]+/)*[\w-]+\.md)((?:,| and) "[^"\n]+"(?:(?:,| and) "[^"\n]+")*)?')
_OTHER_FORM = re.compile(
    r"(?<![\w.])(?:wire protocol|ROS interface|manual|benchmarks|architecture), (?:[A-Z]|section|rule)")


class Citation(NamedTuple):
    """A page that a file names, and a heading of it; an empty heading: the whole page."""

    page: str
    heading: str


@functools.lru_cache(maxsize=None)
def headings(page: pathlib.Path) -> Set[str]:
    """The headings of a page, as they are written, without marks."""
    prose = re.sub(r"^ *```.*?^ *```$", "", page.read_text("utf-8"), flags=re.MULTILINE | re.DOTALL)
    return {heading.replace("`", "").replace("*", "") for heading in re.findall(r"^#+ +(.*)$", prose, re.MULTILINE)}


def citations(text: str) -> Iterator[Citation]:
    """All citations in a text."""
    for page, cited in _CITATION.findall(_BREAK.sub(" ", text)):
        yield from [Citation(page, heading) for heading in re.findall(r'"([^"]+)"', cited)] or [Citation(page, "")]


# Files that a program writes, with the same ending.
WRITTEN = ("scores.md", "standings.md")


def problem(folder: pathlib.Path, cited: Citation) -> str:
    """What is wrong with a citation in a file of `folder`; empty: nothing."""
    page = next((base / cited.page for base in (ROOT, ROOT / "docs", folder) if (base / cited.page).exists()), None)
    if cited.page in WRITTEN:
        return ""
    if page is None:
        return f"there is no page {cited.page}"
    if cited.heading and cited.heading not in headings(page):
        return f'{cited.page} has no heading "{cited.heading}"'
    return ""


FILES = sorted(path for folder in FOLDERS for path in (ROOT / folder).rglob("*")
               if path.is_file() and path.suffix in SUFFIXES and "__pycache__" not in path.parts
               and path != pathlib.Path(__file__).resolve() and "corpus" not in path.parts)


def problems(path: pathlib.Path) -> Iterator[str]:
    """What is wrong with the citations in a file."""
    text = path.read_text("utf-8")
    if ".md" in text:
        yield from filter(None, (problem(path.parent, cited) for cited in citations(text)))
    yield from (f"the citation {found!r} names no page" for found in _OTHER_FORM.findall(_BREAK.sub(" ", text)))


def test_citations_lead_somewhere():
    assert [f"{path.relative_to(ROOT)}: {found}" for path in FILES for found in problems(path)] == []


def test_there_are_citations():
    source = [path for path in FILES if ROOT / "src" in path.parents]
    assert sum(bool(cited.heading) for path in source for cited in citations(path.read_text("utf-8"))) > 60


@pytest.mark.parametrize("text, found", [
    ('(docs/protocol.md, "Timing")', [Citation("docs/protocol.md", "Timing")]),
    ('docs/protocol.md, "Robot\'s\n# next state".', [Citation("docs/protocol.md", "Robot's next state")]),
    ('docs/x.md, "Frame" and "Key".', [Citation("docs/x.md", "Frame"), Citation("docs/x.md", "Key")]),
    ("see README.md.", [Citation("README.md", "")]),
])
def test_what_a_citation_is(text, found):
    assert list(citations(text)) == found


@pytest.mark.parametrize("cited, wrong", [
    (Citation("docs/protocol.md", "Timing"), ""),
    (Citation("docs/protocol.md", "Time"), 'docs/protocol.md has no heading "Time"'),
    (Citation("docs/wire.md", ""), "there is no page docs/wire.md"),
])
def test_errors_in_citations(cited, wrong):
    assert problem(ROOT, cited) == wrong
