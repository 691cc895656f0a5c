"""Another configuration while the box runs: what changes, what runs keep, and what a restart continues with."""

import dataclasses
from decimal import Decimal

import pytest

from helpers import journaled
from helpers.box_driver import BoxDriver, beacon_bytes
from helpers.competition import UTC0, competition, event
from roah_rsbb.core import effects
from roah_rsbb.core.box import Box
from roah_rsbb.core.continuing import Saved
from roah_rsbb.core.views.schedule import EventState, schedule
from roah_rsbb.model.reason import Refused, RunName
from roah_rsbb.model.records import Phase
from roah_rsbb.model.scoring import ScoreKind, ScoringItem
from roah_rsbb.protocol import RobotState
from roah_rsbb.rulebook.benchmarks import EventRules, ZonePlan
from roah_rsbb.rulebook.changes import changes
from roah_rsbb.rulebook.event_ids import adopted
from roah_rsbb.scoring.counting import Why, rulings
from roah_rsbb.scoring.sheet import Mark

HOUR = 3600.0
GLASS = ScoringItem("Achievements", "brings the glass", ScoreKind.BOOL)


def day(**of_first):
    """Three events of a zone, an hour apart."""
    return [event(run=1, **of_first), event("HWV", run=2, scheduled=UTC0 + HOUR),
            event("HCFGAC", run=3, scheduled=UTC0 + 2 * HOUR)]


def reload(driver, config, version=1, before=None):
    """Take this configuration."""
    listed = changes(before, config) if before is not None else ["something"]
    driver.event(driver.box.reload.take, config, version, listed, "Olga")


def codes(driver, zone="tbm"):
    return [e.benchmark.code for e in driver.box.zones[zone].events]


def states(driver):
    return {line.event.run: line.state for line in schedule(driver.box, driver.now)}


# -- zones ------------------------------------------------------------------------------------------


def test_a_zone_stays_at_its_event_when_that_moves_in_time():
    driver = BoxDriver(competition(tbm=day()))
    driver.command("next")
    late = [day()[0], event("HWV", run=2, scheduled=UTC0 + 1.5 * HOUR), day()[2]]
    other = changed_while_off(driver, competition(tbm=late))
    reload(driver, competition(tbm=late))
    assert [box.zones["tbm"].event.run for box in (driver.box, other)] == [2, 2]


def changed_while_off(driver, config):
    """The next box, if the configuration is changed while no box runs."""
    box, before = Box(config, driver.settings, beacon_bytes), driver.box
    states = {name: zone.saved() for name, zone in before.zones.items()}
    plans = tuple(ZonePlan(name, zone.planned) for name, zone in before.zones.items())
    records = before.scores.records(driver.now)
    box.restart.resume(driver.now, Saved(driver.now.utc, before.restart.saved(), states, records, planned=plans))
    return box


@pytest.mark.parametrize("at, order, then", [
    (0, (2, 1, 3), 2), (0, (3, 2, 1), 3), (1, (1, 3, 2), 3), (1, (2, 1, 3), 2), (2, (3, 1, 2), 3),
    (0, (2, 3), 2), (1, (1, 3), 3), (2, (1, 2), 2),
])
def test_a_zone_goes_to_the_event_that_was_swapped_with_its_own_or_follows_a_removed_one(at, order, then):
    driver = BoxDriver(competition(tbm=day()))
    for _ in range(at):
        driver.command("next")
    names = {each.run: each.benchmark.code for each in day()}
    places = range(3) if len(order) == 3 else [run - 1 for run in order]
    config = competition(tbm=[
        event(names[run], run=run, scheduled=UTC0 + place * HOUR) for place, run in zip(places, order)])
    other = changed_while_off(driver, config)
    reload(driver, config)
    assert [box.zones["tbm"].event.run for box in (driver.box, other)] == [then, then]


def test_a_swap_moves_no_zone_to_an_event_that_is_over():
    driver = BoxDriver(competition(tbm=day()))
    driver.command("next")
    driver.command("no_show")
    driver.command("previous")
    driver.command("previous")
    assert driver.box.zones["tbm"].event.run == 1
    config = competition(tbm=[event("HWV", run=2), event(run=1, scheduled=UTC0 + HOUR), day()[2]])
    other = changed_while_off(driver, config)
    reload(driver, config)
    assert [box.zones["tbm"].event.run for box in (driver.box, other)] == [1, 1]


