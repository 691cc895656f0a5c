"""Encrypted pages: what is sent over TLS, what happens to requests without it, and certificates that cannot be used."""

import datetime
import json
import os
import pathlib
import socket
import ssl

import pytest
from cryptography.hazmat.backends import default_backend
from cryptography.hazmat.primitives import serialization
from tornado import httpclient, websocket

from helpers.http_clients import HOST, HttpClients, closed
from helpers.public_box import PublicBox, event, run
from roah_rsbb.ground import durable
from roah_rsbb.rulebook.errors import Place, Report
from roah_rsbb.tools.competition import certificate as maker
from roah_rsbb.web.certificate import Certificate, CertificateError, CertificateFiles
from roah_rsbb.web.own_pages import COOKIE, ENCRYPTED
from roah_rsbb.web.pairing import Grant, Sessions
from roah_rsbb.web.public_documents import Store
from roah_rsbb.web.server import WebServer

FOLDER = str(pathlib.Path(__file__).resolve().parents[3] / "resource" / "web")
TODAY = datetime.datetime.utcnow().replace(microsecond=0)
MADE = maker.make([HOST, "box.local"], TODAY)
OTHER = maker.make([HOST], TODAY)


@pytest.fixture
def files(tmp_path):
    maker.write(str(tmp_path), MADE)
    return CertificateFiles(str(tmp_path / maker.CERTIFICATE), str(tmp_path / maker.KEY))


class Served(HttpClients):
    """An encrypted server, and clients of it that trust what `new_competition` says."""

    def __init__(self, running, files):
        self.running = running
        self.store = Store(PublicBox([run()], [event()]), {})
        self.sessions = Sessions(lambda records: None)
        self.certificate = Certificate(files)
        self.certificate.renew()
        self.server = WebServer(running.loop, self.store, FOLDER, frozenset({"localhost"}), self.sessions,
                                context=self.certificate.context)
        self.port = self.server.open(HOST, 0)
        self.trusted = ssl.create_default_context(cadata=MADE.authority.decode())

    def ask(self, path, scheme="https", **options):
        client = httpclient.AsyncHTTPClient(force_instance=True)
        options.setdefault("ssl_options", self.trusted)
        return self.running.do(client.fetch(
            f"{scheme}://{HOST}:{self.port}{path}", follow_redirects=False, **{"raise_error": False, **options}))

    def post(self, path, body, scheme="https", **headers):
        headers = {"Origin": f"{scheme}://{HOST}:{self.port}", "Content-Type": "application/json", **headers}
        return self.ask(path, scheme, method="POST", body=json.dumps(body), headers=headers)

    def socket(self, path, **headers):
        return self.running.do(websocket.websocket_connect(httpclient.HTTPRequest(
            f"wss://{HOST}:{self.port}{path}", ssl_options=self.trusted, headers=headers)))


@pytest.fixture
def served(running, files):
    made = Served(running, files)
    yield made
    made.server.close()
    running.turn()


def test_pages_and_live_data_are_sent_to_who_trusts_the_certificate(served):
    assert served.ask("/display").code == 200
    message = json.loads(served.running.do(served.socket("/api/v1/events").read_message()))
    assert message["type"] == "snapshot"


def test_others_get_nothing(served):
    with pytest.raises(ssl.SSLError, match="CERTIFICATE_VERIFY_FAILED"):
        other = ssl.create_default_context(cadata=OTHER.authority.decode())
        served.ask("/display", ssl_options=other, raise_error=True)


def test_a_paired_device_has_a_cookie_that_is_sent_encrypted_only(served):
    code = served.server.codes.make(served.server.now(), Grant("referee", "Home")).typed
    answer = served.post("/api/v1/pair", {"code": code, "person": "Anna"})
    cookie = answer.headers["Set-Cookie"]
    assert cookie.startswith(f"__Host-{COOKIE}=")
    assert all(word in cookie for word in ("Secure", "HttpOnly", "SameSite=Strict", "Path=/"))
    own = {"Cookie": cookie.partition(";")[0]}
    assert served.ask("/api/v1/session", headers=own).code == 200
    device = served.socket("/api/v1/device", Origin=f"https://{HOST}:{served.port}", **own)
    assert json.loads(served.running.do(device.read_message()))["type"] == "snapshot"
    with pytest.raises(httpclient.HTTPError):  # a page without TLS, which somebody in between may have written
        served.socket("/api/v1/device", Origin=f"http://{HOST}:{served.port}", **own)


def test_a_token_of_the_time_without_encryption_does_not_count(served):
    """Somebody may have read it."""
    token = served.sessions.add(served.server.utc(), Grant("organiser", ""), "Anna", "phone")
    assert served.sessions.of(served.server.utc(), token)
    for name in (COOKIE, ENCRYPTED + COOKIE):
        assert served.ask("/api/v1/session", headers={"Cookie": f"{name}={token}"}).code == 401


