"""A demonstration on this machine alone: the dummy set-up on loopback, without a network or configuration.

With a display, it opens the referee's window. Without a display, a scripted referee takes a dummy robot through one
task benchmark and one functionality benchmark, and completes the manual operations itself. The exit status shows
whether both runs were completed.
"""

import contextlib
import os
import socket
import subprocess
import sys
from typing import Dict, Iterator, List

from roah_rsbb.ground import linux
from roah_rsbb.ground.arguments import Parser

ZONE = "Testing TestingTeam"
# For each benchmark, further options of the scripted referee.
RUNS: Dict[str, List[str]] = {
    "HGTKMH": ["--score", "door=1", "--score", "moved furniture=2"],
    "HNF": ["--operations", "automatic"],
}
LOG_DIR = os.path.expanduser("~/.ros/roah_rsbb_demo")
LAUNCH_LOG = os.path.join(LOG_DIR, "launch.log")
# The demonstration uses loopback addresses only, so no other machine receives it.
BROADCAST_HOST, BOX_HOST = "127.255.255.255", "127.0.0.1"
FIRST_UDP_PORT, UDP_PORT_STEP = 6666, 100
FIRST_TABLET_PORT = 8080
# Seconds. A dummy run takes seconds; the robot is found after the box has listened for another box.
WAIT_FOR_ROBOT_S = 40
STOP_S = 15
# Characters of output that are shown after a failure.
SHOWN_CHARACTERS = 1500


# Sockets that reserve the chosen ports until the programs use them.
_MARKS: List[socket.socket] = []


def _free_port(kind: socket.SocketKind, host: str, first: int, step: int) -> int:
    """Return the first port from `first` that no program uses on this machine, in steps of `step`.

    Other demonstrations do not choose it: this process keeps a socket of the other kind, TCP or UDP, with its number.
    """
    other = socket.SOCK_DGRAM if kind == socket.SOCK_STREAM else socket.SOCK_STREAM
    for port in range(first, 65000, step):
        mark = socket.socket(socket.AF_INET, other)
        with socket.socket(socket.AF_INET, kind) as probe, contextlib.suppress(OSError):
            mark.bind((BOX_HOST, port))
            probe.bind((host, port))
            _MARKS.append(mark)
            return port
        mark.close()
    raise SystemExit(f"demo: no free port from {first}: end the programs that use these ports, and try again")


def _launch_command(gui: str, master_port: int) -> List[str]:
    udp_port = _free_port(socket.SOCK_DGRAM, BROADCAST_HOST, FIRST_UDP_PORT, UDP_PORT_STEP)
    tablet_port = _free_port(socket.SOCK_STREAM, BOX_HOST, FIRST_TABLET_PORT, 1)
    web_port = _free_port(socket.SOCK_STREAM, BOX_HOST, tablet_port + 1, 1)
    return [
        "roslaunch", "-p", str(master_port), "roah_rsbb", "roah_rsbb_dummy.launch", f"gui:={gui}",
        f"rsbb_host:={BROADCAST_HOST}", f"bind_host:={BOX_HOST}", f"rsbb_port:={udp_port}", f"log_dir:={LOG_DIR}",
        f"tablet_port:={tablet_port}", f"web_port:={web_port}",
    ]


@contextlib.contextmanager
def _launched(command: List[str], environment: Dict[str, str]) -> Iterator[None]:
    """Run the dummy set-up in the background, with its output in LAUNCH_LOG. It ends when the context ends."""
    with open(LAUNCH_LOG, "wb") as log:
        launch = subprocess.Popen(command, env=environment, stdout=log, stderr=log, start_new_session=True)
        try:
            yield
        finally:
            linux.end_launch(launch, STOP_S)


def _last_lines() -> str:
    """Return the end of the programs' output, which shows why they could not start."""
    with open(LAUNCH_LOG, encoding="utf-8", errors="replace") as log:
        return "".join(line for line in log.readlines() if line.strip())[-SHOWN_CHARACTERS:]


def _scripted(environment: Dict[str, str], master_port: int) -> int:
    print(f"No display: a scripted referee takes a dummy robot through {' and '.join(RUNS)}.", flush=True)
    with _launched(_launch_command("none", master_port), environment):
        for benchmark, does in RUNS.items():
            print(f"\n--- {benchmark}", flush=True)
            referee = ["rosrun", "roah_rsbb", "referee", "run", ZONE, "--benchmark", benchmark]
            status = subprocess.call([*referee, "--wait", str(WAIT_FOR_ROBOT_S), *does], env=environment)
            if status != 0:
                print(f"demo: {benchmark} was not completed (the referee's exit status is {status}). Last output of "
                      f"the programs:\n{_last_lines()}", file=sys.stderr)
                break
    print(f"The logs of the runs (rosbags) are in {LOG_DIR}, and the output of the programs in {LAUNCH_LOG}")
    if status == 0:
        # `make demo` has sourced setup.bash, but the reader's terminal has not. A Debian package needs no setup.bash.
        workspace = os.environ.get("CMAKE_PREFIX_PATH", "").split(os.pathsep)[0]
        setup = f"source {os.path.join(workspace, 'setup.bash')}; " if workspace else ""
        print(f"To print both score sheets: {setup}"
              f"rosrun roah_rsbb results export --html sheets --log-dir {LOG_DIR}")
    return status


def _with_window(environment: Dict[str, str], master_port: int) -> int:
    print(f"Opening the referee's window. Choose the zone '{ZONE}', connect, start, and mark scores while the dummy")
    print("robot works. In functionality benchmarks such as HNF, follow the panel Manual Operation.")
    print("To end: Ctrl-C here, or the exit button of Core Status.", flush=True)
    try:
        return subprocess.call(_launch_command("auto", master_port), env=environment)
    except KeyboardInterrupt:
        return 0


def main() -> None:
    """Run the program `rosrun roah_rsbb demo`."""
    parser = Parser("demo", __doc__)
    parser.add_argument("--no-window", action="store_true", help="use the scripted referee even if there is a display")
    options = parser.parse_args()
    os.makedirs(LOG_DIR, mode=0o750, exist_ok=True)
    master_port = _free_port(socket.SOCK_STREAM, "127.0.0.1", 11311, 1)
    environment = {**os.environ, "ROS_MASTER_URI": f"http://127.0.0.1:{master_port}", "ROS_IP": "127.0.0.1"}
    environment.pop("ROS_HOSTNAME", None)
    run = _with_window if linux.has_display() and not options.no_window else _scripted
    sys.exit(run(environment, master_port))
