"""Run logs that were exported as MCAP, read as ROS 2 reads them."""

import json
import os
import subprocess
import sys

import pytest
import std_msgs.msg
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from programs import ROOT
from rclpy.serialization import deserialize_message
from roah_rsbb_msgs.msg import Score

CLASSES = {"uint8": std_msgs.msg.UInt8, "string": std_msgs.msg.String, "empty": std_msgs.msg.Empty, "score": Score}


@pytest.fixture(scope="module")
def exported(tmp_path_factory):
    """The folder of the files, and the entries of each run and robot."""
    folder = tmp_path_factory.mktemp("competition")
    for name in ("log", "unfit"):
        (folder / name).mkdir()
    places = (ROOT / "build/devel/lib/python3/dist-packages", ROOT / "test/pure")
    exporter = subprocess.run(
        [sys.executable, ROOT / "test/ros2/mcap_export.py", folder], capture_output=True, text=True, check=False,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(map(str, places))})
    assert exporter.returncode == 0, exporter.stderr
    return folder, json.loads(exporter.stdout.splitlines()[-1])


def messages_in(path):
    with open(path, "rb") as file:
        return list(make_reader(file).iter_messages(log_time_order=False))


def value_of(kind, message):
    if kind == "empty":
        return None
    return [message.group, message.desc, message.value] if kind == "score" else message.data


def test_every_robot_has_a_file_with_every_entry(exported):
    folder, expected = exported
    assert len(list((folder / "mcap").iterdir())) == len(expected)
    for number, port, entries in expected:
        of_run = list((folder / "mcap").glob(f"{number:03d}_*.mcap"))
        path = of_run[0] if len(of_run) == 1 else next(path for path in of_run if f"_port{port}." in path.name)
        found = messages_in(path)
        assert [(channel.topic, message.log_time) for _, channel, message in found] == [
            (topic, int(utc * 1e9)) for _, topic, utc, _ in entries]
        for (kind, _, _, value), (schema, channel, message) in zip(entries, found):
            cls = CLASSES[kind]
            assert schema.name == "/".join((cls.__module__.split(".")[0], "msg", cls.__name__))
            assert (schema.encoding, channel.message_encoding) == ("ros2msg", "cdr")
            assert value_of(kind, deserialize_message(message.data, cls)) == value
    assert {kind for _, _, entries in expected for kind, *_ in entries} == set(CLASSES)


def test_a_reader_without_ros_knows_the_types(exported):
    folder, expected = exported
    kinds = {topic: kind for _, _, entries in expected for kind, topic, *_ in entries}
    known = {(topic, str(value)) for _, _, entries in expected for _, topic, _, value in entries}
    for path in (folder / "mcap").iterdir():
        with open(path, "rb") as file:
            reader = make_reader(file, decoder_factories=[DecoderFactory()])
            for _, channel, _, message in reader.iter_decoded_messages():
                assert (channel.topic, str(value_of(kinds[channel.topic], message))) in known


def test_what_fits_into_no_message_is_left_out(exported):
    folder, _ = exported
    path, = (folder / "mcap_unfit").iterdir()
    (_, channel, message), = messages_in(path)
    assert (channel.topic, deserialize_message(message.data, std_msgs.msg.String).data) == ("/notification", "last")
