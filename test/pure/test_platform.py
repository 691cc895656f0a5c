"""What operating systems do differently: each on this system, and as Windows and macOS say that they do it.

Neither of these was tried. `helpers/as_on_windows.py` says what is missing there.
"""

import ast
import asyncio
import errno
import json
import os
import pathlib
import signal
import socket
import subprocess
import sys
import time
import types

import pytest

import roah_rsbb
from helpers.as_on_windows import NAMES, WindowsFiles
from roah_rsbb import durable, platform
from roah_rsbb.signs_of_life import Lifeline, Watch

PACKAGE = pathlib.Path(platform.__file__).parent
TIMEOUT_S = 60.0


def as_on_windows(monkeypatch):
    """Let the functions do as on Windows; returns what stands for its modules."""
    files = WindowsFiles()
    for name, value in {"WINDOWS": True, "HAS_TIMES": False, "fcntl": None, "msvcrt": files, "_winapi": files}.items():
        monkeypatch.setattr(platform, name, value)
    for module in (os, signal, socket, time):
        lacking = types.SimpleNamespace(**{name: getattr(module, name) for name in dir(module)
                                           if name not in NAMES[module.__name__].split()})
        monkeypatch.setattr(platform, module.__name__, lacking)
    return files


@pytest.fixture(params=["this system", "Windows"])
def each(request, monkeypatch):
    """Both systems, one after the other; the value says whether it is Windows."""
    if request.param == "Windows":
        as_on_windows(monkeypatch)
    return request.param == "Windows"


@pytest.fixture
def windows(monkeypatch):
    return as_on_windows(monkeypatch)


@pytest.fixture
def macos(monkeypatch):
    monkeypatch.setattr(platform, "MACOS", True)


# -- files --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("mode, before, after", [
    ("x+b", None, b"new"), ("w+b", None, b"new"), ("w+b", b"longer", b"new"), ("r+b", b"longer", b"newger"),
    ("wb", None, b"new"),
])
def test_a_file_is_opened(each, tmp_path, mode, before, after):
    path = tmp_path / "file"
    if before is not None:
        path.write_bytes(before)
    with open(str(path), mode, opener=platform.open_file) as file:
        file.write(b"new")
    assert path.read_bytes() == after
    with open(str(path), "rb", opener=platform.open_file) as file:
        assert file.read() == after


def test_what_is_appended_comes_at_the_end(each, tmp_path):
    fd = platform.open_file(str(tmp_path / "file"), os.O_WRONLY | os.O_APPEND | os.O_CREAT, 0o644)
    os.write(fd, b"one")
    os.lseek(fd, 0, os.SEEK_SET)
    os.write(fd, b"two")
    os.close(fd)
    assert (tmp_path / "file").read_bytes() == b"onetwo"


def test_a_file_that_cannot_be_opened(each, tmp_path):
    (tmp_path / "there").touch()
    with pytest.raises(FileExistsError):
        platform.open_file(str(tmp_path / "there"), os.O_RDWR | os.O_CREAT | os.O_EXCL)
    with pytest.raises(FileNotFoundError):
        platform.open_file(str(tmp_path / "missing"), os.O_RDWR | os.O_TRUNC)


def test_a_locked_file_is_not_locked_again(each, tmp_path):
    path = str(tmp_path / "file")
    with open(path, "w+b", buffering=0) as one, open(path, "rb") as other:
        one.write(b"content")
        platform.lock(one.fileno())
        with pytest.raises(BlockingIOError):
            platform.lock(other.fileno())
        assert (one.tell(), other.read()) == (7, b"content")
    with open(path, "rb") as other:
        platform.lock(other.fileno())


def test_whether_a_file_is_locked_is_known_without_a_lock(each, tmp_path):
    path = str(tmp_path / "file")
    assert not platform.is_locked(path)
    assert not os.path.exists(path)
    with open(path, "w+b") as file:
        platform.lock(file.fileno())
        assert platform.is_locked(path)
        os.chmod(path, 0o444)
        assert platform.is_locked(path)
    assert not platform.is_locked(path)


