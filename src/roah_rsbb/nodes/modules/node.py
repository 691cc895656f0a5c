"""Node roah_rsbb_modules: runs the modules of functionality benchmarks (docs/module_protocol.md).

Parameters (private): benchmarks (codes with blanks between them, to distribute modules over processes; default: all),
parameters_dir (for each benchmark a YAML file with parameters, and a Python file if the competition has rules of its
own; ground_truth.yaml; and a folder for each zone with parameters or ground truth of its own). Files may be changed,
added and removed at any time: changes take effect at the next start of a run or the next request for a pose.
"""

import contextlib
import os
import time
import uuid
from typing import Dict, List, Optional, Tuple

import rospy

from roah_rsbb.bmbox.framework import registry
from roah_rsbb.bmbox.framework.own_rules import own_files
from roah_rsbb.bmbox.framework.zone_folders import zone_folders
from roah_rsbb.model.modules import ModuleInfo, ModulesState, RunForModule
from roah_rsbb.msg import ModuleRuns
from roah_rsbb.msg import ModulesState as ModulesStateMsg
from roah_rsbb.nodes.modules.convert import modules_state_message, runs_of
from roah_rsbb.nodes.modules.driven import Driven
from roah_rsbb.nodes.modules.dummy_ground_truth import default_file
from roah_rsbb.nodes.modules.ground_truth_tf import ZonesGroundTruth
from roah_rsbb.nodes.modules.hosted_module import HostedModule
from roah_rsbb.params import BadParams
from roah_rsbb.ros.command_line import run_node
from roah_rsbb.ros.loop import RosLoop
from roah_rsbb.ros.params import NodeParams
from roah_rsbb.wording.suggestions import did_you_mean

# Interval of messages to the core, which pauses a run after four missing messages.
BEAT_S = 0.5
# Resolution of the times of watches, which run up to ten times a second.
TICK_S = 0.02
# The last message is sent within milliseconds, unless a subscriber hangs.
LEAVE_S = 1.0


class ModulesNode:
    """The node. Everything except topics happens in one thread."""

    def __init__(self) -> None:
        params = NodeParams()
        words = params.text("benchmarks", "all")
        folder = params.path("parameters_dir", os.path.dirname(default_file()))
        self._folder = folder
        self._shipped = registry.modules(lambda text: rospy.logerr("%s", text))
        self._driven: Dict[str, Driven] = {}
        self._find_rules()
        self._chosen = _chosen(words, self._driven)
        params.done()
        self._truth = ZonesGroundTruth(folder)
        self._hosted: Dict[str, HostedModule] = {}  # by the run's identity
        self._node = str(uuid.uuid4())
        self._ros = RosLoop()
        self._infos: Tuple[ModuleInfo, ...] = ()
        self._sent: Optional[ModulesState] = None
        self._is_ticking = False
        self._publisher = rospy.Publisher("/modules/state", ModulesStateMsg, queue_size=1, latch=True)
        self._log_parameters()

    def run(self) -> None:
        """Run until shut down."""
        self._beat()
        rospy.Subscriber("/core/module_runs", ModuleRuns, self._on_runs, queue_size=10, tcp_nodelay=True)
        self._ros.run()
        self._leave()
        self._ros.close()

    def _leave(self) -> None:
        """Report to the core that this process drives no benchmark now. Otherwise it counts as present for a while."""
        # ROS may have shut down already.
        with contextlib.suppress(rospy.ROSException):
            _publish_and_wait(self._publisher, modules_state_message(ModulesState(self._node, (), ())))

    def _log_parameters(self) -> None:
        """Log which benchmarks can run. A competition has files for its own benchmarks only, which is no error."""
        problems = {code: self._driven[code].problems() for code in self._codes()}
        left_out = [] if self._chosen else [
            code for code in problems if problems[code] and not self._driven[code].has_parameters()]
        ready = ", ".join(code for code in problems if code not in left_out)
        rospy.loginfo("Running modules %s with the parameters in %s", ready or "of no benchmark", self._folder)
        if left_out:
            rospy.loginfo("No parameters there for %s, which cannot run", ", ".join(left_out))
        for code, found in problems.items():
            for problem in found if code not in left_out else ():
                rospy.logerr("%s", problem)

    # -- the core -----------------------------------------------------------------------------------

    def _on_runs(self, message: ModuleRuns) -> None:
        runs = runs_of(message)
        self._ros.post(lambda: self._take(runs))

    def _take(self, runs: Tuple[RunForModule, ...]) -> None:
        codes = self._codes()
        ours = {run.run: run for run in runs if run.benchmark in codes or run.run in self._hosted}
        for left in self._hosted.keys() - ours.keys():
            self._hosted.pop(left).close()
        for identity, run in ours.items():
            if identity not in self._hosted:
                self._hosted[identity] = self._host(run)
            self._hosted[identity].on_run(run)
        self._send_if_changed()
        self._tick_if_needed()

    def _host(self, run: RunForModule) -> HostedModule:
        driven = self._driven[run.benchmark]
        return HostedModule(driven.make, lambda: driven.parameters(run.zone), self._truth.of_zone(run.zone),
                            lambda text: rospy.logerr("%s", text))

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
                self._driven[code] = Driven(code, self._folder, self._shipped.get(code), own.get(code))

    def _codes(self) -> List[str]:
        """The codes of the benchmarks that this node drives now."""
        return [code for code in self._driven if self._chosen is None or code in self._chosen]

    # -- time ---------------------------------------------------------------------------------------

    def _beat(self) -> None:
        self._ros.loop.call_later(BEAT_S, self._beat)
        self._find_rules()
        self._infos = tuple(info for code in self._codes() for info in self._infos_of(self._driven[code]))
        self._send(self._state())

    def _tick_if_needed(self) -> None:
        if not self._is_ticking and any(hosted.watching() for hosted in self._hosted.values()):
            self._is_ticking = True
            self._ros.loop.call_later(TICK_S, self._tick)

    def _tick(self) -> None:
        self._is_ticking = False
        for hosted in self._hosted.values():
            hosted.tick(time.time())
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
        try:
            self._publisher.publish(modules_state_message(state))
        except rospy.ROSException as error:
            if not rospy.core.is_shutdown_requested():
                rospy.logerr_throttle(1.0, f"{self._publisher.name} could not be published: {error}")


def _publish_and_wait(publisher: rospy.Publisher, message: ModulesStateMsg) -> None:
    """Publish, and wait until it is sent: rospy sends in its own threads, which end with the node."""
    def sent() -> List[int]:
        _, _, connections = publisher.impl.get_stats()
        return [count for _, _, count, is_open in connections if is_open]

    before = sum(sent())
    deadline = time.monotonic() + LEAVE_S
    publisher.publish(message)
    while sum(sent()) < before + len(sent()) and time.monotonic() < deadline:
        time.sleep(TICK_S)


def _chosen(words: str, known: Dict[str, Driven]) -> Optional[List[str]]:
    """Return the codes of the benchmarks that the parameter selects; None: all. Raises BadParams."""
    if words == "all":
        return None
    codes = words.replace(",", " ").split()
    unknown: List[str] = [f"no module for {code}{did_you_mean(code, known)}" for code in codes
                          if code not in known]
    if unknown or not codes:
        raise BadParams(f"parameter {rospy.resolve_name('~benchmarks')}: " + ("; ".join(unknown) or "it is empty"))
    return codes


def main() -> None:
    """Entry point of the node."""
    run_node("roah_rsbb_modules", __doc__, ModulesNode, disable_signals=True)
