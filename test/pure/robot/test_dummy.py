"""The dummy robot: every benchmark, each misbehaviour, and the program's arguments."""

import asyncio
import os
import signal
import subprocess
import sys
import threading
import time

import pytest

import roah_rsbb
from helpers.examples import ALL
from helpers.small_box import BROADCAST, NAME, PASSWORD, ROBOT, TEAM, SmallBox, free_ports, running
from roah_rsbb.comm.ciphers import Cipher
from roah_rsbb.comm.sockets import listen
from roah_rsbb.protocol import RobotState
from roah_rsbb.robot import dummy
from roah_rsbb.robot.client import RobotClient
from roah_rsbb.robot.dummy import CRASH_STATUS, DummyOptions, DummyRobot, dummy_client

QUICK = {"prepare_duration": 0.05, "execute_duration": 0.05, "seed": 1}


def dummy_at(box, **options):
    """Run a dummy robot on the box's network, in a `with` block."""
    return running(dummy_client(
        TEAM, PASSWORD, NAME, DummyOptions(**{**QUICK, **options}),
        rsbb_host=BROADCAST, rsbb_port=box.port, bind_host=ROBOT,
    ))


def run_through(code, goals=({},), until=None, **options):
    """Take a dummy robot through a run, then wait until `until(box)`. Returns the box."""
    async def body():
        async with SmallBox(code, goals) as box, dummy_at(box, **options):
            await box.run_through()
            if until is not None:
                await box.until(lambda: until(box))
            return box
    return asyncio.run(body())


@pytest.mark.parametrize("code, goals", [
    ("HGTKMH", [{}]),
    ("HOPF", [{}, {}]),
    ("HNF", [{"generic_goal": "[1, 2, 3]"}, {"target_pose_x": 1, "target_pose_y": 2, "target_pose_theta": 3}]),
    ("HPPF", [{}, {}]),
    ("HGMF", [{"generic_goal": "[0.2, 0.3, 4]"}]),
    ("HOMF", [{"initial_state": [True, False], "switches": [1, 0]}]),
    ("STB", [{"generic_goal": "goal: GOAL 1\n"}, {"generic_goal": "goal: GOAL 2\n"}]),
    ("NEWBENCHMARK", [{}]),
])
def test_every_goal_of_every_benchmark_is_completed(code, goals):
    box = run_through(code, goals)
    assert len(box.finished) == len(goals)
    with_result = code in ("HOPF", "HPPF", "STB", "NEWBENCHMARK")
    assert all(bool(message.generic_result) == with_result for message in box.finished)
    assert all(message.messages_saved > 0 for message in box.finished)


@pytest.mark.parametrize("loss", [0.0, 0.3])
def test_online_data_of_hwv_arrives_once_each_whatever_is_lost(loss):
    expected = {
        "activation_event": ["the bell rang"], "visitor": ["Deli Man"],
        "notifications": ["going to the door", "guiding the visitor", "going to the door"],
    }
    box = run_through("HWV", until=lambda box: len(box.logged["notifications"]) >= 3, loss=loss)
    assert {field: texts for field, texts in box.logged.items() if texts} == expected


def test_hcfgac_operates_everything():
    box = run_through("HCFGAC", execute_duration=0.5)
    for field in ("devices_switch_1", "devices_switch_2", "devices_switch_3", "tablet_display_map"):
        assert any(getattr(message, field) for message in box.received), field
    assert {message.devices_dimmer for message in box.received} == {0, 70}
    assert {message.devices_blinds for message in box.received} == {0, 100}
    assert len(box.logged["final_command"]) == 1


def _executes_until_stopped(code, **options):
    async def body():
        async with SmallBox(code) as box, dummy_at(box, **options):
            await box.until(lambda: box.received)
            box.start()
            await box.until(lambda: box.robot_state is RobotState.EXECUTING)
            heard = len(box.received)
            await box.until(lambda: len(box.received) >= heard + 6)  # of its burst: 0.3 s
            assert box.robot_state is RobotState.EXECUTING
            box.stop()
            await box.until(lambda: box.robot_state is RobotState.STOP)
            assert box.finished == []
    asyncio.run(body())


