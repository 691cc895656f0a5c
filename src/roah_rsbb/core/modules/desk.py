"""Functionality benchmarks: takes the messages of benchmarking modules, and the referee's answers to them."""

from typing import Callable, List, Optional, Tuple

from roah_rsbb.core import run_log
from roah_rsbb.core.actions.record import CommandRecord
from roah_rsbb.core.clock import Now
from roah_rsbb.core.modules.messages import ModulesState, RunForModule
from roah_rsbb.core.modules.presence import Modules
from roah_rsbb.core.referee import Refused, RunName
from roah_rsbb.core.runs.functionality import NO_OPERATION, FunctionalityRun
from roah_rsbb.core.zones import Zones
from roah_rsbb.model.reason import say


class ModuleDesk:
    """Takes the modules' and the referee's messages about functionality runs."""

    def __init__(self, tick: Callable[[Now], None], zones: Zones, modules: Modules, record: CommandRecord) -> None:
        """`tick` does what is due by now. Every event calls it first."""
        self._tick = tick
        self._zones = zones
        self._modules = modules
        self._record = record

    # -- the referee --------------------------------------------------------------------------------

    def complete_operation(
        self, now: Now, zone_name: str, operation: int = 0, answer: str = "", who: str = ""
    ) -> None:
        """The referee has done the manual operation that a benchmarking module requested. Raises `Refused`.

        `operation`: the number of the answered request; 0: the current one. An empty answer selects the first choice.
        """
        self._tick(now)
        with self._record.of(RunName(zone_name), who, "manual_operation", operation=operation, answer=answer):
            run = self._zones.run_in(zone_name)
            if not isinstance(run, FunctionalityRun):
                raise Refused([NO_OPERATION(zone=zone_name)])
            run.complete_operation(now, operation, answer)

    def press_switch(self, now: Now, zone_name: str, switch: int, who: str = "") -> None:
        """The referee saw a switch change, numbered from 1. Raises `Refused`."""
        self._tick(now)
        with self._record.of(RunName(zone_name), who, "omf_button", switch=switch):
            run = self._run_with_switches(zone_name)
            run.sheet_of_switches().press(switch)
            run.switches_entered(now, run_log.OMF_BUTTON, switch)

    def damage_switches(self, now: Now, zone_name: str, damaged: int, who: str = "") -> None:
        """The referee enters how many switches were damaged. Raises `Refused`."""
        self._tick(now)
        with self._record.of(RunName(zone_name), who, "omf_damaged", damaged=damaged):
            run = self._run_with_switches(zone_name)
            run.sheet_of_switches().damage(damaged)
            run.switches_entered(now, run_log.OMF_DAMAGED, damaged)

    def complete_switches(self, now: Now, zone_name: str, who: str = "") -> None:
        """The referee confirms the entered switches. Raises `Refused`."""
        self._tick(now)
        with self._record.of(RunName(zone_name), who, "omf_complete"):
            self._run_with_switches(zone_name).complete_switches(now)

    def _run_with_switches(self, zone_name: str) -> FunctionalityRun:
        run = self._zones.run_in(zone_name)
        if not isinstance(run, FunctionalityRun):
            raise Refused([say("zone '{zone}' runs {code}, which has no switches")(
                zone=zone_name, code=run.event.benchmark.code)])
        return run

    # -- the benchmarking modules -------------------------------------------------------------------

    def on_modules(self, now: Now, state: ModulesState) -> None:
        """A node of benchmarking modules reports its benchmarks and its progress in runs."""
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
