"""The list of what differs between two configurations."""

import dataclasses
from decimal import Decimal

import pytest

from helpers.competition import BUMPS, DOOR, UTC0, competition, event
from roah_rsbb.model.rules import Stage, StageColumn
from roah_rsbb.model.scoring import NO_SHEET_RULES, SheetForm, SheetRules, TimeLeft
from roah_rsbb.rulebook.benchmarks import NO_LIMIT, Config, Durable, EventRules
from roah_rsbb.rulebook.changes import changes, warnings
from roah_rsbb.rulebook.config import load_benchmarks
from roah_rsbb.rulebook.errors import Place, known
from roah_rsbb.rulebook.event_ids import key_of
from roah_rsbb.rulebook.registry import PROFILES
from roah_rsbb.rulebook.standing_rules import StandingRules, read_rules
from roah_rsbb.scoring.earlier import modern
from roah_rsbb.wording.times import date_time

THEN, LATER = date_time(UTC0), date_time(UTC0 + 60.0)


def test_nothing_differs():
    assert changes(competition(a=["HNF"]), competition(a=["HNF"])) == []


def test_benchmarks():
    before = competition(a=[event("HNF", timeout=120.0), event("HWV", run=2)])
    after = competition(a=[event("HNF", timeout=120.5, total_timeout=NO_LIMIT), event("HWV", run=2)])
    hwv = after.benchmarks["HWV"]
    profile = dataclasses.replace(PROFILES["HWV"], offline_data=False, beacon=False, uses=frozenset())
    after.benchmarks["HWV"] = dataclasses.replace(
        hwv, desc="Visitors", own=profile, rules=EventRules(attempts=3),
        scoring=(DOOR, dataclasses.replace(BUMPS, desc="falls"), dataclasses.replace(hwv.scoring[1], kind=DOOR.kind)),
    )
    after.benchmarks["STB"] = dataclasses.replace(hwv, code="STB")
    assert changes(before, after) == [
        "benchmark HNF: timeout 120, now 120.5",
        "benchmark HNF: total timeout 120, now without limit",
        "benchmark HWV: subject 'About HWV', now 'Visitors'",
        "benchmark HWV: scoring: 'Achievements: changed objects': kind uint, now bool",
        "benchmark HWV: scoring: 'Penalized: bumps' removed",
        "benchmark HWV: scoring: 'Penalized: falls' added",
        "benchmark HWV: uses activation_event, bell, notifications, visitor, now nothing",
        "benchmark HWV: offline data yes, now no",
        "benchmark HWV: beacon yes, now no",
        "benchmark HWV: attempts any number, now 3",
        "benchmark STB: added",
    ]
    assert changes(after, before)[-1] == "benchmark STB: removed"


SHEET = """\
- name: Test
  desc: Fetch
  code: Fetch
  kind: task
  timeout: 300
  sheet:
    - { item: Takes it, points: 60, times: 5 }
    - { item: Custom, id: 1, points: 5 }
    - { item: Custom, id: 2, points: 5 }
    - { item: Bonus, points: 9, needs: Takes it }
  incidents: { restart: { voids: all } }
"""


def test_the_rules_of_a_sheet():
    changed = SHEET
    for old, new in (("timeout: 300", "timeout: 90.5"), ("60, times: 5", "50, times: 4"), ("all", "earlier"),
                     ("id: 1, points: 5", "id: 1, points: 6"),
                     ("needs: Takes it", "needs: { item: Takes it, least: 2 }")):
        changed = changed.replace(old, new)
    before, after = (Config(load_sheets(text), {}, ()) for text in (SHEET, changed))
    assert changes(before, after) == [
        "benchmark Fetch: timeout 300, now 90.5",
        "benchmark Fetch: total timeout 300, now 90.5",
        "benchmark Fetch: items: 'Takes it': points 60, now 50, times 5, now 4",
        "benchmark Fetch: items: 'Custom (1)': points 5, now 6",
        "benchmark Fetch: items: 'Bonus': needs: 'Takes it' removed, needs: 'Takes it ≥ 2' added",
        "benchmark Fetch: incidents: 'restart': voids all, now earlier",
        "benchmark Fetch: time limit 300 s, now 90.5 s",
    ]


def test_a_row_with_another_name_is_the_same_row():
    before, after = (Config(load_sheets(text), {}, ()) for text in (SHEET, SHEET.replace("Custom", "Special task", 1)))
    assert changes(before, after) == ["benchmark Fetch: items: 'Custom (1)': title 'Custom', now 'Special task'"]


def load_sheets(text):
    with known({"benchmarks.yaml": text}):
        return load_benchmarks("benchmarks.yaml")


