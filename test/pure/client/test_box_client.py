"""A client and the door of a box together: the document from afar, calls, STOP, and everything that can break."""

import asyncio
import socket
import threading

import pytest
from tornado import httpserver, web, websocket
from tornado.netutil import bind_sockets

from helpers.running_loop import running
from helpers.toy_box import HOST, TOKEN, ToyBox
from helpers.toy_document import LOW, Toy
from roah_rsbb.box import door
from roah_rsbb.client import client as client_file
from roah_rsbb.client.client import UNANSWERED, Answer, Client, Offer
from roah_rsbb.client.places import DoorPlace, NotFound
from roah_rsbb.document.calls import HELPER, Caller, InThread, Waiting
from roah_rsbb.model.reason import Refused
from roah_rsbb.wording.device import NO_WEB

__all__ = ["running"]


class World:
    """A box in the test's loop, which may be replaced, and clients in threads of their own."""

    def __init__(self, running):
        self.running = running
        self.box = ToyBox(running)
        self.boxes = [self.box]
        self.find = lambda: self.box.place
        self.clients = []

    def client(self, **how):
        made = Client(Toy, lambda: self.find(), **how)
        self.clients.append(made)
        made.start()
        return made

    def connected(self, **how):
        """A client that has the document and a connection for STOP."""
        made = self.client(**how)
        self.until(lambda: made.document is not None and not made.why and self.link(made, "stop") is not None)
        return made

    @staticmethod
    def link(client, way):
        """The connection of a client for STOP or for everything else ("main"), if there is one."""
        return client._links.get(way)

    @staticmethod
    def in_its_loop(client, call):
        client._loop.call_soon_threadsafe(call)

    def until(self, condition):
        self.running.until(condition)

    def answer(self, future):
        self.until(future.done)
        return future.result()

    def restart(self, port=0):
        """The box starts again; its clock is another one."""
        self.box.door.close()
        self.box = ToyBox(self.running, port, utc=self.box.utc + 1.0)
        self.boxes.append(self.box)

    def close(self):
        for client in self.clients:
            client.close()
        for box in self.boxes:
            box.disk.set()
            box.door.close()
        self.running.turn()


@pytest.fixture
def world(running):
    made = World(running)
    yield made
    made.close()


def count_of(client):
    return client.document.zones["Home"].count


# -- the document -------------------------------------------------------------------------------------


def test_the_document_is_kept_current(world):
    client = world.client()
    assert client.document is None and client.is_old and client.now() == (0.0, 0.0) and client.why
    world.until(lambda: client.document is not None)
    assert client.document == world.box.toy and not client.is_old and not client.why
    yard = client.document.zones["Yard"]
    world.box.change(count=3, why=(LOW(robot="r1", number=2),))
    world.until(lambda: client.document == world.box.toy)
    assert client.document.zones["Yard"] is yard
    assert client.document.zones["Home"].why[0].values == {"robot": "r1", "number": 2}


def test_changes_are_reported(world):
    seen = []
    client = world.client(on_change=lambda: seen.append(client.document and count_of(client)))
    world.until(lambda: 0 in seen)
    world.box.change(count=3)
    world.until(lambda: 3 in seen)


def test_a_face_that_fails_ends_no_connection(world, caplog):
    client = world.client(on_change=lambda: 1 / 0)
    world.until(lambda: client.document is not None)
    world.box.change(count=3)
    world.until(lambda: count_of(client) == 3)
    assert "please report it" in caplog.text


def test_the_clocks_of_the_box(world):
    client = world.connected()
    world.box.utc = 2000.0
    world.box.door.sign()
    world.box.door.sign()
    world.until(lambda: client.now().utc - client.now().mono > 1500.0)
    before = world.box.now()
    found = client.now()
    assert abs(found.mono - before.mono) < 60.0
    assert found.utc - found.mono == pytest.approx(2000.0, abs=0.01)


def test_the_clock_of_a_replay_passes_at_its_rate(world):
    world.box.written.rate = 0.0
    client = world.connected()
    found = client.now()
    world.running.turn()
    assert client.now() == found


