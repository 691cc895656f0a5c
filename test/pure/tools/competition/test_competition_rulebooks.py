"""Rulebooks: every included one makes a competition that the box takes; those of others are checked."""

import datetime
import os
import pathlib
import re

import pytest
import yaml

from helpers.config_files import SHIPPED
from roah_rsbb.rulebook import config
from roah_rsbb.rulebook.errors import Report
from roah_rsbb.rulebook.standing_rules import read_rules
from roah_rsbb.tools.competition import rulebooks

NAMES = rulebooks.names(str(SHIPPED))
OPTIONS = ["--teams", "Alpha,Beta,Gamma", "--time-zone", "UTC"]
DAYS = ["--days", "2026-11-28,2026-11-29,2026-11-30"]


def text_of(path):
    return pathlib.Path(path).read_text("utf-8")


def load(folder="new"):
    return config.load(*(f"{folder}/{name}.yaml" for name in ("benchmarks", "schedule", "passwords")))


def start(event):
    return datetime.datetime.utcfromtimestamp(event.scheduled).strftime("%d %H:%M")


def test_there_are_rulebooks():
    assert {"erl2019", "rockin2015"} <= set(NAMES)


@pytest.mark.parametrize("name", NAMES)
def test_an_included_rulebook_needs_teams_and_days_only(run, name):
    status, out, err = run("new", "--rulebook", name, *OPTIONS, *DAYS)
    assert (status, err) == (0, "")
    assert "warning" not in out
    loaded, warnings = load()
    assert warnings == []
    report = Report()
    book = rulebooks.read_rulebook(report, str(SHIPPED), name)
    assert report.errors == [] and report.warnings == []
    done = {event.benchmark.code for zone in loaded.zones for event in zone.events}
    assert done == set(loaded.benchmarks) <= set(book.benchmarks)
    assert {code: loaded.benchmarks[code] for code in done} == {code: book.benchmarks[code] for code in done}


@pytest.mark.parametrize("name, codes", [
    ("rockin2015", "HGTKMH HWV HCFGAC HOPF HNF HSUF"), ("erl2019", "HGTKMH HWV HCFGAC HOPF HNF HPPF HPFF HGMF"),
])
def test_the_leagues_of_the_past(run, name, codes):
    assert run("new", "--rulebook", name, *OPTIONS, *DAYS)[0] == 0
    assert list(load()[0].benchmarks) == codes.split()
    assert set(read_rules("new/standings.yaml")) == set(codes.split()) - {"HSUF"}
    with open(SHIPPED / "benchmarks.yaml", encoding="utf-8") as file:
        included = {entry["code"]: entry for entry in yaml.safe_load(file)}
    with open("new/benchmarks.yaml", encoding="utf-8") as file:
        assert yaml.safe_load(file) == [included[code] for code in codes.split()]


def test_options_replace_the_answers_of_a_rulebook(run):
    assert run("new", "--rulebook", "erl2019", "--benchmarks", "STB", *OPTIONS, *DAYS)[0] == 0
    assert list(load()[0].benchmarks) == ["STB"]


@pytest.fixture
def own(tmp_path):
    """Write a rulebook of an organiser."""
    def write(**files):
        folder = tmp_path / "own"
        for name, text in files.items():
            path = folder / name.replace("__", "/").replace("_yaml", ".yaml").replace("_py", ".py")
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
        return folder
    return write


BENCHMARKS = """\
# The benchmarks of our league.

# The first one.
-   {name: One, desc: Task one, code: One, kind: task, timeout: 300}
# The second one.
-   code: "Two"
    name: Two
    desc: Task two
    kind: task
    timeout: 1000
"""


def test_a_rulebook_of_an_organiser(run, own):
    own(benchmarks_yaml=BENCHMARKS, rulebook_yaml=(
        "title: Our league\nbenchmarks: one, two\nzones: 'Left: all, Right: all'\ndaily: Two, One\nbreaks: 9:20-10:00\n"
        "every: 20\nrounds: 1\nbegin: '9:00'\nend: 12:00\n"), modules__Other_py="")
    status, out, err = run("new", "--rulebook", "own", *OPTIONS, "--days", "2026-11-28,2026-11-29")
    assert (status, err) == (0, "")
    assert sorted(os.listdir("new")) == [
        "benchmarks.yaml", "competition.launch", "firewall.nft", "passwords.yaml", "schedule.yaml"]
    zones = load()[0].zones
    assert [(zone.name, [(event.benchmark.code, start(event)) for event in zone.events]) for zone in zones] == [
        ("Left", [("Two", "28 09:00"), ("Two", "28 10:00"), ("One", "29 09:00"), ("One", "29 10:00")]),
        ("Right", [("Two", "28 09:00"), ("One", "29 09:00")])]
    # Only what is needed of the answers.
    assert run("few", "--rulebook", "own", *OPTIONS, "--benchmarks", "One", "--days", "2026-11-28",
               "--daily", "all")[0] == 0
    text = text_of("few/benchmarks.yaml")
    assert text == BENCHMARKS[:BENCHMARKS.index("# The second")]


