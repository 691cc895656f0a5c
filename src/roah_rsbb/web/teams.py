"""The codes with which teams see what is not for everybody on their page (docs/web.md, "Pages of teams"). No I/O.

Codes are derived from one secret, which is kept. So they are the same after a restart, also for teams that come later.
"""

import hashlib
import hmac
import secrets
from typing import Any, Dict, Tuple

from tornado import web

from roah_rsbb.ground.kept_file import Save, SavedBeside
from roah_rsbb.model.actions import ENTRIES, OBJECT
from roah_rsbb.web.commands import SHEET, carried_out
from roah_rsbb.web.own_pages import FromOwnPage, OfOrganiser
from roah_rsbb.web.pairing import CODE_LENGTH, SIGNS, DeviceSession, Grant, TooManyGuesses, signs_of
from roah_rsbb.web.serving import TOO_MANY_REQUESTS
from roah_rsbb.wording import device
from roah_rsbb.wording.language import tr

FILE = "web_team_codes.json"
_SECRET_BYTES = 32
MAX_TEAM = 100  # characters of a name


class TeamCodes:
    """The code of each team, and the tokens for browsers that had it."""

    def __init__(self, save: Save, saved: Dict[str, Any]) -> None:
        """`save` keeps the secret and raises OSError; `saved`: what it kept before; raises ValueError and others if it
        is damaged."""
        self._kept = SavedBeside(save)
        self._secret = bytes.fromhex(saved["secret"]) if saved else secrets.token_bytes(_SECRET_BYTES)
        if len(self._secret) != _SECRET_BYTES:
            raise ValueError("the secret has the wrong length")
        self._is_saved = bool(saved)

    def code(self, team: str) -> str:
        """Return a team's code. Call `keep` before it is shown."""
        number = int.from_bytes(self._derived("code", team), "big")
        signs = ""
        for _ in range(CODE_LENGTH):
            number, sign = divmod(number, len(SIGNS))
            signs += SIGNS[sign]
        return f"{signs[:4]}-{signs[4:]}"

    def is_code(self, team: str, typed: str) -> bool:
        """Whether this is the team's code. Limit the guesses."""
        return hmac.compare_digest(signs_of(typed).encode(), signs_of(self.code(team)).encode())

    def token(self, team: str) -> str:
        """Return what a browser keeps that had the code."""
        return self._derived("token", team).hex()

    def is_token(self, team: str, token: str) -> bool:
        """Whether a browser had the team's code."""
        return hmac.compare_digest(token.encode("utf-8", "replace"), self.token(team).encode())

    async def keep(self, renews: bool = False) -> None:
        """Keep the codes for the time after a restart; with `renews`, give all teams new ones. Raises OSError: then
        nothing changes."""
        secret = secrets.token_bytes(_SECRET_BYTES) if renews else self._secret
        if renews or not self._is_saved:
            self._kept.keep({"secret": secret.hex()})
            await self._kept.wait()
            self._secret, self._is_saved = secret, True

    def _derived(self, purpose: str, team: str) -> bytes:
        return hmac.new(self._secret, f"{purpose}:{team}".encode("utf-8", "replace"), hashlib.sha256).digest()


ALL, CODE = TEAM_PAGES = ("all", "code")
COOKIE = "roah_rsbb_team"
CAPTAIN = "captain"
# What the captain gives and sees: no names and notes of referees.
_OF_CAPTAIN = tuple(field.name for field in ENTRIES[CAPTAIN].fields)
_OF_SHEET = ("facts", "items", "points", "steps", "module", "captain")


class _OfTeam(FromOwnPage):
    def has_code(self, team: str) -> bool:
        """Whether the browser had the team's code."""
        return bool(self._server.team_codes.is_token(team, self.get_cookie(self.cookie(COOKIE), "")))

    async def carried_out(
        self, captain: DeviceSession, command: str, body: Dict[str, Any]
    ) -> Tuple[int, Dict[str, Any]]:
        """Carry out a command of a team, which may do it."""
        return await carried_out(self._server, captain, command, body, self.language(), lambda _command: True)


