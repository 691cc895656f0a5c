"""The types of roah_rsbb_comm_ros have the MD5 sums that the original package had in each year."""

import json
import pathlib

import pytest

genmsg = pytest.importorskip("genmsg")
from genmsg import gentools, msg_loader  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[3]
RECORDED = json.loads((ROOT / "test" / "data" / "roah_rsbb_comm_ros_md5.json").read_text())
FILES = [(generation, path) for generation, of in RECORDED.items() for path in of["md5"]]


def _md5(path, of_generation):
    """As the build takes it: the generation's own file, or that of roah_rsbb."""
    context = genmsg.MsgContext.create_default()
    msg_loader.load_msg_from_string(context, "float64 x\nfloat64 y\nfloat64 theta\n", "geometry_msgs/Pose2D")
    own = ROOT / "roah_rsbb_comm_ros" / "generations" / of_generation / pathlib.PurePath(path).name
    load = msg_loader.load_msg_from_string if path.endswith(".msg") else msg_loader.load_srv_from_string
    text = (own if own.exists() else ROOT / path).read_text()
    return gentools.compute_md5(context, load(context, text, f"roah_rsbb_comm_ros/{own.stem}"))


@pytest.mark.parametrize("generation, path", FILES)
def test_the_sum_is_the_originals(generation, path):
    assert _md5(path, generation) == RECORDED[generation]["md5"][path]


def test_what_differs_between_the_generations():
    """A folder has the types that differ from those of 2020, and no other."""
    for generation in RECORDED:
        folder = ROOT / "roah_rsbb_comm_ros" / "generations" / generation
        for path in folder.glob("*.msg"):
            name = f"msg/{path.name}"
            assert RECORDED[generation]["md5"][name] != RECORDED["2020"]["md5"][name]
