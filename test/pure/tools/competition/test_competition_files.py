"""The written files: as the box reads them, private where they must be, never over something else."""

import datetime
import os
import re
import shutil
import stat
import subprocess
from xml.etree import ElementTree

import pytest
import yaml

from helpers.config_files import SHIPPED, TEXTS
from roah_rsbb.rulebook import config
from roah_rsbb.rulebook.errors import Report
from roah_rsbb.rulebook.registry import PROFILES
from roah_rsbb.tools.competition import files
from roah_rsbb.tools.competition.files import TABLE, CannotWriteFiles, Hosts, firewall_text, loaded_for
from roah_rsbb.tools.competition.plan import Plan, PlannedRun, PlannedZone, VenueClock
from roah_rsbb.tools.competition.rulebooks import BENCHMARKS, benchmarks_text, read_rulebook

BOOK = read_rulebook(Report(), str(SHIPPED))
CLOCK = VenueClock("+01:00")
NO_HOSTS = Hosts(None, None)
AWKWARD = ("Brass Butlers", "123", "yes", "n", "Übung's", "a, {b}", "x #y", "-", "null", "2026-11-28", '"q"', "N-1 b")


def run(code, team, number=1, hour=8):
    return PlannedRun(code, team, number, 1, datetime.datetime(2026, 11, 28, hour, tzinfo=datetime.timezone.utc))


def plan(*runs, teams=("A", "B")):
    return Plan(teams, (PlannedZone("Home: 'A', {b}", runs),))


def written(directory, made, hosts=NO_HOSTS):
    new = files.new_files(BOOK, made, CLOCK, hosts, {})
    files.write_new(str(directory), new)
    return new


def load(directory):
    return config.load(*(str(directory / name) for name in (files.BENCHMARKS, files.SCHEDULE, files.PASSWORDS)))


def test_the_box_reads_what_was_planned(tmp_path):
    teams = AWKWARD
    made = plan(*(run("HNF", team, number) for number, team in enumerate(teams, 1)), run("HSUF", "ALL"), teams=teams)
    written(tmp_path, made)
    loaded, warnings = load(tmp_path)
    assert warnings == []
    assert sorted(loaded.benchmarks) == ["HNF", "HSUF"]
    assert tuple(loaded.passwords) == teams
    zone = loaded.zones[0]
    assert zone.name == "Home: 'A', {b}"
    assert [(e.benchmark.code, e.team, e.round, e.run, e.scheduled) for e in zone.events] == [
        (*r[:4], r.begins.timestamp()) for r in made.zones[0].runs]


def test_each_time_of_the_venue_follows_its_run():
    text = files.schedule_text(TEXTS["schedule"], plan(run("HNF", "A", hour=8)).zones, CLOCK)
    line = next(line for line in text.splitlines() if "HNF" in line and not line.startswith("#"))
    assert re.search(r"scheduled_time: 2026-11-28 09:00:00 \+01:00, id: [a-z0-9]{8} }  # Saturday$", line)
    assert text.startswith(TEXTS["schedule"].splitlines()[0])


def test_passwords_are_private_different_and_hard_to_guess(tmp_path):
    made = plan(run("HWV", "A"), run("HWV", "B"))
    for name in ("one", "two"):
        written(tmp_path / name, made)
    mode = stat.S_IMODE(os.stat(str(tmp_path / "one" / files.PASSWORDS)).st_mode)
    assert mode == 0o600
    passwords = [password for name in ("one", "two") for password in load(tmp_path / name)[0].passwords.values()]
    assert len(set(passwords)) == 4
    for password in (*passwords, *(files.new_password() for _ in range(200))):
        assert len(password) == 16
        assert password.isalnum()
        assert not set(password) & set("lIoO01")
        assert yaml.safe_load(password) == password


def test_a_private_file_is_so_whatever_the_umask(tmp_path):
    before = os.umask(0)
    try:
        written(tmp_path, plan(run("HWV", "A")))
    finally:
        os.umask(before)
    assert stat.S_IMODE((tmp_path / files.PASSWORDS).stat().st_mode) == 0o600


@pytest.mark.parametrize("code", PROFILES)
def test_any_benchmark_alone(code):
    text = benchmarks_text(BOOK.path(BENCHMARKS), TEXTS["benchmarks"], [code])
    assert [entry for entry in yaml.safe_load(TEXTS["benchmarks"]) if entry["code"] == code] == yaml.safe_load(text)
    assert text.startswith("# The benchmarks")


def test_all_benchmarks_are_the_shipped_file():
    assert benchmarks_text(BOOK.path(BENCHMARKS), TEXTS["benchmarks"], list(PROFILES)) == TEXTS["benchmarks"]


def test_parameters_of_the_modules_that_are_needed(tmp_path):
    written(tmp_path, plan(run("HNF", "A"), run("HWV", "A"), run("HSUF", "ALL")))
    assert sorted(os.listdir(str(tmp_path / "modules"))) == ["HNF.yaml", "ground_truth.yaml"]
    for name in ("HNF.yaml", "ground_truth.yaml"):
        assert (tmp_path / "modules" / name).read_text("utf-8") == (SHIPPED / "modules" / name).read_text("utf-8")


