"""Commands of paired devices: who may give which, and what the server makes of their answers."""

import asyncio
import json
import threading

import pytest
from tornado import httpclient

from helpers.public_box import PublicBox
from helpers.served_pages import ServedPages
from roah_rsbb.model.results import DIFFER, Given, JudgedItem, JudgedRun, Judging, RunLine, RunSheet
from roah_rsbb.model.zone import SheetItem
from roah_rsbb.web.commands import FIELDS, BadCommand, Outcome, command_of, may
from roah_rsbb.web.displays import Displays
from roah_rsbb.web.limits import Rates
from roah_rsbb.web.own_pages import COOKIE
from roah_rsbb.web.pairing import SESSION_VALID_S, DeviceSession, Grant
from roah_rsbb.web.readers import MOST_STOPS, DeviceEventsHandler, EventsHandler, Reader
from roah_rsbb.web.server import NOT_PAIRED, WebServer
from roah_rsbb.web.teams import TeamCodes

MARK = {"zone": "Home", "identity": "run", "id": "1", "group": "g", "desc": "d", "added": "1"}


def session(role="referee", zone="Home", person="Anna"):
    return DeviceSession("1", Grant(role, zone), person, "iPhone", 0.0)


# -- who may do what --------------------------------------------------------------------------------


OF_JUDGES = {"judge_mark", "submit"}
OF_ALL = sorted(set(FIELDS) | {"mark"})


@pytest.mark.parametrize("name", OF_ALL)
def test_a_referee_may_act_in_one_zone_and_an_organiser_in_all(name):
    for zone, allowed in (("Home", True), ("Hall", False), ("", False)):
        assert may(command_of(name, body(name, zone), session())) == allowed
    assert may(command_of(name, body(name, "Hall"), session("organiser", "")))
    assert not may(command_of(name, body(name, ""), session("organiser", "")))


def body(name, zone="Home"):
    """What a page sends with a command that needs nothing else."""
    return {"zone": zone, **({"group": "g", "desc": "d"} if "mark" in name else {})}


@pytest.mark.parametrize("name", sorted({*OF_JUDGES, "judging"}))
def test_a_judge_scores_on_the_own_sheet(name):
    for role, allowed in (("judge", True), ("referee", name == "judging"), ("organiser", name == "judging")):
        assert may(command_of(name, body(name), session(role))) == allowed
    assert not may(command_of(name, body(name, "Hall"), session("judge")))


@pytest.mark.parametrize("name", sorted(set(FIELDS) - {"judging"}))
def test_a_judge_gives_no_commands(name):
    assert not may(command_of(name, {"zone": "Home"}, session("judge")))


def test_a_judge_gives_own_ratings_only():
    rating = {**body("mark"), "text": "7"}
    for judge, allowed in (("Anna", True), ("Bert", False), ("", False)):
        assert may(command_of("mark", {**rating, "judge": judge}, session("judge"))) == allowed
    assert not may(command_of("mark", {**rating, "zone": "Hall", "judge": "Anna"}, session("judge")))
    for more in ({"added": "1"}, {"not_attempted": True}):
        assert not may(command_of("mark", {**rating, "judge": "Anna", **more}, session("judge")))


@pytest.mark.parametrize("name, body", [
    ("king", {}), ("connect", {"zone": 1}), ("mark", {}), ("mark", {**MARK, "change": 1}),
    ("mark", {**MARK, "added": 1}), ("mark", {**MARK, "value": 2**31}), ("mark", {**MARK, "value": 1.5}),
    ("mark", {**MARK, "note": "x" * 501}), ("stop", {"identity": None}),
    ("stop", {"identity": ["x"]}), ("mark", {**MARK, "note": "\ud83e"}),
    ("operation", {"given": [1]}), ("start", {"given": "x"}), ("mark", {**MARK, "made": "1", "now": 2}),
    ("mark", {**MARK, "made": 1, "now": True}),
])
def test_malformed_commands_are_refused(name, body):
    with pytest.raises(BadCommand):
        command_of(name, body, session())


def test_a_wrong_clock_of_a_phone_does_not_matter():
    for more, ago in (({"made": 86_400_000, "now": 86_520_000}, 120_000), ({"made": 9, "now": 8}, 0), ({}, 0),
                      ({"ago_ms": 7}, 0), ({"made": 0, "now": 2**40}, 2**31 - 1)):
        given = command_of("mark", {**MARK, **more}, session()).fields["given"]
        assert given["ago_ms"] == ago and not {"made", "now"} & set(given)


def test_a_page_of_an_earlier_version_does_not_set_what_it_adds():
    with pytest.raises(BadCommand, match="has no field 'change'"):
        command_of("mark", {"zone": "Home", "group": "g", "desc": "d", "change": 1, "value": 1}, session())


