"""Programs of ROS 2 and of the box, each in its own environment, with their lines as they come."""

import os
import pathlib
import signal
import socket
import subprocess
import sys
import threading
from typing import Dict, List, Optional

from support.waiting import LIMIT_S, happened, wait_until

ROOT = pathlib.Path(__file__).resolve().parents[2]
PREFIX = pathlib.Path(os.environ["ROAH_ROS2_INSTALL"]) / "roah_rsbb_comm"
EXAMPLES = ROOT / "docs" / "examples"
BROADCAST = "127.255.255.255"
BOX_HOST = "127.46.0.1"
END_S = 20.0


class Program:
    """A running program. `close` interrupts it as Ctrl-C does."""

    def __init__(self, *command: object, environment: Optional[Dict[str, str]] = None, **more: str) -> None:
        self.lines: List[str] = []
        self._process = subprocess.Popen(
            [str(word) for word in command], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
            text=True, errors="replace", start_new_session=True,
            env={**(dict(os.environ) if environment is None else environment), "PYTHONUNBUFFERED": "1", **more},
        )
        self._ended = False
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def _read(self) -> None:
        for line in self._process.stdout:
            self.lines.append(line.rstrip("\n"))
            happened()
        self._process.wait()
        self._ended = True
        happened()

    @property
    def text(self) -> str:
        """All that it printed so far."""
        return "\n".join(self.lines)

    def wait_printed(self, text: str, times: int = 1) -> None:
        """Wait until its output contains a text."""
        wait_until(lambda: self.text.count(text) >= times, lambda: f"'{text}' is printed; it printed\n{self.text}")

    def wait_ended(self, limit_s: float = LIMIT_S) -> int:
        """Wait until it ends by itself; returns its exit status."""
        wait_until(lambda: self._ended, lambda: f"the program ends; it printed\n{self.text}", limit_s)
        return self._process.returncode

    def signal(self, number: int) -> None:
        """Send it a signal."""
        self._process.send_signal(number)

    def close(self) -> int:
        """End it, by force if need be; returns the exit status."""
        if self._process.poll() is None:
            self.signal(signal.SIGINT)
            try:
                self._process.wait(END_S)
            except subprocess.TimeoutExpired:
                os.killpg(self._process.pid, signal.SIGKILL)
        self._reader.join(END_S)
        return self._process.returncode


def ros2(name: str, *arguments: object, **parameters: object) -> Program:
    """A program of roah_rsbb_comm, with arguments and ROS parameters."""
    words = [word for key, value in parameters.items() for word in ("-p", f"{key}:={value}")]
    ros = ["--ros-args", *words] if words else []
    return Program(PREFIX / "lib" / "roah_rsbb_comm" / name, *arguments, *ros, ROAH_RSBB_KEY="PASSWORD")


def comm(port: int, team: str = "TestingTeam", number: int = 2, namespace: str = "", **parameters: object) -> Program:
    """The comm node, with the loopback address of this number."""
    more = ["--ros-args", "-r", f"__ns:={namespace}"] if namespace else []
    return ros2("comm", *more, team_name=team, rsbb_host=BROADCAST, bind_host=f"127.46.0.{number}", rsbb_port=port,
                **parameters)


def free_port(kind: int = socket.SOCK_DGRAM) -> int:
    """An unused port, below those that the system gives away. The box uses the ports after it, too."""
    for port in range(21000 + os.getpid() % 400 * 20, 32000, 200):
        with socket.socket(socket.AF_INET, kind) as probe:
            try:
                probe.bind(("", port))
            except OSError:
                continue
            return port
    raise RuntimeError("no port is free")


class Box:
    """The real box: core, benchmarking modules, ground truth and devices with ROS 1."""

    def __init__(self, folder: pathlib.Path) -> None:
        self.port = free_port()
        master = free_port(socket.SOCK_STREAM)
        self._environment = {
            "HOME": os.environ["HOME"], "PATH": "/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin",
            "LANG": "C.UTF-8", "ROS_MASTER_URI": f"http://127.0.0.1:{master}", "ROS_IP": "127.0.0.1",
            "ROS_HOME": str(folder / "ros"), "SETUPTOOLS_USE_DISTUTILS": "stdlib",
        }
        configuration(folder)
        self._launch = self.run(
            "roslaunch", "-p", master, ROOT / "test" / "ros2" / "box.launch.xml", f"folder:={folder}",
            f"rsbb_host:={BROADCAST}", f"rsbb_port:={self.port}", f"bind_host:={BOX_HOST}")

    def run(self, *command: object) -> Program:
        """Start a program with ROS 1."""
        return Program("bash", "-c", f'source {ROOT}/build/devel/setup.bash; exec "$@"', "box", *command,
                       environment=self._environment)

    def referee(self, *words: object) -> Program:
        """Start the referee's program."""
        return self.run(ROOT / "build/devel/lib/roah_rsbb/referee", *words)

    def completes(self, zone: str, benchmark: str, *options: str) -> None:
        """Lead a robot through a whole run."""
        run = self.referee("run", zone, "--benchmark", benchmark, "--operations", "automatic", *options)
        status = run.wait_ended(120.0)
        assert status == 0, f"{benchmark}: status {status}\n{run.text}\nbox:\n{self._launch.text[-3000:]}"

    def kill_core(self) -> None:
        """Kill the core; roslaunch starts it again, and it continues its runs."""
        pid = self.run("rosnode", "info", "/roah_rsbb_core")
        assert pid.wait_ended() == 0, pid.text
        number = next(line.split()[1] for line in pid.lines if line.startswith("Pid:"))
        os.kill(int(number), signal.SIGKILL)

    def close(self) -> None:
        """End all of it."""
        self._launch.close()


def configuration(folder: pathlib.Path) -> None:
    """Write the files of a competition: two zones, all codes, and a benchmark of its own."""
    codes = "HGTKMH HWV HCFGAC HOPF HNF HSUF HPPF HPFF HGMF HOMF STB SetTable".split()
    own = ("- name: Own\n  desc: Set the table\n  code: SetTable\n  kind: task\n  timeout: 60\n"
           "  uses: [notifications, devices]\n")
    (folder / "benchmarks.yaml").write_text((ROOT / "config" / "benchmarks.yaml").read_text() + own)
    zones = {"Testing": ("TestingTeam", codes), "Second": ("SecondTeam", codes[:1])}
    (folder / "schedule.yaml").write_text("".join(
        f"- zone: {zone}\n  schedule:\n" + "".join(
            f"    - {{ benchmark: {code}, team: {'ALL' if code == 'HSUF' else team}, round: 1, run: 1, "
            f"scheduled_time: 2026-01-01 00:{number:02d}:00 }}\n" for number, code in enumerate(zone_codes))
        for zone, (team, zone_codes) in zones.items()))
    passwords = folder / "passwords.yaml"
    passwords.touch(mode=0o600)
    passwords.write_text("TestingTeam: PASSWORD\nSecondTeam: PASSWORD\n")
    modules = folder / "modules"
    modules.mkdir()
    for file in (ROOT / "config" / "modules").iterdir():
        # One goal of Object Perception is enough, and following ends after a few seconds.
        text = file.read_text().replace("goals: 10", "goals: 2").replace("# goal_timeout: 300", "goal_timeout: 4")
        (modules / file.name).write_text(text)


def example(name: str, *arguments: object) -> Program:
    """An example of the documentation."""
    return Program(sys.executable, EXAMPLES / name, *arguments)
