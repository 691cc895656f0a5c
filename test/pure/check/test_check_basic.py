"""The basic level of the check against the dummy robot, in simulated time."""

import asyncio

import pytest

from helpers.checked_robot import ROBOT, Checked, usual_robot
from helpers.faulty_robots import FAULTS, Fragile, ends_in_goal
from helpers.simulated_air import UTC0
from roah_rsbb.check.box import NetworkInUse
from roah_rsbb.check.engine import BUSY_S, Engine, scenarios_of
from roah_rsbb.check.report import Cause, Verdict
from roah_rsbb.check.scenarios import SCENARIOS, Depth
from roah_rsbb.comm import frame
from roah_rsbb.protocol import BoxState, RobotState
from roah_rsbb.radio import wire_convert
from roah_rsbb.robot.dummy import DummyOptions

BASIC = ["find", "beacon", "clock", "channel", "run", "stop-preparing", "stop-waiting", "stop-executing"]


def test_the_dummy_robot_passes_within_a_minute(monkeypatch):
    checked = Checked(monkeypatch, lambda loop: usual_robot(loop, DummyOptions(seed=1)))
    assert [(r.name, r.verdict, r.findings) for r in checked.engine.results] == [
        (name, Verdict.PASSED, []) for name in BASIC]
    assert checked.seconds < 60.0
    assert checked.shown == checked.engine.results


def test_each_reaction_to_stop_is_measured(monkeypatch):
    checked = Checked(monkeypatch)
    lines = [line for result in checked.engine.results for line in result.measured if line.startswith("STOP")]
    assert [line.split(":")[0] for line in lines] == [
        "STOP at the end of the run", "STOP in PREPARING", "STOP in WAITING_GOAL", "STOP in EXECUTING",
        "STOP at the end of the run"]
    assert all(0 < int(line.split()[-2]) < 20 for line in lines), lines


@pytest.mark.parametrize("name", ["find", "run"])
def test_without_a_robot_the_rest_is_skipped(monkeypatch, name):
    checked = Checked(monkeypatch, lambda loop: None)
    verdicts = {result.name: result.verdict for result in checked.engine.results}
    assert verdicts[name] is (Verdict.FAILED if name == "find" else Verdict.SKIPPED)
    assert checked.causes(Verdict.FAILED) == {Cause.NO_BEACON}


def verdicts(checked):
    """Scenario -> its verdict and cause."""
    return {result.name: (result.verdict, result.findings[0].cause) for result in checked.engine.results
            if result.findings}


def test_a_robot_whose_program_ends_is_not_tried_again_and_again(monkeypatch):
    checked = Checked(monkeypatch, lambda loop: Fragile(loop, ends_in_goal))
    assert verdicts(checked) == {
        "run": (Verdict.FAILED, Cause.SILENT), "stop-preparing": (Verdict.FAILED, Cause.NO_BEACON),
        "stop-waiting": (Verdict.SKIPPED, None), "stop-executing": (Verdict.SKIPPED, None)}


def test_a_robot_that_returns_is_checked_further(monkeypatch):
    checked = Checked(monkeypatch, lambda loop: Fragile(loop, ends_in_goal, returns_after=24.0))
    found = verdicts(checked)
    assert found["stop-preparing"] == (Verdict.FAILED, Cause.NO_BEACON)
    assert "stop-waiting" not in found and found["stop-executing"] == (Verdict.FAILED, Cause.SILENT)


def test_a_robot_that_never_answers_is_not_tried_again_and_again(monkeypatch):
    checked = Checked(monkeypatch, lambda loop: usual_robot(loop, password="another"))
    assert verdicts(checked) == {
        "channel": (Verdict.FAILED, Cause.WRONG_PASSWORD), "run": (Verdict.FAILED, Cause.WRONG_PASSWORD),
        **{name: (Verdict.SKIPPED, None) for name in BASIC[5:]}}


def test_an_interrupted_check_leaves_the_robot_stopped_and_keeps_its_results(monkeypatch):
    async def interrupt(play):
        while play.state is not RobotState.EXECUTING:
            await asyncio.sleep(0.1)
        engines[0].cancel()

    engines, ended, run = [], [], Engine.run

    async def noted(engine):
        engines.append(asyncio.current_task())
        ended.append(engine)
        await run(engine)

    monkeypatch.setattr(Engine, "run", noted)
    with pytest.raises(asyncio.CancelledError):
        Checked(monkeypatch, during=interrupt)
    (engine,) = ended
    assert [result.name for result in engine.results] == BASIC[:5]
    assert engine.results[-1].findings[-1].came == "The check was interrupted"
    assert engine.play.record.reports[-1].report.state is RobotState.STOP
    assert engine.play.record.states[-1].state is BoxState.STOP


