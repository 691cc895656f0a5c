"""Changes in the box between two snapshots: one `Change` for each thing that a referee wants to know."""

import re
import time
from typing import Any, Dict, Iterator, List, NamedTuple, Optional, Sequence, Tuple

from roah_rsbb.referee.state import BoxSnapshot, ManualOperation, SheetItem, ZoneSnapshot, lines_of
from roah_rsbb.ros import tail
from roah_rsbb.rulebook.benchmarks import ALL_TEAMS

# Numbers in a warning, such as seconds and skews, change all the time. The warning is the same.
_NUMBER = re.compile(r"[+-]?\d+(\.\d+)?")
# The core publishes every 100 ms. After this long without a message, something is wrong.
SILENT_S = 1.5  # the core publishes the zones ten times a second
NOTHING_ASKED = ManualOperation(0, "")


class Change(NamedTuple):
    """One thing that happened. `kind` and `facts` are those of docs/referee.md."""

    utc_s: float
    kind: str
    zone: str  # empty: it concerns the whole box
    facts: Dict[str, Any]


def changes(old: BoxSnapshot, new: BoxSnapshot, zone: Optional[str] = None) -> List[Change]:
    """Return all changes from one snapshot to a later one; with `zone`, only those that concern that zone."""
    found = list(_of_box(old, new, zone))
    for after in new.zones:
        before = old.zone(after.zone)
        if before is not None and zone in (None, after.zone):
            found.extend(_of_zone(before, after, new.clock_utc_s))
    return found


def news(old: Tuple[str, ...], new: Tuple[str, ...]) -> List[str]:
    """Return the new texts. A text that differs in numbers only is not new."""
    known = {_NUMBER.sub("#", text) for text in old}
    return [text for text in new if _NUMBER.sub("#", text) not in known]


def _of_box(old: BoxSnapshot, new: BoxSnapshot, zone: Optional[str]) -> Iterator[Change]:
    def change(kind: str, **facts: Any) -> Change:
        return Change(new.clock_utc_s, kind, "", facts)

    if old.box_uuid != new.box_uuid:
        yield change("core", what="restarted", box_uuid=new.box_uuid)
    yield from _warnings(new.clock_utc_s, "", old.warnings, new.warnings)
    teams = {z.event.team for z in (*old.zones, *new.zones) if zone in (None, z.zone)}
    before, after = (
        {(r.team, r.robot): r for r in box.robots if zone is None or {r.team, ALL_TEAMS} & teams} for box in (old, new)
    )
    for key in after.keys() - before.keys():
        yield change("robot", what="came", team=key[0], robot=key[1], skew_s=after[key].skew_s)
    for key in before.keys() - after.keys():
        yield change("robot", what="gone", team=key[0], robot=key[1], skew_s=before[key].skew_s)


def _of_zone(old: ZoneSnapshot, new: ZoneSnapshot, utc_s: float) -> Iterator[Change]:
    def change(kind: str, **facts: Any) -> Change:
        return Change(utc_s, kind, new.zone, facts)

    for text in _lines(old.log, new.log):
        if not _is_score_change(text, new.score):
            yield change("log", text=text)
    was, now = _state(old), _state(new)
    if was != now:
        yield change("state", **now, changed=[name for name, value in now.items() if value != was[name]])
    for score in _scores(old, new):
        yield change("score", **score)
    for text in _lines(old.online_data, new.online_data):
        yield change("online_data", text=text)
    if new.operation != old.operation:
        asked = new.operation or NOTHING_ASKED
        yield change("manual_operation", operation=asked.number, text=asked.text, choices=list(asked.choices),
                     asks_text=asked.asks_text, fields=list(asked.fields))
    if new.switches != old.switches and new.switches is not None:
        yield change("switches", **new.switches._asdict())
    for score in _module_scores(old, new):
        yield change("module_score", **score)
    if new.module_status not in ("", old.module_status):
        yield change("module_status", text=new.module_status)
    if new.event != old.event:
        yield change("event", **new.event._asdict())
    yield from _warnings(utc_s, new.zone, old.warnings, new.warnings)


def _state(zone: ZoneSnapshot) -> Dict[str, Any]:
    return {
        "phase": zone.phase, "end_reason": zone.end_reason, "robot": zone.robot, "port": zone.port,
        "box_state": zone.box_state, "robot_state": zone.robot_state, "log_file": zone.log_file,
    }


def _scores(old: ZoneSnapshot, new: ZoneSnapshot) -> Iterator[Dict[str, Any]]:
    if new.port != old.port:
        return  # another run with a new sheet
    before = {(item.group, item.item): item for item in old.score}
    for item in new.score:
        was = before.get((item.group, item.item), item)
        if (was.value, was.text, was.not_attempted) != (item.value, item.text, item.not_attempted):
            yield {"number": item.number, "group": item.group, "item": item.item, "type": item.type,
                   "old": was.value, "value": item.value, "old_not_attempted": was.not_attempted,
                   "not_attempted": item.not_attempted, "old_text": was.text, "text": item.text}


def _is_score_change(text: str, items: Sequence[SheetItem]) -> bool:
    """Whether a line of the core's log describes the change of an item. The item is reported for itself.

    The line and the item come in messages of two topics, so one of them may be in an earlier snapshot.
    """
    for item in items:
        _, begin, values = text.partition(f"Score: {item.group}: {item.item} ")
        if begin:
            old, arrow, value = values.partition(" -> ")
            return bool(arrow) and old != value.partition(" (")[0]
    return False


def _module_scores(old: ZoneSnapshot, new: ZoneSnapshot) -> Iterator[Dict[str, Any]]:
    """Yield the lines of a module's score that have another value."""
    before = {(score.group, score.name): score.value for score in old.module_score}
    for score in new.module_score:
        was = before.get((score.group, score.name))
        if was != score.value:
            yield {**score._asdict(), "old": was}


def _lines(old: str, new: str) -> List[str]:
    """Return the lines that were added to `old`."""
    added = tail.added(old, new)
    return lines_of(new if added is None else added)


def _warnings(utc_s: float, zone: str, old: Tuple[str, ...], new: Tuple[str, ...]) -> Iterator[Change]:
    for text in news(old, new):
        yield Change(utc_s, "warning", zone, {"text": text, "over": False})
    for text in news(new, old):
        yield Change(utc_s, "warning", zone, {"text": text, "over": True})


class Follower:
    """Follows the box through silences and restarts of the core. `link` is a `roah_rsbb.referee.link.Link`, or
    behaves like one."""

    def __init__(self, link, zone: Optional[str] = None) -> None:
        self._link = link
        self._zone = zone
        self._silent = False
        self.box = link.box

    def step(self, limit_s: float) -> List[Change]:
        """Return the changes until the next snapshot, or within `limit_s` if none comes."""
        self._link.next(limit_s)
        new = self._link.box
        found: List[Change] = []
        silent = self._link.silence_s > SILENT_S
        if silent != self._silent:
            self._silent = silent
            found.append(Change(time.time(), "core", "", {"what": "silent" if silent else "back"}))
        if new is not self.box:
            found += changes(self.box, new, self._zone)
            self.box = new
        return found
