"""The score sheet of a run: the referee's marks for each item, and who changed what and when.

Items, their types and groups come from the benchmarks file (docs/benchmarks.md, "Scoring items of the TBMs").

Theory of operation. The sheet is its history. The value of an item is the value of its last entry that is not
withdrawn, or 0 if there is no such entry. One entry can therefore be withdrawn without changing the others. A saved
history can be read even if the benchmarks file has changed: entries of items that the file no longer has stay in the
history.

The history has a maximum length. Changes of an item by one person within a moment become one entry, because a referee
who counts with the mouse wheel makes ten changes a second. If there are too many entries, the oldest plain one that was
replaced is dropped, preferably one of the same person. Notes, withdrawals, and the values at the end of the run are
therefore never lost. The run log and the journal have each change in any case.
"""

from dataclasses import dataclass, field
from typing import Dict, List, NamedTuple, Optional, Tuple

from roah_rsbb.core.clock import Now
from roah_rsbb.core.referee import Refused
from roah_rsbb.core.scoring.records import ItemRecord, ScoreEntry
from roah_rsbb.rulebook.benchmarks import ScoreKind, ScoringItem
from roah_rsbb.wording.suggestions import did_you_mean

# `int32` on the ROS interface.
MAX_VALUE = 2**31 - 1
# Changes of an item by the same person within this time (s) after an entry belong to that entry.
ONE_ENTRY_S = 1.0
# Maximum number of entries besides two for each item, and how many of these may have a note or be withdrawn.
MAX_ENTRIES = 200
MAX_NOTED = 100

Key = Tuple[str, str]  # group and description of an item


def standing_text(value: int, not_attempted: bool) -> str:
    """Return the value of an item as text for the referee."""
    return "not attempted" if not_attempted else str(value)


def score_text(group: str, desc: str, old: str, value: str) -> str:
    """Describe an item's change to the referee. Both values are texts of `standing_text`."""
    return f"Score: {group}: {desc} {old} -> {value}"


class ScoreGroup(NamedTuple):
    """A group as the panels show it: its items and their values, in the file's order."""

    name: str
    items: Tuple[Tuple[ScoringItem, int], ...]


@dataclass
class SheetState:
    """The state of a score sheet is its history. A restart may change the items of the benchmarks file."""

    history: List[ScoreEntry] = field(default_factory=list)


class Mark(NamedTuple):
    """A change of an item that the referee requests."""

    group: str
    desc: str
    value: int = 0
    not_attempted: bool = False  # the robot did not try; then the value is ignored
    note: str = ""


