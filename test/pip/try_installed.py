"""Run by tools/test_pip_install with the Python of a venv that has wheels of roah_rsbb.

Arguments: the source tree, and the last wheel that was installed: robot, check or box. Everything in them
imports, with protobuf, cryptography and PyYAML alone, and the box with tornado. The documented example completes a
benchmark against a box, both of them from the wheels.
"""

import asyncio
import contextlib
import importlib
import importlib.metadata
import importlib.util
import os
import pathlib
import pkgutil
import signal
import socket
import subprocess
import sys
import tempfile

import roah_rsbb

SOURCE, PACKAGE = pathlib.Path(sys.argv[1]), sys.argv[2]
EXAMPLE = SOURCE / "docs" / "examples" / "my_robot.py"
BIN = pathlib.Path(sys.executable).parent
FOREIGN = ("rospy", "genpy", "rospkg", "catkin_pkg", "numpy", *([] if PACKAGE == "box" else ["tornado"]))
LIMIT_S = 120.0
INSTALLED = {each.metadata["Name"]: each.version for each in importlib.metadata.distributions()}


def check_imports():
    """The installed package, wholly, and nothing that a team has not installed."""
    assert pathlib.Path(sys.prefix) in pathlib.Path(roah_rsbb.__file__).parents, roah_rsbb.__file__
    found = [name for name in FOREIGN if importlib.util.find_spec(name)]
    assert not found, f"this venv is not clean: {found}"
    for _, name, _ in pkgutil.walk_packages(roah_rsbb.__path__, "roah_rsbb."):
        if not name.endswith(".__main__"):
            importlib.import_module(name)


def check_shipped():
    """The rules for dummy-box and the pages that the check names are in the wheels."""
    from roah_rsbb.check.report import Cause
    from roah_rsbb.ground.installed import pages_folder, shipped_folder

    assert shipped_folder() == pathlib.Path(roah_rsbb.__file__).parent / "shipped_files" / "config"
    assert (shipped_folder() / "modules" / "HNF.yaml").is_file()
    folder = pages_folder()
    assert folder is not None and pathlib.Path(sys.prefix) in folder.parents, folder
    missing = {page for page in (cause.page.partition("#")[0] for cause in Cause) if not (folder / page).is_file()}
    assert not missing, f"pages that are not in the wheel: {missing}"


def check_programs():
    """The programs of the wheels start without warnings. The others name their wheels."""
    from roah_rsbb.tools.team import COMMANDS

    for command, (package, _, _) in COMMANDS.items():
        wheel = "roah-rsbb" if package == "box" else f"roah-rsbb-{package}"
        ended = subprocess.run([str(BIN / "roah-rsbb"), command, "--help"], stdout=subprocess.PIPE,
                               stderr=subprocess.STDOUT, check=False, text=True)
        if wheel in INSTALLED:
            assert ended.stdout.startswith("usage:"), ended.stdout
        else:
            assert ended.returncode == 1 and f"package {wheel}," in ended.stdout, ended.stdout


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


def check_results():
    """The report of a competition is written from its journal, with the rules and pages of the wheel."""
    sys.path.append(str(SOURCE / "test" / "pure"))
    from helpers.results_of import write_competition

    with tempfile.TemporaryDirectory() as folder:
        write_competition(pathlib.Path(folder, "log"))
        subprocess.run([str(BIN / "roah-rsbb"), "results", "--log-dir", f"{folder}/log", "report", "--html",
                        f"{folder}/report"],
                       check=True, stdout=subprocess.DEVNULL)
        assert pathlib.Path(folder, "report", "index.html").is_file()


def run(*arguments, **options):
    """Run a command of the wheels to its end; returns what it printed."""
    ended = subprocess.run([str(BIN / "roah-rsbb"), *arguments], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                           check=False, text=True, timeout=LIMIT_S, **options)
    assert ended.returncode == 0, f"{arguments}: {ended.stdout}"
    return ended.stdout


def check_demo():
    """The demonstration completes and scores both runs; their score sheets can be printed."""
    with tempfile.TemporaryDirectory() as folder:
        printed = run("demo", "--scripted", "--duration", "0.2", "--log-dir", f"{folder}/log")
        assert printed.count("the run is completed") == 2, printed
        assert "3  Waypoints reached" in printed, printed
        run("results", "--log-dir", f"{folder}/log", "export", "--html", f"{folder}/sheets")
        assert list(pathlib.Path(folder, "sheets").glob("*.html"))


def check_box():
    """The box of a new competition is commanded from a terminal. A killed one is replaced; the next one continues."""
    with tempfile.TemporaryDirectory() as folder:
        home = {**os.environ, "HOME": folder}
        competition = str(pathlib.Path(folder, "competition"))
        run("new", competition, "--teams", "A", "--benchmarks", "HGTKMH", "--days", "2026-11-28", "--rsbb-host",
            "127.255.255.255", env=home)
        with free_udp_port() as port:
            settings = ("bind_host:=127.0.0.1", f"rsbb_port:={port}", "web_port:=0", "listen_duration:=0.2")
        with subprocess.Popen([str(BIN / "roah-rsbb"), "run", competition, "--no-browser", *settings], env=home,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as box:
            try:
                lines = iter(box.stdout.readline, "")
                served = next(line for line in lines if "as the organiser's, open" in line)
                assert "http://127.0.0.1:" in served and "/pair#" in served, served
                assert "NOT CONNECTED" in run("referee", "status", env=home)
                children = pathlib.Path(f"/proc/{box.pid}/task/{box.pid}/children").read_text().split()
                os.kill(int(children[0]), signal.SIGKILL)
                assert any("ended unexpectedly" in line for line in lines)
                next(line for line in lines if "as the organiser's, open" in line)
                assert "NOT CONNECTED" in run("referee", "status", env=home)
            finally:
                box.send_signal(signal.SIGINT)
                box.stdout.read()
        assert box.returncode == 0


@contextlib.contextmanager
def free_udp_port():
    """A public UDP port that nobody else uses."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        yield probe.getsockname()[1]


check_imports()
check_programs()
if PACKAGE == "robot":
    asyncio.run(complete_a_benchmark())
if PACKAGE == "check":
    check_shipped()
if PACKAGE == "box":
    check_results()
    check_demo()
    check_box()
versions = [f"{name} {INSTALLED[name]}" for name in ("protobuf", "cryptography", "PyYAML", "tornado")
            if name in INSTALLED]
print(f"pip test: Python {sys.version.split()[0]}, {', '.join(versions)}: {PACKAGE} works")
