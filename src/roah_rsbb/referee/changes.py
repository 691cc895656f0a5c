"""Changes in the box between two documents: one `Change` for each thing that a referee wants to know."""

import re
import time
from typing import Any, Dict, Iterator, List, NamedTuple, Optional, Sequence, Tuple

from roah_rsbb.document import difference
from roah_rsbb.model.document import Document
from roah_rsbb.model.zone import SheetItem, ZoneSeen
from roah_rsbb.referee.state import asked_in, event_json, lines_of, operation_json, score_json, state_json, zones_of
from roah_rsbb.rulebook.benchmarks import ALL_TEAMS

# Numbers in a warning, such as seconds and skews, change all the time. The warning is the same.
_NUMBER = re.compile(r"[+-]?\d+(\.\d+)?")


class Change(NamedTuple):
    """One thing that happened. `kind` and `facts` are those of docs/referee.md."""

    utc_s: float
    kind: str
    zone: str  # empty: it concerns the whole box
    facts: Dict[str, Any]


def changes(old: Document, new: Document, utc_s: float, zone: Optional[str] = None) -> List[Change]:
    """Return all changes from one document to a later one, of this time; with `zone`, only those that concern that
    zone."""
    found = list(_of_box(old, new, utc_s, zone))
    for after in zones_of(new):
        before = old.zones.get(after.zone)
        if before is not None and before is not after and zone in (None, after.zone):
            found.extend(_of_zone(before, after, utc_s))
    return found


def news(old: Tuple[str, ...], new: Tuple[str, ...]) -> List[str]:
    """Return the new texts. A text that differs in numbers only is not new."""
    known = {_NUMBER.sub("#", text) for text in old}
    return [text for text in new if _NUMBER.sub("#", text) not in known]


def _of_box(old: Document, new: Document, utc_s: float, zone: Optional[str]) -> Iterator[Change]:
    def change(kind: str, **facts: Any) -> Change:
        return Change(utc_s, kind, "", facts)

    if old.box.uuid != new.box.uuid:
        yield change("core", what="restarted", box_uuid=new.box.uuid)
    yield from _warnings(utc_s, "", old.box.warnings, new.box.warnings)
    teams = {one.event.team for box in (old, new) for one in box.zones.values() if zone in (None, one.zone)}
    before, after = (
        {name: robot for name, robot in box.robots.items() if zone is None or {robot.team, ALL_TEAMS} & teams}
        for box in (old, new))
    for what, found, other in (("came", after, before), ("gone", before, after)):
        for name, robot in found.items():
            if name not in other:
                yield change("robot", what=what, team=robot.team, robot=robot.robot, skew_s=robot.skew)


def _of_zone(old: ZoneSeen, new: ZoneSeen, utc_s: float) -> Iterator[Change]:
    def change(kind: str, **facts: Any) -> Change:
        return Change(utc_s, kind, new.zone, facts)

    warned = tuple(_NUMBER.sub("#", text) for text in news(old.warnings, new.warnings))  # each is reported for itself
    for text in _lines(old.log, new.log):
        if not _is_score_change(text, new.items) and not _NUMBER.sub("#", text).endswith(warned):
            yield change("log", text=text)
    was, now = state_json(old), state_json(new)
    if was != now:
        yield change("state", **now, changed=[name for name, value in now.items() if value != was[name]])
    for score in _scores(old, new):
        yield change("score", **score)
    for text in _lines(old.online_data, new.online_data):
        yield change("online_data", text=text)
    if _asked(new) != _asked(old):
        yield change("manual_operation", operation=new.operation, **operation_json(new))
    if new.switches != old.switches and new.switches is not None:
        yield change("switches", **new.switches._asdict())
    for score in _module_scores(old, new):
        yield change("module_score", **score)
    if new.module_status not in ("", old.module_status):
        yield change("module_status", text=new.module_status)
    if new.event != old.event:
        yield change("event", **event_json(new))
    yield from _warnings(utc_s, new.zone, old.warnings, new.warnings)


def _asked(zone: ZoneSeen) -> Any:
    return zone.operation, zone.manual_operation, asked_in(zone)


def _scores(old: ZoneSeen, new: ZoneSeen) -> Iterator[Dict[str, Any]]:
    if new.identity != old.identity:
        return  # another run with a new sheet
    before = {(item.group, item.desc): item for item in old.items}
    for number, item in enumerate(new.items, 1):
        was = before.get((item.group, item.desc), item)
        if (was.value, was.text, was.not_attempted) != (item.value, item.text, item.not_attempted):
            yield {"number": number, "group": item.group, "item": item.desc, "type": item.type,
                   "old": was.value, "value": item.value, "old_not_attempted": was.not_attempted,
                   "not_attempted": item.not_attempted, "old_text": was.text, "text": item.text}


def _is_score_change(text: str, items: Sequence[SheetItem]) -> bool:
    """Whether a line of the core's log describes the change of an item. The item is reported for itself."""
    for item in items:
        _, begin, values = text.partition(f"Score: {item.group}: {item.desc} ")
        if begin:
            old, arrow, value = values.partition(" -> ")
            return bool(arrow) and old != value.partition(" (")[0]
    return False


def _module_scores(old: ZoneSeen, new: ZoneSeen) -> Iterator[Dict[str, Any]]:
    """Yield the lines of a module's score that have another value."""
    before = {(score.group, score.name): score for score in old.module_scores}
    for score in new.module_scores:
        was = before.get((score.group, score.name))
        if was is None or was.value != score.value:
            found = {**score_json(score), "old": None if was is None else score_json(was)["value"]}
            if found["value"] != found["old"]:
                yield found


def _lines(old: str, new: str) -> List[str]:
    """Return the lines that were added to `old`."""
    added = difference.added(old, new)
    return lines_of(new if added is None else added)


def _warnings(utc_s: float, zone: str, old: Tuple[str, ...], new: Tuple[str, ...]) -> Iterator[Change]:
    for text in news(old, new):
        yield Change(utc_s, "warning", zone, {"text": text, "over": False})
    for text in news(new, old):
        yield Change(utc_s, "warning", zone, {"text": text, "over": True})


class BoxFollower:
    """Follows the box through silences and restarts of the core. `link` is an open `roah_rsbb.referee.link.Link`, or
    behaves like one."""

    def __init__(self, link: Any, zone: Optional[str] = None) -> None:
        self._link = link
        self._zone = zone
        self._silent = False
        self.box: Document = link.box

    def step(self, limit_s: float) -> List[Change]:
        """Return the changes until something is new, or within `limit_s` if nothing is."""
        self._link.next(limit_s)
        new = self._link.box
        found: List[Change] = []
        if self._link.is_old != self._silent:
            self._silent = not self._silent
            facts = {"what": "silent", "why": self._link.trouble} if self._silent else {"what": "back"}
            found.append(Change(time.time(), "core", "", facts))
        if new is not self.box:
            found += changes(self.box, new, self._link.now().utc, self._zone)
            self.box = new
        return found
