"""A core that hangs (SIGSTOP) in any phase of a run: it is ended, the next one continues the run, and nothing that was
acknowledged is lost."""

import contextlib
import os
import pathlib
import random
import signal
import socket
import struct
import tempfile
import threading
import time
from typing import Callable, Dict, List, Optional

import rospy
from support.box_case import PACKAGE
from support.box_client import Refusal
from support.fakes.modules import FakeModules
from support.own_core import PARAMS, OwnCoreCase
from support.programs import Program
from support.waiting import LIMIT_S, wait_until

from helpers.forms import answer_in, form
from roah_rsbb.ground.signs_of_life import SIGN
from roah_rsbb.journal.log_dir import JOURNAL, holder_of
from roah_rsbb.journal.records import Kind
from roah_rsbb.model.as_json import from_json
from roah_rsbb.model.modules import RequestKind
from roah_rsbb.model.results import RunSheet

HOME, ARENA = "Home", "Arena"
ITEM = ("Penalized Behaviors", "Bumps into the furniture")
PHASES = ("idle", "connected", "preparing", "executing", "mark in flight", "manual operation", "STOP in flight",
          "ended", "correction", "leaving in flight", "sign-off in flight", "next event")
USUAL = ("executing", "sign-off in flight")
# Seconds. A call in flight meets a core that stops before, while or after it carries it out.
FLIGHT_S = 0.03
# Of a core, until the hangs before are forgotten.
STEADY_SIGNS = 30
# Of core.launch.xml.
ARGUMENTS = {
    "rsbb_host": PARAMS["rsbb_host"], "rsbb_port": PARAMS["rsbb_port"], "bind_host": PARAMS["bind_host"],
    "benchmarks_file": PARAMS["benchmarks_file"], "passwords_file": PARAMS["passwords_file"],
    "public_results": "none", "public_provisional": "false", "public_robot_texts": "false", "standings_file": "none",
    "resume": "always",
}


