"""Times, durations and counts as the panels write them. All clocks are UTC, as the schedule is."""

import contextlib
import math
import time
from typing import Optional


def countdown(seconds: float) -> str:
    """Time left as m:ss, or h:mm:ss from an hour on; rounded up, so that 0:00 means that it is over."""
    whole = max(0, math.ceil(round(seconds, 3)))
    hours, rest = divmod(whole, 3600)
    minutes, secs = divmod(rest, 60)
    return f"{hours}:{minutes:02d}:{secs:02d}" if hours else f"{minutes}:{secs:02d}"


def time_of_day(utc_s: float) -> str:
    """HH:MM:SS, UTC."""
    return _format("%H:%M:%S", utc_s)


def scheduled(utc_s: float, today_utc_s: float) -> str:
    """HH:MM of an event, with its date in front when it is not today's (UTC)."""
    date = _format("%Y-%m-%d", utc_s)
    hours = _format("%H:%M", utc_s)
    return hours if date == _format("%Y-%m-%d", today_utc_s) else f"{date} {hours}"


def short_time(moment: str, clock: str) -> str:
    """`moment` ("2015-12-31 10:00:00") in short: "10:00" on the clock's day, "31 Dec 10:00" on another."""
    date, _, hours = moment.strip().rpartition(" ")
    shown = hours[:-3] if hours.count(":") == 2 else hours
    if date == clock.strip().rpartition(" ")[0]:
        return shown
    with contextlib.suppress(ValueError):  # a date that is none is shown as it came
        date = time.strftime("%d %b", time.strptime(date, "%Y-%m-%d")).lstrip("0")
    return f"{date} {shown}".strip()


def ago(seconds: float) -> str:
    """How long ago something was: "just now", "4 s ago", "3 min ago", "2 h ago"."""
    if seconds < 1.5:
        return "just now"
    if seconds < 120:
        return f"{seconds:.0f} s ago"
    if seconds < 7200:
        return f"{seconds / 60:.0f} min ago"
    return f"{seconds / 3600:.0f} h ago"


def moment(utc_s: float, now_utc_s: float) -> str:
    """A moment and how long ago it was; zero on the ROS interface means never."""
    if utc_s == 0:
        return "never"
    return f"{time_of_day(utc_s)} UTC ({ago(now_utc_s - utc_s)})"


def skew(seconds: float) -> str:
    """A clock skew, in milliseconds; one that rounds to zero is never negative."""
    return f"{round(seconds, 3) + 0.0:+.3f} s".replace("-", "−")


def silence(seconds: Optional[float]) -> str:
    """What a panel says while the core is silent; None: it was never heard."""
    if seconds is None:
        return "OLD: waiting for the core"
    return f"OLD: no news from the core for {max(1.0, seconds):.0f} s"


def bullets(lines) -> str:
    """One line as it is, several as a list."""
    lines = list(lines)
    return "\n".join(lines if len(lines) < 2 else [f"• {line}" for line in lines])


def _format(pattern: str, utc_s: float) -> str:
    try:
        return time.strftime(pattern, time.gmtime(utc_s))
    except (OverflowError, OSError, ValueError):  # a clock that is far off must not stop a panel
        return "?"
