"""What every handler of the gateway does first: it refuses requests for other names, and too many of them."""

import base64
import hashlib
import re
from typing import Any, Optional

from tornado import httputil, web

from roah_rsbb.web.limits import is_own_host
from roah_rsbb.web.serving import set_headers

TOO_MANY_REQUESTS, _MISDIRECTED = 429, 421

_HEADERS = {
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Server": "roah_rsbb",
}
# Pages load and run nothing from other sites, have no scripts within the page but the one that is named, and no other
# site may show them in a frame. The WebSocket is named because older browsers do not count it as 'self'.
_POLICY = (
    "default-src 'none'; script-src {scripts}; style-src 'self'; img-src 'self'; font-src 'self'; "
    "connect-src 'self' ws://{host} wss://{host}; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)


class Guarded(web.RequestHandler):
    """A handler that only answers requests for this computer, and not too many of them."""

    _server: Any  # a WebServer

    def prepare(self) -> None:
        """Refuse what no browser in the hall would ask."""
        if not self.is_allowed():
            raise web.HTTPError(TOO_MANY_REQUESTS, reason="Too Many Requests")
        if not is_own_host(self.request.host, self._server.names):
            raise web.HTTPError(_MISDIRECTED, reason="Misdirected Request")

    def is_allowed(self) -> bool:
        """Whether this is not one request too many."""
        return self._server.rates.allows(self._server.now(), self.request.remote_ip or "")

    def set_default_headers(self) -> None:
        set_headers(self, {**_HEADERS, "Content-Security-Policy": policy(self.request)})

    def write_error(self, status_code: int, **_kwargs: Any) -> None:
        """Answer with a line that names the remedy; never with what happened inside."""
        self.set_header("Content-Type", "text/plain; charset=utf-8")
        if status_code == TOO_MANY_REQUESTS:
            self.set_header("Retry-After", "5")
        self.finish({
            _MISDIRECTED: "Open this page by the address of the box's computer, or add its name to web_names.\n",
            TOO_MANY_REQUESTS: "This address asks too often: try again in some seconds.\n",
            404: "There is no such page. The address / lists all pages.\n",
        }.get(status_code, f"{status_code} {self._reason}\n"))


class FileHandler(Guarded, web.StaticFileHandler):
    """The files of the pages."""

    def initialize(self, server: Any, path: str, default_filename: Optional[str] = None) -> None:
        self._server = server
        super().initialize(path, default_filename)

    def set_extra_headers(self, path: str) -> None:
        self.set_header("Cache-Control", "no-cache")


def policy(request: httputil.HTTPServerRequest, script: str = "") -> str:
    """Return what the answer to a request may load and run. `script`: the text of one within the page."""
    checksum = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    return _POLICY.format(scripts=f"'self' 'sha256-{checksum}'" if script else "'self'", host=_plain_host(request))


def _plain_host(request: httputil.HTTPServerRequest) -> str:
    """The host of a request for a header; anything but a host and a port is left out."""
    return request.host if re.fullmatch(r"[\w.:\[\]-]+", request.host, re.ASCII) else "invalid"