class TestHungCore(OwnCoreCase):
    """The box as roslaunch starts it. `took_s`: from each hang until the next core is heard."""

    took_s: Dict[str, float] = {}

    def setUp(self) -> None:
        super().setUp()
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.log_dir = self.folder / "log"
        self.phases = PHASES if os.environ.get("ROAH_TEST_ALL") == "yes" else USUAL
        self.marked: List[int] = []  # values that the box acknowledged
        self.identity = ""

    def launch(self) -> None:
        """Start the box."""
        schedule = self.folder / "schedule.yaml"
        schedule.write_text("".join(
            f"- zone: {zone}\n  schedule:\n" + "".join(
                f"    - {{ benchmark: {benchmark}, team: {team}, round: 1, run: {run}, "
                f"scheduled_time: 2015-12-31 0{run}:00:00 }}\n" for run in (1, 2))
            for zone, benchmark, team in ((HOME, "HGTKMH", "Alpha"), (ARENA, "HNF", "Beta"))))
        self.systemd = self._leaving(socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM))
        self.systemd.setsockopt(socket.SOL_SOCKET, socket.SO_PASSCRED, 1)
        self.systemd.bind(str(self.folder / "notify"))
        self.systemd.settimeout(LIMIT_S)
        rospy.set_param("/roah_rsbb_core/listen_duration", 0.0)
        arguments = {**ARGUMENTS, "schedule_file": schedule, "log_dir": self.log_dir}
        self.launched = self._leaving(Program(
            "roslaunch", PACKAGE, "core.launch.xml", *(f"{name}:={value}" for name, value in arguments.items()),
            NOTIFY_SOCKET=str(self.folder / "notify")))
        self.box.wait_other_core("", lambda: f"a core is heard; it printed\n{self.launched.text}")
        self.wait_systemd_hears()

    def wait_systemd_hears(self) -> None:
        """Wait until systemd would have a sign of life of the present core. It accepts those of all processes."""
        sender = 0
        while sender != holder_of(str(self.log_dir)):
            data, parts, _, _ = self.systemd.recvmsg(256, socket.CMSG_SPACE(12))
            self.assertEqual(data, SIGN)
            sender = struct.unpack("3i", parts[0][2])[0]

    def hang(self, phase: str, call: Optional[Callable[[], object]] = None) -> bool:
        """Let the core hang, while a call is in flight if one is given, and wait for the next core. Returns whether the
        call was acknowledged. A phase that is not tested only has its call."""
        if phase not in self.phases:
            if call is not None:
                call()
            return call is not None
        pid, before, acknowledged = holder_of(str(self.log_dir)), self.box.uuid, []

        def try_call() -> None:
            with contextlib.suppress(Refusal, AssertionError, rospy.ROSException):
                call()
                acknowledged.append(True)

        calling = threading.Thread(target=try_call if call is not None else lambda: None)
        calling.start()
        if call is not None:
            time.sleep(random.uniform(0.0, FLIGHT_S))
        os.kill(pid, signal.SIGSTOP)
        self.addCleanup(_kill, pid)
        began = time.monotonic()
        self.box.wait_other_core(before, lambda: f"the next core is heard; it printed\n{self.launched.text}")
        self.took_s[phase] = time.monotonic() - began
        calling.join()
        self.launched.wait_printed(f"The box (process {pid}) has not answered for 2 s: it is stopped")
        self.assertNotEqual(holder_of(str(self.log_dir)), pid)
        self.wait_systemd_hears()
        for _ in range(STEADY_SIGNS):  # otherwise it would be one of several that failed in succession
            self.systemd.recv(256)
        folders = [path.name for path in self.log_dir.iterdir() if path.is_dir()]
        self.assertEqual(folders, [JOURNAL], "no other journal")
        self.assert_marks()
        print(f"hung in phase '{phase}': the next core was heard after {self.took_s[phase]:.2f} s, call acknowledged: "
              f"{bool(acknowledged)}")
        return bool(acknowledged)

    def mark(self) -> None:
        """Mark an item with a value that was not marked before."""
        value = len(self.marked) + 1
        self.box.act("mark", HOME, self.identity, "Anna", group=ITEM[0], desc=ITEM[1], value=value)
        self.marked.append(value)

    def sheet(self) -> RunSheet:
        """The sheet of the run."""
        return from_json(RunSheet, self.box.ask("sheet", zone=HOME, run=self.identity))

    def assert_marks(self) -> None:
        """All that was acknowledged is on the sheet."""
        if self.identity:
            # The sheet counts quick changes of an item as one.
            found = [entry.value["value"] for entry in self.journal(self.log_dir).entries(self.identity)
                     if entry.kind == Kind.COMMAND and entry.value.get("item") == ITEM[1]]
            self.assertEqual([value for value in self.marked if value not in found], [], f"lost; there are {found}")
            history = self.sheet().history
            self.assertEqual(history[-1].value if history else 0, found[-1] if found else 0)

    def test_each_phase(self) -> None:
        self.launch()
        alpha, box = self.robot("Alpha", prepares=False), self.box
        self.hang("idle")
        port = box.connect(HOME)
        self.identity = box.zone_details(HOME).identity
        self.hang("connected")
        box.start(HOME)
        alpha.wait_did("prepare HGTKMH")
        self.hang("preparing")
        alpha.let("prepare")
        alpha.wait_did("execute HGTKMH")
        self.mark()
        self.hang("executing")
        self.assertEqual((box.zone_details(HOME).phase, box.zone_details(HOME).port), ("running", port))
        self.hang("mark in flight", self.mark)
        self.mark()
        self.operate()
        if not self.hang("STOP in flight", lambda: box.ask("stop", zone=HOME, run=self.identity)):
            box.ask("stop", zone=HOME, run=self.identity)
        box.wait_details(HOME, lambda d: (d.phase, d.end_reason) == ("ended", "stopped"), "it is stopped")
        alpha.wait_did("stop")
        self.hang("ended")
        self.mark()
        self.hang("correction")
        if not self.hang("leaving in flight", lambda: box.command("disconnect", HOME)):
            with contextlib.suppress(Refusal):  # it was carried out, but not acknowledged
                box.command("disconnect", HOME)
        box.wait_phase(HOME, "idle")
        wait_until(lambda: self.sheet().run.closed_utc_s, "the run is over")
        self.mark()
        if not self.hang("sign-off in flight", lambda: box.act("sign_off", HOME, self.identity, "Anna")):
            with contextlib.suppress(Refusal):
                box.act("sign_off", HOME, self.identity, "Anna")
        self.assertTrue(self.sheet().run.signed_by)
        self.hang("next event")
        self.assertTrue(self.sheet().run.signed_by, "an acknowledged sign-off stays")
        self.assertGreater(box.connect(HOME, again=True), port)
        self.assertEqual(set(self.took_s), set(self.phases))

    def operate(self) -> None:
        """A manual operation in the other zone."""
        if "manual operation" not in self.phases:
            return
        modules = self._leaving(FakeModules("HNF"))
        self.robot("Beta")
        self.box.connect(ARENA)
        self.box.start(ARENA)
        modules.wait_attempt(ARENA)
        modules.asks(ARENA, RequestKind.REFEREE, text="Place the robot", form=form("done"))
        self.box.wait_details(ARENA, lambda d: d.operation == 1, "the referee is asked")
        self.hang("manual operation")
        self.box.wait_details(ARENA, lambda d: d.phase == "running" and d.operation == 1, "the referee is still asked")
        self.box.act("operation", ARENA, operation=1, answer="done")
        self.assertEqual(answer_in(modules.wait_outcome(ARENA)), "done")


def _kill(pid: int) -> None:
    with contextlib.suppress(ProcessLookupError):
        os.kill(pid, signal.SIGKILL)
