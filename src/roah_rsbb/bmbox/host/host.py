"""Runs the modules of the functionality benchmarks for a box: takes its runs, and sends it their state.

Theory of operation (docs/module_protocol.md). The rules and their parameters are files that may be changed, added and
removed at any time: changes take effect at the next start of a run or the next request for a pose. Everything happens
in the thread of an asyncio loop, and rules may block it. A box therefore has them in another process.
"""

import asyncio
import logging
import os
import time
import traceback
import uuid
from types import SimpleNamespace
from typing import Callable, Dict, List, Optional, Sequence, Tuple, Type

from roah_rsbb.bmbox.framework import rule_files
from roah_rsbb.bmbox.framework.ground_truth import GroundTruth
from roah_rsbb.bmbox.framework.module import Module
from roah_rsbb.bmbox.framework.parameters import read_parameters
from roah_rsbb.bmbox.framework.rule_files import WatchedFile, file_in, load_rules, own_files, zone_folders
from roah_rsbb.bmbox.framework.runner import MakeModule, ModuleRunner
from roah_rsbb.bmbox.host.ground_truth_of_frames import ZonesGroundTruth
from roah_rsbb.bmbox.host.limits import checked
from roah_rsbb.ground.params import BadParams, Params
from roah_rsbb.model.modules import ModuleInfo, ModulesState, Progress, RunForModule
from roah_rsbb.rulebook.errors import ConfigErrors
from roah_rsbb.wording.texts import did_you_mean

# -- rules and their parameters -----------------------------------------------------------------------

class Driven:
    """The rules of the package, or those of the competition in `own_file`, and the files with their parameters.

    A zone may have parameters of its own. The zone "" stands for all other zones.
    """

    def __init__(self, code: str, folder: str, kind: Optional[Type[Module]], own_file: Optional[str],
                 load: Callable[[str], Type[Module]] = load_rules) -> None:
        """`load` loads the rules of a file, or raises ConfigErrors."""
        self.code = code
        self.own_file = own_file
        self._folder = folder
        self._kind = kind
        self._rules = None if own_file is None else WatchedFile(own_file, lambda: load(own_file))
        self._parameters: Dict[str, WatchedFile] = {}  # by path
        self._in_zone("")

    def kind(self) -> Type[Module]:
        """Return the rules; raises ConfigErrors."""
        return self._kind if self._rules is None else self._rules.content()

    def make(self, run: RunForModule, parameters: SimpleNamespace, truth: GroundTruth) -> Module:
        """Make the module of an attempt; raises ConfigErrors."""
        return self.kind()(run, parameters, truth)

    def parameters(self, zone: str = "") -> SimpleNamespace:
        """Return the parameters in a zone; raises ConfigErrors."""
        self.reload()
        return self._in_zone(zone).content()

    def has_parameters(self) -> bool:
        """Whether there is a file with parameters, for all zones or for one."""
        zones = ["", *zone_folders(self._folder)]
        return any(os.path.lexists(file_in(self._folder, zone, f"{self.code}.yaml")) for zone in zones)

    def reload(self) -> None:
        """Read the changed files again. If the rules changed, read their parameters again, too."""
        is_changed = self._rules is not None and self._rules.reload()
        for path, file in list(self._parameters.items()):
            if is_changed:
                file.forget()
            if not os.path.lexists(path) and len(self._parameters) > 1:
                del self._parameters[path]  # read again when a zone asks for it
            else:
                file.reload()

    def problems(self, zone: str = "") -> List[str]:
        """Return all errors in the rules or, if they have none, in the parameters of a zone, one per line."""
        rules = [] if self._rules is None else self._rules.problems
        return rules or self._in_zone(zone).problems

    def _in_zone(self, zone: str) -> WatchedFile:
        path = file_in(self._folder, zone, f"{self.code}.yaml")
        if path not in self._parameters:
            self._parameters[path] = WatchedFile(
                path, lambda: read_parameters(path, self.code, self.kind().PARAMETERS))
        return self._parameters[path]

    @property
    def subjects(self) -> List[str]:
        """Whose poses the rules need."""
        try:
            return list(self.kind().SUBJECTS)
        except ConfigErrors:
            return []


# -- a run's module -----------------------------------------------------------------------------------

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


# -- the host -----------------------------------------------------------------------------------------

# Interval of messages to the core, which pauses a run after four missing messages.
BEAT_S = 0.5
# Resolution of the times of watches, which run up to ten times a second.
TICK_S = 0.02

_log = logging.getLogger(__name__)


def chosen_benchmarks(params: Params, folder: str) -> Optional[List[str]]:
    """Return the codes of the benchmarks that the parameter `benchmarks` selects; None: all. Raises BadParams."""
    words = params.text("benchmarks", "all")
    if words == "all":
        return None
    codes = words.replace(",", " ").split()
    known = {**rule_files.modules(lambda text: None), **own_files(folder)}
    unknown = [f"no module for {code}{did_you_mean(code, known)}" for code in codes if code not in known]
    if unknown or not codes:
        raise BadParams(f"parameter {params.full_name('benchmarks')}: " + ("; ".join(unknown) or "it is empty"))
    return codes