def test_a_robot_is_not_blamed_for_a_busy_checker(monkeypatch):
    async def stall(play):
        while not any(said.state is BoxState.PREPARE for said in play.record.states):
            await asyncio.sleep(0.05)
        stop = play.press

        def press(command):
            stop(command)
            if command == "stop":
                play.loop.stall(2.0)  # the robot's STOP is read only after that

        play.press = press

    checked = Checked(monkeypatch, names=["stop-executing"], during=stall)
    assert checked.causes(Verdict.FAILED) == set()
    assert checked.causes(Verdict.UNJUDGED) == {Cause.STOP_LATE}
    assert "too busy to judge" in checked.findings[0].came


def test_short_stalls_over_a_long_time_excuse_nothing(monkeypatch):
    async def stall(play):
        while True:
            await asyncio.sleep(0.98)
            play.loop.stall(0.06)

    checked = Checked(monkeypatch, lambda loop: usual_robot(loop, DummyOptions(1.0, 2.0, never_end=True)),
                      names=["run"], during=stall)
    assert checked.play.stalls.since(checked.play.began) > BUSY_S
    assert checked.causes(Verdict.FAILED) == {Cause.NEVER_DONE} and checked.causes(Verdict.UNJUDGED) == set()


def test_the_check_does_not_run_beside_another_box(monkeypatch):
    async def other_box(play):
        beacon = frame.encode(wire_convert.beacon_message(play.box.box.beacon()))
        other = air(play).peer(play.loop, "127.255.255.255", 6666, lambda *_: None, print, bind_host="127.0.0.9")
        other.open()
        play.box.close()
        play.open(2.5)
        await asyncio.sleep(0.5)
        other.send(beacon, "127.255.255.255")

    def air(play):
        return play.network._make_peer.__self__

    with pytest.raises(NetworkInUse, match=r"127\.0\.0\.9.*: end that one, or give .* another public port"):
        Checked(monkeypatch, lambda loop: None, during=other_box)


def test_a_robot_that_is_also_sent_to_another_robot_of_the_team_is_found_by_name(monkeypatch):
    class Two:
        def __init__(self, loop):
            self._robots = [usual_robot(loop, robot="First", bind_host="127.0.0.8"),
                            usual_robot(loop, robot="Second", bind_host=ROBOT)]

        async def run(self):
            await asyncio.gather(*(robot.run() for robot in self._robots))

    checked = Checked(monkeypatch, Two, names=["run"], robot="Second")
    assert checked.findings == []
    assert {heard.host for heard in checked.play.record.reports} == {ROBOT}


def test_levels_and_names_of_scenarios():
    assert [one.name for one in scenarios_of(Depth.BASIC, ("HNF",))] == BASIC
    assert [one.name for one in scenarios_of(Depth.BASIC, ("HNF",), ["clock"])] == ["find", "clock"]
    names = [one.name for one in SCENARIOS]
    assert len(names) == len(set(names))


def test_the_simulation_begins_at_its_own_time(monkeypatch):
    assert abs(Checked(monkeypatch, names=["clock"]).play.box.now().utc - UTC0) < 10.0


# -- each fault of a robot is found, and its cause is named right -------------------------------------

@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.name.replace(" ", "-"))
def test_a_fault_is_found_and_named(monkeypatch, fault):
    checked = Checked(monkeypatch, lambda loop: fault.make(monkeypatch, loop), names=fault.scenarios,
                      **{"patience": 10.0, **dict(fault.given)})
    assert fault.cause in checked.causes(fault.verdict), checked.findings
    assert checked.causes(Verdict.FAILED) - {fault.cause, *fault.also} == set(), checked.findings


@pytest.mark.parametrize("names", sorted({fault.scenarios for fault in FAULTS}), ids=",".join)
def test_the_same_scenarios_find_nothing_in_a_robot_without_faults(monkeypatch, names):
    checked = Checked(monkeypatch, names=names)
    assert checked.findings == []


def test_a_fault_is_tried_for_each_cause():
    assert {fault.cause for fault in FAULTS} == set(Cause)
