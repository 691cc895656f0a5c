"""A node of benchmarking modules that makes the test's requests, beside the real core."""

import threading
from typing import Any, Dict, Optional, Tuple

import rospy

from roah_rsbb.model.modules import (
    ModuleInfo,
    ModulesState,
    Progress,
    Request,
    RequestKind,
    RequestOutcome,
    RunForModule,
)
from roah_rsbb.msg import ModuleRuns
from roah_rsbb.msg import ModulesState as ModulesStateMsg
from roah_rsbb.ros.modules.convert import modules_state_message, runs_of
from support.box_case import BoxCase
from support.waiting import LIMIT_S, happened, wait_until

BEAT_S = 0.5


class FakeModules:
    """Says twice a second what it drives, and where it is in each run. `close` it at the end: it falls silent."""

    def __init__(
        self, *codes: str, node: str = "modules of the test", problems=(), warnings=(),
    ) -> None:
        self.node = node
        self.infos = tuple(ModuleInfo(code, tuple(problems), tuple(warnings)) for code in codes)
        self.progress: Dict[str, Progress] = {}  # by the run's identity
        self.runs: Dict[str, RunForModule] = {}  # by zone
        self.box_uuid = ""
        self._sent = 0
        self._wild: Optional[Tuple[Progress, ...]] = None  # what is sent instead of `progress`
        self._lock = threading.Lock()  # no beat publishes what was true before a change
        self._closed = threading.Event()
        self._publisher = rospy.Publisher("/modules/state", ModulesStateMsg, queue_size=10, latch=True)
        self._subscriber = rospy.Subscriber("/core/module_runs", ModuleRuns, self._on_runs, tcp_nodelay=True)
        wait_until(self._publisher.get_num_connections, "the core listens to /modules/state")
        wait_until(lambda: self.box_uuid, "the core publishes its runs")
        self._thread = threading.Thread(target=self._beats, name=node, daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Stop without a last message."""
        self._closed.set()
        self._subscriber.unregister()
        self._thread.join(LIMIT_S)

    @property
    def is_closed(self) -> bool:
        """Whether it has fallen silent."""
        return self._closed.is_set()

    def beat(self) -> None:
        """Publish the whole state now."""
        with self._lock:
            progress = tuple(self.progress.values()) if self._wild is None else self._wild
            self._publisher.publish(modules_state_message(ModulesState(self.node, self.infos, progress)))

    def drives(self, *codes: str) -> None:
        """Drive these benchmarks from now on."""
        self.infos = tuple(map(ModuleInfo, codes))
        self.beat()

    def send(self, *progress: Progress) -> str:
        """Say this until `says` or `asks` is called. Returns a warning that comes with it.

        It is repeated, because the core takes only the newest one of several messages that wait for it.
        """
        with self._lock:
            self._sent += 1
            mark = f"sent {self._sent}"
            self.infos = tuple(info._replace(warnings=(mark,)) for info in self.infos)
            self._wild = progress
        self.beat()
        return mark

    def says(self, zone: str, **fields: Any) -> Progress:
        """Continue from the last progress in this attempt, with these fields changed."""
        run = self.runs[zone]
        last = self.progress.get(run.run)
        if last is None or last.attempt != run.attempt:
            last = Progress(run.run, run.attempt)
        with self._lock:
            self.progress[run.run] = last._replace(**fields)
            self._wild = None
        self.beat()
        return self.progress[run.run]

    def asks(self, zone: str, kind: RequestKind = RequestKind.GOAL, **fields: Any) -> Request:
        """Make the next request. Waits until the core has accepted it."""
        request = Request(len(self.runs[zone].steps) + 1, kind, **fields)
        self.says(zone, request=request)
        wait_until(lambda: len(self.runs[zone].steps) == request.number, f"the core takes {request}")
        return request

    def wait_run(self, zone: str, condition, what: str) -> RunForModule:
        """Wait until a condition on a zone's run holds."""
        return wait_until(
            lambda: zone in self.runs and condition(self.runs[zone]) and self.runs[zone],
            lambda: f"{what}; the runs are {self.runs}",
        )

    def wait_attempt(self, zone: str, attempt: int = 1) -> RunForModule:
        """Wait until an attempt is in progress."""
        return self.wait_run(zone, lambda run: run.running and run.attempt == attempt, f"attempt {attempt} is running")

    def wait_outcome(self, zone: str) -> RequestOutcome:
        """Wait for the answer to the last request."""
        return self.wait_run(zone, lambda run: run.steps[-1].outcome, "the core answers").steps[-1].outcome

    def outcome(self, zone: str) -> Optional[RequestOutcome]:
        """The answer to the last request; None: none yet."""
        return self.runs[zone].steps[-1].outcome

    def _beats(self) -> None:
        while not self.is_closed and not rospy.is_shutdown():
            self.beat()
            self._closed.wait(BEAT_S)

    def _on_runs(self, message: ModuleRuns) -> None:
        self.runs = {run.zone: run for run in runs_of(message)}
        self.box_uuid = message.box_uuid
        happened()


class ModulesCase(BoxCase):
    """A test case with its own modules. `fbm` is the node that drives its runs."""

    fbm: FakeModules

    def modules(self, *codes: str, **how) -> FakeModules:
        """Modules that are gone when the test ends."""
        return self._leaving(FakeModules(*codes, **how))

    def started(self, zone: str, attempt: int = 1) -> None:
        """Connect and start."""
        if attempt == 1:
            self.box.connect(zone)
        self.box.start(zone)
        self.fbm.wait_attempt(zone, attempt)

    def wait_asked(self, zone: str, text: str) -> int:
        """Wait until the referee gets this request. Returns its number."""
        self.box.wait_zone(zone, lambda z: z.manual_operation == text, f"the referee is asked: {text}")
        number = len(self.fbm.runs[zone].steps)
        return self.box.wait_details(zone, lambda d: d.operation == number and number, f"it has number {number}")

    def wait_phase(self, zone: str, phase: str, reason: str = "") -> None:
        self.box.wait_details(zone, lambda d: (d.phase, d.end_reason) == (phase, reason), f"{phase} ({reason})")
