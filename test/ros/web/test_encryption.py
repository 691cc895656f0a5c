"""Encrypted pages in a real browser: a phone that trusts the certificate of `new_competition`, and one not."""

import base64
import hashlib
import pathlib
import tempfile

from cryptography import x509
from cryptography.hazmat.backends import default_backend
from cryptography.hazmat.primitives.serialization import Encoding, PublicFormat
from support.browser import Browser, NeedsBrowser, find
from support.gateway import ask
from support.own_core import OwnCoreCase
from support.programs import own, run
from support.robots import CONFIG

from roah_rsbb.tools.competition.certificate import AUTHORITY, CERTIFICATE, KEY
from roah_rsbb.web.own_pages import COOKIE, ENCRYPTED

HOST, ZONE, PHONE = "127.0.0.1", "Room", (360, 740)
TEXT = "document.body.innerText"


def key_of(authority: pathlib.Path) -> str:
    """What Chromium calls the key of a certificate that it is to trust."""
    certificate = x509.load_pem_x509_certificate(authority.read_bytes(), default_backend())
    key = certificate.public_key().public_bytes(Encoding.DER, PublicFormat.SubjectPublicKeyInfo)
    return base64.b64encode(hashlib.sha256(key).digest()).decode()


class TestEncryption(NeedsBrowser, OwnCoreCase):
    """A box with a certificate."""

    PAGES = "encrypted pages"

    def test_a_command_over_https_from_a_phone_that_trusts_the_authority(self) -> None:
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        folder = pathlib.Path(temporary.name)
        made = run(own("new_competition"), "--certificate", str(folder), "--names", HOST)
        self.assertEqual(made.returncode, 0, made.stderr)
        self.start_core(folder / "log", schedule_file=CONFIG / "tablet.yaml", web=True, web_host=HOST, web_port=0,
                        web_cert=folder / CERTIFICATE, web_key=folder / KEY)
        self.core.wait_printed("The web pages: open https://")
        url = ask(self.box, "pair", role="referee", zone=ZONE)["url"]
        self.assertTrue(url.startswith(f"https://{HOST}:"), url)

        with self.assertRaisesRegex(ConnectionError, "ERR_CERT_AUTHORITY_INVALID"):
            self.browser.page(url, *PHONE)

        # What the phone does with the file of the authority: it has no other reason to trust the certificate.
        browser = Browser(find(), f"--ignore-certificate-errors-spki-list={key_of(folder / AUTHORITY)}")
        self.addCleanup(browser.close)
        page = browser.page(url, *PHONE)
        self.assertTrue(page.get("isSecureContext"))
        page.wait("document.querySelector('#person') !== null", "the form is shown")
        self.assertFalse(page.get(f"{TEXT}.includes('is not encrypted')"))
        page.fill("#person", "Anna")
        page.press("form button")
        page.wait_address("/referee")
        # Zones come by a WebSocket. A page of https may open encrypted ones only.
        page.wait("document.querySelector('.run') !== null", "the zone is shown")
        (cookie,) = page.command("Network.getCookies")["cookies"]
        self.assertEqual({name: cookie[name] for name in ("name", "secure", "httpOnly", "sameSite")},
                         {"name": ENCRYPTED + COOKIE, "secure": True, "httpOnly": True, "sameSite": "Strict"})
        before = self.box.zone(ZONE).run
        page.get("window.presses = 0, 0")
        page.wait("(b => b && !b.matches(':disabled, [data-changed]') && (b.textContent.includes('Press again') "
                  "? (b.click(), true) : (presses++ || b.click(), false)))"
                  "(document.querySelector('button[data-command=next]'))", "next asks")
        self.box.wait_zone(ZONE, lambda zone: zone.run == before + 1, "the command reached the core")
        self.box.command("previous", ZONE)
