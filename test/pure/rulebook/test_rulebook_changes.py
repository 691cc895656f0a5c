"""The list of what differs between two configurations."""

import dataclasses

from helpers.competition import BUMPS, DOOR, UTC0, competition, event
from roah_rsbb.rulebook.benchmarks import NO_LIMIT, Config
from roah_rsbb.rulebook.changes import changes
from roah_rsbb.rulebook.registry import PROFILES


def test_nothing_differs():
    assert changes(competition(a=["HNF"]), competition(a=["HNF"])) == []


def test_benchmarks():
    before = competition(a=[event("HNF", timeout=120.0), event("HWV", run=2)])
    after = competition(a=[event("HNF", timeout=120.5, total_timeout=NO_LIMIT), event("HWV", run=2)])
    hwv = after.benchmarks["HWV"]
    profile = dataclasses.replace(PROFILES["HWV"], offline_data=False, uses=frozenset())
    after.benchmarks["HWV"] = dataclasses.replace(
        hwv, desc="Visitors", own=profile,
        scoring=(DOOR, dataclasses.replace(BUMPS, desc="falls"), dataclasses.replace(hwv.scoring[1], kind=DOOR.kind)),
    )
    after.benchmarks["STB"] = dataclasses.replace(hwv, code="STB")
    assert changes(before, after) == [
        "benchmark HNF: timeout 120, now 120.5",
        "benchmark HNF: total timeout 120, now without limit",
        "benchmark HWV: subject 'About HWV', now 'Visitors'",
        "benchmark HWV: scoring: 'Achievements: changed objects' changed",
        "benchmark HWV: scoring: 'Penalized: bumps' removed",
        "benchmark HWV: scoring: 'Penalized: falls' added",
        "benchmark HWV: uses activation_event, bell, notifications, visitor, now nothing",
        "benchmark HWV: offline data yes, now no",
        "benchmark STB: added",
    ]
    assert changes(after, before)[-1] == "benchmark STB: removed"


def test_teams_without_their_passwords():
    zones = competition(a=["HNF"])
    before = Config(zones.benchmarks, {"A": "secret 1", "B": "secret 2"}, zones.zones)
    after = Config(zones.benchmarks, {"B": "secret 3", "C": "secret 4"}, zones.zones)
    found = changes(before, after)
    assert found == ["team 'A': removed", "team 'B': another password", "team 'C': added"]
    assert "secret" not in " ".join(found)


def test_the_schedule():
    before = competition(a=[event("HNF"), event("HWV"), event("STB")], gone=["HNF", "HWV"])
    after = competition(
        new=["HNF"], a=[event("HNF", scheduled=UTC0 + 60.0), event("HWV", team="Beta"), event("STB")])
    assert changes(before, after) == [
        "zone 'a': HNF of Alpha, round 1, run 1: moved from 2027-01-15 08:00:00 UTC to 2027-01-15 08:01:00 UTC",
        "zone 'a': HWV of Alpha, round 1, run 1, 2027-01-15 08:00:00 UTC: removed",
        "zone 'a': HWV of Beta, round 1, run 1, 2027-01-15 08:00:00 UTC: added",
        "zone 'gone': removed, with 2 events",
        "zone 'new': added, with 1 event",
    ]


def test_another_order_of_zones():
    assert changes(competition(a=["HNF"], b=["HNF"]), competition(b=["HNF"], a=["HNF"])) == [
        "schedule: another order"]
