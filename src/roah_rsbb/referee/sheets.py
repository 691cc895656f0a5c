"""Runs and their score sheets: plain values, as `--json` prints them, and their lines in the terminal.

The names of the fields are the names in the JSON output (docs/referee.md) and never change. Times are UTC seconds since
1970; null means that the time does not exist.
"""

from functools import partial
from typing import List, NamedTuple, Optional, Sequence, Tuple

from roah_rsbb.referee.state import SheetItem, items_of
from roah_rsbb.referee.view import BOLD, YELLOW, Style, sheet_line
from roah_rsbb.referee.words import BadWord
from roah_rsbb.wording import sheets, times
from roah_rsbb.wording.counting import with_counting
from roah_rsbb.wording.sheets import HistoryEntry, history_entry
from roah_rsbb.wording.texts import escaped

_IN = "    "

LAST = "last"


class RunLine(NamedTuple):
    """A run, without its score sheet."""

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
    counts: str = ""  # why it counts or not: a word of `wording.counting`


class RunEnd(NamedTuple):
    """One end of a run."""

    number: int
    utc_s: float
    who: str
    end_reason: str
    desc: str
    reason: str
    reason_by: str = ""


class Sheet(NamedTuple):
    """A run with its score sheet, its history and its ends."""

    run: RunLine
    robots: Tuple[str, ...]
    elapsed_s: float
    items: Tuple[SheetItem, ...]
    corrected: Tuple[int, ...]  # numbers of the items that were changed after the run was over
    history: Tuple[HistoryEntry, ...]
    ends: Tuple[RunEnd, ...]
    points: str = ""  # of the score sheet; empty: it gives none


def run_of(summary) -> RunLine:
    """Read a RunSummary."""
    return RunLine(
        summary.identity, summary.zone, summary.code, summary.team, summary.round, summary.run,
        summary.opened.to_sec(), _moment(summary.closed), summary.end_reason, summary.score, summary.corrected,
        _moment(summary.signed), summary.signed_by, _moment(summary.started),
        summary.counts,
    )


def sheet_of(sheet) -> Sheet:
    """Read a RunSheet."""
    items = items_of(sheet.items)
    kinds = {(item.group, item.item): item.type for item in items}
    return Sheet(
        run_of(sheet.summary), tuple(sheet.robots), sheet.elapsed.to_sec(),
        items,
        tuple(number for number, item in enumerate(sheet.items, 1) if item.corrected),
        tuple(history_entry(entry, kinds.get((entry.group, entry.desc), "uint")) for entry in sheet.history),
        tuple(
            RunEnd(number, stop.time.to_sec(), stop.who, stop.end_reason, stop.desc, stop.reason, stop.reason_by)
            for number, stop in enumerate(sheet.stops, 1)
        ),
        sheets.points_of(sheet.points),
    )


def pick_run(word: str, runs: Sequence[RunLine]) -> RunLine:
    """Return the run that `word` names: `last`, or a part of its identity that no other run has; raises `BadWord`.

    `runs`: those of the zone, the latest one first.
    """
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


# -- lines ----------------------------------------------------------------------------------------


def run_lines(runs: Sequence[RunLine], style: Style) -> List[str]:
    """Return a line for each run of a zone."""
    return [_run_line(run, style) for run in runs] or ["no run is connected or over"]


def _run_line(run: RunLine, style: Style) -> str:
    when = "now      " if run.closed_utc_s is None else style.moments.stamp(run.closed_utc_s)
    which = sheets.run_name(escaped(run.code), escaped(run.team), run.round, run.run)
    score = f"  {escaped(run.score)}" if run.score else ""
    return f"{when}  {escaped(run.identity)}  {which}: {_state(run, style)}{score}"


def _state(run: RunLine, style: Style) -> str:
    state = sheets.run_state(run.started_utc_s, run.closed_utc_s, run.end_reason)
    parts = [escaped(with_counting(state, run.counts))]
    if run.corrected:
        parts.append(style(YELLOW, sheets.CORRECTED))
    if run.closed_utc_s is not None:
        parts.append(sheets.signature(run.signed_utc_s, escaped(run.signed_by), style.moments.stamp))
    return ", ".join(parts)


def sheet_lines(sheet: Sheet, style: Style) -> List[str]:
    """Return the lines of a score sheet, its history and the run's ends."""
    lines = [_run_line(sheet.run, style)]
    if sheet.run.end_reason:
        lines.append(f"{_IN}time {times.elapsed(sheet.elapsed_s)}")
    group = None
    for item in sheet.items:
        if item.group != group:
            group = item.group
            lines.append(f"{_IN}{escaped(group)}")
        mark = f"  {style(YELLOW, f'({sheets.CORRECTED})')}" if item.number in sheet.corrected else ""
        lines.append(f"{sheet_line(item, style)}{mark}")
    if sheet.points:
        lines.append(f"{_IN}{style(BOLD, escaped(sheet.points))}")
    if sheet.history:
        lines.append("History")
    for entry in sheet.history:
        words = sheets.EntryTexts(*map(escaped, sheets.entry_texts(entry, style.moments.stamp)))
        lines.append(f"{_IN}{words.number:>4}  {sheets.entry_line(words, partial(style, YELLOW))}")
    if sheet.ends:
        lines.append("Ends")
    for end in sheet.ends:
        who = f" ({escaped(sheets.person(end.who))})" if end.who else ""
        reason = escaped(sheets.stop_reason(end.reason, end.reason_by, end.who))
        lines.append(f"{_IN}{end.number:4}  {style.moments.stamp(end.utc_s)} {escaped(end.desc)}{who}"
                     + (f": {style(BOLD, reason)}" if reason else ""))
    return lines
