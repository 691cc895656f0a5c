"""The tablet's web server on real sockets: its pages, and its protection from bad clients."""

import json
import pathlib
import socket
import time
from types import SimpleNamespace

import pytest
from tornado import httpclient, websocket

from helpers.http_clients import BROKEN_REQUESTS, HOST, HttpClients
from roah_rsbb.tablet import radio as state_module
from roah_rsbb.tablet import server as server_module
from roah_rsbb.tablet.maps import Map
from roah_rsbb.tablet.radio import NEVER, BoxPart, ShownTablet
from roah_rsbb.tablet.server import MAX_MESSAGES_A_SECOND, MAX_PAGES, Pages, TabletServer
from roah_rsbb.web import limits
from roah_rsbb.web.limits import Rates

FOLDER = str(pathlib.Path(__file__).resolve().parents[3] / "resource" / "tablet")
NAMES = frozenset({"localhost", "box.local"})
PLAN = Map(b"\x89PNG image", 200, 100, 0.05, (0.0, 0.0, 0.0), False)


class Served(HttpClients):
    """A server, its tablet, and clients of it."""

    def __init__(self, running, plan=PLAN):
        self.running = running
        self.state = ShownTablet()
        self.touches = []
        self.presence = []
        self.hears_box()
        self.server = TabletServer(
            running.loop, Pages(self.state, plan), plan, FOLDER, NAMES,
            lambda: self.touches.append(self.state.call_time), self.presence.append,
        )
        self.port = self.server.open(HOST, 0)

    def hears_box(self):
        self.state.on_box(self.running.loop.time(), BoxPart(False, NEVER, NEVER))

    def page(self, origin=None):
        request = httpclient.HTTPRequest(
            f"ws://{HOST}:{self.port}/pages", headers={"Origin": origin or f"http://{HOST}:{self.port}"})
        return self.running.do(websocket.websocket_connect(request))

    def read(self, page):
        text = self.running.do(page.read_message())
        return text if text is None else json.loads(text)


@pytest.fixture
def served_each_second(running):
    """As in a competition: pages get a message each second, too."""
    made = Served(running)
    yield made
    made.server.close()
    running.turn()


@pytest.fixture
def served(monkeypatch, request):
    """Pages get messages only at their beginning and after changes."""
    monkeypatch.setattr(server_module, "_PUBLISH_PERIOD_S", 1e6)
    monkeypatch.setattr(state_module, "BOX_SILENT_S", 1e6)
    return request.getfixturevalue("served_each_second")


@pytest.mark.parametrize(("path", "kind"), [
    ("/", "text/html"), ("/tablet.js", "javascript"), ("/tablet.css", "text/css"), ("/icon.svg", "image/svg+xml"),
    ("/map.png", "image/png"), ("/map.png?abcd", "image/png"),
])
def test_serves_the_page_and_the_map_and_lets_nothing_else_in(served, path, kind):
    answer = served.get(path)
    assert answer.code == 200
    assert kind in answer.headers["Content-Type"]
    policy = answer.headers["Content-Security-Policy"]
    assert "script-src 'self'" in policy and "frame-ancestors 'none'" in policy and "unsafe" not in policy
    assert answer.headers["Cache-Control"] == "no-cache"


def test_the_page_needs_nothing_from_elsewhere():
    for path in pathlib.Path(FOLDER).iterdir():
        text = path.read_text(encoding="utf-8").replace("http://www.w3.org/2000/svg", "")
        assert "http:" not in text and "https://" not in text and "//cdn" not in text, path


@pytest.mark.parametrize("path", [
    "/none", "/../tablet.css", "/..%2f..%2fpackage.xml", "/%2e%2e/%2e%2e/package.xml", "//etc/passwd", "/%00",
    "/index.html/x",
])
def test_a_missing_file_is_not_served(served, path):
    answer = served.raw(f"GET {path} HTTP/1.1\r\nHost: {HOST}\r\nConnection: close\r\n\r\n".encode())
    assert answer.split(b" ")[1] in (b"404", b"403", b"400", b"301"), answer
    assert b"<package" not in answer and b"root:" not in answer


