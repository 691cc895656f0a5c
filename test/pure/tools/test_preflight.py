"""preflight: which settings it checks, with and without ROS."""

import socket
import sys

import pytest

from helpers import slots
from helpers.config_files import SHIPPED
from roah_rsbb.client.places import write_place
from roah_rsbb.comm.sockets import LOOPBACK_BROADCAST
from roah_rsbb.ground.params import BadParams
from roah_rsbb.tools import preflight
from roah_rsbb.tools.competition.files import LAUNCH, launch_text

HOST = "127.0.77.3"


@pytest.fixture
def folder(tmp_path):
    """A competition's folder. Its launch file names it, and the robots' network."""
    made = tmp_path / "erl"
    made.mkdir()
    for name in ("benchmarks", "schedule", "passwords", "standings"):
        (made / f"{name}.yaml").write_text((SHIPPED / f"{name}.yaml").read_text("utf-8"), "utf-8")
    (made / LAUNCH).write_text(launch_text([], "10.0.0.255", "10.0.0.56", True), "utf-8")
    return made


@pytest.fixture
def without_ros(tmp_path, monkeypatch):
    """The program is a command of roah-rsbb, of a user with a new home."""
    monkeypatch.setattr("sys.argv", ["roah-rsbb"])
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.delenv("ROAH_RSBB_DOOR", raising=False)
    monkeypatch.setattr("roah_rsbb.ros.display.has_display", lambda: False)
    return str(tmp_path / ".roah_rsbb" / "door.json")


@pytest.fixture
def port():
    """A port with free ones above it. Another run of these tests on this machine has other ones."""
    with slots.free_slot() as slot:
        yield slots.first_port(slot)


def settings(*words):
    return preflight.read_settings(preflight._parser().parse_args([w for w in words if ":=" not in w]), list(words))


def run(capsys, *words):
    """Run the program; returns its exit status and its lines."""
    with pytest.raises(SystemExit) as ended:
        preflight.main(list(words))
    return ended.value.code, capsys.readouterr().out.splitlines()


def on_loopback(folder, port, *more):
    """Arguments for a network that every computer has, on which nobody is listened to."""
    return [str(folder), "--listen", "0", f"rsbb_host:={LOOPBACK_BROADCAST}", f"bind_host:={HOST}",
            f"rsbb_port:={port}", f"web_port:={port + 60}", f"tablet_port:={port + 61}", f"smartif_host:={HOST}",
            f"smartif_port:={port + 62}", *more]


def test_without_a_competition_the_shipped_files():
    found = settings()
    assert found.box.files == [str(SHIPPED / f"{name}.yaml") for name in ("benchmarks", "schedule", "passwords")]
    assert (found.modules_dir, found.box.network.rsbb_host) == (str(SHIPPED / "modules"), "10.255.255.255")
    assert (found.web_port, found.tablet_port, found.smartif_port) == (8081, 8080, 6665)


@pytest.mark.parametrize("option", [[], ["--competition"]])
def test_a_competitions_launch_file_counts(folder, option):
    found = settings(*option, str(folder))
    assert found.box.files == [str(folder / f"{name}.yaml") for name in ("benchmarks", "schedule", "passwords")]
    assert (found.box.log_dir, found.box.network.rsbb_host) == (str(folder / "log"), "10.0.0.255")
    assert (found.smartif_host, found.has_devices, found.tablet_port) == ("10.0.0.56", False, 0), "none is needed"


def test_what_is_given_counts_more(folder):
    found = settings(str(folder), "--schedule-file", "/other.yaml", "log_dir:=/log", "--rsbb-host", "10.0.1.255",
                     "rsbb_port:=7000", "tablet:=true", "--tablet-port", "1234", "bell_ring_command:=play bell.wav",
                     "timeout_ring_command:=play timeout.wav")
    assert (found.box.files[1], found.box.log_dir) == ("/other.yaml", "/log")
    assert (found.box.network.rsbb_host, found.box.network.rsbb_port) == ("10.0.1.255", 7000)
    assert (found.tablet_port, found.players) == (1234, [["play", "bell.wav"], ["play", "timeout.wav"]])


@pytest.mark.parametrize("word, said", [
    ("rsbb_port:=many", "rsbb_port"), ("web_port:=70000", "web_port"), ("tablet:=perhaps", "tablet"),
    ("smartif_port:=0", "smartif_port"), ("bell_ring_command:='x", "bell_ring_command"), ("resume:=no", "resume"),
])
def test_a_wrong_setting_is_named(folder, word, said):
    with pytest.raises(BadParams, match=f"parameter {said}: found "):
        settings(str(folder), word)


