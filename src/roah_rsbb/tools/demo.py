"""The demonstration: the dummy set-up on this machine alone (loopback; no network, no configuration).

With a display it opens the referee's window and leaves the rest to the referee. Without one a scripted
referee takes a dummy robot through one task benchmark and one functionality benchmark, whose manual operations it
completes by itself; the exit status says whether both runs completed.
"""

import contextlib
import os
import signal
import socket
import subprocess
import sys
from typing import Dict, Iterator, List

from roah_rsbb.arguments import Parser

ZONE = "Testing TestingTeam"
# Benchmark: what the scripted referee does besides conducting the run.
RUNS: Dict[str, List[str]] = {
    "HGTKMH": ["--score", "door=1", "--score", "moved furniture=2"],
    "HNF": ["--operations", "automatic"],
}
LOG_DIR = os.path.expanduser("~/.ros/roah_rsbb_demo")
LAUNCH_LOG = os.path.join(LOG_DIR, "launch.log")
# What a loopback demonstration needs: all on this machine, heard by nobody else.
BROADCAST_HOST, BOX_HOST = "127.255.255.255", "127.0.0.1"
FIRST_UDP_PORT, UDP_PORT_STEP = 6666, 100
FIRST_TABLET_PORT = 8080
# A dummy run takes seconds; the robot is found after the box has listened for another one.
WAIT_FOR_ROBOT_S = 40
STOP_S = 15
# Of what the programs printed, when something failed.
SHOWN_CHARACTERS = 1500


def _free_port(kind: socket.SocketKind, host: str, first: int, step: int) -> int:
    """The first port from `first` on that nobody uses on this machine; ports are tried `step` apart."""
    for port in range(first, 65000, step):
        with socket.socket(socket.AF_INET, kind) as probe, contextlib.suppress(OSError):
            probe.bind((host, port))
            return port
    raise SystemExit(f"demo: no free port from {first} on; end what uses them and try again")


def _launch_command(gui: str, master_port: int) -> List[str]:
    udp_port = _free_port(socket.SOCK_DGRAM, BROADCAST_HOST, FIRST_UDP_PORT, UDP_PORT_STEP)
    tablet_port = _free_port(socket.SOCK_STREAM, BOX_HOST, FIRST_TABLET_PORT, 1)
    return [
        "roslaunch", "-p", str(master_port), "roah_rsbb", "roah_rsbb_dummy.launch", f"gui:={gui}",
        f"rsbb_host:={BROADCAST_HOST}", f"bind_host:={BOX_HOST}", f"rsbb_port:={udp_port}", f"log_dir:={LOG_DIR}",
        f"tablet_port:={tablet_port}",
    ]


@contextlib.contextmanager
def _launched(command: List[str], environment: Dict[str, str]) -> Iterator[None]:
    """The dummy set-up in the background, its output in LAUNCH_LOG; it is ended however this is left."""
    with open(LAUNCH_LOG, "wb") as log:
        launch = subprocess.Popen(command, env=environment, stdout=log, stderr=log, start_new_session=True)
        try:
            yield
        finally:
            launch.send_signal(signal.SIGINT)
            try:
                launch.wait(STOP_S)
            except subprocess.TimeoutExpired:
                os.killpg(launch.pid, signal.SIGKILL)
                launch.wait()


def _last_lines() -> str:
    """The end of what the programs printed, where the reason is if they could not start."""
    with open(LAUNCH_LOG, encoding="utf-8", errors="replace") as log:
        return "".join(line for line in log.readlines() if line.strip())[-SHOWN_CHARACTERS:]


def _scripted(environment: Dict[str, str], master_port: int) -> int:
    print(f"No display here: a scripted referee takes a dummy robot through {' and '.join(RUNS)}.", flush=True)
    with _launched(_launch_command("none", master_port), environment):
        for benchmark, does in RUNS.items():
            print(f"\n--- {benchmark}", flush=True)
            referee = ["rosrun", "roah_rsbb", "referee", "run", ZONE, "--benchmark", benchmark]
            status = subprocess.call([*referee, "--wait", str(WAIT_FOR_ROBOT_S), *does], env=environment)
            if status != 0:
                print(f"demo: {benchmark} did not complete (the referee's exit status is {status}); the programs said "
                      f"last:\n{_last_lines()}", file=sys.stderr)
                break
    print(f"Logs of the runs (rosbags) are in {LOG_DIR}; what the programs printed is in {LAUNCH_LOG}")
    if status == 0:
        # Whoever reads this has not sourced what `make demo` has.
        setup = os.path.join(os.environ["CMAKE_PREFIX_PATH"].split(os.pathsep)[0], "setup.bash")
        print(f"Both score sheets as pages to print: source {setup}; "
              f"rosrun roah_rsbb results export --html sheets --log-dir {LOG_DIR}")
    return status


def _with_window(environment: Dict[str, str], master_port: int) -> int:
    print(f"Opening the referee's window. Choose zone '{ZONE}', then connect, start, and mark scores while the")
    print("dummy robot works. In functionality benchmarks, such as HNF, the panel Manual Operation says what to do.")
    print("End with Ctrl-C here, or with the exit button of Core Status.", flush=True)
    try:
        return subprocess.call(_launch_command("auto", master_port), env=environment)
    except KeyboardInterrupt:
        return 0


def main() -> None:
    """Entry point of `rosrun roah_rsbb demo`."""
    parser = Parser("demo", __doc__)
    parser.add_argument("--no-window", action="store_true", help="script the referee even where there is a display")
    options = parser.parse_args()
    os.makedirs(LOG_DIR, exist_ok=True)
    master_port = _free_port(socket.SOCK_STREAM, "127.0.0.1", 11311, 1)
    environment = {**os.environ, "ROS_MASTER_URI": f"http://127.0.0.1:{master_port}", "ROS_IP": "127.0.0.1"}
    environment.pop("ROS_HOSTNAME", None)
    has_display = bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
    run = _with_window if has_display and not options.no_window else _scripted
    sys.exit(run(environment, master_port))
