"""Tracks which nodes of benchmarking modules are present, and which benchmarks each drives.

A node of modules sends the list of its benchmarks twice a second. It is missing after `GONE_S` without a message, or
after a message with an empty list, which it sends at its end. If two nodes drive the same benchmark, the first keeps
it.
"""

from typing import Dict, List, NamedTuple, Optional

from roah_rsbb.model.clock import Now
from roah_rsbb.model.modules import ModuleInfo, ModulesState, Progress
from roah_rsbb.model.reason import say

# Seconds: four messages in a row are missing.
GONE_S = 2.0
# No competition has more nodes. The limit keeps a fault from growing.
MAX_NODES = 32
NO_DRIVER = say("Benchmarking module not connected: nothing drives {code}. Start the box with modules:=true, and see "
                "its log: the rules may be damaged")


class _HeardNode(NamedTuple):
    state: ModulesState
    mono: float


class Driver(NamedTuple):
    """The node that drives a benchmark."""

    node: str  # identity of the process
    info: ModuleInfo


class Modules:
    """All nodes of benchmarking modules that were heard."""

    def __init__(self) -> None:
        self._heard: Dict[str, _HeardNode] = {}

    def hear(self, now: Now, state: ModulesState) -> None:
        """Take a node's message. An empty list of benchmarks means that the node has ended."""
        if not state.modules:
            self._heard.pop(state.node, None)
            return
        if state.node not in self._heard:
            self.forget_gone(now)
            if len(self._heard) >= MAX_NODES:
                return
        self._heard[state.node] = _HeardNode(state, now.mono)

    def is_repetition(self, now: Now, state: ModulesState) -> bool:
        """Whether a node that is present says only what it said before."""
        heard = self._heard.get(state.node)
        return heard is not None and heard.state == state and now.mono < heard.mono + GONE_S

    def forget_gone(self, now: Now) -> None:
        """Forget the nodes that have been silent for too long. A node that comes back is the last in the order."""
        self._heard = {node: heard for node, heard in self._heard.items() if now.mono < heard.mono + GONE_S}

    def deadline(self) -> Optional[float]:
        """Monotonic time (s) at which the next node counts as missing unless a message comes first; None: no nodes."""
        return min((heard.mono + GONE_S for heard in self._heard.values()), default=None)

    def driver(self, now: Now, code: str, zone: str) -> Optional[Driver]:
        """Return the driver of the benchmark `code` in a zone; None: it has no driver."""
        return next(iter(self._drivers(now, code, zone)), None)

    def progress(self, node: str) -> Dict[str, Progress]:
        """Return a node's last progress in each run, by the run's identity."""
        heard = self._heard.get(node)
        return {} if heard is None else {progress.run: progress for progress in heard.state.progress}

    def start_off(self, now: Now, code: str, zone: str) -> List[str]:
        """Return why no run of a functionality benchmark can be started in a zone; empty: one can."""
        driver = self.driver(now, code, zone)
        if driver is None:
            return [NO_DRIVER(code=code)]
        return list(driver.info.problems)

    def warnings(self, now: Now, code: str, zone: str) -> List[str]:
        """Return the warnings about the module of a benchmark for the referee of a zone."""
        drivers = self._drivers(now, code, zone)
        found = list(drivers[0].info.warnings) if drivers else []
        if len(drivers) > 1:
            found.append(f"{len(drivers)} nodes drive {code}: end all but one. The first one counts")
        return found

    def _drivers(self, now: Now, code: str, zone: str) -> List[Driver]:
        drivers = []
        for node, heard in self._heard.items():
            infos = [info for info in heard.state.modules if info.benchmark == code and info.zone in ("", zone)]
            if infos and now.mono < heard.mono + GONE_S:
                drivers.append(Driver(node, next((info for info in infos if info.zone), infos[0])))
        return drivers
