"""The door of the box on real loopback sockets: the document, calls, STOP first, and its defences. The document is
made again when something happened, and once a second of the box's clock."""

import asyncio
import contextlib
import json
import socket
import stat
import time
import zlib

import pytest
from tornado import httpclient, websocket

from helpers.box_driver import BoxDriver
from helpers.running_loop import running
from helpers.toy_box import HOST, TOKEN, Bare, ToyBox
from helpers.toy_document import LOW
from roah_rsbb.box import door
from roah_rsbb.box.door import BoxDoor
from roah_rsbb.client.places import DoorPlace, NotFound, new_token, read_place, write_place
from roah_rsbb.core.views.document import Documents
from roah_rsbb.document.calls import Caller, InThread, Waiting
from roah_rsbb.ground.loop import call_in_loop
from roah_rsbb.model.reason import encode
from roah_rsbb.protocol import RobotState
from roah_rsbb.web import serving
from roah_rsbb.web.serving import DEFLATED_BYTES, ServeError, frame

__all__ = ["running"]


@pytest.fixture
def box(running):
    made = ToyBox(running)
    yield made
    made.disk.set()
    made.door.close()
    running.turn()


def silent(box, query=""):
    """A client that never reads."""
    client = socket.socket()
    client.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
    client.connect((HOST, box.port))
    client.sendall(f"GET /door{query} HTTP/1.1\r\nHost: {HOST}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                   f"Authorization: Bearer {TOKEN}\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n"
                   "Sec-WebSocket-Version: 13\r\n\r\n".encode())
    return client


# -- the document -------------------------------------------------------------------------------------


def test_the_whole_then_what_changes(box):
    client = Bare(box)
    whole = client.read()
    assert whole["whole"]["zones"]["Home"] == {"name": "Home"}
    assert whole["utc"] - whole["mono"] == pytest.approx(1000.0)
    box.change(count=7)
    change = client.read()
    assert change["changes"] == {"zones": {"Home": {"count": [7]}}}
    assert (change["since"], change["number"]) == (whole["number"], whole["number"] + 1)
    client.send(whole=True)
    assert client.read()["whole"]["zones"]["Home"] == {"name": "Home", "count": 7}


def test_signs_of_life_go_to_those_that_got_nothing(box):
    client = Bare(box)
    client.read()
    box.door.sign()  # the whole was sent meanwhile
    box.door.sign()
    assert set(client.read()) == {"mono", "utc", "rate"}
    box.change(count=1)
    box.door.sign()
    box.door.sign()
    assert "changes" in client.read()
    assert set(client.read()) == {"mono", "utc", "rate"}


def test_a_long_message_is_compressed_once_for_all(box):
    compressed = [Bare(box, compression_options={}) for _ in range(3)]
    plain = Bare(box)
    assert all("whole" in client.read() for client in (*compressed, plain))
    frame.cache_clear()
    for count in (1, 2):
        box.change(log="12:00:00Z a line of a log\n" * 1000, count=count)
        expected = {"log", "count"} if count == 1 else {"count"}
        assert all(set(client.read()["changes"]["zones"]["Home"]) == expected for client in (*compressed, plain))
    assert frame.cache_info().misses == 4
    for client in compressed:
        client.send(whole=True)
        assert len(client.read()["whole"]["zones"]["Home"]["log"]) == 26000
    compressed[0].send(id=1, call="act", text="x" * 2000)
    assert compressed[0].read_answer()["id"] == 1


def test_a_client_that_chooses_another_window_gets_plain_messages(box):
    client = Bare(box, headers={"Authorization": f"Bearer {TOKEN}",
                                "Sec-WebSocket-Extensions": "permessage-deflate; server_max_window_bits=9"})
    box.change(log="x" * 2000)
    client.read()
    assert [one._deflates for one in box.clients] == [False]


def test_what_is_compressed():
    text = "a" * (DEFLATED_BYTES + 1)
    data = frame(text, True)
    assert data[0] == 0xC1 and len(data) < 100
    assert zlib.decompressobj(-15).decompress(data[2:] + b"\0\0\xff\xff").decode() == text
    assert frame(text[:-1], True) == frame(text[:-1])


# -- calls --------------------------------------------------------------------------------------------


def test_the_change_is_sent_before_the_answer(box):
    client = Bare(box, "?face=referee")
    number = client.read()["number"]
    client.send(id=7, call="act", zone="Home")
    assert client.read()["changes"] == {"zones": {"Home": {"count": [1]}}}
    assert client.read() == {"id": 7, "number": number + 1, "answer": {"count": 1}}
    assert box.done == [({"zone": "Home"}, Caller("referee", HOST))]


def test_a_refusal_has_its_reasons(box):
    client = Bare(box)
    number = client.read()["number"]
    client.send(id="a", call="refuse")
    assert client.read() == {"id": "a", "number": number, "refused": [encode(LOW(robot="r1", number=1)), "typed"]}


