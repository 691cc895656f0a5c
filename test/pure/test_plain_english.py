"""Words that are never right in the texts of this project: in source, pages, messages, configuration and tests."""

import pathlib
import re
from typing import Dict, Iterator, List

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
FOLDERS = ("src", "test", "docs", "launch", "config", "resource", "tools", "bench", "scripts", "msg", "srv", "proto",
           "roah_rsbb_comm_ros")
SUFFIXES = {".py", ".md", ".msg", ".srv", ".proto", ".launch", ".xml", ".test", ".yaml", ".js", ".html", ".css", ""}
# Recordings and messages of the original package, whose texts never change, and this list.
EXCLUDED = ("test/data/", "test/fuzz/corpus/", "msg/CoreToGui.msg", "msg/CoreToPublic.msg",
            "test/pure/test_plain_english.py")

# Word (a regular expression) -> the usual term. An identifier counts as words with spaces instead of underscores.
INSTEAD: Dict[str, str] = {
    r"(?:un)?mend(?:s|ed|ing|able)?": "repair, retry or recover",
    r"tell(?:s|ing)?|told": "report, warn, log or publish",
    r"(?:go|goes|going|went|gone) on(?! (?:the|a|this|another|its|their) )": "continue or resume",
    r"rooms(?<!four rooms)": "packages or folders",
    r"what is none|what there is none of": "missing or not available",
    r"(?:stand|stands|stood) still": "paused or stopped",
    r"end of the time|end of time": "timeout",
    r"surroundings|mendabletruth": "the role of the thing",
    r"by chance": "random, randomly generated or by coincidence",
    r"look at the network": "check the network",
    r"(?:that|those) of then": "a whole sentence",
    r"must be what it asked for": "a whole sentence",
}
# Fields of saved states and of a message that other versions read, and the method of files.
KEPT = re.compile(
    r"\btold_(?:utc|invalid|ignored)\b|\.told\b|^ +told(?:: Optional\[Now\]| =)|\btold(?: is None|\.mono)|\.tell\(\)",
    re.MULTILINE)

_TERMS = list(INSTEAD.values())
_WRONG = re.compile(rf"(?<![a-z])(?:{'|'.join(f'({word})' for word in INSTEAD)})(?![a-z])", re.IGNORECASE)


def wrong_words(text: str) -> List[str]:
    """Every wrong word in a text, with its line and the usual term."""
    plain = KEPT.sub(lambda kept: " " * len(kept.group()), text).replace("_", " ")
    return [
        f"line {plain.count(chr(10), 0, match.start()) + 1}: '{match.group()}'; write {_TERMS[match.lastindex - 1]}"
        for match in _WRONG.finditer(plain)
    ]


def _files() -> Iterator[pathlib.Path]:
    yield from (ROOT / name for name in ("README.md", "Makefile", "setup.py", "CMakeLists.txt", "package.xml"))
    for folder in FOLDERS:
        for path in sorted((ROOT / folder).rglob("*")):
            is_ours = "__pycache__" not in path.parts and not path.relative_to(ROOT).as_posix().startswith(EXCLUDED)
            if path.suffix in SUFFIXES and is_ours and path.is_file():
                yield path


def test_all_files():
    found = [f"{path.relative_to(ROOT)}: {words}" for path in _files()
             for words in wrong_words(path.read_text(encoding="utf-8"))]
    assert found == []


@pytest.mark.parametrize("text, usual", [
    ("The disk is mended.", "repair"), ("def test_a_run_that_goes_on():", "continue"), ("the run goes on", "continue"),
    ("# The referee is told.", "report"), ("time stands still", "paused"), ("passwords, made by chance", "random"),
    ("the other rooms", "folders"), ("A recording, and what is none.", "missing"), ("class Surroundings:", "role"),
    ("No connection: look at the network.", "check the network"), ("after the end of the time", "timeout"),
])
def test_a_wrong_word_is_found(text, usual):
    (found,) = wrong_words(f"first line\n{text}\n")
    assert found.startswith("line 2: ") and usual in found


@pytest.mark.parametrize("text", [
    "recommended", "a flat with four rooms", "there is room for 40 robots", "run.told_utc", "at = file.tell()",
    "        told = self.state.told", "intelligent", "category on",
])
def test_other_words_are_not(text):
    assert wrong_words(text) == []
