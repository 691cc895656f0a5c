"""The text of a schedule file after changes of its events. Comments and layout stay.

Only what changes is written: the time of an event in its place, and the line of an event that is added, removed, or
comes between others now. What the text says afterwards is what the changes say, or nothing is written: whoever calls it
reads the new text again and compares.
"""

import re
from typing import Container, Dict, Iterable, NamedTuple, Optional, Tuple

import yaml

from roah_rsbb.model.reason import Refused, say
from roah_rsbb.rulebook.day import EventChange, PlannedSlot
from roah_rsbb.rulebook.errors import Place, Report
from roah_rsbb.rulebook.yaml_fields import utc_time
from roah_rsbb.rulebook.yaml_lines import Scalar
from roah_rsbb.wording.times import date_time, formatted

NOT_BY_LINE = say("The schedule file has an event that does not begin with '- ' on a line of its own: write each so, "
                  "and reload")
_OFFSET = re.compile(r"[+-][0-9]{1,2}:?[0-9]{2}$|Z$")
_PLAIN = re.compile(r"[A-Za-z][A-Za-z0-9_]+(?:[ /-][A-Za-z0-9_]+)*")
_DAY = "%A"


class _Item(NamedTuple):
    """An event in the text: from the beginning of its line to the end of its last one, and its time."""

    zone: str
    begin: int
    end: int
    indent: int  # of the '-'
    time: yaml.ScalarNode
    scheduled: float


def yaml_text(text: str) -> str:
    """Format a text of one line as YAML."""
    if _PLAIN.fullmatch(text) and isinstance(yaml.safe_load(text), str):
        return text
    return "'" + text.replace("'", "''") + "'"


def changed(text: str, changes: Iterable[EventChange]) -> str:
    """Return the text of a schedule file, in which all events have ids, after changes. Raises `Refused`."""
    changes = list(changes)
    items = _items(text)
    here = [(items[change.id], change.after) for change in changes if change.after is not None and change.id in items]
    for place, to in sorted(here, key=lambda one: one[0].begin, reverse=True):
        text = _timed(text, place, to)
    items = _items(text)
    moved = {name for name, slot in ((change.id, change.after) for change in changes) if name in items and (
        slot is None or slot.zone != items[name].zone or not _is_in_order(items, items[name]))}
    cuts = [(items[name].begin, items[name].end, "") for name in moved]
    added: Dict[int, str] = {}  # by place
    for change in sorted(changes, key=lambda change: 0.0 if change.after is None else change.after.scheduled):
        if change.after is not None and (change.id in moved or change.id not in items):
            at, line = _inserted(text, items, moved, change.after, change.id)
            added[at] = added.get(at, "") + line
    newline = _newline(text)
    for at, end, line in sorted([*cuts, *((at, at, line) for at, line in added.items())], reverse=True):
        gap = newline if line and at and not text[:at].endswith("\n") else ""
        text = text[:at] + gap + line + text[end:]
    return text


def _items(text: str) -> Dict[str, _Item]:
    """Return the events of a text by their ids. Raises `Refused`."""
    loader = yaml.CSafeLoader if yaml.__with_libyaml__ else yaml.SafeLoader
    try:
        root = yaml.compose(text, loader)
    except yaml.YAMLError:
        raise Refused([NOT_BY_LINE]) from None
    found: Dict[str, _Item] = {}
    for entry in root.value if isinstance(root, yaml.SequenceNode) else ():
        parts = _parts(entry)
        if "zone" in parts and isinstance(parts.get("schedule"), yaml.SequenceNode):
            for event in parts["schedule"].value:
                keys = _parts(event)
                if not {"id", "scheduled_time"} <= keys.keys():
                    raise Refused([NOT_BY_LINE])
                found[keys["id"].value] = _item(text, parts["zone"].value, event, keys["scheduled_time"])
    return found


def _parts(node: yaml.Node) -> Dict[str, yaml.Node]:
    return {key.value: value for key, value in node.value} if isinstance(node, yaml.MappingNode) else {}


def _item(text: str, zone: str, event: yaml.MappingNode, time: yaml.ScalarNode) -> _Item:
    before = text[:event.start_mark.index].rstrip()
    begin = before.rfind("\n") + 1
    last = event.end_mark.index if event.flow_style else max(value.end_mark.index for _, value in event.value)
    end = text.find("\n", last)
    if not before.endswith("-") or before[begin:].strip(" ") != "-" or (
            event.flow_style and text[last:end if end >= 0 else None].split("#")[0].strip()):
        raise Refused([NOT_BY_LINE])
    seconds = utc_time(Report(), Scalar(Place("", 0, 0), time.value, False, False), "")
    if seconds is None:
        raise Refused([NOT_BY_LINE])
    return _Item(zone, begin, len(text) if end < 0 else end + 1, len(before) - 1 - begin, time, seconds)


def _is_in_order(items: Dict[str, _Item], item: _Item) -> bool:
    """Whether an event is between those before and after it."""
    own = sorted((other for other in items.values() if other.zone == item.zone), key=lambda other: other.begin)
    place = own.index(item)
    near = own[max(0, place - 1):place + 2]
    return all(one.scheduled <= other.scheduled for one, other in zip(near, near[1:]))


def _timed(text: str, item: _Item, slot: PlannedSlot) -> str:
    """Return the text with the new time of an event, and the day of the week in its comment."""
    begin, end = item.time.start_mark.index, item.time.end_mark.index
    rest = text[end:item.end]
    was, now = (formatted(utc, _DAY, in_utc=False) for utc in (item.scheduled, slot.scheduled))
    rest = re.sub(rf"#( *){was}(?=\s*$)", rf"#\g<1>{now}", rest)
    return text[:begin] + _written(slot.scheduled, bool(_OFFSET.search(item.time.value))) + rest + text[item.end:]


def _written(utc: float, has_offset: bool = True) -> str:
    if has_offset:
        found = date_time(utc)
        return found[:19] if found.endswith("+00:00") else found
    return formatted(utc, "%Y-%m-%d %H:%M:%S", in_utc=True)


def _inserted(
    text: str, items: Dict[str, _Item], moved: Container[str], slot: PlannedSlot, own: str
) -> Tuple[int, str]:
    """Return where an event comes among those of its zone that are not `moved`, and its lines. Raises `Refused`."""
    there = sorted(((item, name in moved) for name, item in items.items() if item.zone == slot.zone),
                   key=lambda one: one[0].begin)
    if not there:
        raise Refused([NOT_BY_LINE])
    stay = [item for item, is_moved in there if not is_moved]
    before: Optional[_Item] = next((item for item in reversed(stay) if item.scheduled <= slot.scheduled), None)
    at = before.end if before is not None else (stay or [there[0][0]])[0].begin
    to, newline = (before or there[0][0]).indent, _newline(text)
    if own in items:
        lines, by = text[items[own].begin:items[own].end].splitlines(), to - items[own].indent
        return at, newline.join(_indented(part, by) for part in lines) + newline
    return at, (f"{' ' * to}- {{ benchmark: {slot.benchmark}, team: {yaml_text(slot.team)}, round: {slot.round}, "
                f"run: {slot.run}, scheduled_time: {_written(slot.scheduled)}, id: {own} }}"
                f"  # {formatted(slot.scheduled, _DAY, in_utc=False)}{newline}")


def _newline(text: str) -> str:
    return "\r\n" if "\r\n" in text else "\n"


def _indented(line: str, by: int) -> str:
    return " " * by + line if by >= 0 else line[min(-by, len(line) - len(line.lstrip(" "))):]
