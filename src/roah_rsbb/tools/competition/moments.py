"""Converts days and times at the venue to the UTC times of schedules (docs/benchmarks.md, "Files")."""

import datetime
import re
from typing import Optional

from roah_rsbb.rulebook.errors import Place, Report, quote

UTC = datetime.timezone.utc
_DAY = re.compile(r"([0-9]{4})-([0-9]{1,2})-([0-9]{1,2})")
_TIME = re.compile(r"([0-9]{1,2}):([0-9]{2})(?::([0-9]{2}))?")
_OFFSET = re.compile(r"([+-])([0-9]{1,2}):([0-9]{2})")
# What a competition can be held in; a year of two digits or a slip of a finger is not.
_FIRST_YEAR, _LAST_YEAR = 2000, 2100


class VenueClock:
    """The clock on the venue's wall: this computer's local time, or a fixed offset from UTC."""

    def __init__(self, offset: Optional[datetime.timedelta] = None) -> None:
        self._zone = None if offset is None else datetime.timezone(offset)

    def utc(self, day: datetime.date, time: datetime.time) -> datetime.datetime:
        """The moment when the wall shows this."""
        wall = datetime.datetime.combine(day, time)
        return (wall if self._zone is None else wall.replace(tzinfo=self._zone)).astimezone(UTC)

    def wall(self, moment: datetime.datetime) -> datetime.datetime:
        """What the wall shows at a moment; it knows its offset from UTC."""
        return moment.astimezone(self._zone)


def read_day(report: Report, place: Place, text: str, what: str) -> Optional[datetime.date]:
    """A day; None after an error, which is then in the report."""
    found = _DAY.fullmatch(text)
    if found is None:
        report.error(place, f"{quote(text)} as {what}", "a day as year-month-day, such as 2026-11-28")
        return None
    try:
        day = datetime.date(*map(int, found.groups()))
    except ValueError:
        report.error(place, f"{quote(text)} as {what}", "a day that exists, as year-month-day, such as 2026-11-28")
        return None
    if not _FIRST_YEAR <= day.year <= _LAST_YEAR:
        report.error(place, f"{quote(text)} as {what}", f"a year from {_FIRST_YEAR} to {_LAST_YEAR}")
        return None
    return day


def read_time(report: Report, place: Place, text: str, what: str) -> Optional[datetime.time]:
    """A time of day; None after an error, which is then in the report."""
    found = _TIME.fullmatch(text)
    if found is not None:
        hour, minute, second = (int(part or 0) for part in found.groups())
        if hour < 24 and minute < 60 and second < 60:
            return datetime.time(hour, minute, second)
    report.error(place, f"{quote(text)} as {what}", "a time of day from 0:00 to 23:59, such as 09:30")
    return None


def read_clock(report: Report, place: Place, text: str) -> Optional[VenueClock]:
    """``local``, ``UTC`` or an offset; None after an error, which is then in the report."""
    if text.casefold() == "local":
        return VenueClock()
    if text.casefold() == "utc":
        return VenueClock(datetime.timedelta(0))
    found = _OFFSET.fullmatch(text)
    if found is not None and int(found.group(2)) <= 14 and int(found.group(3)) < 60:
        offset = datetime.timedelta(hours=int(found.group(2)), minutes=int(found.group(3)))
        return VenueClock(-offset if found.group(1) == "-" else offset)
    report.error(place, f"{quote(text)} as time zone",
                 "local (this computer's), UTC, or how far the venue is ahead of UTC, such as +01:00")
    return None
