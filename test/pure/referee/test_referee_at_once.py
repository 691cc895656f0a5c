"""A STOP leaves before the rest of the terminal's program is imported."""

import subprocess
import sys

import pytest

from helpers.referee_box import box, running_zone, zone
from helpers.running_loop import running
from roah_rsbb.box.door import Door
from roah_rsbb.client.places import OWN_VARIABLE, write_place
from roah_rsbb.document.document import Written
from roah_rsbb.model.clock import Now
from roah_rsbb.model.document import Document
from roah_rsbb.model.reason import Refused, say
from roah_rsbb.referee.at_once import Exit, send_stop
from roah_rsbb.referee.stopping import Stopping

__all__ = ["running"]

ENDED = {"phase": "ended", "end_reason": "stopped"}
IDLE = say("No run is connected")


class StopBox:
    """The door of a box of some zones."""

    def __init__(self, running, *zones):
        self.running = running
        self.stopped = []
        self.document = box(*zones)
        self._written = Written(Document)
        self._written.update(self.document, self.now())
        self._door = Door(running.loop, "token", {"stop": self._stop}, self.now, self._written)
        self.url = f"ws://127.0.0.1:{self._door.open('127.0.0.1')}/door"
        self.close = self._door.close

    def now(self):
        return Now(self.running.loop.time(), 1000.0)

    def _stop(self, arguments, caller):
        name = arguments["zone"]
        self.stopped.append((name, arguments["run"], arguments["by"], caller.face))
        assert arguments["node"].startswith("/referee_"), "the records say which program it was"
        if self.document.zones[name].phase == "idle":
            raise Refused([IDLE])
        if self.document.zones[name].phase == "running":
            self.document = self.document._replace(
                zones={**self.document.zones, name: self.document.zones[name]._replace(**ENDED)})
            self._written.update(self.document, self.now())

    def send(self, *words):
        """What the program does first."""
        return self.running.do(self.running.loop.run_in_executor(None, send_stop, words, False))


@pytest.fixture
def stop_box(running, tmp_path, monkeypatch):
    """Two runs, a zone without one, and the file of the door."""
    made = StopBox(running, running_zone(zone="Home A"), running_zone(zone="Home B"), zone(zone="Kitchen"))
    path = tmp_path / "door.json"
    write_place(str(path), made.url, "token")
    monkeypatch.setenv(OWN_VARIABLE, str(path))
    yield made
    made.close()


class Link:
    """A link that shows the box as it is after the STOP."""

    node, referee, trouble, news = "/referee_1", "", "", 0

    def __init__(self, document):
        self.document = document

    def stop(self, *_arguments, **_more):
        raise AssertionError("it is sent once")

    @staticmethod
    def is_confirmed(number):
        return number > 0


def test_only_what_a_stop_needs_is_imported_before_it():
    """The other modules take ten times as long."""
    found = subprocess.run(
        [sys.executable, "-c", "import sys, roah_rsbb.referee.program\nprint(*sys.modules)"],
        stdout=subprocess.PIPE, text=True, check=True).stdout.split()
    assert {name for name in found if name.startswith("roah_rsbb.") and name.count(".") > 1} == {
        "roah_rsbb.client.places", "roah_rsbb.ground.arguments", "roah_rsbb.referee.at_once",
        "roah_rsbb.referee.program"}
    assert not {"tornado", "asyncio", "ssl", "subprocess", "xmlrpc", "logging"} & set(found)


@pytest.mark.parametrize("words, zones", [
    (["stop", "Home A"], ["Home A"]), (["--json", "stop", "home b", "__name:=x"], ["Home B"]),
    (["stop", "kit"], ["Kitchen"]), (["stop", "all"], ["Home A", "Home B", "Kitchen"]),
    (["stop", "--all", "--utc"], ["Home A", "Home B", "Kitchen"]),
])
def test_the_stop_is_sent(stop_box, words, zones):
    sent = stop_box.send(*words)
    assert stop_box.stopped == [(name, "", "", "referee") for name in zones]
    assert set(sent.answers) == set(zones)


@pytest.mark.parametrize("words", [
    [], ["stop"], ["stop", "Home"], ["stop", "Attic"], ["stop", "--help"], ["stop", "Home A", "--all"],
    ["start", "Home A"], ["stop", ""],
])
def test_other_words_than_a_plain_stop_are_left_to_the_rest(stop_box, words):
    assert stop_box.send(*words) is None
    assert stop_box.stopped == []


def test_a_door_that_is_not_there_is_left_to_the_rest(stop_box, tmp_path):
    stop_box.close()
    assert stop_box.send("stop", "all") is None
    for content in ("{}", "[]", '{"url": "ws://127.0.0.1:x/door", "token": ""}', '{"url": "", "token": ""}'):
        (tmp_path / "door.json").write_text(content)
        assert stop_box.send("stop", "all") is None


@pytest.mark.parametrize("word, stopped", [("all", ["Home A", "Home B"]), ("home a", ["Home A"])])
def test_the_rest_reports_it_and_sends_it_no_second_time(stop_box, word, stopped):
    sent, lines = stop_box.send("stop", word), []
    stopping = Stopping(Link(stop_box.document), word, lines.append, sent=sent)
    stopping.run()
    assert [line.zone for line in lines if line.way == "stopped"] == stopped
    assert stopping.status() is Exit.OK


def test_a_refusal_is_reported(stop_box):
    stopping = Stopping(Link(stop_box.document), "kitchen", print, sent=stop_box.send("stop", "kitchen"))
    stopping.run()
    assert (stopping.status(), stopping.result()[0].refused) == (Exit.REFUSED, (IDLE,))
