"""The commands of the terminal referee that edit the schedule of the day (docs/organiser.md, "The day is edited")."""

from typing import Any, Dict, List, Sequence

from roah_rsbb.document.calls import EDIT
from roah_rsbb.document.calls import EDITS as LISTED
from roah_rsbb.model.actions import EDITS, UNDO
from roah_rsbb.model.reason import decoded
from roah_rsbb.referee.at_once import Exit
from roah_rsbb.referee.sheets import event_numbered
from roah_rsbb.referee.terminal import (
    BY,
    ZONE,
    Argument,
    Call,
    Commands,
    argument,
    counted,
    switch,
    text,
    zone,
)
from roah_rsbb.referee.words import BadWord, pick, pick_zone
from roah_rsbb.wording import sheets, whole_box
from roah_rsbb.wording.texts import escaped
from roah_rsbb.wording.times import at_venue

COMMANDS = Commands()
_ACTIONS = Commands()
_NUMBER = "number of an event in its zone ('schedule' shows it)"
_EVENT = argument("event", metavar="N", type=counted, help=_NUMBER)
_TO_ZONE = argument("--to-zone", metavar="ZONE", help="in this zone (default: its own)")


@COMMANDS.add("day", "edit the schedule of the day: a late zone, swap, move, add, a team that withdraws or is late",
              ["shift 'Home A' 40", "list", "swap --help"], actions=_ACTIONS)
def _day(call: Call) -> Exit:
    return _ACTIONS[call.options.action].do(call)


def _add(name: str, examples: Sequence[str], *arguments: Argument) -> None:
    """Add the command of an edit, whose arguments are its fields."""
    said = str(EDITS[name].explanation)
    _ACTIONS.add(name.replace("_", "-"), said[0].lower() + said[1:], examples, *arguments,
                 text("--reason", "why; it is kept"), switch("--yes", "do it without asking"), BY,
                 has_keyboard=True)(lambda call: _edit(call, name))


_add("shift", ["'Home A' 40", "'Home A' 14:20 --reason 'the arena was not ready'", "'Home A' -10 --yes"], ZONE,
     argument("time", help="minutes, also below 0; or the time at which the next event begins, such as 14:20"))
_add("swap", ["'Home A' 3 5", "'Home A' 3 2 --to-zone 'Home B'"], ZONE, _EVENT,
     argument("other", metavar="N", type=counted, help=_NUMBER),
     argument("--to-zone", metavar="ZONE", help="zone of the other event (default: the same)"))
_add("move", ["'Home A' 3 14:20", "'Home A' 3 2026-11-30", "'Home A' 3 --to-zone 'Home B'"], ZONE, _EVENT,
     argument("time", nargs="?", default="", help="such as 14:20, 2026-11-30, or '2026-11-30 14:20'"), _TO_ZONE)
_add("insert", ["'Home A' GPSR Alpha 14:20"], ZONE, argument("benchmark", help="its code"), argument("team"),
     argument("time", help="such as 14:20, or '2026-11-30 14:20'"))
_add("remove", ["'Home A' 3"], ZONE, _EVENT)
_add("repeat", ["'Home A' 3", "'Home A' 3 16:30"], ZONE, _EVENT,
     argument("time", nargs="?", default="", help="such as 16:30 (default: after the zone's last event)"), _TO_ZONE)
_add("withdraw_team", ["Alpha", "Alpha --day 2026-11-29", "Alpha --event 3 --zone 'Home A'"], argument("team"),
     text("--day", "only from events of this day", metavar="YYYY-MM-DD"),
     argument("--event", metavar="N", type=counted, help=_NUMBER), zone("of the event; ", name="--zone"))
_add("add_team", ["TeaAtFive"], argument("team", help="the name that its robot announces"))
_add("advance", ["", "--stage Tasks --to-zone Arena --time '2026-11-29 15:00' --minutes 20"],
     text("--stage", "the stage, if teams advance from several", metavar="STAGE"),
     text("--time", "of the first event (default: those that are planned)", metavar="HH:MM"),
     argument("--minutes", metavar="N", type=counted, help="from one to the next (default: what the benchmark needs)"),
     _TO_ZONE)
_add(UNDO, ["3"], argument("number", metavar="N", type=counted, help="number of the edit ('day list' shows it)"))


@_ACTIONS.add("list", "list the edits: what, who, when, why", [""])
def _list(call: Call) -> Exit:
    found = call.link.request(LISTED)
    lines = [line for edit in found for line in _edit_lines(edit)]
    return call.output.show({"edits": found}, lines or ["the schedule was not edited"])


def _edit_lines(edit: Dict[str, Any]) -> List[str]:
    about = [f"by {sheets.person(edit['who'])}", edit["reason"],
             f"undone by {edit['undone']}" if edit["undone"] else ""]
    label = EDITS[edit["action"]].label if edit["action"] in EDITS else edit["action"]
    head = "; ".join(filter(None, [f"{edit['number']}  {at_venue(edit['utc'])}  {label}", *about]))
    return [escaped(head), *(f"    {escaped(line)}" for line in decoded(edit["words"]))]


def _edit(call: Call, action: str) -> Exit:
    """Show what an edit would do, ask, and do it."""
    given = _given(call, action)
    found = _asked(call, action, given, "")
    with call.confirmed(
        "", lambda: _lines(found), "Do it? [y/N]", "give --yes to do it, or use a terminal, where you are asked",
        "nothing was changed",
    ):
        done = _asked(call, action, given, found["seen"])
    trouble = [f"warning: {escaped(str(decoded([done['trouble']])[0]))}"] if done["trouble"] else []
    shown = [] if not call.options.yes else _lines(done)
    return call.done([*shown, *trouble, whole_box.RELOAD_DONE], f"day {call.options.action}",
                     **{name: [str(line) for line in decoded(done[name])] for name in ("effects", "warnings")})


def _asked(call: Call, action: str, given: Dict[str, Any], seen: str) -> Dict[str, Any]:
    found: Dict[str, Any] = call.link.request(EDIT, action=action, given=given, seen=seen, by=call.options.referee)
    return found


def _lines(found: Dict[str, Any]) -> List[str]:
    return [*map(escaped, decoded(found["effects"])),
            *(f"warning: {escaped(line)}" for line in decoded(found["warnings"]))]


def _given(call: Call, action: str) -> Dict[str, Any]:
    """Return the values of the fields of an edit that were typed. Raises `BadWord`."""
    options, box = vars(call.options), call.link.box
    zones = box.box.zones
    own = "" if options.get("zone") is None else pick_zone(options["zone"], zones)
    to = "" if options.get("to_zone") is None else pick_zone(options["to_zone"], zones)
    given: Dict[str, Any] = {}
    for field in EDITS[action].fields:
        value = options.get(field.name)
        if field.name == "zone":
            value = to if "to_zone" in options else own
        elif field.name in ("event", "other") and value is not None:
            if not own:
                raise BadWord("give the zone of the event, too: --zone")
            value = event_numbered(call, to or own if field.name == "other" else own, value).id
        elif field.name == "team" and action != "add_team":
            value = pick("team", options["team"], sorted({event.team for event in box.events()}))
        if value not in (None, ""):
            given[field.name] = value
    return given
