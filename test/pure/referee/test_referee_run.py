"""Whole runs by script, in simulated time, against a core that the test plays."""

import pytest

from helpers import referee_box
from helpers.referee_box import EVENTS, NO_RUN, FakeLink
from roah_rsbb.model.reason import Refused
from roah_rsbb.referee.at_once import Exit, NoCore
from roah_rsbb.referee.run import RunScript, ScriptPlan
from roah_rsbb.referee.words import EventWanted, event_wanted


@pytest.fixture
def link():
    return FakeLink()


def _run(link, **plan):
    """The outcome and all reports, as (kind, what) pairs."""
    reported = []
    outcome = RunScript(link, ScriptPlan(**{"zone": "Home A", "wait_s": 20.0, **plan}), reported.append).run()
    return outcome, [(c.kind, c.facts.get("text") or c.facts.get("phase") or c.facts.get("what")) for c in reported]


def _interrupt():
    raise KeyboardInterrupt


def test_a_run_from_connect_to_disconnect(link):
    link.at(5, lambda: link.end("completed"))
    outcome, reported = _run(link)
    assert (outcome.status, outcome.text) == (Exit.OK, "the run is completed")
    assert link.commands == ["connect", "start", "disconnect"]
    assert outcome.zone.end_reason == "completed"
    assert [what for kind, what in reported if kind == "state"] == ["connected", "running", "ended", "idle"]


def test_it_waits_for_connect_and_for_start_and_reports_each_reason_once(link):
    link.block("connect", "No robot for 1 s")
    link.block("start", "Robot has not stopped")
    link.at(3, lambda: link.block("connect", "No robot for 2 s", "Skew"))
    link.at(10, lambda: link.block("connect"))
    link.at(25, lambda: link.block("start"))
    link.at(30, lambda: link.end("completed"))
    outcome, reported = _run(link)
    assert outcome.status is Exit.OK
    assert [what for kind, what in reported if kind == "note"] == [
        "waiting to connect: No robot for 1 s", "waiting to connect: Skew", "waiting to start: Robot has not stopped",
    ]


def test_a_connect_that_stays_impossible_is_refused_with_every_reason(link):
    link.block("connect", "one", "two")
    outcome, _ = _run(link, wait_s=3.0)
    assert (outcome.status, outcome.text, outcome.zone) == (Exit.REFUSED, "refused: one; two", None)
    assert link.commands == []
    assert 3.0 <= link.time < 4.0


def test_an_event_that_is_signed_off_is_run_again_only_by_who_says_so(link):
    link.signed_off = True
    link.change()
    link.block("connect", "No robot")
    outcome, _ = _run(link)
    assert (outcome.status, outcome.text, link.commands, link.time) == (
        Exit.REFUSED, "refused: Signed off. Give --again for another attempt", [], 0.0)
    link.block("connect")
    link.at(5, lambda: link.end("completed"))
    outcome, _ = _run(link, again=True)
    assert (outcome.status, link.commands) == (Exit.OK, ["connect", "start", "disconnect"])


def test_a_start_that_stays_impossible_leaves_no_run_behind(link):
    link.block("start", "Skew")
    outcome, _ = _run(link, wait_s=3.0)
    assert (outcome.status, outcome.text) == (Exit.REFUSED, "refused: Skew")
    assert link.commands == ["connect", "disconnect"]


def test_a_refusal_although_the_button_was_on_is_waited_out(link):
    link.answers["connect"] = [Refused(["Skew"]), None]
    link.at(5, lambda: link.end("completed"))
    outcome, reported = _run(link)
    assert outcome.status is Exit.OK
    assert ("note", "waiting to connect: Skew") in reported
    assert link.commands[:2] == ["connect", "connect"]


def test_a_zone_with_a_run_is_left_alone(link):
    link.change(phase="running")
    outcome, _ = _run(link)
    assert outcome.status is Exit.REFUSED
    assert "already (running)" in outcome.text
    assert link.commands == []


def test_a_referee_who_connects_first_keeps_the_run(link):
    link.block("connect", "No robot")
    link.at(2, link.connect)
    outcome, _ = _run(link)
    assert outcome.status is Exit.REFUSED
    assert "another referee" in outcome.text
    assert link.commands == []


def test_a_referee_who_connects_at_the_same_moment_keeps_the_run(link):
    link.answers["connect"] = [Refused(["Already connected"])]
    link.at(0.2, link.connect)
    outcome, _ = _run(link)
    assert outcome.status is Exit.REFUSED
    assert "another referee" in outcome.text
    assert link.commands == ["connect"]


