"""The values of the box as `--json` prints them, and its changes.

The names are those of docs/referee.md and never change. Times are UTC seconds since 1970, durations are seconds.
"""

import json
import re
import time
from typing import Any, Dict, Iterator, List, NamedTuple, Optional, Sequence, Tuple

from roah_rsbb.document import difference
from roah_rsbb.model.actions import ACTIONS, Row
from roah_rsbb.model.clock import Now
from roah_rsbb.model.document import Document
from roah_rsbb.model.fields import Choice, Field, TypedText, entered
from roah_rsbb.model.reason import Said
from roah_rsbb.model.records import ScoreValue
from roah_rsbb.model.results import EventSeen, RunLine, RunSheet
from roah_rsbb.model.zone import Event, SheetItem, ZoneSeen
from roah_rsbb.referee.words import command_of, to_confirm
from roah_rsbb.wording import sheets
from roah_rsbb.wording.public import ALL_TEAMS
from roah_rsbb.wording.times import clock_lines, clock_of

Json = Dict[str, Any]

# They are of no interest in a zone without such a module.
_OF_MODULES = [action.name for action in ACTIONS.values() if action.row is Row.MODULE]


def as_json(value: Any) -> Any:
    """Return a value for `json.dumps`; one of the model with the names of its fields. Times and durations are rounded
    to microseconds."""
    if isinstance(value, Field):
        return value.form()
    if isinstance(value, tuple) and hasattr(value, "_asdict"):
        return {name: as_json(field) for name, field in value._asdict().items()}
    if isinstance(value, (list, tuple)):
        return [as_json(item) for item in value]
    if isinstance(value, dict):
        return {key: as_json(item) for key, item in value.items()}
    return round(value, 6) if isinstance(value, float) else value


# -- what the terminal shows of a box ---------------------------------------------------------------


def zones_of(box: Document) -> List[ZoneSeen]:
    """Return the zones in the order of the schedule."""
    return [box.zones[name] for name in box.box.zones if name in box.zones]


def off_in(zone: ZoneSeen) -> Dict[str, Tuple[Said, ...]]:
    """Return why each command is refused, without those of benchmarking modules that nobody asks for."""
    return {command_of(name): action.off + to_confirm(action)
            for name, action in zone.actions.items() if action.shown or name not in _OF_MODULES}


def asked_in(zone: ZoneSeen) -> Tuple[Field, ...]:
    """Return what the referee enters for the manual operation."""
    return entered(zone.fields("operation")) if zone.operation else ()


def silence_s(silent_since: Optional[float], now: Now) -> float:
    """Return for how long something has not been heard; one that is not silent was heard now."""
    return 0.0 if silent_since is None else max(0.0, now.mono - silent_since)


def lines_of(text: str) -> List[str]:
    """Return the lines that the core wrote. Only \\n ends a line; a robot's text may contain other line ends."""
    return [line for line in text.split("\n") if line]


# -- as JSON ----------------------------------------------------------------------------------------


def box_json(box: Document, now: Now) -> Json:
    """Return the whole box at a moment."""
    return {
        "clock_utc_s": now.utc, "status": box.box.status, "host": box.box.host, "port": str(box.box.port),
        "box_uuid": box.box.uuid, "warnings": box.box.warnings,
        "robots": [{
            "team": robot.team, "robot": robot.robot, "skew_s": robot.skew,
            "last_heard_utc_s": now.utc - silence_s(robot.silent_since, now),
            "age_s": silence_s(robot.silent_since, now),
        } for robot in box.robots.values()],
        "zones": [zone_json(zone, now) for zone in zones_of(box)],
    }


def zone_json(zone: ZoneSeen, now: Now) -> Json:
    """Return a zone, its event and its run at a moment. Unknown values are None or empty."""
    robot, of_all = zone.robot, zone.all_robots
    return {
        "zone": zone.zone, "event": event_json(zone), **state_json(zone), "identity": zone.identity,
        "timer_s": zone.clock.timer(now.mono), "state": [line for text in zone.lines for line in lines_of(text)],
        "skew_s": None if robot is None else robot.skew,
        "last_message_utc_s": (
            None if robot is None or not robot.heard else now.utc - silence_s(robot.silent_since, now)),
        "messages_saved": 0 if robot is None else robot.messages_saved,
        "manual_operation": zone.manual_operation, "warnings": zone.warnings, "off": off_in(zone),
        "score": items_json(zone.items), "log": zone.log, "online_data": zone.online_data,
        "operation": {"number": zone.operation, **operation_json(zone)} if zone.operation else None,
        "switches": zone.switches, "held": zone.held, "module_status": zone.module_status,
        "module_score": [score_json(score) for score in zone.module_scores], "points": sheets.points_text(zone.points),
        "all_robots": None if of_all is None else {
            "preparing": of_all.preparing, "executing": of_all.executing, "stopped": of_all.stopped,
            "robots": of_all.robots},
        "times": _times_json(zone, now.mono), "by_hand": zone.by_hand, "attempt": zone.attempt,
        "attempts": zone.attempts, "robots_to_choose": zone.robots_to_choose, "not_stopped": zone.not_stopped,
    }