def test_a_zone_with_a_run_cannot_be_removed():
    driver = BoxDriver(competition(tbm=day(), old=["STB"]))
    driver.connected("tbm")
    driver.taken()
    config = competition(old=["STB"])
    assert driver.box.reload.off(config) == [
        "zone 'tbm' is no longer in the schedule, but a run of HGTKMH is connected in it: disconnect it first"]
    with pytest.raises(Refused):
        reload(driver, config)
    assert list(driver.box.zones) == ["tbm", "old"]
    assert driver.taken() == []
    driver.command("disconnect")
    reload(driver, config)
    assert list(driver.box.zones) == ["old"]


# -- teams ------------------------------------------------------------------------------------------


def test_a_late_team_can_connect():
    driver = BoxDriver(competition(teams=["Alpha"], tbm=day()))
    reload(driver, competition(teams=["Alpha", "Late"], tbm=[event("HSUF", team="ALL")]))
    robot = driver.robot(team="Late")
    robot.beacon()
    driver.command("connect")
    opened = driver.taken(effects.OpenChannel)
    assert [(channel.team, channel.version) for channel in opened] == [("Late", 1)]


# -- runs -------------------------------------------------------------------------------------------


def test_a_run_keeps_its_limits_and_items_and_the_next_has_the_new_ones():
    driver = BoxDriver(competition(tbm=day(timeout=600.0)))
    robot = driver.executing()
    robot.lives(100)
    reload(driver, competition(tbm=day(timeout=60.0, scoring=(GLASS,))))
    run = driver.run_in()
    assert run.phase is Phase.RUNNING
    driver.score("Achievements", "detects the door", 1)
    with pytest.raises(Refused):
        driver.score("Achievements", "brings the glass", 1)
    robot.lives(499)
    assert run.phase is Phase.RUNNING
    robot.lives(2)
    assert run.end_reason.name == "TIMEOUT"
    assert driver.box.zones["tbm"].event.benchmark.timeout == 600.0
    driver.command("disconnect")
    robot.beacon()
    driver.command("connect")
    assert driver.run_in().event.benchmark.timeout == 60.0
    driver.score("Achievements", "brings the glass", 1)


def test_the_event_of_a_run_stays_until_the_run_is_left():
    driver = BoxDriver(competition(tbm=day()))
    driver.connected()
    reload(driver, competition(tbm=day()[1:]))
    assert codes(driver) == ["HGTKMH", "HWV", "HCFGAC"]
    assert states(driver)[1] is EventState.CONNECTED
    driver.command("start")
    driver.command("stop")
    driver.command("disconnect")
    assert codes(driver) == ["HWV", "HCFGAC"]
    assert driver.box.zones["tbm"].event.run == 2
    assert [record.benchmark for record in driver.box.finished.records()] == ["HGTKMH"]


def test_results_stay_with_an_event_that_moves_in_time():
    driver = BoxDriver(competition(tbm=day()))
    robot = driver.executing()
    robot.completes()
    driver.command("disconnect")
    assert states(driver)[1] is EventState.DONE
    moved = event(run=1, scheduled=UTC0 + 0.5 * HOUR)
    reload(driver, competition(tbm=[moved, *day()[1:]]))
    assert states(driver)[1] is EventState.DONE
    # Another attempt at it is not signed off, so leaving the event has to be confirmed.
    driver.command("previous")
    with pytest.raises(Refused, match="not signed off"):
        driver.choose(1)


# -- ids --------------------------------------------------------------------------------------------


def with_id(own, **fields):
    """An event that is known by an id."""
    return dataclasses.replace(event(**fields), id=own)


def attempt(driver, zone="tbm"):
    """A run at the zone's event that is over; returns its record."""
    driver.command("open_sheet", zone)
    driver.command("start", zone)
    driver.command("stop", zone)
    driver.command("disconnect", zone)
    return driver.box.finished.records()[0]


TWICE = EventRules(attempts=2)