class ScoreSheet:
    """All scoring items of one run with their history. Each begins at 0."""

    def __init__(self, items: Tuple[ScoringItem, ...], state: Optional[SheetState] = None) -> None:
        self.state = state or SheetState()
        self._history = self.state.history  # the same list
        self._items: Dict[Key, ScoringItem] = {(i.group, i.desc): i for i in items}
        self._standing: Dict[Key, ScoreEntry] = {}  # of each item, the last entry that is not withdrawn
        self._begun: Dict[int, float] = {}  # number of an item's newest entry -> monotonic time (s) of its first change
        self._groups: Optional[Tuple[ScoreGroup, ...]] = None  # as `groups` has them, until something changes
        self._marks: Optional[Tuple[bool, ...]] = None
        self._stand()

    @property
    def history(self) -> Tuple[ScoreEntry, ...]:
        """All entries, oldest first."""
        return tuple(self._history)

    # -- changing -----------------------------------------------------------------------------------

    def check(self, group: str, desc: str, value: int) -> None:
        """Raise `Refused` with the remedy if the item does not exist or cannot have this value."""
        item = self._items.get((group, desc))
        if item is None:
            raise Refused([self._unknown(group, desc)])
        if item.kind is ScoreKind.BOOL and value not in (0, 1):
            raise Refused([f"'{desc}' is yes or no: its value must be 0 or 1, not {value}"])
        if not 0 <= value <= MAX_VALUE:
            raise Refused([f"'{desc}' is a count: its value must be 0 or more, not {value}"])

    def set(self, now: Now, who: str, mark: Mark, correction: bool = False) -> ItemRecord:
        """Set an item, or mark it as not attempted. Returns the item before the change. Raises as `check` does.

        A value removes the mark. A call without a change and without a note makes no entry. `correction`: the run is
        over.
        """
        value = 0 if mark.not_attempted else mark.value
        self.check(mark.group, mark.desc, value)
        key = (mark.group, mark.desc)
        before = self._item(key)
        if not mark.note and (value, mark.not_attempted) == (before.value, before.not_attempted):
            return before
        if mark.note:
            self._check_noted("set the value without a note")
        entry = ScoreEntry(
            self._next_number(), now.utc, who, mark.group, mark.desc, before.value, value,
            mark.not_attempted, mark.note, before.not_attempted, correction,
        )
        same = self._same_moment(now, entry)
        if same is None:
            self._make_room()
            self._history.append(entry)
            self._begun[entry.number] = now.mono
        else:
            self._replace(same, entry)
        self._stand()
        return before

    def withdraw(self, now: Now, who: str, number: int, note: str = "", correction: bool = False) -> ScoreEntry:
        """Withdraw an entry. The item gets the value of the entry before, or 0. Returns the withdrawn entry. Raises
        `Refused`."""
        index = next((i for i, entry in enumerate(self._history) if entry.number == number), None)
        if index is None:
            raise Refused([f"the score sheet has no entry {number}: " + self._numbers()])
        entry = self._history[index]
        if entry.withdrawn_utc:
            raise Refused([f"entry {number} was withdrawn already, by {entry.withdrawn_by or 'somebody'}"])
        if _is_plain(entry):
            self._check_noted("set the value instead")
        self._history[index] = entry._replace(
            withdrawn_utc=now.utc, withdrawn_by=who, withdrawn_note=note, withdrawal_corrects=correction
        )
        self._begun.pop(number, None)
        self._stand()
        return entry

    def _same_moment(self, now: Now, entry: ScoreEntry) -> Optional[int]:
        """Return the index of the item's newest entry if this change belongs to it."""
        for index in reversed(range(len(self._history))):
            last = self._history[index]
            if (last.group, last.desc) == (entry.group, entry.desc):
                begun = self._begun.get(last.number)
                is_same = begun is not None and now.mono - begun <= ONE_ENTRY_S and _is_alike(last, entry)
                return index if is_same else None
        return None

    def _replace(self, index: int, entry: ScoreEntry) -> None:
        first = self._history[index]
        if (entry.value, entry.not_attempted) == (first.old, first.old_not_attempted):
            del self._history[index]  # a slip that was undone at once
            del self._begun[first.number]
        else:
            self._history[index] = entry._replace(
                number=first.number, old=first.old, old_not_attempted=first.old_not_attempted
            )

    def _make_room(self) -> None:
        """Drop one entry if there are too many."""
        if len(self._history) < MAX_ENTRIES + 2 * len(self._items):
            return
        pairs = self._replaced_pairs()
        alike = [pair for pair in pairs if self._history[pair[0]].who == self._history[pair[1]].who]
        for index, later in (alike or pairs)[-1:]:
            gone = self._history[index]
            self._history[later] = self._history[later]._replace(
                old=gone.old, old_not_attempted=gone.old_not_attempted
            )
            del self._history[index]
            self._begun.pop(gone.number, None)

    def _replaced_pairs(self) -> List[Tuple[int, int]]:
        """Return the indices of plain entries, each with that of the next plain entry of the same item; oldest last.

        If there are too many entries, some are always plain, because the number of others is limited.
        """
        pairs: List[Tuple[int, int]] = []
        newer: Dict[Key, int] = {}  # index of the next entry of the item
        for index in reversed(range(len(self._history))):
            entry = self._history[index]
            later = newer.get((entry.group, entry.desc))
            newer[entry.group, entry.desc] = index
            if later is not None and _may_replace(self._history[later], entry):
                pairs.append((index, later))
        return pairs

    def _check_noted(self, instead: str) -> None:
        if sum(1 for entry in self._history if not _is_plain(entry)) >= MAX_NOTED:
            raise Refused([f"{MAX_NOTED} entries of the score sheet already have a note or are withdrawn: {instead}"])

    def _next_number(self) -> int:
        return 1 + max((entry.number for entry in self._history), default=0)

    def _numbers(self) -> str:
        numbers = [str(entry.number) for entry in self._history if not entry.withdrawn_utc]
        return f"choose from {', '.join(numbers)}" if numbers else "no entry can be withdrawn"

    # -- looking ------------------------------------------------------------------------------------

    def groups(self) -> Tuple[ScoreGroup, ...]:
        """Return all items with their values by group, in the file's order. The same object until one changes."""
        if self._groups is None:
            grouped: Dict[str, List[Tuple[ScoringItem, int]]] = {}
            for key, item in self._items.items():
                grouped.setdefault(item.group, []).append((item, self._value(key)))
            self._groups = tuple(ScoreGroup(name, tuple(items)) for name, items in grouped.items())
        return self._groups

    def not_attempted(self) -> Tuple[bool, ...]:
        """Return for each item whether it is marked as not attempted, in the order of `groups`."""
        if self._marks is None:
            keys = [(item.group, item.desc) for group in self.groups() for item, _ in group.items]
            self._marks = tuple(key in self._standing and self._standing[key].not_attempted for key in keys)
        return self._marks

    def items(self) -> Tuple[ItemRecord, ...]:
        """Return all items, in the file's order."""
        return tuple(self._item(key) for key in self._items)

    def _item(self, key: Key) -> ItemRecord:
        item, entry = self._items[key], self._standing.get(key)
        return ItemRecord(
            item.group, item.desc, item.kind.name.lower(), self._value(key),
            not_attempted=entry is not None and entry.not_attempted,
            corrected=self._is_corrected(key, entry),
        )

    def item(self, group: str, desc: str) -> ItemRecord:
        """Return an item. Raises `Refused` if it does not exist."""
        self.check(group, desc, 0)
        return self._item((group, desc))

    def _value(self, key: Key) -> int:
        return self._standing[key].value if key in self._standing else 0

    def _is_corrected(self, key: Key, standing: Optional[ScoreEntry]) -> bool:
        """Whether the item's value differs from the value at the end of the run."""
        if standing is not None and standing.correction:
            return True
        number = 0 if standing is None else standing.number
        return any(
            entry.number > number and entry.withdrawal_corrects and not entry.correction
            for entry in self._history if (entry.group, entry.desc) == key
        )

    def _stand(self) -> None:
        self._standing = {(e.group, e.desc): e for e in self._history if not e.withdrawn_utc}
        self._groups = self._marks = None

    def _unknown(self, group: str, desc: str) -> str:
        if not self._items:
            return "this benchmark has no scoring items for the referee"
        groups = list(dict.fromkeys(i.group for i in self._items.values()))
        if group not in groups:
            return f"no scoring group '{group}'{did_you_mean(group, groups)}"
        descs = [i.desc for i in self._items.values() if i.group == group]
        return f"no scoring item '{desc}' in group '{group}'{did_you_mean(desc, descs)}"


def _is_plain(entry: ScoreEntry) -> bool:
    return not (entry.note or entry.withdrawn_utc)


def _is_alike(last: ScoreEntry, entry: ScoreEntry) -> bool:
    """Whether both changes may become one entry. A change to "not attempted" is always an entry of its own."""
    same = (last.who, last.correction, last.not_attempted) == (entry.who, entry.correction, entry.not_attempted)
    return same and not last.note and not entry.note


def _may_replace(later: ScoreEntry, entry: ScoreEntry) -> bool:
    return _is_plain(entry) and _is_plain(later) and entry.correction is later.correction
