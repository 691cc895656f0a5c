"""STOP in the terminal: how far it came, and that it waits for nothing but its own core."""

import threading

import pytest

from helpers.referee_box import box, running_zone, zone
from roah_rsbb.client.client import Answer
from roah_rsbb.referee.at_once import Exit, is_all
from roah_rsbb.referee.stopping import STOP_HINT, Keyboard, Stopping, ZoneStop
from roah_rsbb.referee.words import BadWord, stop_wanted

ENDED = {"phase": "ended", "end_reason": "stopped"}
LIMIT_S = 30.0  # for what comes, however busy the machine is


class StopCore:
    """A core of some zones, and the link to it."""

    node, referee, trouble = "/referee_1", "Olga", "no core: start it"

    def __init__(self, *zones):
        self.document = box(*zones)  # None: nothing is known of the box yet
        self.hidden = None  # what will be known then
        self.sent = []  # zones, as the calls arrived
        self.gates = {one.zone: threading.Event() for one in zones}  # cleared: the call for this zone hangs
        for gate in self.gates.values():
            gate.set()
        self.refuses = {}
        self.news = 0
        self._changed = threading.Condition()

    def hide(self):
        """Nothing is known of the box any more."""
        self.document, self.hidden = None, self.document

    def show(self):
        """It is known again."""
        if self.hidden is not None:
            self.document, self.hidden = self.hidden, None
            self.wake()

    @property
    def box(self):
        return self.document or self.hidden

    def change(self, name, **fields):
        """Change a zone."""
        changed = self.box._replace(zones={**self.box.zones, name: self.box.zones[name]._replace(**fields)})
        if self.document is None:
            self.hidden = changed
        else:
            self.document = changed
        self.wake()

    def obey(self, name):
        """Stop the run in a zone; returns the reasons why not."""
        if name not in self.box.zones:
            return (f"no zone {name}",)
        self.gates[name].wait(LIMIT_S)
        if name in self.refuses:
            return (self.refuses[name],)
        if self.box.zones[name].phase == "idle":
            return ("No run is connected",)
        if self.box.zones[name].phase == "running":
            self.change(name, **ENDED)
        return ()

    # -- the link ------------------------------------------------------------------------------------

    def stop(self, name, run, done, timeout_s, node, by):
        assert (run, node, by) == ("", self.node, self.referee), "the records have the referee's name"
        self.sent.append(name)
        threading.Thread(target=lambda: done(Answer(1, None, self.obey(name))), daemon=True).start()

    def wake(self):
        with self._changed:
            self.news += 1
            self._changed.notify_all()

    def wait_news(self, since, timeout_s):
        with self._changed:
            self._changed.wait_for(lambda: self.news != since, timeout_s)
            return self.news

    @staticmethod
    def is_confirmed(number):
        return number == 1


def _running(name, **fields):
    return running_zone(zone=name, **fields)


def _stop(core, word, own_zone=""):
    lines = []
    stopping = Stopping(core, word, lines.append, own_zone)
    stopping.run()
    return stopping, [(line.zone, line.way) for line in lines]


# -- words -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("line, word", [
    ("stop", ""), (" STOP! ", ""), ("stopp", ""), ("Stop all", "all"), ("stopp alle.", "alle"), ("stop --all", "--all"),
    ("stop  Home A\n", "Home A"), ("stop home a!!", "home a"), ("stop, all!", "all"),
    ("", None), ("st", None), ("stopped", None), ("stop-all", None), ("do not stop", None), ("yes", None),
])
def test_lines_that_stop(line, word):
    assert stop_wanted(line) == word


@pytest.mark.parametrize("word, names, expected", [
    ("all", ["Hall"], True), ("ALL", ["Hall"], True), ("alle", ["Allee"], True), ("--all", ["all", "--all"], True),
    ("all", ["All"], False), ("alle", ["all"], True), ("Alle", ["alle"], False), ("a", [], False), ("", [], False),
])
def test_words_for_all_zones(word, names, expected):
    assert is_all(word, names) is expected


# -- the way -----------------------------------------------------------------------------------------


def _followed(after=None, **state):
    one = ZoneStop("A", 100.0, _running("A"))
    for name, value in {"after": after, **state}.items():
        setattr(one, name, value)
    return one