def test_a_gap_is_closed_by_the_whole(world):
    client = world.connected()
    yard = client.document.zones["Yard"]
    follower = next(one for one in world.box.clients if one._follower is not None)._follower
    for count in (1, 2):
        world.box.toy = world.box.toy._replace(
            zones={**world.box.toy.zones, "Home": world.box.toy.zones["Home"]._replace(count=count)})
        world.box.written.update(world.box.toy, world.box.now())
        if count == 1:
            follower.next(world.box.written, world.box.now())  # which is lost
    world.box.door.publish()
    world.until(lambda: count_of(client) == 2)
    assert client.document.zones["Yard"] is yard


def test_waiting_for_a_condition(world):
    client = world.connected()
    waiting = world.running.loop.run_in_executor(None, client.wait, lambda toy: toy.zones["Home"].count == 3, 60.0)
    world.box.change(count=1)
    world.box.change(count=3)
    assert world.running.do(waiting).zones["Home"].count == 3
    with pytest.raises(TimeoutError, match="did not do that within 0 s"):
        client.wait(lambda toy: toy.zones["Home"].count == 4, 0.0)


def test_in_a_loop_that_there_is(world):
    client = world.connected(loop=world.running.loop)
    assert world.answer(client.call("act")).answer == {"count": 1}
    client.close()
    world.until(lambda: not world.box.clients)


# -- calls --------------------------------------------------------------------------------------------


def test_an_answer_comes_when_the_document_contains_what_was_done(world):
    client = world.connected(face="referee")
    seen = []
    future = client.call("act", done=lambda answer: seen.append((answer, count_of(client))), zone="Home")
    answer = world.answer(future)
    assert seen == [(answer, 1)]
    assert answer == Answer(world.box.written.number, {"count": 1})
    assert client.is_confirmed(answer.number) and not client.is_confirmed(answer.number + 1)
    arguments, caller = world.box.done[0]
    assert (arguments, caller.face) == ({"zone": "Home"}, "referee")


def test_refusals_and_errors_are_answers(world):
    client = world.connected()
    refused = world.answer(client.call("refuse"))
    assert refused.reasons == (LOW(robot="r1", number=1), "typed") and refused.is_answered
    assert refused.reasons[0].values == {"robot": "r1", "number": 1}
    assert "there is no call 'unknown'" in world.answer(client.call("unknown")).reasons[0]
    assert "of a toy" in world.answer(client.call("break")).reasons[0]


def test_what_is_not_on_the_disks_is_not_known(world):
    world.box.trouble = "the disk is full"
    world.box.disk.set()
    client = world.connected()
    answer = world.answer(client.call("save"))
    assert (answer.reasons, answer.is_answered, answer.is_known) == (("the disk is full",), True, False)


def test_a_call_without_a_connection_is_not_answered(world):
    world.find = lambda: DoorPlace("ws://127.0.0.1:1/door", TOKEN)
    assert world.answer(world.client().call("act")) == UNANSWERED
    assert world.box.done == []


def test_a_call_whose_connection_breaks_is_not_answered(world):
    client = world.connected()
    future = client.call("save")
    world.until(lambda: world.box.done)
    old = world.box
    world.restart()
    assert world.answer(future) == UNANSWERED
    old.disk.set()
    world.until(lambda: client.document == world.box.toy and not client.why)
    assert world.answer(client.call("act")).answer == {"count": 1}


def test_what_may_be_done_again_is_sent_until_it_is_answered(world):
    client = world.connected()
    future = client.call("save", timeout_s=60.0, again=True)
    world.until(lambda: world.box.done)
    old = world.box
    world.restart()
    old.disk.set()
    world.box.disk.set()
    assert world.answer(future).is_answered
    assert len(world.box.done) == 1


def test_a_client_ends_although_a_message_comes_in_that_moment(world, monkeypatch):
    client, wait_for = world.connected(), asyncio.wait_for

    async def losing(awaited, timeout_s):
        try:
            return await wait_for(awaited, timeout_s)
        except asyncio.CancelledError:  # as Python 3.11 does
            return '{"mono":1.0,"utc":1.0,"rate":1.0}'

    monkeypatch.setattr(asyncio, "wait_for", losing)
    client.close()
    assert not [one for one in threading.enumerate() if one.name == "client"]


def test_a_call_that_takes_too_long_is_not_answered(world):
    client = world.connected()
    assert world.answer(client.call("save", timeout_s=0.0)) == UNANSWERED
    assert world.answer(client.call("act")).is_answered


def test_a_call_after_the_end_is_not_answered(world):
    client = world.connected()
    waiting = client.call("save")
    world.until(lambda: world.box.done)
    client.close()
    assert waiting.result(0) == UNANSWERED
    assert client.call("act").result(0) == UNANSWERED


