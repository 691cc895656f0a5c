"""Calls that clients of the door offer: who answers them, and clients that die, hang, or send nonsense."""

import json

import pytest

from helpers.running_loop import running
from helpers.toy_box import HOST, Bare, ToyBox
from roah_rsbb.box import door, offers
from roah_rsbb.wording.device import NO_WEB
from roah_rsbb.wording.whole_box import NO_DEVICES

__all__ = ["running"]


@pytest.fixture
def box(running):
    made = ToyBox(running)
    yield made
    made.disk.set()
    made.door.close()
    running.turn()


def read_of(client, *names):
    """The next message with one of these fields; None: the connection was closed."""
    while True:
        message = client.read()
        if message is None or any(name in message for name in names):
            return message


def offering(box, *calls, node="/web", is_taken=True):
    """A client whose offer was answered."""
    client = Bare(box)
    client.send(offer=list(calls), node=node)
    answered = read_of(client, "offer")
    assert bool(answered["offer"]) == is_taken, answered
    client.answered = answered
    return client


def asked_by(box, client, call="pair", **arguments):
    """Another client that calls what this one offers; and what this one is asked."""
    asking = Bare(box, "?face=referee")
    asking.send(id=7, call=call, **arguments)
    return asking, read_of(client, "asked")


def test_a_call_is_passed_on_and_its_answer_comes_back(box):
    client = offering(box, "pair", "paired")
    asking, asked = asked_by(box, client, role="judge", zone="Home")
    assert {name: asked[name] for name in ("call", "face", "address", "arguments")} == {
        "call": "pair", "face": "referee", "address": HOST, "arguments": {"role": "judge", "zone": "Home"}}
    (waiting,) = box.asked.values()
    client.send(asked=asked["asked"], answer={"code": "ABCD"})
    assert asking.read_answer() == {"id": 7, "number": box.written.number, "answer": {"code": "ABCD"}}
    assert box.done == [] and not box.asked and waiting.late.cancelled()


@pytest.mark.parametrize("given", [{"refused": ["no zone"]}, {"refused": ["x"], "known": False}, {"error": "a bug"}])
def test_a_refusal_or_an_error_comes_back(box, given):
    client = offering(box, "pair")
    asking, asked = asked_by(box, client)
    client.send(asked=asked["asked"], more=1, **given)
    assert asking.read_answer() == {"id": 7, "number": box.written.number, **given}


def test_several_calls_are_answered_in_any_order(box):
    client = offering(box, "pair")
    askings = [asked_by(box, client) for _ in range(3)]
    for _, asked in reversed(askings):
        client.send(asked=asked["asked"], answer=asked["asked"])
    assert [asking.read_answer()["answer"] for asking, _ in askings] == [asked["asked"] for _, asked in askings]


@pytest.mark.parametrize("call, remedy", [("pair", NO_WEB), ("set_device", NO_DEVICES)])
def test_what_nobody_offers_is_refused_with_the_remedy(box, call, remedy):
    client = Bare(box)
    client.send(id=1, call=call)
    assert client.read_answer()["refused"] == [remedy]
    client.send(id=2, call="unknown")
    assert "of another version" in client.read_answer()["error"]


def test_a_call_whose_client_ends_is_refused(box):
    asking, gone = Bare(box), offering(box, "mine")
    box.running.do(asking.connection.write_message(json.dumps({"id": 1, "call": "mine"})))
    box.running.until(lambda: box.asked)
    gone.connection.close()
    ((text, values),) = asking.read_answer()["refused"]
    assert "mine now" in values["why"][0].format(**values["why"][1]) and "ended" in values["error"][0]


def test_the_calls_of_the_box_cannot_be_offered(box):
    for call in ("act", "stop"):
        refused = offering(box, "pair", call, is_taken=False)
        assert refused.answered["refused"] == [f"{call} is a call of the box itself, which no other program can offer"]
    other = Bare(box)
    other.send(id=1, call="act")
    assert other.read_answer()["answer"] == {"count": 1}
    other.send(id=2, call="pair")
    assert other.read_answer()["refused"] == [NO_WEB], "not even the other call is offered"


def test_a_second_one_waits_until_the_first_one_has_gone(box):
    first = offering(box, "pair", node="/first")
    second = offering(box, "paired", "pair", node="/second", is_taken=False)
    assert second.answered["refused"] == [f"/first at {HOST} offers pair already"]
    third = offering(box, "pair", is_taken=False)
    asking, asked = asked_by(box, first)
    first.connection.close()
    assert NO_WEB in asking.read_answer()["refused"][0][1]["why"]
    assert read_of(second, "offer") == {"offer": ["paired", "pair"]}
    asking, asked = asked_by(box, second)
    second.send(asked=asked["asked"], answer=2)
    assert asking.read_answer()["answer"] == 2
    second.send(offer=[])  # withdrawn
    assert read_of(third, "offer") == {"offer": ["pair"]}


def test_another_offer_replaces_the_one_before(box):
    client = offering(box, "pair")
    client.send(offer=["paired"])
    assert read_of(client, "offer") == {"offer": ["paired"]}
    other = Bare(box)
    other.send(id=1, call="pair")
    assert other.read_answer()["refused"] == [NO_WEB]


def test_one_that_hangs_is_waited_for_only_so_long(box, monkeypatch):
    monkeypatch.setattr(offers, "ASKED_S", 0.05)
    client = offering(box, "pair")
    asking, asked = asked_by(box, client)
    ((text, values),) = asking.read_answer()["refused"]
    assert "no answer within" in text and values["why"] == NO_WEB
    client.send(asked=asked["asked"], answer="late")
    asking.send(id=8, call="act")
    assert asking.read_answer() == {"id": 8, "number": box.written.number, "answer": {"count": 1}}


