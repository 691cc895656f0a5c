"""package.xml declares what the code imports (REP 149), so that rosdep and release tools install it."""

import pathlib
import re
import sys
import xml.etree.ElementTree as ElementTree
from typing import Iterator, Set

import pytest

from helpers.imports import imports_of

ROOT = pathlib.Path(__file__).resolve().parents[2]
# rosdep's names of Python packages that are no ROS packages. Without a name: part of another one.
NAMES = {
    "argcomplete": "python3-argcomplete", "cryptography": "python3-cryptography", "dateutil": "python3-dateutil",
    "google": "python3-protobuf",
    "jsonschema": "python3-jsonschema", "pytest": "python3-pytest", "qrcode": "python3-qrcode",
    "rospkg": "python3-rospkg-modules",
    "tornado": "python3-tornado", "yaml": "python3-yaml", "hypothesis": None, "PyQt5": "python_qt_binding",
    "setuptools": "python3-setuptools",
    "mcap": None, "mcap_ros2": None,  # no distribution has them: what needs them says how to install them
    "roah_rsbb": None, "roah_rsbb_comm_ros": None,
}
OWN_TEST_TOOLS = ("atheris", "catkin_pkg", "importlib_resources", "grpc_tools")


def _declared(*kinds: str) -> Set[str]:
    package = ElementTree.parse(str(ROOT / "package.xml")).getroot()
    return {each.text for kind in kinds for each in package.iter(kind)}


def _imported(folder: str) -> Iterator[str]:
    for path in (ROOT / folder).rglob("*.py"):
        yield from (each.module.split(".")[0] for each in imports_of(path))


def _missing(folder: str, *kinds: str) -> Set[str]:
    beside = {path.stem for place in ("test", "tools", "src") for path in (ROOT / place).rglob("*")}
    names = {
        NAMES.get(name, name) for name in set(_imported(folder)) - beside - set(OWN_TEST_TOOLS)
        if name not in sys.stdlib_module_names
    }
    return names - {None} - _declared(*kinds)


@pytest.mark.skipif(not hasattr(sys, "stdlib_module_names"), reason="Python 3.10 and later list the standard library")
@pytest.mark.parametrize("folder, kinds", [
    ("src", ("depend", "exec_depend")),
    ("test/ros", ("depend", "exec_depend", "test_depend")),
    ("test/pure", ("depend", "exec_depend", "test_depend")),
])
def test_every_imported_package_is_declared(folder: str, kinds) -> None:
    assert _missing(folder, *kinds) == set()


# Debian's names where they do not follow from those of ROS and rosdep. Without a name: needed for building only.
DEBIAN_NAMES = {
    "alsa-utils": "alsa-utils", "message_runtime": None, "python3-rospkg-modules": "python3-rospkg", "rqt_gui": None,
    "rqt_gui_py": "ros-noetic-rqt-gui-py",
}


def test_the_debian_package_depends_on_what_package_xml_declares() -> None:
    control = (ROOT / "packaging" / "debian" / "control").read_text(encoding="utf-8")
    fields = "".join(re.findall(r"^(?:Depends|Recommends|Suggests):.*(?:\n .*)*", control, re.MULTILINE))
    named = set(re.findall(r"[a-z0-9][a-z0-9.+-]+", fields))
    wanted = set()
    for name in _declared("depend", "exec_depend"):
        default = name if name.startswith("python3-") else "python3-" + name.replace("_", "-")
        wanted.add(DEBIAN_NAMES.get(name, default))
    assert wanted - {None} - named == set()
