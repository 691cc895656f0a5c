"""The Python package `roah_rsbb`: all of it for catkin, and the parts that need no ROS for pip.

catkin reads this file (calling its own `setup`), and runs its command `install`. It gets all packages; CMake generates
roah_rsbb.pb and installs the programs.

pip, which requests a wheel, gets the packages for teams without ROS (docs/robot_without_ros.md), with roah_rsbb.pb.
"""

import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

from setuptools import find_packages, setup
from setuptools.command.build_py import build_py

PROTO = pathlib.Path("proto", "roah_rsbb_msgs.proto")
# Python code of these protoc versions works with protobuf runtimes from 3.20, and does not require a later one. Older
# versions write code that protobuf 4 refuses (Ubuntu 20.04 has 3.6). Later ones refuse runtimes older than themselves.
FIRST_PROTOC, BEFORE_PROTOC = (3, 20), (26, 0)
RUNTIME = "protobuf>=3.20.2,<8"
# It brings protoc 25.1, and has wheels for Python 3.8 to 3.12.
COMPILER = "grpcio-tools>=1.62,<1.63; python_version<'3.13'"

# Pages that check-robot names.
PAGES = ("check_robot.md", "protocol.md", "robot_without_ros.md", "team.md")
# Modules of the wheel in packages of which it has only some.
ONLY = {"roah_rsbb.tools": ("__init__", "team"), "roah_rsbb.results": ("__init__", "page")}

COMMON = {
    "name": "roah_rsbb",
    "version": "0.1.0",
    "description": "RoAH RSBB: the Referee, Scoring and Benchmarking Box of a home-robot competition",
    "license": "BSD-3-Clause",
    "package_dir": {"": "src"},
    "python_requires": ">=3.8",
}


def usable_protoc():
    """Return the protoc on PATH if its Python code works with the declared runtimes, else None."""
    protoc = shutil.which("protoc")
    if protoc is None:
        return None
    said = subprocess.run([protoc, "--version"], stdout=subprocess.PIPE, text=True, check=False).stdout
    version = tuple(int(number) for number in re.findall("[0-9]+", said)[:2])
    return protoc if FIRST_PROTOC <= version < BEFORE_PROTOC else None


class BuildWithProtobuf(build_py):
    """Also generates roah_rsbb.pb."""

    def find_package_modules(self, package, package_dir):
        """Return the modules of a package. Some packages have modules that need ROS, or that a team does not need."""
        modules = super().find_package_modules(package, package_dir)
        only = ONLY.get(package)
        return [module for module in modules if only is None or module[1] in only]

    def run(self):
        super().run()
        package = pathlib.Path(self.build_lib, "roah_rsbb", "pb")
        package.mkdir(parents=True, exist_ok=True)
        arguments = ["-I", str(PROTO.parent), f"--python_out={package}", str(PROTO)]
        protoc = usable_protoc()
        if protoc is not None:
            status = subprocess.run([protoc, *arguments], check=False).returncode
        else:
            status = _compiler()(["protoc", *arguments])
        if status != 0:
            raise SystemExit(f"roah_rsbb: protoc could not read {PROTO}")
        (package / "__init__.py").touch()
        # The rules for dummy-box, and the pages for check-robot.
        shipped = pathlib.Path(self.build_lib, "roah_rsbb", "shipped")
        shutil.copytree("config/modules", str(shipped / "modules"), dirs_exist_ok=True)
        shutil.copy("config/benchmarks.yaml", str(shipped))
        (shipped / "docs").mkdir(exist_ok=True)
        for page in PAGES:
            shutil.copy(f"docs/{page}", str(shipped / "docs"))


def _compiler():
    try:
        from grpc_tools import protoc
    except ImportError:
        raise SystemExit(
            "roah_rsbb: neither a protoc of version 3.20 to 25 is on PATH, nor is grpcio-tools installed: "
            "install one of them (protobuf-compiler of Debian 12 has such a version)"
        ) from None
    return protoc.main


def setup_for_pip():
    """Build a wheel of the packages without ROS, or run the commands that lead to it."""
    if {"develop", "editable_wheel"} & set(sys.argv):
        raise SystemExit("roah_rsbb: 'pip install -e' cannot contain the generated roah_rsbb.pb: omit -e")
    # build/ belongs to CMake. Files of an earlier build there would end up in the wheel.
    with tempfile.TemporaryDirectory() as build_base:
        setup(
            packages=find_packages("src", include=[
                "roah_rsbb", "roah_rsbb.comm*", "roah_rsbb.model*", "roah_rsbb.robot*", "roah_rsbb.rulebook*",
                "roah_rsbb.wording*", "roah_rsbb.core*", "roah_rsbb.radio*", "roah_rsbb.bmbox*", "roah_rsbb.check*",
                "roah_rsbb.results", "roah_rsbb.capture*", "roah_rsbb.tools",
            ]),
            cmdclass={"build_py": BuildWithProtobuf},
            options={"build": {"build_base": build_base}},
            install_requires=[RUNTIME, "cryptography>=2.8", "PyYAML>=5.3.1"],
            setup_requires=[] if usable_protoc() else [COMPILER],
            entry_points={
                "console_scripts": [
                    "roah-rsbb = roah_rsbb.tools.team:main",
                ],
            },
            **COMMON,
        )


# catkin calls this file with egg_info and install or, to read it only, without a command.
PIP_COMMANDS = {"egg_info", "dist_info", "sdist", "bdist_wheel", "develop", "editable_wheel"}
if "install" not in sys.argv and PIP_COMMANDS & set(sys.argv):
    setup_for_pip()
else:
    setup(packages=find_packages("src"), **COMMON)
