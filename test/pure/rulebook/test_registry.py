"""The registry of benchmarks: what robots in the field know. It is the only place with codes."""

import pathlib
import re

import pytest

from roah_rsbb.rulebook.registry import (
    OTHER,
    OTHER_NUMBER,
    PROFILES,
    STRINGS,
    USES,
    BenchmarkKind,
    GoalForm,
    ResultForm,
    profile_of,
)

ROOT = pathlib.Path(__file__).resolve().parents[3]
CODES = re.compile(rf"\b({'|'.join(PROFILES)})\b")


@pytest.mark.parametrize("folder", ["core", "comm", "ros", "robot"])
def test_no_other_file_names_a_code(folder):
    found = [
        f"{path.relative_to(ROOT)}:{number}: {line.strip()}"
        for path in sorted((ROOT / "src" / "roah_rsbb" / folder).rglob("*.py"))
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1) if CODES.search(line)
    ]
    assert found == []


def test_the_numbers_are_the_ones_of_the_message():
    text = (ROOT / "msg" / "Benchmark.msg").read_text(encoding="utf-8")
    constants = {name: int(number) for name, number in re.findall(r"^uint8 (\w+) = (\d+)$", text, re.MULTILINE)}
    assert {code: profile.number for code, profile in PROFILES.items()} == {
        **{name: number for name, number in constants.items() if name != "NONE"}, "HOMF": 11
    }


def test_a_number_belongs_to_one_benchmark():
    numbers = [profile.number for profile in PROFILES.values()]
    assert len(set(numbers)) == len(numbers)
    assert not {0, OTHER_NUMBER} & set(numbers)


def test_what_robots_in_the_field_offer_and_expect():
    """Names, forms and numbers that teams have built their programs for."""
    goals = {code: profile.goal for code, profile in PROFILES.items() if profile.goal is not GoalForm.NONE}
    assert goals == {
        "HNF": GoalForm.WAYPOINT, "HGMF": GoalForm.PLACEMENT, "HOMF": GoalForm.SWITCHES, "STB": GoalForm.STRING,
    }
    results = {code: profile.result for code, profile in PROFILES.items() if profile.result is not ResultForm.NONE}
    assert results == {"HOPF": ResultForm.OBJECT, "HPPF": ResultForm.PERSON, "STB": ResultForm.ANY}
    assert {code: set(profile.uses) for code, profile in PROFILES.items() if profile.uses} == {
        "HWV": {"notifications", "activation_event", "visitor", "bell"},
        "HCFGAC": {"final_command", "devices", "tablet"},
        "HNF": {"notifications"},
        "HOMF": {"notifications"},
    }
    assert [code for code, profile in PROFILES.items() if profile.prepare_ends_goal] == ["HNF"]
    assert [code for code, profile in PROFILES.items() if profile.runs_until_timeout] == ["HPFF"]
    assert all(profile.offline_data for profile in PROFILES.values())


def test_strings_are_fields_of_a_robots_message():
    proto = (ROOT / "proto" / "roah_rsbb_msgs.proto").read_text(encoding="utf-8")
    assert all(re.search(rf"repeated string {name}\b", proto) for name in STRINGS)


def test_a_robot_offers_everything_in_a_benchmark_that_it_does_not_know():
    assert profile_of("FETCH_MUG") is OTHER
    assert OTHER.uses == frozenset(USES)
    assert (OTHER.number, OTHER.goal, OTHER.result) == (255, GoalForm.TEXT, ResultForm.TEXT)


def _rows(page):
    """The table "The table" of docs/benchmarks.md, by code."""
    part = page[page.index("\n## The table\n"):]
    rows = re.findall(r"^\| ([A-Z]{3,6}) \|(.*)\|$", part[:part.index("\n## ", 1)], re.MULTILINE)
    return {code: [cell.strip() for cell in rest.split("|")] for code, rest in rows}


def test_the_page_says_the_same():
    rows = _rows((ROOT / "docs" / "benchmarks.md").read_text(encoding="utf-8"))
    assert list(rows) == list(PROFILES)
    kinds = {BenchmarkKind.TASK: "TBM", BenchmarkKind.FUNCTIONALITY: "FBM", BenchmarkKind.ALL_ROBOTS: "all robots"}
    for code, (_, kind, _, _, last) in rows.items():
        profile = PROFILES[code]
        assert kind == kinds[profile.kind], code
        forms, _, uses = last.partition("; uses: ")
        assert set(filter(None, uses.split(", "))) == profile.uses, code
        goal, _, result = forms.partition(" → ")
        assert (goal == "–") is (profile.goal is GoalForm.NONE), code
        assert result in ("", "–") or profile.result is not ResultForm.NONE, code
