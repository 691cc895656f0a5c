"""A restart at any moment loses nothing, in no field of any object; and states of the version before are continued."""

import collections
import copy
import enum
import json
import pathlib
from decimal import Decimal
from fractions import Fraction

import pytest
from hypothesis import given

from fuzzing.core import RULES, Play
from helpers.box_driver import BoxDriver, beacon_bytes
from helpers.competition import competition, event
from helpers.examples import OPENINGS, STORIES, examples
from helpers.forms import form
from roah_rsbb.core.box import Box
from roah_rsbb.core.continuing import BoxSaved, Saved
from roah_rsbb.core.settings import Settings
from roah_rsbb.core.zones import ZoneState
from roah_rsbb.model.as_json import from_json, to_json
from roah_rsbb.model.clock import Anchor, Now
from roah_rsbb.model.records import RunRecord
from roah_rsbb.rulebook.benchmarks import NO_LIMIT

OLD_STATES = pathlib.Path(__file__).resolve().parents[2] / "data" / "journal_states.json"
TEAMS = ("Alpha", "Beta", "Gamma", "Delta", "Epsilon")
# Nothing is dropped from a log by its size, so that the line that a restart adds can be taken away again.
SETTINGS = Settings(listen_duration=0.0, display_log_size=10**9)

# What a restart may lose, by class. Everything else must be the same after it.
LOST = {
    # Robots and modules say it again within a second.
    "RobotLink": {"_listens_since", "_old", "_old_mono", "_looks", "_looked_mono", "_reported", "_last_beacon",
                  "record", "_skew"},
    "Timeline": {"_candidate", "_rising"},
    # The saved times are later: see `core/link/freshness.py`.
    "RobotPast": {"near", "ahead", "_latest"},
    "SavingWatch": {"_since"},
    "FunctionalityRun": {"_node", "_progress"},
    "Run": {"_last_logged", "_settled_at", "_hint_mono"},
    # Budgets are full again, and a hint about a robot that does not react comes later.
    "StringsBudget": {"_strings", "_characters"},
    "AllRobotsRun": {"_settled_mono", "_hint_mono"},
    # Entries of a moment ago are no longer joined with the next one; `_touched` is of one event.
    "ScoreSheet": {"_begun", "_touched"},
}
LOST["RobotLink"] |= {f"_{what}{mono}" for what in ("step", "rival", "moved", "bad") for mono in ("", "_mono")}
# Caches, the way out of the box, and what says that there was a restart.
LOST["Zones"], LOST["ScoreSheet"] = {"_runs"}, LOST["ScoreSheet"] | {"_groups", "_records", "_course"}
LOST["Zone"] = {"_run_set"}
LOST["RunBook"], LOST["SheetForm"] = {"_counted"}, {"is_plain"}
LOST["Run"] |= {"_dropped_strings", "_unread", "_say_dropped_from", "_state_mono"}
LOST["Run"] |= {"resumed", "_emit", "_show_map", "_opened_mono", "_is_heard", "_continued", "_is_withheld"}
LOST["RunState"], LOST["BookState"] = {"doubted", "away_s"}, {"outages"}  # they are of the restart
LOST["AllRobotsRun"] |= {"_emit", "_context"}
LOST["FunctionalityRun"] |= {"_modules"}
LOST["MemberRun"] = {"_whole"}


def facts(value, path, found):
    """Add all that an object consists of, in plain values by their paths."""
    plain = (enum.Enum, bool, int, float, str, frozenset, Decimal, Fraction)
    if value is None or isinstance(value, plain):
        found[path] = value
    elif isinstance(value, dict) and not hasattr(value, "__dict__"):
        for key, item in value.items():
            facts(item, f"{path}[{key!r}]", found)
    elif isinstance(value, (list, tuple, collections.deque)):
        found[f"{path}#"] = len(value)
        for number, item in enumerate(value):
            facts(item, f"{path}[{number}]", found)
    else:
        if isinstance(value, dict):
            facts(dict(value), path, found)
        lost = set().union(*(LOST.get(cls.__name__, ()) for cls in type(value).__mro__))
        for name, item in vars(value).items():
            if name not in lost:
                facts(item, f"{path}.{name}", found)


