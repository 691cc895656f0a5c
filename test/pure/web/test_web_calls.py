"""Commands of paired devices as calls to the box: only an answer of it ends the repetition of a STOP."""

import asyncio
import concurrent.futures

import pytest

from helpers.shown_box import EVENT
from roah_rsbb.client.client import UNANSWERED, Answer
from roah_rsbb.model.as_json import to_json
from roah_rsbb.model.reason import say
from roah_rsbb.model.results import JudgedRun, Judging, RunLine, RunSheet
from roah_rsbb.web.commands import Outcome, PageCalls, call_of, command_of
from roah_rsbb.web.pairing import DeviceSession, Grant

WHO = {"by": "Anna, Linux id", "node": "/web"}
RUN = {"zone": "Home", "run": "run 1"}
REFUSED = say("{robot} is not active")(robot="R")


class Client:
    """A client of the door whose calls are answered as the test says."""

    why = ""

    def __init__(self, answer):
        self._answer = answer
        self.calls = []

    def call(self, name, **arguments):
        self.calls.append((name, arguments))
        answered = concurrent.futures.Future()
        answered.set_result(self._answer)
        return answered

    def stop(self, **arguments):
        return self.call("its own way", **arguments)


def command(name, **body):
    session = DeviceSession("id", Grant("referee", "Home"), "Anna", "Linux", 0.0)
    return command_of(name, {"zone": "Home", "identity": "run 1", **body}, session)


def outcome(client, name="stop", **body):
    return asyncio.new_event_loop().run_until_complete(PageCalls(client, "/web").carry_out(command(name, **body)))


def test_stop_has_its_own_way():
    client = Client(Answer(4))
    assert outcome(client) == Outcome()
    assert client.calls == [("its own way", {**RUN, **WHO})]


def test_an_action_says_what_is_seen_and_who_it_is():
    client = Client(Answer(4, {"number": 3}))
    assert outcome(client, "start", event_id="kx2") == Outcome(result={"number": 3})
    ((name, arguments),) = client.calls
    assert name == "act" and arguments == {
        **RUN, **WHO, "action": "start", "event": "kx2", "given": command("start").fields["given"]}
    mark = call_of(command("mark", group="g", desc="d", id="1", added="1"))[1]
    assert (mark["by"], mark["given"]["device"]) == ("Anna", "Linux id"), "each device has its own id in sheets"


@pytest.mark.parametrize("answer, expected", [
    (Answer(4, reasons=(REFUSED,)), Outcome((REFUSED,))),
    (Answer(4, reasons=(REFUSED,), is_known=False), Outcome((REFUSED,), is_confirmed=False)),
    (UNANSWERED, Outcome(is_known=False)),
])
def test_only_what_the_box_answers_is_a_refusal(answer, expected):
    for name in ("stop", "sheet", "start"):
        found = outcome(Client(answer), name)
        assert found == expected and all(reason is REFUSED for reason in found.reasons)


def test_why_there_is_no_connection_is_said():
    client = Client(UNANSWERED)
    client.why = "no connection to the box"
    assert outcome(client) == Outcome(("no connection to the box",), is_known=False)


def test_sheets_and_judges_are_values():
    line = RunLine("run 1", 1, "Home", EVENT.code, "Alpha", 1, 1, 10.0)
    sheet = RunSheet(line, ("R",), 3.5, (), (), ())
    client = Client(Answer(4, to_json(sheet)))
    assert outcome(client, "sheet").result == sheet
    judged = JudgedRun(Judging("Home", "run 1"), (), submitted=True)
    client = Client(Answer(4, to_json(judged)))
    assert outcome(client, "judging").result == judged
    assert client.calls == [("judges", {**RUN, **WHO, "judge": "Anna"})]