def test_on_windows_no_byte_of_a_file_is_locked(windows, tmp_path):
    """Nobody else could read it."""
    with open(str(tmp_path / "file"), "w+b") as file:
        platform.lock(file.fileno())
    assert windows.locked == [1 << 40]


def test_a_file_system_without_locks_is_no_locked_file(windows, tmp_path, monkeypatch):
    def locking(*_arguments):
        raise OSError(errno.EINVAL, "not supported")

    monkeypatch.setattr(windows, "locking", locking)
    with open(str(tmp_path / "file"), "w+b") as file, pytest.raises(OSError, match="not supported") as raised:
        platform.lock(file.fileno())
    assert not isinstance(raised.value, BlockingIOError)


def test_reading_and_writing_at_a_place(each, tmp_path):
    with open(str(tmp_path / "file"), "w+b", buffering=0) as file:
        assert platform.write_at(file.fileno(), b"0123456789", 5) == 10
        assert platform.write_at(file.fileno(), memoryview(b"ab"), 7) == 2
        assert platform.read_at(file.fileno(), 4, 6) == b"1ab4"
        assert platform.read_at(file.fileno(), 100, 13) == b"89"
        assert platform.read_at(file.fileno(), 100, 15) == b""


def test_on_windows_no_thread_moves_the_place_of_another(windows, tmp_path):
    """Otherwise it would read from the wrong place, or write there."""
    def alone(function):
        def called(*arguments):
            assert platform._position.locked()
            return function(*arguments)
        return called

    for name in ("lseek", "read", "write"):
        setattr(platform.os, name, alone(getattr(os, name)))
    with open(str(tmp_path / "file"), "w+b", buffering=0) as file:
        platform.write_at(file.fileno(), b"0123456789", 0)
        assert platform.read_at(file.fileno(), 2, 8) == b"89"


class FullSync:
    """`fcntl` of macOS."""

    F_FULLFSYNC = 51

    def __init__(self, error=0):
        self.error, self.count = error, 0

    def fcntl(self, fd, what):
        assert what == self.F_FULLFSYNC
        self.count += 1
        if self.error:
            raise OSError(self.error, os.strerror(self.error))


@pytest.mark.parametrize("error, expected", [
    (0, []), (errno.ENOTSUP, ["fsync"]), (errno.EIO, errno.EIO), (errno.ENOSPC, errno.ENOSPC)])
def test_macos_syncs_the_memory_of_the_disk(monkeypatch, error, expected):
    """fsync after an error would say that all is well."""
    full, synced = FullSync(error), []
    monkeypatch.setattr(platform, "fcntl", full)
    monkeypatch.setattr(os, "fsync", lambda fd: synced.append("fsync"))
    if isinstance(expected, int):
        with pytest.raises(OSError, match="") as raised:
            platform.sync(0)
        assert raised.value.errno == expected and not synced
    else:
        platform.sync(0)
        assert synced == expected
    assert full.count == 1


def test_files_and_folders_are_synced(each, tmp_path, monkeypatch):
    real, synced = os.fsync, []
    monkeypatch.setattr(platform.os, "fsync", lambda fd: (synced.append(os.readlink(f"/proc/self/fd/{fd}")), real(fd)))
    (tmp_path / "file").touch()
    durable.sync(str(tmp_path / "file"))
    durable.sync(str(tmp_path))
    assert synced == [str(tmp_path / "file"), *([] if each else [str(tmp_path)])]
    durable.write_file(str(tmp_path / "file"), b"content")
    assert (tmp_path / "file").read_bytes() == b"content"


def test_files_that_others_may_read(tmp_path, monkeypatch):
    path = tmp_path / "file"
    path.touch()
    path.chmod(0o600)
    assert platform.open_to_others(str(path)) == 0
    path.chmod(0o640)
    assert platform.open_to_others(str(path)) == 0o640
    as_on_windows(monkeypatch)
    assert platform.open_to_others(str(path)) == 0


# -- the computer and its processes -------------------------------------------------------------------


def test_the_start_of_the_computer():
    assert platform.boot_id() == pathlib.Path("/proc/sys/kernel/random/boot_id").read_text().strip()


