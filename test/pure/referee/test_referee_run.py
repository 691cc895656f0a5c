"""Whole runs by script, in simulated time, against a core that the test plays."""

import functools

import pytest

from helpers.referee_box import EVENTS, ITEMS, NO_RUN, FakeLink
from roah_rsbb.model.reason import Refused
from roah_rsbb.referee.at_once import Exit, NoCore
from roah_rsbb.referee.run import RunScript, ScriptPlan
from roah_rsbb.referee.words import EventWanted, event_wanted

LOST_ROBOT = "STOP Home A: NO ANSWER FROM THE ROBOT. Stop it by hand. Trying again …\nmbot"
GONE, REFUSED, INTERRUPT = NoCore("gone"), Refused(["Skew"]), KeyboardInterrupt()


class Played(FakeLink):
    """A core of which a test says what happens when."""

    def vanish(self):
        """The zone is no longer in the schedule."""
        self.true_box = self.true_box._replace(zones={})

    def fall_silent(self):
        """Nothing is published any more; calls are answered."""
        self.silent = True

    def another_connects_instead(self, phase="running"):
        """Ours is disconnected, and another one connected and perhaps started, between two snapshots."""
        self.change(**NO_RUN)
        self.connect()
        self.change(phase=phase)

    def need_again(self):
        """The event is signed off."""
        self.signed_off = True
        self.change()

    @staticmethod
    def interrupt():
        """Ctrl-C."""
        raise KeyboardInterrupt


@pytest.fixture
def link():
    return Played()


def played(link, *acts, answers=None):
    """Plan acts, each (seconds, name of a method, its arguments, its named arguments)."""
    for seconds, name, *given in acts:
        named = given.pop() if given and isinstance(given[-1], dict) else {}
        act = functools.partial(getattr(link, name), *given, **named)
        if seconds:
            link.at(seconds, act)
        else:
            act()
    link.answers.update({command: list(found) for command, found in (answers or {}).items()})


def _run(link, **plan):
    """The outcome and all reports, as (kind, what) pairs."""
    reported = []
    outcome = RunScript(link, ScriptPlan(**{"zone": "Home A", "wait_s": 20.0, **plan}), reported.append).run()
    return outcome, [(c.kind, c.facts.get("text") or c.facts.get("phase") or c.facts.get("what")) for c in reported]


COMPLETED, TO_THE_END = (5, "end", "completed"), "connect start disconnect"
MOVING = {"phase": "ended", "not_stopped": ("mbot",)}


