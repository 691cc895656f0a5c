"""A late team: a password, and a run of everything that the others do, at times when it is free."""

import datetime
import os
import pathlib
import stat

import pytest

from roah_rsbb.rulebook import config

OPTIONS = ["--teams", "Alpha,Beta", "--benchmarks", "HWV,HNF,HSUF", "--days", "2026-11-28,2026-11-29",
           "--time-zone", "UTC"]


@pytest.fixture(name="run")
def _run(run):
    """The program, after a competition was written."""
    run("erl", *OPTIONS)
    return run


def text_of(path):
    return pathlib.Path(path).read_text("utf-8")


def load():
    return config.load(*(f"erl/{name}.yaml" for name in ("benchmarks", "schedule", "passwords")))[0]


def runs_of(team):
    return [(zone.name, event.benchmark.code, event.round, event.run,
             datetime.datetime.utcfromtimestamp(event.scheduled).strftime("%d %H:%M"))
            for zone in load().zones for event in zone.events if event.team == team]


def test_a_late_team(run):
    before, schedule = load(), text_of("erl/schedule.yaml")
    status, out, err = run("erl", "--add-team", "Home Alone", "--time-zone", "UTC")
    assert (status, err) == (0, "")
    assert "warning" not in out
    assert runs_of("Home Alone") == [
        ("Task Benchmarks", "HWV", 1, 1, "28 09:45"), ("Task Benchmarks", "HWV", 2, 1, "29 09:45"),
        ("Functionality Benchmarks", "HNF", 1, 1, "28 10:00"), ("Functionality Benchmarks", "HNF", 2, 1, "29 10:00")]
    assert "  2026-11-28 09:45  zone 'Task Benchmarks': HWV, round 1\n" in out
    after = load()
    assert {team: after.passwords[team] for team in before.passwords} == before.passwords
    assert len(after.passwords["Home Alone"]) == 16
    assert stat.S_IMODE(os.stat("erl/passwords.yaml").st_mode) == 0o600
    for old, new in zip(before.zones, after.zones):
        assert [event for event in new.events if event.team != "Home Alone"] == list(old.events)
    assert text_of("erl/schedule.yaml~") == schedule
    assert sorted(name for name in os.listdir("erl") if name.endswith(".new")) == []


def test_only_on_certain_days(run):
    assert run("erl", "--add-team", "Gamma", "--days", "2026-11-29", "--time-zone", "UTC")[0] == 0
    assert {day[:2] for *_, day in runs_of("Gamma")} == {"29"}
    assert len(runs_of("Gamma")) == 2


def test_one_run_where_two_zones_share_a_benchmark(run):
    run("two", "--teams", "A,B,C", "--benchmarks", "HWV", "--zones", "X: HWV, Y: HWV", "--days", "2026-11-28",
        "--time-zone", "UTC")
    assert run("two", "--add-team", "D", "--time-zone", "UTC")[1].count("zone '") == 1


@pytest.mark.parametrize("arguments, reported", [
    (["Alpha"], "--add-team: found team 'Alpha', which the competition has already; expected another name"),
    (["a:b"], "--add-team: found 'a:b' as a team's name; expected a name without a colon"),
    ([""], "--add-team: found an empty text as a team's name; expected a text that is not empty"),
    (["New", "--teams", "X"],
     "--teams: found this option together with --add-team; expected only --days and --time-zone"),
    (["New", "--days", "x"], "--days: found 'x' as a day; expected a day as year-month-day, such as 2026-11-28"),
])
def test_refused(run, arguments, reported):
    before = {name: text_of(f"erl/{name}") for name in ("schedule.yaml", "passwords.yaml")}
    status, _, err = run("erl", "--add-team", *arguments)
    assert (status, err) == (1, f"new_competition: {reported}\n")
    assert before == {name: text_of(f"erl/{name}") for name in before}


def test_files_with_errors_are_not_changed(run):
    with open("erl/schedule.yaml", "a", encoding="utf-8") as file:
        file.write("- zone:\n")
    before = text_of("erl/passwords.yaml")
    status, _, err = run("erl", "--add-team", "New")
    assert status == 1
    assert "erl/schedule.yaml:" in err
    assert text_of("erl/passwords.yaml") == before


def test_a_passwords_file_in_another_form(run):
    with open("erl/passwords.yaml", "w", encoding="utf-8") as file:
        file.write("{Alpha: secret1a, Beta: secret2b}")
    status, _, err = run("erl", "--add-team", "New")
    assert status == 1
    assert err.endswith("or the file does not end with a line 'team: password'\n")
    assert "New" not in load().passwords
