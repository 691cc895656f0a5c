"""Rulebooks: what competitions of one kind have in common (docs/organiser.md, "Rulebooks").

A rulebook is a folder with any of the files of a competition. The included files in ``config/`` stand in for the files
that it lacks, so that each piece of knowledge is in one place. Its file ``rulebook.yaml`` has the answers to the
questions of `new_competition` that the organiser need not answer again.
"""

import os
import re
from typing import Collection, Dict, Iterator, List, Mapping, NamedTuple, Optional, Sequence, Tuple

from roah_rsbb.model.rules import Decision
from roah_rsbb.rulebook.benchmarks import Benchmark
from roah_rsbb.rulebook.config import BenchmarksFile
from roah_rsbb.rulebook.decisions import decided_in, decisions_in
from roah_rsbb.rulebook.errors import ConfigErrors, Place, Report, known, listing, quote
from roah_rsbb.rulebook.registry import BenchmarkKind
from roah_rsbb.rulebook.standing_rules import OVERALL, STAGES, read_rules
from roah_rsbb.rulebook.yaml_fields import describe, fields, text
from roah_rsbb.rulebook.yaml_lines import Mapping as MapNode
from roah_rsbb.rulebook.yaml_lines import Node, Scalar, Unusable, read_yaml
from roah_rsbb.rulebook.yaml_lines import Sequence as SequenceNode
from roah_rsbb.wording.texts import did_you_mean

BENCHMARKS, STANDINGS, RULEBOOK = "benchmarks.yaml", "standings.yaml", "rulebook.yaml"
FOLDER = "rulebooks"
# The options of `new_competition` that a rulebook can answer, with examples.
ANSWERS = {
    "benchmarks": "all", "zones": "'Home, Arena'", "daily": "all", "arenas": "2", "rounds": "1",
    "decisions": "Posters", "begin": '"09:00"', "end": '"18:00"',
    "every": "15", "breaks": "12:30-13:30",
}
_SHAPE = "a map 'title: ...' and the defaults of options, such as 'benchmarks: all'"

Benchmarks = Mapping[str, Benchmark]  # by code, in the file's order


class RulebookAnswer(NamedTuple):
    """The rulebook's answer to a question, and where it stands."""

    place: Place
    text: str


class Rulebook(NamedTuple):
    """A rulebook that was read."""

    folder: str
    config_dir: str  # of the files that it lacks
    benchmarks: Benchmarks
    answers: Dict[str, RulebookAnswer]  # by option

    def path(self, name: str) -> str:
        """The path of a file: the rulebook's own, or the included one."""
        own = os.path.join(self.folder, name)
        return own if os.path.lexists(own) else os.path.join(self.config_dir, name)

    def decisions(self) -> Tuple[Decision, ...]:
        """What its rules leave to people."""
        return decisions_in(*(decided_in(Report(), self.path(name)) for name in (BENCHMARKS, STANDINGS)))

    def for_all(self, code: str) -> bool:
        """Whether all robots do this benchmark at once."""
        return self.benchmarks[code].kind is BenchmarkKind.ALL_ROBOTS


def names(config_dir: str) -> List[str]:
    """The names of the included rulebooks."""
    try:
        return sorted(os.listdir(os.path.join(config_dir, FOLDER)))
    except OSError:
        return []


def folder_of(config_dir: str, name: str) -> str:
    """The folder of an included rulebook, or the one of this path."""
    return os.path.join(config_dir, FOLDER, name) if name in names(config_dir) else name


def read_rulebook(report: Report, config_dir: str, name: Optional[str] = None) -> Rulebook:
    """Read an included rulebook by its name, or the one in a folder; without `name`, the included files.

    Errors are added to the report.
    """
    folder = config_dir
    if name is not None:
        folder, known = folder_of(config_dir, name), names(config_dir)
        if not os.path.isdir(folder):
            report.error(Place("--rulebook", 0, 0), f"no rulebook {quote(name)}",
                         f"{listing(known)}, or the path of a folder{did_you_mean(name, known)}")
            return Rulebook(folder, config_dir, {}, {})
    book = Rulebook(folder, config_dir, {}, {} if name is None else _answers(report, os.path.join(folder, RULEBOOK)))
    return book._replace(benchmarks=BenchmarksFile(book.path(BENCHMARKS), report).by_code)


def _answers(report: Report, path: str) -> Dict[str, RulebookAnswer]:
    """Read the file of a rulebook; it may be missing."""
    if not os.path.lexists(path):
        return {}
    root = read_yaml(path, report, "the file of a rulebook", _SHAPE)
    got = None if root is None else fields(report, root, "a rulebook", {"title": "RoCKIn@Home 2015"}, ANSWERS)
    if got is None:
        return {}
    text(report, got.get("title"), "title")
    found: Dict[str, RulebookAnswer] = {}
    for option, node in got.items():
        if option == "title" or isinstance(node, Unusable):
            continue
        if isinstance(node, Scalar) and node.text.strip():
            found[option] = RulebookAnswer(node.place, node.text)
        else:
            report.error(node.place, f"{describe(node)} as {option}", f"a text, such as {ANSWERS[option]}")
    return found


