"""The commands of the terminal referee for the schedule, the configuration, and the devices that the box's pages pair
(docs/web.md, "Pairing" and "Pages of teams")."""

from typing import Any, Dict, List

from roah_rsbb.document.calls import PAIR, PAIRED, REVOKE, TEAM_CODES
from roah_rsbb.model.actions import ORGANISER, ROLES, UNSIGNED
from roah_rsbb.model.reason import Refused
from roah_rsbb.referee import view
from roah_rsbb.referee.at_once import Exit
from roah_rsbb.referee.sheets import event_numbered
from roah_rsbb.referee.state import scheduled_json
from roah_rsbb.referee.terminal import BY, LEAVING, ZONE, Call, Commands, argument, counted, switch, text, zone
from roah_rsbb.referee.words import BadWord, pick
from roah_rsbb.wording import schedule, whole_box
from roah_rsbb.wording.device import encryption_text, role_text
from roah_rsbb.wording.texts import escaped
from roah_rsbb.wording.times import countdown

# How the terminal confirms what `choose` asks for.
GIVE_UNSIGNED = "Give --unsigned to leave it, or sign it off first ('sign-off')"


COMMANDS = Commands()


# -- the schedule ---------------------------------------------------------------------------------


@COMMANDS.add(
    "schedule", "list all events with results, sign-offs and estimated times",
    ["", "'Home A' --day 2026-11-28", "--team Beta", "--show missing    (what is not run or not signed off)"],
    zone("only the events of this zone; ", "?"), text("--team", "only the events of this team", metavar="TEAM"),
    text("--day", "only the events of this day", metavar="YYYY-MM-DD"),
    argument("--show", choices=[show.name.lower().replace("_", "-") for show in schedule.Show], default="all",
             help="all events (default), to-come, unsigned (not signed off), or missing (without a result that "
                  "is signed off)"),
)
def _schedule(call: Call) -> Exit:
    options, events = call.options, call.link.box.events()
    team = options.team and pick("team", options.team, sorted({event.team for event in events}))
    day = options.day and pick("day", options.day, sorted({schedule.day_of(event, options.utc) for event in events}))
    shown = schedule.EventFilter(
        call.one_zone or "", team, day, schedule.Show[options.show.upper().replace("-", "_")])
    found = [event for event in events if shown.shows(event, options.utc)]
    return call.output.show({"events": [scheduled_json(event) for event in found]},
                            [*view.schedule_lines(found, call.output.style), "", schedule.summary(found)])


@COMMANDS.add(
    "choose", "make an event of the schedule the current one of its zone", ["'Home A' 3", "'Home A' 3 --unsigned"],
    ZONE, argument("event", type=counted, help="number of the event in its zone ('schedule' shows it)"),
    switch("--unsigned", "leave the zone's run although its score sheet is not signed off"), LEAVING, BY,
)
def _choose(call: Call) -> Exit:
    options = call.options
    event = event_numbered(call, call.zone_name, options.event)
    call.check_stopped()
    try:
        call.act("choose_event", {"event": event.id, "team": event.team, "unsigned": options.unsigned})
    except Refused as refused:
        templates = [getattr(reason, "template", "") for reason in refused.reasons]
        how = [GIVE_UNSIGNED] if UNSIGNED.template in templates else []
        raise Refused([*refused.reasons, *how]) from None
    return call.say_done()


# -- the configuration ----------------------------------------------------------------------------


@COMMANDS.add(
    "reload", "take changed configuration files into use, without a restart",
    ["", "--check    (only list what would change)", "--yes --by Olga"],
    switch("--check", "change nothing: only list errors and changes"),
    switch("--yes", "apply the changes without asking"),
    switch("--for-all", "score the runs that are over by changed sheets, too; signed ones get a new version"), BY,
    has_keyboard=True,
)
def _reload(call: Call) -> Exit:
    """Check the configuration files, list what they change, and apply it."""
    found = _reloaded(call, "")
    is_needed = found["changes"] or (call.options.for_all and found["rescored"])
    if not is_needed or call.options.check:
        return _show_reload(call, found)
    with call.confirmed(
        "", lambda: _reload_lines(found), "Apply these changes? [y/N]",
        "give --yes to apply the changes, --check to list them, or use a terminal, where you are asked",
        "nothing was changed",
    ):
        return _show_reload(call, _reloaded(call, found["digest"]))


