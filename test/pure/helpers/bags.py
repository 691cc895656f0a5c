"""Run logs in tests without a ROS master: skipped where rosbag or this package's built messages are not there."""

import pathlib

import pytest

import roah_rsbb

rosbag = pytest.importorskip("rosbag")

_built = pathlib.Path(__file__).resolve().parents[3] / "build/devel/lib/python3/dist-packages/roah_rsbb"
if _built.is_dir() and str(_built) not in roah_rsbb.__path__:
    roah_rsbb.__path__.append(str(_built))
pytest.importorskip("roah_rsbb.msg")

SCORE, STATE, TEXT, END = "/rsbb_log/score", "/rsbb_log/rsbb_state", "/rsbb_log/rsbb_state_desc", "/rsbb_log/end"
UUID = "0123abcd-0123-0123-0123-0123456789ab"
NAME = f"online_log_2027-01-15_08-00-00_Alpha_round1_run1_{UUID}.bag"
UTC = 1_800_000_000.25


def entries(count, first=0):
    """Entries of a run's log, each of which differs from all others."""
    return [(TEXT, f"entry {number}", UTC + number) for number in range(first, first + count)]


def read(path):
    """All entries of a closed bag, in their order; raises rosbag.ROSBagException for any other."""
    with rosbag.Bag(str(path)) as bag:
        return [(topic, _value(message)) for topic, message, _ in bag.read_messages()]


def _value(message):
    fields = [getattr(message, name) for name in message.__slots__]
    return tuple(fields) if len(fields) > 1 else fields[0] if fields else None


def plain(logged):
    """Topics and values of entries."""
    return [(topic, value) for topic, value, _ in logged]