@pytest.mark.parametrize("moved", [
    {"zone": "tbm", "scheduled": UTC0 + 40 * 60.0}, {"zone": "tbm", "scheduled": UTC0 + 24 * HOUR},
    {"zone": "hall"}, {"zone": "tbm", "round": 3, "run": 7}, {"zone": "hall", "round": 2, "scheduled": UTC0 + HOUR},
])
def test_an_event_is_known_by_its_id(moved):
    """Whatever changes, the attempts before count, and are the event's."""
    driver = BoxDriver(competition(tbm=[with_id("x", rules=TWICE), with_id("y", code="HWV", run=2)], hall=["STB"]))
    first = attempt(driver)
    zone = moved.pop("zone")
    zones = {"tbm": [with_id("y", code="HWV", run=2)], "hall": [event("STB")]}
    zones[zone].append(with_id("x", rules=TWICE, **moved))
    reload(driver, competition(**zones))
    line, = (line for line in schedule(driver.box, driver.now) if line.event.id == "x")
    assert line.last.identity == first.identity
    driver.choose_id("x", zone, True)
    assert driver.view(zone).attempt == 2
    second = attempt(driver, zone)
    assert (second.event, first.event) == ("x", "x")
    assert driver.off("open_sheet", zone) == [
        "The last of 2 attempts at this event was made: go to the next event. To allow more, raise 'attempts' in "
        "benchmarks.yaml"]
    ruled = rulings([first, second], {})
    assert [ruling.why for ruling in ruled] == [Why.NOT_LAST, Why.COUNTS]


@pytest.mark.parametrize("before, after", [({}, {"team": "Beta"}), ({"code": "HWV"}, {})], ids=["team", "benchmark"])
def test_another_team_or_benchmark_at_an_event_has_no_runs_yet(before, after):
    """Its signed run used to stand for the new benchmark in schedule and checklist, and to be one of its attempts."""
    others = [with_id("y", run=2), with_id("z", code="HWV", run=3)]
    driver = BoxDriver(competition(tbm=[with_id("x", rules=TWICE, **before), *others]))
    first = attempt(driver)
    reload(driver, competition(tbm=[with_id("x", rules=TWICE, **after), *others]))
    now = driver.box.zones["tbm"].event
    assert (now.team, now.benchmark.code) == (after.get("team", "Alpha"), "HGTKMH")
    assert states(driver)[1] is EventState.NEXT
    assert schedule(driver.box, driver.now)[0].result is None
    assert driver.view().attempt == 1
    second = attempt(driver)
    assert (first.event, second.event) == ("x", "x")
    assert [ruling.why for ruling in rulings([first, second], {})] == [Why.COUNTS, Why.COUNTS]
    assert [(key.benchmark, key.team) for key in driver.box.reload.ran()] == [
        (record.benchmark, record.team) for record in (second, first)]


def test_a_run_of_tomorrow_with_the_same_numbers_is_another_event():
    """A sheet of tomorrow begins at round 1 again. Its runs used to appear as done and signed off."""
    driver = BoxDriver(competition(tbm=[with_id("x"), with_id("y", code="HWV", run=2)]))
    record = attempt(driver)
    driver.enter("sign_off", RunName("tbm", record.identity), "Anna")
    reload(driver, competition(tbm=[with_id("z", scheduled=UTC0 + 24 * HOUR)]))
    line, = schedule(driver.box, driver.now)
    assert (line.last, line.state) == (None, EventState.NEXT)


def test_a_chosen_event_whose_team_changed_is_refused():
    driver = BoxDriver(competition(tbm=[with_id("x"), with_id("y", run=2)]))
    reload(driver, competition(tbm=[with_id("x"), with_id("y", run=2, team="Beta")]))
    with pytest.raises(Refused, match="The event is of team Beta now"):
        driver.choose_id("y", team="Alpha")
    driver.choose_id("y", team="Beta")
    assert driver.box.zones["tbm"].event.id == "y"


def test_a_journal_without_ids_is_continued(tmp_path):
    """The state and the records of an older version have none."""
    old, new = competition(tbm=day()), competition(tbm=[
        dataclasses.replace(e, id=f"id{e.run}", scheduled=e.scheduled + (60.0 if e.run == 3 else 0.0)) for e in day()])
    driver = journaled.box(tmp_path, old)
    first = attempt(driver)
    driver.command("next")
    driver.command("next")
    assert (first.event, driver.box.zones["tbm"].event.run) == ("", 3)
    driver.kill(config=new)
    assert driver.box.zones["tbm"].event.id == "id3"
    assert states(driver)[1] is EventState.DONE
    driver.command("previous")
    driver.command("previous")
    second = attempt(driver)
    assert second.event == "id1"
    assert [ruling.why for ruling in rulings([first, second], {})] == [Why.NOT_LAST, Why.COUNTS]