@pytest.mark.parametrize("reason, text", [
    ("timeout", "timeout"), ("no_messages_saved", "no data saved"), ("goals_timed_out", "all goals timed out"),
])
def test_a_run_that_ends_otherwise_did_not_complete(link, reason, text):
    link.at(5, lambda: link.end(reason))
    outcome, _ = _run(link)
    assert outcome.status is Exit.NOT_COMPLETED
    assert text in outcome.text
    assert link.commands[-1] == "disconnect"


def test_a_run_that_another_referee_stops_stays_for_that_one(link):
    link.at(5, lambda: link.end("stopped"))
    outcome, _ = _run(link)
    assert outcome.status is Exit.NOT_COMPLETED
    assert link.commands == ["connect", "start"]


@pytest.mark.parametrize("phase", ["connected", "running"])
def test_a_run_that_another_referee_disconnects_did_not_complete(link, phase):
    if phase == "connected":
        link.block("start", "Skew")
    link.at(5, lambda: link.change(**NO_RUN))
    outcome, _ = _run(link)
    assert (outcome.status, outcome.text) == (
        Exit.NOT_COMPLETED, "the run did not complete: another referee disconnected it")


def test_keep_stays_connected(link):
    link.at(5, lambda: link.end("completed"))
    outcome, _ = _run(link, keep=True)
    assert (outcome.status, outcome.text) == (Exit.OK, "the run is completed; left connected")
    assert link.commands == ["connect", "start"]


# -- scores ---------------------------------------------------------------------------------------


def test_scores_are_set_once_the_run_is_started(link):
    link.at(5, lambda: link.end("completed"))
    outcome, reported = _run(link, scores=(("door", "yes"), ("2", "+3")))
    assert outcome.status is Exit.OK
    assert link.scores == {"Detects the door": 1, "Moved furniture": 3}
    assert [kind for kind, _ in reported].count("score") == 2
    assert [item.value for item in outcome.zone.items] == [1, 3, 0]


@pytest.mark.parametrize("score, status", [(("furniture", "1"), Exit.USAGE), (("door", "2"), Exit.REFUSED)])
def test_a_wrong_score_is_reported_before_anything_is_done(link, score, status):
    outcome, _ = _run(link, scores=(score,))
    assert outcome.status is status
    assert link.commands == []


def test_a_score_that_cannot_be_set_does_not_end_the_run(link):
    link.answers["mark"] = [Refused(["no such item"])]
    link.at(5, lambda: link.end("completed"))
    outcome, _ = _run(link, scores=(("door", "1"), ("moved", "2")))
    assert outcome.status is Exit.REFUSED
    assert "'Detects the door' = 1 failed: no such item" in outcome.text
    assert link.scores == {"Moved furniture": 2}
    assert outcome.zone.end_reason == "completed"


# -- events ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("start, wanted, run, steps", [
    (0, "HGTKMH", 1, []),
    (1, "HGTKMH", 3, ["next"]),
    (3, "HGTKMH", 3, ["previous"]),
    (2, "HWV", 2, ["next", "previous", "previous"]),
    (0, "hgtkmh/1/3", 3, ["next", "next"]),
])
def test_the_zone_is_moved_to_the_event(link, start, wanted, run, steps):
    link.index = start
    link.change(event=EVENTS[start])
    link.at(5, lambda: link.end("completed"))
    outcome, _ = _run(link, event=event_wanted(wanted))
    assert outcome.zone.event.run == run
    assert link.commands == [*steps, "connect", "start", "disconnect"]


def test_an_event_that_is_not_there_leaves_the_zone_where_it_was(link):
    link.index = 1
    link.change(event=EVENTS[1])
    outcome, _ = _run(link, event=event_wanted("STB"))
    assert outcome.status is Exit.USAGE
    assert "no event STB" in outcome.text
    assert "HGTKMH/1/3" in outcome.text
    assert link.zone.event == EVENTS[1]
    assert "connect" not in link.commands


def test_a_restart_on_the_way_to_the_event_is_waited_out(link):
    link.answers["next"] = [None, NoCore("gone")]
    link.at(0.1, link.die)
    link.at(9, link.restart)
    link.at(20, lambda: link.end("completed"))
    outcome, reported = _run(link, event=event_wanted("HCFGAC"))
    assert outcome.status is Exit.OK
    assert outcome.zone.event.code == "HCFGAC"
    assert [what for kind, what in reported if kind == "note"] == ["waiting for the core: gone"]
    assert link.commands == ["next", "next", "next", "next", "next", "connect", "start", "disconnect"]