@pytest.mark.parametrize("method", ["POST", "PUT", "DELETE", "PATCH"])
def test_nothing_can_be_put_there(served, method):
    body = None if method == "DELETE" else "x"
    assert served.get("/", method=method, body=body).code == 405


@pytest.mark.parametrize("data", BROKEN_REQUESTS)
def test_broken_requests_are_cut_off_and_the_next_one_is_served(served, data):
    assert b"200 OK" not in served.raw(data)
    assert served.get("/").code == 200


def test_a_call_is_forwarded_and_shown_on_every_page_at_once(served):
    pages = [served.page(), served.page()]
    for page in pages:
        assert served.read(page)["call"]["time"] == 0
    pages[0].write_message('{"do": "call"}')
    for page in pages:
        assert served.read(page)["call"]["time"] > 0
    assert served.touches == [served.state.call_time] != [NEVER]


def test_a_refusal_is_sent_only_to_the_page_that_asked(served):
    asking, other = served.page(), served.page()
    served.read(asking), served.read(other)
    asking.write_message('{"do": "place", "u": 7, "v": 0}')
    assert served.read(asking) == {"refused": "This position is not on the map"}
    asking.write_message('{"do": "call"}')
    assert "call" in served.read(other)
    assert len(served.touches) == 1


@pytest.mark.parametrize("message", ["", "{", "[" * 1000, b"\xff\xfe", '{"do": 1}'])
def test_nonsense_from_a_page_is_answered_and_the_page_lives(served, message):
    page = served.page()
    served.read(page)
    page.write_message(message, binary=isinstance(message, bytes))
    assert "refused" in served.read(page)
    page.write_message('{"do": "call"}')
    assert served.read(page)["call"]["time"] > 0


def test_a_message_that_is_too_large_ends_that_page_alone(served):
    bad, good = served.page(), served.page()
    served.read(bad), served.read(good)
    bad.write_message("x" * 5000)
    assert served.read(bad) is None
    good.write_message('{"do": "call"}')
    assert served.read(good)["call"]["time"] > 0


def test_more_messages_than_fingers_send_are_dropped(served, monkeypatch):
    page = served.page()
    # One second, however busy the machine is.
    monkeypatch.setattr(server_module, "time", SimpleNamespace(monotonic=lambda: 100.0, time_ns=time.time_ns))
    for _ in range(10 * MAX_MESSAGES_A_SECOND):
        page.write_message('{"do": "place", "u": 0.5, "v": 0.5}')
    served.running.until(lambda: len(served.touches) >= MAX_MESSAGES_A_SECOND)
    served.read(page)
    served.running.turn()
    assert len(served.touches) == MAX_MESSAGES_A_SECOND


def test_pages_of_other_sites_may_not_call(served):
    with pytest.raises(httpclient.HTTPError) as raised:
        served.page(origin="http://evil.example")
    assert raised.value.code == 403
    assert served.touches == []


def test_a_name_of_another_site_that_points_here_may_not_call(served):
    evil = {"Host": "evil.example", "Origin": "http://evil.example"}
    with pytest.raises(httpclient.HTTPError) as raised:
        served.running.do(websocket.websocket_connect(
            httpclient.HTTPRequest(f"ws://{HOST}:{served.port}/pages", headers=evil)))
    assert raised.value.code == 421
    assert served.get("/", headers={"Host": "evil.example"}).code == 421
    assert served.get("/", headers={"Host": f"box.local:{served.port}"}).code == 200


def test_too_many_requests_are_refused(served):
    served.server.rates = Rates(a_second=1e-9, at_once=2.0)
    assert [served.get("/").code for _ in range(3)] == [200, 200, 429]


@pytest.mark.long
def test_there_is_room_for_so_many_pages(served):
    pages = [served.page() for _ in range(MAX_PAGES)]
    assert all(served.read(page) for page in pages)
    assert served.read(served.page()) is None
    pages[0].close()
    served.running.until(lambda: len(served.server._sockets) < MAX_PAGES)
    assert served.read(served.page())


