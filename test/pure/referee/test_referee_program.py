"""The referee's program: its signals, its name in the records, its times, and a command."""

import signal
import types

import pytest

from helpers.referee_box import box, zone
from roah_rsbb.model.actions import UNSIGNED
from roah_rsbb.model.document import BoxSeen, Document, Public
from roah_rsbb.model.reason import Refused
from roah_rsbb.model.results import EventSeen
from roah_rsbb.referee import commands, program
from roah_rsbb.referee.link import Link, caller_name
from roah_rsbb.referee.terminal import Call
from roah_rsbb.wording.times import Moments, use_zone


def test_signals_that_come_together_are_one_wish(monkeypatch):
    """`timeout 10 rosrun … referee run` sends SIGTERM to the process and to its group. A second wish would leave a run
    whose robot moves."""
    mono = [100.0]
    monkeypatch.setattr(program.time, "monotonic", lambda: mono[0])
    interrupts = program.Interrupts()
    with pytest.raises(KeyboardInterrupt):
        interrupts(signal.SIGTERM, None)
    interrupts(signal.SIGTERM, None)
    mono[0] += 0.4
    interrupts(signal.SIGINT, None)
    mono[0] += 0.6
    with pytest.raises(KeyboardInterrupt):
        interrupts(signal.SIGINT, None)


def test_a_refused_choose_names_its_option():
    unsigned = UNSIGNED(code="HNF", team="Alpha", round=1, run=1)

    def act(*_arguments, **_more):
        raise Refused([unsigned])

    event = EventSeen("e1", 1, "Home", "HNF", "", "Alpha", 1, 1, 0.0, 0.0, "done", False)
    found = box(zone(zone="Home"))._replace(schedule={"e1": event})
    link = types.SimpleNamespace(box=found, act=act)
    options = types.SimpleNamespace(zone="Home", event=1, yes=True, unsigned=False, referee="")
    with pytest.raises(Refused) as refused:
        commands.COMMANDS["choose"].do(Call(link, options, None))
    assert refused.value.reasons == [unsigned, "Give --unsigned to leave it, or sign it off first ('sign-off')"]


def test_a_caller_has_a_name_that_ros_allows() -> None:
    assert caller_name("referee").startswith("/referee_")
    assert caller_name("référée")[1:].replace("_", "").isalnum() and caller_name("référée").isascii()


def test_times_are_those_of_the_venue(monkeypatch) -> None:
    for name, shown in (("Asia/Tokyo", "09:00:00 JST"), ("UTC", "00:00:00 UTC")):
        document = Document(BoxSeen("uuid", "", 0), {}, {}, {}, {}, {}, public=Public(time_zone=name))
        monkeypatch.setattr(Link, "document", document)
        monkeypatch.setattr(Link, "is_old", False)
        Link().open()
        assert Moments().with_zone(0.0) == shown
        assert Link().box is document
    use_zone("")
