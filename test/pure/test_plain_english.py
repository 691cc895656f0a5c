"""Words that are never right in texts and names of files: source, pages, messages, configuration and tests."""

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

# Word -> the usual term. A word is a regular expression in lower case. It begins with letters, so that searching all
# files is fast. An identifier counts as words with spaces instead of underscores.
_CONTINUE = "continue or resume"
INSTEAD: Dict[str, str] = {
    r"mend(?:s|ed|ing|able)?": "repair, retry or recover",
    r"unmended": "not repaired",
    r"tell(?:s|ing)?": "report, warn, log or publish",
    r"told": "report, warn, log or publish",
    r"go on(?! (?:the|a|this|another|its|their) )": _CONTINUE,
    r"goes on": _CONTINUE,
    r"going on": _CONTINUE,
    r"gone on": _CONTINUE,
    r"went on": _CONTINUE,
    r"rooms(?<!four rooms)": "packages or folders",
    r"what (?:is|are) no(?:ne)?": "missing, invalid or not available",
    r"anew": "again",
    r"stands? still": "paused or stopped",
    r"stood still": "paused or stopped",
    r"end of (?:the )?time": "timeout",
    r"surroundings": "context, or the role of the thing",
    r"mendabletruth": "the role of the thing",
    r"by chance": "random, randomly generated or by coincidence",
    r"look at the network": "check the network",
    r"of then": "a whole sentence",
}
# Fields of saved states and of a message that other versions read, and the method of files.
KEPT = re.compile(
    r"told_(?:utc|invalid|ignored)\b|\.told\b| told(?:: Optional\[Now\]| =)| told(?: is None|\.mono)|\.tell\(\)")

_WRONG = [(re.compile(rf"{word}(?![a-z])"), term) for word, term in INSTEAD.items()]


def wrong_words(text: str) -> List[str]:
    """Every wrong word in a text, with its line and the usual term."""
    plain = KEPT.sub(lambda kept: " " * len(kept.group()), text).lower().replace("_", " ")
    return [
        f"line {plain.count(chr(10), 0, match.start()) + 1}: '{match.group()}'; write {term}"
        for word, term in _WRONG for match in word.finditer(plain)
        if not plain[match.start() - 1:match.start()].isalpha()
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
             for words in wrong_words(path.name) + wrong_words(path.read_text(encoding="utf-8"))]
    assert found == []


@pytest.mark.parametrize("text, usual", [
    ("The disk is mended.", "repair"), ("The UNMENDED disk", "not repaired"),
    ("def test_a_run_that_goes_on():", "continue"),
    ("a run, which WENT ON", "continue"), ("# The referee is told.", "report"), ("time stands still", "paused"),
    ("passwords, made by chance", "random"), ("the other rooms", "folders"),
    ("A recording, and what is none.", "missing"),
    ("class Surroundings:", "role"), ("No connection: look at the network.", "check the network"),
    ("after the end of the time", "timeout"), ("def test_what_is_no_bag():", "invalid"),
    ("test_log_mending.py", "repair"),
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