def test_decisions_of_a_rulebook(run, own):
    own(benchmarks_yaml=BENCHMARKS.replace("timeout: 1000", "timeout: { decide: Long, yes: 1000, no: 500 }"),
        decisions_yaml="# Ours.\nLong: no\n")
    assert run("new", "--rulebook", "own", "--benchmarks", "all", *OPTIONS, *DAYS)[0] == 0
    assert text_of("new/decisions.yaml") == "# Ours.\nLong: no\n"
    assert {each.chosen for each in load()[0].decisions} == {"no"}
    assert run("few", "--rulebook", "own", "--benchmarks", "One", *OPTIONS, *DAYS)[0] == 0
    assert "decisions.yaml" not in os.listdir("few")


def test_the_interval_fits_the_longest_benchmark(run, own):
    own(benchmarks_yaml=BENCHMARKS)
    assert run("new", "--rulebook", "own", "--benchmarks", "all", *OPTIONS, "--days", "2026-11-28")[0] == 0
    first, second = load()[0].zones[0].events[:2]
    assert second.scheduled - first.scheduled == 20 * 60


def test_functionality_benchmarks_come_with_their_rules_and_parameters(run, own):
    own(benchmarks_yaml="- {name: F, desc: F, code: Fetch, kind: functionality, timeout: 20}\n",
        modules__Fetch_py=text_of(SHIPPED.parent / "test/ros/config/own/modules/FetchMug.py")
        .replace("FetchMug", "Fetch"), modules__Fetch_yaml="colours: [red]\n",
        standings_yaml="Fetch: {criteria: [{name: Mugs, of: [{score: fetched}]}]}\n")
    assert run("new", "--rulebook", "./own", "--benchmarks", "all", *OPTIONS, *DAYS)[0] == 0
    assert sorted(os.listdir("new/modules")) == ["Fetch.py", "Fetch.yaml", "ground_truth.yaml"]
    own(modules__X__Fetch_yaml="colours: [blue]\n", modules__Y__Fetch_yaml="colours: [green]\n")
    run("arenas", "--rulebook", "./own", "--benchmarks", "all", "--zones", "X", *OPTIONS, *DAYS)
    assert sorted(os.listdir("arenas/modules")) == ["Fetch.py", "Fetch.yaml", "X", "ground_truth.yaml"]
    assert text_of("arenas/modules/X/Fetch.yaml") == "colours: [blue]\n"
    assert "standings.yaml" in os.listdir("new")
    launch = text_of("new/competition.launch")
    assert '$(dirname)/standings.yaml' in launch
    with open("new/standings.yaml", "a", encoding="utf-8") as file:
        file.write("Fetch: {}\n")
    status, out, _ = run("new", "--check")
    assert status == 1
    assert out.startswith("error: new/standings.yaml:2: found the key 'Fetch' again")


def test_benchmarks_for_more_days_than_there_are(run):
    err = run("new", "--rulebook", "erl2019", *OPTIONS, "--days", "2026-11-28", "--daily", "HNF, HWV")[2]
    assert "expected those of 1 day, or --daily all" in err


@pytest.mark.parametrize("text, line, reported", [
    ("benchmarks: all\n", 1, "found a rulebook without title"),
    ("title: A\nbenchmark: all\n", 2, "found the unknown key 'benchmark' in a rulebook"),
    ("title: A\nbenchmarks: Onne\n", 2, "found the text 'Onne' as benchmark; expected a benchmark code: did you mean "),
    ("title: A\nbenchmarks: []\n", 2, "found a sequence ('- item', or [a, b]) as benchmarks; expected a text"),
    ("title: A\nbenchmarks: all\nevery: soon\n", 3, "found 'soon' as minutes"),
    ("title: A\nbenchmarks: all\nevery:\n", 3, "found nothing as every; expected a text, such as 15"),
    ("title: A\nbenchmarks: all\ndaily: One, One, One\n", 3, "found no day for Two"),
    ("title: A\nbenchmarks: all\nzones: 'L: One'\n", 3, "found no zone for Two"),
])
def test_errors_of_a_rulebook(run, own, text, line, reported):
    own(benchmarks_yaml=BENCHMARKS, rulebook_yaml=text)
    status, _, err = run("new", "--rulebook", "own", *OPTIONS, *DAYS)
    assert status == 1
    assert err.startswith(f"new_competition: own/rulebook.yaml:{line}: {reported}")
    assert not os.path.exists("new")


