"""A phone is paired in a real browser, with codes from the terminal; the core is killed after it."""

import json
import pathlib
import urllib.error
import urllib.request
from typing import Any, Tuple

from support.box_case import BoxCase
from support.box_client import Refusal
from support.browser import NeedsBrowser, Page
from support.gateway import URL, ask, wait_served
from support.referee_program import called
from support.waiting import wait_until

SHOTS = pathlib.Path(__file__).resolve().parents[3] / "build" / "screenshots"
ZONE = "Room"
PHONE = (360, 740)
TEXT = "document.body.innerText"


def devices() -> Any:
    """The paired devices, as the terminal lists them."""
    return json.loads(called("devices", "--json").stdout)["devices"]


def typed_code(code: str) -> int:
    """The status with which the gateway answers a code that is typed on a team's page."""
    return answered("teams/Delta", {"code": code})


def answered(path: str, body: Any) -> int:
    """The status with which the gateway answers what a page sends."""
    request = urllib.request.Request(f"{URL}/api/v1/{path}", json.dumps(body).encode(), {
        "Content-Type": "application/json", "Origin": URL})
    try:
        with urllib.request.urlopen(request, timeout=30) as opened:
            return opened.status
    except urllib.error.HTTPError as refused:
        return refused.code


def pair_with(code: str) -> int:
    """The status with which the gateway answers a code that is typed on the page for pairing."""
    return answered("pair", {"code": code, "person": "Eve", "device": "phone"})


