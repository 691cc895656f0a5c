"""The parent of forked programs (forking.py): imports what programs import, and forks to become them.

    forking_parent.py DESCRIPTOR [PROGRAM ...]

The descriptor is a socket for requests. What the given programs import is imported at once. A request can be a whole
test: its fork is the parent of all programs of that test, and the program of the request, rostest, is the first one.
It gives the others to its parent instead of executing them.
"""

import array
import ast
import contextlib
import ctypes
import gc
import importlib
import io
import os
import pickle
import random
import runpy
import select
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import types

sys.path.insert(1, os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
from support import forking
from support.forking import Parent, is_python

del sys.path[1]
PR_SET_PDEATHSIG = 1
# The modules of ROS that start programs.
STARTERS = ("roslaunch.nodeprocess", "rosunit.baretest")
# What these import only when they begin.
LATER = {
    "rostest": (*STARTERS, "rostest.rostest_main", "rostest.runner", "rostest.rostest_parent", "roslaunch.parent"),
    "rosmaster": ("rosmaster.main", "rosmaster.master_api"),
}
imported = set()


def import_for(path):
    """Import what a program imports at its top."""
    if path in imported:
        return
    imported.add(path)
    with open(path, encoding="utf-8") as file:
        for node in ast.parse(file.read()).body:
            if isinstance(node, ast.Assign) and getattr(node.targets[0], "id", "") == "python_script":
                import_for(node.value.value)  # catkin's relay to the program in the source folder
            names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            for name in names + ([node.module] if isinstance(node, ast.ImportFrom) else []):
                for each in (name, *LATER.get(name, ())):
                    importlib.import_module(each)
    gc.freeze()  # a program that ends would look through all that was imported: 0.2 s of CPU


def remember_packages():
    """Search the folders with ROS's packages only once. A program does so whenever it asks for a package: 50 ms."""
    import rospkg

    search, known = rospkg.rospack.list_by_path, {}

    def remembered(kind, path, cache):
        if (kind, path) not in known:
            found = {}
            known[kind, path] = search(kind, path, found), found
        names, found = known[kind, path]
        cache.update(found)
        return list(names)

    rospkg.rospack.list_by_path = remembered
    rospkg.RosPack().list()


def remember_files():
    """Walk through the folders of this package only once. roslaunch does so for each program it starts: 30 ms."""
    import roslib.packages
    import rospkg

    known = {}

    def remembered(top, name, filter_fn=None):
        if top not in known:
            places = known[top] = {}
            for folder, folders, files in os.walk(top, followlinks=True):
                folders[:] = [each for each in folders if not each.startswith(".")]
                for each in files:
                    places.setdefault(each, []).append(os.path.abspath(os.path.join(folder, each)))
        return [path for path in known[top].get(name, ()) if filter_fn is None or filter_fn(path)]

    roslib.packages._find_resource = remembered
    with contextlib.suppress(rospkg.ResourceNotFound):  # no workspace is in use
        roslib.packages.find_node("roah_rsbb", "run_cases.py")


class Forks:
    """The programs of this process, and the socket on which they are requested."""

    def __init__(self, requests):
        self.requests = requests
        self.running = set()
        self.test = 0  # the process of rostest; its end is the end of this process

    def serve(self):
        """Fork for each request. Returns in the forks, with the path of the program."""
        # The handler does nothing: it may interrupt an import, which must not import anything (CPython issue 106176).
        awake, wake = os.pipe()
        os.set_blocking(wake, False)
        signal.set_wakeup_fd(wake, warn_on_full_buffer=False)
        signal.signal(signal.SIGCHLD, lambda number, frame: None)
        self.report_ended()  # before the handler was set
        while True:
            ready, _, _ = select.select([self.requests, awake], [], [])
            if awake in ready:
                os.read(awake, 4096)
                self.report_ended()
            if self.requests not in ready:
                continue
            message, ancillary, _, _ = self.requests.recvmsg(1 << 20, socket.CMSG_SPACE(3 * 4))
            if not message:
                while self.test:
                    self.report_ended(wait=True)  # rostest has closed its socket, and ends
                sys.exit()
            files = array.array("i")
            files.frombytes(ancillary[0][2])
            path, arguments, environment, options = pickle.loads(message)
            import_for(path)
            pid = os.fork()
            if not pid:
                signal.set_wakeup_fd(-1)
                for file in (awake, wake):
                    os.close(file)
                self.requests.close()
                become(files, arguments, environment, **options)
                return path
            self.running.add(pid)
            self.report("began", pid)
            for file in files:
                os.close(file)

    def report(self, *news):
        """Report to the process that makes the requests."""
        with contextlib.suppress(OSError):  # it has ended
            self.requests.send(pickle.dumps((*news, 0, 0.0)[:4]))

    def report_ended(self, wait=False):
        """Report all programs that have ended."""
        while True:
            try:
                pid, status, used = os.wait4(-1, 0 if wait else os.WNOHANG)
            except ChildProcessError:
                return
            if not pid:
                return
            self.running.discard(pid)
            code = -os.WTERMSIG(status) if os.WIFSIGNALED(status) else os.WEXITSTATUS(status)
            self.report("ended", pid, code, used.ru_utime + used.ru_stime)
            if pid == self.test:
                self.end_test(code)

    def end_test(self, code):
        """End programs that rostest has left, and this process."""
        for pid in self.running:
            os.kill(pid, signal.SIGKILL)
        for pid in self.running:
            os.waitpid(pid, 0)
        os._exit(code if code >= 0 else 128 - code)


def become(
        files, arguments, environment, death_signal="SIGKILL", folder="", is_leader=False, is_test=False,
        has_programs=False):
    """Turn this process into a program: its arguments, environment, files and, if given, folder and session.

    It gets the signal of that name when its parent ends: a test that is killed leaves no program behind.
    """
    for number in (signal.SIGCHLD, signal.SIGHUP, signal.SIGTERM):
        signal.signal(number, signal.SIG_DFL)
    signal.signal(signal.SIGINT, signal.default_int_handler)  # ignored where a script runs the tests in the background
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, getattr(signal, death_signal))
    if is_leader:
        os.setsid()
    if folder:
        os.chdir(folder)
    for number, file in enumerate(files):
        os.dup2(file, number)
        os.close(file)
    sys.stdin = open(0, encoding=sys.stdin.encoding, closefd=False)  # noqa: SIM115
    for number, name in ((1, "stdout"), (2, "stderr")):
        old, file = getattr(sys, name), io.FileIO(number, "wb", closefd=False)
        setattr(sys, name, io.TextIOWrapper(file, old.encoding, old.errors, write_through=True))
    os.environ.clear()
    os.environ.update(environment)
    time.tzset()
    random.seed()
    tempfile.tempdir = None
    sys.argv[:] = arguments  # the same list, to which default arguments of functions refer
    sys.path[0] = os.path.dirname(os.path.realpath(arguments[0]))
    if "rospy" in sys.modules:
        # It reads them when it is imported.
        names = sys.modules["rospy"].names
        names.reload_mappings(arguments)
        names._caller_namespace = names.get_ros_namespace()
        names._caller_id = f"{names._caller_namespace}unnamed"
    if is_test:
        become_rostest()
    elif has_programs:
        fork_parent()


