"""--check: everything that is wrong in a competition's directory, at once."""

import datetime
import re

import pytest

from helpers.config_files import SHIPPED
from helpers.time_zones import local_time
from roah_rsbb.rulebook.errors import Report
from roah_rsbb.tools.competition import files
from roah_rsbb.tools.competition.check import check
from roah_rsbb.tools.competition.files import Hosts
from roah_rsbb.tools.competition.plan import Plan, PlannedRun, PlannedZone, VenueClock
from roah_rsbb.tools.competition.rulebooks import read_rulebook

BOOK = read_rulebook(Report(), str(SHIPPED))
CLOCK = VenueClock("UTC")


def run(code, team, minute=0, number=1):
    begins = datetime.datetime(2026, 11, 28, 9, tzinfo=datetime.timezone.utc) + datetime.timedelta(minutes=minute)
    return PlannedRun(code, team, 1, number, begins)


@pytest.fixture
def competition(tmp_path):
    """Write a competition with these zones; return its directory."""
    def write(teams=("A", "B"), **zones):
        zones = zones or {"X": [run("HWV", "A"), run("HWV", "B", 15)], "Y": [run("HNF", "B"), run("HNF", "A", 15)]}
        made = Plan(teams, tuple(PlannedZone(name, tuple(runs)) for name, runs in zones.items()))
        files.write_new(str(tmp_path), files.new_files(BOOK, made, CLOCK, Hosts(None, None), {}))
        return tmp_path
    return write


def change(path, old, new):
    text = path.read_text("utf-8")
    assert old in text
    path.write_text(text.replace(old, new, 1), encoding="utf-8")


def warnings(directory):
    found = check(str(directory))
    assert found.errors == []
    return [warning.replace(str(directory) + "/", "") for warning in found.warnings]


def test_errors_of_all_files_at_once(competition):
    directory = competition()
    change(directory / files.SCHEDULE, "team: 'A'", "team: AA")
    change(directory / files.BENCHMARKS, "timeout: 600", "timeout: soon")
    change(directory / files.LAUNCH, "</launch>", "")
    found = check(str(directory))
    reported = [error.replace(str(directory) + "/", "").partition(":")[0] for error in found.errors]
    assert sorted(reported) == ["benchmarks.yaml", "competition.launch", "schedule.yaml"]
    assert found.summary == ""


def test_what_a_sheet_says_in_vain(competition):
    directory = competition()
    change(directory / files.BENCHMARKS, "  scoring:\n", "  sheet: [{item: a, points: 1}, {item: b}]\n  was:\n")
    path = directory / files.BENCHMARKS
    path.write_text(re.sub(r"  was:\n(    .*\n)+", "", path.read_text("utf-8")), "utf-8")
    assert warnings(directory)[0].endswith("'b' gives no points, and no other row depends on it: write 'points: 0' if "
                                           "it is only recorded")


def test_parameters_of_modules(competition):
    directory = competition()
    change(directory / "modules" / "HNF.yaml", "# goal_timeout: 120", "goal_timeout: long")
    change(directory / "modules" / "ground_truth.yaml", "maximum_age: 0.5", "maximum_age: old")
    reported = check(str(directory)).errors
    assert [error.partition("found ")[2].partition(";")[0] for error in reported] == [
        "the text 'long' as goal_timeout", "the text 'old' as maximum_age"]


def test_no_parameters_at_all_are_a_warning(competition):
    directory = competition()
    for path in (directory / "modules").iterdir():
        path.unlink()
    (directory / "modules").rmdir()
    assert [w for w in warnings(directory) if "the default parameters of HNF apply" in w]


@pytest.mark.parametrize("name", ["no", "file"])
def test_a_path_that_is_not_a_folder(tmp_path, name):
    (tmp_path / "file").write_text("", encoding="utf-8")
    found = check(str(tmp_path / name))
    assert found.errors == [
        f"{tmp_path}/{name}: found no such folder; expected one that new_competition created"]


def test_an_empty_directory(tmp_path):
    found = check(str(tmp_path))
    assert len(found.errors) == 3
    assert all("found no file" in error for error in found.errors)


@pytest.mark.parametrize("planned, expected", [
    ({"X": [run("HWV", "A"), run("HWV", "B", 9), run("HWV", "A", 19, 2)]},
     "schedule.yaml: zone 'X': too little time between runs: HWV of B (round 1, run 1) before the end of HWV of A "
     "(round 1, run 1)"),
    ({"X": [run("HWV", "A")], "Y": [run("HNF", "A", 9), run("HNF", "B", 25)]},
     "schedule.yaml: team 'A' is in two zones at once: HNF of A (round 1, run 1) in zone 'Y' and HWV of A (round 1, "
     "run 1) in zone 'X'"),
    ({"X": [run("HWV", "A"), run("HWV", "B", 30)], "Y": [run("HSUF", "ALL", 5)]},
     "schedule.yaml: team 'A' is in two zones at once: HSUF of ALL (round 1, run 1) in zone 'Y' and HWV of A (round 1, "
     "run 1) in zone 'X'"),
    ({"teams": ("A", "B", "C")}, "passwords.yaml: no runs in the schedule for 'C': is that intended?"),
])
def test_a_schedule_that_was_hardly_meant(competition, planned, expected):
    assert warnings(competition(**planned)) == [expected]


