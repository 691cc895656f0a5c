"""Functionality benchmarks: takes the messages of benchmarking modules."""

from typing import Callable, List, Optional, Tuple

from roah_rsbb.core.actions.record import CommandRecord
from roah_rsbb.core.modules.presence import Modules
from roah_rsbb.core.runs.functionality import FunctionalityRun
from roah_rsbb.core.zones import Zones
from roah_rsbb.model.clock import Now
from roah_rsbb.model.modules import ModulesState, RunForModule


class ModuleDesk:
    """Takes the modules' messages about functionality runs."""

    def __init__(self, tick: Callable[[Now], None], zones: Zones, modules: Modules, record: CommandRecord) -> None:
        """`tick` does what is due by now. Every event calls it first."""
        self._tick = tick
        self._zones = zones
        self._modules = modules
        self._record = record

    def on_modules(self, now: Now, state: ModulesState) -> None:
        """A node of benchmarking modules reports its benchmarks and its progress in runs."""
        if self._modules.is_repetition(now, state) and not self._functionality_runs():
            self._modules.hear(now, state)  # twice a second, and nothing happens in the box
            return
        self._tick(now)
        if self._record.closed:
            return
        self._modules.hear(now, state)
        self._update_runs(now)

    def runs(self) -> Tuple[RunForModule, ...]:
        """Return what benchmarking modules need to know of the functionality runs."""
        return tuple(run.for_module() for run in self._functionality_runs())

    def deadline(self) -> Optional[float]:
        """Monotonic time (s) at which `tick` has something to do; None: never."""
        return self._modules.deadline()

    def tick(self, now: Now) -> None:
        """Pause the runs whose node is missing by now. Earlier events come first."""
        due = self._modules.deadline()
        while due is not None and due <= now.mono:
            then = Now(due, now.utc + (due - now.mono))
            for run in self._zones.runs():
                run.tick(then)
            self._modules.forget_gone(then)
            self._update_runs(then)
            due = self._modules.deadline()

    def _functionality_runs(self) -> List[FunctionalityRun]:
        return [run for run in self._zones.members() if isinstance(run, FunctionalityRun)]

    def _update_runs(self, now: Now) -> None:
        for run in self._functionality_runs():
            run.on_modules(now)
