"""tools/install_deps, with stand-ins for the package manager."""

import os
import pathlib
import re
import subprocess
from typing import List

import pytest

PROGRAM = pathlib.Path(__file__).resolve().parents[3] / "tools" / "install_deps"
DEBIAN = "ID=debian\nVERSION_ID=12\n"
UBUNTU = "ID=ubuntu\nVERSION_ID=20.04\n"

# Each stand-in notes how it was called. What is installed, and what the package lists have, are files' lines.
STAND_INS = {
    "dpkg-query": 'printf "installed %s\\n" $(cat "$STATE/installed")',
    "apt-cache": 'grep -qx -- "${@: -1}" "$STATE/unknown" || echo "  Candidate: 1.0"',
    "apt-get": 'echo "apt-get $*" >> "$STATE/calls"; exit "$(cat "$STATE/apt_status")"',
    "python3": 'cat "$STATE/foreign_ros" 2>/dev/null',
    "id": 'cat "$STATE/uid"',
    "sudo": 'echo "sudo $*" >> "$STATE/calls"; [ -e "$STATE/may_sudo" ] || exit 1; [ "$1" = -n ] && shift; "$@"',
}


class Machine:
    """A machine with stand-ins."""

    def __init__(self, path: pathlib.Path) -> None:
        self.path = path
        for name, text in STAND_INS.items():
            (path / name).write_text(f"#!/bin/bash\n{text}\n")
            (path / name).chmod(0o755)
        self.write("installed", "")
        self.write("unknown", "")
        self.write("uid", "0")
        self.write("apt_status", "0")
        self.write("release", DEBIAN)

    def write(self, name: str, text: str) -> None:
        """Set something about the machine."""
        (self.path / name).write_text(text)

    def install(self, path: str = "") -> "subprocess.CompletedProcess[str]":
        """Run install_deps, without a terminal."""
        return subprocess.run(
            ["/bin/bash", str(PROGRAM)], stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False,
            env={"PATH": path or f"{self.path}:{os.defpath}:/usr/bin:/bin", "STATE": str(self.path),
                 "OS_RELEASE": str(self.path / "release"), "PYTHON": str(self.path / "python3")},
        )

    @property
    def calls(self) -> str:
        """How apt-get and sudo were called, one a line."""
        calls = self.path / "calls"
        return calls.read_text() if calls.exists() else ""

    def be(self, release: str) -> None:
        """Become another system; only Debian's own archive has ROS under Debian's names."""
        self.write("release", release)
        self.write("unknown", "" if "debian" in release else "python3-rospy\n")

    def wanted(self) -> List[str]:
        """What is installed where nothing is there."""
        self.write("installed", "")
        assert self.install().returncode == 0
        words = re.search(r"Timeout=\d+ (.*)", self.calls).group(1).split()
        (self.path / "calls").unlink()
        return words


@pytest.fixture
def machine(tmp_path: pathlib.Path) -> Machine:
    return Machine(tmp_path)


@pytest.mark.parametrize("release, some", [
    (DEBIAN, {"catkin", "catkin-lint", "python3-rospy", "protobuf-compiler", "rosbash"}),
    (UBUNTU, {"ros-noetic-catkin", "python3-catkin-lint", "ros-noetic-rospy", "ros-noetic-rqt-gui"}),
])
def test_names_are_the_distribution_s(machine: Machine, release: str, some: set) -> None:
    machine.be(release)
    wanted = machine.wanted()
    assert some <= set(wanted)
    assert len(wanted) == len(set(wanted))
    assert (release is UBUNTU) == any(name.startswith("ros-noetic-") for name in wanted)


@pytest.mark.parametrize("release", [DEBIAN, UBUNTU])
def test_with_everything_there_nothing_is_done(machine: Machine, release: str) -> None:
    machine.be(release)
    machine.write("installed", "\n".join(machine.wanted()))
    machine.write("uid", "1000")
    done = machine.install()
    assert (done.returncode, done.stdout, done.stderr, machine.calls) == (0, "", "", "")