def test_a_zone_that_another_referee_moves_is_not_connected(link):
    link.block("connect", "No robot")
    link.at(2, lambda: link.change(event=EVENTS[1]))
    link.at(2, lambda: link.block("connect"))
    outcome, _ = _run(link)
    assert outcome.status is Exit.REFUSED
    assert "moved the zone to HWV/1/2" in outcome.text
    assert "connect" not in link.commands


def test_a_core_that_begins_at_its_first_event_again_is_moved_back(link):
    link.index = 2
    link.change(event=EVENTS[2])
    link.block("connect", "No robot")
    link.at(2, link.die)
    link.at(8, link.restart)
    link.at(9, lambda: link.block("connect"))
    link.at(15, lambda: link.end("completed"))
    outcome, _ = _run(link)
    assert outcome.zone.event == EVENTS[2]
    assert link.commands == ["next", "next", "connect", "start", "disconnect"]


def test_a_move_after_a_restart_is_another_referees(link):
    link.index = 2
    link.change(event=EVENTS[2])
    link.block("connect", "No robot")
    link.at(2, link.restart)
    link.at(6, lambda: link.change(event=EVENTS[1]))
    outcome, _ = _run(link)
    assert "moved the zone to HWV/1/2" in outcome.text


# -- a core that goes away ------------------------------------------------------------------------


def test_a_core_that_resumes_the_run_after_a_restart(link):
    link.at(5, link.die)
    link.at(15, lambda: link.restart(phase="running"))
    link.at(20, lambda: link.end("completed"))
    outcome, reported = _run(link)
    assert outcome.status is Exit.OK
    assert [what for kind, what in reported if kind == "core"] == ["silent", "back", "restarted"]


def test_a_core_that_lost_the_run_in_a_restart(link):
    link.at(5, link.restart)
    outcome, _ = _run(link)
    assert outcome.status is Exit.NOT_COMPLETED
    assert "lost when the core was restarted" in outcome.text


def test_a_restart_before_the_start_loses_nothing(link):
    link.block("start", "Robot has not answered")
    link.at(5, link.restart)
    link.at(8, lambda: link.block("start"))
    link.at(12, lambda: link.end("completed"))
    outcome, _ = _run(link, scores=(("door", "1"),))
    assert outcome.status is Exit.OK
    assert link.commands == ["connect", "connect", "start", "disconnect"]
    assert link.scores == {"Detects the door": 1}


def test_a_core_lost_during_the_command_is_awaited(link):
    link.answers["connect"] = [NoCore("gone"), None]
    link.at(5, lambda: link.end("completed"))
    outcome, reported = _run(link)
    assert outcome.status is Exit.OK
    assert ("note", "waiting to connect: the core does not answer") in reported


def test_a_core_that_stays_gone_before_connect_ends_it_as_such(link):
    link.die()
    outcome, _ = _run(link, wait_s=4.0, event=event_wanted("HGTKMH"))
    assert outcome.status is Exit.NO_CORE
    assert outcome.text.startswith("gone")


def test_a_core_that_was_gone_and_then_refuses_is_a_refusal(link):
    link.answers["connect"] = [NoCore("gone")]
    link.at(0.1, lambda: link.block("connect", "No robot"))
    outcome, _ = _run(link, wait_s=4.0)
    assert (outcome.status, outcome.text) == (Exit.REFUSED, "refused: No robot")


@pytest.mark.parametrize("answers", [[None], [NoCore("gone"), None]])
def test_a_core_lost_during_the_disconnect_is_awaited(link, answers):
    link.answers["disconnect"] = answers
    link.at(5, lambda: link.end("completed"))
    outcome, reported = _run(link)
    assert (outcome.status, outcome.text, link.zone.phase) == (Exit.OK, "the run is completed", "idle")
    assert (("note", "waiting to disconnect: gone") in reported) == (len(link.commands) == 4)


def test_a_core_that_disconnected_before_it_could_answer(link):
    link.answers["disconnect"] = [NoCore("gone")]
    link.at(5, lambda: link.end("completed"))
    link.at(6, link.restart)
    outcome, _ = _run(link)
    assert (outcome.status, outcome.text) == (Exit.OK, "the run is completed")


