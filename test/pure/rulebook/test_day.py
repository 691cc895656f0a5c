"""Edits of the day: in any order, on the schedule and on the text of its file; and what is said of them."""

import random
import re

import pytest

from helpers.competition import benchmark
from roah_rsbb.model.reason import Refused
from roah_rsbb.rulebook import day, event_ids, schedule_text
from roah_rsbb.rulebook.benchmarks import ScheduledEvent, ZonePlan
from roah_rsbb.rulebook.day import Day, EventChange
from roah_rsbb.rulebook.errors import Report, known
from roah_rsbb.rulebook.yaml_fields import utc_time
from roah_rsbb.rulebook.yaml_lines import Scalar, read_yaml
from roah_rsbb.wording import times

MORNING = 1795942800.0  # 2026-11-29 10:00 in Berlin
HOUR, CODES, TEAMS = 3600.0, ("HGTKMH", "HWV", "HCFGAC"), ("Alpha", "Beta", "Gamma", "it's: odd")
FLOW = ("    - {{ benchmark: {0}, team: {1}, round: {2}, run: {3}, scheduled_time: {4}, id: {5} }}"
        "  # {6}\n")
BLOCK = ("  - id: {5}\n    benchmark: {0}  # a note\n    team: {1}\n    round: {2}\n    run: {3}\n"
         "    scheduled_time: '{4}'\n")


@pytest.fixture(autouse=True)
def berlin():
    times.use_zone("Europe/Berlin")
    yield
    times.use_zone("")


def plan(name, *slots):
    """A zone of (code, team, hours after the morning, id)."""
    return ZonePlan(name, tuple(ScheduledEvent(benchmark(code), team, 1, 1, MORNING + hours * HOUR, own)
                                for code, team, hours, own in slots))


def schedule(chance):
    """A random schedule of two days."""
    names = iter(f"event{number}" for number in range(100))
    return [ZonePlan(zone, tuple(sorted((ScheduledEvent(
        benchmark(chance.choice(CODES)), chance.choice(TEAMS), 1, number + 1,
        MORNING + 86400.0 * chance.randrange(2) + 900.0 * chance.randrange(30), next(names))
        for number in range(chance.randint(1, 6))), key=lambda event: event.scheduled))) for zone in ("Home", "Arena")]


def text_of(zones, chance):
    """A file of that schedule, with comments, in one of the layouts that people write."""
    lines = ["# The whole\n", "- time_zone: Europe/Berlin\n"]
    for zone in zones:
        form = chance.choice((FLOW, BLOCK))
        lines += [f"\n# of {zone.name}\n", f"- zone: {zone.name}\n", "  schedule:\n"]
        for event in zone.events:
            lines += [form.format(
                event.benchmark.code, schedule_text.yaml_text(event.team), event.round, event.run, written, event.id,
                times.formatted(event.scheduled, "%A", False))
                for written in [chance.choice((times.date_time(event.scheduled),
                                               times.formatted(event.scheduled, "%Y-%m-%d %H:%M:%S", True)))]]
            lines += ["    # between\n"] * chance.randrange(2)
    text = "".join(lines)
    return text if chance.random() < 0.7 else text.replace("\n", "\r\n")


def read(text):
    """The slots that a file says."""
    found = {}
    with known({"s.yaml": text}):
        root = read_yaml("s.yaml", Report(), "", "")
    for node in root.items:
        parts = {key.text: value for key, value in node.pairs}
        for event in parts["schedule"].items if "schedule" in parts else ():
            got = {key.text: value for key, value in event.pairs}
            found[got["id"].text] = day.PlannedSlot(
                parts["zone"].text, got["benchmark"].text, got["team"].text, int(got["round"].text),
                int(got["run"].text), utc_time(Report(), Scalar(
                    got["id"].place, got["scheduled_time"].text, False, False), ""))
    return found


def zones_of(slots, zones):
    """The schedule of these slots."""
    return [ZonePlan(zone.name, tuple(sorted((
        ScheduledEvent(benchmark(slot.benchmark), slot.team, slot.round, slot.run, slot.scheduled, own)
        for own, slot in slots.items() if slot.zone == zone.name), key=lambda event: event.scheduled)))
        for zone in zones]