@pytest.mark.parametrize("chosen", ["x", "z"])
def test_an_event_is_chosen_while_a_run_has_an_event_that_was_removed(chosen):
    """The places in the schedule change when the run is left: the core ended with an IndexError."""
    driver = BoxDriver(competition(tbm=[with_id("x"), with_id("y", run=2), with_id("z", run=3)]))
    for command in ("open_sheet", "start", "stop"):
        driver.command(command)
    events = {e.id: e for e in driver.box.zones["tbm"].events}
    reload(driver, competition(tbm=[events["y"], events["z"]]))
    driver.choose_id(chosen, unsigned=True)
    assert driver.box.zones["tbm"].event.id == {"x": "y", "z": "z"}[chosen]


def test_an_event_that_was_moved_to_another_zone_during_its_run_has_its_result_in_both():
    driver = BoxDriver(competition(tbm=[with_id("x"), with_id("y", run=2)], hall=["STB"]))
    for command in ("open_sheet", "start", "stop"):
        driver.command(command)
    identity = driver.run_in().identity
    reload(driver, competition(tbm=[with_id("y", run=2)], hall=[event("STB"), with_id("x")]))
    lines = [line for line in schedule(driver.box, driver.now) if line.event.id == "x"]
    assert [line.result.shown.record.identity for line in lines] == [identity, identity]
    driver.command("disconnect")
    line, = (line for line in schedule(driver.box, driver.now) if line.event.id == "x")
    assert (line.zone, line.result.shown.record.identity, line.state) == ("hall", identity, EventState.DONE)


def test_an_event_that_was_removed_and_is_written_again_has_its_runs():
    """Its new line has no id. Its zone and time change later: its result used to be lost."""
    driver = BoxDriver(competition(tbm=[with_id("x", rules=TWICE), with_id("y", run=2)]))
    first = attempt(driver)
    reload(driver, competition(tbm=[with_id("y", run=2)]))
    again = dataclasses.replace(event(rules=TWICE), id="other", id_goes=object())
    read = competition(tbm=[with_id("y", run=2), again])
    zones = adopted(read.zones, competition(tbm=[with_id("y", run=2)]).zones, driver.box.reload.ran())
    reload(driver, dataclasses.replace(read, zones=zones))
    assert [e.id for e in driver.box.zones["tbm"].events] == ["y", "x"]
    moved = dataclasses.replace(driver.box.zones["tbm"].events[1], scheduled=UTC0 + HOUR)
    reload(driver, competition(hall=[moved]))
    line, = schedule(driver.box, driver.now)
    assert (line.zone, line.last.identity) == ("hall", first.identity)
    assert driver.view("hall").attempt == 2


def test_the_reload_is_recorded_before_anything_else():
    driver = BoxDriver(competition(tbm=day()))
    driver.taken()
    reload(driver, competition(tbm=day(timeout=60.0)), before=competition(tbm=day()))
    first = driver.taken()[0]
    assert (first.kind, first.who, first.value["version"]) == ("reload", "Olga", 1)
    assert first.value["changes"] == ["benchmark HGTKMH: timeout 600, now 60",
                                      "benchmark HGTKMH: total timeout 600, now 60"]


# -- restarts ---------------------------------------------------------------------------------------


def test_a_restart_continues_the_run_with_what_it_began_with(tmp_path):
    old, new = competition(tbm=day(timeout=600.0)), competition(tbm=day(timeout=60.0)[1:])
    driver = journaled.box(tmp_path, old)
    robot = driver.executing()
    reload(driver, new)
    driver.taken()
    driver.kill(config=new, version=1, earlier={0: old})
    assert [channel.version for channel in driver.taken(effects.OpenChannel)] == [0]
    assert driver.run_in().event.benchmark.timeout == 600.0
    assert codes(driver) == ["HGTKMH", "HWV", "HCFGAC"]
    robot.says(RobotState.EXECUTING)
    robot.lives(100)
    assert driver.run_in().phase is Phase.RUNNING
    driver.command("stop")
    driver.command("disconnect")
    assert codes(driver) == ["HWV", "HCFGAC"]
    driver.kill(config=new, version=1)
    assert driver.box.zones["tbm"].event.run == 2
    assert len(driver.box.finished.records()) == 1


