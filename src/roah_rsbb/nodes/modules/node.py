"""Node roah_rsbb_modules: runs the modules of functionality benchmarks (docs/module_protocol.md).

Parameters (private): benchmarks (codes with blanks between them, to distribute modules over processes; default: all),
parameters_dir (for each benchmark a YAML file with parameters, and a Python file if the competition has rules of its
own; and ground_truth.yaml). Files may be changed at any time: changes take effect at the next start of a run or the
next request for a pose.
"""

import contextlib
import os
import time
import uuid
from typing import Dict, List, Optional, Tuple

import rospy

from roah_rsbb.bmbox.framework import registry
from roah_rsbb.bmbox.framework.ground_truth_config import FILE_NAME
from roah_rsbb.bmbox.framework.own_rules import own_files
from roah_rsbb.core.modules.messages import ModuleInfo, ModulesState, RunForModule
from roah_rsbb.msg import ModuleRuns
from roah_rsbb.msg import ModulesState as ModulesStateMsg
from roah_rsbb.nodes.modules.convert import modules_state_message, runs_of
from roah_rsbb.nodes.modules.driven import Driven
from roah_rsbb.nodes.modules.dummy_ground_truth import default_file
from roah_rsbb.nodes.modules.ground_truth_tf import ReloadingGroundTruth
from roah_rsbb.nodes.modules.hosted_module import HostedModule
from roah_rsbb.ros.command_line import run_node
from roah_rsbb.ros.loop import RosLoop
from roah_rsbb.ros.params import BadParams, Params
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
        params = Params()
        words = params.text("benchmarks", "all")
        folder = params.path("parameters_dir", os.path.dirname(default_file()))
        self._driven = _chosen(words, folder)
        params.done()
        self._truth = ReloadingGroundTruth(os.path.join(folder, FILE_NAME))
        self._hosted: Dict[str, HostedModule] = {}  # by the run's identity
        self._node = str(uuid.uuid4())
        self._ros = RosLoop()
        self._infos: Tuple[ModuleInfo, ...] = ()
        self._sent: Optional[ModulesState] = None
        self._is_ticking = False
        self._publisher = rospy.Publisher("/modules/state", ModulesStateMsg, queue_size=1, latch=True)
        rospy.loginfo("Running modules %s with the parameters in %s", ", ".join(self._driven), folder)
        for driven in self._driven.values():
            for problem in driven.problems:
                rospy.logerr("%s", problem)

    def run(self) -> None:
        """Run until shut down."""
        self._beat()
        rospy.Subscriber("/core/module_runs", ModuleRuns, self._on_runs, queue_size=10, tcp_nodelay=True)
        self._ros.run()
        self._leave()
        self._ros.close()

    def _leave(self) -> None:
        """Report to the core that this process drives no benchmark. Otherwise it counts as present for a while."""
        # ROS may have shut down already.
        with contextlib.suppress(rospy.ROSException):
            _publish_and_wait(self._publisher, modules_state_message(ModulesState(self._node, (), ())))

    # -- the core -----------------------------------------------------------------------------------

    def _on_runs(self, message: ModuleRuns) -> None:
        runs = runs_of(message)
        self._ros.post(lambda: self._take(runs))

    def _take(self, runs: Tuple[RunForModule, ...]) -> None:
        ours = {run.run: run for run in runs if run.benchmark in self._driven}
        for left in self._hosted.keys() - ours.keys():
            self._hosted.pop(left).close()
        for identity, run in ours.items():
            if identity not in self._hosted:
                self._hosted[identity] = self._host(run.benchmark)
            self._hosted[identity].on_run(run)
        self._send_if_changed()
        self._tick_if_needed()

    def _host(self, code: str) -> HostedModule:
        driven = self._driven[code]
        return HostedModule(driven.make, driven.parameters, self._truth, lambda text: rospy.logerr("%s", text))

    # -- time ---------------------------------------------------------------------------------------

    def _beat(self) -> None:
        self._ros.loop.call_later(BEAT_S, self._beat)
        self._infos = tuple(self._info(driven) for driven in self._driven.values())
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

    def _info(self, driven: Driven) -> ModuleInfo:
        driven.reload()
        problems, warnings = self._truth.check(driven.subjects)
        return ModuleInfo(driven.code, (*driven.problems, *problems), tuple(warnings))

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
            if not rospy.is_shutdown():
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


def _chosen(words: str, folder: str) -> Dict[str, Driven]:
    """Return the benchmarks that the parameter selects, by code. Raises BadParams.

    Rules in the competition's folder replace those of the package.
    """
    shipped, own = registry.modules(lambda text: rospy.logerr("%s", text)), own_files(folder)
    known = {code: Driven(code, folder, shipped.get(code), own.get(code)) for code in {**shipped, **own}}
    if words == "all":
        return known
    codes = words.replace(",", " ").split()
    unknown: List[str] = [f"no module for {code}{did_you_mean(code, known)}" for code in codes
                          if code not in known]
    if unknown or not codes:
        raise BadParams(f"parameter {rospy.resolve_name('~benchmarks')}: " + ("; ".join(unknown) or "it is empty"))
    return {code: known[code] for code in codes}


def main() -> None:
    """Entry point of the node."""
    run_node("roah_rsbb_modules", __doc__, ModulesNode, disable_signals=True)
