"""The codes with which teams see what is not for everybody on their page (docs/web.md, "Pages of teams"). No I/O.

Codes are derived from one secret, which is kept. So they are the same after a restart, also for teams that come later.
"""

import hashlib
import hmac
import secrets
from typing import Any, Dict

from roah_rsbb.web.kept_file import Save, SavedBeside
from roah_rsbb.web.pairing import CODE_LENGTH, SIGNS, signs_of

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