def any_edit(chance, today):
    """The changes of a random edit that is not refused."""
    while True:
        name, events = chance.choice(list(day.EDITS)), list(today.slots)
        time = chance.choice(("", "12:30", "2026-11-30", "2026-11-30 09:15"))
        given = {"zone": chance.choice(("Home", "Arena")), "time": chance.choice(("40", "-15", "13:05")),
                 "event": chance.choice(events), "other": chance.choice(events), "benchmark": chance.choice(CODES),
                 "team": chance.choice((*TEAMS, f"New {chance.random()}"))}
        if name in ("move", "insert", "repeat"):
            given["time"] = time
        try:
            return name, day.EDITS[name](today, given)
        except Refused:
            continue


@pytest.mark.parametrize("seed", range(60))
def test_any_edits_lose_no_event_are_written_with_all_comments_and_are_undone(seed):
    chance = random.Random(seed)
    zones = schedule(chance)
    text = text_of(zones, chance)
    comments = sorted(re.findall("# (?:The whole|of .*|between|a note)", text))
    for _ in range(6):
        slots = day.slots(zones)
        today = Day(zones, slots, slots, MORNING)
        name, changes = any_edit(chance, today)
        after = day.applied(slots, changes)
        removed = slots.keys() - after.keys()
        assert len(removed) == (name == "remove") and all(zone.events for zone in zones)
        written = schedule_text.changed(text, changes)
        assert read(written) == after
        kept = sorted(re.findall("# (?:The whole|of .*|between|a note)", written))
        assert kept == comments or name == "remove"  # that of a line goes with it
        assert len(written.split("\r\n")) in (1, len(written.split("\n")))
        back = day.undone(changes)
        assert day.applied(after, back) == slots
        assert read(schedule_text.changed(written, back)) == slots
        if after != slots:
            with pytest.raises(Refused):
                day.applied(after, changes)
        assert len(day.words(changes, today.today)) == len(changes)
        zones, text, comments = zones_of(after, zones), written, kept


@pytest.mark.parametrize("seed", range(40))
def test_no_team_is_in_two_zones_unnoticed(seed):
    chance = random.Random(seed)
    zones = schedule(chance)
    slots = day.slots(zones)
    today = Day(zones, slots, slots, MORNING)
    changes = any_edit(chance, today)[1]
    after = zones_of(day.applied(slots, changes), zones)

    def together(of):
        """Pairs of events of a team in two zones at once, counted plainly."""
        all_of = [(zone.name, event) for zone in of for event in zone.events]
        return {frozenset((one.id, other.id)) for first, one in all_of for second, other in all_of
                if first != second and one.team == other.team and one.scheduled <= other.scheduled
                and other.scheduled < one.scheduled + day.planned_s(one.benchmark)}
    text = " ".join(day.warnings(today, after, changes))
    slots = day.slots(after)
    for pair in together(after) - together(zones):
        assert f"Team {slots[min(pair)].team} is in two zones at once" in text


HERE = [plan("Home", ("HWV", "Alpha", 0, "a"), ("HWV", "Beta", 1, "b"), ("HWV", "Gamma", 24, "c")),
        plan("Arena", ("HGTKMH", "Beta", 2, "d"))]