class TestPairing(NeedsBrowser, BoxCase):
    """Codes, the page that takes them, and the list of devices."""

    PAGES = "pairing"

    def setUp(self) -> None:
        super().setUp()
        wait_served()
        ask(self.box, "revoke")

    def pair(self, url: str, person: str) -> Page:
        """Open the address of a QR code, and type a name."""
        page = self._leaving(self.browser.page(url, *PHONE))
        page.wait("document.querySelector('#person') !== null", "the form is shown")
        self.assertEqual(page.inaccessible(), [])
        page.screenshot(SHOTS / "web_pair.png")
        page.fill("#person", person)
        page.press("form button")
        return page

    def test_an_organiser_gets_and_renews_the_codes_of_teams_in_the_terminal(self) -> None:
        before = json.loads(called("team-codes", "--json").stdout)["codes"]
        self.assertIn("Delta", before)
        listed = called("team-codes").stdout
        self.assertTrue(any(line.split() == ["Delta", before["Delta"]] for line in listed.splitlines()), listed)
        self.assertEqual(typed_code(before["Delta"]), 200)
        after = json.loads(called("team-codes", "--renew", "--json").stdout)["codes"]
        self.assertEqual((set(after), after["Delta"] == before["Delta"]), (set(before), False))
        self.assertEqual((typed_code(before["Delta"]), typed_code(after["Delta"])), (403, 200))

    def test_a_phone_is_paired_and_revoked(self) -> None:
        made = json.loads(called("pair", ZONE, "--json").stdout)
        self.assertRegex(made["url"], f"^{URL}/pair#{made['code']}-[A-Z2-9]{{16}}$")
        self.assertEqual({pair_with("AAAA-AAAA") for _ in range(12)}, {403, 429}, "somebody at this address guesses")
        self.assertEqual(pair_with(made["code"]), 429)
        page = self.pair(made["url"], "Anna")
        page.wait_address("/referee")
        page.wait(f"document.querySelector('.run') !== null && {TEXT}.includes('Delta')", "the phone is paired")
        self.assertEqual(page.get("document.cookie"), "", "no script reads the cookie")
        self.assertNotIn(made["code"], page.get("location.href"))
        (listed,) = devices()
        self.assertEqual((listed["person"], listed["role"], listed["zone"]), ("Anna", "referee", ZONE))
        typed = json.dumps({"code": made["url"].partition("#")[2], "person": "Eve", "device": "phone", "language": ""})
        wrong = self._leaving(self.browser.page(f"{URL}/pair?language=en#AAAA-AAAA", *PHONE))
        wrong.wait("document.querySelector('#person') !== null", "the form is shown")
        wrong.get("['person', 'device'].forEach(name => { const field = document.getElementById(name); "
                  "field.value = `my ${name}`; field.dispatchEvent(new Event('input', {bubbles: true})); })")
        wrong.wait(f"{TEXT}.includes('Paired: Referee in')", "it is complete")
        wrong.get("document.querySelector('form button').scrollIntoView()")
        wait_until(lambda: self.is_refused_after_guesses(wrong), "the page says that there were too many")
        self.assertEqual(wrong.get("['code', 'person', 'device'].map(name => document.getElementById(name).value)"),
                         ["AAAA-AAAA", "my person", "my device"], "nothing needs to be typed again")
        self.assertIn("was used", page.get(
            "fetch('/api/v1/pair', {method: 'POST', credentials: 'omit', "
            "headers: {'Content-Type': 'application/json'}, "
            f"body: {json.dumps(typed)}}}).then(answer => answer.text())"), "the code is for one device")
        self.kill_core()
        wait_served()
        self.assertEqual(page.get("fetch('/api/v1/session').then(answer => answer.json()).then(one => one.person)"),
                         "Anna")
        self.assertEqual(called("devices", "--revoke", listed["id"]).returncode, 0)
        page.wait(f"{TEXT}.includes('This device is not paired')", "the phone says so")
        self.assertEqual(devices(), [])

    def is_refused_after_guesses(self, page: Page) -> bool:
        """Whether a code that is sent right after somebody's guesses is one too many: on a busy machine it may come
        so late that a guess is allowed again."""
        while pair_with("AAAA-AAAA") != 429:
            pass
        self.assertTrue(page.tap("form button"))
        page.wait(f"{TEXT}.includes('Too many wrong codes') || {TEXT}.includes('This code is wrong')", "it is answered")
        return page.is_now(f"{TEXT}.includes('Too many wrong codes')")

    def test_a_referees_window_leads_to_a_part_of_the_box(self) -> None:
        def page(size: Tuple[int, int]) -> Page:
            made = json.loads(called("pair", "--role", "organiser", "--json").stdout)
            asked = f"?part=runs&zone={ZONE}&person=Hugo#"
            return self._leaving(self.browser.page(made["url"].replace("#", asked), *size))

        first = page((1024, 700))
        first.wait("document.querySelector('#person')?.value === 'Hugo'", "the name is that of the window")
        first.press("form button")
        for one in (first, page((900, 500))):  # the second is paired already
            one.wait_address("/box")
            one.wait(f"location.search === '?part=runs&zone={ZONE}'", "the zone is that of the window")
            one.wait("document.querySelector('[data-part=runs][aria-current]') !== null", "the results are shown")
        self.assertEqual([one["person"] for one in devices()], ["Hugo"])

    def test_wrong_requests_are_refused_with_reasons(self) -> None:
        for role, zone, reason in (("king", ZONE, "choose one of"), ("referee", "", "needs a zone"),
                                   ("referee", "Rom", "did you mean"), ("organiser", ZONE, "leave out zone")):
            with self.subTest(role=role, zone=zone), self.assertRaisesRegex(Refusal, reason):
                ask(self.box, "pair", role=role, zone=zone)
        self.assertEqual(called("pair").returncode, 2)
        self.assertEqual(called("devices", "--revoke", "none").returncode, 2)

    def test_the_terminal_shows_a_code(self) -> None:
        shown = called("pair", "--role", "organiser")
        self.assertEqual(shown.returncode, 0, shown.stderr)
        self.assertRegex(shown.stdout, r"type the code [A-Z2-9]{4}-[A-Z2-9]{4}")
        self.assertIn("Organiser, all zones", shown.stdout)
        self.assertEqual(called("devices").stdout, "no device is paired\n")
