"""A run's module in its host. Errors in a module end only its run."""

import traceback
from types import SimpleNamespace
from typing import Callable, Optional

from roah_rsbb.bmbox.framework.ground_truth import GroundTruth
from roah_rsbb.bmbox.framework.runner import MakeModule, ModuleRunner
from roah_rsbb.bmbox.host.limits import checked
from roah_rsbb.model.modules import Progress, RunForModule


class HostedModule:
    """A `ModuleRunner` that catches all exceptions; `log` is called with errors."""

    def __init__(
        self, kind: MakeModule, load_parameters: Callable[[], SimpleNamespace], truth: GroundTruth,
        log: Callable[[str], None],
    ) -> None:
        self._runner = ModuleRunner(kind, load_parameters, truth)
        self._log = log
        self._run: Optional[RunForModule] = None
        self._logged = ""
        self._last: Optional[Progress] = None
        self._broken = ""  # exception that ended this attempt's module

    def on_run(self, run: RunForModule) -> None:
        """See `ModuleRunner.on_run`."""
        if self._run is None or run.attempt > self._run.attempt:
            self._broken, self._last = "", None
        self._run = run
        self._guarded(lambda: self._runner.on_run(run))
        if self._runner.traceback != self._logged:
            self._logged = self._runner.traceback
            if self._logged:
                self._log(f"{run.benchmark} in zone {run.zone}: {self._logged}")

    def tick(self, utc: float) -> None:
        """See `ModuleRunner.tick`."""
        self._guarded(lambda: self._runner.tick(utc))

    def watching(self) -> bool:
        """See `ModuleRunner.watching`."""
        return not self._broken and self._runner.watching()

    def progress(self) -> Optional[Progress]:
        """The state to be sent; None if there is none yet."""
        self._guarded(self._update)
        if not self._broken:
            return self._last
        last = self._last or Progress(self._run.run, self._run.attempt)
        return checked(last._replace(request=None, finished=False, failed=self._broken))

    def close(self) -> None:
        """See `ModuleRunner.close`."""
        self._guarded(self._runner.close)

    def _update(self) -> None:
        progress = self._runner.progress()
        self._last = None if progress is None else checked(progress)

    def _guarded(self, job: Callable[[], object]) -> None:
        if self._broken:
            return
        try:
            job()
        except BaseException as error:  # rules may raise anything, even SystemExit
            self._broken = f"{type(error).__name__}: {error}"
            run = self._run
            where = "" if run is None else f"{run.benchmark} in zone {run.zone}: "
            self._log(where + "".join(traceback.format_exception(type(error), error, error.__traceback__)))