@pytest.mark.parametrize("acts, answers, plan, status, text, commands", [
    # A run that completes.
    ([COMPLETED], {}, {}, Exit.OK, "the run is completed", TO_THE_END),
    ([COMPLETED], {}, {"keep": True}, Exit.OK, "the run is completed; left connected", "connect start"),
    ([(0, "need_again"), COMPLETED], {}, {"again": True}, Exit.OK, "the run is completed", TO_THE_END),
    # It waits as long as it may, and leaves no run behind.
    ([(0, "block", "connect", "one", "two")], {}, {"wait_s": 3.0}, Exit.REFUSED, "refused: one; two", ""),
    ([(0, "block", "start", "Skew")], {}, {"wait_s": 3.0}, Exit.REFUSED, "refused: Skew", "connect disconnect"),
    ([(0, "need_again"), (0, "block", "connect", "No robot")], {}, {}, Exit.REFUSED,
     "refused: Signed off. Give --again for another attempt", ""),
    # Runs of other referees.
    ([(0, "change", {"phase": "running"})], {}, {}, Exit.REFUSED,
     "a run is in zone 'Home A' already (running): disconnect it first", ""),
    ([(0, "block", "connect", "No robot"), (2, "connect")], {}, {}, Exit.REFUSED,
     "another referee was quicker: zone 'Home A' is connected", ""),
    ([(0.2, "connect")], {"connect": [Refused(["Already connected"])]}, {}, Exit.REFUSED,
     "another referee was quicker: zone 'Home A' is connected", "connect"),
    ([(5, "another_connects_instead")], {}, {}, Exit.NOT_COMPLETED,
     "the run did not complete: another referee disconnected it", "connect start"),
    ([(5, "another_connects_instead"), (5, "end", "completed")], {}, {}, Exit.NOT_COMPLETED,
     "the run did not complete: another referee disconnected it", "connect start"),
    ([(0, "block", "start", "Skew"), (5, "another_connects_instead", "connected"), (7, "block", "start")], {}, {},
     Exit.NOT_COMPLETED, "the run did not complete: another referee disconnected it", "connect"),
    ([(0, "block", "start", "Skew"), (5, "change", NO_RUN)], {}, {}, Exit.NOT_COMPLETED,
     "the run did not complete: another referee disconnected it", "connect"),
    ([(5, "change", NO_RUN)], {}, {}, Exit.NOT_COMPLETED,
     "the run did not complete: another referee disconnected it", "connect start"),
    ([(5, "end", "stopped")], {}, {}, Exit.NOT_COMPLETED,
     "stopped by another referee, and left connected for that one", "connect start"),
    # After a connect without an answer, the run may be this script's: it is started, but not disconnected.
    ([(0.2, "connect"), COMPLETED], {"connect": [GONE]}, {}, Exit.NO_CORE,
     "the run is completed; left connected: the box did not confirm the connect, so the run may be another referee's",
     "connect start"),
    ([(5, "change", {**MOVING, "end_reason": "completed"}), (5.3, "change", {"phase": "running", "end_reason": ""})],
     {}, {}, Exit.OK, "the run is completed; left connected: run run 1 is running: stop it first", TO_THE_END),
    # Other ends.
    ([(5, "end", "timeout")], {}, {}, Exit.NOT_COMPLETED, "the run did not complete: timeout", TO_THE_END),
    ([(5, "end", "no_messages_saved")], {}, {}, Exit.NOT_COMPLETED, "the run did not complete: no data saved",
     TO_THE_END),
    ([(5, "end", "goals_timed_out")], {}, {}, Exit.NOT_COMPLETED, "the run did not complete: all goals timed out",
     TO_THE_END),
    ([(5, "vanish")], {}, {}, Exit.NOT_COMPLETED, "zone 'Home A' is no longer in the schedule", "connect start"),
    # A core that goes away.
    ([(5, "restart")], {}, {}, Exit.NOT_COMPLETED, "the run did not complete: it was lost when the box was restarted",
     "connect start"),
    ([(5, "restart", {"phase": "running", "identity": "run 9"})], {}, {}, Exit.NOT_COMPLETED,
     "the run did not complete: another referee disconnected it", "connect start"),
    ([(5, "change", {"phase": "connected"})], {}, {}, Exit.NOT_COMPLETED,
     "the run did not complete: it is connected again", TO_THE_END),
    ([(0, "block", "start", "Skew"), (5, "block", "connect", "No robot"), (5, "restart"), (7, "connect")], {}, {},
     Exit.REFUSED, "another referee was quicker: zone 'Home A' is connected", "connect"),
    ([(0, "block", "connect", "No robot"), (2, "restart"), (3, "block", "connect"), (6, "change", NO_RUN)], {}, {},
     Exit.NOT_COMPLETED, "the run did not complete: another referee disconnected it", "connect start"),
    ([(0.1, "block", "connect", "No robot")], {"connect": [GONE]}, {"wait_s": 4.0}, Exit.REFUSED, "refused: No robot",
     "connect"),
    ([COMPLETED, (6, "restart")], {"disconnect": [GONE]}, {}, Exit.OK, "the run is completed",
     f"{TO_THE_END} disconnect"),
    ([(5, "change", {**MOVING, "end_reason": "timeout"}), (5.1, "die")], {}, {}, Exit.NOT_COMPLETED,
     f"the run did not complete: timeout; left connected\n{LOST_ROBOT}", "connect start"),
    # An interrupt stops the run, and leaves it. What is on its way is awaited.
    ([(5, "interrupt")], {}, {}, Exit.INTERRUPTED, "interrupted, the run was stopped",
     "connect start stop_run disconnect"),
    ([(0, "block", "connect", "No robot"), (5, "interrupt")], {}, {}, Exit.INTERRUPTED, "interrupted", ""),
    ([(0, "block", "start", "Skew"), (5, "interrupt")], {}, {}, Exit.INTERRUPTED, "interrupted", "connect disconnect"),
    ([(0.5, "change", {"phase": "running"})], {"start": [INTERRUPT]}, {}, Exit.INTERRUPTED,
     "interrupted, the run was stopped", "connect start stop_run disconnect"),
    ([(5, "interrupt")], {"stop_run": [INTERRUPT]}, {}, Exit.INTERRUPTED,
     "interrupted twice: THE RUN MAY STILL BE RUNNING, check with 'referee status'", "connect start stop_run"),
    ([(5, "fall_silent"), (6, "interrupt")], {}, {}, Exit.INTERRUPTED, "interrupted, the run was stopped",
     "connect start stop_run disconnect"),
    # A run whose robot does not report STOP is not left: after the disconnect the box would not repeat it.
    ([(5, "change", {"not_stopped": ("mbot",)}), (5, "interrupt"), (5.9, "change", {"not_stopped": ()})], {}, {},
     Exit.INTERRUPTED, "interrupted, the run was stopped", "connect start stop_run disconnect"),
    ([(5, "change", {"not_stopped": ("mbot",)}), (5, "interrupt")], {}, {}, Exit.INTERRUPTED,
     f"interrupted, the run was stopped; left connected\n{LOST_ROBOT}", "connect start stop_run"),
    ([(5, "change", {**MOVING, "end_reason": "completed"})], {}, {}, Exit.NO_CORE,
     f"the run is completed; left connected\n{LOST_ROBOT}", "connect start"),
    ([(5, "change", {**MOVING, "end_reason": "timeout"})], {}, {}, Exit.NOT_COMPLETED,
     f"the run did not complete: timeout; left connected\n{LOST_ROBOT}", "connect start"),
    ([(5, "change", {**MOVING, "end_reason": "completed"}), (5.8, "change", {"not_stopped": ()})], {}, {}, Exit.OK,
     "the run is completed", TO_THE_END),
])
def test_how_a_run_ends(link, acts, answers, plan, status, text, commands):
    played(link, *acts, answers=answers)
    outcome, _ = _run(link, **plan)
    assert (outcome.status, outcome.text) == (status, text)
    assert " ".join(link.commands) == commands