def test_the_fields_of_a_modules_form_are_for_the_core_to_read():
    given = {"operation": 7, "zone": "a field", "pose": [1, 2, 3]}
    command = command_of("operation", {"zone": "Home", "identity": "run", "language": "de", "given": given}, session())
    assert command.fields == {"identity": "run", "event_id": "", "given": given}


def test_unknown_fields_are_left_out():
    command = command_of("stop", {"zone": "Home", "identity": "run", "who": "Eve"}, session())
    assert command.fields == {"identity": "run"}


# -- on real loopback sockets -----------------------------------------------------------------------


class Served(ServedPages):
    """A server whose core answers as the test says, and devices."""

    def __init__(self, running):
        self.commands, self.outcome = [], Outcome(result={"number": 3})
        self.is_free, self.hanging = threading.Event(), 0
        self.is_free.set()
        super().__init__(running, PublicBox(), command=self.carry_out, displays=Displays(self.save, {"ab" * 16: {}}),
                         team_codes=TeamCodes(self.save, {}))

    def save(self, content):
        if not self.is_free.is_set():
            self.hanging += 1
            self.is_free.wait(5.0)  # the disk hangs
        super().save(content)

    async def carry_out(self, command):
        self.commands.append(command)
        return self.outcome

    def send(self, name, body, token="", **headers):
        return self.ask(f"commands/{name}", body, token=token, **headers)


def test_the_last_mark_of_a_device_is_known(served):
    served.outcome = Outcome(("No run",))
    for marks in (False, True):
        served.send("mark", body("mark"), served.token())
        assert [one.marked_utc > 0.0 for one in served.sessions.listed(served.server.utc())][-1] is marks
        served.outcome = Outcome()


def test_who_acts_is_sent_changes_before_spectators(served, monkeypatch):
    served.opened("events")
    served.opened("device", served.token())
    served.running.until(lambda: len(served.server.viewers) == len(served.server.devices) == 1)
    order = []
    monkeypatch.setattr(Reader, "send_next", lambda reader, now, made=None: order.append(type(reader)))
    served.server.publish()
    assert order == [DeviceEventsHandler, EventsHandler]


@pytest.mark.parametrize("outcome, code", [
    (Outcome(), 200), (Outcome(("No run is running",)), 409),
    (Outcome(("not confirmed: no standby",), is_confirmed=False), 202), (Outcome(is_known=False), 504),
    (Outcome(("unable to connect",), is_known=False), 504),
])
def test_the_answer_says_whether_it_was_done(served, outcome, code):
    served.outcome = outcome
    answer = served.send("stop", {"zone": "Home", "identity": "run"}, served.token())
    assert answer.code == code
    reasons = json.loads(answer.body).get("reasons", [])
    assert bool(reasons) == (code != 200) and set(outcome.reasons) <= set(reasons)
    assert [(one.name, one.fields) for one in served.commands] == [("stop", {"identity": "run"})]


def test_nothing_is_carried_out_for_others(served):
    stop, token = {"zone": "Home", "identity": "run"}, served.token()
    assert served.send("stop", stop).code == 401
    assert served.send("stop", stop, "x" * 43).code == 401
    assert served.send("stop", {**stop, "zone": "Hall"}, token).code == 403
    assert served.send("stop", stop, served.token("judge")).code == 403
    assert served.send("stop", stop, token, Origin="https://evil.example").code == 403
    assert served.send("king", stop, token).code == 400
    assert served.send("STOP", stop, token).code == 404
    assert served.get("/api/v1/commands/stop", headers={"Cookie": f"{COOKIE}={token}"}).code == 405
    served.server.revoke("")
    assert served.send("stop", stop, token).code == 401
    assert served.commands == []


def test_what_is_wrong_with_a_value_is_said_in_the_page_s_language(served):
    body = {"zone": "Home", "identity": "run", "given": {"number": 0}, "language": "de"}
    answer = served.send("switch", body, served.token())
    assert (answer.code, json.loads(answer.body)["reasons"]) == (
        400, ["auf Deutsch: auf Deutsch: Number: a whole number from 1 to 2147483647 is expected"])


def test_a_sheet_of_a_run_that_is_over_is_shown_to_referees(served):
    line = RunLine("run", 1, "Home", "HWV", "Alpha", 1, 1, 10.0)
    served.outcome = Outcome(result=RunSheet(line, (), 3.5, (SheetItem("G", "cups", "uint", 2, max="3"),), (), ()))
    body = {"zone": "Home", "identity": "run"}
    shown = json.loads(served.send("sheet", body, served.token()).body)
    assert [(one["desc"], one["shown"], one["max"]) for one in shown["items"]] == [("cups", "2", "3")]
    assert served.send("sheet", body, served.token("judge")).code == 403


