"""Choices that a rule book leaves to people: `decide` in the place of any value (docs/rules.md).

A file names the choice and its readings with their values, such as ``{decide: Finalists of nine teams, 4: 4, 3: 3}``.
The first reading is the default; ``decisions.yaml`` in the same folder may choose another one. `resolved` puts the
chosen values in their places before the file is read, so that no other reader needs to know of choices. The value
``nothing`` leaves out what it stands for: a key, or an entry of a sequence.
"""

import os
from dataclasses import replace
from typing import Dict, Iterable, List, NamedTuple, Optional, Set, Tuple

from roah_rsbb.model.rules import Decision
from roah_rsbb.rulebook.errors import Place, Report, is_known, quote
from roah_rsbb.rulebook.yaml_fields import describe, text
from roah_rsbb.rulebook.yaml_lines import Mapping, Node, Scalar, Sequence, Unusable, read_yaml
from roah_rsbb.wording.texts import did_you_mean

DECISIONS = "decisions.yaml"
DECIDE, NOTHING = "decide", "nothing"
# Keys whose values name an entry of a sequence.
_NAMES = ("code", "item", "section", "stage", "test", "name")
# The files of a folder in which values may be decided.
_FILES = ("benchmarks.yaml", "standings.yaml")
# The key of what hangs under a row, and has decisions of its own.
_ROWS = "items"
_SHAPE = "lines 'name of a choice: reading'"
_CHOICE = "two or more readings with their values, such as '{decide: Finalists of nine teams, 4: 4, 3: 3}'"


class Decided(NamedTuple):
    """A place where a value is decided."""

    decision: Decision
    place: Place
    where: Tuple[str, ...]  # the keys above it, and the names of what has them
    values: Tuple[str, ...]  # of the readings, as texts


def beside(path: str) -> str:
    """Return the path of the file that chooses for this file."""
    return os.path.join(os.path.dirname(path), DECISIONS)


def resolved(report: Report, root: Optional[Node], path: str) -> Tuple[Optional[Node], Tuple[Decided, ...]]:
    """Return the content of a file with the chosen values in their places, and where something was decided."""
    if root is None:
        return None, ()
    chosen = _chosen(report, path)
    found = _Resolver(report, chosen)
    node = found.value(root) or Mapping(root.place, (), whole=True)
    _report_unknown(report, chosen, path, found)
    return node, tuple(found.places)


def decided_in(report: Report, path: str) -> Tuple[Decided, ...]:
    """Return where a file, which may be missing, leaves something to people."""
    if not is_known(path, path):
        return ()
    return resolved(report, read_yaml(path, report, "the rules", "rules"), path)[1]


def decisions_in(*found: Iterable[Decided]) -> Tuple[Decision, ...]:
    """Return the choices of these places, each once."""
    return tuple(dict.fromkeys(each.decision for places in found for each in places))


def _chosen(report: Report, path: str) -> Dict[str, Tuple[Scalar, Node]]:
    """Read what the competition chose: readings by names."""
    own = beside(path)
    if not is_known(own, path):
        return {}
    root = read_yaml(own, report, "the file of decisions", _SHAPE)
    if root is None or isinstance(root, Unusable):
        return {}
    if not isinstance(root, Mapping):
        report.error(root.place, f"{describe(root)} as the file's content", _SHAPE)
        return {}
    return {key.text: (key, value) for key, value in root.pairs}


def _report_unknown(report: Report, chosen: Dict[str, Tuple[Scalar, Node]], path: str, found: "_Resolver") -> None:
    """Report names in the file of decisions that are in no file of the folder."""
    unknown = [key for name, (key, _) in chosen.items() if name not in found.names()]
    if not unknown:
        return
    names = found.names()
    for name in _FILES:
        other = os.path.join(os.path.dirname(path), name)
        if other != path and is_known(other, path):
            quiet = Report()
            root = read_yaml(other, quiet, "", "")
            walked = _Resolver(quiet, {})
            if root is not None:
                walked.value(root)
            names |= walked.names()
    for key in unknown:
        if key.text not in names:
            expected = "a choice of the rules" + (did_you_mean(key.text, sorted(names)) if names else ": there is none")
            report.error(key.place, f"the unknown choice {quote(key.text)}", expected)