def test_an_interrupt_while_the_connect_is_on_its_way_says_that_a_run_may_be_left(link):
    def act(*_arguments, **_more):
        link.connect()
        raise KeyboardInterrupt

    link.act = act
    outcome, _ = _run(link)
    assert (outcome.status, outcome.text, link.zone.phase) == (
        Exit.INTERRUPTED, "interrupted; left connected: the box did not confirm the connect, so the run may be "
        "another referee's", "connected")


@pytest.mark.parametrize("acts, answers, notes", [
    ([(0, "block", "connect", "No robot for 1 s"), (0, "block", "start", "Robot has not stopped"),
      (3, "block", "connect", "No robot for 2 s", "Skew"), (10, "block", "connect"), (25, "block", "start"),
      (30, "end", "completed")], {},
     ["waiting to connect: No robot for 1 s", "waiting to connect: Skew", "waiting to start: Robot has not stopped"]),
    ([COMPLETED], {"connect": [REFUSED, None]}, ["waiting to connect: Skew"]),  # although its button was on
    ([COMPLETED], {"connect": [GONE, None]}, ["waiting to connect: the box does not answer"]),
    ([COMPLETED], {"disconnect": [GONE, None]}, ["waiting to disconnect: gone"]),
])
def test_what_it_waits_for_is_reported_once(link, acts, answers, notes):
    played(link, *acts, answers=answers)
    outcome, reported = _run(link)
    assert (outcome.text, outcome.zone.end_reason, link.zone.phase) == ("the run is completed", "completed", "idle")
    assert [what for kind, what in reported if kind == "note"] == notes
    assert [what for kind, what in reported if kind == "state"] == ["connected", "running", "ended", "idle"]


@pytest.mark.parametrize("acts, answers, plan, status, text, at_least_s, at_most_s", [
    ([(0, "block", "connect", "one")], {}, {"wait_s": 3.0}, Exit.REFUSED, "refused: one", 3, 4),
    ([(0, "need_again")], {}, {}, Exit.REFUSED, "refused: Signed off. Give --again for another attempt", 0, 0),
    ([(3, "interrupt")], {"start": [REFUSED] * 100}, {}, Exit.INTERRUPTED, "interrupted", 3, 4),
    ([COMPLETED], {"disconnect": [GONE] * 100}, {}, Exit.NO_CORE,
     "the run is completed; it could not be disconnected: gone", 60, 70),
    ([(5, "fall_silent")], {}, {}, Exit.NO_CORE,
     "the box has been silent for 60 s: check the launch on the box's computer: THE RUN MAY STILL BE RUNNING, check "
     "with 'referee status'", 60, 70),
    ([(0, "die")], {}, {"wait_s": 4.0, "event": event_wanted("HGTKMH")}, Exit.NO_CORE,
     "gone: THE RUN MAY STILL BE RUNNING, check with 'referee status'", 4, 10),
])
def test_how_long_it_waits(link, acts, answers, plan, status, text, at_least_s, at_most_s):
    played(link, *acts, answers=answers)
    outcome, _ = _run(link, **plan)
    assert (outcome.status, outcome.text) == (status, text)
    assert at_least_s <= link.time <= at_most_s


