"""A run's module in the node: whatever goes wrong in it ends this run alone. No ROS."""

import traceback
from types import SimpleNamespace
from typing import Callable, Optional, Type

from roah_rsbb.bmbox.framework.ground_truth import GroundTruth
from roah_rsbb.bmbox.framework.module import Module
from roah_rsbb.bmbox.framework.runner import ModuleRunner
from roah_rsbb.core.modules.messages import Progress, RunForModule
from roah_rsbb.nodes.modules.limits import checked


class HostedModule:
    """A `ModuleRunner` that nothing gets out of; `tell` gets what belongs into the node's log."""

    def __init__(
        self, kind: Type[Module], load_parameters: Callable[[], SimpleNamespace], truth: GroundTruth,
        tell: Callable[[str], None],
    ) -> None:
        self._runner = ModuleRunner(kind, load_parameters, truth)
        self._tell = tell
        self._run: Optional[RunForModule] = None
        self._told = ""
        self._last: Optional[Progress] = None
        self._broken = ""  # why this attempt's module cannot even say what it wants

    def on_run(self, run: RunForModule) -> None:
        """See `ModuleRunner.on_run`."""
        if self._run is None or run.attempt > self._run.attempt:
            self._broken, self._last = "", None
        self._run = run
        self._guarded(lambda: self._runner.on_run(run))
        if self._runner.traceback != self._told:
            self._told = self._runner.traceback
            if self._told:
                self._tell(f"{run.benchmark} in zone {run.zone}: {self._told}")

    def tick(self, utc: float) -> None:
        """See `ModuleRunner.tick`."""
        self._guarded(lambda: self._runner.tick(utc))

    def watching(self) -> bool:
        """See `ModuleRunner.watching`."""
        return not self._broken and self._runner.watching()

    def progress(self) -> Optional[Progress]:
        """What can be sent; None: nothing yet."""
        self._guarded(self._say)
        if not self._broken:
            return self._last
        last = self._last or Progress(self._run.run, self._run.attempt)
        return checked(last._replace(request=None, finished=False, failed=self._broken))

    def close(self) -> None:
        """See `ModuleRunner.close`."""
        self._guarded(self._runner.close)

    def _say(self) -> None:
        progress = self._runner.progress()
        self._last = None if progress is None else checked(progress)

    def _guarded(self, job: Callable[[], object]) -> None:
        if self._broken:
            return
        try:
            job()
        except BaseException as error:  # also SystemExit: rules may do anything
            self._broken = f"{type(error).__name__}: {error}"
            run = self._run
            where = "" if run is None else f"{run.benchmark} in zone {run.zone}: "
            self._tell(where + "".join(traceback.format_exception(type(error), error, error.__traceback__)))