def test_what_waits_for_the_disk_delays_no_other(box):
    slow, other = Bare(box), Bare(box)
    slow.send(id=1, call="save")
    slow.send(id=2, call="act")
    other.send(id=3, call="act")
    assert slow.read_answer()["id"] == 2
    assert other.read_answer()["id"] == 3
    box.disk.set()
    answer = slow.read_answer()
    assert (answer["id"], answer["answer"]) == (1, {"count": 1})


def test_what_is_not_on_the_disk_is_done_but_not_known(box):
    box.trouble = LOW(robot="disk", number=100)
    box.disk.set()
    client = Bare(box)
    client.send(id=1, call="save")
    answer = client.read_answer()
    assert (answer["refused"], answer["known"]) == ([encode(box.trouble)], False)
    assert len(box.done) == 1


@pytest.mark.parametrize("message", [
    "x", "[]", "7", "null", "{}", '{"id": 7}', '{"id": 7, "call": "unknown"}', '{"id": 7, "call": []}',
    '{"id": true, "call": "act"}', '{"call": "act"}', '{"id": {}, "call": "act"}', "[" * 60000, b"\xff\0",
])
def test_a_malformed_request_is_answered(box, message):
    client = Bare(box)
    box.running.do(client.connection.write_message(message, binary=isinstance(message, bytes)))
    assert client.read_answer()["error"]
    client.send(id=8, call="act")
    assert client.read_answer()["id"] == 8
    assert len(box.done) == 1


def test_a_call_that_fails_is_logged_once_and_answered(box, caplog):
    client = Bare(box)
    for number in range(3):
        client.send(id=number, call="break")
        assert "of a toy" in client.read_answer()["error"]
    assert [record.levelname for record in caplog.records] == ["ERROR"]
    box.door.add_calls({"save": lambda given, caller: Waiting(lambda: str(1 / 0)),
                        "strange": lambda given, caller: {1}})
    for name in ("save", "strange"):
        client.send(id=4, call=name)
        assert "error" in client.read_answer()
    assert len(caplog.records) == 3


def count_turns(box):
    """Count the turns of the loop, in the list that is returned."""
    turns = [0]

    def count():
        turns[0] += 1
        box.running.loop.call_soon(count)

    count()
    return turns


def test_each_turn_of_the_loop_carries_out_one_call_and_stop_comes_first(box):
    crowd = [Bare(box) for _ in range(5)]
    stopper = Bare(box, "?face=stop")
    order, turns = [], count_turns(box)
    box.door.add_calls({"act": lambda given, caller: order.append(turns[0]),
                        "stop": lambda given, caller: order.append("stop")})
    for client in crowd:
        for number in range(5):
            client.connection.write_message(json.dumps({"id": number, "call": "act"}))
    stopper.connection.write_message(json.dumps({"id": 1, "call": "stop"}))
    assert stopper.read()["id"] == 1
    for client in crowd:
        assert [client.read_answer()["id"] for _ in range(5)] == [0, 1, 2, 3, 4]
    in_turns = [turn for turn in order if turn != "stop"]
    assert len(in_turns) == len(set(in_turns)) == 25
    assert order.index("stop") < 15, "it did not wait for those before it"


def test_a_flood_of_one_client_is_read_one_message_in_a_turn(box):
    flooding = Bare(box)
    done, turns = [], count_turns(box)
    box.door.add_calls({"stop": lambda given, caller: done.append(turns[0])})
    for number in range(50):
        flooding.connection.write_message(json.dumps({"id": number, "call": "stop"}))
    box.running.until(lambda: len(done) == 50)
    assert len(set(done)) == 50


def test_a_client_is_read_on_only_when_a_thread_is_free(box, monkeypatch):
    monkeypatch.setattr(door, "MAX_THREADS", 1)
    client = Bare(box)
    for number in range(3):
        client.send(id=number, call="save")
    box.running.until(lambda: box.done)
    box.running.turn()
    assert len(box.done) == 1
    box.disk.set()
    assert [client.read_answer()["id"] for _ in range(3)] == [0, 1, 2]


# -- defences -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("headers", [
    {}, {"Authorization": "Bearer wrong"}, {"Authorization": f"Basic {TOKEN}"}, {"Authorization": "Bearer ü"},
    {"Authorization": f"Bearer {TOKEN}", "Origin": "http://localhost"},
    {"Authorization": f"Bearer {TOKEN}", "Sec-WebSocket-Origin": "http://localhost"},
])
def test_whoever_has_no_token_is_refused(box, headers):
    with pytest.raises(httpclient.HTTPClientError) as raised:
        Bare(box, headers=headers or {"X": "y"})
    assert raised.value.code == 403
    assert box.clients == []