def test_on_windows_it_is_when_the_monotonic_clock_began(windows):
    now = [1_764_000_010.0, 1000.0]
    platform.time.time, platform.time.monotonic = (lambda: now[0]), (lambda: now[1])
    first = platform.boot_id()
    now[:] = [now[0] + 86400.02, now[1] + 86400.0]  # the same start, a day later
    assert platform.boot_id() == first
    now[:] = [now[0] + 300.0, 20.0]
    assert platform.boot_id() not in (first, "")


def test_on_macos_the_system_says_it(macos, monkeypatch):
    def run(command, **options):
        assert command == ["sysctl", "-n", "kern.bootsessionuuid"]
        return subprocess.run([sys.executable, "-c", "print('A-B')"], **options)

    monkeypatch.setattr(platform, "subprocess", types.SimpleNamespace(run=run, PIPE=subprocess.PIPE))
    assert platform.boot_id() == "A-B"


def test_the_clock_that_runs_in_sleep(monkeypatch):
    before = time.clock_gettime(time.CLOCK_BOOTTIME)
    assert before <= platform.running_s() <= time.clock_gettime(time.CLOCK_BOOTTIME)
    as_on_windows(monkeypatch)
    assert time.monotonic() <= platform.running_s() <= time.monotonic() + TIMEOUT_S


def test_the_status_of_a_process():
    assert platform.status_of(os.getpid())[0] in ("R", "S")
    assert platform.status_of(1 << 30) == [""]


def test_processors(monkeypatch):
    assert platform.processors() == len(os.sched_getaffinity(0))
    monkeypatch.delattr(os, "sched_getaffinity")
    assert platform.processors() == os.cpu_count()
    monkeypatch.delattr(os, "fork")
    assert platform.processors() == 1


def test_the_superuser(each, monkeypatch):
    assert platform.is_root() == (os.geteuid() == 0 and not each)


def test_a_process_ends_with_those_that_it_started():
    """The output ends when both of them have ended."""
    process = subprocess.Popen(["bash", "-c", "sleep 1000 & echo ready; wait"], stdout=subprocess.PIPE,
                               start_new_session=True)
    with process:
        assert process.stdout.readline() == b"ready\n"
        platform.end_with_children(process)
        assert process.stdout.read() == b""
    platform.end_with_children(process)  # it has ended already


def test_on_windows_a_program_of_the_system_ends_them(windows, monkeypatch):
    commands = []
    monkeypatch.setattr(subprocess, "run", lambda command, **_options: commands.append(command))
    platform.end_with_children(types.SimpleNamespace(pid=17, kill=lambda: commands.append("kill")))
    assert commands == [["taskkill", "/F", "/T", "/PID", "17"], "kill"]


def test_signals_that_windows_does_not_have(monkeypatch):
    assert platform.signal_named("SIGHUP") is signal.SIGHUP
    as_on_windows(monkeypatch)
    assert platform.signal_named("SIGHUP") is None


# -- the loop -----------------------------------------------------------------------------------------


@pytest.fixture
def loop():
    loop = platform.new_loop()
    yield loop
    loop.close()


@pytest.fixture
def kept_signals():
    kept = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    yield
    for number, handler in kept.items():
        signal.signal(number, handler)


def without_signals(loop):
    """Let a loop be one of Windows."""
    def add_signal_handler(number, callback):
        raise NotImplementedError

    loop.add_signal_handler = add_signal_handler


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_the_end_comes_into_the_loop(each, loop, kept_signals, number):
    if each:
        without_signals(loop)
    ended = loop.create_future()
    platform.on_end(loop, lambda: ended.set_result("ended"))
    loop.call_soon(os.kill, os.getpid(), number)
    assert loop.run_until_complete(asyncio.wait_for(ended, TIMEOUT_S)) == "ended"
    if not each:
        loop.remove_signal_handler(signal.SIGINT)
        loop.remove_signal_handler(signal.SIGTERM)