def test_existing_files_are_not_overwritten(tmp_path):
    (tmp_path / files.SCHEDULE).write_text("mine", encoding="utf-8")
    with pytest.raises(CannotWriteFiles) as raised:
        written(tmp_path, plan(run("HWV", "A")))
    assert f"schedule.yaml in {tmp_path} already exist" in str(raised.value)
    assert os.listdir(str(tmp_path)) == [files.SCHEDULE]
    assert (tmp_path / files.SCHEDULE).read_text("utf-8") == "mine"


def test_a_failed_write_leaves_nothing(tmp_path):
    (tmp_path / "modules").write_text("a file where a directory must be", encoding="utf-8")
    with pytest.raises(CannotWriteFiles) as raised:
        written(tmp_path, plan(run("HNF", "A")))
    assert f"{tmp_path}/modules" in str(raised.value)
    assert "hoose another folder" in str(raised.value)
    assert os.listdir(str(tmp_path)) == ["modules"]


def test_a_new_schedule_keeps_the_old_one(tmp_path):
    written(tmp_path, plan(run("HWV", "A")))
    old = (tmp_path / files.SCHEDULE).read_text("utf-8")
    passwords = (tmp_path / files.PASSWORDS).read_text("utf-8")
    before = files.write_schedule(str(tmp_path), BOOK, plan(run("HWV", "B", 7)).zones, CLOCK)
    assert before == str(tmp_path / "schedule.yaml~")
    with open(before, encoding="utf-8") as file:
        assert file.read() == old
    assert [(event.team, event.round) for event in load(tmp_path)[0].zones[0].events] == [("B", 7)]
    assert (tmp_path / files.PASSWORDS).read_text("utf-8") == passwords
    assert sorted(name for name in os.listdir(str(tmp_path)) if "schedule" in name) == [
        "schedule.yaml", "schedule.yaml~"]
    for round_ in (*range(8, 16), 15):  # the same one again takes no place
        zones = [zone._replace(runs=tuple(each._replace(id="k3x9w2mq") for each in zone.runs))
                 for zone in plan(run("HWV", "B", round_)).zones]
        files.write_schedule(str(tmp_path), BOOK, zones, CLOCK)
    assert (tmp_path / "schedule.yaml~9").read_text("utf-8") == old


def test_a_first_schedule_keeps_nothing(tmp_path):
    assert files.write_schedule(str(tmp_path), BOOK, plan(run("HWV", "B")).zones, CLOCK) == ""


@pytest.mark.parametrize("code, started", [
    ("HGTKMH", []), ("HWV", ["devices"]), ("HCFGAC", ["devices", "tablet"]), ("HNF", ["modules"]), ("HSUF", []),
])
def test_only_what_the_benchmarks_need_is_started(code, started):
    arguments = launch_arguments(files.launch_text([BOOK.benchmarks[code]], None, "10.0.0.9"))
    assert sorted(name for name in ("devices", "modules", "tablet") if arguments[name] == "true") == started
    assert ("modules_dir" in arguments) == (code == "HNF")


def test_without_the_address_of_their_controller_the_home_devices_are_off():
    arguments = launch_arguments(files.launch_text([BOOK.benchmarks["HCFGAC"]], None, None))
    assert arguments["devices"] == "false"


def test_addresses_in_the_launch_file():
    arguments = launch_arguments(files.launch_text([BOOK.benchmarks["HWV"]], "10.0.0.255", "10.0.0.9"))
    assert (arguments["rsbb_host"], arguments["smartif_host"]) == ("10.0.0.255", "10.0.0.9")


def test_the_firewall_lets_only_the_box_pass():
    text = firewall_text("firewall.nft", "enp3s0", 6666, tablet=True)
    assert 'define robots = "enp3s0"' in text
    assert "udp dport 6666-7000 accept" in text
    assert "tcp dport 8080 accept" in text
    assert "CHECK" not in text
    unknown = firewall_text("firewall.nft", None, 6666, tablet=False)
    assert "CHECK THIS NAME" in unknown
    assert "tcp dport" not in unknown


@pytest.mark.skipif(shutil.which("nft", path="/usr/sbin:/usr/bin") is None, reason="nft is not installed")
def test_nft_takes_the_firewall(tmp_path):
    (tmp_path / "firewall.nft").write_text(firewall_text("firewall.nft", "eth0", 6666, tablet=True), encoding="utf-8")
    nft = shutil.which("nft", path="/usr/sbin:/usr/bin")
    inside = ["unshare", "--user", "--map-root-user", "--net"]
    if subprocess.run([*inside, "true"], check=False).returncode:
        pytest.skip("no network namespaces here")
    listing = subprocess.run([*inside, "sh", "-c", f"{nft} -f firewall.nft && {nft} -f firewall.nft && "
                              f"{nft} list table inet {TABLE}"],
                             cwd=str(tmp_path), stdout=subprocess.PIPE, check=True).stdout.decode()
    assert loaded_for(listing) == ["eth0"]
    assert "udp dport 6666-7000 accept" in listing


def launch_arguments(text):
    root = ElementTree.fromstring(text)
    assert root.find("include").get("pass_all_args") == "true"
    shipped = ElementTree.parse(str(SHIPPED.parent / "launch" / "roah_rsbb.launch")).getroot()
    known = {arg.get("name") for arg in shipped.findall("arg")}
    assert {arg.get("name") for arg in root.findall("arg")} <= known
    assert all(arg.get("doc") for arg in root.findall("arg"))
    return {arg.get("name"): arg.get("default") for arg in root.findall("arg")}
