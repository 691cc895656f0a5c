"""The schedule as referees and organisers read it: states, delays, filters, and what is not signed off yet.

Page and terminal decorate these words and add none of their own.
"""

import enum
from typing import Callable, Dict, Iterable, NamedTuple, Optional, Sequence

from roah_rsbb.model.results import EventSeen
from roah_rsbb.wording import sheets, times
from roah_rsbb.wording.language import tr, tr_later
from roah_rsbb.wording.sheets import with_counting

MINUTE_S, DAY_S = 60, 86400

# By `EventSeen.state`.
_STATES = {
    "connected": tr_later("● connected"), "running": tr_later("▶ running"), "ended": tr_later("■ ended"),
    "next": tr_later("→ next"), "later": tr_later("later"), "skipped": tr_later("– skipped"),
}
TO_COME = ("connected", "running", "ended", "next", "later")
_IN_ZONE = ("connected", "running", "ended")

COLUMNS = (tr_later("Begins"), tr_later("Planned"), tr_later("Team"), tr_later("Benchmark"), tr_later("Zone"),
           tr_later("State"))


# -- words ------------------------------------------------------------------------------------------


def state_text(event: EventSeen) -> str:
    """Return the state of an event."""
    end = with_counting(sheets.end_reason(event.end_reason), event.counts, only_unusual=True)
    if event.state == "done":
        return tr("✓ done: {end}", end=end)
    text = tr(_STATES.get(event.state, event.state))
    if event.identity and event.state in ("next", "later"):
        return tr("{state} (before: {end})", state=text, end=end)
    return text


def sheet_text(event: EventSeen) -> str:
    """Return whether the score sheets of an event's runs that count are signed off; empty: no run is over."""
    if event.unsigned:
        return tr(sheets.NOT_SIGNED_OFF)
    return tr(sheets.SIGNED_OFF) if event.identity else ""


def delay_text(seconds: float) -> str:
    """Return a delay such as ``+12 min``, ``+2 h 05 min`` or ``+3 days``; empty: less than a minute."""
    minutes = int(seconds // MINUTE_S)
    if minutes < 1:
        return ""
    if minutes < 60:
        return tr("+{minutes} min", minutes=minutes)
    if seconds < 2 * DAY_S:
        return tr("+{hours} h {minutes:02d} min", hours=minutes // 60, minutes=minutes % 60)
    return tr("+{n} days", n=int(seconds // DAY_S))


def summary(events: Sequence[EventSeen]) -> str:
    """Return how many events are signed off, not signed off, to come and skipped."""
    unsigned = sum(event.unsigned for event in events)
    counts = (
        (sum(bool(event.identity) and not event.unsigned for event in events), tr(sheets.SIGNED_OFF)),
        (unsigned, tr(sheets.NOT_SIGNED_OFF)),
        (sum(event.state in TO_COME and not event.identity and not event.unsigned for event in events), tr("to come")),
        (sum(event.state == "skipped" for event in events), tr("skipped")),
    )
    return "  ·  ".join(f"{count} {what}" for count, what in counts if count) or tr("no events")


# -- filters ----------------------------------------------------------------------------------------


class Show(enum.Enum):
    """Which events are shown."""

    ALL = tr_later("all")
    TO_COME = tr_later("to come")
    UNSIGNED = tr_later("not signed off")
    MISSING = tr_later("without a result")  # that is final: to be run, skipped, or not signed off


class EventFilter(NamedTuple):
    """The events that are shown; an empty text shows all."""

    zone: str = ""
    team: str = ""
    day: str = ""  # YYYY-MM-DD
    show: Show = Show.ALL

    def shows(self, event: EventSeen, in_utc: bool = False) -> bool:
        """Return whether an event is shown."""
        return (
            self.zone in ("", event.zone) and self.team in ("", event.team)
            and self.day in ("", day_of(event, in_utc)) and _SHOWN[self.show](event)
        )


_SHOWN: Dict[Show, Callable[[EventSeen], bool]] = {
    Show.ALL: lambda event: True,
    Show.TO_COME: lambda event: event.state in TO_COME,
    Show.UNSIGNED: lambda event: event.unsigned,
    Show.MISSING: lambda event: event.unsigned or not event.identity,
}


def day_of(event: EventSeen, in_utc: bool = False) -> str:
    """Return the day of an event's scheduled time."""
    return times.formatted(event.scheduled_utc_s, "%Y-%m-%d", in_utc)


def moment_text(utc_s: float, with_day: bool) -> str:
    """Return a local moment as HH:MM, or as ``Thu 31 HH:MM``."""
    number = times.formatted(utc_s, "%u", False)
    if not with_day or not number.isdigit():
        return times.formatted(utc_s, "%H:%M", False)
    return f"{tr(times.DAYS[int(number) - 1])} {times.formatted(utc_s, '%d %H:%M', False)}"


# -- choosing ---------------------------------------------------------------------------------------


def left_unsigned(events: Iterable[EventSeen], zone: str) -> Optional[EventSeen]:
    """Return the current event of a zone if its run is over and not signed off; None: nothing to confirm."""
    return next((event for event in events if event.zone == zone and event.current and event.unsigned), None)


def why_not(events: Iterable[EventSeen], chosen: EventSeen) -> str:
    """Return why an event cannot become the current one of its zone; empty: it can."""
    current = next((event for event in events if event.zone == chosen.zone and event.current), None)
    if current is not None and current.state == "running":
        return tr("A run is running in {zone}. Stop it first.", zone=chosen.zone)
    if current is not None and current.state == "connected":
        return tr("A run is connected in {zone}. Disconnect it first.", zone=chosen.zone)
    if chosen.current and chosen.state not in _IN_ZONE:
        return tr("{zone} is at this event already.", zone=chosen.zone)
    return ""
