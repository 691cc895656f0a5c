"""The terminal's commands for phones and tablets: pair one, list them, end pairings (docs/web.md, "Pairing"); and for
the codes of teams (docs/web.md, "Pages of teams")."""

from typing import Any, List

from roah_rsbb import qr_code
from roah_rsbb.client.places import DoorPlaces
from roah_rsbb.model.referee import Refused
from roah_rsbb.referee import ros_client
from roah_rsbb.referee.exits import Exit, NoCore
from roah_rsbb.referee.link import Link
from roah_rsbb.referee.output import Output
from roah_rsbb.referee.view import BOLD, Style
from roah_rsbb.referee.words import BadWord, pick_zone
from roah_rsbb.ros import refusals
from roah_rsbb.srv import PairDevice, PairedDevices, RevokeDevice, TeamCodes
from roah_rsbb.wording.device import NO_WEB, encryption_text, role_text
from roah_rsbb.wording.texts import escaped
from roah_rsbb.wording.times import countdown

ORGANISER = "organiser"
ANSWER_S = 6.0


def _call(link: Link, name: str, kind: type, *request: object) -> Any:
    """Call a service of the web pages' node; raises `Refused`, or `NoCore`."""
    try:
        return ros_client.call(DoorPlaces().master_uri, link.node, name, kind, *request, limit_s=ANSWER_S)
    except ros_client.Late:
        raise NoCore(f"{name} did not answer within {ANSWER_S:.0f} s: {NO_WEB}") from None
    except ros_client.ServiceError as error:
        raise Refused(refusals.answered_reasons(str(error))) from None
    except ros_client.RosError as error:
        raise NoCore(f"{name} could not be called ({error}): {NO_WEB}") from None


def pair(link: Link, options: Any, output: Output) -> Exit:
    """Print a code for one device."""
    if (options.role == ORGANISER) != (options.zone is None):
        raise BadWord("give the zone of a referee or judge; an organiser has none, because all zones are theirs")
    zone = "" if options.zone is None else pick_zone(options.zone, link.box.box.zones)
    answer = _call(link, "/web/pair", PairDevice, options.role, zone)
    valid_s = answer.valid.to_sec()
    if output.json:
        output.object({"ok": True, "command": "pair", "role": options.role, "zone": zone, "code": answer.code,
                       "url": answer.url, "valid_s": valid_s})
        return Exit.OK
    square = qr_code.lines_of(answer.url)
    page = answer.url.partition("#")[0]
    output.lines([
        *(square or [f"No QR code: install it with '{qr_code.INSTALL}'"]),
        f"{role_text(options.role, zone)}: open {answer.url}",
        f"or open {page} and type the code {output.style(BOLD, answer.code)}",
        f"The code is for one device, and valid for {countdown(valid_s)}",
        *filter(None, [encryption_text(answer.url)]),
    ])
    return Exit.OK


def devices(link: Link, options: Any, output: Output) -> Exit:
    """List the paired devices, or end pairings."""
    if options.revoke is not None or options.revoke_all:
        ended = _call(link, "/web/revoke", RevokeDevice, options.revoke or "").revoked
        if not ended and options.revoke:
            raise BadWord(f"no device has the name '{options.revoke}': 'referee devices' lists them")
        if output.json:
            output.object({"ok": True, "command": "devices", "revoked": ended})
        else:
            output.lines([f"{ended} pairings ended" if ended != 1 else "1 pairing ended"])
        return Exit.OK
    found = _call(link, "/web/sessions", PairedDevices).devices
    if output.json:
        output.object({"ok": True, "command": "devices", "devices": [
            {"id": one.id, "role": one.role, "zone": one.zone, "person": one.person, "device": one.device,
             "paired_utc_s": one.paired.to_sec(), "seen_utc_s": one.seen.to_sec() or None, "connected": one.connected}
            for one in found
        ]})
    else:
        output.lines(_lines(found, output.style))
    return Exit.OK


def team_codes(link: Link, options: Any, output: Output) -> Exit:
    """Print the codes of the teams."""
    answer = _call(link, "/web/team_codes", TeamCodes, options.renew)
    found = dict(zip(answer.teams, answer.codes))
    if output.json:
        output.object({"ok": True, "command": "team-codes", "renewed": options.renew, "team_pages": answer.team_pages,
                       "codes": found})
        return Exit.OK
    width = max(map(len, map(escaped, found)), default=0)
    lines = [f"{escaped(team):{width}}  {output.style(BOLD, code)}" for team, code in found.items()]
    if not lines:
        lines = ["no teams are known yet: the pages have not heard the core"]
    if answer.team_pages == "all":
        lines.append("team_pages is all: everybody sees the links and clocks of all teams, so codes are not needed")
    output.lines(lines)
    return Exit.OK


COMMANDS = {"pair": pair, "devices": devices, "team-codes": team_codes}


def _lines(found: List[Any], style: Style) -> List[str]:
    return [
        f"{one.id}  {escaped(one.person)}, {escaped(role_text(one.role, one.zone))}, {escaped(one.device)}: "
        + ("connected" if one.connected else f"seen {style.moments.stamp(one.seen.to_sec() or one.paired.to_sec())}")
        for one in found
    ] or ["no device is paired"]