def _reloaded(call: Call, digest: str) -> Dict[str, Any]:
    answer = call.link.reload(digest, call.options.referee, call.options.for_all)
    if answer["errors"]:
        raise Refused([*answer["errors"], "Nothing was changed"])
    return answer


def _show_reload(call: Call, answer: Dict[str, Any]) -> Exit:
    is_done = answer["applied"] and (answer["changes"] or (call.options.for_all and answer["rescored"]))
    end = [whole_box.RELOAD_DONE] if is_done else []
    names = "applied", "changes", "rescored", "warnings"
    return call.done(_reload_lines(answer) + end, **{name: answer[name] for name in names})


def _reload_lines(answer: Dict[str, Any]) -> List[str]:
    warnings = [f"warning: {escaped(text)}" for text in answer["warnings"]]
    rescored = [escaped(text) for text in answer["rescored"]]
    return [*warnings, *([escaped(text) for text in answer["changes"]] or [whole_box.RELOAD_SAME]),
            *([f"{whole_box.RELOAD_RESCORED} (--for-all)", *rescored] if rescored else [])]


# -- devices and codes ------------------------------------------------------------------------------


@COMMANDS.add(
    "pair", "show a code that pairs a phone or tablet: it can then act as a referee",
    ["'Home A'", "'Home A' --role assistant", "--role organiser"], zone("where it may act; ", "?"),
    argument("--role", choices=ROLES, default="referee",
             help="referee (default): everything in the zone; assistant: marks, notes, STOP; judge: ratings only; "
                  "timekeeper: start, clock, notes, STOP; observer: only reads; organiser: all zones"),
)
def _pair(call: Call) -> Exit:
    """Print a code for one device."""
    from roah_rsbb.web import pairing  # late: no other command needs it

    role, output = call.options.role, call.output
    if (role == ORGANISER) != (call.options.zone is None):
        raise BadWord("give the zone where the device may act; an organiser has none, because all zones are theirs")
    name = call.one_zone or ""
    answer = call.link.request(PAIR, role=role, zone=name)
    url, code, valid_s = answer["url"], answer["code"], answer["valid"]
    return call.done([
        *(() if output.json else pairing.lines_of(url) or [f"No QR code: install it with '{pairing.INSTALL}'"]),
        f"{role_text(role, name)}: open {url}",
        f"or open {url.partition('#')[0]} and type the code {output.style(view.BOLD, code)}",
        f"The code is for one device, and valid for {countdown(valid_s)}",
        *filter(None, [encryption_text(url)]),
    ], role=role, zone=name, code=code, url=url, valid_s=valid_s)


@COMMANDS.add(
    "devices", "list the paired phones and tablets, or end pairings", ["", "--revoke 1f3c9a02", "--revoke-all"],
    text("--revoke", "end the pairing of this device at once", metavar="ID", default=None),
    switch("--revoke-all", "end all pairings at once"), is_exclusive=True,
)
def _devices(call: Call) -> Exit:
    """List the paired devices, or end pairings."""
    one = call.options.revoke
    if one is not None or call.options.revoke_all:
        ended = call.link.request(REVOKE, device=one or "")["revoked"]
        if not ended and one:
            raise BadWord(f"no device has the name '{one}': 'referee devices' lists them")
        return call.done([f"{ended} pairings ended" if ended != 1 else "1 pairing ended"], revoked=ended)
    found = call.link.request(PAIRED)["devices"]
    return call.done(view.device_lines(found, call.output.style), devices=[
        {**{name: device[name] for name in ("id", "role", "zone", "person", "device")},
         "paired_utc_s": device["paired"], "seen_utc_s": device["seen"] or None, "connected": device["connected"]}
        for device in found])


@COMMANDS.add(
    "team-codes", "list the codes with which teams see how the box hears their robot",
    ["", "--renew    (the codes before become invalid)"], switch("--renew", "give all teams new codes first"),
)
def _team_codes(call: Call) -> Exit:
    answer = call.link.request(TEAM_CODES, renew=call.options.renew)
    found = dict(zip(answer["teams"], answer["codes"]))
    width = max(map(len, map(escaped, found)), default=0)
    lines = [f"{escaped(team):{width}}  {call.output.style(view.BOLD, code)}" for team, code in found.items()]
    if not lines:
        lines = ["no teams are known yet: the pages have not heard the box"]
    if answer["team_pages"] == "all":
        lines.append("team_pages is all: everybody sees the links and clocks of all teams, so codes are not needed")
    return call.done(lines, renewed=call.options.renew, team_pages=answer["team_pages"], codes=found)
