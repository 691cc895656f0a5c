"""Phones of referees in a network that is away at times: a day of which every mark counts once, and pages that open
without a network where the certificate is trusted. The box is at no loopback address: browsers trust those."""

import base64
import contextlib
import datetime
import hashlib
import json
import pathlib
import random
import shutil
from typing import Any, Dict, Iterator, List, Tuple
from unittest import mock

import pytest
from cryptography import x509
from cryptography.hazmat.backends import default_backend
from cryptography.hazmat.primitives.serialization import Encoding, PublicFormat
from namespaces import BROADCAST, NoRight, Switch, address, run_ip
from support.browser import Browser, Page, find
from support.served_box import ServedBox

from roah_rsbb.box.program import neighbours
from roah_rsbb.model.as_json import from_json
from roah_rsbb.model.results import RunSheet
from roah_rsbb.tools.competition import certificate as maker
from web.test_stop_page import CLICKED

SHIPPED = pathlib.Path(__file__).resolve().parents[2]
BOX = address(1)
RULES = f"MAP * ~NOTFOUND, EXCLUDE 127.0.0.1, EXCLUDE {BOX}"
ZONE, TEAMS = "Room", ("TestingTeam", "DefaultTeam", "DumpTeam", "BrassButlers")
REFEREE, ASSISTANT, JUDGES, SECOND = "Anna", "Arno", ("Jana", "Jim"), "Berta"
# Each person marks an item of a run once: the sheet joins what follows soon in the same one.
ITEMS = ("Enters", "Finds", "Greets", "Carries", "Leaves")
COUNTED, RATED = "Achievements", "Show"
GROUPS = {COUNTED: "type: uint", RATED: f"type: rating, max: 99, judges: [{', '.join(JUDGES)}]"}
BENCHMARK = "- {name: Task, desc: Day, code: HCFGAC, timeout: 600, attempts: 2, scoring: [" + ", ".join(
    f"{group}: [{', '.join(f'{{desc: {item}, {kind}}}' for item in ITEMS)}]" for group, kind in GROUPS.items()) + "]}\n"
