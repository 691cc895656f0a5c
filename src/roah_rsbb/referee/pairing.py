"""The terminal's commands for phones and tablets: pair one, list them, end pairings (docs/web.md, "Pairing"); and for
the codes of teams (docs/web.md, "Pages of teams")."""

from typing import Any, Dict, List

from roah_rsbb.document.calls import PAIR, PAIRED, REVOKE, TEAM_CODES
from roah_rsbb.referee.exits import Exit
from roah_rsbb.referee.link import Link
from roah_rsbb.referee.output import Output
from roah_rsbb.referee.view import BOLD, Style
from roah_rsbb.referee.words import BadWord, pick_zone
from roah_rsbb.web import pairing
from roah_rsbb.wording.device import encryption_text, role_text
from roah_rsbb.wording.texts import escaped
from roah_rsbb.wording.times import countdown

ORGANISER = "organiser"


def pair(link: Link, options: Any, output: Output) -> Exit:
    """Print a code for one device."""
    if (options.role == ORGANISER) != (options.zone is None):
        raise BadWord("give the zone of a referee or judge; an organiser has none, because all zones are theirs")
    zone = "" if options.zone is None else pick_zone(options.zone, link.box.box.zones)
    answer = link.request(PAIR, role=options.role, zone=zone)
    url, code, valid_s = answer["url"], answer["code"], answer["valid"]
    if output.json:
        output.object({"ok": True, "command": "pair", "role": options.role, "zone": zone, "code": code,
                       "url": url, "valid_s": valid_s})
        return Exit.OK
    square = pairing.lines_of(url)
    page = url.partition("#")[0]
    output.lines([
        *(square or [f"No QR code: install it with '{pairing.INSTALL}'"]),
        f"{role_text(options.role, zone)}: open {url}",
        f"or open {page} and type the code {output.style(BOLD, code)}",
        f"The code is for one device, and valid for {countdown(valid_s)}",
        *filter(None, [encryption_text(url)]),
    ])
    return Exit.OK


def devices(link: Link, options: Any, output: Output) -> Exit:
    """List the paired devices, or end pairings."""
    if options.revoke is not None or options.revoke_all:
        ended = link.request(REVOKE, device=options.revoke or "")["revoked"]
        if not ended and options.revoke:
            raise BadWord(f"no device has the name '{options.revoke}': 'referee devices' lists them")
        if output.json:
            output.object({"ok": True, "command": "devices", "revoked": ended})
        else:
            output.lines([f"{ended} pairings ended" if ended != 1 else "1 pairing ended"])
        return Exit.OK
    found = link.request(PAIRED)["devices"]
    if output.json:
        output.object({"ok": True, "command": "devices", "devices": [
            {**{name: one[name] for name in ("id", "role", "zone", "person", "device")},
             "paired_utc_s": one["paired"], "seen_utc_s": one["seen"] or None, "connected": one["connected"]}
            for one in found
        ]})
    else:
        output.lines(_lines(found, output.style))
    return Exit.OK


def team_codes(link: Link, options: Any, output: Output) -> Exit:
    """Print the codes of the teams."""
    answer = link.request(TEAM_CODES, renew=options.renew)
    found = dict(zip(answer["teams"], answer["codes"]))
    if output.json:
        output.object({"ok": True, "command": "team-codes", "renewed": options.renew,
                       "team_pages": answer["team_pages"], "codes": found})
        return Exit.OK
    width = max(map(len, map(escaped, found)), default=0)
    lines = [f"{escaped(team):{width}}  {output.style(BOLD, code)}" for team, code in found.items()]
    if not lines:
        lines = ["no teams are known yet: the pages have not heard the core"]
    if answer["team_pages"] == "all":
        lines.append("team_pages is all: everybody sees the links and clocks of all teams, so codes are not needed")
    output.lines(lines)
    return Exit.OK


COMMANDS = {"pair": pair, "devices": devices, "team-codes": team_codes}


def _lines(found: List[Dict[str, Any]], style: Style) -> List[str]:
    return [
        f"{one['id']}  {escaped(one['person'])}, {escaped(role_text(one['role'], one['zone']))}, "
        f"{escaped(one['device'])}: "
        + ("connected" if one["connected"] else f"seen {style.moments.stamp(one['seen'] or one['paired'])}")
        for one in found
    ] or ["no device is paired"]