def test_hpff_continues_until_it_is_stopped():
    _executes_until_stopped("HPFF")


def test_a_robot_that_saves_nothing():
    box = run_through("HGTKMH", save_nothing=True)
    assert {message.messages_saved for message in box.received} == {0}


@pytest.mark.parametrize("skew", [0.0, -7.5, 100.0])
def test_a_robot_with_a_skewed_clock(skew):
    async def body():
        async with SmallBox() as box, dummy_at(box, skew=skew):
            await box.until(lambda: box.received)
            return box.received[0].time

    began = time.time()
    sent = asyncio.run(body())
    ended = time.time()
    assert began - 0.001 <= sent.sec + sent.nsec / 1e9 - skew <= ended + 0.001


@pytest.mark.parametrize("phase", ["prepare", "execute"])
def test_a_robot_that_crashes(phase):
    crashed = []

    async def body():
        options = DummyOptions(crash_in=phase, prepare_duration=0.1, execute_duration=0.1)
        async with SmallBox() as box:
            robot = DummyRobot(options, crash=lambda status: crashed.append((status, robot.client.state)))
            client = RobotClient(
                TEAM, PASSWORD, robot, NAME, rsbb_host=BROADCAST, rsbb_port=box.port, bind_host=ROBOT
            )
            task = asyncio.get_event_loop().create_task(client.run())
            await box.run_through()
            task.cancel()

    asyncio.run(body())
    state = {"prepare": RobotState.PREPARING, "execute": RobotState.EXECUTING}[phase]
    assert crashed == [(CRASH_STATUS, state)]


def test_everything_lost_is_silence():
    async def body():
        async with SmallBox() as box, dummy_at(box, loss=1.0):
            ticks = []
            await box.until(lambda: ticks.append(None) or len(ticks) > 20)
            assert box.beacons == [] and box.received == []
    asyncio.run(body())


# The program.


@pytest.fixture
def no_password(monkeypatch):
    monkeypatch.delenv(dummy.PASSWORD_VARIABLE, raising=False)


@pytest.mark.parametrize("arguments, found", [
    ([], "--team"),
    (["--team", "T"], "no password: use --password-file or the environment variable ROAH_RSBB_KEY"),
    (["--team", "T", "--password", ""], "password is empty"),
    (["--team", "", "--password", "p"], "must not be empty"),
    (["--team", "T", "--password", "p", "--password-file", "f"], "not allowed with"),
    (["--team", "T", "--password-file", "/no/such/file"], "cannot read the password file /no/such/file"),
    (["--team", "T", "--password", "p", "--loss", "1.5"], "'1.5' is not a number from 0 to 1"),
    (["--team", "T", "--password", "p", "--loss", "nan"], "not a number"),
    (["--team", "T", "--password", "p", "--skew", "fast"], "'fast' is not a number"),
    (["--team", "T", "--password", "p", "--cipher", "none"], "aes-256-cbc"),
    (["--team", "T", "--password", "p", "--crash-in", "sleep"], "prepare"),
    (["--team", "T", "--password", "p", "--bind", "10.1.2.3"], "not an address of this machine"),
    (["--team", "T", "--password", "p", "--port", "70000", "--bind", "127.0.0.2"], "70000"),
    (["--team", "T", "--password", "p", "--frob"], "--frob"),
])
def test_a_wrong_argument_is_one_clear_line(arguments, found, no_password, capsys):
    with pytest.raises(SystemExit) as end:
        dummy.main(arguments)
    text = capsys.readouterr().err or str(end.value.code)
    assert end.value.code not in (0, None)
    assert text.startswith("dummy_robot: ") and found in text
    assert text.count("\n") <= 1


def test_help_names_every_way_to_give_the_password(capsys):
    with pytest.raises(SystemExit) as end:
        dummy.main(["--help"])
    text = capsys.readouterr().out
    assert end.value.code == 0
    for name in ("ROAH_RSBB_KEY", "--password-file", "--never-end", "--crash-in", "--skew", "--loss", "--bind"):
        assert name in text