def test_only_the_first_answer_of_the_one_that_was_asked_counts(box):
    client, other = offering(box, "pair"), offering(box, "other")
    asking, asked = asked_by(box, client)
    other.send(asked=asked["asked"], answer="wrong")
    for strange in (asked["asked"] + 1, True, None, "1", [], {}):
        client.send(asked=strange, answer="strange")
    client.send(asked=asked["asked"], answer=1)
    client.send(asked=asked["asked"], answer=2)
    assert asking.read_answer()["answer"] == 1
    asking.send(id=8, call="act")
    assert asking.read_answer()["id"] == 8


@pytest.mark.parametrize("answer", [{}, {"refused": 7}, {"refused": "text"}, {"error": []}])
def test_a_malformed_answer_is_reported(box, answer):
    client = offering(box, "pair")
    asking, asked = asked_by(box, client)
    client.send(asked=asked["asked"], **answer)
    assert "malformed" in asking.read_answer()["refused"][0][0]


@pytest.mark.parametrize("calls", [
    ["a"] * 10000, 7, {"pair": 1}, [7], [""], ["x" * 41], [["pair"]], None,
])
def test_a_malformed_offer_is_refused(box, calls):
    client = Bare(box)
    client.send(offer=calls)
    assert "at most 16 names" in read_of(client, "offer")["refused"][0]
    client.send(id=1, call="act")
    assert client.read_answer()["id"] == 1


def test_the_offers_are_limited(box, monkeypatch):
    monkeypatch.setattr(offers, "MAX_OFFERS", 2)
    first, second = offering(box, "one"), offering(box, "two")
    third = offering(box, "three", is_taken=False)
    assert "end one of them" in third.answered["refused"][0]
    first.connection.close()
    second.send(offer=["two", "more"])
    assert read_of(second, "offer")["offer"] == ["two", "more"], "its own place is free for it"


def test_the_calls_that_wait_are_limited(box, monkeypatch):
    monkeypatch.setattr(offers, "MAX_ASKED", 2)
    client = offering(box, "pair")
    waiting = [asked_by(box, client) for _ in range(2)]
    late = Bare(box)
    late.send(id=1, call="pair")
    assert "too many calls wait" in late.read_answer()["refused"][0][0]
    asking, asked = waiting[0]
    client.send(asked=asked["asked"], answer=1)
    assert asking.read_answer()["answer"] == 1
    late.send(id=2, call="pair")
    assert read_of(client, "asked")["call"] == "pair"


def test_one_that_has_gone_is_not_answered(box):
    client = offering(box, "pair")
    asking, asked = asked_by(box, client)
    asking.connection.close()
    box.running.until(lambda: len(box.clients) == 1)
    client.send(asked=asked["asked"], answer=1)
    other, asked = asked_by(box, client)
    client.send(asked=asked["asked"], answer=2)
    assert other.read_answer()["answer"] == 2


def test_what_is_nested_deeply_harms_nobody(box, monkeypatch):
    monkeypatch.setattr(offers, "ASKED_S", 0.05)
    client, asking = offering(box, "pair"), Bare(box)
    for depth in (100, 900, 1200):
        nested = "[" * depth + "]" * depth
        box.running.do(asking.connection.write_message(f'{{"id":{depth},"call":"pair","x":{nested}}}'))
        answered = asking.read_answer()
        assert answered.get("refused") or answered["error"]
    asking.send(id=8, call="act")
    assert asking.read_answer()["answer"] == {"count": 1}
    client.send(id=9, call="act")
    assert client.read_answer()["answer"] == {"count": 2}
    nested = []
    for _ in range(100000):  # as can be read, on a version of Python that reads deeper than it writes
        nested = [nested]
    assert "nested too deeply" in json.loads(door._dumped({"x": nested}))["error"]


def test_stop_waits_for_no_offer_and_no_answer(box):
    """Each turn of the loop takes one offer, one call that is passed on, or one answer."""
    client, stopper = offering(box, "pair"), Bare(box, "?face=stop")
    turns, order = [0], []

    def count():
        turns[0] += 1
        box.running.loop.call_soon(count)

    def noted(name):
        method = getattr(box.door._offers, name)

        def note(*given):
            order.append((turns[0], name))
            return method(*given)

        return note

    for name in ("offer", "pass_on", "answered"):
        setattr(box.door._offers, name, noted(name))
    box.door.add_calls({"stop": lambda given, caller: order.append((turns[0], "stop"))})
    crowd = [Bare(box) for _ in range(5)]
    count()
    for number in range(5):
        for other in crowd:
            other.connection.write_message(json.dumps({"offer": ["other"]}))
            other.connection.write_message(json.dumps({"id": number, "call": "pair"}))
        client.connection.write_message(json.dumps({"asked": number, "answer": 1}))
    stopper.connection.write_message(json.dumps({"id": 1, "call": "stop"}))
    assert stopper.read_answer()["id"] == 1
    names = [name for _, name in order]
    assert names.index("stop") < 15, "it did not wait for those before it"
    box.running.until(lambda: len(order) == 56)
    in_turns = [turn for turn, name in order if name != "stop"]
    assert len(in_turns) == len(set(in_turns)) == 55


def test_a_closed_door_waits_for_nothing(box):
    client = offering(box, "pair")
    asking, _ = asked_by(box, client)
    (waiting,) = box.asked.values()
    box.door.close()
    assert waiting.late.cancelled()
