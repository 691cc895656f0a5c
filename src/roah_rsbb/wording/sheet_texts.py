"""What panels and terminal say of score sheets, runs and their ends; all clocks are UTC.

Works on anything with the fields of RunSummary, ScoreItem, ScoreChange and RunStop: neither ROS nor Qt is needed.
"""

from typing import List

from roah_rsbb.wording import panel_texts

NOT_ATTEMPTED = "not attempted"
_BOOL = 0  # ZoneScoreGroup.SCORING_BOOL
_ENDS = {
    "completed": "completed", "stopped": "stopped", "timeout": "time is up", "no_messages_saved": "no data saved",
    "module_failed": "module failed",
}


def standing(value: int, not_attempted: bool, kind: int) -> str:
    """How an item stands."""
    if not_attempted:
        return NOT_ATTEMPTED
    if kind == _BOOL:
        return "yes" if value else "no"
    return str(value)


def end(summary) -> str:
    """How a run ended, or that it has not."""
    if summary.end_reason:
        return _ENDS.get(summary.end_reason, summary.end_reason)
    return "running" if summary.started.to_sec() else "connected"


def event(summary) -> str:
    """Which run it was."""
    return f"{summary.code}  {summary.round}/{summary.run}"


def state(summary) -> str:
    """What became of a run's score sheet."""
    marks: List[str] = ["✎ corrected"] if summary.corrected else []
    if summary.signed.to_sec():
        marks.append("✔ signed off")
    else:
        marks.append("unsigned" if summary.closed.to_sec() else "not over")
    return ", ".join(marks)


def signature(summary) -> str:
    """Who signed a score sheet off, and when; empty: nobody did."""
    signed = summary.signed.to_sec()
    return f"by {summary.signed_by or 'somebody'} at {panel_texts.time_of_day(signed)} UTC" if signed else ""


def change(entry, kind: int) -> str:
    """What an entry changed."""
    old = standing(entry.old, entry.old_not_attempted, kind)
    return f"{old} → {standing(entry.value, entry.not_attempted, kind)}"


def entry_notes(entry) -> str:
    """What else there is to say of an entry of the history."""
    notes = [entry.note] if entry.note else []
    if entry.correction:
        notes.insert(0, "✎ correction")
    if entry.withdrawn.to_sec():
        when = panel_texts.time_of_day(entry.withdrawn.to_sec())
        after = " (✎ correction)" if entry.withdrawal_corrects else ""
        why = f": {entry.withdrawn_note}" if entry.withdrawn_note else ""
        notes.append(f"✘ withdrawn {when} by {entry.withdrawn_by or 'somebody'}{after}{why}")
    return "; ".join(notes)


def stop_reason(stop) -> str:
    """Why a run was stopped, if somebody said so."""
    if not stop.reason:
        return ""
    return f"{stop.reason} ({stop.reason_by})" if stop.reason_by and stop.reason_by != stop.who else stop.reason
