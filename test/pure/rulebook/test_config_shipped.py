"""The shipped files are complete, cause no warnings, and agree with the benchmarks' table."""

import calendar
import os

import pytest

from helpers.config_files import SHIPPED, TEXTS
from roah_rsbb.model.scoring import ScoreKind
from roah_rsbb.rulebook import config
from roah_rsbb.rulebook.benchmarks import ALL_TEAMS
from roah_rsbb.rulebook.registry import PROFILES, BenchmarkKind

# docs/benchmarks.md, "The table": timeout of a goal and of the whole run, in seconds.
TIMEOUTS = {
    "HGTKMH": (600, 600),
    "HWV": (600, 600),
    "HCFGAC": (600, 600),
    "HOPF": (120, 600),
    "HNF": (120, 600),
    "HSUF": (120, 120),
    "HPPF": (120, 600),
    "HPFF": (300, 305),
    "HGMF": (120, 600),
    "HOMF": (120, 600),
    "STB": (30, 120),
}
GROUPS = ["Achievements", "Penalized Behaviors", "Disqualifying Behaviors"]
# docs/benchmarks.md, "Scoring items of the TBMs": how many of each group, and how many of them are bool.
SCORING = {
    "HGTKMH": ([4, 3, 2], 2),
    "HWV": ([8, 6, 2], 8),
    "HCFGAC": ([5, 3, 3], 2),
    "HNF": ([0, 1, 2], 0),
    "HPFF": ([0, 1, 2], 0),
}


@pytest.fixture
def shipped(files):
    return files.load()[0]


def test_no_warnings_when_passwords_are_private(files):
    assert files.load()[1] == []


def test_loads_from_where_it_is_shipped():
    paths = [str(SHIPPED / f"{name}.yaml") for name in ("benchmarks", "schedule", "passwords")]
    assert set(config.load(*paths)[0].benchmarks) == set(PROFILES)


def test_every_benchmark_of_the_table(shipped):
    found = {code: (b.timeout, b.total_timeout) for code, b in shipped.benchmarks.items()}
    assert found == TIMEOUTS
    assert all(b.code == code for code, b in shipped.benchmarks.items())
    assert all(b.kind is PROFILES[code].kind for code, b in shipped.benchmarks.items())


def test_kinds():
    tasks = {code for code, profile in PROFILES.items() if profile.kind is BenchmarkKind.TASK}
    assert tasks == {"HGTKMH", "HWV", "HCFGAC"}
    assert [code for code, profile in PROFILES.items() if profile.kind is BenchmarkKind.ALL_ROBOTS] == ["HSUF"]


@pytest.mark.parametrize("code", list(TIMEOUTS))
def test_scoring_items(shipped, code):
    items = shipped.benchmarks[code].scoring
    sizes, bools = SCORING.get(code, ([0, 0, 0], 0))
    assert [sum(item.group == group for item in items) for group in GROUPS] == sizes
    assert len(items) == sum(sizes)
    assert sum(item.kind is ScoreKind.BOOL for item in items) == bools


def test_zones_and_events(shipped):
    zones = {zone.name: zone for zone in shipped.zones}
    assert list(zones) == ["Testing TestingTeam", "Task Benchmarks", "Functionality Benchmarks"]
    testing = zones["Testing TestingTeam"].events
    assert testing[0].benchmark.code == "HGTKMH"
    assert sorted(event.benchmark.code for event in testing) == sorted(PROFILES)
    for event in testing:
        assert event.team == (ALL_TEAMS if event.benchmark.code == "HSUF" else "TestingTeam")
    assert testing[0].scheduled == calendar.timegm((2015, 12, 31, 0, 0, 0))
    assert {event.benchmark.kind for event in zones["Task Benchmarks"].events} == {BenchmarkKind.TASK}


def test_passwords_are_there_but_not_in_repr(shipped):
    assert shipped.passwords["TestingTeam"] == "PASSWORD"
    assert shipped.passwords["DefaultTeam"] == "DefaultKey"
    assert shipped.passwords["DumpTeam"] == "randomkey"
    assert not any(password in repr(shipped) for password in shipped.passwords.values())


@pytest.mark.parametrize("mode, warned", [(0o600, False), (0o640, True), (0o604, True), (0o700, False)])
def test_passwords_that_others_can_read_are_a_warning_with_the_remedy(files, mode, warned):
    files.load()
    os.chmod(files.file("passwords"), mode)
    warnings = files.load()[1]
    assert len(warnings) == warned
    if warned:
        assert f"chmod 600 {files.file('passwords')}" in warnings[0]
        assert f"mode {mode:04o}" in warnings[0]


@pytest.mark.parametrize("name", list(TEXTS))
def test_the_comment_explains_every_key(name):
    comment = TEXTS[name].split("\n\n")[0]
    keys = {
        "benchmarks": ["name", "desc", "code", "timeout", "total_timeout", "scoring", "type", "bool", "uint"],
        "schedule": ["zone", "schedule", "benchmark", "team", "round, run", "scheduled_time", "UTC"],
        "passwords": ["team", "password", "CHANGE ALL OF THEM FOR EVERY COMPETITION"],
    }
    assert [key for key in keys[name] if key not in comment] == []