def test_on_windows_the_loop_wakes_for_signals_again_and_again(kept_signals):
    timers = []
    loop = types.SimpleNamespace(call_later=lambda delay, work, *arguments: timers.append((delay, work, arguments)))
    without_signals(loop)
    platform.on_end(loop, lambda: None)
    for number in range(1, 4):
        assert len(timers) == number
        delay, work, arguments = timers[-1]
        assert delay < 0.5
        work(*arguments)


def test_a_loop_waits_for_sockets(loop):
    ours, theirs = socket.socketpair()
    with ours, theirs:
        read = loop.create_future()
        loop.add_reader(ours, lambda: read.set_result(ours.recv(10)))
        theirs.send(b"here")
        assert loop.run_until_complete(asyncio.wait_for(read, TIMEOUT_S)) == b"here"
        loop.remove_reader(ours)


def test_on_windows_the_loop_of_a_program_does_so_too(windows, monkeypatch):
    class Policy(asyncio.DefaultEventLoopPolicy):
        made = 0

        def new_event_loop(self):
            Policy.made += 1
            return super().new_event_loop()

    async def work():
        return 5

    monkeypatch.setattr(asyncio, "WindowsSelectorEventLoopPolicy", Policy, raising=False)
    try:
        assert platform.run(work()) == 5
    finally:
        asyncio.set_event_loop_policy(None)
    assert Policy.made == 1


def test_input_comes_into_the_loop_until_its_end(each, loop):
    if each:
        def add_reader(file, callback):
            raise OSError("it is not a socket")

        loop.add_reader = add_reader
    reading, writing = os.pipe()
    came, ended = [], loop.create_future()

    def take(data):
        assert asyncio.get_event_loop() is loop
        came.append(data)
        if not data:
            ended.set_result(None)
        elif b"".join(came) == b"one":
            os.write(writing, b"two")
            os.close(writing)

    with open(reading, "rb") as file:
        platform.on_input(loop, file, take)
        os.write(writing, b"one")
        loop.run_until_complete(asyncio.wait_for(ended, TIMEOUT_S))
    assert b"".join(came) == b"onetwo" and came.count(b"") == 1


def test_there_may_be_no_input(each, loop):
    with pytest.raises(ValueError, match="no input"):
        platform.on_input(loop, None, print)


# -- sockets ------------------------------------------------------------------------------------------


class Endpoint:
    """A socket that notes its options, and reads what it is given."""

    def __init__(self, *reads):
        self.options, self.reads = [], list(reads)

    def setsockopt(self, level, option, value):
        assert (level, value) == (socket.SOL_SOCKET, 1)
        self.options.append(option)

    def recvfrom(self, size):
        read = self.reads.pop(0)
        if isinstance(read, Exception):
            raise read
        return read


def options(shared):
    endpoint = Endpoint()
    platform.set_up(endpoint, shared)
    return endpoint.options


def test_a_port_is_shared_or_not(monkeypatch):
    monkeypatch.setattr(platform, "HAS_TIMES", False)
    assert (options(True), options(False)) == ([socket.SO_REUSEADDR], [])


def test_on_macos_two_options_share_a_port(macos, monkeypatch):
    monkeypatch.setattr(platform, "HAS_TIMES", False)
    assert (options(True), options(False)) == ([socket.SO_REUSEADDR, socket.SO_REUSEPORT], [])


def test_on_windows_nobody_takes_a_port_that_is_not_shared(windows):
    platform.socket.SO_EXCLUSIVEADDRUSE = -5
    assert (options(True), options(False)) == ([socket.SO_REUSEADDR], [-5])


def test_a_port_in_use(each):
    assert platform.is_in_use(OSError(errno.EADDRINUSE, ""))
    assert platform.is_in_use(OSError(errno.EACCES, "")) == each
    assert not platform.is_in_use(OSError(errno.EADDRNOTAVAIL, ""))


def test_errors_of_sockets_have_words(monkeypatch):
    assert platform.reason_of(OSError(errno.ENETDOWN, "other")) == os.strerror(errno.ENETDOWN)
    as_on_windows(monkeypatch)
    assert platform.reason_of(OSError(10050, "the network is down")) == "the network is down"