def test_a_core_that_resumes_the_run_after_a_restart(link):
    played(link, (5, "die"), (15, "restart", {"phase": "running"}), (20, "end", "completed"))
    outcome, reported = _run(link)
    assert outcome.status is Exit.OK
    assert [what for kind, what in reported if kind == "core"] == ["silent", "back", "restarted"]


# -- scores ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("acts, answers, commands", [
    ([COMPLETED], {}, TO_THE_END),
    # A restart before the start loses nothing.
    ([(0, "block", "start", "Not yet"), (5, "restart"), (8, "block", "start"), (12, "end", "completed")], {},
     f"connect {TO_THE_END}"),
])
def test_scores_are_set_once_the_run_is_started(link, acts, answers, commands):
    played(link, *acts, answers=answers)
    outcome, reported = _run(link, scores=(("door", "yes"), ("2", "+3")))
    assert (outcome.status, " ".join(link.commands)) == (Exit.OK, commands)
    assert link.scores == {"Detects the door": 1, "Moved furniture": 3}
    assert [kind for kind, _ in reported].count("score") == 2
    assert [item.value for item in outcome.zone.items] == [1, 3, 0]


def test_scores_are_set_in_a_run_that_is_over_when_it_is_seen_for_the_first_time(link):
    played(link, (0.5, "end", "completed"), answers={"start": [GONE]})
    outcome, _ = _run(link, scores=(("door", "yes"),))
    assert (outcome.status, link.scores) == (Exit.OK, {"Detects the door": 1})


@pytest.mark.parametrize("score, status", [(("furniture", "1"), Exit.USAGE), (("door", "2"), Exit.REFUSED)])
def test_a_wrong_score_is_reported_before_anything_is_done(link, score, status):
    outcome, _ = _run(link, scores=(score,))
    assert (outcome.status, link.commands) == (status, [])


def test_a_score_that_cannot_be_set_does_not_end_the_run(link):
    played(link, COMPLETED, answers={"mark": [Refused(["no such item"])]})
    outcome, _ = _run(link, scores=(("door", "1"), ("moved", "2")))
    assert outcome.status is Exit.REFUSED
    assert "'Detects the door' = 1 failed: no such item" in outcome.text
    assert (link.scores, outcome.zone.end_reason) == ({"Moved furniture": 2}, "completed")


# -- events ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("start, wanted, event, chosen", [
    ("e1", "HGTKMH", "e1", []),
    ("e2", "HGTKMH", "e3", ["choose_event"]),
    ("e4", "HGTKMH", "e3", ["choose_event"]),
    ("e3", "HWV", "e2", ["choose_event"]),
    ("e1", "hgtkmh/1/3", "e3", ["choose_event"]),
])
def test_the_zone_is_moved_to_the_event(link, start, wanted, event, chosen):
    played(link, (0, "at_event", start), COMPLETED)
    outcome, _ = _run(link, event=event_wanted(wanted))
    assert outcome.zone.event.id == event
    assert link.commands == [*chosen, "connect", "start", "disconnect"]


@pytest.mark.parametrize("plan, status, text", [
    ({"event": event_wanted("STB")}, Exit.USAGE,
     "no event STB in zone 'Home A': there are HGTKMH/1/1, HWV/1/2, HGTKMH/1/3, HCFGAC/1/4"),
    ({"event": event_wanted("HCFGAC"), "scores": [("poured", "1")]}, Exit.USAGE,
     "no scoring item 'poured'; there are\n   1  Devices: Lights on"),
    ({"event": event_wanted("HGTKMH/1/3")}, Exit.REFUSED,
     "refused: HGTKMH/1/3 is signed off. Give --again for another attempt"),
])
def test_the_zone_stays_at_its_event_unless_all_that_was_typed_is_right(link, plan, status, text):
    link.signed.append("e3")
    link.sheets["e4"] = (ITEMS[0]._replace(group="Devices", desc="Lights on"),)
    played(link, (0, "at_event", "e2"))
    outcome, _ = _run(link, **plan)
    assert (outcome.status, outcome.text, link.commands) == (status, text, [])


def test_scores_are_those_of_the_event_to_which_the_zone_is_moved(link):
    link.sheets["e1"] = ()
    played(link, COMPLETED)
    outcome, _ = _run(link, event=event_wanted("HWV"), scores=(("door", "yes"),))
    assert (outcome.status, link.scores) == (Exit.OK, {"Detects the door": 1})


