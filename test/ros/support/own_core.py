"""A core that the test may kill and restart, and the records of its runs."""

import pathlib
import signal
from typing import Any, Dict, List, Tuple

from roah_rsbb.client.places import PARAM
from roah_rsbb.journal.log_dir import JOURNAL
from roah_rsbb.journal.reader import JournalReader
from roah_rsbb.model.run_log import KINDS, LogKind
from support.box_case import NetworkCase
from support.box_client import BoxClient
from support.programs import Program, own
from support.robots import BOX, BROADCAST, CONFIG, RSBB_PORT
from support.run_logs import RunLog
from support.waiting import wait_until

PARAMS: Dict[str, Any] = {
    "rsbb_host": BROADCAST, "rsbb_port": RSBB_PORT, "bind_host": BOX, "listen_duration": 0.0,
    "benchmarks_file": CONFIG.parents[2] / "config" / "benchmarks.yaml", "schedule_file": CONFIG / "boxes.yaml",
    "passwords_file": CONFIG / "passwords.yaml",
}


# The names in ROS of a second core with the same master.
OTHER = "/other"
OTHER_CORE = ("__name:=other_core", f"/timeout:={OTHER}/timeout", f"{PARAM}:={OTHER}{PARAM}", *(
    f"/core/{name}:={OTHER}/core/{name}" for name in (
        "to_gui", "to_public", "connect", "disconnect", "start", "stop", "previous", "next", "set_score",
        "manual_operation_complete", "omf_switches/complete", "omf_switches/damaged", "omf_switches/button")))


class Core(Program):
    """A core; `inside`: see `SmallDisk`."""

    def __init__(self, params: Dict[str, Any], inside: Tuple[str, ...] = ()) -> None:
        super().__init__(*inside, own("roah_rsbb_core"), "--unsupervised",
                         *(f"_{name}:={value}" for name, value in {**PARAMS, **params}.items()))

    def kill(self) -> None:
        """Kill it in the middle of whatever it is doing."""
        super().kill()
        self.wait_ended()

    def stop(self) -> None:
        """Make it hang: the process exists, but does nothing."""
        self._process.send_signal(signal.SIGSTOP)

    def proceed(self) -> None:
        """Let a core that hangs continue."""
        self._process.send_signal(signal.SIGCONT)


class OwnCoreCase(NetworkCase):
    """A test case with its own core. `box` is its client."""

    def setUp(self) -> None:
        super().setUp()
        self.box = BoxClient()
        self.addCleanup(self.box.close)

    def start_core(self, log_dir: pathlib.Path, inside: Tuple[str, ...] = (), **params: Any) -> None:
        """Start the core, or one after one that ended; returns once it is heard."""
        before = self.box.uuid
        self.core = self._leaving(Core({**params, "log_dir": log_dir}, inside))
        self.box.wait_other_core(before, lambda: f"a core is heard; it printed\n{self.core.text}")

    def journal(self, log_dir: pathlib.Path) -> JournalReader:
        """The present journal, as of a running box."""
        return JournalReader(str(log_dir / JOURNAL))

    def journaled(self, log_dir: pathlib.Path, port: int) -> List[Tuple[str, Any]]:
        """Return the journal's entries of a robot's run log: topic and value."""
        reader = self.journal(log_dir)
        identity = next(m.identity for run in reader.runs() for m in reader.members(run.identity) if m.port == port)
        return [(e.kind, e.value) for e in reader.entries(identity) if e.port == port and e.kind in KINDS]

    def assert_log_is_the_journals(self, log_dir: pathlib.Path, port: int, log: RunLog) -> None:
        """A run's bag and the journal hold the same, in the same order."""
        self.assertEqual(_entries(log), self.journaled(log_dir, port))

    def assert_log_has_all_of_the_journal(self, log_dir: pathlib.Path, port: int, log: RunLog) -> None:
        """The same, but the bag may have additional entries from the time when the journal could not be written."""
        logged, journaled = _entries(log), self.journaled(log_dir, port)
        rest = iter(logged)
        self.assertTrue(all(entry in rest for entry in journaled), f"of\n{journaled}\nthe log has only\n{logged}")

    def complete_log(self, path: pathlib.Path) -> RunLog:
        """The log of a run that was left, once it is complete."""
        return wait_until(lambda: RunLog.complete(path), f"{path} is complete")

    def wait_warned(self, text: str) -> str:
        """Wait until every referee is warned of something; returns the whole warning."""
        return wait_until(lambda: next((w for w in self.box.warnings if text in w), None),
                          lambda: f"a warning contains '{text}'; warnings: {self.box.warnings}")

    def wait_no_warning(self, text: str) -> None:
        """Wait until no warning contains that text."""
        wait_until(lambda: not any(text in warning for warning in self.box.warnings),
                   lambda: f"no warning contains '{text}' any more; warnings: {self.box.warnings}")


def _entries(log: RunLog) -> List[Tuple[str, Any]]:
    return [(topic, _value(topic, message)) for topic, message in log.entries]


def _value(topic: str, message: Any) -> Any:
    kind = KINDS[topic]
    if kind is LogKind.SCORE:
        return [message.group, message.desc, message.value]
    return None if kind is LogKind.EMPTY else message.data

