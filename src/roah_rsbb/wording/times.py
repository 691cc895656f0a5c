"""Times of day, durations and clock skews as people read them, and the clock of a run.

Days and times are those of the competition's time zone (`use_zone`), or of this computer's if it has none.
A countdown shows whole seconds, rounded up, so that 0:00 means that the time is over. The time that a run took is a
result: it shows tenths of a second, in panels, in the terminal and on score sheets alike.
"""

import contextlib
import datetime
import enum
import math
import re
import sys
from typing import List, NamedTuple, Optional

from roah_rsbb.model.zone import ENDED, RUNNING, RunClock
from roah_rsbb.wording.language import number, tr, tr_later, tr_said

# Stands for a value that does not exist.
NOTHING = "–"


# -- the time zone ----------------------------------------------------------------------------------


_OFFSET = re.compile(r"([+-])([0-9]{1,2}):([0-9]{2})")
# Not 'localtime' or 'posixrules', which mean another zone on each computer, and no path that leads elsewhere.
_NAME = re.compile(r"[A-Z][A-Za-z0-9_+-]*(/[A-Z][A-Za-z0-9_+-]*)*")
_name = ""
_zone: Optional[datetime.tzinfo] = None


def zone_of(name: str) -> Optional[datetime.tzinfo]:
    """Return the time zone of this name: of the IANA's list, UTC, or an offset from it; None: there is none."""
    offset = _OFFSET.fullmatch(name)
    if offset is not None and int(offset.group(2)) <= 14 and int(offset.group(3)) < 60:
        ahead = datetime.timedelta(hours=int(offset.group(2)), minutes=int(offset.group(3)))
        return datetime.timezone(-ahead if offset.group(1) == "-" else ahead)
    if name == "UTC":
        return datetime.timezone.utc
    if not _NAME.fullmatch(name):
        return None
    if sys.version_info >= (3, 9):
        import zoneinfo

        try:
            return zoneinfo.ZoneInfo(name)
        except (OSError, ValueError, zoneinfo.ZoneInfoNotFoundError):  # OSError: a folder, such as Asia
            return None
    from dateutil import tz

    found = tz.gettz(name)
    return found if isinstance(found, tz.tzfile) else None  # others are rules that a name such as EST-5 spells


def use_zone(name: str) -> None:
    """Show days and times in the time zone of this name; empty, or unknown here: in that of this computer."""
    global _name, _zone
    if name != _name:
        _name, _zone = name, zone_of(name)


def has_zone() -> bool:
    """Return whether days and times are those of a competition's time zone."""
    return _zone is not None


def day_of(utc_s: float) -> str:
    """Return the day of a moment, such as ``2026-11-28``."""
    return formatted(utc_s, "%Y-%m-%d", in_utc=False)


# -- durations --------------------------------------------------------------------------------------


