"""Where the door of the box of a ROS master is looked for."""

import os
import socket

import pytest

from roah_rsbb.client.places import (
    OWN_VARIABLE,
    DoorPlace,
    DoorPlaces,
    NotFound,
    file_of,
    local_door_file,
    write_place,
)


@pytest.fixture(autouse=True)
def home(tmp_path, monkeypatch):
    monkeypatch.setenv("ROS_HOME", str(tmp_path))
    return tmp_path


@pytest.mark.parametrize("host", ["localhost", "127.0.0.1", "127.0.1.1", socket.gethostname()])
def test_a_master_on_this_computer_has_a_file(home, host):
    assert file_of(f"http://{host}:11411") == os.path.join(str(home), "roah_rsbb_door_11411.json")


@pytest.mark.parametrize("uri", [
    "http://192.0.2.1:11411", "http://no-such-computer.invalid:11411", "http://:11411", "", f"http://{'x' * 70}:11411"])
def test_the_file_is_not_that_of_a_master_on_another_computer(uri):
    assert file_of(uri) == ""


def test_a_box_on_another_computer_is_not_taken_for_the_one_here(monkeypatch):
    here = "http://127.0.0.1:11411"
    write_place(file_of(here), "ws://127.0.0.1:1/door", "of the box here")
    there = DoorPlaces("http://192.0.2.1:11411")
    monkeypatch.setattr(there, "_ask",
                        lambda: setattr(there, "_of_master", DoorPlace("ws://192.0.2.1:2/door", "there")))
    assert there.find().token == "there"
    assert DoorPlaces(here).find().token == "of the box here"


@pytest.fixture
def own(tmp_path, monkeypatch):
    """The file of a box without ROS, and no ROS master in the environment."""
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.delenv("ROS_MASTER_URI", raising=False)
    monkeypatch.delenv(OWN_VARIABLE, raising=False)
    write_place(local_door_file(), "ws://127.0.0.1:3/door", "without ROS")
    return local_door_file()


def test_a_box_without_ros_is_found_unless_a_master_is_named(own, monkeypatch):
    write_place(file_of("http://localhost:11311"), "ws://127.0.0.1:1/door", "with ROS")
    assert DoorPlaces().find().token == "without ROS"
    assert DoorPlaces("http://localhost:11311").find().token == "with ROS"
    monkeypatch.setenv("ROS_MASTER_URI", "http://localhost:11311")
    assert DoorPlaces().find().token == "with ROS"


def test_the_program_without_ros_prefers_its_own_box_that_answers_to_the_master_of_the_shell(own, monkeypatch):
    write_place(file_of("http://localhost:11311"), "ws://127.0.0.1:1/door", "with ROS")
    monkeypatch.setenv("ROS_MASTER_URI", "http://localhost:11311")
    assert DoorPlaces(without_ros=True).find().token == "with ROS", "nothing answers at the place in the file"
    with socket.create_server(("127.0.0.1", 0)) as door:
        write_place(own, f"ws://127.0.0.1:{door.getsockname()[1]}/door", "without ROS")
        assert DoorPlaces(without_ros=True).find().token == "without ROS"
        assert DoorPlaces("http://localhost:11311", without_ros=True).find().token == "with ROS", "it is asked for"
        assert DoorPlaces().find().token == "with ROS"


@pytest.mark.parametrize("uri", ["http://[", "http://localhost:port", "http://localhost:99999", "garbage", "\x00"])
def test_a_master_that_no_address_names_is_reported(home, monkeypatch, uri):
    with pytest.raises(NotFound, match="ROS_MASTER_URI"):
        DoorPlaces(uri).find()


def test_nobody_is_led_from_one_box_to_another(own, monkeypatch):
    write_place(file_of("http://localhost:11311"), "ws://127.0.0.1:1/door", "with ROS")
    without = DoorPlaces()
    without.find()
    os.unlink(own)
    with pytest.raises(NotFound, match="no box of this user runs on this computer: start it with"):
        without.find()
    with_ros = DoorPlaces()
    assert with_ros.find().token == "with ROS"
    write_place(own, "ws://127.0.0.1:3/door", "without ROS")
    assert with_ros.find().token == "with ROS"


def test_one_of_several_boxes_without_ros_is_named(own, monkeypatch, tmp_path):
    other = str(tmp_path / "other" / "door.json")
    write_place(other, "ws://127.0.0.1:4/door", "another")
    monkeypatch.setenv(OWN_VARIABLE, other)
    monkeypatch.setenv("ROS_MASTER_URI", "http://localhost:11311")
    assert DoorPlaces().find().token == "another"


def test_nobody_without_ros_hears_of_a_master(own, monkeypatch):
    os.unlink(own)
    with pytest.raises(NotFound, match="roah-rsbb run"):
        DoorPlaces(without_ros=True).find()
    monkeypatch.setenv("ROS_MASTER_URI", "http://127.0.0.1:1")
    with pytest.raises(NotFound, match="ROS master at http://127.0.0.1:1 cannot be reached"):
        DoorPlaces(without_ros=True).find()
