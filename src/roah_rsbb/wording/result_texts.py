"""Times, values and strings as people read them, whoever they came from."""

import datetime
import json
from typing import Any, Optional

from roah_rsbb.core.runs.phases import EndReason
from roah_rsbb.core.scoring.records import RunRecord, ScoreValue
from roah_rsbb.wording.module_scores import readable

# What stands where there is nothing.
NOTHING = "–"
NOT_ATTEMPTED = "not attempted"


def moment(utc: float, in_utc: bool = False) -> str:
    """A moment in local time with its offset, e.g. ``2025-11-21 12:03:59 +01:00``; in UTC, if wished."""
    time = datetime.datetime.fromtimestamp(utc, datetime.timezone.utc)
    if in_utc:
        return time.strftime("%Y-%m-%d %H:%M:%SZ")
    text = time.astimezone().strftime("%Y-%m-%d %H:%M:%S %z")
    return f"{text[:-2]}:{text[-2:]}"


def clock(utc: float, in_utc: bool = False) -> str:
    """The time of day with tenths of a second, where the day and the offset stand elsewhere."""
    time = datetime.datetime.fromtimestamp(utc, datetime.timezone.utc)
    time = time if in_utc else time.astimezone()
    return f"{time:%H:%M:%S}.{time.microsecond // 100_000}"


def iso(utc: float, in_utc: bool = False) -> str:
    """A moment for programs, ISO 8601, e.g. ``2025-11-21T12:03:59.250+01:00``."""
    time = datetime.datetime.fromtimestamp(utc, datetime.timezone.utc)
    return (time if in_utc else time.astimezone()).isoformat(timespec="milliseconds")


def duration(seconds: float) -> str:
    """E.g. ``9:58.3`` (minutes, seconds)."""
    tenths = round(seconds * 10)
    return f"{tenths // 600}:{tenths // 10 % 60:02d}.{tenths % 10}"


def visible(text: str) -> str:
    """A text of a robot, or of anybody, in which nothing is hidden: what cannot be printed (also signs that turn
    the direction of writing) stands as its escape. Line breaks stay."""
    return "".join(c if c.isprintable() or c == "\n" else c.encode("unicode_escape", "replace").decode() for c in text)


def line(text: str) -> str:
    """The same in one line."""
    return " ".join(visible(text).split())


def plain(value: Any) -> str:
    """Any value of JSON as text."""
    return value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)


def item_value(kind: str, value: int, not_attempted: bool = False) -> str:
    """What a scoring item says."""
    if not_attempted:
        return NOT_ATTEMPTED
    if kind == "bool":
        return "yes" if value else "no"
    return str(value)


def module_value(score: ScoreValue) -> str:
    """A module's value with its unit."""
    return readable(score).value


def module_name(score: ScoreValue) -> str:
    """What a module's value is called."""
    return readable(score).name


def end_text(end_reason: str) -> str:
    """Why a run ended; the name of a reason that this version does not know stays as it is."""
    try:
        return EndReason[end_reason.upper()].value
    except KeyError:
        return end_reason


def state_of(record: RunRecord) -> str:
    """Where a run is: how it ended, or that it did not."""
    if not record.started_utc:
        return "connected, not started yet" if not record.closed_utc else "never started"
    if not record.end_reason:
        return "running"
    return end_text(record.end_reason)


def sign_off_text(record: RunRecord, in_utc: bool = False) -> str:
    """Who signed off, and when."""
    if record.sign_off is None:
        return "not signed off"
    return f"signed off by {line(record.sign_off.who) or 'somebody'}, {moment(record.sign_off.utc, in_utc)}"


def robots_text(record: RunRecord) -> str:
    """The robots' names."""
    return ", ".join(line(robot) for robot in record.robots) or NOTHING


def optional_moment(utc: Optional[float], in_utc: bool = False) -> str:
    """As `moment`; 0 and None are no moment."""
    return moment(utc, in_utc) if utc else NOTHING