@pytest.mark.parametrize("one, passed_s, expected, status", [
    (_followed(), 0.5, "sent", Exit.NO_CORE),
    (_followed(), 1.0, "lost_box", Exit.NO_CORE),
    (_followed(answered_s=100.1), 0.5, "at_box", Exit.NOT_COMPLETED),
    # The core publishes a robot's STOP later than a slow program has begun to listen: nothing is known of it yet.
    (_followed(answered_s=100.9), 1.8, "at_box", Exit.NOT_COMPLETED),
    (_followed(answered_s=100.9), 1.9, "lost_robot", Exit.NOT_COMPLETED),
    (_followed(_running("A", **ENDED)._replace(not_stopped=("r1",)), answered_s=100.9), 1.0, "lost_robot",
     Exit.NOT_COMPLETED),
    (_followed(_running("A", **ENDED)._replace(not_stopped=("r1",)), answered_s=100.1), 9.0, "lost_robot",
     Exit.NOT_COMPLETED),
    (_followed(_running("A"), answered_s=100.1), 9.0, "lost_robot", Exit.NOT_COMPLETED),  # it was started again
    (_followed(_running("A", **ENDED), answered_s=100.1), 9.0, "stopped", Exit.OK),
    (_followed(zone(zone="A", by_hand=True, **ENDED), answered_s=100.1), 9.0, "no_robot", Exit.OK),
])
def test_how_far_it_came(one, passed_s, expected, status):
    line = one.line(100.0 + passed_s)
    assert (line.zone, line.way, line.text.startswith("STOP A: ")) == ("A", expected, True)
    assert one.is_over is (status is Exit.OK)
    assert one.status() is status


@pytest.mark.parametrize("before, waits", [
    (_running("A"), True), (_running("A", by_hand=True), False), (None, False)])
def test_it_waits_for_a_robot_only_if_the_run_has_one(before, waits):
    text = _followed(before=before, answered_s=100.1).line(100.5).text
    assert ("Waiting for the robot" in text) is waits and "the box has it" in text


def test_robots_that_move_are_named_until_they_stop():
    one = _followed(_running("A", **ENDED)._replace(not_stopped=("r1", "r2")), answered_s=100.1)
    assert one.line(101.0).not_stopped == ("r1", "r2")
    one.after = _running("A", **ENDED)
    assert one.line(101.0).not_stopped == ()


def test_a_run_that_is_left_before_its_robot_has_stopped_is_not_forgotten():
    one, core = _followed(answered_s=100.1, number=1), StopCore(_running("A", **ENDED, not_stopped=("r1",)))
    one.look(core)
    core.document = box(zone(zone="A"))
    one.look(core)
    assert one.refused == ("the run was left before r1 answered STOP: stop by hand",)


# -- from the word to the robot ----------------------------------------------------------------------


@pytest.mark.parametrize("word, own_zone", [("Home A", ""), ("home", ""), ("", "Home A"), ("", "")])
def test_a_run_is_stopped(word, own_zone):
    core = StopCore(_running("Home A"), zone(zone="Kitchen"))
    stopping, lines = _stop(core, word, own_zone)
    assert lines[-1] == ("Home A", "stopped")
    assert core.box.zones["Home A"].phase == "ended"
    assert (stopping.status(), stopping.is_all) == (Exit.OK, False)


def test_all_runs_are_stopped_and_one_that_hangs_delays_no_other():
    core = StopCore(_running("A"), _running("B"), zone(zone="C"),
                    zone(zone="D", phase="connected", off={"stop": ["The run is not started"]}),
                    _running("E", **ENDED, not_stopped=("gone",)))
    core.gates["A"].clear()
    seen = []

    def report(line):
        seen.append((line.zone, line.way))
        if line == line._replace(zone="B", way="stopped"):
            core.gates["A"].set()

    stopping = Stopping(core, "all", report)
    stopping.run()
    assert [line for line in seen if line[1] == "stopped"] == [("B", "stopped"), ("A", "stopped")]
    assert {name for name, _ in seen} == {"A", "B"}, "the others have nothing to stop"
    assert sorted(set(core.sent)) == ["A", "B", "C", "D", "E"], "the core decides, whatever was shown before"
    assert stopping.status() is Exit.OK


def test_it_is_sent_although_nothing_is_published():
    core = StopCore(_running("A"))
    core.hide()
    lines = []

    def report(line):
        lines.append((line.zone, line.way, line.trouble))
        core.show()

    Stopping(core, "A", report).run()
    assert lines[0] == ("A", "lost_robot", "no core: start it"), "the box has it, but nobody knows of the robot"
    assert lines[-1] == ("A", "stopped", "")
    assert core.sent == ["A"], "at once; its answer counts when the zone is known"