def test_a_tablet_is_there_while_a_page_is_open(served_each_second, monkeypatch):
    served = served_each_second
    assert served.presence == [False]
    monkeypatch.setattr(server_module, "PAGE_SILENT_S", 0.5)
    page = served.page()
    assert True in served.presence
    page.close()
    served.running.until(lambda: served.presence[-1] is False)


def test_a_page_that_fell_silent_is_left_behind(served_each_second, monkeypatch):
    served = served_each_second
    monkeypatch.setattr(server_module, "PAGE_SILENT_S", 0.5)
    page = served.page()
    # The messages until then: one at once, and one a second.
    assert any(served.read(page) is None for _ in range(5))
    served.running.until(lambda: served.presence[-1] is False)


def test_without_a_map_no_image_is_served(running):
    served = Served(running, plan=None)
    assert served.get("/map.png").code == 404
    served.server.close()


def test_a_port_in_use_is_said_with_its_remedy(served):
    state = ShownTablet()
    second = TabletServer(
        served.running.loop, Pages(state, None), None, FOLDER, NAMES, lambda: None, lambda there: None)
    with pytest.raises(OSError, match="choose another tablet_port") as raised:
        second.open(HOST, served.port)
    assert str(served.port) in str(raised.value)
    served.server.close()
    served.running.turn()
    assert second.open(HOST, served.port) == served.port, "it may be tried again"
    second.close()


def test_an_address_of_another_machine_is_said(served):
    second = TabletServer(
        served.running.loop, Pages(ShownTablet(), None), None, FOLDER, NAMES, lambda: None, lambda there: None)
    with pytest.raises(OSError, match="tablet_host"):
        second.open("192.0.2.1", 0)


def test_clients_that_never_finish_do_not_delay_others(served):
    idle = [socket.create_connection((HOST, served.port)) for _ in range(20)]
    for number, connection in enumerate(idle):
        connection.sendall([b"", b"GET / HT", b"POST / HTTP/1.1\r\nContent-Length: 9\r\n\r\n"][number % 3])
    assert served.get("/").code == 200
    for connection in idle:
        connection.close()


def _ended(sock, received):
    """Whether the other side closes the connection. Received data goes to `received`."""
    try:
        received.append(sock.recv(4096))
    except BlockingIOError:
        return False
    return received[-1] == b"" or b"too many pages" in received[-1]


@pytest.mark.long
def test_a_page_that_is_refused_touches_nothing(served):
    pages = [served.page() for _ in range(MAX_PAGES)]
    assert all(served.read(page) for page in pages)
    call = b'{"do": "call"}'
    frame = bytes([0x81, 0x80 | len(call), 0, 0, 0, 0]) + call
    with socket.create_connection((HOST, served.port)) as refused:  # a client that does not wait for an answer
        refused.sendall(f"GET /pages HTTP/1.1\r\nHost: {HOST}:{served.port}\r\nUpgrade: websocket\r\n"
                        "Connection: Upgrade\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n"
                        "Sec-WebSocket-Version: 13\r\n\r\n".encode() + frame)
        refused.setblocking(False)
        received = []
        served.running.until(lambda: _ended(refused, received))
        assert b" 101 " in received[0]
    pages[0].write_message('{"do": "call"}')
    served.running.until(lambda: served.touches)
    served.running.turn()
    assert len(served.touches) == 1


@pytest.fixture
def few_connections(monkeypatch):
    """Before `served`: its server has fewer places."""
    monkeypatch.setattr(limits, "MAX_CONNECTIONS", 20)


@pytest.mark.long
def test_too_many_slow_connections_do_not_keep_others_out(few_connections, served):
    page = served.page()
    assert served.read(page)
    slow = [socket.create_connection((HOST, served.port)) for _ in range(60)]
    assert served.get("/").code == 200
    slow[0].settimeout(30.0)
    assert slow[0].recv(1) == b"", "the oldest was closed"
    page.write_message('{"do": "call"}')
    served.running.until(lambda: served.touches)
    for connection in slow:
        connection.close()