def test_teams_without_their_passwords():
    zones = competition(a=["HNF"])
    before = Config(zones.benchmarks, {"A": "secret 1", "B": "secret 2"}, zones.zones)
    after = Config(zones.benchmarks, {"B": "secret 3", "C": "secret 4"}, zones.zones)
    found = changes(before, after)
    assert found == ["team 'A': removed", "team 'B': another password", "team 'C': added"]
    assert "secret" not in " ".join(found)


def test_how_many_computers_must_have_an_entry():
    before = competition(a=["HNF"])
    after = dataclasses.replace(before, durable=Durable.TWO, durable_at=Place("schedule.yaml", 3, 1))
    assert changes(before, after) == ["durable: one, now two"]
    assert changes(after, before) == ["durable: two, now one"]
    assert changes(after, dataclasses.replace(after, durable_at=Place("schedule.yaml", 4, 1))) == []


def test_days_of_standings_are_those_of_the_time_zone():
    before, rules = competition(a=["HNF"]), StandingRules()
    after = dataclasses.replace(before, time_zone="Asia/Tokyo")
    assert changes(before, after) == ["time zone: none, now Asia/Tokyo"]
    rules.stages = (Stage("All", (StageColumn("HNF", day="2026-11-28"),)),)
    before, after = (dataclasses.replace(config, ranking=rules) for config in (before, after))
    assert changes(before, after) == [
        "time zone: none, now Asia/Tokyo. The days of the stages are those of the new one"]


RANKED = """
HWV: { runs: best }
stages:
  - name: Tasks
    of: [ { test: HWV, weight: 2, attempts: best } ]
    adjustments: { Late: -5, Untidy: { from: -50, to: 0 } }
    advance: { 0: 3, 9: 4 }
    given: [ { team: A, adjustment: Late }, { team: A, adjustment: Late } ]
"""


@pytest.mark.parametrize("old, new, expected", [
    ("{ runs: best }", "{ runs: last }", ["standings of HWV: other rules"]),
    ("weight: 2", "weight: 3", ["stages: 'Tasks': of: 'HWV': weight 2, now 3"]),
    ("attempts: best", "attempts: mean of the best 2",
     ["stages: 'Tasks': of: 'HWV': attempts best, now mean of the best 2"]),
    ("9: 4", "9: 5", ["stages: 'Tasks': advance: 'from 9 teams on 4' removed, advance: 'from 9 teams on 5' added"]),
    (", { team: A, adjustment: Late }", "", ["team A, Tasks: Late -5: no longer given"]),
    (" ]\n", ", { team: B, adjustment: Untidy, points: -9, reason: cables } ]\n",
     ["team B, Tasks: Untidy -9 (cables): given"]),
])
def test_what_changed_in_the_rules_of_the_standings(tmp_path, old, new, expected):
    texts = RANKED, new.join(RANKED.rsplit(old, 1))
    configs = []
    for text in texts:
        (tmp_path / "standings.yaml").write_text(text)
        rules = read_rules(str(tmp_path / "standings.yaml"))
        configs.append(dataclasses.replace(competition(a=["HNF"]), ranking=rules))
    assert changes(*configs) == expected


def with_id(own, code="HNF", **of_event):
    """An event that is known by this id."""
    return dataclasses.replace(event(code, **of_event), id=own)


def test_points_that_change_are_said_with_the_runs_that_keep_the_old_ones():
    before = competition(a=["HWV", "HNF"])
    sixty = dataclasses.replace(DOOR, points=Decimal(60))
    after = competition(a=["HWV", "HNF"])
    limits = SheetRules(least=Decimal(0), time_left=TimeLeft(Decimal(1)))
    for config, points, rules in ((before, 60, NO_SHEET_RULES), (after, 50, limits)):
        form = modern(SheetForm((dataclasses.replace(sixty, points=Decimal(points)),), rules))
        config.benchmarks["HWV"] = dataclasses.replace(
            config.benchmarks["HWV"], scoring=form.items, sheet=form.sheet)
    row, section = f"'{DOOR.desc} ({DOOR.group}: {DOOR.desc})'", f"'{DOOR.group} ({DOOR.group}:)'"
    lines = [f"benchmark HWV: items: {section}: under '', now 'Score sheet.'",
             f"benchmark HWV: items: {row}: points 60, now 50",
             "benchmark HWV: items: 'Score sheet (Score sheet.)' added", "benchmark HWV: items: 'Time left' added"]
    assert changes(before, after) == lines
    ran = [key_of(with_id("m", "HWV")), key_of(with_id("n"))]
    assert changes(before, after, ran) == [*lines, "benchmark HWV: 1 run keeps the old score sheet"]
    assert changes(before, after, 2 * ran)[-1] == "benchmark HWV: 2 runs keep the old score sheet"


