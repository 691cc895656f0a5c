"""Runs and their score sheets in the terminal."""

from functools import partial
from typing import List, Sequence

from roah_rsbb.model.results import RunLine, RunSheet
from roah_rsbb.referee.view import BOLD, YELLOW, Style, item_lines
from roah_rsbb.referee.words import BadWord
from roah_rsbb.wording import sheets, times
from roah_rsbb.wording.sheets import with_counting
from roah_rsbb.wording.texts import escaped

_IN = "    "

LAST = "last"


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


def sheet_lines(sheet: RunSheet, style: Style) -> List[str]:
    """Return the lines of a score sheet, its history and the run's ends."""
    lines = [_run_line(sheet.run, style)]
    if sheet.run.end_reason:
        lines.append(f"{_IN}time {times.elapsed(sheet.elapsed_s)}")
    lines += item_lines(sheet.items, sheet.points, style, f"  {style(YELLOW, f'({sheets.CORRECTED})')}")
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