def test_another_attempt_at_an_event_that_is_signed_off(link):
    link.signed.append("e3")
    played(link, COMPLETED, (0, "at_event", "e2"))
    outcome, _ = _run(link, event=event_wanted("HGTKMH/1/3"), again=True)
    assert (outcome.status, outcome.zone.event.id) == (Exit.OK, "e3")


def test_a_restart_on_the_way_to_the_event_is_waited_out(link):
    played(link, (0.1, "die"), (9, "restart"), (20, "end", "completed"), answers={"choose_event": [NoCore("gone")]})
    outcome, reported = _run(link, event=event_wanted("HCFGAC"))
    assert (outcome.status, outcome.zone.event.code) == (Exit.OK, "HCFGAC")
    assert [what for kind, what in reported if kind == "note"] == ["waiting for the box: gone"]
    assert " ".join(link.commands) == f"choose_event choose_event {TO_THE_END}"


@pytest.mark.parametrize("acts", [
    [(0, "block", "connect", "No robot"), (2, "at_event", "e2"), (2, "block", "connect")],
    # After a restart, the core is at its first event. The later move is another referee's.
    [(0, "at_event", "e3"), (0, "block", "connect", "No robot"), (2, "restart"), (6, "at_event", "e2")],
])
def test_a_zone_that_another_referee_moves_is_not_connected(link, acts):
    played(link, *acts)
    outcome, _ = _run(link)
    assert (outcome.status, outcome.text) == (Exit.REFUSED, "another referee moved the zone to HWV/1/2")
    assert "connect" not in link.commands


def test_a_core_that_begins_at_its_first_event_again_is_moved_back(link):
    played(link, (0, "at_event", "e3"), (0, "block", "connect", "No robot"), (2, "die"), (8, "restart"),
           (9, "block", "connect"), (15, "end", "completed"))
    outcome, _ = _run(link)
    assert outcome.zone.event == EVENTS[2]
    assert " ".join(link.commands) == f"choose_event {TO_THE_END}"


def test_it_goes_to_an_event_of_a_team(link):
    teams = ("TestingTeam", "TestingTeam", "Beta", "TestingTeam")
    link.events = events = tuple(event._replace(team=team) for event, team in zip(EVENTS, teams))
    link.change(event=events[0])
    link.at(5, lambda: link.end("completed"))
    outcome, _ = _run(link, event=EventWanted(team="beta"))
    assert (outcome.status, outcome.zone.event) == (Exit.OK, events[2])
    outcome, _ = _run(link, event=EventWanted("HWV", team="Beta"))
    assert outcome.status is Exit.USAGE
    assert "no event HWV of team Beta in zone 'Home A': there are" in outcome.text
    assert "HGTKMH/1/3 of team Beta" in outcome.text


# -- STOP at the same terminal ------------------------------------------------------------------------


class Keys:
    """A keyboard on which STOP was typed, or not yet."""

    is_stopped = False
    is_terminal = True


def _typed(link, when):
    """The outcome of a run in whose terminal STOP is typed at this time: the core obeys it at once."""
    keys = Keys()

    def stop():
        keys.is_stopped = True
        link.stop_run("Home A", link.zone.identity)

    link.at(when, stop)
    return RunScript(link, ScriptPlan("Home A", 20.0), lambda change: None, keys).run()


def test_a_run_that_was_stopped_here_stays_connected(link):
    outcome = _typed(link, 5)
    assert (outcome.status, outcome.text) == (Exit.NOT_COMPLETED, "stopped, and left connected")
    assert link.zone.phase == "ended"


@pytest.mark.parametrize("command", ["connect", "start"])
def test_a_stop_before_the_start_ends_the_script(link, command):
    link.block(command, "not ready")
    outcome = _typed(link, 3)
    assert (outcome.status, outcome.text) == (Exit.NOT_COMPLETED, "stopped before the run began")
    assert "start" not in link.commands
    assert link.zone.phase == "idle"


def test_a_start_that_overtakes_the_stop_is_stopped(link):
    keys = Keys()
    start = link.change

    def change(**fields):
        keys.is_stopped = keys.is_stopped or fields.get("phase") == "running"
        start(**fields)

    link.change = change
    outcome = RunScript(link, ScriptPlan("Home A", 20.0), lambda change: None, keys).run()
    assert (outcome.text, link.commands) == ("stopped, and left connected", ["connect", "start", "stop_run"])
