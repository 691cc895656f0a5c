"""A small competition, made by hand: benchmarks, events and zones for the tests of the core."""

from roah_rsbb.model.records import ItemRecord, RunRecord, StopRecord
from roah_rsbb.model.scoring import ScoreKind, ScoringItem
from roah_rsbb.rulebook.benchmarks import NO_RULES, Benchmark, Config, ScheduledEvent, ZonePlan
from roah_rsbb.rulebook.event_ids import known_by

UTC0 = 1_800_000_000.0
TEAMS = ("Alpha", "Beta", "Gamma")

DOOR = ScoringItem("Achievements", "detects the door", ScoreKind.BOOL)
OBJECTS = ScoringItem("Achievements", "changed objects", ScoreKind.UINT)
BUMPS = ScoringItem("Penalized", "bumps", ScoreKind.UINT)
SCORING = (DOOR, OBJECTS, BUMPS)


def benchmark(code, timeout=600.0, total_timeout=None, scoring=SCORING, rules=NO_RULES, **others):
    """A benchmark of that code; times in seconds."""
    total = timeout if total_timeout is None else total_timeout
    return Benchmark(code, f"Benchmark {code}", f"About {code}", timeout, total, scoring, rules=rules, **others)


def event(code="HGTKMH", team="Alpha", round=1, run=1, scheduled=UTC0, **of_benchmark):
    """An event of the schedule."""
    return ScheduledEvent(benchmark(code, **of_benchmark), team, round, run, scheduled)


def id_of(event):
    """The id of an event. One that is not from a file has the one that it would get there."""
    return event.id or known_by(event, ())


def competition(teams=TEAMS, **zones):
    """A configuration: each zone by its name, with its events or with the codes of its events."""
    plans = [
        ZonePlan(name, tuple(event(e) if isinstance(e, str) else e for e in events))
        for name, events in zones.items()
    ]
    benchmarks = {e.benchmark.code: e.benchmark for plan in plans for e in plan.events}
    return Config(benchmarks, {team: f"password of {team}" for team in teams}, tuple(plans))


def run_record(run=1, zone="tbm", identity=None, **fields):
    """The record of a run that was stopped and left; its items are those of `SCORING`, at 0."""
    items = tuple(ItemRecord(item.group, item.desc, item.kind.name.lower(), 0) for item in SCORING)
    record = RunRecord(
        identity or f"HGTKMH-{6000 + run}-{UTC0 + run:.3f}", zone, "HGTKMH", "Alpha", 1, run, UTC0, UTC0 + run,
        started_utc=UTC0 + run, closed_utc=UTC0 + run + 1.0, end_reason="stopped", items=items,
        stops=(StopRecord(UTC0 + run, "Anna", "stopped", "Benchmark stopped by the referee"),), robots=("r1",),
    )
    return record._replace(**fields)
