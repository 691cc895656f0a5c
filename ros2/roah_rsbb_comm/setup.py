"""Builds the node and the client of the box that it uses: package roah_rsbb of this repository, as pip installs it.

The client is built into this package, because Ubuntu's pip refuses to install packages beside those of ROS 2, and so
that node and client always have the same version.
"""

import os
import pathlib
import subprocess
import sys
import tempfile

from setuptools import setup
from setuptools.command.build_py import build_py
from setuptools.command.develop import develop

NAME = "roah_rsbb_comm"
ROOT = pathlib.Path(__file__).resolve().parents[2]


def build_client(folder):
    """Build the Python package roah_rsbb into a folder. ROOT/setup.py knows which parts need no ROS 1."""
    if not (ROOT / "proto" / "roah_rsbb_msgs.proto").exists():
        raise SystemExit(f"{NAME}: {ROOT} is not the repository of roah_rsbb. This package builds only inside of it, "
                         "because it uses the repository's client: clone the whole repository")
    with tempfile.TemporaryDirectory() as info:
        built = [subprocess.run(
            [sys.executable, "setup.py", "--quiet", "egg_info", "--egg-base", info,
             "build_py", "--build-lib", str(pathlib.Path(folder).resolve())],
            cwd=ROOT, env={**os.environ, "ROAH_RSBB_PACKAGE": package}, check=False,
        ).returncode == 0 for package in ("robot", "check")]
    if not all(built):
        raise SystemExit(f"{NAME}: the client of the box was not built, see above")


class BuildWithClient(build_py):
    """`colcon build`."""

    def run(self):
        super().run()
        build_client(self.build_lib)


class DevelopWithClient(develop):
    """`colcon build --symlink-install`: the client is a copy there, too."""

    def run(self):
        super().run()
        build_client(self.install_dir)


setup(
    name=NAME,
    version="0.1.0",
    description="The comm node of roah_rsbb for robots with ROS 2",
    license="BSD-3-Clause",
    maintainer="roah_rsbb maintainers",
    maintainer_email="maintainers@roah-rsbb.invalid",
    packages=[NAME],
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{NAME}"]),
        (f"share/{NAME}", ["package.xml"]),
        (f"share/{NAME}/launch", ["launch/comm.launch.xml", "launch/dummy.launch.xml"]),
    ],
    cmdclass={"build_py": BuildWithClient, "develop": DevelopWithClient},
    zip_safe=False,
    entry_points={
        "console_scripts": [
            f"comm = {NAME}.comm:main",
            f"dummy = {NAME}.dummy:main",
            "check_robot = roah_rsbb.check.program:main",
            "dummy_box = roah_rsbb.check.dummy_box:main",
        ],
    },
)
