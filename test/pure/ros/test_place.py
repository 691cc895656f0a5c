"""Where the door of the box of a ROS master is looked for."""

import os
import socket

import pytest

from roah_rsbb.document.place import DoorPlace, write_place
from roah_rsbb.ros.place import DoorPlaces, file_of


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
