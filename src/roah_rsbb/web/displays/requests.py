"""What the organiser's page asks: the list of displays, and what each shows (docs/web.md, "Displays")."""

from typing import Any, Dict

from roah_rsbb.web.displays.listed import NOTHING_SET, SHOWS, DisplayRow, TooMany, setting_of
from roah_rsbb.web.writing import OfOrganiser
from roah_rsbb.wording import device
from roah_rsbb.wording.language import tr


class DisplaysHandler(OfOrganiser):
    """The list of displays."""

    def get(self) -> None:
        """Return the list, and what can be chosen."""
        server = self._server
        self.finish({
            "displays": [_row(row) for row in server.displays.rows()],
            "unlisted": server.displays.unlisted,
            "zones": sorted(server.desk.zones()), "languages": server.store.known_languages(), "shows": SHOWS,
            "clock": server.utc(),
        })

    async def post(self) -> None:
        """Change what is set for a display, or let all displays show their names.

        A request has only the fields that change: so two organisers do not undo what the other one sets. With
        `take_back` the page's own address counts again.
        """
        if self.body.get("show_names"):
            self._server.show_display_names()
            self.finish({})
            return
        displays, display_id = self._server.displays, self.text("id")
        with self._server.store.speaking(self.language()):
            try:
                setting = NOTHING_SET if self.body.get("take_back") else setting_of(
                    {**displays.setting(display_id)._asdict(), **self.body.get("setting", {})},
                    self._server.store.known_languages())
                self._server.set_display(display_id, setting)
            except (ValueError, TypeError) as bad:
                self.refuse(400, str(bad))
                return
            except (KeyError, TooMany) as refused:
                self.refuse(409, tr(device.NO_SUCH_DISPLAY if isinstance(refused, KeyError)
                                    else device.TOO_MANY_DISPLAYS))
                return
        try:
            await displays.kept.wait()
            self.finish({})
        except OSError as error:
            with self._server.store.speaking(self.language()):
                self.refuse(500, tr(device.SETTING_NOT_SAVED, error=error))


def _row(row: DisplayRow) -> Dict[str, Any]:
    display = row.display
    return {
        "id": row.id, "name": row.name, "windows": row.windows, "setting": row.setting._asdict(),
        "is_set": row.setting != NOTHING_SET,
        "display": None if display is None else {
            "page": display.page, "name": display.name, "address": display.address, "size": display.size,
            "since": display.since_utc, "zones": display.zones, "show": display.show, "language": display.language,
        },
    }
