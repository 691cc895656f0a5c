"""The web server of a box on a real loopback socket, and what our own pages send to it."""

import json
import pathlib

from tornado import httpclient, websocket

from helpers.http_clients import HOST, HttpClients
from helpers.public_box import PublicBox, event, run
from roah_rsbb.web.own_pages import COOKIE
from roah_rsbb.web.pairing import Grant, Sessions
from roah_rsbb.web.public_documents import Store
from roah_rsbb.web.server import WebServer

FOLDER = str(pathlib.Path(__file__).resolve().parents[3] / "resource" / "web")
GERMAN = {"de": lambda text, n: f"auf Deutsch: {text}"}
NAMES = frozenset({"localhost", "box.local"})


class ServedPages(HttpClients):
    """A server, and devices that are paired with it."""

    def __init__(self, running, box=None, **parts):
        """`box`: the one that is shown; None: a public one with a run. `parts`: further ones of a `WebServer`."""
        self.running, self.saved = running, []
        self.box = PublicBox([run()], [event()]) if box is None else box
        self.store, self.sessions = Store(self.box, GERMAN), Sessions(self.save)
        self.server = WebServer(running.loop, self.store, FOLDER, NAMES, self.sessions, **parts)
        self.port = self.server.open(HOST, 0)
        self.origin = f"http://{HOST}:{self.port}"

    def save(self, content):
        self.saved.append(content)

    def token(self, role="referee", zone=None, person=""):
        """That of a device which is paired; a referee or judge in Home, unless a zone is given."""
        zone = ("" if role == "organiser" else "Home") if zone is None else zone
        person = person or f"Anna {len(self.sessions.listed(0.0))}"
        return self.sessions.add(self.server.utc(), Grant(role, zone), person, "iPhone")

    def ask(self, path, body=None, method="", token="", **headers):
        """What one of our pages asks. `headers`: others than usual; None: without this one."""
        headers = {"Origin": self.origin, "Content-Type": "application/json", "Cookie": f"{COOKIE}={token}", **headers}
        method = method or ("GET" if body is None else "POST")
        data = body if isinstance(body, (bytes, str)) else json.dumps(body)
        return self.get(f"/api/v1/{path}", method=method, body=data if method == "POST" else None,
                        headers={name: value for name, value in headers.items() if value is not None})

    def opened(self, path, token="", **headers):
        """A WebSocket that one of our pages opens."""
        headers = {"Origin": self.origin, "Cookie": f"{COOKIE}={token}", **headers}
        request = httpclient.HTTPRequest(f"ws://{HOST}:{self.port}/api/v1/{path}", headers=headers)
        return self.running.do(websocket.websocket_connect(request))

    def read(self, connection, kind=None):
        """The next message; with `kind`: the next of this kind; None: the connection was closed."""
        while True:
            text = self.running.do(connection.read_message())
            message = text if text is None else json.loads(text)
            if kind is None or message is None or message["type"] == kind:
                return message

    def is_closed(self, connection):
        """Read until the server closes it."""
        while self.read(connection) is not None:
            pass
        return True