@pytest.mark.parametrize("word, running, why", [
    ("Kitchen", "A", "no zone 'Kitchen'"), ("", "", "no runs are in progress"), ("", "AB", "2 runs are in progress"),
])
def test_a_word_that_names_no_zone_is_an_error(word, running, why):
    zones = [_running(name) if name in running else zone(zone=name) for name in "AB"]
    with pytest.raises(BadWord, match=why):
        _stop(StopCore(*zones), word)


def test_what_the_core_refuses_is_over():
    core = StopCore(_running("A"))
    core.refuses["A"] = "This box is superseded"
    stopping, _ = _stop(core, "A")
    assert (stopping.status(), stopping.result()[0].refused) == (Exit.REFUSED, ("This box is superseded",))


# -- at a prompt -------------------------------------------------------------------------------------


def test_typed_stops_wait_for_no_other():
    core = StopCore(_running("Home A"), _running("Home B"))
    core.gates["Home A"].clear()
    seen, notes = threading.Event(), []
    stops = Keyboard(core, lambda line: seen.set() if line.zone == "Home B" and line.way == "stopped" else None,
                       notes.append, "Home A")
    assert not stops.take("no") and not stops.is_stopped
    assert stops.take("stop home b") and not stops.is_stopped
    assert stops.take("stop") and stops.is_stopped
    assert seen.wait(LIMIT_S)
    assert core.box.zones["Home A"].phase == "running"
    core.gates["Home A"].set()
    stops.wait()
    assert core.box.zones["Home A"].phase == "ended"
    assert stops.take("stop nowhere")
    stops.wait()
    (note,) = notes
    assert note.startswith("NOT STOPPED: no zone 'nowhere'")


def test_a_program_that_ends_waits_for_a_stop_that_only_begins(monkeypatch):
    """A run ends by the STOP of another referee while one is typed."""
    core, begins, may_begin, ended = StopCore(_running("Home A")), threading.Event(), threading.Event(), []
    stops = Keyboard(core, lambda line: None, lambda text: None, "Home A")

    def start(thread, start=threading.Thread.start):
        if thread.name == "typed stop":
            begins.set()
            may_begin.wait(LIMIT_S)
        start(thread)

    def end():
        stops.wait()
        ended.append(core.box.zones["Home A"].phase)
    monkeypatch.setattr(threading.Thread, "start", start)
    typing, ending = threading.Thread(target=stops.take, args=["stop"]), threading.Thread(target=end)
    typing.start()
    assert begins.wait(LIMIT_S)
    ending.start()
    ending.join(0.3)  # what does not wait has ended by then
    may_begin.set()
    typing.join()
    ending.join()
    assert ended == ["ended"]


@pytest.mark.parametrize("line, with_answers, alone", [
    ("stpo", "NOT STOPPED: 'stpo' is", "NOT STOPPED: 'stpo' is"),
    (" sto arena\n", "NOT STOPPED: 'sto arena' is", "NOT STOPPED: 'sto arena' is"),
    ("stop-all", "NOT STOPPED: 'stop-all' is", "NOT STOPPED: 'stop-all' is"),
    ("start", "", "'start' is"), ("kitchen table", "", "'kitchen table' is"), ("\n", "", ""),
])
def test_a_line_that_is_no_stop_is_answered_if_nothing_else_reads_it_or_a_stop_was_probably_meant(
        line, with_answers, alone):
    for has_answers, begin in ((True, with_answers), (False, alone)):
        notes = []
        assert not Keyboard(StopCore(), None, notes.append, "Hall", has_answers).take(line)
        assert notes == ([f"{begin} no command: {STOP_HINT}"] if begin else [])


def test_a_run_that_its_program_stopped_first_is_shown_as_stopped():
    """A program stops its own run as soon as a STOP is typed, perhaps before the STOP has looked at the zones."""
    core = StopCore(_running("Home A"), _running("B"))
    lines = []
    stopping = Stopping(core, "all", lines.append, "Home A", core.document)
    core.obey("Home A")
    stopping.run()
    assert {line.zone for line in lines if line.way == "stopped"} == {"Home A", "B"}
    assert not [one for one in stopping.result() if one.refused]


@pytest.mark.parametrize("line, is_own", [("stop", True), ("stop all", True), ("stop home", True), ("stop B", False)])
def test_whether_the_programs_own_run_was_stopped(line, is_own):
    core = StopCore(_running("Home A"), _running("B"))
    stops = Keyboard(core, lambda line: None, lambda text: None, "Home A")
    stops.take(line)
    stops.wait()
    assert stops.is_stopped is is_own
    assert (core.box.zones["Home A"].phase == "ended") is is_own