# -- calls that a client offers -----------------------------------------------------------------------


def refuse(given, caller):
    raise Refused([LOW(robot="r1", number=2)])


OFFERED = {
    "pair": lambda given, caller: [given, caller], "no": refuse,
    "thread": lambda given, caller: InThread(lambda: threading.current_thread().name),
    "saved": lambda given, caller: Waiting(lambda: "the disk is full"),
    "broken": lambda given, caller: 1 / 0, "strange": lambda given, caller: {1},
    "long": lambda given, caller: "x" * 70000,
}


def offering(world, calls=OFFERED, **how):
    return world.client(offer=Offer(calls, "/offering"), **how)


def test_a_client_carries_out_what_it_offers(world):
    client, other = offering(world), world.connected(face="referee")
    world.until(lambda: not client.not_offered)
    given, caller = world.answer(other.call("pair", role="judge")).answer
    assert (given, Caller(*caller)) == ({"role": "judge"}, Caller("referee", HOST))
    assert world.answer(other.call("no")).reasons[0].values == {"robot": "r1", "number": 2}
    assert world.answer(other.call("thread")).answer != "client"
    saved = world.answer(other.call("saved"))
    assert (saved.reasons, saved.is_known) == (("the disk is full",), False)
    for name in ("broken", "strange"):
        assert "please report it" in world.answer(other.call(name)).reasons[0]
    assert "too long" in world.answer(other.call("long")).reasons[0]
    assert world.answer(client.call("pair")).answer[0] == {}, "also to itself"


@pytest.mark.parametrize("face", ["", HELPER])
def test_what_is_offered_is_offered_again_to_the_next_box(world, face):
    client, other = offering(world, face=face), world.connected()
    world.until(lambda: not client.not_offered)
    world.restart()
    while world.answer(other.call("pair", again=True, timeout_s=60.0)).reasons:
        world.running.turn()  # it is not offered yet
    assert world.answer(other.call("pair")).answer[0] == {}
    assert world.answer(client.call("act")).is_answered
    assert (client.document is None) == (face == HELPER), "whoever only helps is sent no document"


def test_a_second_one_knows_why_it_waits(world):
    first = offering(world)
    world.until(lambda: not first.not_offered)
    seen = threading.Event()
    second = offering(world, {"pair": lambda given, caller: 2},
                      on_change=lambda: seen.set() if "/offering at" in world.clients[1].not_offered else None)
    world.until(seen.is_set)
    assert second.not_offered == f"/offering at {HOST} offers pair already"
    first.close()
    world.until(lambda: not second.not_offered)
    assert world.answer(second.call("pair")).answer == 2


def test_a_client_in_a_loop_that_there_is_offers_calls(world):
    client = offering(world, loop=world.running.loop)
    world.until(lambda: not client.not_offered)
    assert world.answer(world.connected().call("pair")).answer[0] == {}


def test_stop_does_not_wait_for_one_that_hangs(world):
    held = threading.Event()
    client, other = offering(world, {"pair": lambda given, caller: held.wait(60)}), world.connected()
    world.until(lambda: not client.not_offered)
    waiting = other.call("pair", timeout_s=60.0)
    world.until(lambda: world.box.asked)
    assert world.answer(other.stop("Home", "run 1")).is_answered
    assert world.answer(other.call("act")).answer == {"count": 2}
    assert not waiting.done()
    held.set()
    assert world.answer(waiting).answer is True


def test_one_that_dies_is_not_waited_for(world):
    held = threading.Event()
    client, other = offering(world, {"pair": lambda given, caller: InThread(lambda: held.wait(60))}), world.connected()
    world.until(lambda: not client.not_offered)
    waiting = other.call("pair", timeout_s=60.0)
    world.until(lambda: world.box.asked)
    world.in_its_loop(client, world.link(client, "main").socket.close)
    assert NO_WEB in world.answer(waiting).reasons[0]
    held.set()


# -- STOP ---------------------------------------------------------------------------------------------


def stops(world):
    return [arguments for arguments, caller in world.box.done if caller.face == "stop"]


def test_stop_has_a_connection_of_its_own(world):
    client = world.connected()
    waiting = [client.call("save") for _ in range(3)]
    assert world.answer(client.stop("Home", "run 1", by="A. Referee")).answer is not None
    assert stops(world) == [{"zone": "Home", "run": "run 1", "by": "A. Referee"}]
    assert not any(future.done() for future in waiting)