def test_the_schedule():
    before = competition(a=[with_id("m"), with_id("n", "HWV"), event("STB")], gone=["HNF", "HWV"])
    after = competition(
        new=["HNF"], a=[with_id("m", scheduled=UTC0 + 60.0), with_id("o", "HWV", team="Beta"), event("STB")])
    assert changes(before, after) == [
        f"zone 'a': HNF of Alpha, round 1, run 1: moved from {THEN} to {LATER}",
        f"zone 'a': HWV of Alpha, round 1, run 1, {THEN}: removed",
        f"zone 'a': HWV of Beta, round 1, run 1, {THEN}: added",
        "zone 'gone': removed, with 2 events",
        "zone 'new': added, with 1 event",
    ]


def test_an_event_that_moves_is_one_line_and_its_runs_are_named():
    before = competition(a=[with_id("m"), with_id("n", "HWV"), with_id("o", "STB")], b=["HOPF"])
    later = with_id("n", "HWV", scheduled=UTC0 + 60.0)
    after = competition(a=[with_id("o", "STB", round=2)], b=["HOPF", with_id("m"), later])
    ran = [*2 * [key_of(with_id("m"))], key_of(with_id("n", "HWV")), key_of(with_id("o", "STB"))]
    assert changes(before, after, ran) == [
        f"zone 'a': HNF of Alpha, round 1, run 1: moved from {THEN} to zone 'b', {THEN}. Its 2 runs stay with it",
        f"zone 'a': HWV of Alpha, round 1, run 1: moved from {THEN} to zone 'b', {LATER}. Its run stays "
        "with it",
        f"zone 'a': STB of Alpha, round 1, run 1, {THEN}: now STB of Alpha, round 2, run 1. Its run stays with it",
    ]
    assert warnings(before, after, ran) == []


def test_runs_of_events_that_are_removed_and_written_again():
    before = competition(a=["STB", with_id("m")])
    after = dataclasses.replace(competition(a=["STB"]), benchmarks=before.benchmarks)
    ran, place = [key_of(with_id("m"))], f"zone 'a': HNF of Alpha, round 1, run 1, {THEN}"
    assert changes(before, after, ran) == [f"{place}: removed. Its run stays in the results"]
    assert changes(after, before, 3 * ran) == [f"{place}: added. Its 3 runs before belong to it"]


def test_a_zone_with_another_name():
    before = competition(a=[with_id("m"), with_id("n", "HWV"), with_id("o", "STB")], b=["HOPF"])
    after = competition(c=[with_id("m"), with_id("n", "HWV", scheduled=UTC0 + 60.0)], b=["HOPF"])
    ran = [key_of(with_id("m")), *2 * [key_of(with_id("o", "STB"))]]
    after = dataclasses.replace(after, benchmarks=before.benchmarks)
    assert changes(before, after, ran) == [
        f"zone 'a': HWV of Alpha, round 1, run 1: moved from {THEN} to zone 'c', {LATER}",
        "zone 'a': removed, with 3 events: 2 move to zone 'c'. 2 runs stay in the results",
        "zone 'c': added, with 2 events",
    ]


def test_runs_of_an_event_that_has_another_benchmark_or_team_now():
    before, after = competition(a=[with_id("m"), with_id("n", "HWV")]), competition(
        a=[with_id("m", "HWV"), with_id("n", "HWV", team="Beta")])
    after = dataclasses.replace(after, benchmarks=before.benchmarks)
    ran = [key_of(with_id("m")), *2 * [key_of(with_id("n", "HWV"))]]
    assert changes(before, after, ran) == [
        f"zone 'a': HNF of Alpha, round 1, run 1, {THEN}: now HWV of Alpha, round 1, run 1",
        f"zone 'a': HWV of Alpha, round 1, run 1, {THEN}: now HWV of Beta, round 1, run 1",
    ]
    assert warnings(before, after, ran) == [
        "zone 'a': HNF of Alpha, round 1, run 1 is HWV of Alpha, round 1, run 1 now. Its run before stays a result of "
        "HNF of Alpha, and is no attempt at this event. If it is another event, delete its id (m) in the schedule file",
        "zone 'a': HWV of Alpha, round 1, run 1 is HWV of Beta, round 1, run 1 now. Its 2 runs before stay results of "
        "HWV of Alpha, and are no attempts at this event. If it is another event, delete its id (n) in the schedule "
        "file",
    ]
    assert warnings(before, after, ()) == []


def test_another_order_of_zones():
    assert changes(competition(a=["HNF"], b=["HNF"]), competition(b=["HNF"], a=["HNF"])) == [
        "schedule: another order"]
