"""How the terminal's referee writes runs and score sheets. Pure text: no ROS, no terminal."""

from typing import List, Sequence

from roah_rsbb.core.clock import clock_text
from roah_rsbb.referee.sheets import Entry, RunLine, Sheet
from roah_rsbb.referee.view import BOLD, YELLOW, Paint, plain, standing_text

_IN = "    "


def run_lines(runs: Sequence[RunLine], paint: Paint) -> List[str]:
    """The runs of a zone, a line each."""
    return [_run_line(run, paint) for run in runs] or ["no run is connected or over"]


def _run_line(run: RunLine, paint: Paint) -> str:
    when = "now      " if run.closed_utc_s is None else clock_text(run.closed_utc_s)
    which = f"{plain(run.code)}, team {plain(run.team)}, round {run.round}, run {run.run}"
    score = f"  {plain(run.score)}" if run.score else ""
    return f"{when}  {plain(run.identity)}  {which}: {_state(run, paint)}{score}"


def _state(run: RunLine, paint: Paint) -> str:
    parts = [plain(run.end_reason).replace("_", " ") or ("connected" if run.closed_utc_s is None else "never started")]
    if run.corrected:
        parts.append(paint(YELLOW, "corrected"))
    if run.signed_utc_s is not None:
        parts.append(f"signed off by {plain(run.signed_by)} at {clock_text(run.signed_utc_s)}")
    elif run.closed_utc_s is not None:
        parts.append("to be signed off")
    return ", ".join(parts)


def sheet_lines(sheet: Sheet, paint: Paint) -> List[str]:
    """A score sheet with its history and the run's ends."""
    lines = [_run_line(sheet.run, paint)]
    group = None
    for item in sheet.items:
        if item.group != group:
            group = item.group
            lines.append(f"{_IN}{plain(group)}")
        mark = f"  {paint(YELLOW, '(corrected)')}" if item.number in sheet.corrected else ""
        value = f"{standing_text(item.type, item.value, item.not_attempted):>5}"
        shown = paint(BOLD, value) if item.value or item.not_attempted else value
        lines.append(f"{_IN}{item.number:4}  {shown}  {plain(item.item)}{mark}")
    if sheet.history:
        lines += ["History", *(f"{_IN}{entry.number:4}  {_entry(entry, paint)}" for entry in sheet.history)]
    if sheet.ends:
        lines.append("Ends")
    for end in sheet.ends:
        who = f" ({plain(end.who)})" if end.who else ""
        reason = f": {paint(BOLD, plain(end.reason))}" if end.reason else ""
        lines.append(f"{_IN}{end.number:4}  {clock_text(end.utc_s)} {plain(end.desc)}{who}{reason}")
    return lines


def _entry(entry: Entry, paint: Paint) -> str:
    old = standing_text(entry.type, entry.old, entry.old_not_attempted)
    new = standing_text(entry.type, entry.value, entry.not_attempted)
    text = f"{clock_text(entry.utc_s)} {plain(entry.who) or '?'}: {plain(entry.item)}: {old} -> {paint(BOLD, new)}"
    if entry.note:
        text += f" ({plain(entry.note)})"
    if entry.correction:
        text += f" {paint(YELLOW, 'correction')}"
    if entry.withdrawn_utc_s is not None:
        why = f": {plain(entry.withdrawn_note)}" if entry.withdrawn_note else ""
        by = f" by {plain(entry.withdrawn_by)}" if entry.withdrawn_by else ""
        text += f" {paint(YELLOW, f'withdrawn at {clock_text(entry.withdrawn_utc_s)}{by}{why}')}"
    return text
