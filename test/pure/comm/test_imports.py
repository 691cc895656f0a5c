"""Python 3.8 imports every module that needs no ROS."""

import importlib
import pkgutil
import sys

import pytest

import roah_rsbb

# Packages that need ROS, or Qt. The generated ones are found where another test has added them to the path.
WITH_ROS = ("msg", "referee", "ros", "rqt", "srv")
# Where a module needs these, another Python tests it.
OF_ROS = ("genpy", "python_qt_binding", "roah_rsbb_comm_ros", "rosbag", "rosgraph", "roslaunch", "roslib", "rosmaster",
          "rosnode", "rospkg", "rospy", "rostopic", "tf", "tf2_ros")


def names():
    for module in pkgutil.iter_modules(roah_rsbb.__path__, "roah_rsbb."):
        if module.name.rpartition(".")[2] not in WITH_ROS:
            yield module.name
            if module.ispkg:
                paths = importlib.import_module(module.name).__path__
                yield from (each.name for each in pkgutil.walk_packages(paths, f"{module.name}.", onerror=check))


def check(name):
    """Import a module."""
    try:
        importlib.import_module(name)
    except ModuleNotFoundError as error:
        missing = error.name or ""
        if missing.partition(".")[0] not in OF_ROS and missing not in ("roah_rsbb.msg", "roah_rsbb.srv"):
            raise


@pytest.mark.skipif(sys.version_info >= (3, 9), reason="other tests import them")
def test_every_module_without_ros_can_be_imported():
    found = [name for name in names() if not name.endswith(".__main__")]
    assert len(found) > 150
    for name in found:
        check(name)