def countdown(seconds: float) -> str:
    """Return the time left as m:ss, or as h:mm:ss from an hour on."""
    whole = max(0, math.ceil(round(seconds, 3)))
    return _minutes(whole // 60, f"{whole % 60:02d}")


def in_sentence(seconds: float) -> str:
    """Return how many seconds something has lasted as sentences say it: the whole ones, after 10 s the tens, and after
    a minute the minutes in seconds. A sentence that is shown for long changes rarely."""
    whole = max(0, round(seconds))
    step = 1 if whole < 10 else 10 if whole < 60 else 60
    return str(whole // step * step)


def elapsed(seconds: float) -> str:
    """Return the time that something took, to a tenth of a second, such as ``9:58.3`` or ``1:02:03.4``."""
    tenths = max(0, round(seconds * 10))
    return _minutes(tenths // 600, number(f"{tenths // 10 % 60:02d}.{tenths % 10}"))


def clock_time(seconds: float) -> str:
    """Return the whole seconds that a run's clock has counted, such as ``2:41``."""
    whole = max(0, int(seconds))
    return _minutes(whole // 60, f"{whole % 60:02d}")


def _minutes(minutes: int, seconds: str) -> str:
    hours, rest = divmod(minutes, 60)
    return f"{hours}:{rest:02d}:{seconds}" if hours else f"{rest}:{seconds}"


def ago(seconds: float) -> str:
    """Return how long ago something was: "just now", "4 s ago", "3 min ago", "2 h ago"."""
    if seconds < 1.5:
        return tr("just now")
    if seconds < 120:
        return tr("{time:.0f} s ago", time=seconds)
    if seconds < 7200:
        return tr("{time:.0f} min ago", time=seconds / 60)
    return tr("{time:.0f} h ago", time=seconds / 3600)


def skew(seconds: float) -> str:
    """Return a clock skew with its sign, such as ``+0.150 s``. A skew that rounds to zero is not negative."""
    return number(f"{round(seconds, 3) + 0.0:+.3f} s" if abs(seconds) < 100 else f"{seconds:+.3g} s")


def silence(seconds: Optional[float]) -> str:
    """Return what a panel says while the core is silent; None: the core has never been heard."""
    if seconds is None:
        return tr("OLD: waiting for the box")
    return tr("OLD: nothing heard from the box for {time:.0f} s", time=max(1.0, seconds))


# -- moments in UTC, for the terminal and for logs --------------------------------------------------


def time_of_day(utc_s: float) -> str:
    """Return HH:MM:SS in UTC, where a heading or the text beside it says UTC."""
    return formatted(utc_s, "%H:%M:%S", in_utc=True)


def time_with_zone(utc_s: float) -> str:
    """Return the UTC time of day at the beginning of log lines, such as ``14:03:59Z``: see `Moments.lines`."""
    return f"{time_of_day(utc_s)}Z"


def formatted(utc_s: float, pattern: str, in_utc: bool) -> str:
    """Return a local or UTC moment in this format."""
    try:
        return _moment(utc_s, in_utc).strftime(pattern)
    except (OverflowError, OSError, ValueError):  # a clock that is far off must not stop a panel
        return "?"


# -- moments for panels, in one time zone -----------------------------------------------------------

# The core writes this time at the beginning of each line of a run's log.
_OF_LINE = re.compile(r"^(\d\d):(\d\d):(\d\d)Z", re.MULTILINE)
_DAY_S = 86400


class Moments(NamedTuple):
    """How the panels of a client show moments: all in local time, or all in UTC."""

    in_utc: bool = False

    def time_of_day(self, utc_s: float) -> str:
        """Return HH:MM:SS, where the name of the time zone is shown elsewhere."""
        return formatted(utc_s, "%H:%M:%S", self.in_utc)

    def short(self, utc_s: float) -> str:
        """Return HH:MM."""
        return formatted(utc_s, "%H:%M", self.in_utc)

    def with_zone(self, utc_s: float) -> str:
        """Return the time of day with the time zone, such as ``14:03:59 CET``."""
        return f"{self.time_of_day(utc_s)} {'UTC' if self.in_utc else formatted(utc_s, '%Z', in_utc=False)}"

    def stamp(self, utc_s: float) -> str:
        """Return the time of day at the beginning of a line, such as ``14:03:59``, or ``14:03:59Z`` in UTC."""
        return self.time_of_day(utc_s) + ("Z" if self.in_utc else "")

    def scheduled(self, utc_s: float, today_utc_s: float) -> str:
        """Return HH:MM of an event, after its date if it is not today."""
        day, today = (formatted(utc, "%Y-%m-%d", self.in_utc) for utc in (utc_s, today_utc_s))
        return self.short(utc_s) if day == today else f"{day} {self.short(utc_s)}"

    def and_age(self, utc_s: float, now_utc_s: float) -> str:
        """Return a time of day and how long ago it was; on the ROS interface zero means never."""
        return f"{self.time_of_day(utc_s)} ({ago(now_utc_s - utc_s)})" if utc_s else tr("never")

    def lines(self, text: str, now_utc_s: float) -> str:
        """Return the lines of a log with the times at their beginnings in this time zone."""
        if self.in_utc:
            return text
        shift_s = offset_s(now_utc_s)

        def shifted(match: "re.Match[str]") -> str:
            hours, minutes, seconds = map(int, match.groups())
            day_s = (3600 * hours + 60 * minutes + seconds + shift_s) % _DAY_S
            return f"{day_s // 3600:02d}:{day_s // 60 % 60:02d}:{day_s % 60:02d}"

        return _OF_LINE.sub(shifted, text)

    @staticmethod
    def tip(utc_s: float) -> str:
        """Return the moment in UTC with its date, for a tooltip."""
        return f"{formatted(utc_s, '%Y-%m-%d %H:%M:%S', in_utc=True)} UTC"


def at_venue(utc_s: float) -> str:
    """Return a time of day within a sentence, such as ``14:03:59 CET``."""
    return Moments().with_zone(utc_s)


def offset_s(utc_s: float) -> int:
    """Return by how many seconds local time is ahead of UTC then."""
    try:
        ahead = _moment(utc_s, in_utc=False).utcoffset()
    except (OverflowError, OSError, ValueError):
        return 0
    return 0 if ahead is None else int(ahead.total_seconds())


# -- moments for the public and for results, local or UTC -------------------------------------------


DAYS = (tr_later("Mon"), tr_later("Tue"), tr_later("Wed"), tr_later("Thu"), tr_later("Fri"), tr_later("Sat"),
        tr_later("Sun"))
MONTHS = (
    tr_later("Jan"), tr_later("Feb"), tr_later("Mar"), tr_later("Apr"), tr_later("May"), tr_later("Jun"),
    tr_later("Jul"), tr_later("Aug"), tr_later("Sep"), tr_later("Oct"), tr_later("Nov"), tr_later("Dec"),
)


def short_time(moment: str, clock: str) -> str:
    """Shortens `moment` ("2015-12-31 10:00:00"): "10:00" on the clock's day, "Thu 10:00" within six days of it.

    Further away it is "31 Dec 10:00".
    """
    date, _, hours = moment.strip().rpartition(" ")
    shown = hours[:-3] if hours.count(":") == 2 else hours
    today = clock.strip().rpartition(" ")[0]
    if date == today:
        return shown
    with contextlib.suppress(ValueError):  # text that is not a date is shown unchanged
        day = datetime.datetime.strptime(date, "%Y-%m-%d")
        is_near = abs((day - datetime.datetime.strptime(today, "%Y-%m-%d")).days) < 7
        date = tr(DAYS[day.weekday()]) if is_near else tr("{day} {month}", day=day.day, month=tr(MONTHS[day.month - 1]))
    return f"{date} {shown}".strip()


def date_time(utc_s: float, in_utc: bool = False) -> str:
    """Return a local moment with its offset, such as ``2025-11-21 12:03:59 +01:00``, or the UTC one with a Z."""
    moment = _moment(utc_s, in_utc)
    text = moment.isoformat(" ", "seconds")  # as 2025-11-21 12:03:59+01:00, in a fraction of the time of strftime
    return f"{text[:19]}Z" if in_utc else f"{text[:19]} {text[19:]}"


def optional_date_time(utc_s: Optional[float], in_utc: bool = False) -> str:
    """Like `date_time`. For 0 and None, which mean that it has not happened, return `NOTHING`."""
    return date_time(utc_s, in_utc) if utc_s else NOTHING


def time_with_tenths(utc_s: float, in_utc: bool = False) -> str:
    """Return the time of day with tenths of a second, where the day and the offset are shown elsewhere."""
    return _moment(utc_s, in_utc).isoformat(timespec="milliseconds")[11:21]  # in a fraction of the time of strftime


def iso(utc_s: float, in_utc: bool = False) -> str:
    """Return a moment for programs, in ISO 8601, such as ``2025-11-21T12:03:59.250+01:00``."""
    return _moment(utc_s, in_utc).isoformat(timespec="milliseconds")


def _moment(utc_s: float, in_utc: bool) -> datetime.datetime:
    moment = datetime.datetime.fromtimestamp(utc_s, datetime.timezone.utc)
    return moment if in_utc else moment.astimezone(_zone)


# -- the clock of a run: each figure with its label, which never changes its meaning ---------------

SOON_S = 30.0
LAST_S = 10.0
PAUSED = tr_later("PAUSED")


class Hurry(enum.IntEnum):
    """How soon a time is up."""

    NO = 0
    SOON = 1  # in the last 30 s
    LAST = 2  # in the last 10 s


class Figure(NamedTuple):
    """A time with its label."""

    label: str
    text: str
    hurry: Hurry = Hurry.NO


class Clock(NamedTuple):
    """The times of a run, in words."""

    main: Figure  # of the run
    goal: Optional[Figure] = None  # of the robot's goal, or of the task's phase
    pause: str = ""  # says that the run is paused, and why; empty: not paused
    aside: str = ""  # less important details


def clock_of(clock: RunClock, phase: str, mono: float) -> Clock:
    """Return the times of a run in this phase at a moment of the box's clock."""
    if phase == ENDED:
        left = clock.after_stop(mono)
        aside = tr("Time left after the stop: {time}", time=countdown(left)) if left > 0.0 else ""
        return Clock(Figure(tr("Final time of the run"), elapsed(clock.spent(mono))), aside=aside)
    if phase != RUNNING:
        goal = Figure(tr("Time limit of a goal"), countdown(clock.goal_limit)) if clock.goal_limit else None
        limit = Figure(tr("Time limit of the run"), countdown(clock.limit) if clock.limit else tr("no limit"))
        return Clock(_setup(clock, mono), limit) if clock.setup_elapsed.counting else Clock(limit, goal)
    goal = None
    if clock.goal:
        goal = _left(tr("Goal: time left"), clock.goal_limit - clock.goal_spent(mono), clock.goal_elapsed.counting)
    elif clock.phase_number:
        goal = _phase(clock, mono)
    pause = f"{tr(PAUSED)}: {tr_said(clock.paused)}" if clock.paused else ""
    spent_s = clock.spent(mono)
    if not clock.limit:
        return Clock(Figure(tr("Run: time used"), countdown(int(spent_s))), goal, pause)
    used = tr("Used: {time} of {limit}", time=countdown(int(spent_s)), limit=countdown(clock.limit))
    return Clock(_left(tr("Run: time left"), clock.limit - spent_s, clock.elapsed.counting), goal, pause, used)


def below_clock(clock: RunClock, phase: str) -> str:
    """Return what the large clock of a run means, in few words."""
    if phase == ENDED:
        return tr("used")
    if phase != RUNNING:
        return tr("to set up") if clock.setup_elapsed.counting else tr("for the run") if clock.limit else ""
    if not clock.elapsed.counting:
        return tr("does not count")
    return tr("left of {limit}", limit=countdown(clock.limit)) if clock.limit else tr("used")


def clock_lines(clock: Clock) -> List[str]:
    """Return the times in words, the most important first."""
    figures = [f"{figure.label} {figure.text}" for figure in (clock.main, clock.goal) if figure is not None]
    return [text for text in (clock.pause, *figures, clock.aside) if text]


def _setup(clock: RunClock, mono: float) -> Figure:
    left_s = clock.setup_limit - clock.setup_elapsed.at(mono)
    if left_s > 0.0:
        return _left(tr("Setup: time left"), left_s, True)
    return Figure(tr("Setup: over by"), countdown(int(-left_s)), Hurry.LAST)


def _phase(clock: RunClock, mono: float) -> Figure:
    """Return the time of the current phase of a task."""
    name = tr("Phase {number} of {count}, {name}", number=clock.phase_number, count=clock.phases,
              name=clock.phase_name)
    spent_s, limit_s = clock.phase_elapsed.at(mono), clock.phase_limit
    if not limit_s:
        return Figure(tr("{phase}: time used", phase=name), countdown(int(spent_s)))
    if spent_s < limit_s:
        return _left(tr("{phase}: time left", phase=name), limit_s - spent_s, clock.elapsed.counting)
    return Figure(tr("{phase}: over by", phase=name), countdown(int(spent_s - limit_s)), Hurry.LAST)


def _left(label: str, left_s: float, counting: bool) -> Figure:
    hurry = Hurry.NO
    if counting and left_s <= SOON_S:
        hurry = Hurry.LAST if left_s <= LAST_S else Hurry.SOON
    return Figure(label, countdown(max(0.0, left_s)), hurry)