def test_stop_opens_a_connection_if_there_is_none(world, monkeypatch):
    client = world.connected()
    link = world.link(client, "stop")
    world.in_its_loop(client, link.close)
    world.until(lambda: world.link(client, "stop") is None)
    assert world.answer(client.stop("Home", "run 1")).is_answered
    assert len(stops(world)) == 1 and world.link(client, "stop") is not link


def test_stop_takes_the_first_connection_if_its_own_is_silent(world, monkeypatch):
    monkeypatch.setattr(client_file, "STOP_S", 0.05)
    client = world.connected()
    carry_out = door.Door._carry_out
    monkeypatch.setattr(door.Door, "_carry_out", lambda self, request: None
                        if request.client.caller.face == "stop" else carry_out(self, request))
    assert world.answer(client.stop("Home", "run 1")).is_answered
    assert {caller.face for _, caller in world.box.done} == {""}  # sent again until its answer is there


def test_stop_is_sent_as_soon_as_there_is_a_box(world):
    world.box.door.close()
    client = world.client()
    stopping = client.stop("Home", "run 1", timeout_s=60.0)
    world.until(lambda: "check that it runs" in client.why)
    world.restart()
    assert world.answer(stopping).is_answered
    assert len(world.box.done) >= 1


def test_stop_looks_for_another_door_while_the_first_one_hangs(world, monkeypatch):
    monkeypatch.setattr(client_file, "STOP_S", 0.5)
    monkeypatch.setattr(client_file, "CONNECT_S", 60.0)
    with socket.socket() as listening:
        listening.bind((HOST, 0))
        listening.listen()
        places = [DoorPlace(f"ws://{HOST}:{listening.getsockname()[1]}/door", TOKEN)]
        world.find = lambda: places.pop() if places else world.box.place
        client = world.client()
        world.until(lambda: not places)
        assert world.answer(client.stop("Home", "run 1", timeout_s=60.0)).is_answered
        assert client.document is None and stops(world)


# -- what breaks --------------------------------------------------------------------------------------


def test_a_box_that_starts_again_elsewhere_is_found(world):
    client = world.connected()
    number = world.answer(client.call("act")).number
    yard = client.document.zones["Yard"]
    world.restart()
    world.until(lambda: count_of(client) == 0 and not client.why)
    assert client.document.zones["Yard"] is yard, "equal parts stay the same objects"
    assert client.is_confirmed(number), "the numbers of the new box are higher"
    world.restart(port=world.box.port)
    world.box.change(count=5)
    world.until(lambda: count_of(client) == 5)


def test_why_there_is_no_connection(world, monkeypatch):
    monkeypatch.setattr(client_file, "LAST_S", client_file.FIRST_S)

    def find():
        raise NotFound("start the box")

    right, world.find = world.find, find
    client = world.client()
    world.until(lambda: client.why == "start the box")
    world.find = lambda: DoorPlace(world.box.place.url, "wrong")
    world.until(lambda: "refuses this program, whose token is another one" in client.why)
    world.find = lambda: DoorPlace("ws://127.0.0.1:1/door", TOKEN)
    world.until(lambda: "no connection to the box at ws://127.0.0.1:1/door" in client.why)
    world.find = lambda: DoorPlace("nonsense", TOKEN)
    world.until(lambda: "no connection to the box at nonsense" in client.why)
    world.find = lambda: 1 / 0
    world.until(lambda: "no connection to the box (division by zero)" in client.why)
    assert client.document is None and client.is_old
    world.find = right
    world.until(lambda: client.document is not None)
    assert client.why == ""


def test_a_box_that_hangs_is_noticed(world, monkeypatch):
    monkeypatch.setattr(client_file, "OLD_S", 0.05)
    monkeypatch.setattr(client_file, "SILENT_S", 0.2)
    ended = threading.Event()
    client = world.connected(on_change=lambda: ended.set() if world.clients and world.clients[0].why else None)
    ended.clear()
    assert ended.wait(60), "the loop of the box does not run meanwhile"
    assert client.is_old and "silent" in client.why and client.silence_s > 0.05
    assert client.document == world.box.toy
    monkeypatch.setattr(client_file, "SILENT_S", 60.0)
    world.until(lambda: not client.why)