def test_requests_without_encryption_are_sent_to_the_encrypted_page(served):
    answer = served.ask("/display?zone=Home", "http")
    assert (answer.code, answer.headers["Location"]) == (302, f"https://{HOST}:{served.port}/display?zone=Home")
    assert served.ask("/", "http", headers={"Host": "evil.example"}).code == 421
    code = served.server.codes.make(served.server.now(), Grant("referee", "Home")).typed
    refused = served.post("/api/v1/pair", {"code": code, "person": "Anna"}, "http")
    assert refused.code == 403 and b"begin the address with https" in refused.body
    assert served.post("/api/v1/pair", {"code": code, "person": "Anna"}).code == 200, "it used no code up"


@pytest.mark.parametrize("data", [b"", b"\x16", b"\x16\x03\x01\x02\x00garbage" * 50, b"GET / HT", b"\xff\xff\xff"])
def test_connections_that_are_no_browser_s_do_not_delay_others(few_connections, served, data):
    idle = [socket.create_connection((HOST, served.port)) for _ in range(30)]
    for connection in idle:
        connection.sendall(data)
    assert served.ask("/display").code == 200
    served.running.until(lambda: len(closed(idle)) >= 20)
    for connection in idle:
        connection.close()


def test_a_certificate_that_is_replaced_counts_at_once(served, tmp_path):
    assert not served.certificate.renew()
    maker.write(str(tmp_path), OTHER)
    assert served.certificate.renew()
    assert served.ask("/", ssl_options=ssl.create_default_context(cadata=OTHER.authority.decode())).code == 200


def test_a_wrong_certificate_is_reported_once_and_the_one_before_stays(served, files):
    durable.write_file(files.key, OTHER.key)
    with pytest.raises(CertificateError, match="does not belong"):
        served.certificate.renew()
    assert not served.certificate.renew()
    assert served.ask("/").code == 200


# -- certificates -----------------------------------------------------------------------------------


def _encrypted_key():
    key = serialization.load_pem_private_key(MADE.key, None, default_backend())
    return key.private_bytes(serialization.Encoding.PEM, serialization.PrivateFormat.PKCS8,
                             serialization.BestAvailableEncryption(b"secret"))


@pytest.mark.parametrize("name, content, why", [
    ("certificate", None, "cannot read .*No such file.*web_cert and web_key.*--certificate DIR"),
    ("key", None, "cannot read .*No such file"),
    ("certificate", b"nonsense", "is not a certificate in PEM format"),
    ("certificate", b"", "is not a certificate in PEM format"),
    ("key", b"nonsense", "must be in PEM format"),
    ("key", OTHER.key, "does not belong to the certificate"),
    ("certificate", OTHER.certificate, "does not belong to the certificate"),
    ("key", _encrypted_key(), "has a password: remove it with 'openssl pkey"),
])
def test_a_file_that_cannot_be_used_is_reported_with_its_remedy(files, name, content, why):
    path = getattr(files, name)
    os.unlink(path)
    if content is not None:
        durable.write_file(path, content)
    for _ in range(2):
        with pytest.raises(CertificateError, match=why):
            Certificate(files).renew()


def _trouble(files, days, host=HOST):
    certificate = Certificate(files)
    certificate.renew()
    return certificate.trouble(TODAY + datetime.timedelta(days=days), host)


def test_a_certificate_of_another_time_or_name_is_reported(files):
    assert _trouble(files, 0) == _trouble(files, 300, "box.local") == ""
    assert "set the clock" in _trouble(files, -2)
    assert "expires on" in _trouble(files, maker.VALID_DAYS - 1)
    assert "has expired" in _trouble(files, maker.VALID_DAYS + 1)
    assert "is not for 192.0.2.7" in _trouble(files, 0, "192.0.2.7")


def test_only_the_owner_reads_the_key_and_nobody_has_that_of_the_authority(files, tmp_path):
    assert os.stat(files.key).st_mode & 0o777 == 0o600
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted([
        maker.CERTIFICATE, maker.KEY, maker.AUTHORITY])
    assert (tmp_path / maker.AUTHORITY).read_bytes() == MADE.authority != MADE.certificate
    assert b"PRIVATE KEY" not in MADE.certificate + MADE.authority


@pytest.mark.parametrize("name", ["", "a b", "rsbb..local", "x" * 64, "böx", "http://rsbb.local"])
def test_names_that_no_certificate_can_have_are_reported(name):
    report = Report()
    maker.check_names(report, Place("--names", 0, 0), [name, "rsbb.local", "192.168.1.10"])
    assert len(report.errors) == 1


def test_a_certificate_is_for_this_computer_unless_it_is_named():
    assert {"localhost", HOST} <= set(maker.own_names())
