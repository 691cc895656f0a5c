"""preflight: motion capture, home devices and the tablet's page, as far as the schedule needs them."""

import dataclasses
import socket

import pytest

from helpers.competition import competition, event
from helpers.config_files import SHIPPED
from roah_rsbb.bmbox.framework.ground_truth import Pose3
from roah_rsbb.bmbox.host.ground_truth_of_frames import FrameState
from roah_rsbb.rulebook.benchmarks import Durable
from roah_rsbb.rulebook.errors import Place
from roah_rsbb.tools import preflight_checks as venue
from roah_rsbb.tools.preflight_checks import Severity

HOST = "127.0.77.2"
SEEN = Pose3(0.0, 0.0, 0.0, 0.0)


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "ground_truth.yaml").write_text((SHIPPED / "modules" / "ground_truth.yaml").read_text("utf-8"), "utf-8")
    return tmp_path


def sees(*missing):
    """A motion capture that sees all markers but these."""
    def look(config):
        return [FrameState(team, subject, marker.frame, None if subject in missing else SEEN,
                           f"{subject}: never seen" if subject in missing else "")
                for team, subject, marker in config.all_markers()]
    return look


def levels(found):
    return [finding.level for finding in found]


def test_nothing_is_checked_that_the_schedule_does_not_need(folder):
    loaded = competition(home=["HGTKMH", "STB"])
    assert venue.check_tablet_port(loaded, HOST, 1) == []
    assert venue.check_devices(loaded, HOST, 1) == []
    assert venue.check_ground_truth(loaded, str(folder), sees("robot")) == []


def test_entries_on_two_computers_need_a_standby():
    one = competition(home=["HGTKMH"])
    two = dataclasses.replace(one, durable=Durable.TWO, durable_at=Place("schedule.yaml", 7, 0))
    assert venue.check_standby(one, 0) == venue.check_standby(two, 8083) == []
    found, = venue.check_standby(two, 0)
    assert found.level is Severity.FAILED and "schedule.yaml:7" in found.text and "standby_port:=" in found.remedy


def test_devices_that_are_off_although_a_benchmark_needs_them():
    found, = venue.check_devices(competition(home=["HWV"]), "", 1)
    assert found.level is Severity.WARNING and "devices:=true smartif_host:=" in found.remedy


def test_the_tablets_port():
    loaded = competition(home=["HCFGAC"])
    with socket.socket() as other:
        other.bind((HOST, 0))
        other.listen(1)
        port = other.getsockname()[1]
        found, = venue.check_tablet_port(loaded, HOST, port)
        assert (found.level, f"sport = :{port}" in found.remedy) == (Severity.FAILED, True)
    assert levels(venue.check_tablet_port(loaded, HOST, port)) == [Severity.OK]


@pytest.mark.parametrize("program, level", [("preflight", Severity.WARNING), ("roah-rsbb", Severity.FAILED)])
def test_the_port_of_the_web_pages(monkeypatch, program, level):
    monkeypatch.setattr("sys.argv", [program])
    with socket.socket() as other:
        other.bind((HOST, 0))
        other.listen(1)
        port = other.getsockname()[1]
        found = venue.check_web_port(HOST, port)
        assert (found.level, "web_port" in found.remedy) == (level, True), "with ROS, runs do not need it"
    assert venue.check_web_port(HOST, port).level == Severity.OK


@pytest.mark.parametrize("code", ["HCFGAC", "HWV"])
def test_the_controller_of_the_home_devices(code):
    loaded = competition(home=[code])
    with socket.socket() as controller:
        controller.bind((HOST, 0))
        controller.listen(1)
        port = controller.getsockname()[1]
        assert levels(venue.check_devices(loaded, HOST, port)) == [Severity.OK]
    found, = venue.check_devices(loaded, HOST, port)
    assert (found.level, "smartif_host" in found.remedy) == (Severity.FAILED, True)
    assert code in found.remedy


def test_markers_that_the_schedule_needs(folder):
    loaded = competition(arena=["HNF", "HPFF"])
    assert levels(venue.check_ground_truth(loaded, str(folder), sees("table"))) == [Severity.OK]
    found, = venue.check_ground_truth(loaded, str(folder), sees("person", "table"))
    assert (found.level, found.text) == (Severity.WARNING, "marker not seen: person: never seen")


def test_without_a_ros_master_markers_are_not_checked(folder):
    found, = venue.check_ground_truth(competition(arena=["HNF"]), str(folder), lambda config: None)
    assert (found.level, "no ROS master" in found.text) == (Severity.WARNING, True)


def test_without_ros_nobody_looks_at_markers(folder, monkeypatch):
    loaded = competition(arena=["HNF"])
    found, = venue.check_ground_truth(loaded, str(folder), None)
    assert (found.level, "only ROS can see them" in found.text) == (Severity.WARNING, True)
    monkeypatch.setattr("sys.argv", ["roah-rsbb"])
    found, = venue.check_ground_truth(loaded, str(folder), None)
    assert (found.level, "a box without ROS sees no markers" in found.text) == (Severity.WARNING, True)


def test_each_zone_has_its_own_motion_capture(folder):
    (folder / "North").mkdir()
    (folder / "North" / "ground_truth.yaml").write_text("source: none\n", "utf-8")
    loaded = competition(North=["HNF"], South=[event("HNF", run=2)])
    found = venue.check_ground_truth(loaded, str(folder), sees("robot"))
    assert levels(found) == [Severity.WARNING, Severity.WARNING, Severity.OK]  # also the marker of TestingTeam
    assert found[-1].text.endswith("poses are not scored")
