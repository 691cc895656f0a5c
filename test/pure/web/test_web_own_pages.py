"""What devices may send: only from our own pages, only small, and only after pairing. On real loopback sockets."""

import json
import socket

import pytest

from helpers.http_clients import HOST, closed
from helpers.served_pages import ServedPages
from roah_rsbb.ground.kept_file import SavedBeside
from roah_rsbb.web import serving
from roah_rsbb.web.own_pages import COOKIE, is_own_origin
from roah_rsbb.web.pairing import GUESSES_AT_ONCE, Grant


class Served(ServedPages):
    """A server, and a device that sends requests to it."""

    def code(self, role="referee"):
        return self.server.codes.make(self.server.now(), Grant(role, "Home")).typed

    def pair(self, person="Anna", **how):
        return self.ask("pair", {"code": self.code(), "person": person, "device": "iPhone"}, **how)

    def paired(self, person="Anna"):
        return self.pair(person).headers["Set-Cookie"].partition("=")[2].partition(";")[0]

    def asking(self, token):
        """A function that asks on a connection of the device, and returns whether there was an answer."""
        ask = (f"GET /api/v1/session HTTP/1.1\r\nHost: {HOST}\r\nCookie: {COOKIE}={token}\r\n\r\n").encode()

        def asked(sock):
            sock.sendall(ask)
            sock.setblocking(False)
            received = []

            def is_answered():
                try:
                    received.append(sock.recv(65536))
                except BlockingIOError:
                    return False
                return True

            self.running.until(is_answered)
            return b" 200 OK" in received[0]
        return asked


def session(served, token):
    return served.ask("session", token=token)


def test_a_code_gives_a_cookie_that_no_script_reads(served):
    answer = served.pair()
    assert answer.code == 200
    assert json.loads(answer.body)["role"] == "referee"
    cookie = answer.headers["Set-Cookie"]
    assert "HttpOnly" in cookie and "SameSite=Strict" in cookie and "Max-Age=" in cookie and "Domain" not in cookie
    assert answer.headers["Cache-Control"] == "no-store"
    assert "Access-Control-Allow-Origin" not in answer.headers


def test_the_cookie_is_the_session(served):
    token = served.paired()
    found = json.loads(session(served, token).body)
    assert (found["person"], found["device"], found["zone"]) == ("Anna", "iPhone", "Home")
    assert session(served, "").code == session(served, token[:-1]).code == 401


def test_a_pairing_that_is_ended_counts_no_more(served):
    first, second = served.paired(), served.paired("Bert")
    served.server.revoke(json.loads(session(served, first).body)["id"])
    assert (session(served, first).code, session(served, second).code) == (401, 200)
    assert served.ask("session", method="DELETE", token=second).code == 204
    assert session(served, second).code == 401


def test_a_device_that_is_paired_again_has_one_session(served):
    token = served.paired()
    served.pair(token=token)
    assert len(served.sessions.listed(served.server.utc())) == 1
    assert session(served, token).code == 401


def test_a_wrong_code_is_refused_in_the_reader_s_language(served):
    answer = served.ask("pair", {"code": "AAAA-AAAA", "person": "Anna", "language": "de"})
    assert answer.code == 403
    assert json.loads(answer.body)["reasons"][0].startswith("auf Deutsch: This code is wrong")


def test_without_a_name_the_code_is_not_used_up(served):
    code = served.code()
    assert served.ask("pair", {"code": code, "person": " "}).code == 403
    assert served.ask("pair", {"code": code, "person": "Anna"}).code == 200


def test_a_pairing_that_cannot_be_saved_is_refused_and_its_code_can_be_used_again(served):
    def fails(_records):
        raise OSError("disk full")
    code, kept = {"code": served.code(), "person": "Anna", "language": "de"}, served.sessions.kept
    served.sessions.kept = SavedBeside(fails)
    answer = served.ask("pair", code)
    assert answer.code == 403 and json.loads(answer.body)["reasons"][0].startswith("auf Deutsch: The pairing cannot be")
    assert not served.sessions.listed(served.server.utc())
    served.sessions.kept = kept
    assert served.ask("pair", code).code == 200


def test_a_pairing_whose_end_cannot_be_saved_is_ended_and_says_the_remedy(served):
    def fails(_records):
        raise OSError("disk full")
    token = served.paired()
    served.sessions.kept = SavedBeside(fails)
    answer = served.ask("session?language=de", method="DELETE", token=token)
    assert answer.code == 500 and session(served, token).code == 401
    assert json.loads(answer.body)["reasons"][0].startswith("auf Deutsch: Ended, but not saved (disk full): it would")


@pytest.mark.parametrize("given, status", [("typed", 429), ("link", 200)])
def test_guesses_keep_out_a_typed_code_and_no_link(served, given, status):
    code = served.server.codes.make(served.server.now(), Grant("referee", "Home"))._asdict()[given]
    codes = [served.ask("pair", {"code": "x", "person": "Eve"}).code for _ in range(int(GUESSES_AT_ONCE))]
    assert set(codes) == {403}
    assert served.ask("pair", {"code": code, "person": "Eve"}).code == status