def test_a_server_that_accepts_and_says_nothing_is_left(world, monkeypatch):
    monkeypatch.setattr(client_file, "CONNECT_S", 0.05)
    with socket.socket() as listening:
        listening.bind((HOST, 0))
        listening.listen()
        world.find = lambda: DoorPlace(f"ws://{HOST}:{listening.getsockname()[1]}/door", TOKEN)
        client = world.client()
        world.until(lambda: "no connection to the box" in client.why)


@pytest.mark.parametrize("message", [
    "nonsense", "7", '{"mono": 1}', '{"mono": 1.0, "utc": 1.0, "rate": 1.0, "number": 1, "whole": {"box": 7}}',
])
def test_a_box_of_another_version_is_reported(world, message):
    class Other(websocket.WebSocketHandler):
        def open(self):
            self.write_message(message)

    asyncio.set_event_loop(world.running.loop)
    server, (listening,) = httpserver.HTTPServer(web.Application([("/door", Other)])), bind_sockets(0, HOST)
    server.add_sockets([listening])
    world.find = lambda: DoorPlace(f"ws://{HOST}:{listening.getsockname()[1]}/door", TOKEN)
    client = world.client()
    world.until(lambda: "is of another version than this program" in client.why)
    assert client.document is None and client.is_old
    server.stop()


def test_a_slow_client_gets_the_newest(world):
    client = world.connected()
    held, entered = threading.Event(), threading.Event()

    def hold():
        entered.set()
        held.wait(60)

    world.in_its_loop(client, hold)
    assert entered.wait(60)
    number = 0
    while not any(one.busy_since is not None for one in world.box.clients):
        number += 1
        world.box.change(log=f"{number} " * 50000)
    for _ in range(20):
        number += 1
        world.box.change(log=f"{number} " * 50000)
    held.set()
    world.until(lambda: client.document == world.box.toy)
    assert client.document.zones["Home"].log.startswith(f"{number} ")


def test_many_clients(world):
    clients = [world.client(loop=world.running.loop) for _ in range(40)]
    world.until(lambda: all(one.document is not None for one in clients))
    futures = [one.call("act", timeout_s=60.0) for one in clients]
    world.until(lambda: all(future.done() for future in futures))
    assert sorted(future.result().answer["count"] for future in futures) == list(range(1, 41))
    world.until(lambda: all(one.document == world.box.toy for one in clients))
    assert all(one.is_confirmed(future.result().number) for one, future in zip(clients, futures))


def test_one_too_many_waits_before_it_tries_again(world, monkeypatch):
    monkeypatch.setattr(door, "MAX_CLIENTS", 1)
    world.restart()
    first = world.client()
    world.until(lambda: first.document is not None)
    second = world.client()
    world.until(lambda: "too many clients" in first.why)
    world.until(lambda: second.document is not None)


def test_an_id_that_would_be_that_of_the_message_is_an_error(world):
    with pytest.raises(ValueError, match="the id of a mark goes into given"):
        world.client().call("act", action="mark", id="7")


def test_a_newer_box_may_say_more():
    assert client_file.answer_of({"id": 1, "number": 5, "answer": 7, "weather": "fine"}) == Answer(5, 7)


def message(mono, rate=1.0, **more):
    return {"mono": mono, "utc": mono + 1000.0, "rate": rate, **more}


@pytest.fixture
def followed(monkeypatch):
    """A client that takes messages at moments of the test's clock."""
    made = Client(Toy, lambda: None, loop=object())
    clock = [100.0]
    monkeypatch.setattr(client_file.time, "monotonic", lambda: clock[0])

    def take(at, sent, rate=1.0):
        clock[0] = at
        made._take(None, message(sent, rate), made._heard is None)

    made.take = take
    return made


def test_what_comes_late_is_old_when_it_comes(followed):
    followed.take(100.0, 5000.0)
    followed.take(100.5, 5000.5)
    assert not followed.is_old
    followed.take(103.0, 5001.0)  # on a link that has become slow
    assert followed.silence_s == pytest.approx(2.0, abs=0.01) and followed.is_old
    followed.take(104.0, 5003.9)
    assert not followed.is_old


def test_a_replay_that_stood_is_not_late(followed):
    followed.take(100.0, 5000.0)
    followed.take(101.0, 5001.0, rate=0.0)
    followed.take(150.0, 5001.0, rate=0.0)
    followed.take(150.5, 5001.5, rate=1.0)
    assert not followed.is_old
