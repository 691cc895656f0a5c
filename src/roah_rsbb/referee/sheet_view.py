"""How the terminal's referee writes runs and score sheets. Pure text: no ROS, no terminal."""

from functools import partial
from typing import List, Sequence

from roah_rsbb.referee.sheets import RunLine, Sheet
from roah_rsbb.referee.view import BOLD, YELLOW, Paint, item_text, plain
from roah_rsbb.wording import sheets, times

_IN = "    "


def run_lines(runs: Sequence[RunLine], paint: Paint) -> List[str]:
    """The runs of a zone, a line each."""
    return [_run_line(run, paint) for run in runs] or ["no run is connected or over"]


def _run_line(run: RunLine, paint: Paint) -> str:
    when = "now      " if run.closed_utc_s is None else times.time_with_zone(run.closed_utc_s)
    which = sheets.run_name(plain(run.code), plain(run.team), run.round, run.run)
    score = f"  {plain(run.score)}" if run.score else ""
    return f"{when}  {plain(run.identity)}  {which}: {_state(run, paint)}{score}"


def _state(run: RunLine, paint: Paint) -> str:
    parts = [plain(sheets.run_state(run.started_utc_s, run.closed_utc_s, run.end_reason))]
    if run.corrected:
        parts.append(paint(YELLOW, sheets.CORRECTED))
    if run.closed_utc_s is not None:
        parts.append(sheets.signature(run.signed_utc_s, plain(run.signed_by), times.time_with_zone))
    return ", ".join(parts)


def sheet_lines(sheet: Sheet, paint: Paint) -> List[str]:
    """A score sheet with its history and the run's ends."""
    lines = [_run_line(sheet.run, paint)]
    if sheet.run.end_reason:
        lines.append(f"{_IN}time {times.elapsed(sheet.elapsed_s)}")
    group = None
    for item in sheet.items:
        if item.group != group:
            group = item.group
            lines.append(f"{_IN}{plain(group)}")
        mark = f"  {paint(YELLOW, f'({sheets.CORRECTED})')}" if item.number in sheet.corrected else ""
        value = f"{item_text(item):>5}"
        shown = paint(BOLD, value) if item.value or item.not_attempted else value
        lines.append(f"{_IN}{item.number:4}  {shown}  {plain(item.item)}{mark}")
    if sheet.history:
        lines.append("History")
    for entry in sheet.history:
        words = sheets.EntryTexts(*map(plain, sheets.entry_texts(entry, times.time_with_zone)))
        lines.append(f"{_IN}{words.number:>4}  {sheets.entry_line(words, partial(paint, YELLOW))}")
    if sheet.ends:
        lines.append("Ends")
    for end in sheet.ends:
        who = f" ({plain(end.who)})" if end.who else ""
        reason = plain(sheets.stop_reason(end.reason, end.reason_by, end.who))
        lines.append(f"{_IN}{end.number:4}  {times.time_with_zone(end.utc_s)} {plain(end.desc)}{who}"
                     + (f": {paint(BOLD, reason)}" if reason else ""))
    return lines