@pytest.fixture
def clients(monkeypatch):
    """The arguments of every client that the program makes; it then ends at once."""
    made = []

    class NoClient:
        def __init__(self, *arguments):
            made.append(arguments)

        async def run(self):
            pass

    monkeypatch.setattr(dummy, "dummy_client", NoClient)
    return made


def test_all_arguments_reach_the_robot(clients):
    dummy.main(
        "--team T --robot R --password p --host 127.255.255.255 --port 31000 --bind 127.0.0.2 --cipher aes-256-ecb "
        "--prepare-duration 1.5 --execute-duration 2.5 --never-end --crash-in execute --skew -0.15 --save-nothing "
        "--loss 0.25 --seed 7 __name:=dummy_robot __log:=/tmp/x.log other:=thing".split()
    )
    assert clients == [(
        "T", "p", "R", DummyOptions(1.5, 2.5, True, "execute", -0.15, True, 0.25, 7),
        "127.255.255.255", 31000, "127.0.0.2", Cipher.AES_256_ECB,
    )]


@pytest.mark.parametrize("source", ["file", "environment"])
def test_the_password_is_not_seen_in_the_list_of_processes(source, clients, tmp_path, monkeypatch, no_password):
    arguments = ["--team", "T"]
    if source == "file":
        (tmp_path / "password").write_text("Käse ohne Löcher\n", encoding="utf-8")
        arguments += ["--password-file", str(tmp_path / "password")]
    else:
        monkeypatch.setenv(dummy.PASSWORD_VARIABLE, "Käse ohne Löcher")
    dummy.main(arguments)
    assert clients[0][1] == "Käse ohne Löcher"


LOCALES = {
    "utf8": {"LANG": "C.UTF-8"}, "c": {"LANG": "C"}, "missing": {"LC_ALL": "no_SUCH"},
    # What Python does in a locale such as Latin-1: it decodes arguments by the locale.
    "ascii": {"LANG": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"},
}
# Python decodes the environment as it decodes arguments. So `make test` tests it in the most difficult locale only.
SOURCES = [*(("argument", name) for name in LOCALES),
           *(("environment", name) for name in LOCALES if ALL or name == "ascii")]


@pytest.mark.parametrize("source, name", SOURCES)
def test_a_password_in_any_letters_is_the_boxs(source, name):
    locale = LOCALES[name]
    password = "Käse ß 日本"

    async def body():
        async with SmallBox(password=password) as box:
            folders = [*roah_rsbb.__path__]
            arguments = [
                sys.executable, "-c", f"import roah_rsbb; roah_rsbb.__path__ = {folders}\n"
                "from roah_rsbb.robot.dummy import main; main()", "--team", TEAM, "--robot", NAME, "--host", BROADCAST,
                "--port", str(box.port), "--bind", ROBOT,
            ]
            environment = {
                **os.environ, **locale, **({dummy.PASSWORD_VARIABLE: password} if source == "environment" else {}),
            }
            if "LC_ALL" not in locale:
                environment.pop("LC_ALL", None)
            arguments += ["--password", password] if source == "argument" else []
            program = subprocess.Popen(
                [text.encode() for text in arguments], env={name: text.encode() for name, text in environment.items()}
            )
            try:
                await box.until(lambda: box.received or program.poll() is not None)
                assert box.received, "the program ended before its first message"
            finally:
                program.kill()
                program.wait()

    asyncio.run(body())


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_signal_ends_the_program(number):
    port = free_ports()
    with listen(BROADCAST, port, shared=True) as ear:
        ear.setblocking(True)
        ear.settimeout(20)

        def end_it():
            ear.recv(2000)  # its first beacon
            os.kill(os.getpid(), number)

        thread = threading.Thread(target=end_it)
        thread.start()
        try:
            dummy.main(
                ["--team", "T", "--password", "p", "--host", BROADCAST, "--port", str(port), "--bind", ROBOT]
            )
        finally:
            thread.join()
