"""The Python package `roah_rsbb`: all of it for catkin, and wheels of the parts that need no ROS for pip.

catkin reads this file (calling its own `setup`), and runs its command `install`. It gets all packages; CMake generates
roah_rsbb.pb and installs the programs.

pip, which requests a wheel, gets the one that the environment variable ROAH_RSBB_PACKAGE names
(docs/robot_without_ros.md), or that these sources belong to; packaging/contents.py says what is in it.
"""

import contextlib
import os
import pathlib
import re
import runpy
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

REQUIRES = {"robot": [RUNTIME, "cryptography>=2.8"],
            "check": ["PyYAML>=5.3.1", "python-dateutil>=2.7; python_version<'3.9'"],
            "box": ["tornado>=6", "qrcode>=6"]}
# Names of the wheels at an index. Each has the program roah-rsbb, because tools such as pipx look for it only there.
WHEELS = {"robot": "roah-rsbb-robot", "check": "roah-rsbb-check", "box": "roah-rsbb"}
# Packages of Debian that are in the wheel of another one.
IN_WHEEL = {"results": "box"}
WITH_PROGRAM = ("robot", "box")

# Folders whose files are in the wheels, too.
SHIPPED = ("config", "docs", "launch", "resource")
PROGRAM = {"console_scripts": ["roah-rsbb = roah_rsbb.tools.team:main"]}

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


def build_command(package, package_of):
    """Return the command that builds one package."""

    def is_in(path):
        owner = package_of(path)
        return IN_WHEEL.get(owner, owner) == package

    class Build(build_py):
        def find_package_modules(self, package_name, package_dir):
            """Return the modules of a folder that are in this package."""
            return [module for module in super().find_package_modules(package_name, package_dir)
                    if is_in(pathlib.Path(module[2]).relative_to("src").as_posix())]

        def run(self):
            super().run()
            built = pathlib.Path(self.build_lib, "roah_rsbb")
            if package == "robot":
                generate_protobuf(built / "pb")
            for file in (found for place in SHIPPED for found in pathlib.Path(place).rglob("*")):
                if file.is_file() and is_in(file.as_posix()):
                    shipped = built / "shipped_files" / file
                    shipped.parent.mkdir(parents=True, exist_ok=True)
                    shutil.copy(str(file), str(shipped))

    return Build


def generate_protobuf(folder):
    """Write the module roah_rsbb.pb."""
    folder.mkdir(parents=True, exist_ok=True)
    arguments = ["-I", str(PROTO.parent), f"--python_out={folder}", str(PROTO)]
    protoc = usable_protoc()
    if protoc is not None:
        status = subprocess.run([protoc, *arguments], check=False).returncode
    else:
        status = _compiler()(["protoc", *arguments])
    if status != 0:
        raise SystemExit(f"roah_rsbb: protoc could not read {PROTO}")
    (folder / "__init__.py").touch()


def _compiler():
    try:
        from grpc_tools import protoc
    except ImportError:
        raise SystemExit(
            "roah_rsbb: neither a protoc of version 3.20 to 25 is on PATH, nor is grpcio-tools installed: "
            "install one of them (protobuf-compiler of Debian 12 has such a version)"
        ) from None
    return protoc.main


def unpacked_package():
    """Return the package to which these sources belong; None: they are a checkout."""
    with contextlib.suppress(FileNotFoundError):
        name = re.search("^Name: (.*)$", pathlib.Path("PKG-INFO").read_text("utf-8"), re.MULTILINE)[1]
        return next(package for package, wheel in WHEELS.items() if wheel == name)
    return None


def setup_for_pip():
    """Build a wheel or a package of sources, or run the commands that lead to it."""
    if {"develop", "editable_wheel"} & set(sys.argv):
        raise SystemExit("roah_rsbb: 'pip install -e' cannot contain the generated roah_rsbb.pb: omit -e")
    package = os.environ.get("ROAH_RSBB_PACKAGE") or unpacked_package() or "robot"
    if package not in REQUIRES:
        raise SystemExit(f"roah_rsbb: ROAH_RSBB_PACKAGE is '{package}': give one of {', '.join(REQUIRES)}")
    contents = runpy.run_path(str(pathlib.Path("packaging", "contents.py")))
    needs = [f"{WHEELS[needed]}=={COMMON['version']}" for needed in contents["NEEDS"][package]
             if needed in WHEELS]
    # build/ belongs to CMake. Files of an earlier build there would end up in the wheel.
    with tempfile.TemporaryDirectory() as build_base:
        setup(
            packages=find_packages("src"),
            cmdclass={"build_py": build_command(package, contents["package_of"])},
            options={"build": {"build_base": build_base}},
            install_requires=[*REQUIRES[package], *needs],
            setup_requires=[] if usable_protoc() or package != "robot" else [COMPILER],
            entry_points=PROGRAM if package in WITH_PROGRAM else {},
            **{**COMMON, "name": WHEELS[package]},
        )


# catkin calls this file with egg_info and install or, to read it only, without a command.
PIP_COMMANDS = {"egg_info", "dist_info", "sdist", "bdist_wheel", "develop", "editable_wheel"}
if "install" not in sys.argv and PIP_COMMANDS & set(sys.argv):
    setup_for_pip()
else:
    setup(packages=find_packages("src"), **COMMON)