def all_facts(box):
    parts = {"zones": box.zones, "finished": box.finished, "devices": box.devices.state, "tablet": box.tablet.state}
    found = {}
    facts(parts, "", found)
    return found


def restarted(driver):
    """Another box that continues from this one's state, after it went through JSON."""
    box = driver.box
    zones = {name: _again(ZoneState, zone.saved()) for name, zone in box.zones.items()}
    records = tuple(_again(RunRecord, record) for record in reversed(box.scores.records(driver.now)))
    other = Box(driver.config, driver.settings, beacon_bytes)
    other.restart.resume(driver.now, Saved(driver.now.utc, _again(BoxSaved, box.restart.saved()), zones, records))
    return other


def _again(kind, state):
    return from_json(kind, json.loads(json.dumps(to_json(state))))


def without_the_restart(found):
    """Return the log without the line about the restart."""
    def cut(path, value):
        is_log = path.endswith(".state.log") and "The box was restarted at" in value
        return value[:value.rindex("\n", 0, -1) + 1] if is_log else value

    return {path: cut(path, value) for path, value in found.items()}


# -- random competitions ------------------------------------------------------------------------------


@examples(60)
@given(OPENINGS, STORIES)
def test_a_restart_after_any_event_of_random_competitions_loses_nothing(opening, story):
    play = Play(opening, lambda config: BoxDriver(config, SETTINGS))
    for act in story:
        play.do(act)
        play.driver.event(play.driver.box.timers.tick)
        expected = all_facts(play.driver.box)
        assert without_the_restart(all_facts(restarted(play.driver))) == expected


# The referee's commands, and seconds that pass.
_BY_HAND = ("open_sheet", 70.0, "start", 2.5, "next_phase", "pause", 0.5, "next_phase", "previous_phase", "resume", 2.5,
            "stop", 2.5, "start", "stop", "disconnect", "no_show")


@pytest.mark.parametrize("timeout", [300.0, NO_LIMIT])
def test_a_restart_in_a_run_by_hand_continues_it(timeout):
    config = competition(tbm=[event("HCFGAC", timeout=timeout, rules=RULES), event("HWV")])
    driver = BoxDriver(config, SETTINGS)
    driver.config = config
    seen = set()
    for act in _BY_HAND:
        (driver.command if isinstance(act, str) else driver.run)(act)
        expected = all_facts(driver.box)
        again = restarted(driver)
        assert without_the_restart(all_facts(again)) == expected
        run = again.zones["tbm"].run
        seen.add(None if run is None else (run.phase, run.times.state.phase, run.clock.elapsed(driver.now)))
    assert len(seen) > 8


# -- states of the version before ---------------------------------------------------------------------

with OLD_STATES.open(encoding="utf-8") as file:
    OLD = json.load(file)


def _config():
    return competition(
        teams=TEAMS, tbm=[event("HCFGAC", timeout=300.0), event("HWV")],
        fbm=[event("HNF", team="Beta", timeout=60.0, total_timeout=300.0)],
        omf=[event("HOMF", team="Gamma", timeout=60.0, total_timeout=300.0)],
        all=[event("HSUF", team="ALL", timeout=120.0)],
    )


def with_forms(old):
    """A state whose requests to the referee have forms, as this version writes it."""
    states = copy.deepcopy(old)
    for step in states.get("zone:fbm", {}).get("for_module", {}).get("steps", ()):
        request, outcome = step["request"], step.get("outcome", {})
        if request["kind"] == "REFEREE":
            request["form"] = form(*request.pop("choices"), asks_text=request.pop("asks_text"))
        if "answer" in outcome:
            outcome["values"] = json.dumps({"answer": outcome.pop("answer")})
    return states