def test_referees_have_places_of_their_own(box, monkeypatch):
    monkeypatch.setattr(door, "MAX_CLIENTS", 3)
    monkeypatch.setattr(door, "MAX_REFEREES", 2)
    box = ToyBox(box.running)
    others = [Bare(box) for _ in range(3)]
    referees = [Bare(box, "?face=referee") for _ in range(2)]
    stops = [Bare(box, "?face=stop") for _ in range(2)]
    assert len(box.clients) == 7
    late = Bare(box)
    assert "whole" in late.read()
    assert "whole" in others[0].read() and others[0].read() is None
    assert others[0].connection.close_code == 1013
    assert all("whole" in client.read() for client in (*others[1:], *referees))
    third = Bare(box, "?face=referee")
    assert "whole" in third.read() and others[1].read() is None
    box.door.sign()
    assert all(client.read() for client in stops)
    assert len(box.clients) == 7
    box.door.close()


def test_a_message_that_is_too_long_ends_its_client(box):
    client, other = Bare(box), Bare(box)
    client.send(id=1, call="act", text="x" * door.MAX_MESSAGE_BYTES)
    assert client.read_answer() is None
    other.send(id=1, call="act")
    assert other.read_answer()["id"] == 1
    assert len(box.done) == 1


def test_a_slow_client_delays_nobody_and_has_no_backlog(box, monkeypatch):
    slow, good = silent(box), Bare(box)
    box.running.until(lambda: len(box.clients) == 2)
    stuck = box.clients[0]
    number = 0
    while stuck.busy_since is None:
        number += 1
        box.change(log=f"{number} " * 50000)
    waiting = len(stuck.ws_connection.stream._write_buffer)
    for _ in range(5):
        number += 1
        box.change(log=f"{number} " * 50000)
    while f"{number} " not in json.dumps(good.read()):
        pass
    assert len(stuck.ws_connection.stream._write_buffer) <= waiting
    box.door.sign()
    assert stuck in box.clients
    monkeypatch.setattr(serving, "STUCK_S", -1.0)
    box.door.sign()
    assert stuck not in box.clients and len(box.clients) == 1
    slow.close()


def test_a_client_that_reads_no_answers_is_ended(box):
    slow = silent(box, "?face=stop")
    box.running.until(lambda: len(box.clients) == 1)
    (stuck,) = box.clients
    text = json.dumps({"id": 1, "answer": "x" * 50000})
    for _ in range(door.MAX_ANSWERS + 200):
        stuck.send(box.now(), text)
    assert box.clients == []
    slow.close()


# Empty frames that are no messages, masked with zeros (RFC 6455, 5.2).
PING, PONG, FRAGMENT = (bytes([first, 0x80, 0, 0, 0, 0]) for first in (0x89, 0x8A, 0x00))
FIRST_FRAGMENT = bytes([0x01, 0x80, 0, 0, 0, 0])


@pytest.mark.parametrize("flood", [PING, PONG, FRAGMENT], ids=["pings", "pongs", "fragments"])
def test_a_flood_of_frames_that_are_no_messages_is_read_one_in_a_turn(box, monkeypatch, flood):
    client = silent(box, "?face=stop")
    box.running.until(lambda: box.clients)
    loop, turn, read_in, receive = box.running.loop, [0], [], websocket.WebSocketProtocol13._receive_frame

    def next_turn():
        turn[0] += 1
        loop.call_soon(next_turn)

    async def counted(self):
        await receive(self)
        read_in.append(turn[0])

    monkeypatch.setattr(websocket.WebSocketProtocol13, "_receive_frame", counted)
    next_turn()
    client.sendall(FIRST_FRAGMENT + flood * 2000)
    box.running.until(lambda: len(read_in) > 1500)
    assert len(set(read_in)) == len(read_in)
    client.close()


def test_no_answers_to_pings_pile_up(box):
    client = silent(box, "?face=stop")
    box.running.until(lambda: box.clients)
    (stuck,) = box.clients
    client.setblocking(False)
    longest = bytes([0x89, 0x80 + 125, 0, 0, 0, 0]) + b"x" * 125
    while not stuck.ws_connection.stream.writing():
        with contextlib.suppress(BlockingIOError):
            client.send(longest * 100)
        box.running.turn()
    waiting = len(stuck.ws_connection.stream._write_buffer)
    for _ in range(100):
        stuck.ws_connection._handle_message(0x9, b"x" * 125)
    assert len(stuck.ws_connection.stream._write_buffer) <= waiting
    client.close()


def test_clients_that_go_free_their_places(box):
    gone = [Bare(box) for _ in range(3)]
    for client in gone:
        client.connection.close()
    box.running.until(lambda: not box.clients)


def test_everything_that_leaves_is_checked(box):
    checked = []
    box.door.check = lambda: checked.append(1)
    client = Bare(box)
    client.read()
    client.send(id=1, call="refuse")
    client.read_answer()
    assert len(checked) == 2