def test_on_windows_a_datagram_that_did_not_arrive_is_no_error(windows):
    """It is reported to the next one who reads."""
    endpoint = Endpoint(ConnectionResetError(), ConnectionResetError(), (b"x", ("10.0.0.1", 5)), BlockingIOError())
    assert platform.receive(endpoint) == (b"x", ("10.0.0.1", 5), None)
    with pytest.raises(BlockingIOError):
        platform.receive(endpoint)


def test_where_broadcasts_are_received(each):
    assert platform.host_for_broadcasts("10.0.0.255") == ("0.0.0.0" if each else "10.0.0.255")


def test_signs_of_life_are_seen_where_there_are_such_sockets(each, tmp_path):
    watch = Watch(str(tmp_path), time.monotonic)
    watch.look()
    Lifeline(str(tmp_path)).send()
    watch.look()
    watch.close()
    assert watch.silence.pid == (0 if each else os.getpid())
    assert not (watch.is_gone or watch.is_hung or watch.is_starting)


def test_interfaces(monkeypatch):
    assert ("lo", "127.0.0.1") in [(name, address) for name, address, _ in platform.interfaces()]
    as_on_windows(monkeypatch)
    platform.socket.gethostname = lambda: "pc"
    platform.socket.gethostbyname_ex = lambda name: (name, [], ["10.0.0.5"])
    assert platform.interfaces() == [("pc", "127.0.0.1", ""), ("pc", "10.0.0.5", "")]

    def unknown(name):
        raise socket.gaierror("unknown")

    platform.socket.gethostbyname_ex = unknown
    assert platform.interfaces() == [("pc", "127.0.0.1", "")]


# -- the programs that need no ROS --------------------------------------------------------------------

# What needs ROS or only runs on Linux, and the only part of tools/ that runs anywhere.
LINUX_ONLY = ("capture", "nodes", "ros", "rqt", "standby.program", "tools")
ANYWHERE = ("tools.competition", "tools.interfaces", "tools.open_ports", "tools.preflight", "tools.preflight_checks",
            "tools.preflight_venue", "tools.team")
# What may be missing: the messages of ROS, and its libraries.
OF_ROS = ("roah_rsbb.msg", "roah_rsbb.srv", "genpy", "rosgraph", "rospkg", "rospy")

BEGIN = """
import importlib, json, sys
sys.path[:] = json.loads(sys.argv[1])
import roah_rsbb
roah_rsbb.__path__ = json.loads(sys.argv[2])
from helpers.as_on_windows import take_away
take_away()
"""
IMPORTS = BEGIN + """
for name in json.loads(sys.argv[3]):
    try:
        importlib.import_module(name)
    except Exception as error:
        if getattr(error, "name", None) not in json.loads(sys.argv[4]):
            print(f"{name}: {error}")
"""
JOURNAL = BEGIN + """
import os
from helpers.journals import Writer
from roah_rsbb.journal import file
from roah_rsbb.journal.reader import JournalReader
from roah_rsbb.run_logs import bag_file

folder = sys.argv[3]
for start in range(2):
    box = Writer(folder)
    box.entry("/notification", f"start {start}")
    try:
        file.lock(folder)
    except file.JournalInUse as error:
        assert f"in use by process {os.getpid()}, since" in str(error), error
    else:
        print("it is locked twice")
    box.close()
assert not box.journal.warnings, box.journal.warnings
with JournalReader(box.path) as reader:
    print(*(entry.value for entry in reader.entries("")), *reader.damage)

path = os.path.join(folder, "one.bag")
bag_file.write_bag(path, [("/notification", "start", 1e9)])
print(os.path.getsize(path) > 4096)
"""


def run(program, *arguments):
    """Run a program in a process that lacks what Windows lacks; returns what it printed."""
    paths = json.dumps(sys.path), json.dumps(list(roah_rsbb.__path__))
    done = subprocess.run([sys.executable, "-c", program, *paths, *arguments], stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, check=False)
    return done.stdout


def _is_in(module, folders):
    return any(module == folder or module.startswith(f"{folder}.") for folder in folders)