def test_a_paired_phone_stays_connected_and_connects_beside_many_hostile_addresses(few_connections, served):
    asked, hostile = served.asking(served.paired()), []
    phone = socket.create_connection((HOST, served.port))
    assert asked(phone)
    for n in range(20):
        hostile += [socket.create_connection((HOST, served.port), source_address=(address, 0))
                    for address in ("127.0.9.9", f"127.0.9.{10 + n}")]
        served.running.turn_once()
    served.running.turn()
    served.running.until(lambda: len(closed(hostile)) >= 20)
    assert asked(phone), "its connection stayed open"
    again = socket.create_connection((HOST, served.port))
    for n in range(20):
        hostile.append(socket.create_connection((HOST, served.port), source_address=(f"127.0.8.{10 + n}", 0)))
        served.running.turn_once()
    served.running.turn()
    assert asked(again), "its new connection stayed open, too"
    for sock in (phone, again, *hostile):
        sock.close()


def test_a_paired_phone_that_needs_a_new_connection_is_served_before_those_who_wait(served, monkeypatch):
    token = served.paired()
    session(served, token)
    order, handle = [], serving.BoundedServer.handle_stream

    def handled(server, stream, address):
        order.append(address[0])
        return handle(server, stream, address)

    monkeypatch.setattr(serving.BoundedServer, "handle_stream", handled)
    # Nothing is accepted meanwhile, as on a busy computer.
    sockets = [socket.create_connection((HOST, served.port), 30.0, (f"127.0.9.{1 + n % 50}", 0)) for n in range(300)]
    sockets.append(socket.create_connection((HOST, served.port), 30.0))
    served.running.until(lambda: HOST in order)
    assert order.index(HOST) <= 2 * serving.SERVED_AT_ONCE * (1 + 300 // 128), "the loop accepts 128 at once"
    for sock in sockets:
        sock.close()
    served.running.turn()


def test_the_connection_of_a_paired_phone_stays_open_when_it_is_idle(running, monkeypatch):
    monkeypatch.setattr(serving, "IDLE_S", 0.3)
    served = Served(running)
    asked, phone = served.asking(served.paired()), socket.create_connection((HOST, served.port))
    assert asked(phone)
    assert served.raw(b"") == b"", "one that came later is closed"
    assert asked(phone)
    phone.close()
    served.server.close()
    running.turn()


@pytest.mark.parametrize("headers", [
    {"Origin": None}, {"Origin": "null"}, {"Origin": "https://evil.example"}, {"Origin": "http://127.0.0.1"},
    {"Origin": "http://127.0.0.1:1"}, {"Sec-Fetch-Site": "cross-site"}, {"Sec-Fetch-Site": "same-site"},
])
def test_pages_of_other_sites_are_refused(served, headers):
    token = served.paired()
    assert served.pair(**headers).code == 403
    assert served.ask("session", method="DELETE", token=token, **headers).code == 403
    assert session(served, token).code == 200


def test_the_origin_must_be_the_host_that_is_asked(served):
    """A name of another site that points to this computer passes neither test."""
    assert served.pair(Host="evil.example", Origin="http://evil.example").code == 421
    assert served.pair(Host=f"localhost:{served.port}").code == 403
    assert served.pair(Host=f"localhost:{served.port}", Origin=f"http://localhost:{served.port}").code == 200


@pytest.mark.parametrize("origin, fits", [
    ("http://box:8081", True), ("http://BOX:8081", True), ("https://box:8081", False), ("http://box", False),
    ("http://box:8081.evil.example", False), ("http://evil@box:8081", False), ("", False), ("null", False),
    ("http://[", False), ("box:8081", False),
])
def test_own_origins(origin, fits):
    assert is_own_origin(origin, "http", "box:8081") == fits


@pytest.mark.parametrize("kind", ["text/plain", "application/x-www-form-urlencoded", ""])
def test_forms_are_refused(served, kind):
    assert served.pair(**{"Content-Type": kind}).code == 415


@pytest.mark.parametrize("body", [
    "", "{", "[]", "1", "null", '"x"', pytest.param("[" * 900, id="deep"), b"\xff\xfe", '{"code": 1}',
    '{"code": {"a": 1}, "person": "x"}', '{"person": ["x"]}',
])
def test_bodies_that_are_wrong_are_refused(served, body):
    answer = served.ask("pair", body)
    assert answer.code in (400, 403) and b"Traceback" not in answer.body


def test_bodies_are_small(served):
    data = json.dumps({"code": "x" * 5000})
    answer = served.raw((
        f"POST /api/v1/pair HTTP/1.1\r\nHost: {HOST}:{served.port}\r\nOrigin: {served.origin}\r\n"
        f"Content-Type: application/json\r\nContent-Length: {len(data)}\r\n\r\n{data}").encode())
    assert b"200 OK" not in answer and b"403" not in answer
    assert served.pair().code == 200


@pytest.mark.parametrize("path", ["pair", "session"])
def test_other_sites_may_not_ask_whether_they_may_write(served, path):
    answer = served.ask(path, method="OPTIONS", Origin="https://evil.example")
    assert answer.code in (403, 405)
    assert "Access-Control-Allow-Origin" not in answer.headers


def test_the_pairing_page_is_served(served):
    assert served.get("/pair").code == 200