def test_the_session_says_who_it_was_and_not_the_request(served):
    served.send("mark", {**MARK, "device": "Eve's", "role": "organiser"}, served.token())
    session = served.commands[0].session
    assert session.who == f"Anna 0, iPhone {session.id}"
    given = served.commands[0].fields["given"]
    assert (given["device"], given["role"]) == (f"iPhone {session.id}", "referee")


def test_a_crowd_behind_the_same_address_does_not_keep_a_referee_out(served):
    token = served.token()
    served.server.rates = Rates(a_second=1e-9, at_once=3.0)
    assert [served.get("/api/v1/state").code for _ in range(4)] == [200, 200, 200, 429]
    assert served.send("stop", {"zone": "Home"}, token).code == 200
    assert served.send("stop", {"zone": "Home"}).code == 429, "whoever is not paired belongs to the crowd"


def test_a_device_has_a_limit_of_its_own(served):
    first, second = served.token(), served.token()
    served.server.device_rates = Rates(a_second=1e-9, at_once=3.0)
    assert [served.send("connect", {"zone": "Home"}, first).code for _ in range(4)] == [200, 200, 200, 429]
    assert served.send("connect", {"zone": "Home"}, second).code == 200
    assert served.send("stop", {"zone": "Home"}, first).code == 200, "a STOP is never one too many"


# -- STOP on the connection that a page has ---------------------------------------------------------


def stopped(served, device, number, **body):
    """Send a STOP; returns the answer to it."""
    device.write_message(json.dumps({"number": number, "zone": "Home", "identity": "run", **body}))
    while True:
        answer = served.read(device)
        if answer["type"] == "answer" and answer["number"] == number:
            return answer


@pytest.mark.parametrize("outcome, code", [
    (Outcome(), 200), (Outcome(("No run",)), 409), (Outcome(is_known=False), 504)])
def test_stop_needs_no_new_connection(served, outcome, code):
    served.outcome = outcome
    answer = stopped(served, served.opened("stop", served.token()), 7)
    assert answer["status"] == code and bool(answer.get("reasons")) == (code != 200)
    assert [(one.name, one.zone, one.fields) for one in served.commands] == [("stop", "Home", {"identity": "run"})]


@pytest.mark.parametrize("method, path, body, code", [
    ("POST", "pair", {"person": "Ben", "device": "iPad"}, 200), ("DELETE", "session", None, 204),
    ("POST", "codes", {}, 200), ("GET", "codes", None, 200), ("POST", "displays", {"id": "ab" * 16}, 200)])
def test_a_stop_waits_for_no_disk(served, method, path, body, code):
    token, other = served.token(), served.token("organiser", "")
    served.running.do(served.sessions.kept.wait())
    if path == "pair":
        body = {**body, "code": served.server.codes.make(served.server.now(), Grant("judge", "Home")).typed}
    served.is_free.clear()
    asked = asyncio.ensure_future(httpclient.AsyncHTTPClient(force_instance=True).fetch(
        f"{served.origin}/api/v1/{path}", method=method, body=None if body is None else json.dumps(body), headers={
            "Origin": served.origin, "Content-Type": "application/json", "Cookie": f"{COOKIE}={other}"}))
    served.running.until(lambda: served.hanging)
    before = len(served.saved)
    assert served.send("stop", {"zone": "Home"}, token).code == 200
    assert len(served.saved) == before and not asked.done(), "the disk still hangs"
    served.is_free.set()
    assert served.running.do(asked).code == code


def test_a_stop_waits_for_no_other_stop(served):
    waits, late = served.running.loop.create_future(), []

    async def carry_out(command):
        late.append(command.zone)
        return await waits if len(late) == 1 else Outcome()

    served.server.command = carry_out
    device = served.opened("stop", served.token("organiser", ""))
    device.write_message(json.dumps({"number": 1, "zone": "Home"}))
    assert stopped(served, device, 2, zone="Hall")["status"] == 200 and late == ["Home", "Hall"]
    waits.set_result(Outcome())
    assert served.read(device)["number"] == 1


def test_a_stop_that_the_role_does_not_allow_is_refused_there_too(served):
    for token, body, code in ((served.token(), {"zone": "Hall"}, 403), (served.token("judge"), {}, 403),
                              (served.token(), {"identity": 5}, 400)):
        answer = stopped(served, served.opened("stop", token), 1, language="de", **body)
        assert answer["status"] == code and answer["reasons"][0].startswith("auf Deutsch: ")
    token = served.token()
    device = served.opened("stop", token)
    served.sessions.revoke("")  # and before its connection is closed
    assert stopped(served, device, 1)["status"] == 401
    assert served.commands == []