def state_json(zone: ZoneSeen) -> Json:
    """Return the states of a zone and its robot."""
    robot = zone.robot
    return {
        "phase": zone.phase, "end_reason": zone.end_reason, "robot": zone.robot_name, "port": zone.port,
        "box_state": "" if robot is None else robot.box_state,
        "robot_state": "" if robot is None else robot.robot_state, "log_file": zone.log_file,
    }


def event_json(zone: ZoneSeen) -> Json:
    """Return the event of a zone."""
    event: Event = zone.event
    return {"code": event.code, "name": event.name, "desc": event.desc, "team": event.team, "round": event.round,
            "run": event.run, "scheduled_utc_s": event.scheduled, "timeout_s": zone.timeout}


def operation_json(zone: ZoneSeen) -> Json:
    """Return the manual operation, without its number. `choices`: of its first choice, the usual one first."""
    fields = asked_in(zone)
    choices = next((field.choices for field in fields if isinstance(field, Choice)), ())
    return {"text": zone.manual_operation, "choices": list(choices),
            "asks_text": any(isinstance(field, TypedText) for field in fields), "fields": list(fields)}


def score_json(score: ScoreValue) -> Json:
    """Return a line of a module's score; its value is a number, a bool, a text, or None if not known yet."""
    try:
        value = json.loads(score.value)
    except ValueError:
        value = score.value
    return {"group": score.group, "name": score.name, "value": value, "unit": score.unit, "desc": score.desc}


def item_json(number: int, item: SheetItem) -> Json:
    """Return a scoring item. Its number counts from 1 through the whole sheet."""
    return {
        "number": number, "group": item.group, "item": item.desc, "type": item.type, "value": item.value,
        "not_attempted": item.not_attempted, "text": item.text, "points": item.points, "choices": item.choices,
        "judges": item.judges, "ratings": item.ratings,
    }


def items_json(items: Sequence[SheetItem]) -> List[Json]:
    """Return the scoring items of a sheet."""
    return [item_json(number, item) for number, item in enumerate(items, 1)]


def run_json(run: RunLine) -> Json:
    """Return a run, without its score sheet."""
    return {name: value for name, value in run._asdict().items() if name != "revision"}


def sheet_json(sheet: RunSheet) -> Json:
    """Return a run with its score sheet. `corrected`: numbers of the items that were changed after the run was over."""
    return {
        "run": run_json(sheet.run), "robots": sheet.robots, "elapsed_s": sheet.elapsed_s,
        "items": items_json(sheet.items),
        "corrected": [number for number, item in enumerate(sheet.items, 1) if item.corrected],
        "history": sheet.history, "ends": sheet.ends, "points": sheets.points_text(sheet.points),
    }


def scheduled_json(event: EventSeen) -> Json:
    """Return an event of the schedule."""
    return {**{name: value for name, value in event._asdict().items() if name != "id"}, "late_s": event.late_s}


def _times_json(zone: ZoneSeen, mono: float) -> Json:
    clock, shown = zone.clock, clock_of(zone.clock, zone.phase, mono)
    return {
        "text": clock_lines(shown._replace(pause="")), "pause": shown.pause, "limit_s": clock.limit,
        "elapsed_s": clock.spent(mono), "counting": clock.elapsed.counting, "goal": clock.goal,
        "goal_limit_s": clock.goal_limit, "goal_elapsed_s": clock.goal_spent(mono),
        "goal_counting": clock.goal_elapsed.counting, "after_stop_s": clock.after_stop(mono),
        "setup_limit_s": clock.setup_limit, "setup_elapsed_s": clock.setup_elapsed.at(mono),
        "setup_counting": clock.setup_elapsed.counting, "phase": clock.phase_number, "phase_name": clock.phase_name,
        "phase_limit_s": clock.phase_limit, "phase_elapsed_s": clock.phase_elapsed.at(mono),
    }


# -- changes between two documents: one for each thing that a referee wants to know ---------------

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
                   "not_attempted": item.not_attempted, "old_text": was.text, "text": item.text, "unit": item.unit}


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