def test_a_team_that_was_removed_keeps_its_run_through_a_restart(tmp_path):
    old = competition(tbm=[event(team="Beta")], other=["STB"])
    new = competition(teams=["Alpha"], tbm=["HWV"], other=["STB"])
    driver = journaled.box(tmp_path, old)
    driver.executing(team="Beta")
    reload(driver, new)
    driver.kill(config=new, version=1, earlier={0: old})
    assert driver.run_in().robot.team == "Beta"
    # Without the earlier configuration, the run is lost, but the box runs.
    driver.kill(config=new, version=1)
    assert driver.run_in() is None


def test_a_run_that_began_after_the_reload_needs_no_earlier_configuration(tmp_path):
    old, new = competition(tbm=day(timeout=600.0)), competition(tbm=day(timeout=60.0))
    driver = journaled.box(tmp_path, old)
    reload(driver, new)
    driver.executing()
    driver.kill(config=new, version=1, earlier={0: old})
    assert driver.run_in().event.benchmark.timeout == 60.0
    assert driver.box.zones["tbm"].version == 1


# -- runs that are over, scored by a changed sheet ---------------------------------------------------


def scored_day(points):
    """One event whose sheet gives so many points for the glass."""
    glass = dataclasses.replace(GLASS, points=Decimal(points))
    return competition(tbm=[event(run=1, scoring=(glass,)), event("HWV", run=2, scheduled=UTC0 + HOUR)])


def finished_run(driver, signer=""):
    """A finished run with the glass, signed off if somebody does; returns its identity."""
    driver.command("open_sheet")
    driver.command("start")
    identity = driver.box.zones["tbm"].run.identity
    driver.event(driver.box.scores.mark, RunName("tbm", identity), Mark(*GLASS.key, 1), "Anna")
    driver.command("stop")
    driver.command("disconnect")
    if signer:
        driver.event(driver.box.scores.sign_off, RunName("tbm", identity), signer)
    return identity


def found(driver, points):
    """The runs that such a sheet would score in another way."""
    return driver.box.reload.rescoring(scored_day(points))()


def record(driver, identity):
    return driver.box.scores.named(RunName("tbm", identity)).record


def test_a_changed_sheet_names_the_runs_that_it_would_score_otherwise():
    driver = BoxDriver(scored_day(60))
    identity = finished_run(driver)
    assert [str(run) for run in found(driver, 50)] == [
        f"HGTKMH, team Alpha, round 1, run 1 ({identity}): 60, now 50"]
    assert found(driver, 60) == []
    reload(driver, scored_day(50), before=scored_day(60))
    assert record(driver, identity).points.total == "60", "from now on"


def test_runs_that_kept_their_sheet_can_be_scored_by_the_new_one_later():
    driver = BoxDriver(scored_day(60))
    identity = finished_run(driver)
    reload(driver, scored_day(50), before=scored_day(60))
    assert [run.after.points.total for run in found(driver, 50)] == ["50"]
    driver.event(driver.box.reload.take, scored_day(50), 1, [], "Olga", found(driver, 50))
    assert record(driver, identity).points.total == "50"
    assert found(driver, 50) == []


def test_a_changed_sheet_for_all_runs_gives_a_signed_one_a_new_version():
    driver = BoxDriver(scored_day(60))
    identity = finished_run(driver, "Ben")
    signed = record(driver, identity)
    with pytest.raises(Refused, match="needs the name"):
        driver.event(driver.box.reload.take, scored_day(50), 1, ["a sheet"], "/web", found(driver, 50))
    driver.event(driver.box.reload.take, scored_day(50), 1, ["a sheet"], "Olga", found(driver, 50))
    now = record(driver, identity)
    assert (now.points.total, now.sign_off.who, now.history) == ("50", "Olga", signed.history)
    (version,) = now.versions
    assert (version.points, version.items, version.sign_off) == (signed.points, signed.items, signed.sign_off)
    assert driver.taken(effects.RecordChanged)[-1].record == now
    with pytest.raises(Refused, match="final"):
        driver.event(driver.box.scores.mark, RunName("tbm", identity), Mark(*GLASS.key, 0), "Anna")


def test_a_run_that_changed_since_it_was_found_is_scored_as_it_is_now():
    driver = BoxDriver(scored_day(60))
    identity = finished_run(driver)
    before = found(driver, 50)
    driver.event(driver.box.scores.mark, RunName("tbm", identity), Mark(*GLASS.key, 0), "Anna")
    later = finished_run(driver)
    driver.event(driver.box.reload.take, scored_day(50), 1, ["a sheet"], "Olga", before)
    assert [record(driver, each).points.total for each in (identity, later)] == ["0", "50"]
