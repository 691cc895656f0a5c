"""The page that plays a run again, for those who decide about it (docs/web.md, "The whole box")."""

import asyncio
import os
import subprocess
import tempfile
from typing import List

from tornado import web

from roah_rsbb.ground.arguments import without_ros
from roah_rsbb.ground.linux import with_low_priority
from roah_rsbb.model.actions import REFEREES
from roah_rsbb.web.own_pages import FromOwnPage
from roah_rsbb.web.serving import TOO_MANY_REQUESTS

# A run of an hour takes some seconds.
_LIMIT_S = 60.0


class ReplayHandler(FromOwnPage):
    """A run that is over, as `results replay` shows it. Another process makes it of the journal, one at a time."""

    async def get(self, identity: str) -> None:
        """Return the page."""
        server, document = self._server, self._server.desk.box.document
        grant = self.needed_session().grant
        run = None if document is None else document.results.get(identity)
        if run is None or not server.log_dir or grant.role not in REFEREES or not grant.allows(run.zone):
            raise web.HTTPError(404)
        if server.is_replaying:
            raise web.HTTPError(TOO_MANY_REQUESTS, reason="Too Many Requests")
        server.is_replaying = True
        try:
            page = await asyncio.get_running_loop().run_in_executor(None, _made, server.log_dir, identity)
        except (OSError, subprocess.SubprocessError):
            raise web.HTTPError(500, reason="The journal of this run cannot be read") from None
        finally:
            server.is_replaying = False
        # The page has rules of its own: it runs nothing but its program.
        self.clear_header("Content-Security-Policy")
        self.set_header("Content-Type", "text/html; charset=utf-8")
        self.finish(page)


def _made(log_dir: str, identity: str) -> bytes:
    """Return the page of a run. Raises OSError, SubprocessError."""
    with tempfile.TemporaryDirectory() as folder:
        command: List[str] = without_ros("results", "--log-dir", log_dir, "replay", identity, "--html", folder)
        subprocess.run(with_low_priority(command), check=True, timeout=_LIMIT_S, stdin=subprocess.DEVNULL,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        (name,) = os.listdir(folder)
        with open(os.path.join(folder, name), "rb") as file:
            return file.read()