def test_what_the_box_would_refuse_fails_and_nothing_else_is_checked(folder, without_ros, capsys):
    status, lines = run(capsys, str(folder), "web_prot:=1")
    assert (status, lines[0], len(lines)) == (
        1, "FAILED   there is no setting web_prot: did you mean 'web_port'?", 3)
    assert lines[1].startswith("         -> correct the settings")
    (folder / LAUNCH).unlink()
    status, lines = run(capsys, str(folder))
    assert (status, "roah-rsbb new" in lines[0]) == (1, True)


def test_arguments_of_a_launch_file_may_be_for_ros_only(folder):
    """Only roslaunch knows whether something uses them."""
    assert settings(str(folder), "camera:=ours", "standby_port:=8083").box.standby_port == 8083


def test_a_box_without_ros(folder, port, without_ros, capsys):
    status, lines = run(capsys, *on_loopback(folder, port))
    assert status == 0, lines
    said = "\n".join(lines)
    assert f"ok       terminals will find the box by {without_ros}" in lines
    assert f"ok       UDP ports {port} to {port + 50} are free" in lines
    assert f"ok       TCP port {port + 60} of the web pages is free" in lines
    assert f"ok       log_dir {folder / 'log'} can be written" in lines
    assert "a box without ROS sees no markers of " in said and "motion capture needs ROS: run the box with" in said
    assert "of the tablet's page" not in said, "its launch file does not start it"


def test_what_the_launch_file_starts_is_checked(folder, port, without_ros, capsys):
    status, lines = run(capsys, *on_loopback(folder, port, "devices:=true", "tablet:=true"))
    assert (status, [line for line in lines if line.startswith("FAILED ")]) == (1, [
        f"FAILED   the SmartIF controller at {HOST}:{port + 62} cannot be reached: Connection refused"])
    assert f"ok       TCP port {port + 61} of the tablet's page is free" in lines


def test_the_ports_of_pages_are_those_where_they_are_served(folder, port, without_ros, capsys):
    """bind_host is another address."""
    with socket.socket() as other:
        other.bind(("127.0.0.1", port + 60))
        other.listen(1)
        _, lines = run(capsys, *on_loopback(folder, port))
    assert f"FAILED   TCP port {port + 60} of the web pages cannot be used: Address already in use" in lines


def test_pages_that_are_not_served_need_no_port(folder, port, without_ros, capsys):
    _, lines = run(capsys, *on_loopback(folder, port, "web:=false"))
    assert "of the web pages" not in "\n".join(lines)


def test_a_box_that_runs_already(folder, port, without_ros, capsys):
    with socket.socket() as door:
        door.bind(("127.0.0.1", 0))
        door.listen(1)
        write_place(without_ros, f"ws://127.0.0.1:{door.getsockname()[1]}/door", "token")
        _, lines = run(capsys, *on_loopback(folder, port))
    assert f"WARNING  a box without ROS runs already: {without_ros} says where its door is" in lines
    _, lines = run(capsys, *on_loopback(folder, port))
    assert f"ok       terminals will find the box by {without_ros}" in lines, "that box was killed"


def test_a_door_that_terminals_would_not_find(folder, port, without_ros, tmp_path, capsys, monkeypatch):
    (tmp_path / "file").touch()
    monkeypatch.setenv("ROAH_RSBB_DOOR", str(tmp_path / "file" / "door.json"))
    status, lines = run(capsys, *on_loopback(folder, port))
    failed, = [line for line in lines if line.startswith("FAILED ")]
    assert (status, f"{tmp_path / 'file'} cannot be written" in failed) == (1, True)


def test_windows_matter_with_ros(without_ros, monkeypatch):
    assert preflight._check_display() == []
    monkeypatch.setattr("sys.argv", ["preflight"])
    assert "rosrun roah_rsbb referee" in preflight._check_display()[0].remedy


@pytest.mark.parametrize("missing", ["roah_rsbb.ros", "rospy"])
def test_markers_are_looked_at_only_where_ros_is(missing, monkeypatch):
    monkeypatch.delitem(sys.modules, "roah_rsbb.ros.modules.check_ground_truth", raising=False)
    monkeypatch.setitem(sys.modules, missing, None)
    assert preflight._look() is None
