"""Node roah_rsbb_core: the box itself (docs/ros_interface.md, "Core node").

The only place where the core meets rospy.

Parameters (private; docs/ros_interface.md, "Parameters" explains them): rsbb_host, rsbb_port, bind_host,
benchmarks_file, schedule_file, passwords_file, log_dir, resume, public_results, public_provisional, public_robot_texts,
standings_file, rsbb_cypher, private_mode, robot_timeout, allowed_skew, after_stop_duration, check_messages_saved,
check_messages_saved_timeout, auto_next, display_log_size, max_datagram, listen_duration, take_over, backup_dir,
standby_port, end_launch.
"""

import functools
import gc
import os
import shlex
import signal
import stat
import sys
import threading
import time
import uuid
from typing import Callable, List, Optional

import rospy
from std_srvs.srv import Empty as EmptySrv

from roah_rsbb.box.assembly import BoxPlace, CoreAssembly, Machine
from roah_rsbb.box.box_door import BoxDoor
from roah_rsbb.box.calls import BoxCalls, Disks
from roah_rsbb.box.configuration import Configuration, Content
from roah_rsbb.box.driver import Outputs
from roah_rsbb.box.reload import Reloads
from roah_rsbb.comm.sender import on_grid
from roah_rsbb.core.copies import NO_PORT
from roah_rsbb.core.effects import Level
from roah_rsbb.durable import close_to_others
from roah_rsbb.journal.file import DamagedJournal, Resume, boot_id
from roah_rsbb.journal.ports import PortRecord
from roah_rsbb.journal.store import Journal
from roah_rsbb.model.clock import Now
from roah_rsbb.nodes.core.door_place import PublishedDoor
from roah_rsbb.nodes.core.original_topics import OriginalTopics, TimeoutBell
from roah_rsbb.nodes.core.other_nodes import OtherNodes
from roah_rsbb.nodes.core.parameters import CoreParameters, read_parameters
from roah_rsbb.nodes.core.services import CoreServices
from roah_rsbb.nodes.standing_by import CORE, wait_for_journal, wait_for_takeover
from roah_rsbb.ros import connections
from roah_rsbb.ros.command_line import explain
from roah_rsbb.ros.live_core import wait_for_other_core
from roah_rsbb.ros.loop import RosLoop
from roah_rsbb.ros.loop_services import LoopServices
from roah_rsbb.ros.params import BadParams, Params
from roah_rsbb.rulebook import config
from roah_rsbb.rulebook.benchmarks import Durable
from roah_rsbb.run_logs.writer import RunLogWriter
from roah_rsbb.signs_of_life import Signs

# Seconds: between the panels' messages, and between signs of life if nobody wants those.
GUI_PERIOD_S, SIGN_PERIOD_S = 0.1, 0.2
PUBLIC_PERIOD_S = 0.5
JOURNAL_PERIOD_S = 1.0

# Seconds. The node that ends the launch may still be starting, and ending takes some time.
END_LAUNCH_S = 10.0

# Seconds after which the loop's thread gets Python's lock from another thread. Usual are 0.005: too long for STOP.
SWITCH_S = 0.0005

_LOG = {Level.INFO: rospy.loginfo, Level.WARNING: rospy.logwarn, Level.ERROR: rospy.logerr}


def _report_bug(text: str) -> None:
    rospy.logerr_throttle_identical(1.0, f"internal error, please report it: {text}", exc_info=True)