EVENT = "    - {{ benchmark: HCFGAC, team: {}, round: {}, run: 1, scheduled_time: 2015-12-31 1{}:00:00 }}\n"
SCHEDULE = f"- zone: {ZONE}\n  schedule:\n" + "".join(EVENT.format(TEAMS[n % 4], 1 + n // 4, n) for n in range(8))
PHONE = (390, 844)
AWAY_MS, RESTARTED, EXCHANGED = 120_000, 2, 5  # how long the network is away, and in the runs of which teams, from 0
IS_AWAY = "document.querySelector('.stopsaid').textContent.includes('NO LINK')"
HAS_ARRIVED = "marks.isRead && marks.waiting.length === 0 && marks.refused.length === 0"
SHOWN = "live.data['page.zone'].identity + live.data['page.zone'].phase === '{}running'"


class Hall:
    """A box, its phones, and the network between them."""

    def __init__(self, folder: pathlib.Path, is_encrypted: bool = True, trusts: bool = True) -> None:
        """`trusts`: phones have the certificate."""
        self._trusts, switch = trusts, Switch()
        box, self._phones = (switch.station(number).host for number in (1, 2))
        self.folder, self._computer, self._closed = folder, box, [switch.close, box.close, self._phones.close]
        made = maker.make([BOX], datetime.datetime.utcnow().replace(microsecond=0))
        maker.write(str(folder), made)
        files = {"web_cert": maker.CERTIFICATE, "web_key": maker.KEY} if is_encrypted else {}
        for name, text in (("benchmarks", BENCHMARK), ("schedule", SCHEDULE)):
            (folder / f"{name}.yaml").write_text(text)
            files[f"{name}_file"] = f"{name}.yaml"
        self._settings = {name: str(folder / file) for name, file in files.items()}
        self.open_box()
        key = x509.load_pem_x509_certificate(made.authority, default_backend()).public_key()
        digest = hashlib.sha256(key.public_bytes(Encoding.DER, PublicFormat.SubjectPublicKeyInfo)).digest()
        trust = [f"--ignore-certificate-errors-spki-list={base64.b64encode(digest).decode()}"] if trusts else []
        self.browser: Browser = self._phones.do(Browser, find(), f"--host-resolver-rules={RULES}", *trust)

    def open_box(self, pages: pathlib.Path = SHIPPED) -> None:
        """Start a box, on the disk of the one before. `pages`: the folder of its resource and config."""
        with mock.patch.object(neighbours, "shipped_folder", lambda: pages / "config"):
            self.box: ServedBox = self._computer.do(lambda: ServedBox(
                self.folder, robots=0, rsbb_host=BROADCAST, bind_host=BOX, web_names=BOX, web_port="8081",
                **self._settings))

    def close(self) -> None:
        """End all."""
        self.browser.close()
        self.box.close()
        for close in self._closed:
            close()

    @contextlib.contextmanager
    def away(self, *phones: Page) -> Iterator[None]:
        """Without a network, as soon as phones say so."""
        self._phones.do(run_ip, "link set eth0 down")
        for page in phones:
            page.wait(IS_AWAY, "the page says that it is alone")
        yield
        self._phones.do(run_ip, "link set eth0 up")

    def phone(self, person: str, role: str = "referee") -> Page:
        """A phone that is paired and shows the page."""
        url = self.box.call("pair", role=role, zone=ZONE)["url"].replace("pair#", "pair?language=en#")
        page = self.browser.page("about:blank", *PHONE, is_alone=True)
        if not self._trusts:
            page.command("Security.setIgnoreCertificateErrors", ignore=True)  # as somebody who goes past the warning
        page.open(url)
        page.fill("#person", person)
        page.press("form button")
        page.wait_address("/referee")
        page.wait("document.querySelector('.run') !== null", "the zone is shown")
        return page

    def sheet(self, identity: str) -> RunSheet:
        """The score sheet of a run."""
        return from_json(RunSheet, self.box.call("sheet", zone=ZONE, run=identity))


@pytest.fixture
def halls(tmp_path) -> Iterator[Any]:
    """Makes halls."""
    if find() is None:
        pytest.skip("NOT TESTED: phones. There is no Chromium here")
    made: List[Hall] = []

    def make(**how: bool) -> Hall:
        try:
            made.append(Hall(tmp_path, **how))
        except NoRight as reason:
            pytest.skip(f"NOT TESTED: phones: {reason}")
        return made[-1]

    yield make
    for hall in made:
        hall.close()


def until_kept(page: Page) -> None:
    """Wait until the phone opens the page without a network."""
    page.wait("navigator.serviceWorker.ready.then(({active}) => window.worker = active.state) "
              "&& worker === 'activated'", "the pages are kept")
    page.wait("import('/assets/kept.js').then(({kept}) => kept('shown')).then(all => window.all = all) && all.length",
              "what was shown is kept")


class Day:
    """What each person enters, and what has arrived."""

    def __init__(self, hall: Hall) -> None:
        self.hall, self._chance = hall, random.Random(1)
        self.entered: Dict[Tuple[str, str], List[Tuple[str, str, int]]] = {}  # by run and person: group, item, value

    def mark(self, run: str, person: str, page: Page) -> None:
        """Enter something on the page of a person."""
        entered = self.entered.setdefault((run, person), [])
        item = self._chance.choice([item for item in ITEMS if all(item != one for _, one, _ in entered)])
        group, value, button = COUNTED, 1, f"[data-item={item}] [data-meaning=more]"
        if person in JUDGES:
            group, value, button = RATED, self._chance.randint(1, 99), f"[data-item={item}] .entry button"
            page.fill(f"[data-item={item}] .entry input", str(value))
        page.wait(CLICKED.format(button), f"{person} enters {item}")
        entered.append((group, item, value))

    def arrived(self, run: str, person: str) -> List[Tuple[str, str, int]]:
        """What is on the sheet, in its order."""
        return [(one.group, one.item, int(one.text) if one.judge else one.value - one.old)
                for one in self.hall.sheet(run).history if (one.judge or one.who.split()[0].rstrip(",")) == person]


def test_every_mark_of_a_day_counts_once(halls):
    hall = halls()
    day, box = Day(hall), hall.box
    phones = {REFEREE: hall.phone(REFEREE), ASSISTANT: hall.phone(ASSISTANT, "assistant"),
              **{name: hall.phone(name, "judge") for name in JUDGES}}
    until_kept(phones[REFEREE])
    runs = []
    for team in range(len(TEAMS) * 2):
        box.wait(lambda document: document.zones[ZONE].is_on("open_sheet"), "a run can begin")
        box.act("open_sheet", ZONE, team=box.document.zones[ZONE].event.team)
        box.act("start", ZONE)
        run = box.document.zones[ZONE].identity
        runs.append(run)
        for page in phones.values():
            page.wait(SHOWN.format(run), "the run")
        is_away = team in (RESTARTED, EXCHANGED)
        with hall.away(*phones.values()) if is_away else contextlib.nullcontext():
            for person, page in [*phones.items()] * (1 + is_away):
                day.mark(run, person, page)
            if is_away:
                for page in phones.values():
                    assert page.get("marks.waiting.length") == 2, "all wait"
                    page.get(f"Date.now = (now => () => now() + {AWAY_MS})(Date.now), 0")
            if team == RESTARTED:
                page = phones[REFEREE]
                page.open(page.get("location.href"))
                page.wait("marks.isRead && marks.waiting.length === 2", "its marks are still there")
                page.wait(f"document.querySelector('[data-item]') !== null && {IS_AWAY}", "and its page")
                day.mark(run, REFEREE, page)
            elif team == EXCHANGED:
                left = phones.pop(REFEREE)
                left.get("marks.isLinked = () => false, 0")  # it is lost
        if team == EXCHANGED:
            phones[SECOND] = hall.phone(SECOND)
        for person, page in phones.items():
            page.wait(HAS_ARRIVED, "all have arrived")
            if is_away:
                day.mark(run, person, page)
                page.wait(HAS_ARRIVED, "this one, too")
        box.call("stop", zone=ZONE, run=run, by="Rita")
        box.act("disconnect", ZONE)
        if team < len(TEAMS) * 2 - 1:
            box.act("next", ZONE)
    assert left.get("marks.waiting.length") == 2
    left.get("marks.isLinked = () => true, marks.again(), 0")  # it is found
    left.wait(HAS_ARRIVED, "its marks have arrived")
    for (run, person), entered in day.entered.items():
        assert day.arrived(run, person) == entered, f"{person} in run {runs.index(run)}"
    assert sum(len(hall.sheet(run).history) for run in runs) == sum(map(len, day.entered.values()))
    assert [one for one in hall.browser.errors if "WebSocket" not in one and "Failed to load" not in one] == []


def test_a_phone_that_trusts_the_certificate_opens_the_page_without_a_network(halls, tmp_path):
    hall = halls()
    page = hall.phone(REFEREE)
    until_kept(page)
    assert page.get("document.querySelector('.missing')") is None
    manifest = page.command("Page.getAppManifest")
    assert (manifest["url"], manifest["errors"]) == (page.get("location.origin") + "/assets/manifest.json", [])
    wrong = page.command("Page.getInstallabilityErrors")["installabilityErrors"]
    assert [one["errorId"] for one in wrong] in ([], ["in-incognito"]), "only a browser that keeps nothing refuses"
    hall.box.close()
    other = tmp_path / "other"
    for name in ("config", "resource"):
        shutil.copytree(SHIPPED / name, other / name)
    with (other / "resource" / "web" / "assets" / "buttons.js").open("a") as file:
        file.write("\nwindow.isOther = true;\n")
    hall.open_box(other)
    page.wait(f"!({IS_AWAY})", "another box is heard")
    page.reload()
    page.wait("isOther", "its pages are shown")
    page.wait("caches.keys().then(names => Promise.all(names.map(cacheName => caches.match('/assets/buttons.js', "
              "{cacheName}).then(found => found.text())))).then(found => window.found = found) && found.length === 1 "
              "&& found[0].includes('isOther')", "and kept, and no others")
    with hall.away(page):
        page.open(page.get("location.href"))
        assert page.get("isOther")
        page.wait(f"document.querySelector('.run .team').textContent === '{TEAMS[0]}' && {IS_AWAY}", "as it was last")
        page.wait("document.querySelector('button[data-command=connect]').matches(':disabled')", "no command")


@pytest.mark.parametrize("is_encrypted", [False, True])
def test_a_page_says_what_is_missing(halls, is_encrypted):
    said = "does not trust the certificate" if is_encrypted else "Without encryption"
    is_said = f"document.querySelector('.missing').textContent.includes({json.dumps(said)})"
    page = halls(is_encrypted=is_encrypted, trusts=False).phone(REFEREE)
    assert page.get("isSecureContext") == is_encrypted
    for path in ("/referee", "/pair"):
        page.open(page.get(f"location.origin + '{path}?language=en'"))
        page.wait(is_said, f"what is missing on {path}")
