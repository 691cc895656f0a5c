"""The documentation's pages as these tests see them: headings, links, and blocks with what is to be done with them.

Comments that GitHub does not show say so, in the line before a block:

    <!-- file: NAME -->       the block is written to a file of this name
    <!-- run -->              its commands are run, and must succeed
    <!-- run: exit 1 -->      they are run, and must end with this status
    <!-- prints -->           it is what the last commands printed; … stands for anything
    <!-- sheet -->            it is the sheet of a benchmark (also <!-- runs -->, <!-- stages -->), and
    <!-- gives -->            these marks are worth these points
"""

import pathlib
import re
from typing import Iterator, List, NamedTuple

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGES = [
    ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md")), ROOT / "bench" / "README.md",
    *sorted((ROOT / "test").glob("*/README.md")),
]
NAMES = [str(page.relative_to(ROOT)) for page in PAGES]

_FENCE = re.compile(r"^( *)```(\S*) *$")
_MARK = re.compile(r"^ *<!-- *(file|runs?|prints|sheet|stages|gives)(?:: *(.*?))? *-->$")
_LINK = re.compile(r"\]\(([^)\s]+)\)")
_PLACEHOLDER = re.compile(r"<[a-z ]+>")


class Block(NamedTuple):
    """A fenced block."""

    page: str
    line: int  # of its fence
    language: str
    text: str
    mark: str  # one of those above, or empty
    given: str  # what the mark says behind its colon

    @property
    def where(self) -> str:
        """Page and line, for messages."""
        return f"{self.page}:{self.line}"


def blocks(page: str) -> List[Block]:
    """All fenced blocks of a page."""
    found: List[Block] = []
    before, fence, begin, inside = "", None, 0, []
    for number, line in enumerate((ROOT / page).read_text(encoding="utf-8").splitlines(), 1):
        match = _FENCE.match(line)
        if fence is None and match:
            fence, begin, inside = match, number, []
        elif fence is not None and match and not match.group(2):
            mark = _MARK.match(before)
            text = "".join(f"{each[len(fence.group(1)):]}\n" for each in inside)
            kind, given = (mark.group(1), mark.group(2) or "") if mark else ("", "")
            found.append(Block(page, begin, fence.group(2), text, kind, given))
            fence, before = None, ""
        elif fence is not None:
            inside.append(line)
        elif line.strip():
            before = line
    assert fence is None, f"{page}:{begin}: a block that is not closed"
    return found


def links(page: str) -> List[str]:
    """The targets of a page's links and pictures."""
    return _LINK.findall(prose(page))


def prose(page: str) -> str:
    """A page without its blocks."""
    return re.sub(r"^ *```.*?^ *```$", "", (ROOT / page).read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)


def anchors(page: str) -> List[str]:
    """Return the anchors of a page's headings, as GitHub generates them."""
    headings = re.findall(r"^#+ +(.*)$", prose(page), re.MULTILINE)
    names = [re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings]
    return [name if names.index(name) == number else f"{name}-{names[:number].count(name)}"
            for number, name in enumerate(names)]


def commands(block: Block) -> Iterator[str]:
    """The commands of a block, one at a time: continued lines joined, comments and placeholders taken out."""
    for line in block.text.replace("\\\n", " ").splitlines():
        if line.strip() and not line.lstrip().startswith("#"):
            yield _PLACEHOLDER.sub("placeholder", line.strip())
