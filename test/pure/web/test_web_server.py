"""The gateway's web server on real loopback sockets: pages, data, live data, and its defences."""

import json
import re
import shutil
import socket
from base64 import b64encode
from hashlib import sha256

import pytest
from tornado import httpclient

from helpers.http_clients import BROKEN_REQUESTS, HOST, closed
from helpers.public_box import PublicBox, event, result, run
from helpers.served_pages import FOLDER, NAMES, ServedPages
from roah_rsbb.web import serving
from roah_rsbb.web.limits import Places, Rates
from roah_rsbb.web.numbered import Viewer
from roah_rsbb.web.server import BEAT_S, LOOK_S, WebServer, worker


class Served(ServedPages):
    """A server whose box changes as the test says, and readers."""

    steps = 0

    def __init__(self, running):
        super().__init__(running, PublicBox())

    def change(self, size=1):
        """The core publishes another state."""
        self.steps += 1
        runs = [run(zone=f"Zone {n}", left=90.0 + 10 * self.steps, counting=False) for n in range(size)]
        self.box.publish(runs, [event()])
        self.server.follow()

    def viewer(self, query="", **headers):
        return self.opened(f"events{query}", **headers)

    def silent_viewer(self):
        """A reader that asks and then never reads."""
        reader = socket.socket()
        reader.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        reader.connect((HOST, self.port))
        reader.sendall(f"GET /api/v1/events HTTP/1.1\r\nHost: {HOST}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                       "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\nSec-WebSocket-Version: 13\r\n\r\n".encode())
        return reader


@pytest.fixture
def served(served):
    served.change()
    return served


# -- pages and data ---------------------------------------------------------------------------------


@pytest.mark.parametrize(("path", "kind"), [
    ("/", "text/html"), ("/display?zone=Home", "text/html"), ("/overlay", "text/html"),
    ("/team/Copper%20Kettle", "text/html"), ("/assets/live.js", "javascript"), ("/assets/tokens.css", "text/css"),
    ("/assets/vendor/preact-htm.js", "javascript"), ("/api/v1/state", "application/json"),
    ("/api/v1/schemas/state.json", "application/schema+json"),
])
def test_every_page_has_its_protection(served, path, kind):
    answer = served.get(path)
    assert answer.code == 200
    assert kind in answer.headers["Content-Type"]
    policy = answer.headers["Content-Security-Policy"]
    scripts = re.findall("<script>(.*?)</script>", answer.body.decode(), re.DOTALL) if kind == "text/html" else []
    checksums = "".join(f" 'sha256-{b64encode(sha256(script.encode()).digest()).decode()}'" for script in scripts)
    assert f"default-src 'none'; script-src 'self'{checksums}; style-src 'self'" in policy and "unsafe" not in policy
    assert len(scripts) == (kind == "text/html"), "the one that loads the page again"
    assert "frame-ancestors 'none'" in policy
    assert answer.headers["X-Content-Type-Options"] == "nosniff"
    assert ("Access-Control-Allow-Origin" in answer.headers) == path.startswith("/api/")


def test_the_worker_keeps_what_its_pages_need_until_a_file_is_another_one(served, tmp_path):
    script = served.get("/worker.js").body.decode()
    paths = json.loads(re.search(r"FILES = (\[.*?\]);", script).group(1))
    assert {served.get(path).code for path in paths} == {200}
    page = served.get("/referee").body.decode()
    assert {*re.findall(r'(?:src|href)="(/[^"]+)"', page)} <= {*paths}
    shutil.copytree(FOLDER, tmp_path / "web")
    folder = tmp_path / "web"
    assert worker(folder) == script
    (folder / "assets" / "live.js").write_text("// another version")
    worker.cache_clear()
    assert worker(folder) != script


def test_the_host_in_the_policy_cannot_be_chosen(served):
    policy = served.get("/", headers={"Host": "localhost:1; script-src *"}).headers["Content-Security-Policy"]
    assert "script-src *" not in policy


def test_data_is_answered_again_only_when_it_has_changed(served):
    first = served.get("/api/v1/state")
    assert json.loads(first.body)["data"]["runs"][0]["zone"] == "Zone 0"
    assert first.headers["Cache-Control"] == "max-age=1"
    tag = first.headers["Etag"]
    again = served.get("/api/v1/state", headers={"If-None-Match": tag})
    assert (again.code, again.body) == (304, b"")
    assert served.get("/api/v1/state", method="HEAD").body == b""
    served.change()
    assert served.get("/api/v1/state", headers={"If-None-Match": tag}).code == 200


def test_results_appear_when_they_are_public(served):
    assert json.loads(served.get("/api/v1/results").body)["data"]["results"] == []
    served.box.publish(results=[result()])
    served.server.follow()
    assert json.loads(served.get("/api/v1/results").body)["data"]["results"][0]["team"] == "Alpha"


def test_other_sites_may_read(served):
    answer = served.get("/api/v1/state", headers={"Origin": "https://results.example"})
    assert answer.headers["Access-Control-Allow-Origin"] == "*"
    asked = served.get("/api/v1/state", method="OPTIONS", headers={"Origin": "https://results.example"})
    assert (asked.code, asked.headers["Access-Control-Allow-Methods"]) == (204, "GET, HEAD, OPTIONS")
    assert served.read(served.viewer(Origin="https://results.example"))["type"] == "snapshot"


# -- live data --------------------------------------------------------------------------------------


def test_readers_get_a_snapshot_then_changes(served):
    viewers = [served.viewer(), served.viewer("?documents=state")]
    for viewer in viewers:
        assert served.read(viewer)["documents"]["state"]["number"] == 1
    served.change()
    for viewer in viewers:
        message = served.read(viewer, "change")
        assert {name: one["number"] for name, one in message["documents"].items()} == {"state": 2}


def test_the_clock_comes_without_being_asked(served):
    viewer = served.viewer("?documents=state,schedule")
    assert served.read(viewer, "clock")["numbers"] == {"state": 1, "schedule": 1}


def test_silence_of_the_box_is_sent(served):
    viewer = served.viewer("?documents=state")
    assert served.read(viewer, "clock")["heard"]
    served.server._beat_due_mono = 1e9  # the next regular one
    served.box.is_old = True
    assert not served.read(viewer)["heard"]


def test_texts_are_in_the_language_of_the_browser(served):
    for query, headers in (("&language=de-AT", {}), ("", {"Accept-Language": "de-AT,en;q=0.5"})):
        message = served.read(served.viewer(f"?documents=page.words{query}", **headers))
        assert message["documents"]["page.words"]["data"]["next"] == "auf Deutsch: Next"


@pytest.mark.parametrize("query", ["?documents=secret", "?documents=", "?documents=state,../x", "?documents=%ff"])
def test_unknown_documents_are_refused(served, query):
    with pytest.raises(httpclient.HTTPError) as raised:
        served.viewer(query)
    assert raised.value.code == 400


# -- defences ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("path", ["/", "/api/v1/state", "/api/v1/events", "/assets/live.js", "/none"])
def test_another_name_for_this_computer_is_refused(served, path):
    answer = served.get(path, headers={"Host": "evil.example"})
    assert answer.code == 421 and b"web_names" in answer.body
    assert served.get("/", headers={"Host": "box.local:8081"}).code == 200


@pytest.mark.parametrize("path", [
    "/none", "/assets/../display.html", "/assets/..%2f..%2f..%2fpackage.xml", "/assets/%2e%2e/index.html",
    "/assets//etc/passwd", "/assets/%00", "/assets/", "/api/v1/schemas/..%2findex.html", "/api/v2/state", "/team/",
    "/team/a/b",
])
def test_nothing_else_is_served(served, path):
    answer = served.raw(f"GET {path} HTTP/1.1\r\nHost: {HOST}\r\nConnection: close\r\n\r\n".encode())
    assert answer.split(b" ")[1] in (b"404", b"403", b"400"), answer
    assert b"<" not in answer and b"Traceback" not in answer


def test_people_get_a_page_that_leads_back(served):
    answer = served.get("/none", headers={"Accept": "text/html,*/*", "Accept-Language": "de"})
    assert answer.code == 404 and "auf Deutsch: There is no such page" in answer.body.decode()
    assert 'href="/"' in answer.body.decode() and 'lang="de"' in answer.body.decode()


@pytest.mark.parametrize("path", ["/", "/api/v1/state", "/api/v1/events", "/assets/live.js", "/team/Alpha"])
@pytest.mark.parametrize("method", ["POST", "PUT", "DELETE", "PATCH"])
def test_nothing_can_be_written(served, path, method):
    body = None if method == "DELETE" else "x"
    assert served.get(path, method=method, body=body).code == 405


@pytest.mark.parametrize("data", BROKEN_REQUESTS)
def test_broken_requests_are_cut_off_and_the_next_one_is_served(served, data):
    assert b"200 OK" not in served.raw(data)
    assert served.get("/").code == 200


def test_too_many_requests_are_refused(served):
    served.server.rates = Rates(a_second=1e-9, at_once=3.0)
    assert [served.get("/api/v1/state").code for _ in range(4)] == [200, 200, 200, 429]
    assert served.get("/").headers["Retry-After"]


@pytest.mark.parametrize("message", ["hello", "x" * 5000], ids=["short", "long"])
def test_a_reader_that_speaks_is_closed_alone(served, message):
    bad, good = served.viewer("?documents=state"), served.viewer("?documents=state")
    served.read(good)
    bad.write_message(message)
    assert served.is_closed(bad)
    served.change()
    assert served.read(good, "change")
    assert len(served.server.viewers) == 1


def test_a_message_is_made_once_for_all_its_readers(served, monkeypatch):
    readers = [served.viewer("?documents=schedule,state") for _ in range(5)]
    assert all(served.read(reader) for reader in readers)
    made, now = [], served.store._now
    monkeypatch.setattr(served.store, "_now", lambda: made.append(1) or now())
    serving.frame.cache_clear()
    served.change()
    assert (len(made), serving.frame.cache_info().misses) == (1, 1)
    assert all(viewer.busy_since is None for viewer in served.server.viewers), "all was sent at once, without tasks"
    assert all(set(served.read(reader, "change")["documents"]) == {"state"} for reader in readers)
    made.clear()  # a second may have passed
    served.server._timer.cancel()
    served.server._beat_due_mono = 0.0
    served.server._look()
    assert len(made) == 1, "neither is the clock made for each reader"


def test_without_readers_it_looks_once_a_second(served):
    server, times = served.server, served.server._loop.time

    def look():
        server._timer.cancel()
        server._look()
        return server._timer.when()
    before = times()
    assert look() >= before + BEAT_S
    served.read(served.viewer("?documents=state"))
    assert look() <= times() + LOOK_S


@pytest.mark.parametrize("length", [0, 125, 126, 65535, 65536])
def test_a_frame_of_any_length_is_read(served, monkeypatch, length):
    reader = served.viewer("?documents=state")
    served.read(reader)
    text = "ü" * (length // 2) + "x" * (length % 2)
    monkeypatch.setattr(Viewer, "next", lambda self, made, texts=[text]: texts.pop() if texts else None)
    served.server.publish()
    found = served.running.do(reader.read_message())
    while found.startswith('{"type":"clock"'):  # a second may have passed
        found = served.running.do(reader.read_message())
    assert found == text


def test_a_slow_reader_delays_nobody_and_has_no_backlog(served):
    slow, good = served.silent_viewer(), served.viewer("?documents=state")
    served.running.until(lambda: len(served.server.viewers) == 2)
    stuck = next(iter(served.server.viewers))
    buffer = stuck.ws_connection.stream._write_buffer
    while not len(buffer):
        served.change(size=200)
        served.read(good, "change")
    waiting = len(buffer)
    for _ in range(20):
        served.change(size=200)
        assert served.read(good, "change")
    assert len(buffer) <= waiting, "nothing is queued behind what it does not read"
    slow.close()


def test_a_reader_that_takes_nothing_is_ended(served, monkeypatch):
    slow = served.silent_viewer()
    served.running.until(lambda: len(served.server.viewers) == 1)
    stuck = next(iter(served.server.viewers))
    while stuck.busy_since is None:
        served.change(size=200)
        served.running.turn()
    monkeypatch.setattr(serving, "STUCK_S", -1.0)
    served.running.until(lambda: len(served.server.viewers) == 0 and stuck.ws_connection is None)
    slow.close()


def test_one_address_cannot_take_all_places(served):
    served.server.viewers = Places(lambda viewer: viewer.close(1013, "too many"), most=3)
    first, *others = [served.viewer("?documents=state") for _ in range(4)]
    assert served.read(first) is not None
    while served.read(first) is not None:  # the oldest is closed, perhaps after some clocks
        pass
    served.change()
    assert all(served.read(other, "change") for other in others)


def test_silent_connections_do_not_keep_others_out(few_connections, served):
    viewer = served.viewer("?documents=state")
    served.read(viewer)
    idle = [socket.create_connection((HOST, served.port)) for _ in range(100)]
    for number, connection in enumerate(idle):
        connection.setblocking(False)
        connection.send([b"x", b"GET / HT", b"POST / HTTP/1.1\r\nContent-Length: 9\r\n\r\n"][number % 3])
    assert served.get("/").code == 200
    served.running.until(lambda: len(closed(idle)) >= 80)
    served.change()
    assert served.read(viewer, "change"), "a reader stays"
    for connection in idle:
        connection.close()


@pytest.mark.parametrize("data", [b"", b"GET / HT", b"POST / HTTP/1.1\r\nContent-Length: 9\r\n\r\n"])
def test_a_connection_that_stays_silent_is_ended(running, monkeypatch, data):
    monkeypatch.setattr(serving, "IDLE_S", 0.05)
    served = Served(running)
    assert b"200 OK" not in served.raw(data), "it ends, or this would wait for ever"
    served.server.close()
    running.turn()


@pytest.mark.long
def test_a_thousand_silent_connections(served):
    resource = pytest.importorskip("resource")
    limits = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (min(4096, limits[1]), limits[1]))
    viewer = served.viewer("?documents=state")
    idle = []
    for _ in range(1000):
        idle.append(socket.create_connection((HOST, served.port)))
        served.running.turn_once()
    assert served.get("/display").code == 200
    served.change()
    assert served.read(viewer, "change")
    for connection in idle:
        connection.close()
    served.running.turn()
    resource.setrlimit(resource.RLIMIT_NOFILE, limits)


def test_a_port_in_use_is_reported_with_its_remedy(served):
    second = WebServer(served.running.loop, served.store, FOLDER, NAMES)
    with pytest.raises(OSError, match="choose another web_port") as raised:
        second.open(HOST, served.port)
    assert str(served.port) in str(raised.value)
    with pytest.raises(OSError, match="correct web_host"):
        second.open("192.0.2.1", 0)
    served.server.close()
    served.running.turn()
    assert second.open(HOST, served.port) == served.port, "it may be tried again"
    second.close()


def test_a_reader_that_fails_misses_a_message_and_the_others_do_not(served, monkeypatch, caplog):
    first, second = served.viewer("?documents=state"), served.viewer("?documents=state")
    for viewer in (first, second):
        served.read(viewer, "snapshot")
    real, failing = Viewer.next, next(iter(served.server.viewers))._viewer

    def fails(self, made=None):
        if self is failing:
            raise TypeError("a text that cannot be rendered")
        return real(self, made)

    monkeypatch.setattr(Viewer, "next", fails)
    for _ in range(3):
        served.change()
    assert served.read(second, "change")["documents"]["state"]["data"]["runs"]
    assert served.read(second, "clock"), "the clock comes, too"
    assert len([one for one in caplog.records if "misses a message" in one.message]) == 1
    monkeypatch.setattr(Viewer, "next", real)
    served.change()
    assert served.read(first, "change")["documents"]["state"]["number"] == served.store.document(("state", "")).number