@pytest.mark.parametrize("edit, given, said", [
    ("shift", {"time": "40"}, ["HWV of Beta: 11:40 instead of 11:00"]),
    ("shift", {"time": "10:50"}, ["HWV of Beta: 10:50 instead of 11:00"]),
    ("shift", {"time": "0"}, "Nothing would change"),
    ("shift", {"time": "soon"}, "'soon' is no delay"),
    ("shift", {"time": "1440"}, "more than a day"),
    ("shift", {"time": "9", "zone": "Hom"}, "There is no zone 'Hom'"),
    ("move", {"event": "b", "time": "2026-11-30"}, ["HWV of Beta: 2026-11-30 11:00 instead of 11:00"]),
    ("move", {"event": "b", "zone": "Arena", "time": ""},
     ["HWV of Beta: 11:00 in zone 'Arena' instead of 11:00 in zone 'Home'"]),
    ("move", {"event": "a", "time": "12:00"}, "HWV of Alpha is over, or in progress"),
    ("move", {"event": "b", "time": "25:00"}, "'25:00' is no time"),
    ("move", {"event": "b", "time": "2026-02-30"}, "'2026-02-30' is no time"),
    ("move", {"event": "b", "time": "2027-03-28 02:30"}, "the clocks skip it"),
    ("move", {"event": "d", "zone": "Home", "time": ""}, "the only event of zone 'Arena'"),
    ("swap", {"event": "b", "other": "d"}, ["HGTKMH of Beta: 11:00 in zone 'Home' instead of 12:00 in zone 'Arena'",
                                            "HWV of Beta: 12:00 in zone 'Arena' instead of 11:00 in zone 'Home'"]),
    ("swap", {"event": "b", "other": "b"}, "two different events"),
    ("remove", {"event": "c"}, ["HWV of Gamma: removed (it was at 2026-11-30 10:00 in zone 'Home')"]),
    ("remove", {"event": "x"}, "no such event"),
    ("repeat", {"event": "a", "time": ""}, ["HWV of Alpha: 12:00 in zone 'Home', added"]),
    ("repeat", {"event": "a", "time": "16:30", "zone": "Arena"}, ["HWV of Alpha: 16:30 in zone 'Arena', added"]),
    ("insert", {"time": "14:00", "benchmark": "HCFGAC", "team": "Gamma"},
     ["HCFGAC of Gamma: 14:00 in zone 'Home', added"]),
    ("add_team", {"team": "Alpha"}, "Alpha is there already"),
    ("add_team", {"team": "Tea"}, ["HGTKMH of Tea: 12:15 in zone 'Arena', added",
                                   "HWV of Tea: 2026-11-30 11:00 in zone 'Home', added"]),
])
def test_what_an_edit_says(edit, given, said):
    today = Day(HERE, {"b", "c", "d"}, {"b", "c", "d"}, MORNING)
    given = {"zone": "" if edit in ("move", "repeat") else "Home", **given}
    try:
        found = day.words(day.EDITS[edit](today, given), today.today)
    except Refused as refused:
        assert said in refused.reasons[0]
    else:
        assert found == said


def test_what_becomes_worse_is_said_and_nothing_else():
    today = Day(HERE, {"b", "c", "d"}, {"b", "c", "d"}, MORNING)

    def worse(edit, **given):
        changes = day.EDITS[edit](today, {"zone": "", "time": "", **given})
        return day.warnings(today, zones_of(day.applied(today.slots, changes), HERE), changes)
    assert worse("move", event="b", time="11:30") == []
    length = day.planned_s(benchmark("HWV")) / 60.0
    assert worse("move", event="b", time=f"11:{60 - round(length) - 5}") == [
        f"Team Beta has less than 10 minutes between HWV (11:{60 - round(length) - 5}) and HGTKMH (12:00)"]
    assert worse("move", event="b", time="12:01") == [
        "Team Beta is in two zones at once: HGTKMH at 12:00, HWV at 12:01"]
    assert worse("move", event="b", time="10:01") == [
        "Zone 'Home': HWV of Beta at 10:01 begins before the end of HWV of Alpha (10:00)"]
    assert worse("move", event="b", time="9:00") == ["HWV of Beta: 09:00 has passed"]
    assert worse("move", event="d", time="23:59") == ["HGTKMH of Beta at 23:59 ends after midnight"]


def test_a_file_that_is_no_list_of_lines_is_refused():
    for events in (" [{id: a, scheduled_time: 2026-11-29 10:00:00}]", "\n    - {id: a}",
                   "\n    - {id: a, scheduled_time: x}"):
        with pytest.raises(Refused, match="a line of its own"):
            schedule_text.changed(f"- zone: A\n  schedule:{events}\n", [EventChange("a", None, None)])


def test_new_events_get_ids_that_are_valid():
    assert all(event_ids.VALID.fullmatch(change.id)
               for change in day.EDITS["insert"](Day(HERE, (), (), MORNING), {
                   "zone": "Home", "benchmark": "HWV", "team": "Alpha", "time": "15:00"}))