def test_a_run_that_could_not_be_disconnected_is_a_failure(link):
    link.answers["disconnect"] = [NoCore("gone")] * 100
    link.at(5, lambda: link.end("completed"))
    outcome, _ = _run(link)
    assert outcome.status is Exit.NO_CORE
    assert outcome.text == "the run is completed; it could not be disconnected: gone"
    assert 60 <= link.time < 70


def test_a_restart_while_waiting_is_not_blamed_for_what_a_referee_does_later(link):
    link.block("connect", "No robot")
    link.at(2, link.restart)
    link.at(3, lambda: link.block("connect"))
    link.at(6, lambda: link.change(**NO_RUN))
    assert "another referee disconnected it" in _run(link)[0].text


def test_a_core_that_stays_silent_ends_it_and_the_referee_is_warned(link):
    link.at(5, lambda: setattr(link, "silent", True))
    outcome, _ = _run(link)
    assert outcome.status is Exit.NO_CORE
    assert "THE RUN MAY STILL BE RUNNING" in outcome.text
    assert 60 <= link.time < 70


def test_a_zone_that_is_no_longer_in_the_schedule(link):
    link.at(5, lambda: setattr(link, "true_box", link.true_box._replace(zones={})))
    outcome, _ = _run(link)
    assert outcome.status is Exit.NOT_COMPLETED
    assert "schedule" in outcome.text


# -- Ctrl-C ---------------------------------------------------------------------------------------


def test_an_interrupt_stops_the_run_and_leaves_it(link):
    link.at(5, _interrupt)
    outcome, _ = _run(link)
    assert (outcome.status, outcome.text) == (Exit.INTERRUPTED, "interrupted, the run was stopped")
    assert link.commands == ["connect", "start", "stop_run", "disconnect"]
    assert outcome.zone.end_reason == "stopped"


def test_an_interrupt_before_the_start_disconnects(link):
    link.block("start", "Skew")
    link.at(5, _interrupt)
    outcome, _ = _run(link)
    assert outcome.status is Exit.INTERRUPTED
    assert link.commands == ["connect", "disconnect"]


def test_an_interrupt_while_the_start_is_on_its_way_stops_what_it_starts(link):
    """The core carries the start out after the program was interrupted, which got no answer."""
    link.answers["start"] = [KeyboardInterrupt()]
    link.at(0.5, lambda: link.change(phase="running"))
    outcome, _ = _run(link)
    assert (outcome.status, outcome.text) == (Exit.INTERRUPTED, "interrupted, the run was stopped")
    assert link.commands == ["connect", "start", "stop_run", "disconnect"]
    assert outcome.zone.end_reason == "stopped"


def test_an_interrupt_after_a_refused_start_waits_for_nothing(link):
    link.answers["start"] = [Refused(["Skew"])] * 100
    link.at(3, _interrupt)
    outcome, _ = _run(link)
    assert (outcome.status, outcome.text) == (Exit.INTERRUPTED, "interrupted")
    assert link.commands[-1] == "disconnect"
    assert link.time < 4.0


def test_an_interrupt_before_connect_changes_nothing(link):
    link.block("connect", "No robot")
    link.at(5, _interrupt)
    outcome, _ = _run(link)
    assert outcome.status is Exit.INTERRUPTED
    assert link.commands == []


def test_an_interrupt_while_the_core_is_silent_still_tries_to_stop(link):
    link.at(5, lambda: setattr(link, "silent", True))
    link.at(6, _interrupt)
    outcome, _ = _run(link)
    assert outcome.status is Exit.INTERRUPTED
    assert "stop_run" in link.commands


def test_a_second_interrupt_leaves_at_once_and_warns(link):
    link.at(5, _interrupt)
    link.answers["stop_run"] = [KeyboardInterrupt()]
    outcome, _ = _run(link)
    assert outcome.status is Exit.INTERRUPTED
    assert "THE RUN MAY STILL BE RUNNING" in outcome.text
    assert link.commands == ["connect", "start", "stop_run"]


# -- only its own run -----------------------------------------------------------------------------


def test_the_run_of_another_referee_is_not_disconnected(link):
    """Ours is disconnected, and another one connected and started, between two snapshots."""
    link.at(5, lambda: (link.change(**NO_RUN), link.connect(), link.change(phase="running")))
    outcome, _ = _run(link)
    assert (outcome.status, outcome.text) == (
        Exit.NOT_COMPLETED, "the run did not complete: another referee disconnected it")
    assert link.commands == ["connect", "start"]
    assert link.zone.phase == "running"