# -- parts of files ---------------------------------------------------------------------------------

def benchmarks_text(path: str, content: str, codes: Sequence[str]) -> str:
    """A benchmarks file, reduced to these benchmarks."""
    root = read_yaml(path, Report(), "the benchmarks file", "benchmarks")
    nodes = root.items if isinstance(root, SequenceNode) else ()
    return _reduced(content, [(node.place.line, _code(node) in codes) for node in nodes], begin="-")


def standings_text(path: str, content: str, codes: Sequence[str]) -> str:
    """A file with the rules of standings, reduced to these benchmarks; empty without any rules for them."""
    content = _without_other_tests(path, content, codes)
    pairs = _pairs(path, content)
    entries = [(key.place.line, _is_about(key, node, codes)) for key, node in pairs]
    return _reduced(content, entries) if any(kept for _, kept in entries) else ""


def _pairs(path: str, content: str) -> Sequence[Tuple[Scalar, Node]]:
    with known({path: content}):
        root = read_yaml(path, Report(), "the rules of the standings", "benchmarks")
    return root.pairs if isinstance(root, MapNode) else ()


def _without_other_tests(path: str, content: str, codes: Sequence[str]) -> str:
    """The text without the lines of stages that are about other tests; unchanged if the rest cannot be read."""
    lines = re.findall("[^\n]*\n|[^\n]+", content)
    stages = next((node for key, node in _pairs(path, content) if key.text == STAGES), None)
    if stages is None:
        return content
    for begin, end in reversed(list(_other_tests(stages, codes, lines))):
        del lines[begin - 1:end]
    others = set(_named(stages)).difference(codes)
    shorter = re.sub(r"(?m)^( *ties: )\[(.*)\]\n", lambda found: _without(found, others), "".join(lines))
    try:
        with known({path: shorter}):
            read_rules(path, codes)
    except ConfigErrors:
        return content
    return shorter


def _other_tests(node: Node, codes: Sequence[str], lines: Sequence[str]) -> Iterator[Tuple[int, int]]:
    """The first and last lines of the smallest entries that name other tests and have lines of their own."""
    for child in _children(node):
        if not all(code in codes for code in _named(child)):
            inner = list(_other_tests(child, codes, lines))
            yield from inner
            begin = lines[child.place.line - 1][:child.place.column - 1]
            if not inner and isinstance(node, SequenceNode) and begin.strip() == "-":
                yield child.place.line, _last_line(child)


def _without(ties: "re.Match[str]", others: Collection[str]) -> str:
    names = [name for name in re.split(", *", ties.group(2)) if name not in others]
    return f"{ties.group(1)}[{', '.join(names)}]\n" if names else ""


def _children(node: Node) -> Sequence[Node]:
    if isinstance(node, MapNode):
        return [value for _, value in node.pairs]
    return node.items if isinstance(node, SequenceNode) else ()


def _last_line(node: Node) -> int:
    return max([node.place.line, *map(_last_line, _children(node))])


def _is_about(key: Scalar, node: Node, codes: Sequence[str]) -> bool:
    """Whether rules are only about these benchmarks: those of a benchmark, or the stages."""
    return key.text in codes or (key.text in (STAGES, OVERALL) and all(code in codes for code in _named(node)))


def _named(node: Node) -> Iterator[str]:
    """The benchmarks that stages name."""
    for key, value in node.pairs if isinstance(node, MapNode) else ():
        if key.text in ("test", "benchmark") and isinstance(value, Scalar):
            yield value.text
    for child in _children(node):
        yield from _named(child)


def _code(node: Node) -> Optional[str]:
    pairs = node.pairs if isinstance(node, MapNode) else ()
    return next((value.text for key, value in pairs if key.text == "code" and isinstance(value, Scalar)), None)


def _reduced(content: str, entries: Sequence[Tuple[int, bool]], begin: str = "") -> str:
    """Keep the head of a text, and the wanted ones of its entries: the line (from 1) of each, and whether to keep it.

    An entry begins with the comment directly above it. If entries share a line, the whole text is kept.
    """
    lines = re.findall("[^\n]*\n|[^\n]+", content)
    starts = [line - 1 for line, _ in entries]
    in_lines = all(lines[start].startswith(begin) for start in starts)
    if not in_lines or sorted(set(starts)) != starts:
        return content
    for number, start in enumerate(starts):
        while start > 0 and lines[start - 1].startswith("#"):
            start -= 1
        starts[number] = start
    ends = [*starts[1:], len(lines)]
    kept = [line for (_, keep), start, end in zip(entries, starts, ends) if keep for line in lines[start:end]]
    return "".join(lines[:starts[0]] if starts else lines) + "".join(kept).rstrip("\n") + "\n"
