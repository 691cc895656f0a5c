"""Runs and their score sheets, as plain values: what the terminal's referee shows of them, and what `--json` prints.

The names of the fields are the names in the JSON output (docs/referee.md): they are kept. Times are UTC in
seconds since 1970; null: there was none.
"""

from typing import List, NamedTuple, Optional, Sequence, Tuple

from roah_rsbb.referee.state import ITEM_TYPES, Item
from roah_rsbb.referee.words import BadWord
from roah_rsbb.wording.sheets import HistoryEntry, history_entry

LAST = "last"


class RunLine(NamedTuple):
    """A run in a line."""

    identity: str
    zone: str
    code: str
    team: str
    round: int
    run: int
    opened_utc_s: float
    closed_utc_s: Optional[float]  # None: it is still connected
    end_reason: str
    score: str
    corrected: bool
    signed_utc_s: Optional[float]
    signed_by: str
    started_utc_s: Optional[float] = None


class End(NamedTuple):
    """One end of a run."""

    number: int
    utc_s: float
    who: str
    end_reason: str
    desc: str
    reason: str
    reason_by: str = ""


class Sheet(NamedTuple):
    """All that there is of a run."""

    run: RunLine
    robots: Tuple[str, ...]
    elapsed_s: float
    items: Tuple[Item, ...]
    corrected: Tuple[int, ...]  # numbers of the items that stand otherwise than when the run was over
    history: Tuple[HistoryEntry, ...]
    ends: Tuple[End, ...]


def run_of(summary) -> RunLine:
    """A RunSummary."""
    return RunLine(
        summary.identity, summary.zone, summary.code, summary.team, summary.round, summary.run,
        summary.opened.to_sec(), _moment(summary.closed), summary.end_reason, summary.score, summary.corrected,
        _moment(summary.signed), summary.signed_by, _moment(summary.started),
    )


def sheet_of(sheet) -> Sheet:
    """A RunSheet."""
    kinds = {(item.group, item.desc): ITEM_TYPES[item.type] for item in sheet.items}
    return Sheet(
        run_of(sheet.summary), tuple(sheet.robots), sheet.elapsed.to_sec(),
        tuple(
            Item(number, item.group, item.desc, ITEM_TYPES[item.type], item.value, item.not_attempted)
            for number, item in enumerate(sheet.items, 1)
        ),
        tuple(number for number, item in enumerate(sheet.items, 1) if item.corrected),
        tuple(history_entry(entry, kinds.get((entry.group, entry.desc)) == "bool") for entry in sheet.history),
        tuple(
            End(number, stop.time.to_sec(), stop.who, stop.end_reason, stop.desc, stop.reason, stop.reason_by)
            for number, stop in enumerate(sheet.stops, 1)
        ),
    )


def pick_run(word: str, runs: Sequence[RunLine]) -> RunLine:
    """The run that `word` names: `last` (that was left last), or a part of its identity that no other has; raises
    `BadWord`. `runs`: the zone's, the one that was left last first."""
    over = [run for run in runs if run.closed_utc_s is not None]
    if word == LAST and over:
        return over[0]
    found = [run for run in runs if run.identity == word] or [run for run in runs if word and word in run.identity]
    if len(found) == 1:
        return found[0]
    listed: List[str] = [run.identity for run in found or runs]
    if not listed:
        raise BadWord("no run of this zone is connected or over")
    matches = f"{len(found)} runs have '{word}' in their name" if found else f"no run '{word}'"
    raise BadWord("\n  ".join([f"{matches}; there are", *listed]))


def _moment(time) -> Optional[float]:
    return time.to_sec() or None