def test_a_run_past_midnight(competition):
    late = [run("HWV", "A", 14 * 60 + 55), run("HWV", "B", 14 * 60 + 40)]
    warning, = warnings(competition(X=late))
    assert warning == ("schedule.yaml: past midnight, and counted on the day on which it begins: HWV of A (round 1, "
                       "run 1), from 2026-11-28 23:55:00 +00:00")


def test_no_time_zone(competition):
    directory = competition()
    change(directory / "schedule.yaml", "- time_zone: UTC\n", "")
    with local_time("Asia/Tokyo"):
        warning, = warnings(directory)
    assert "schedule.yaml: no time zone, so each computer shows days and times in its own, here Asia/Tokyo." in warning
    assert "a line '- time_zone: Asia/Tokyo'" in warning


def test_many_runs_that_follow_too_soon_are_one_warning(competition):
    directory = competition(X=[run("HWV", "AB"[n % 2], n, n + 1) for n in range(9)])
    reported = warnings(directory)
    assert len(reported) == 1
    assert reported[0].endswith("; and 5 more")


def test_a_box_that_does_not_start_without_a_port_for_its_standby(competition):
    directory = competition()
    schedule = directory / files.SCHEDULE
    schedule.write_text(schedule.read_text("utf-8") + "\n- durable: two\n", encoding="utf-8")
    (found,) = warnings(directory)
    assert found.startswith(f"schedule.yaml:{len(schedule.read_text('utf-8').splitlines())}: ")
    assert "standby_port:=8083" in found
    change(directory / files.LAUNCH, "  <include", '  <arg name="standby_port" default="8083"/>\n  <include')
    assert warnings(directory) == []


def test_passwords_that_others_can_read(competition):
    directory = competition()
    (directory / files.PASSWORDS).chmod(0o644)
    assert "chmod 600" in warnings(directory)[0]


def test_no_launch_file(competition):
    directory = competition()
    (directory / files.LAUNCH).unlink()
    assert "roslaunch roah_rsbb roah_rsbb.launch" in warnings(directory)[0]


@pytest.mark.parametrize("file, old, new, expected", [
    (files.LAUNCH, "in this folder", "-- in this folder", "competition.launch:2: found invalid XML"),
    (files.LAUNCH, 'roah_rsbb.launch"', 'other.launch"', "found nothing that starts the box; expected <include"),
    ("modules/HNF.yaml", "", None, "modules/HNF.yaml: found no file"),
])
def test_one_file_that_is_wrong_or_missing(competition, file, old, new, expected):
    directory = competition()
    (directory / file).unlink() if new is None else change(directory / file, old, new)
    error, = check(str(directory)).errors
    assert expected in error


def test_a_launch_file_with_another_schedule(competition):
    directory = competition()
    change(directory / files.LAUNCH, "$(dirname)/schedule.yaml", "/other.yaml")
    assert warnings(directory) == [
        "competition.launch:11: schedule_file is '/other.yaml', but the checked file is $(dirname)/schedule.yaml"]


RULES = """\
from roah_rsbb.bmbox.framework.module import Module


class Fetch(Module):
    CODE = "FetchMug"

    async def execute(self):
        await self.goal()
"""
ENTRY = "\n- { name: F, desc: Fetch, code: FetchMug, kind: functionality, timeout: 60 }\n"


def test_benchmarks_of_its_own(competition):
    directory = competition()
    path = directory / files.BENCHMARKS
    path.write_text(path.read_text("utf-8") + ENTRY, encoding="utf-8")
    change(directory / files.SCHEDULE, "benchmark: HNF", "benchmark: FetchMug")
    rules = directory / "modules" / "FetchMug.py"
    (reported,) = check(str(directory)).errors
    assert reported == f"{rules}: found no rules for the functionality benchmark FetchMug; expected a file as in " \
                       "docs/write_a_benchmark.md"
    rules.write_text(RULES.replace("async def", "async dif"), encoding="utf-8")
    (reported,) = check(str(directory)).errors
    assert reported.startswith(f"{rules}:7: found invalid Python (")
    rules.write_text(f"import os\nos._exit(3)\n{RULES}", encoding="utf-8")
    (reported,) = check(str(directory)).errors
    assert reported.startswith(f"{rules}: found rules that end their process, or hang, while they are loaded; expected")
    rules.write_text(RULES, encoding="utf-8")
    assert check(str(directory)).errors == []


def test_files_of_a_zone(competition):
    directory = competition(North=[run("HNF", "A")], South=[run("HNF", "B")])
    own = directory / "modules" / "North"
    own.mkdir()
    (own / "HNF.yaml").write_text("starting_pose: [0, 0]\n", "utf-8")
    (own / "ground_truth.yaml").write_text("source: nothing\n", "utf-8")
    reported = {error.replace(str(directory) + "/", "").partition(": ")[0] for error in check(str(directory)).errors}
    assert reported == {"modules/North/HNF.yaml:1", "modules/North/ground_truth.yaml:1"}


def test_files_that_no_zone_reads(competition):
    directory = competition(North=[run("HNF", "A")], South=[run("HNF", "B")])
    for zone in ("Nort", "South"):
        (directory / "modules" / zone).mkdir()
    (directory / "modules" / "South" / "HNF.py").write_text("", "utf-8")
    assert warnings(directory) == [
        "modules/Nort: not used: no zone of the schedule has this name: did you mean 'North'?",
        "modules/South/HNF.py: not used: rules are the same in all zones, so put them into modules",
    ]
