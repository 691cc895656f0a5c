"""Sessions of the original box and client, replayed: our box answers the client as the original did, sooner."""

import itertools

import pytest

from helpers.recorded_session import Replay, goals_of, waypoint
from roah_rsbb.core.effects import SetDevice
from roah_rsbb.model.modules import RequestKind
from roah_rsbb.model.records import EndReason, Phase
from roah_rsbb.protocol import BoxState


@pytest.mark.parametrize("name, code", [
    ("HGTKMH_2015", "HGTKMH"), ("HGTKMH_2020", "HGTKMH"), ("HCFGAC_2015", "HCFGAC"),
])
def test_the_box_reaches_the_same_states_sooner(name, code):
    replay = Replay(name, code)
    assert replay.refused == []
    assert [state for _, state in replay.ours] == [state for _, state in replay.originals] == [
        BoxState.STOP, BoxState.PREPARE, BoxState.WAITING_RESULT, BoxState.STOP
    ]
    assert all(ours <= original for (ours, _), (original, _) in zip(replay.ours, replay.originals))
    assert replay.run.end_reason is EndReason.COMPLETED
    run = replay.driver.run_in()
    assert run is None or run.phase is Phase.ENDED  # one recording ends with a stop after the end
    assert replay.run.link.times_valid


@pytest.mark.parametrize("name, code, script", [
    ("HNF_2020", "HNF", [waypoint(goal) for goal in goals_of("HNF_2020")]),
    ("STB_2020", "STB", [
        (RequestKind.REFEREE, {"text": "First Manual Operation"}),
        *((RequestKind.GOAL, {"goal": goal, "timeout": 15.0}) for goal in goals_of("STB_2020")),
        (RequestKind.REFEREE, {"text": "Last Manual Operation"}),
    ]),
])
def test_a_functionality_benchmark_reaches_the_same_states_sooner(name, code, script):
    replay = Replay(name, code, timeout=600.0, script=script)
    goals = sum(kind is RequestKind.GOAL for kind, _ in script)
    assert goals >= 2
    assert replay.refused == []
    assert [state for _, state in replay.ours] == [state for _, state in replay.originals] == [
        BoxState.STOP, *[BoxState.PREPARE, BoxState.GOAL_TX, BoxState.WAITING_RESULT] * goals, BoxState.STOP
    ]
    # A manual operation is over when the referee says so; the recording has that a little late.
    assert all(ours <= original + 0.01 for (ours, _), (original, _) in zip(replay.ours, replay.originals))
    assert replay.run.end_reason is EndReason.COMPLETED
    assert [step.outcome.result for step in replay.run.steps if step.request.kind is RequestKind.GOAL] == [
        "SOME RESULT" if code == "STB" else ""
    ] * goals


def test_a_timeout():
    """The original allowed another start after it, which is refused here (docs/protocol.md, "State machines")."""
    replay = Replay("TIMEOUT_2015", "HGTKMH", timeout=5.0)
    assert replay.run.end_reason is EndReason.TIMEOUT
    originals = list(itertools.islice(replay.originals, 4))
    assert [state for _, state in replay.ours] == [state for _, state in originals]
    assert all(ours <= original for (ours, _), (original, _) in zip(replay.ours, originals))
    assert replay.refused[0] == ("start", ["The run ended by timeout: disconnect, and connect for a new run"])


def test_a_2015_clients_devices_tablet_and_final_command():
    replay = Replay("HCFGAC_2015", "HCFGAC")
    assert replay.driver.taken(SetDevice) == [
        # It always sends all of them: so its first word on each counts, from its second message on.
        *(("tbm", device, value) for device, value in (
            ("switch_1", 1), ("switch_2", 0), ("switch_3", 0), ("dimmer", 0), ("blinds", 0), ("dimmer", 70),
            ("blinds", 100),  # when the run was over, and not left yet
        )),
    ]
    assert replay.driver.box.tablet.state.display_map is True
    assert replay.driver.logged(replay.port, "/command") == ["open the blinds"]