@pytest.mark.parametrize("days, options, found", [
    (1, ["--arenas", "1"], {"Arena": 16, "Final": 2}),
    (2, [], {"Arena 1": 8, "Arena 2": 8, "Final": 2}),
    (5, ["--rounds", "6, Final: 2"], {"Arena 1": 24, "Arena 2": 24, "Final": 4}),
])
def test_an_event_of_robocup_at_home(run, days, options, found):
    """Any number of days and arenas; the Final is on the last day."""
    named = [f"2026-11-{number}" for number in range(30 - days, 30)]
    assert run("new", "--rulebook", "athome2026", "--teams", "Alpha, Beta", "--days", ",".join(named), "--time-zone",
               "UTC", "--decisions", "Posters: count", *options)[0] == 0
    loaded, _ = load()
    held = {zone.name: zone.events for zone in loaded.zones}
    assert {name: len(held[name]) for name in found} == found
    assert start(held["Final"][-1])[:2] == named[-1][-2:]
    assert text_of("new/decisions.yaml") == "Posters: count\n"


def test_what_differs_from_event_to_event_is_asked_for(run):
    typed = "Alpha\n2026-11-29\n1\n\nPosters: conut\nPosters: count\n\nUTC\n\n"
    status, out, _ = run("new", "--rulebook", "athome2026", typed=typed)
    assert status == 0
    assert "Number of arenas (press Enter for 2): " in out
    assert "  Posters: award only, or count\n" in out and "did you mean 'count'?" in out
    assert [zone.name for zone in load()[0].zones] == ["Arena", "Restaurant", "Final", "Hall"]


def test_arenas_without_a_zone_for_them(run):
    err = run("new", "--rulebook", "erl2019", *OPTIONS, *DAYS, "--arenas", "2")[2]
    assert "--arenas: found no zone with '*' in its name" in err


def test_an_unknown_rulebook(run):
    status, _, err = run("new", "--rulebook", "erl2018", *OPTIONS, *DAYS)
    assert status == 1
    assert "--rulebook: found no rulebook 'erl2018'; expected " in err
    assert "did you mean 'erl2019'?" in err


def test_a_benchmark_without_a_limit(run, own):
    own(benchmarks_yaml=BENCHMARKS.replace("timeout: 1000", "timeout: no limit\n    setup_time: 1000"))
    status, out, _ = run("new", "--rulebook", "own", "--benchmarks", "all", *OPTIONS, "--days", "2026-11-28")
    assert status == 0
    assert "warning" not in out
    first, second = load()[0].zones[0].events[:2]
    assert second.scheduled - first.scheduled == 20 * 60
    assert run("new", "--add-team", "Delta", "--time-zone", "UTC")[0] == 0


def codes_in(stages):
    return [column.test for stage in stages for column in stage.of if column.test]


@pytest.mark.parametrize("rulebook", [
    name for name in NAMES if (SHIPPED / "rulebooks" / name / "standings.yaml").exists()])
def test_a_competition_without_a_test_keeps_the_stages_of_the_others(tmp_path, rulebook):
    path = SHIPPED / "rulebooks" / rulebook / "standings.yaml"
    content = path.read_text()
    all_tests = list(dict.fromkeys(re.findall(r"test: (\w+)", content)))
    assert rulebooks.standings_text(str(path), content, all_tests) == content
    whole = read_rules(str(path), all_tests).stages
    for gone in all_tests:
        left = [test for test in all_tests if test != gone]
        (tmp_path / "standings.yaml").write_text(rulebooks.standings_text(str(path), content, left))
        stages = read_rules(str(tmp_path / "standings.yaml"), left).stages
        assert [stage.name for stage in stages] == [stage.name for stage in whole]
        assert codes_in(stages) == [test for test in codes_in(whole) if test != gone]
        assert not any(gone in stage.ties for stage in stages)


def test_stages_that_cannot_be_read_without_a_test_are_left_out(tmp_path):
    path = tmp_path / "standings.yaml"
    content = "stages:\n  - name: All\n    of:\n      - { test: T }\nT: { runs: last }\nU: { runs: last }\n"
    path.write_text(content)
    assert rulebooks.standings_text(str(path), content, ["U"]) == "U: { runs: last }\n"