@pytest.mark.parametrize("old", OLD, ids=lambda old: old["moment"])
@pytest.mark.parametrize("boot", ["boot 1", "boot 2"])
def test_a_state_that_the_version_before_wrote_is_continued(old, boot):
    """The file was written by commit a059938: see test/data/README.md."""
    now = Now(old["mono"], old["utc"]) if boot == "boot 1" else Now(50.0, old["utc"])
    shift = Anchor(old["mono"], old["utc"], "boot 1").shift(now, boot)
    zones = {
        name[len("zone:"):]: from_json(ZoneState, state, shift)
        for name, state in old["states"].items() if name.startswith("zone:")
    }
    records = tuple(from_json(RunRecord, record) for record in old["outcomes"])
    box = Box(_config(), SETTINGS, beacon_bytes)
    box.restart.resume(now, Saved(now.utc, from_json(BoxSaved, old["states"]["box"]), zones, records))
    expected = with_forms({name: state for name, state in old["states"].items() if name != "box"})
    found = {f"zone:{name}": to_json(zone.saved()) for name, zone in box.zones.items()}
    assert to_json(box.restart.saved()) == old["states"]["box"]
    for run in box.zones.runs():
        assert "The box was restarted at" in run.log
        saved = found[f"zone:{run.zone}"][_part(run)]
        del saved["log"]
        saved["book"].pop("outages", None)
        for member in saved.get("members", [saved]):
            member.pop("doubted", None)
            member.pop("away_s", None)
        expected[f"zone:{run.zone}"][_part(run)].pop("log", None)
    if boot == "boot 1":
        assert json.loads(json.dumps(found)) == expected
    else:
        assert found.keys() == expected.keys()
        for run in box.zones.runs():
            before = expected[f"zone:{run.zone}"][_part(run)]["clock"].get("deadline")
            assert run.state.clock.deadline == (None if before is None else pytest.approx(before + shift))
    assert {record.identity for record in box.finished.records()} == {
        record["identity"] for record in old["outcomes"] if record.get("closed_utc")
    }


def _part(run):
    return "all_robots" if len(run.members()) > 1 else "run"


def test_after_a_restart_a_robot_has_time_to_be_heard_again():
    driver = BoxDriver()
    driver.config = competition(tbm=["HGTKMH"])
    driver.executing()
    driver.run(2)
    box = restarted(driver)
    now = driver.now.later(9.0)
    box.timers.tick(now)
    assert box.warnings_of(now, "tbm")[-1] == "No message from the robot for 10 s"
    now = driver.now.later(10.0)
    assert box.warnings_of(now, "tbm")[-1].startswith("The robot has disappeared: no message for 10 s")


def test_a_restart_takes_the_place_of_no_warning_of_a_zone_and_only_a_run_in_progress_continues():
    config = competition(tbm=[event("HGTKMH")], fbm=[event("HWV", team="Beta")])
    driver = BoxDriver(config)
    driver.config = config
    driver.executing()
    driver.executing("fbm", team="Beta", name="r2", host="10.0.0.3")
    driver.command("stop", "fbm")
    box = restarted(driver)
    now = driver.now.later(10.0)
    box.timers.tick(now)
    restart = box.warnings(now)
    assert [text.partition(" at ")[0] for text in restart] == ["The box was restarted"]
    assert [text.partition(":")[0] for text in box.warnings_of(now, "tbm")] == [
        "The box was restarted, and has not heard the robot since", "The robot has disappeared"]
    logs = {run.zone: run.log for run in box.zones.runs()}
    assert f"WARNING: {restart[0]}: the run continues if its robot does\n" in logs["tbm"]
    assert f"WARNING: {restart[0]}\n" in logs["fbm"]


def test_a_replay_does_not_know_whether_beacons_arrived():
    driver = BoxDriver()
    driver.executing()
    state = driver.box.zones["tbm"].saved()
    replay = Box(competition(tbm=["HGTKMH"]), driver.settings, beacon_bytes)
    replay.restart.begin_replay("a run")
    replay.restart.show(driver.now, "tbm", state)
    assert replay.warnings_of(driver.now.later(60.0), "tbm") == ["No message from the robot for 60 s"]