def test_a_connect_that_was_carried_out_but_not_answered(link):
    """The run may be this script's: it is started, but not disconnected."""
    link.answers["connect"] = [NoCore("gone")]
    link.at(0.2, link.connect)
    link.at(5, lambda: link.end("completed"))
    outcome, _ = _run(link)
    assert outcome.status is Exit.NO_CORE
    assert "left connected: the core did not confirm the connect" in outcome.text
    assert link.commands == ["connect", "start"]


def test_a_run_that_another_referee_started_again_is_not_disconnected(link):
    link.at(5, lambda: link.change(phase="ended", end_reason="completed", not_stopped=("mbot",)))
    link.at(5.3, lambda: link.change(phase="running", end_reason=""))
    outcome, _ = _run(link)
    assert link.zone.phase == "running"
    assert "left connected: run run 1 is running" in outcome.text


def test_the_last_event_of_a_zone(link):
    """After the move the buttons are those of the new event."""
    link.at(15, lambda: link.end("completed"))
    outcome, _ = _run(link, event=event_wanted("STB"))
    assert outcome.status is Exit.USAGE
    assert "no event STB" in outcome.text
    assert link.zone.event == EVENTS[0]


def test_it_connects_the_chosen_robot(link):
    link.at(5, lambda: link.end("completed"))
    outcome, _ = _run(link, robot="b2")
    assert (outcome.status, outcome.zone.robot_name) == (Exit.OK, "b2")


def test_it_goes_to_an_event_of_a_team(link, monkeypatch):
    teams = ("TestingTeam", "TestingTeam", "Beta", "TestingTeam")
    events = tuple(event._replace(team=team) for event, team in zip(EVENTS, teams))
    monkeypatch.setattr(referee_box, "EVENTS", events)
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


def test_an_interrupted_run_is_left_when_its_robot_has_stopped(link):
    link.at(5, lambda: link.change(not_stopped=("mbot",)))
    link.at(5, _interrupt)
    link.at(5.9, lambda: link.change(not_stopped=()))
    outcome, _ = _run(link)
    assert (outcome.status, outcome.text) == (Exit.INTERRUPTED, "interrupted, the run was stopped")
    assert link.commands[-2:] == ["stop_run", "disconnect"]


def test_an_interrupted_run_whose_robot_does_not_stop_stays_connected(link):
    """After a disconnect the box would no longer repeat STOP."""
    link.at(5, lambda: link.change(not_stopped=("mbot",)))
    link.at(5, _interrupt)
    outcome, _ = _run(link)
    assert outcome.status is Exit.INTERRUPTED
    assert outcome.text.split("\n") == [
        "interrupted, the run was stopped; left connected",
        "STOP Home A: NO ANSWER FROM THE ROBOT. Stop it by hand. Trying again …", "mbot"]
    assert link.commands[-1] == "stop_run"


@pytest.mark.parametrize("reason, text, status", [
    ("completed", "the run is completed", Exit.NO_CORE),
    ("timeout", "the run did not complete: timeout", Exit.NOT_COMPLETED),
])
def test_a_run_that_ended_by_itself_and_whose_robot_does_not_stop_stays_connected(link, reason, text, status):
    link.at(5, lambda: link.change(phase="ended", end_reason=reason, not_stopped=("mbot",)))
    outcome, _ = _run(link)
    assert outcome.text.split("\n") == [
        f"{text}; left connected",
        "STOP Home A: NO ANSWER FROM THE ROBOT. Stop it by hand. Trying again …", "mbot"]
    assert (outcome.status, link.commands[-1]) == (status, "start")


def test_a_run_that_ended_by_itself_is_left_when_its_robot_has_stopped(link):
    link.at(5, lambda: link.change(phase="ended", end_reason="completed", not_stopped=("mbot",)))
    link.at(5.8, lambda: link.change(not_stopped=()))
    outcome, _ = _run(link)
    assert (outcome.status, outcome.text, link.commands[-1]) == (Exit.OK, "the run is completed", "disconnect")


def test_a_core_that_falls_silent_while_its_robot_stops_does_not_end_the_script_with_a_fault(link):
    link.at(5, lambda: link.change(phase="ended", end_reason="timeout", not_stopped=("mbot",)))
    link.at(5.1, link.die)
    outcome, _ = _run(link)
    assert (outcome.status, link.commands[-1]) == (Exit.NOT_COMPLETED, "start")
