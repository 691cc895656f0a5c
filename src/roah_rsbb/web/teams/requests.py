"""What the pages of teams ask: what the box knows of their robot, and whether they may see it (docs/web.md, "Pages of
teams")."""

from tornado import web

from roah_rsbb.web.guarded import TOO_MANY_REQUESTS
from roah_rsbb.web.pairing import SESSION_VALID_S, TooManyGuesses
from roah_rsbb.web.teams.codes import MAX_TEAM
from roah_rsbb.web.writing import FromOwnPage, OfOrganiser
from roah_rsbb.wording import device
from roah_rsbb.wording.language import tr

ALL, CODE = TEAM_PAGES = ("all", "code")
COOKIE, ENCRYPTED_COOKIE = "roah_rsbb_team", "__Host-roah_rsbb_team"


class TeamHandler(FromOwnPage):
    """A team's own robot."""

    def get(self, name: str) -> None:
        """Return what the box knows, if the reader may see it; null: it is not known yet."""
        team = _team(name)
        if not self._may_see(team):
            self.finish({"is_allowed": False, "facts": None})
            return
        desk = self._server.desk
        self.finish({"is_allowed": True, "facts": desk.team_facts(team, self.language()) if desk.is_heard else None})

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
        self.set_cookie(self._cookie, server.team_codes.token(team), path="/", max_age=int(SESSION_VALID_S),
                        httponly=True, samesite="Strict", secure=self.is_encrypted)
        self.finish({})

    @property
    def _cookie(self) -> str:
        return ENCRYPTED_COOKIE if self.is_encrypted else COOKIE

    def _may_see(self, team: str) -> bool:
        """Everybody, if the organisers want that; else who has the team's code, and paired devices."""
        server = self._server
        return server.team_pages == ALL or self.session() is not None or server.team_codes.is_token(
            team, self.get_cookie(self._cookie, ""))


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