class _Resolver:
    """Puts values in their places."""

    def __init__(self, report: Report, chosen: Dict[str, Tuple[Scalar, Node]]) -> None:
        self.places: List[Decided] = []
        self._report = report
        self._chosen = chosen
        self._first: Dict[str, Decided] = {}
        self._refused: Set[str] = set()  # choices whose reading is unknown: reported once
        self._here: List[str] = []  # what was chosen in the map that is read now

    def names(self) -> Set[str]:
        """Return the names of the choices."""
        return set(self._first)

    def value(self, node: Node, where: Tuple[str, ...] = ()) -> Optional[Node]:
        """Return a node with the chosen values; None: it is left out. `where`: what is above it."""
        if isinstance(node, Sequence):
            items = [self.value(item, (*where[:-1], *_name(item, where[-1:]))) for item in node.items]
            return Sequence(node.place, tuple(item for item in items if item is not None))
        if not isinstance(node, Mapping):
            return node
        if any(key.text == DECIDE for key, _ in node.pairs):
            return self._decided(node, where)
        pairs, found = [], []
        for key, value in node.pairs:
            resolved_value, here = self._apart(value, (*where, key.text))
            pairs.append((key, resolved_value))
            found += [] if key.text == _ROWS else here
        self._here += found
        return Mapping(node.place, tuple((key, value) for key, value in pairs if value is not None), node.whole,
                       tuple(found))

    def _decided(self, node: Mapping, where: Tuple[str, ...]) -> Optional[Node]:
        name = text(self._report, next(value for key, value in node.pairs if key.text == DECIDE), "name of a choice")
        pairs = [(key, value) for key, value in node.pairs if key.text != DECIDE]
        values = {key.text: (None, []) if _is_nothing(value) else self._apart(value, where) for key, value in pairs}
        if name is None or not node.whole:
            return Unusable(node.place)
        if len(pairs) < 2:
            self._report.error(node.place, f"the choice {quote(name)} with {len(pairs)} readings", _CHOICE)
            return Unusable(node.place)
        readings = tuple(values)
        first = self._first.get(name)
        if first is not None and first.decision.readings != readings:
            self._report.error(
                node.place, f"the choice {quote(name)} with the readings {', '.join(map(quote, readings))}",
                f"those of line {first.place.line} in their order: {', '.join(map(quote, first.decision.readings))}")
            return Unusable(node.place)
        chosen = self._reading(name, readings)
        decided = Decided(Decision(name, readings, chosen), node.place, where,
                          tuple(_shown(value) for _, value in pairs))
        self._first.setdefault(name, decided)
        self.places.append(decided)
        found, inner = values[chosen]
        said = f"{name}: {chosen}"
        self._here += [said, *inner]
        return replace(found, decided=(said, *found.decided)) if isinstance(found, Mapping) else found

    def _apart(self, node: Node, where: Tuple[str, ...]) -> Tuple[Optional[Node], List[str]]:
        """Return a node with the chosen values, and what was chosen in it."""
        around, self._here = self._here, []
        found, here = self.value(node, where), self._here
        self._here = around
        return found, here

    def _reading(self, name: str, readings: Tuple[str, ...]) -> str:
        """Return the reading that was chosen."""
        if name not in self._chosen:
            return readings[0]
        node = self._chosen[name][1]
        word = node.text if isinstance(node, Scalar) else ""
        if word in readings:
            return word
        if name not in self._refused and not isinstance(node, Unusable):
            self._report.error(node.place, f"{describe(node)} as reading of {quote(name)}",
                               "one of its readings" + did_you_mean(word, readings))
        self._refused.add(name)
        return readings[0]


def _name(entry: Node, key: Tuple[str, ...]) -> Tuple[str, ...]:
    """Return the name of an entry of a sequence, or else the key of the sequence."""
    pairs = entry.pairs if isinstance(entry, Mapping) else ()
    found = {each.text: value.text for each, value in pairs if isinstance(value, Scalar)}
    return next(((found[name],) for name in _NAMES if name in found), key)


def _is_nothing(node: Node) -> bool:
    return isinstance(node, Scalar) and node.text == NOTHING and not node.quoted


def _shown(node: Node) -> str:
    """Return a value in one line, as a file has it."""
    if isinstance(node, Scalar):
        return node.text
    if isinstance(node, Sequence):
        return f"[{', '.join(map(_shown, node.items))}]"
    pairs = node.pairs if isinstance(node, Mapping) else ()
    return "{" + ", ".join(f"{key.text}: {_shown(value)}" for key, value in pairs) + "}"
