"""Every benchmark completes, with the right states, strings and scores, however bad the network is."""

import contextlib
import pathlib
import sys
from typing import Dict, Iterator, List

import expected
import lateness
import troubles
import wire
from crew import RSBB_PORT
from net import FLOODER, FORGER, STRANGER, Net, Round
from rounds import Plan
from support.programs import Program
from support.waiting import wait_until

from box import SPEECH, TEAMS
from referee import Result
from roah_rsbb.protocol import BoxState

FLOOD = pathlib.Path(__file__).resolve().parent / "flood.py"
FLOOD_RATE, FLOOD_S = 10000, 8
# Without a goal, with explicit ones of both generations.
FLOODED = ["HWV", "HNF", "STB"]


def test_round(net: Net, plan: Plan, measured: List[str]) -> None:
    """Each benchmark once, at the same time, and then the one with all robots."""
    net.impair(wire.BAD)
    for code in plan.lossless:
        net.lan.wire(net.numbers[code]).how = wire.BAD._replace(loss=0.0)
    with _forger(net, plan), Round(net, list(TEAMS)) as played:
        with contextlib.ExitStack() as around:
            if plan.strangers:
                played.when_connected = lambda: around.enter_context(
                    troubles.strangers(net.lan.stations[STRANGER], list(TEAMS.values())))
            results = played.conduct(plan.troubles)
        faults = _faults(played, results) + _speech_faults(played) + _tablet_faults(played)
        measured.append(f"{plan.name}: {_lateness(played, results)}")
        measured.extend(_overtaken(played))
    assert not faults, "\n".join(faults)


@contextlib.contextmanager
def _forger(net: Net, plan: Plan) -> Iterator[None]:
    """Somebody forges the robots' beacons, and the box hears that first."""
    if not plan.strangers:
        yield
        return
    teams = list(TEAMS.values())
    with troubles.forged_robots(net.lan.stations[FORGER], teams):
        wait_until(lambda: {robot.team for robot in net.box.document.robots.values()} >= set(teams), "all are forged")
        yield


def test_flood(net: Net, measured: List[str]) -> None:
    """Garbage arrives on the public port and on a private one, and the runs continue."""
    net.impair(wire.PERFECT)
    with Round(net, FLOODED) as played:
        with contextlib.ExitStack() as around:
            played.when_connected = lambda: around.enter_context(_flood(net, measured))
            results = played.conduct({})
        faults = _faults(played, results)
        measured.append(f"flood: {_lateness(played, results)}")
    assert not faults, "\n".join(faults)


@contextlib.contextmanager
def _flood(net: Net, measured: List[str]) -> Iterator[None]:
    ports = [str(RSBB_PORT), str(net.box.zone_details("HNF").port)]
    program = net.lan.stations[FLOODER].host.do(
        Program, sys.executable, str(FLOOD), str(net.seed), str(FLOOD_RATE), str(FLOOD_S), net.lan.box, *ports)
    before = net.box.core_used()
    try:
        yield
        program.wait_ended()
        used = net.box.core_used().percent_since(before)
        measured.append(f"flood: {program.text}; meanwhile the core took {used:.0f} % of a processor")
    finally:
        program.close()


def _faults(played: Round, results: Dict[str, Result]) -> List[str]:
    return [fault for code, result in results.items()
            for fault in expected.faults(result, played.robots[code], played.reboots[code])]


def _lateness(played: Round, results: Dict[str, Result]) -> str:
    return lateness.summary([
        late for code, result in results.items()
        for late in lateness.of_run(result, played.robots[code], played.outages[code])])


def _speech_faults(played: Round) -> List[str]:
    """The run of all robots at once."""
    result = played.speech()
    faults = [] if result.end_reason == "completed" else [f"{SPEECH}: {result.end_reason}"]
    if len(result.logs) != len(played.robots):
        faults.append(f"{SPEECH}: {len(result.logs)} logs of {len(played.robots)} robots")
    should, left_out = [int(state) for state in expected.box_states(SPEECH)], [int(BoxState.STOP)]
    states = [result.values(expected.BOX_STATES, number) for number in range(len(result.logs))]
    faults += [f"{SPEECH}: {[BoxState(state).name for state in wrong]}" for wrong in states
               if wrong not in (should, left_out)]
    if states.count(left_out) > result.left_out:
        faults.append(f"{SPEECH}: {states.count(left_out)} robots did not run, but {result.left_out} were left out")
    return faults


def _tablet_faults(played: Round) -> List[str]:
    """Each robot heard once that somebody touched the tablet."""
    heard = {code: len(robot.did("call")) for code, robot in played.robots.items()}
    return [f"{code}: its robot heard {times} calls of the tablet, there was one" for code, times in heard.items()
            if times != 1]


def _overtaken(played: Round) -> List[str]:
    """The STOP that a box repeats each second may come after the PREPARE of a start: robots then begin again."""
    return [f"  {code}: a STOP from before the start came after PREPARE: {' '.join(robot.states)}"
            for code, robot in played.robots.items() if expected.late_stops(robot)]
