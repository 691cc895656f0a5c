"""Run by tools/test_pip_install with the Python of a venv that has roah_rsbb from pip; its argument is the source tree.

Everything of the wheel imports, with protobuf, cryptography and PyYAML alone, and the documented example completes a
benchmark against a box, both of them from the wheel.
"""

import asyncio
import importlib
import importlib.metadata
import importlib.util
import os
import pathlib
import pkgutil
import signal
import subprocess
import sys

import roah_rsbb
import roah_rsbb.comm
import roah_rsbb.pb.roah_rsbb_msgs_pb2
import roah_rsbb.protocol
import roah_rsbb.robot

SOURCE = pathlib.Path(sys.argv[1])
EXAMPLE = SOURCE / "docs" / "examples" / "my_robot.py"
BIN = pathlib.Path(sys.executable).parent
FOREIGN = ("rospy", "genpy", "rospkg", "catkin_pkg", "numpy", "tornado")
LEFT_OUT = ("nodes", "journal", "devices", "tablet", "referee", "run_logs", "rqt", "results.sheet", "tools.demo")
TEAM_COMMANDS = ("check-robot", "capture", "dummy-robot", "dummy-box")


def check_imports():
    """The installed package, wholly, and nothing that a team has not installed."""
    assert pathlib.Path(sys.prefix) in pathlib.Path(roah_rsbb.__file__).parents, roah_rsbb.__file__
    found = [name for name in FOREIGN if importlib.util.find_spec(name)]
    assert not found, f"this venv is not clean: {found}"
    found = [name for name in LEFT_OUT if importlib.util.find_spec(f"roah_rsbb.{name}")]
    assert not found, f"packages that need ROS are in the wheel: {found}"
    modules = [module.name for module in pkgutil.walk_packages(roah_rsbb.__path__, "roah_rsbb.")]
    assert len(modules) > 30, modules
    for name in modules:
        if not name.endswith(".__main__"):
            importlib.import_module(name)


def check_pages():
    """The pages that the check names are in the wheel."""
    from roah_rsbb.check.findings import Cause
    from roah_rsbb.check.shipped import pages_folder

    folder = pages_folder()
    assert folder is not None and pathlib.Path(sys.prefix) in folder.parents, folder
    missing = {page for page in (cause.page.partition("#")[0] for cause in Cause) if not (folder / page).is_file()}
    assert not missing, f"pages that are not in the wheel: {missing}"


def check_programs():
    """The programs of the wheel start without warnings."""
    for command in TEAM_COMMANDS:
        ended = subprocess.run([str(BIN / "roah-rsbb"), command, "--help"], stdout=subprocess.PIPE,
                               stderr=subprocess.STDOUT, check=True, text=True)
        assert ended.stdout.startswith("usage:"), ended.stdout


async def complete_a_benchmark():
    """Run the example as a program in a run of HOPF. Returns its output."""
    sys.path.append(str(SOURCE / "test" / "pure"))
    from helpers.small_box import BROADCAST, PASSWORD, ROBOT, TEAM, SmallBox

    async with SmallBox("HOPF") as box:
        robot = await asyncio.create_subprocess_exec(
            sys.executable, "-I", str(EXAMPLE), TEAM, BROADCAST, "--port", str(box.port), "--bind", ROBOT,
            stdout=asyncio.subprocess.PIPE, stderr=asyncio.subprocess.STDOUT,
            env={**os.environ, "ROAH_RSBB_KEY": PASSWORD},
        )
        try:
            await box.run_through()
        finally:
            if robot.returncode is None:
                robot.send_signal(signal.SIGINT)
            printed = (await robot.communicate())[0].decode()
    assert [message.object_name for message in box.finished] == ["red_cup"], printed
    assert robot.returncode == 0, printed
    lines = printed.splitlines()
    assert [line.split(None, 2)[:2] for line in lines[:2]] == [["HOPF:", "preparing"], ["HOPF:", "executing"]], printed
    assert lines[2:] == ["stopped: the box sent STOP"], printed


def check_shipped():
    """The rules for dummy-box are in the wheel."""
    from roah_rsbb.check.shipped import shipped_folder
    assert shipped_folder() == pathlib.Path(roah_rsbb.__file__).parent / "shipped"
    assert (shipped_folder() / "modules" / "HNF.yaml").is_file()


check_imports()
check_pages()
check_programs()
check_shipped()
asyncio.run(complete_a_benchmark())
packages = ", ".join(f"{name} {importlib.metadata.version(name)}" for name in ("protobuf", "cryptography", "PyYAML"))
print(f"pip test: Python {sys.version.split()[0]}, {packages}: the example completed a benchmark")