@pytest.mark.parametrize("message", ["hello", "[1]", "7", '{"number": true}', '{"zone": "Home"}', "[" * 1000,
                                     '{"number": 1, "language": {}}', "x" * 5000])
def test_nothing_but_stop_is_taken_there(served, message):
    device = served.opened("stop", served.token())
    device.write_message(message)
    assert served.is_closed(device)
    assert served.commands == []


def test_stops_without_answers_do_not_pile_up(served):
    waits, begun = served.running.loop.create_future(), []

    async def carry_out(command):
        begun.append(command)
        return await waits

    served.server.command = carry_out
    device = served.opened("stop", served.token())
    for number in range(MOST_STOPS + 1):
        device.write_message(json.dumps({"number": number, "zone": "Home"}))
    assert served.is_closed(device)
    assert len(begun) == MOST_STOPS and device.close_code == 1008
    waits.set_result(Outcome())
    served.running.turn()


# -- what devices are shown -------------------------------------------------------------------------


@pytest.mark.parametrize("query, headers, code", [
    ("", {"Cookie": ""}, 401), ("", {"Origin": "https://evil.example"}, 403), ("?zone=Hall", {}, 403),
])
def test_only_paired_devices_of_our_pages_see_the_zone(served, query, headers, code):
    with pytest.raises(httpclient.HTTPError) as raised:
        served.opened(f"device{query}", served.token(), **headers)
    assert raised.value.code == code
    assert len(served.server.devices) == 0


def test_a_page_of_another_scheme_sees_no_zone(served):
    with pytest.raises(httpclient.HTTPError) as raised:
        served.opened("device", served.token(), Origin=f"https://127.0.0.1:{served.port}")
    assert raised.value.code == 403


def test_a_device_is_shown_its_zone_until_its_pairing_ends(served):
    token = served.token()
    device = served.opened("device", token)
    message = served.read(device)
    assert set(message["documents"]) == {"page.words", "page.device_words", "page.zones", "page.zone", "page.clock",
                                         "page.timeline"}
    assert served.server.connected() == {served.sessions.listed(served.server.utc())[0].id}
    served.server.revoke("")
    assert served.is_closed(device)
    assert device.close_code == NOT_PAIRED


def test_a_device_whose_pairing_has_become_too_old_is_shown_nothing_more(served, monkeypatch):
    device = served.opened("device", served.token())
    late = served.server.utc() + SESSION_VALID_S + 1.0
    monkeypatch.setattr(WebServer, "utc", staticmethod(lambda: late))
    assert served.is_closed(device)
    assert device.close_code == NOT_PAIRED


def test_texts_in_any_script_arrive(served):
    asked = {"zone": "Home", "identity": "run", "by": "異" * 100, "text": "議" * 300}
    assert served.send("object", asked, served.token()).code == 200


@pytest.mark.parametrize("message", ["hello", "x" * 5000], ids=["short", "long"])
def test_a_device_that_speaks_is_closed_alone(served, message):
    bad, good = served.opened("device", served.token()), served.opened("device", served.token())
    bad.write_message(message)
    assert served.is_closed(bad)
    served.running.until(lambda: len(served.server.devices) == 1)
    assert served.read(good)["type"] == "snapshot"


def test_spectators_take_no_places_of_devices(served):
    device = served.opened("device", served.token())
    served.server.viewers._most = 1
    for _ in range(3):
        served.opened("events")
    assert len(served.server.viewers) == 1 and len(served.server.devices) == 1
    assert served.read(device)["type"] == "snapshot"


# -- several judges -----------------------------------------------------------------------------------


def _answer():
    """What the core says of two judges who differ, as the call makes it."""
    item = SheetItem("Table", "cups", "uint")
    given = Given("Ann", 2, "", False), Given("Ben", 0, "", True)
    return JudgedRun(Judging("Home", "run"), (item,), (JudgedItem(item, DIFFER, given),), (),
                     (item._replace(value=2),), submitted=True)


def test_a_judge_gets_the_own_sheet_only(served):
    served.outcome = Outcome(result=_answer())
    asked = {"zone": "Home", "identity": "run"}
    own = json.loads(served.send("judging", asked, served.token("judge")).body)
    assert [item["value"] for item in own["items"]] == [2]
    assert "Ben" not in str(own)
    both = json.loads(served.send("judging", asked, served.token()).body)
    (line,) = both["judged"]
    assert [(each["judge"], each["shown"]) for each in line["given"]] == [("Ann", "2"), ("Ben", "not attempted")]
    assert line["outcome"] == "differs"