def test_only_what_is_missing_is_installed(machine: Machine) -> None:
    wanted = machine.wanted()
    machine.write("installed", "\n".join(set(wanted) - {"cmake", "rosbash"}))
    assert machine.install().returncode == 0
    update, install = machine.calls.splitlines()
    assert "update" in update
    assert install.endswith(" cmake rosbash")
    assert "sudo" not in machine.calls


def test_without_the_right_one_line_names_the_command(machine: Machine) -> None:
    machine.write("installed", "\n".join(set(machine.wanted()) - {"xvfb"}))
    machine.write("uid", "1000")
    done = machine.install()
    assert done.returncode != 0
    assert len(done.stderr.splitlines()) == 1
    assert "'apt-get install xvfb'" in done.stderr
    assert "apt-get" not in machine.calls


def test_sudo_is_used_where_it_asks_for_nothing(machine: Machine) -> None:
    machine.write("installed", "\n".join(set(machine.wanted()) - {"xvfb"}))
    machine.write("uid", "1000")
    machine.write("may_sudo", "")
    assert machine.install().returncode == 0
    assert re.search(r"^sudo env .*apt-get install .* xvfb$", machine.calls, re.MULTILINE)


def test_a_missing_package_source_is_named_with_its_remedy(machine: Machine) -> None:
    machine.write("unknown", "python3-hypothesis")
    done = machine.install()
    assert done.returncode != 0
    assert len(done.stderr.splitlines()) == 1
    assert "python3-hypothesis" in done.stderr
    assert "universe" in done.stderr
    assert "apt-get install" not in machine.calls


def test_a_system_without_ros_1_is_reported_in_one_line(machine: Machine) -> None:
    machine.write("release", UBUNTU)
    machine.write("unknown", "python3-rospy\nros-noetic-rospy\n")
    done = machine.install()
    assert done.returncode != 0
    assert len(done.stderr.splitlines()) == 1
    assert "ubuntu-20.04" in done.stderr
    assert "wiki.ros.org/noetic" in done.stderr
    assert machine.calls == "apt-get update -qq\n"


def test_without_the_right_to_fetch_the_lists_one_line_names_the_command(machine: Machine) -> None:
    machine.write("uid", "1000")
    machine.write("unknown", "python3-rospy\nros-noetic-rospy\n")
    done = machine.install()
    assert done.returncode != 0
    assert len(done.stderr.splitlines()) == 1
    assert "'apt-get update'" in done.stderr


def test_an_unknown_system_is_tried_with_a_warning(machine: Machine) -> None:
    machine.write("release", "ID=ubuntu\nVERSION_ID=24.04\n")
    done = machine.install()
    assert done.returncode == 0
    assert "ubuntu-24.04 has not been tried" in done.stderr
    assert "python3-rospy" in machine.calls


def test_a_package_that_only_some_archives_have_is_not_a_problem(machine: Machine) -> None:
    machine.write("unknown", "python3-python-qt-binding\nchromium-headless-shell\n")
    wanted = machine.wanted()
    assert not {"python3-python-qt-binding", "chromium-headless-shell"} & set(wanted)
    machine.write("installed", "\n".join(wanted))
    machine.write("uid", "1000")
    done = machine.install()
    assert (done.returncode, done.stdout, done.stderr, machine.calls) == (0, "", "", "")


def test_ros_from_another_source_gets_nothing_beside_it(machine: Machine) -> None:
    machine.write("foreign_ros", "/home/anna/conda/lib/python3.11/site-packages/rospy/__init__.py\n")
    done = machine.install()
    assert (done.returncode, done.stdout, done.stderr, machine.calls) == (0, "", "", "")


@pytest.mark.parametrize("release", ["ID=arch\n", ""])
def test_a_system_without_apt_is_reported_in_one_line(machine: Machine, release: str) -> None:
    machine.write("release", release)
    done = machine.install(path=str(machine.path / "nothing"))
    assert done.returncode != 0
    assert len(done.stderr.splitlines()) == 1
    assert "no apt" in done.stderr


def test_a_failure_of_the_package_manager_is_a_failure(machine: Machine) -> None:
    machine.write("apt_status", "100")
    assert machine.install().returncode != 0