class ModulesHost:
    """The modules of all runs. Call `start` once, then `take` with the runs whenever they change."""

    def __init__(
        self, loop: asyncio.AbstractEventLoop, folder: str, benchmarks: Optional[Sequence[str]],
        truth: ZonesGroundTruth, send: Callable[[ModulesState], object], utc: Callable[[], float] = time.time,
        on_enter: Callable[[str], object] = lambda run: None, load: Callable[[str], Type[Module]] = load_rules,
    ) -> None:
        """`folder`: with parameters, rules of the competition and ground truth. `benchmarks`: codes; None: all.
        `send` is called with the state, on each change and every `BEAT_S`, and `on_enter` with the identity of a run
        before its rules are called, which may never return. `load` loads the rules of a file, or raises
        ConfigErrors."""
        self._loop, self._folder, self._chosen, self._truth, self._utc = loop, folder, benchmarks, truth, utc
        self._do_send, self._on_enter, self._load = send, on_enter, load
        self._shipped = rule_files.modules(lambda text: _log.error("%s", text))
        self._driven: Dict[str, Driven] = {}
        self._find_rules()
        self._hosted: Dict[str, HostedModule] = {}  # by the run's identity
        self._node = str(uuid.uuid4())
        self._infos: Tuple[ModuleInfo, ...] = ()
        self._sent: Optional[ModulesState] = None
        self._next_beat: Optional[asyncio.TimerHandle] = None
        self._next_tick: Optional[asyncio.TimerHandle] = None
        self._log_parameters()

    def start(self) -> None:
        """Send the first state, and continue until `close`."""
        self._beat()

    def close(self) -> None:
        """Report to the core that this host drives no benchmark now. Otherwise it counts as present for a while."""
        for timer in (self._next_beat, self._next_tick):
            if timer is not None:
                timer.cancel()
        self._truth.close()
        self._send(ModulesState(self._node, (), ()))

    def _log_parameters(self) -> None:
        """Log which benchmarks can run. A competition has files for its own benchmarks only, which is no error."""
        problems = {code: self._driven[code].problems() for code in self._codes()}
        left_out = [] if self._chosen else [
            code for code in problems if problems[code] and not self._driven[code].has_parameters()]
        ready = ", ".join(code for code in problems if code not in left_out)
        _log.info("Running modules %s with the parameters in %s", ready or "of no benchmark", self._folder)
        if left_out:
            _log.info("No parameters there for %s, which cannot run", ", ".join(left_out))
        for code, found in problems.items():
            for problem in found if code not in left_out else ():
                _log.error("%s", problem)

    # -- the core -----------------------------------------------------------------------------------

    def take(self, runs: Sequence[RunForModule]) -> None:
        """Take the present runs with modules."""
        self._truth.take(runs)
        codes = self._codes()
        ours = {run.run: run for run in runs if run.benchmark in codes or run.run in self._hosted}
        for left in self._hosted.keys() - ours.keys():
            self._on_enter(left)
            self._hosted.pop(left).close()
        for identity, run in ours.items():
            self._on_enter(identity)
            if identity not in self._hosted:
                self._hosted[identity] = self._host(run)
            self._hosted[identity].on_run(run)
        self._send_if_changed()
        self._tick_if_needed()

    def _host(self, run: RunForModule) -> HostedModule:
        driven = self._driven[run.benchmark]
        return HostedModule(driven.make, lambda: driven.parameters(run.zone), self._truth.of_zone(run.zone),
                            lambda text: _log.error("%s", text))

    # -- the rules ----------------------------------------------------------------------------------

    def _find_rules(self) -> None:
        """Find the rules of all benchmarks. Files may have been added or removed since the last call.

        Rules in the competition's folder replace those of the package.
        """
        own = own_files(self._folder)
        for code in list(self._driven):
            if self._driven[code].own_file != own.get(code):
                del self._driven[code]
        for code in {**self._shipped, **own}:
            if code not in self._driven:
                self._driven[code] = Driven(code, self._folder, self._shipped.get(code), own.get(code), self._load)

    def _codes(self) -> List[str]:
        """The codes of the benchmarks that this host drives now."""
        return [code for code in self._driven if self._chosen is None or code in self._chosen]

    # -- time ---------------------------------------------------------------------------------------

    def _beat(self) -> None:
        self._next_beat = self._loop.call_later(BEAT_S, self._beat)
        self._find_rules()
        self._infos = tuple(info for code in self._codes() for info in self._infos_of(self._driven[code]))
        self._send(self._state())

    def _tick_if_needed(self) -> None:
        if self._next_tick is None and any(hosted.watching() for hosted in self._hosted.values()):
            self._next_tick = self._loop.call_later(TICK_S, self._tick)

    def _tick(self) -> None:
        self._next_tick = None
        for identity, hosted in self._hosted.items():
            self._on_enter(identity)
            hosted.tick(self._utc())
        self._send_if_changed()
        self._tick_if_needed()

    # -- state --------------------------------------------------------------------------------------

    def _infos_of(self, driven: Driven) -> List[ModuleInfo]:
        """Return a benchmark's common state, and its state in each zone in which that differs."""
        driven.reload()
        common = self._info(driven, "")
        of_zones = [self._info(driven, zone) for zone in zone_folders(self._folder)]
        return [common, *(info for info in of_zones if info != common._replace(zone=info.zone))]

    def _info(self, driven: Driven, zone: str) -> ModuleInfo:
        problems, warnings = self._truth.check(zone, driven.subjects)
        return ModuleInfo(driven.code, (*driven.problems(zone), *problems), tuple(warnings), zone)

    def _state(self) -> ModulesState:
        said = (hosted.progress() for hosted in self._hosted.values())
        return ModulesState(self._node, self._infos, tuple(progress for progress in said if progress is not None))

    def _send_if_changed(self) -> None:
        state = self._state()
        if state != self._sent:
            self._send(state)

    def _send(self, state: ModulesState) -> None:
        self._sent = state
        self._do_send(state)
