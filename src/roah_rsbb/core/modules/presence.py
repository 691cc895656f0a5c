"""Which benchmarks are driven, by which nodes of benchmarking modules, and whether these are there.

A node of modules says what it drives twice a second. One that was not heard for `GONE_S` is gone, and so is one
that says at its end that it drives nothing. When two drive the same benchmark, the one that was first keeps it.
"""

from typing import Dict, List, NamedTuple, Optional

from roah_rsbb.core.clock import Now
from roah_rsbb.core.modules.messages import ModuleInfo, ModulesState, Progress

# Four of its messages in a row are missing.
GONE_S = 2.0
# No competition has more nodes. More are a fault that must not grow.
MAX_NODES = 32


class _HeardNode(NamedTuple):
    state: ModulesState
    mono: float


class Driver(NamedTuple):
    """Who drives a benchmark."""

    node: str  # identity of the process
    info: ModuleInfo


class Modules:
    """All nodes of benchmarking modules that were heard."""

    def __init__(self) -> None:
        self._heard: Dict[str, _HeardNode] = {}

    def hear(self, now: Now, state: ModulesState) -> None:
        """A node says what it drives; one that drives nothing has left."""
        if not state.modules:
            self._heard.pop(state.node, None)
            return
        if state.node not in self._heard:
            self.forget_gone(now)
            if len(self._heard) >= MAX_NODES:
                return
        self._heard[state.node] = _HeardNode(state, now.mono)

    def forget_gone(self, now: Now) -> None:
        """Forget the nodes that were not heard for too long. A node that comes back is the last in order."""
        self._heard = {node: heard for node, heard in self._heard.items() if now.mono < heard.mono + GONE_S}

    def deadline(self) -> Optional[float]:
        """Monotonic time (s) at which the next node is gone if it is not heard before; None: there is none."""
        return min((heard.mono + GONE_S for heard in self._heard.values()), default=None)

    def driver(self, now: Now, code: str) -> Optional[Driver]:
        """Who drives the benchmark `code`; None: nobody does."""
        return next(iter(self._drivers(now, code)), None)

    def progress(self, node: str) -> Dict[str, Progress]:
        """What a node last said of each run, by the run's identity."""
        heard = self._heard.get(node)
        return {} if heard is None else {progress.run: progress for progress in heard.state.progress}

    def start_off(self, now: Now, code: str) -> List[str]:
        """Why no run of a functionality benchmark can be started."""
        driver = self.driver(now, code)
        if driver is None:
            return [f"Benchmarking module not connected: no node drives {code}. Is roah_rsbb_modules running, and is "
                    f"{code} among its benchmarks?"]
        return list(driver.info.problems)

    def warnings(self, now: Now, code: str) -> List[str]:
        """What the referee should know of the module of a benchmark."""
        drivers = self._drivers(now, code)
        found = list(drivers[0].info.warnings) if drivers else []
        if len(drivers) > 1:
            found.append(f"{len(drivers)} nodes drive {code}: end all but one, only the first is listened to")
        return found

    def _drivers(self, now: Now, code: str) -> List[Driver]:
        return [
            Driver(node, info)
            for node, heard in self._heard.items() if now.mono < heard.mono + GONE_S
            for info in heard.state.modules if info.benchmark == code
        ]