class TeamHandler(_OfTeam):
    """A team's own robot."""

    def get(self, name: str) -> None:
        """Return what the box knows, if the reader may see it; null: it is not known yet."""
        team = _team(name)
        if not self._may_see(team):
            self.finish({"is_allowed": False, "facts": None})
            return
        desk, language = self._server.desk, self.language()
        self.finish({"is_allowed": True, "facts": desk.team_facts(team, language) if desk.is_heard else None, **({
            "runs": desk.team_runs(team, language), "protests": desk.protests(team, language)}
            if self.has_code(team) else {})})

    def post(self, name: str) -> None:
        """Take the code of the team, and answer with a cookie."""
        team, server, address = _team(name), self._server, self.request.remote_ip or ""
        with server.store.speaking(self.language()):
            try:
                server.team_guesses.check(server.now(), address)
                if not server.team_codes.is_code(team, self.text("code")):
                    self.refuse(403, tr(device.WRONG_TEAM_CODE))
                    return
                server.team_guesses.was_right(address)
            except TooManyGuesses as refused:
                self.refuse(TOO_MANY_REQUESTS, str(refused))
                return
        self.give_cookie(COOKIE, server.team_codes.token(team))
        self.finish({})

    def _may_see(self, team: str) -> bool:
        """Everybody, if the organisers want that; else who has the team's code, and paired devices."""
        return self._server.team_pages == ALL or self.session() is not None or self.has_code(team)


class ProtestHandler(_OfTeam):
    """A team objects to the result of one of its runs."""

    async def post(self, name: str) -> None:
        """Enter it."""
        team, server, identity = _team(name), self._server, self.text("identity")
        runs = server.desk.protests(team, self.language())["runs"]
        run = next((run for run in runs if run["identity"] == identity), None)
        if run is None or not self.has_code(team):
            with server.store.speaking(self.language()):
                self.refuse(403, tr(device.NO_PROTEST))
            return
        session = DeviceSession(team, Grant(CAPTAIN, run["zone"]), team, "page of", server.utc())
        status, answer = await self.carried_out(session, OBJECT, {
            "zone": run["zone"], "identity": identity, "by": team, "text": self.text("text"),
            "second": self.body.get("second", 0)})
        self.set_status(status)
        self.finish(answer)


class TeamSheetHandler(_OfTeam):
    """The score sheets of a team's runs, for its captain, who signs them or refuses."""

    async def post(self, name: str) -> None:
        """Return the sheet of a run as its captain sees it, after the captain's signature if the body has one: the
        fields of the action `captain`. Whoever reads it has the team's code, whatever `team_pages` says."""
        team, server = _team(name), self._server
        if not self.has_code(team):
            raise web.HTTPError(403)
        zone, identity = server.desk.run_of_team(team, self.text("identity")), self.text("identity")
        if zone is None:
            raise web.HTTPError(404)
        captain = DeviceSession(team, Grant(CAPTAIN, zone), self.text("name") or team, "page of", server.utc())
        status, answer = 200, {}
        if "name" in self.body:
            body = {key: value for key, value in self.body.items() if key in _OF_CAPTAIN}
            status, answer = await self.carried_out(captain, CAPTAIN, {**body, "zone": zone, "identity": identity})
        if status == 200:
            status, answer = await self.carried_out(captain, SHEET, {"zone": zone, "identity": identity})
            answer = {key: value for key, value in answer.items() if key in _OF_SHEET} if status == 200 else answer
        self.set_status(status)
        self.finish(answer)


class CodesHandler(OfOrganiser):
    """The codes of all teams."""

    async def get(self) -> None:
        """Return them."""
        await self._answer(renews=False)

    async def post(self) -> None:
        """Give all teams new codes, and return them."""
        await self._answer(renews=True)

    async def _answer(self, renews: bool) -> None:
        server = self._server
        try:
            await server.team_codes.keep(renews)
        except OSError as error:
            with server.store.speaking(self.language()):
                self.refuse(500, tr(device.CODES_NOT_SAVED, error=error))
            return
        self.finish({"team_pages": server.team_pages, "codes": [
            {"team": team, "code": server.team_codes.code(team)} for team in server.store.teams()]})


def _team(name: str) -> str:
    """The name of a team in an address."""
    if len(name) > MAX_TEAM:
        raise web.HTTPError(404)
    return name