def test_a_port_in_use_is_reported_with_the_remedy(box):
    with pytest.raises(ServeError, match=f"cannot serve the door of the box on {HOST}:{box.port}: another program"):
        box.door.open(HOST, box.port)


# -- its file -----------------------------------------------------------------------------------------


def test_the_file_of_the_door_is_for_its_owner(tmp_path):
    path, token = tmp_path / "door.json", new_token()
    assert token != new_token() and len(token) > 30
    write_place(str(path), "ws://localhost:1/door", token)
    assert read_place(str(path)) == DoorPlace("ws://localhost:1/door", token)
    assert stat.S_IMODE(path.stat().st_mode) == 0o600


@pytest.mark.parametrize("content", [None, b"", b"[]", b"\xff", b'{"url": "x"}'])
def test_a_file_that_cannot_be_read_names_the_remedy(tmp_path, content):
    path = tmp_path / "door.json"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(NotFound, match="start the box"):
        read_place(str(path))


@pytest.fixture
def looks(monkeypatch):
    found, look = [], Documents.look

    def counted(documents, now, *others):
        found.append(now)
        return look(documents, now, *others)

    monkeypatch.setattr(Documents, "look", counted)
    return found


@pytest.fixture
def driver():
    return BoxDriver()


@pytest.fixture
def kept(driver):
    loop = asyncio.new_event_loop()
    made = BoxDoor(loop, driver.box, "uuid", "", lambda: driver.now, dict, tuple, {}, lambda: None)
    yield made
    made.close()
    loop.close()


def in_thread(loop, work):
    """Do it as `reload` does, after the document was published again."""
    def later():
        time.sleep(10 * door.CALLS_GAP_S)
        return call_in_loop(loop, work)

    return InThread(later)


@pytest.mark.parametrize("do", [pytest.param(lambda loop, work: work(), id="at once"), in_thread])
def test_an_answer_names_a_document_that_contains_what_the_call_did(running, driver, do):
    def work():
        driver.connected()
        return {}

    made = BoxDoor(running.loop, driver.box, "uuid", "", lambda: driver.now, dict, tuple,
                   {"act": lambda found, caller: do(running.loop, work)}, lambda: None)
    made.publish()
    answer = running.do(made.ask("act", {}, Caller("", "")))
    in_answer = made.written.number
    assert made.publish().zones["tbm"].is_on("disconnect")
    assert (answer["number"], made.written.number) == (in_answer, in_answer)
    made.close()


def test_making_the_document_leaves_most_of_the_time_to_others(running, driver, looks):
    """STOP waits while it is made, and many calls change the box all the time."""
    slow_s, began = 0.01, time.monotonic()
    made = BoxDoor(running.loop, driver.box, "uuid", "", lambda: driver.now, lambda: time.sleep(slow_s) or {}, tuple,
                   {}, lambda: None)
    while time.monotonic() - began < 30 * slow_s:
        driver.event(driver.box.timers.tick)
        made.called()
        running.turn_once()
    assert 1 < len(looks) <= 1 + (time.monotonic() - began) / (4 * slow_s)
    made.close()


def after(driver, looks, kept, act):
    """How often the box is looked at after this."""
    kept.publish()
    before = len(looks)
    act()
    for _ in range(3):
        kept.publish()
    return len(looks) - before


def test_a_robot_that_repeats_itself_is_no_reason_to_look(driver, kept, looks):
    robot = driver.executing()
    driver.jump(1.1 - driver.now.mono % 1.0)  # a second begins
    for _ in range(3):
        robot.says()

    def says_again():
        driver.jump(0.01)
        robot.send(robot.report())

    says_again()
    assert after(driver, looks, kept, says_again) == 0
    assert after(driver, looks, kept, lambda: driver.event(driver.box.timers.tick_if_due)) == 0
    assert after(driver, looks, kept, lambda: robot.says(messages_saved=7)) == 1
    assert after(driver, looks, kept, lambda: driver.event(driver.box.arrivals.on_unreadable, robot.port, "bad")) == 1
    assert after(driver, looks, kept, lambda: driver.command("stop")) == 1


def test_what_only_time_changes_is_looked_at_once_a_second_of_the_box(driver, kept, looks):
    driver.executing()
    assert after(driver, looks, kept, lambda: driver.jump(1.0)) == 1


def test_a_robot_that_ignores_stop_is_shown_at_once(driver, kept, looks):
    robot = driver.executing()
    driver.command("stop")
    robot.says(RobotState.EXECUTING)
    kept.publish()
    assert driver.box.timers.deadline() <= driver.now.mono + 1.0
    driver.run(1.0)
    assert any("did not answer STOP" in text for text in kept.publish().zones["tbm"].warnings)