def become_rostest():
    """Fork again: rostest, and its parent, which forks all other programs of the test and ends with it."""
    ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    forks = Forks(theirs)
    forks.test = os.fork()
    if forks.test:
        ours.close()
        raise Served(forks.serve())
    theirs.close()
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    parent = Parent(ours)

    def start_program(arguments, cwd=None, stdout=None, stderr=None, env=None, **others):
        """Start a program as `subprocess.Popen` does, in a session of its own."""
        path = shutil.which(arguments[0])
        if path is None or not is_python(path) or subprocess.PIPE in (stdout, stderr):
            return subprocess.Popen(arguments, cwd=cwd, stdout=stdout, stderr=stderr, env=env, **others)
        files = [0, *(number if file is None else file.fileno() for number, file in ((1, stdout), (2, stderr)))]
        return parent.start(path, [path, *arguments[1:]], files, dict(env), folder=cwd, is_leader=True,
                            has_programs=os.path.basename(path) == "run_cases.py")

    stand_in = types.SimpleNamespace(**{**vars(subprocess), "Popen": start_program})
    for name in STARTERS:
        if name in sys.modules:
            sys.modules[name].subprocess = stand_in


def fork_parent():
    """Fork the parent of the programs that this process, the cases of a test, will start."""
    ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    pid = os.fork()
    if not pid:
        ours.close()
        os.setsid()  # an interruption of the cases does not end it before their programs
        raise Served(Forks(theirs).serve())
    theirs.close()
    forking.use(Parent(ours), lambda: os.waitpid(pid, 0))


class Served(Exception):
    """This process is a fork of a fork, and becomes that program."""


def main():
    """Serve requests; in the forks, run the program."""
    requests = socket.socket(fileno=int(sys.argv[1]))
    for path in sys.argv[2:]:
        import_for(path)
    if "rospkg" in sys.modules:
        remember_packages()
    if "roslib.packages" in sys.modules:
        remember_files()
    try:
        path = Forks(requests).serve()
    except Served as served:
        (path,) = served.args
    runpy.run_path(path, run_name="__main__")


if __name__ == "__main__":
    main()
