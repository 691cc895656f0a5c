"""What the organiser's page asks about pairing: codes for devices, and the list of those that are paired (docs/web.md,
"Pairing")."""

import asyncio
from typing import Any

from roah_rsbb.document.calls import PAIR, PAIRED, REVOKE, Caller, InThread
from roah_rsbb.model.reason import Refused
from roah_rsbb.web.pairing import ORGANISER
from roah_rsbb.web.qr_code import modules_of
from roah_rsbb.web.writing import OfOrganiser
from roah_rsbb.wording.device import encryption_text, role_text
from roah_rsbb.wording.language import tr, tr_said
from roah_rsbb.wording.times import Moments


class PairingsHandler(OfOrganiser):
    """The paired devices."""

    async def get(self) -> None:
        """Return the list."""
        own, moments = self.needed_session(), Moments(False)
        await self._answer(PAIRED, lambda found: {"devices": [
            {"id": one["id"], "person": one["person"], "device": one["device"], "is_own": one["id"] == own.id,
             "role": role_text(one["role"], one["zone"]),
             "seen": tr("connected") if one["connected"] else moments.stamp(one["seen"] or one["paired"])}
            for one in found["devices"]]})

    async def post(self) -> None:
        """Make a code for a device, or end the pairing of the one that is named."""
        ended = self.text("end")
        if ended:
            await self._answer(REVOKE, lambda found: found, device=ended)
        else:
            await self._answer(PAIR, lambda found: {**found, "square": _square(found["url"]),
                                                    "encryption": encryption_text(found["url"])},
                               role=self.text("role"), zone=self.text("zone"))

    async def _answer(self, name: str, shown: Any, **arguments: str) -> None:
        try:
            found: Any = self._server.calls[name](arguments, Caller(ORGANISER, self.request.remote_ip or ""))
            if isinstance(found, InThread):
                found = await asyncio.get_event_loop().run_in_executor(None, found.make)
        except Refused as refused:
            with self._server.store.speaking(self.language()):
                self.refuse(409, *map(tr_said, refused.reasons))
        else:
            with self._server.store.speaking(self.language()):
                self.finish(shown(found))


def _square(url: str) -> Any:
    """Return the rows of the QR code, a 1 for each dark module; None: its library is not installed."""
    rows = modules_of(url)
    return rows and ["".join("01"[is_dark] for is_dark in row) for row in rows]