class CoreNode:
    """The node, from its parameters to its end. Raises `BadParams`, `ConfigErrors`, `DamagedJournal` or OSError at the
    start."""

    def __init__(self) -> None:
        self._params = params = read_parameters(Params())
        wait_for_takeover(params.log_dir)
        lock = wait_for_journal(params.log_dir)
        launch = rospy.get_param("/run_id", "")
        self._configuration = _configuration(params, launch)
        self._public_due = self._journal_due = 0.0  # monotonic (s)
        self._ros = RosLoop()
        self._door: Optional[BoxDoor] = None
        box_uuid = str(uuid.uuid4())
        self._bell = TimeoutBell(self._ros.loop, lambda: self._core.fence.check())
        self._others = OtherNodes(self._ros, box_uuid)
        self._core = CoreAssembly(
            self._ros.loop, Machine(boot_id(), os.getpid(), box_uuid, time.monotonic, time.time),
            BoxPlace(params.log_dir, params.network, params.standby_port), self._configuration.content.config,
            self._configuration.version, params.settings, launch,
            lambda session, events, on_trouble: Journal(
                params.log_dir, session, events, params.resume, on_trouble, lock),
            PortRecord(params.log_dir), functools.partial(RunLogWriter, params.log_dir), self._outputs(),
            self._others.ask_standby)
        self._box, self._event = self._core.box, self._core.event
        self._offer_calls(box_uuid)
        self._signs = Signs(params.log_dir)
        for warning in self._configuration.notices:
            self._event(self._box.on_notice, warning)
        self._check_log_dir()
        for place in params.copies:
            self._box.copies.expect(self._core.now(), place)

    def _outputs(self) -> Outputs:
        """What the box wants done outside of it."""
        return Outputs(
            self._bell.ring, self._others.publish_module_runs, self._others.set_device,
            lambda level, text: _LOG[level]("%s", text), _report_bug, self._on_changed)

    def _offer_calls(self, box_uuid: str) -> None:
        """Offer the box's calls: at its door, and as the original services."""
        core, box, ros = self._core, self._box, self._ros
        calls = BoxCalls(box, self._call, Disks(core.journal.ticket, core.store.why_not_saved, core.standby.ask))
        self._services = LoopServices(ros.loop, core.fence.check)
        CoreServices(box, self._services, calls)
        reload = Reloads(box, self._configuration, ros.call, self._event, self._use)
        self._door = BoxDoor(
            ros.loop, box, box_uuid, self._params.network.rsbb_host, core.now, lambda: core.run_logs.files,
            core.unsaved, {**calls.named(), "reload": reload.call}, core.fence.check, self._params.publicity)
        self._published = PublishedDoor(self._door)

    def run(self) -> None:
        """Run until shut down."""
        self._ros.loop.run_until_complete(self._core.ask())
        self._topics = OriginalTopics(self._ros, self._box, self._now, self._door.publish)
        self._bell.open()
        self._others.open(self._core)
        gc.collect()
        # From here on, robots are heard, and wait for reactions.
        self._core.resume(self._configuration.earlier)
        if self._core.open():
            network = self._params.network
            rospy.loginfo("Listening on UDP %s:%d, private channels above; log in %s",
                          network.rsbb_host, network.rsbb_port, self._params.log_dir)
        threading.Thread(target=self._core.check_earlier, name="check of the journal", daemon=True).start()
        self._others.publish_module_runs()
        self._ros.loop.call_soon(self._published.open)  # it serves in the loop that is running
        self._tick()
        # Exclude the present objects from garbage collection: a full collection of them stops the box for about 15 ms.
        gc.freeze()
        self._ros.run()
        self._signs.end()
        self._published.close()
        self._services.close()
        self._core.close()
        self._ros.close()

    def _call(self, method: Callable[..., object], *args: object) -> None:
        try:
            self._event(method, *args)
        finally:
            self._door.called()

    def _now(self) -> Now:
        """The moment of what is published: nothing leaves after a takeover."""
        self._core.fence.check()
        return self._core.now()

    def _on_changed(self) -> None:
        if self._door is not None:
            self._door.changed()

    def _use(self, content: Content, version: int) -> None:
        """Prepare everything outside the box for another configuration."""
        self._core.use(content.config, version)

    def _check_log_dir(self) -> None:
        problem, log_dir = self._core.run_logs.check(), self._params.log_dir
        if problem:
            self._event(self._box.on_trouble, problem)
        elif os.stat(log_dir).st_mode & stat.S_IRWXO:
            rospy.logwarn("%s: other users of this computer can read log_dir; remedy: chmod -R o= %s",
                          log_dir, shlex.quote(log_dir))

    def _tick(self) -> None:
        loop = self._ros.loop
        now, period_s = on_grid(loop.time()), GUI_PERIOD_S if self._topics.are_wanted else SIGN_PERIOD_S
        loop.call_at(now + period_s, self._tick)
        self._event(self._box.tick_if_due)
        self._signs.send()
        todo: List[Callable[[], object]] = [self._topics.publish_to_gui]
        if now > self._public_due - GUI_PERIOD_S / 2:
            self._public_due = now + PUBLIC_PERIOD_S
            todo.append(self._topics.publish_to_public)
        if now > self._journal_due - GUI_PERIOD_S / 2:
            self._journal_due = now + JOURNAL_PERIOD_S
            todo.append(self._core.each_second)
        self._do_in_turn(todo)

    def _do_in_turn(self, todo: List[Callable[[], object]]) -> None:
        """Do one thing, and the others in later turns of the loop, so that no datagram waits for all of them."""
        self._core.fence.check()
        try:
            todo[0]()
        finally:
            if todo[1:]:
                self._ros.loop.call_soon(self._do_in_turn, todo[1:])


def _configuration(params: CoreParameters, launch: str) -> Configuration:
    """Read the configuration. Raises `ConfigErrors` or `BadParams`."""
    found = Configuration(params.log_dir, "" if params.resume is Resume.NEVER else launch, params.files,
                          params.standings_file)
    loaded = found.content.config
    if loaded.durable is Durable.TWO and not params.standby_port:
        raise BadParams(NO_PORT.format(place=loaded.durable_at))
    for warning in found.warnings:
        rospy.logwarn("%s", warning)
    return found


def _end_launch() -> None:
    """End the whole launch, if this node was launched in one, because a restart cannot repair the error.

    Returns once roslaunch interrupts this process, too. If this process ended before that, roslaunch would restart it.
    """
    if not rospy.get_param("~end_launch", False):
        return
    interrupted = threading.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: interrupted.set())
    try:
        rospy.wait_for_service("roah_rsbb_shutdown", timeout=END_LAUNCH_S)
        rospy.ServiceProxy("roah_rsbb_shutdown", EmptySrv)()
    except (rospy.ROSException, rospy.ServiceException) as error:
        rospy.logerr("the launch could not be ended (%s): end it with Ctrl-C", error)
    else:
        interrupted.wait(END_LAUNCH_S)


def main() -> None:
    """Run the node."""
    explain(__doc__)
    close_to_others()
    wait_for_other_core()
    connections.init_node(CORE, disable_signals=True)
    sys.setswitchinterval(SWITCH_S)
    status = 0
    try:
        CoreNode().run()
    except (BadParams, config.ConfigErrors, DamagedJournal, OSError) as error:
        for line in str(error).splitlines():
            rospy.logfatal("%s", line)
        status = 1
        _end_launch()
    # End the process now: roslaunch interrupts all its nodes, which would only add a traceback.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    sys.exit(status)
