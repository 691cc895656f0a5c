"""The logos of the teams: pictures in a folder of the organisers (docs/web.md, "Logos")."""

import os
from typing import Any, Callable, Dict

from roah_rsbb.web.guarded import Guarded

TYPES = {".png": "image/png", ".jpg": "image/jpeg", ".svg": "image/svg+xml"}
MAX_LOGOS = 200
MAX_BYTES = 1_000_000


def read_logos(folder: str, report: Callable[[str], None]) -> Dict[str, str]:
    """Return the paths of the logos by team. `report` is called for each file that cannot be used."""
    found: Dict[str, str] = {}
    try:
        names = sorted(os.listdir(folder)) if folder else []
    except OSError as error:
        report(f"cannot read the logos of the teams in web_logos ({error}): correct web_logos")
        return found
    for name in names:
        team, kind = os.path.splitext(name)
        path = os.path.join(folder, name)
        if kind.lower() not in TYPES or not os.path.isfile(path):
            continue
        if os.path.dirname(os.path.realpath(path)) != os.path.realpath(folder):
            report(f"the logo {path} is not shown: it is a link to a file outside of web_logos. Copy the file")
            continue
        if os.path.getsize(path) > MAX_BYTES:
            report(f"the logo {path} is not shown: it has more than 1 MB")
        elif len(found) < MAX_LOGOS:
            found[team] = os.path.realpath(path)
    return found


class LogoHandler(Guarded):
    """The logo of a team."""

    def initialize(self, server: Any) -> None:
        self._server = server

    def get(self, team: str) -> None:
        """Return the picture. Only files that were found at the start are served."""
        path = self._server.store.logos.get(team, "")
        try:
            with open(os.open(path, os.O_RDONLY | getattr(os, "O_NOFOLLOW", 0)), "rb") as file:
                content = file.read(MAX_BYTES)
        except OSError:
            self.send_error(404)
            return
        self.set_header("Content-Type", TYPES[os.path.splitext(path)[1].lower()])
        self.set_header("Cache-Control", "max-age=300")
        self.finish(content)
