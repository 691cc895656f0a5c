"""The tablet on the public channel: beside a box on the same address, and the tablet on the command line."""

import asyncio
import itertools
import os
import pathlib
import signal
import subprocess
import sys

import pytest

import roah_rsbb
from helpers.box_beacon import box_beacon
from helpers.small_box import free_ports
from roah_rsbb.comm.channels import Network, PublicChannel
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.tablet import dummy
from roah_rsbb.tablet.radio import NEVER, ShownTablet, TabletRadio

BROADCAST, BOX = "127.255.255.255", "127.0.0.1"


class OneBox:
    """A box that repeats the tablet's data if the test wants it."""

    def __init__(self, running, bind_host):
        self.port = free_ports()
        self.heard = []
        self.answers = False
        self.display_map = False
        self.channel = PublicChannel(
            running.loop, Network(BROADCAST, self.port, bind_host), self._hear, lambda text: None)
        self.channel.open()

    def beacon(self):
        never = pb.Time(sec=0, nsec=0)
        last = self.heard[-1] if self.heard else pb.TabletBeacon(last_call=never, last_pos=never, x=0.0, y=0.0)
        self.channel.send(box_beacon(
            tablet_display_map=self.display_map, tablet_call_time=last.last_call, tablet_position_time=last.last_pos,
            tablet_position_x=last.x, tablet_position_y=last.y,
        ))

    def _hear(self, message, _sender):
        if isinstance(message, pb.TabletBeacon):
            self.heard.append(message)
            if self.answers:
                self.beacon()


@pytest.fixture(params=[BOX, "0.0.0.0"])
def box(request, running):
    made = OneBox(running, request.param)
    made.host = request.param
    yield made
    made.channel.close()


@pytest.fixture
def tablet(running, box):
    """A radio at the box's own address, its state, and the effect of the box's beacons."""
    state = ShownTablet()
    news = []
    made = TabletRadio(running.loop, state, news.append, lambda text: None,
                       Network(BROADCAST, box.port, box.host))
    made.state, made.news = state, news
    made.open()
    yield made
    made.close()


def test_who_is_not_there_says_nothing(running, box, tablet):
    tablet.state.call(5)
    tablet.changed()
    running.turn()
    assert box.heard == []
    tablet.present = True
    running.until(lambda: box.heard)
    assert box.heard[0].last_call.nsec == 5


def test_a_touch_leaves_at_once_and_again_in_case_it_was_lost(running, box, tablet):
    tablet.present = True
    tablet.state.place(1_451_556_000_000_000_007, 1.5, -2.5)
    tablet.changed()
    running.until(lambda: [m for m in box.heard if m.last_pos.nsec == 7 and (m.x, m.y) == (1.5, -2.5)])
    seen = len(box.heard)
    running.until(lambda: len(box.heard) >= seen + 5)
    assert box.heard[-1].last_pos.sec == 1_451_556_000
    assert (box.heard[-1].last_call.sec, box.heard[-1].last_call.nsec) == NEVER


def test_the_box_is_heard_on_its_own_machine(running, box, tablet):
    box.display_map = True
    box.beacon()
    running.until(lambda: tablet.news)
    assert tablet.state.display_map is True
    assert tablet.state.hears_box(running.loop.time())


def test_the_box_acknowledges(running, box, tablet):
    box.answers = True
    tablet.present = True
    tablet.state.call(123)
    tablet.changed()
    running.until(lambda: tablet.state.call_is_acknowledged)
    assert not tablet.state.position_is_acknowledged


# -- on the command line ---------------------------------------------------------------------------------

class Started:
    """The program in a separate process."""

    def __init__(self, box, *arguments):
        folders = itertools.chain(roah_rsbb.__path__, [pathlib.Path(__file__).resolve().parents[3] / "src/roah_rsbb"])
        code = (f"import roah_rsbb; roah_rsbb.__path__ = {[str(f) for f in folders]!r}; "
                "from roah_rsbb.tablet.dummy import main; main()")
        source = str(pathlib.Path(__file__).resolve().parents[3] / "src")
        self.process = subprocess.Popen(
            [sys.executable, "-c", code, "--host", BROADCAST, "--port", str(box.port), *arguments],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True,
            env={**os.environ, "PYTHONPATH": source, "PYTHONUNBUFFERED": "1"},
        )

    async def end(self):
        while self.process.poll() is None:
            await asyncio.sleep(0.01)
        return self.process.returncode


@pytest.fixture
def start(box):
    """Start the program with these arguments, beside the box."""
    started = []

    def start_(*arguments):
        started.append(Started(box, *arguments))
        return started[-1]

    yield start_
    for program in started:
        program.process.kill()
        program.process.wait()
        program.process.stdin.close()
        program.process.stdout.close()


@pytest.mark.long
def test_dummy_calls_and_places_once(running, box, start):
    box.answers = True
    program = start("--call", "--position=-1.5,2", "--once", "__name:=x")
    assert running.do(program.end()) == 0
    last = box.heard[-1]
    assert last.last_call.sec > 1_700_000_000 and last.last_pos.sec > 1_700_000_000
    assert (last.x, last.y) == (-1.5, 2.0)


def test_dummy_does_what_is_typed_and_shows_the_requested_view(running, box, start):
    program = start()
    running.until(lambda: box.heard)
    program.process.stdin.write("call\n1.5 -2\nnonsense\n3,4\n")  # all at once
    program.process.stdin.flush()
    running.until(lambda: box.heard[-1].x == 3.0)
    assert box.heard[-1].last_call.sec > 0
    box.display_map = True
    box.beacon()
    running.turn()
    program.process.stdin.close()
    assert running.do(program.end()) == 0
    printed = program.process.stdout.read()
    assert "'nonsense' is not a position" in printed
    assert "the box requests the view: map" in printed
    assert "the box has published the call" in printed
    assert "the box has published the position" in printed


@pytest.mark.long
def test_dummy_ends_when_interrupted(running, box, start):
    program = start()
    running.until(lambda: box.heard)
    program.process.send_signal(signal.SIGINT)
    assert running.do(program.end()) == 0


def test_dummy_says_when_no_box_answers(running, box, monkeypatch, capsys):
    monkeypatch.setattr(dummy, "ANSWER_S", 0.1)
    with pytest.raises(SystemExit) as ended:
        dummy.main(["--host", BROADCAST, "--port", str(box.port), "--call", "--once"])
    assert ended.value.code == 1


@pytest.mark.parametrize("arguments", [["--position", "1"], ["--position", "nan,1"], ["--position", "a,b"], ["--what"]])
def test_dummy_says_what_is_wrong_with_its_arguments(arguments, capsys):
    with pytest.raises(SystemExit) as ended:
        dummy.main(arguments)
    assert ended.value.code == 2
    assert "dummy_tablet: " in capsys.readouterr().err


def test_dummy_says_where_it_cannot_hear_anybody():
    with pytest.raises(SystemExit, match="not a broadcast address"):
        dummy.main(["--host", "127.0.0.5"])