def modules():
    """The modules of the programs that need no ROS."""
    for path in sorted(PACKAGE.rglob("*.py")):
        parts = path.relative_to(PACKAGE).with_suffix("").parts
        name = ".".join(parts[:-1] if parts[-1] == "__init__" else parts)
        if name and not name.endswith("__main__") and (_is_in(name, ANYWHERE) or not _is_in(name, LINUX_ONLY)):
            yield f"roah_rsbb.{name}"


def test_every_module_is_imported_on_windows():
    """A failure? What it names is not on Windows: it belongs into platform.py, with what Windows has instead."""
    names = list(modules())
    assert "roah_rsbb.journal.log" in names and "roah_rsbb.referee.program" in names
    assert run(IMPORTS, json.dumps(names), json.dumps(OF_ROS)) == ""


def test_a_journal_and_a_run_log_are_written_on_windows(tmp_path):
    assert run(JOURNAL, str(tmp_path)) == "start 0 start 1\nTrue\n"


def test_what_is_missing_on_windows_is_noticed(tmp_path):
    """A module of the package that needs it cannot be imported."""
    (tmp_path / "locking.py").write_text("import fcntl\n")
    (tmp_path / "forking.py").write_text("import os\nos.fork\n")
    roah_rsbb.__path__.append(str(tmp_path))
    try:
        found = run(IMPORTS, json.dumps(["roah_rsbb.locking", "roah_rsbb.forking"]), json.dumps(OF_ROS))
    finally:
        roah_rsbb.__path__.remove(str(tmp_path))
    assert found == ("roah_rsbb.locking: Windows has no module fcntl\n"
                     "roah_rsbb.forking: on Windows, module 'os' has no attribute 'fork'\n")


# Names that Windows lacks, in code that does not run there.
KNOWN = {
    "journal.processes": {"os.fork", "signal.SIGKILL"},  # `platform.processors` is 1
    "signs_of_life": {"os.geteuid", "signal.SIGKILL", "socket.AF_UNIX", "socket.CMSG_SPACE", "socket.SCM_CREDENTIALS",
                      "socket.SO_PASSCRED"},  # `platform.local_socket` is None
}


def _missing(source):
    """The names in a source that Windows lacks."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            module, names = node.value.id, [node.attr]
        elif isinstance(node, ast.ImportFrom):
            module, names = node.module or "", [alias.name for alias in node.names]
        else:
            continue
        for name in names:
            if name in NAMES.get(module, "").split():
                yield f"{module}.{name}"


def test_names_that_windows_lacks_are_in_one_file():
    """A failure? As above."""
    found = {}
    for module in modules():
        path = PACKAGE.joinpath(*module.split(".")[1:])
        path = path / "__init__.py" if path.is_dir() else path.with_suffix(".py")
        names = set(_missing(path.read_text(encoding="utf-8")))
        if names and module != "roah_rsbb.platform":
            found[module[len("roah_rsbb."):]] = names
    assert found == KNOWN


def test_other_users_do_not_see_the_address_that_a_browser_is_given(tmp_path):
    """All users see the arguments of programs, and the address of the organiser's page has a code."""
    browser, seen = tmp_path / "browser", tmp_path / "seen"
    browser.write_text(f'#!/bin/sh\necho "$1" > {seen}\ncd "$(dirname "${{1#file://}}")" && stat -c %a . page.html >> '
                       f'{seen} && cat page.html >> {seen}\n')
    browser.chmod(0o700)
    subprocess.run(
        [sys.executable, "-c", "from roah_rsbb.platform import open_in_browser\n"
         "assert open_in_browser('http://127.0.0.1:1/?a=b&token=SECRET')"], check=True,
        env={**os.environ, "HOME": str(tmp_path), "DISPLAY": ":0", "BROWSER": f"{browser} %s"})
    given, folder, file, page = seen.read_text().splitlines()
    assert "SECRET" not in given and given.startswith(f"file://{tmp_path}/roah_rsbb_")
    assert (folder, file) == ("700", "600")
    assert "0;url=http://127.0.0.1:1/?a=b&amp;token=SECRET" in page
    assert not list(tmp_path.glob("roah_rsbb_*")), "it is removed"
