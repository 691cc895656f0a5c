"""The box's events that concern functionality benchmarks: of benchmarking modules, and of the referee for them."""

import abc
from typing import List, Tuple

from roah_rsbb.core.clock import Now
from roah_rsbb.core.modules.messages import ModulesState, RunForModule
from roah_rsbb.core.modules.presence import Modules
from roah_rsbb.core.referee_record import RefereeRecord, RunName
from roah_rsbb.core.refused import Refused
from roah_rsbb.core.runs.functionality import FunctionalityRun
from roah_rsbb.core.runs.run import Run
from roah_rsbb.core.runs.zone_run import ZoneRun

# The benchmark with switches that the referee watches.
HOMF = "HOMF"


class ModuleEvents(RefereeRecord):
    """A part of `roah_rsbb.core.box.Box`, which has the runs and the time."""

    def __init__(self) -> None:
        super().__init__()
        self.modules = Modules()

    @abc.abstractmethod
    def tick(self, now: Now) -> None:
        """See `Box.tick`."""

    @abc.abstractmethod
    def runs(self) -> List[Run]:
        """See `Box.runs`."""

    @abc.abstractmethod
    def _zone_runs(self) -> List[ZoneRun]: ...

    @abc.abstractmethod
    def _run_in(self, zone_name: str) -> ZoneRun: ...

    # -- the referee --------------------------------------------------------------------------------

    def manual_operation_complete(
        self, now: Now, zone_name: str, operation: int = 0, answer: str = "", who: str = ""
    ) -> None:
        """The referee did what a benchmarking module asked for; raises `Refused`.

        `operation`: number of the request that was answered, 0: whatever is asked now. An empty answer is the
        first of those to choose from.
        """
        self.tick(now)
        with self._recording(RunName(zone_name), who, "manual_operation", operation=operation, answer=answer):
            run = self._run_in(zone_name)
            if not isinstance(run, FunctionalityRun):
                raise Refused([f"no manual operation is asked for in zone '{zone_name}'"])
            run.complete_operation(now, operation, answer)

    def omf_button(self, now: Now, zone_name: str, switch: int, who: str = "") -> None:
        """HOMF: the referee saw a switch change, numbered from 1; raises `Refused`."""
        self.tick(now)
        with self._recording(RunName(zone_name), who, "omf_button", switch=switch):
            run = self._homf_run(zone_name)
            run.sheet_of_switches().press(switch)
            run.switches_entered(now)

    def omf_damaged(self, now: Now, zone_name: str, damaged: int, who: str = "") -> None:
        """HOMF: so many switches were damaged; raises `Refused`."""
        self.tick(now)
        with self._recording(RunName(zone_name), who, "omf_damaged", damaged=damaged):
            run = self._homf_run(zone_name)
            run.sheet_of_switches().damage(damaged)
            run.switches_entered(now)

    def omf_complete(self, now: Now, zone_name: str, who: str = "") -> None:
        """HOMF: all was entered that the robot changed; raises `Refused`."""
        self.tick(now)
        with self._recording(RunName(zone_name), who, "omf_complete"):
            self._homf_run(zone_name).complete_switches(now)

    def _homf_run(self, zone_name: str) -> FunctionalityRun:
        run = self._run_in(zone_name)
        if not isinstance(run, FunctionalityRun) or run.event.benchmark.code != HOMF:
            raise Refused([f"zone '{zone_name}' runs {run.event.benchmark.code}: only {HOMF} has switches"])
        return run

    # -- the benchmarking modules -------------------------------------------------------------------

    def on_modules(self, now: Now, state: ModulesState) -> None:
        """A node of benchmarking modules says what it drives, and where it is in its runs."""
        self.tick(now)
        self.modules.hear(now, state)
        self._tell_runs_of_modules(now)

    def module_runs(self) -> Tuple[RunForModule, ...]:
        """What benchmarking modules need to know of the runs that they drive."""
        return tuple(run.for_module() for run in self._functionality_runs())

    def _miss_modules(self, now: Now) -> None:
        """Nodes that are gone by now hold their runs from then on, but not before what was due earlier."""
        due = self.modules.deadline()
        while due is not None and due <= now.mono:
            then = Now(due, now.utc + (due - now.mono))
            for run in self._zone_runs():
                run.tick(then)
            self.modules.forget_gone(then)
            self._tell_runs_of_modules(then)
            due = self.modules.deadline()

    def _functionality_runs(self) -> List[FunctionalityRun]:
        return [run for run in self.runs() if isinstance(run, FunctionalityRun)]

    def _tell_runs_of_modules(self, now: Now) -> None:
        for run in self._functionality_runs():
            run.on_modules(now)
