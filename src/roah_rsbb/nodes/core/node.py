"""Node roah_rsbb_core: the box itself (docs/ros_interface.md, "Core node").

The only place where the core meets rospy.

Parameters (private; docs/ros_interface.md, "Parameters" explains them): rsbb_host, rsbb_port, bind_host,
benchmarks_file, schedule_file, passwords_file, log_dir, resume, public_results, public_provisional, public_robot_texts,
standings_file, rsbb_cypher, private_mode, robot_timeout, allowed_skew, after_stop_duration, check_messages_saved,
check_messages_saved_timeout, auto_next, display_log_size, max_datagram, listen_duration, take_over, backup_dir,
standby_port, end_launch.
"""

import asyncio
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
from typing import Callable, Dict, List, Optional, Tuple

import rospy
from std_msgs.msg import Empty
from std_srvs.srv import Empty as EmptySrv

from roah_rsbb.box.assembly import CoreAssembly, Machine, Place
from roah_rsbb.box.calls import BoxCalls, Disks
from roah_rsbb.box.driver import Outputs
from roah_rsbb.comm.ciphers import Cipher, cipher_by_label
from roah_rsbb.core.copies import NO_PORT, STANDBY, CopyReport
from roah_rsbb.core.effects import Level, SetDevice
from roah_rsbb.core.modules.presence import MAX_NODES
from roah_rsbb.core.settings import Settings
from roah_rsbb.core.views.explained import explanations
from roah_rsbb.core.views.public import PublicResults, PublicView, public_view
from roah_rsbb.durable import close_to_others
from roah_rsbb.journal.file import DamagedJournal, Resume, boot_id
from roah_rsbb.journal.ports import PortRecord
from roah_rsbb.journal.store import Journal
from roah_rsbb.model import shown
from roah_rsbb.msg import (
    CopyQuestion,
    CopyState,
    CoreToGui,
    CoreToPublic,
    DevicesState,
    DevicesStatus,
    ModuleRuns,
    ModulesState,
    PublicBoard,
    PublicDetails,
    PublicExplained,
)
from roah_rsbb.nodes.core import public_convert
from roah_rsbb.nodes.core.configuration import Configuration, Content
from roah_rsbb.nodes.core.device_calls import DeviceCalls, devices_of
from roah_rsbb.nodes.core.door import BoxDoor
from roah_rsbb.nodes.core.latched import LatchedTopic
from roah_rsbb.nodes.core.public_board import PublicBoardMaker
from roah_rsbb.nodes.core.reload import Reloads
from roah_rsbb.nodes.core.services import CoreServices
from roah_rsbb.nodes.core.to_gui import ToGui
from roah_rsbb.nodes.modules import convert
from roah_rsbb.nodes.standing_by import CORE, wait_for_journal, wait_for_takeover
from roah_rsbb.radio.radio import Network
from roah_rsbb.ros import connections
from roah_rsbb.ros.command_line import explain
from roah_rsbb.ros.loop import RosLoop
from roah_rsbb.ros.loop_services import LoopServices
from roah_rsbb.ros.newest import Newest
from roah_rsbb.ros.params import BadParams, Params
from roah_rsbb.rulebook import config
from roah_rsbb.rulebook.benchmarks import Durable
from roah_rsbb.run_logs.writer import RunLogWriter
from roah_rsbb.signs_of_life import Signs

# The value of a parameter without its file or folder.
NO_FILE = "none"

GUI_PERIOD_S = 0.1
# Every fifth of the panels' messages goes with one for the public.
PUBLIC_EVERY = 5
JOURNAL_EVERY = 10
# Seconds. Shortest time between what is published for the public after two referees' calls.
PUBLIC_GAP_S = 0.05
# Seconds. After a restart, the nodes that play sounds need a moment to find the core again.
HEARD_AFTER_S = 2.0
# Seconds. On a busy computer they need longer. Without any of them, nobody hears the sound.
LISTENERS_S = 10.0
LOOK_FOR_LISTENERS_S = 0.2

# Seconds. The node that ends the launch may still be starting, and ending takes some time.
END_LAUNCH_S = 10.0

# Seconds after which the loop's thread gets Python's lock from another thread. Usual are 0.005: too long for STOP.
SWITCH_S = 0.0005

# How private channels send (parameter private_mode).
UNICAST, BROADCAST = "unicast", "broadcast"


def _settings(params: Params) -> Settings:
    default = Settings()
    return Settings(
        rsbb_port=params.whole("rsbb_port", default.rsbb_port, 1, 65000),
        robot_timeout=params.number("robot_timeout", default.robot_timeout, lowest=1.0),
        allowed_skew=params.number("allowed_skew", default.allowed_skew, lowest=0.001),
        after_stop_duration=params.number("after_stop_duration", default.after_stop_duration),
        display_log_size=params.whole("display_log_size", default.display_log_size, 100, 1_000_000),
        check_messages_saved=params.flag("check_messages_saved", default.check_messages_saved),
        check_messages_saved_timeout=params.number(
            "check_messages_saved_timeout", default.check_messages_saved_timeout
        ),
        max_datagram=params.whole("max_datagram", default.max_datagram, 200, 65507),
        auto_next=params.flag("auto_next", default.auto_next),
        listen_duration=params.number("listen_duration", default.listen_duration, highest=60.0),
        take_over=params.flag("take_over", default.take_over),
    )


def _network(params: Params, settings: Settings) -> Network:
    labels = [cipher.label for cipher in Cipher if cipher is not Cipher.NONE]
    return Network(
        rsbb_host=params.text("rsbb_host", "10.255.255.255"),
        rsbb_port=settings.rsbb_port,
        bind_host=params.text("bind_host", "0.0.0.0"),
        cipher=cipher_by_label(params.choice("rsbb_cypher", Cipher.AES_128_CBC.label, labels)),
        broadcast=params.choice("private_mode", UNICAST, [UNICAST, BROADCAST]) == BROADCAST,
        max_datagram=settings.max_datagram,
    )


_LOG = {Level.INFO: rospy.loginfo, Level.WARNING: rospy.logwarn, Level.ERROR: rospy.logerr}


def _report_bug(text: str) -> None:
    rospy.logerr_throttle_identical(1.0, f"internal error, please report it: {text}", exc_info=True)


class CoreNode:
    """The node, from its parameters to its end. Raises `BadParams`, `ConfigErrors`, `DamagedJournal` or OSError at the
    start."""

    def __init__(self) -> None:
        params = Params()
        settings = _settings(params)
        network = _network(params, settings)
        files = [params.path(name) for name in ("benchmarks_file", "schedule_file", "passwords_file")]
        log_dir = params.path("log_dir", "~/.ros/roah_rsbb")
        resume = Resume(params.choice("resume", Resume.ALWAYS.value, [choice.value for choice in Resume]))
        results = params.choice("public_results", PublicResults.NONE.value, [choice.value for choice in PublicResults])
        self._public_provisional = params.flag("public_provisional", False)
        self._public_robot_texts = params.flag("public_robot_texts", False)
        standings_file = params.text("standings_file", NO_FILE)
        copies = [params.path("backup_dir")] if params.text("backup_dir", NO_FILE) != NO_FILE else []
        standby_port = params.whole("standby_port", 0, 0, 65535)
        copies += [STANDBY] if standby_port else []
        params.done()
        wait_for_takeover(log_dir)
        lock = wait_for_journal(log_dir)
        launch = rospy.get_param("/run_id", "")
        standings = None if standings_file == NO_FILE else os.path.expanduser(standings_file)
        self._configuration = Configuration(log_dir, "" if resume is Resume.NEVER else launch, files, standings)
        content, version = self._configuration.content, self._configuration.version
        loaded = content.config
        if loaded.durable is Durable.TWO and not standby_port:
            raise BadParams(NO_PORT.format(place=loaded.durable_at))
        for warning in self._configuration.warnings:
            rospy.logwarn("%s", warning)

        self._uuid = str(uuid.uuid4())
        self._ros = RosLoop()
        self._ticks = 0
        self._public_results = PublicResults(results)
        self._last_public_view: Optional[PublicView] = None
        self._public_revision: Optional[int] = None  # of the box, to which that view belongs
        self._public_soon: Optional[asyncio.TimerHandle] = None
        self._public_mono = float("-inf")  # when it was published after a referee's call
        self._last_explained: Optional[Tuple[object, ...]] = None
        self._door: Optional[BoxDoor] = None
        machine = Machine(boot_id(), os.getpid(), self._uuid, time.monotonic, time.time)
        self._device_calls = DeviceCalls(self._on_device_refused)
        outputs = Outputs(self._ring_timeout, self._publish_module_runs, lambda: None,
                          self._device_calls.set, lambda level, text: _LOG[level]("%s", text), _report_bug,
                          self._on_changed)
        self._core = CoreAssembly(
            self._ros.loop, machine, Place(log_dir, network, standby_port), loaded, version, settings, launch,
            lambda session, events, on_trouble: Journal(log_dir, session, events, resume, on_trouble, lock),
            PortRecord(log_dir), functools.partial(RunLogWriter, log_dir), outputs, self._ask_standby)
        self._box = box = self._core.box
        self._event = self._core.event
        self._public_schedule = public_convert.PublicSchedule(box)
        self._public_board = PublicBoardMaker(box, self._uuid, _titles(content))
        self._to_gui = ToGui(box)
        calls = BoxCalls(box, self._referee_event, Disks(
            self._core.journal.ticket, self._core.store.why_not_saved, self._core.standby.ask))
        self._services = LoopServices(self._ros.loop, self._core.fence.check)
        CoreServices(box, self._services, calls)
        reload = Reloads(box, self._configuration, self._ros, self._event, self._use)
        self._door = BoxDoor(
            self._ros.loop, box, self._uuid, network.rsbb_host, self._core.now, lambda: self._core.run_logs.files,
            self._core.unsaved, {**calls.named(), "reload": reload.call}, self._core.fence.check)
        self._heard_from = self._ros.loop.time() + HEARD_AFTER_S
        self._modules = Newest(self._ros.post, lambda state: self._event(box.modules.on_modules, state), MAX_NODES)
        self._network = network
        self._log_dir = log_dir
        self._signs = Signs(log_dir)
        for warning in self._configuration.notices:
            self._event(box.on_notice, warning)
        self._check_log_dir()
        for place in copies:
            box.copies.expect(self._core.now(), place)

    def run(self) -> None:
        """Run until shut down."""
        self._ros.loop.run_until_complete(self._core.ask())
        self._topics = {
            "gui": LatchedTopic("/core/to_gui", CoreToGui, lambda: self._ros.post(self._publish_for_panels)),
            "public": LatchedTopic("/core/to_public", CoreToPublic, lambda: self._ros.post(self._publish_to_public)),
            "public_details": rospy.Publisher("/core/public_details", PublicDetails, queue_size=1, latch=True),
            "public_board": rospy.Publisher("/core/public_board", PublicBoard, queue_size=1, latch=True),
            "public_explained": rospy.Publisher("/core/public_explained", PublicExplained, queue_size=1, latch=True),
            "module_runs": rospy.Publisher("/core/module_runs", ModuleRuns, queue_size=1, latch=True),
            "timeout": rospy.Publisher("/timeout", Empty, queue_size=1),
        }
        rospy.Subscriber("/devices/state", DevicesState, self._on_devices, queue_size=10)
        rospy.Subscriber("/devices/status", DevicesStatus, self._on_devices_status, queue_size=10)
        rospy.Subscriber("/copies/state", CopyState, self._on_copy, queue_size=10)
        self._topics["question"] = rospy.Publisher("/copies/asked", CopyQuestion, queue_size=10)
        rospy.Subscriber("/copies/confirmed", CopyQuestion, self._on_confirmed, queue_size=10, tcp_nodelay=True)
        rospy.Subscriber("/modules/state", ModulesState, self._on_modules, queue_size=10, tcp_nodelay=True)
        gc.collect()
        # From here on, robots are heard, and wait for reactions.
        self._core.resume(self._configuration.earlier)
        if self._core.open():
            rospy.loginfo("Listening on UDP %s:%d, private channels above; log in %s",
                          self._network.rsbb_host, self._network.rsbb_port, self._log_dir)
        threading.Thread(target=self._core.check_earlier, name="check of the journal", daemon=True).start()
        self._publish_module_runs()
        self._ros.loop.call_soon(self._door.open)  # it serves in the loop that is running
        self._publish_tick()
        # Exclude the present objects from garbage collection: a full collection of them stops the box for about 15 ms.
        gc.freeze()
        self._ros.run()
        self._signs.end()
        self._door.close()
        self._services.close()
        self._core.close()
        self._ros.close()

    # -- events -------------------------------------------------------------------------------------

    def _on_changed(self) -> None:
        if self._door is not None:
            self._door.changed()

    def _referee_event(self, method: Callable[..., object], *args: object) -> None:
        """Like `_event`. After the answer, what the public sees is published without waiting for the next tick, but
        not for each of many calls."""
        if self._public_soon is None:
            due = max(self._ros.loop.time(), self._public_mono + PUBLIC_GAP_S)
            self._public_soon = self._ros.loop.call_at(due, self._publish_public_now)
        self._event(method, *args)

    def _publish_public_now(self) -> None:
        self._public_soon, self._public_mono = None, self._ros.loop.time()
        self._publish_public()

    def _on_devices(self, message: DevicesState) -> None:
        devices = devices_of(message)
        self._ros.post(lambda: self._event(self._box.on_devices, devices))

    def _on_devices_status(self, message: DevicesStatus) -> None:
        self._ros.post(lambda: self._event(self._box.on_devices_status, message.connected, message.text))

    def _on_copy(self, message: CopyState) -> None:
        trouble, notice = shown.restored((message.trouble, message.notice), message.said)
        report = CopyReport(message.place, message.journal == self._core.store.identity, message.behind,
                            message.missing_bytes, trouble, notice)
        self._ros.post(lambda: self._take_copy(report))

    def _take_copy(self, report: CopyReport) -> None:
        self._event(self._box.on_copy_report, report)
        self._core.standby.look()

    def _ask_standby(self, ticket: int) -> None:
        self._publish("question", CopyQuestion(self._uuid, self._core.store.identity, ticket))

    def _on_confirmed(self, message: CopyQuestion) -> None:
        if message.box_uuid == self._uuid:
            self._ros.post(lambda: self._core.standby.on_answer(message.ticket))

    def _on_device_refused(self, wish: SetDevice, reason: str) -> None:
        self._ros.post(lambda: self._event(self._box.on_device_refused, wish.zone, wish.device, wish.value, reason))

    def _on_modules(self, message: ModulesState) -> None:
        state = convert.modules_state_of(message)
        self._modules.put(state.node, state)

    def _use(self, content: Content, version: int) -> None:
        """Prepare everything outside the box for another configuration."""
        self._core.use(content.config, version)
        self._public_board.use(_titles(content))

    def _check_log_dir(self) -> None:
        problem = self._core.run_logs.check()
        if problem:
            self._event(self._box.on_trouble, problem)
        elif os.stat(self._log_dir).st_mode & stat.S_IRWXO:
            rospy.logwarn("%s: other users of this computer can read log_dir; remedy: chmod -R o= %s",
                          self._log_dir, shlex.quote(self._log_dir))

    # -- topics -------------------------------------------------------------------------------------

    def _publish_module_runs(self) -> None:
        self._publish("module_runs", convert.runs_message(self._uuid, self._box.modules.runs()))

    def _ring_timeout(self) -> None:
        """Ring at once, unless the core has just started: a run may have timed out while it was down."""
        self._ros.loop.call_at(self._heard_from, self._ring_if_heard)

    def _ring_if_heard(self) -> None:
        """Ring. Shortly after the start, wait for the first node that listens."""
        loop, is_heard = self._ros.loop, self._topics["timeout"].get_num_connections() > 0
        if is_heard or loop.time() > self._heard_from + LISTENERS_S:
            self._publish("timeout", Empty())
        else:
            loop.call_later(LOOK_FOR_LISTENERS_S, self._ring_if_heard)

    def _publish_tick(self) -> None:
        self._ros.loop.call_later(GUI_PERIOD_S, self._publish_tick)
        self._event(self._box.tick_if_due)
        self._signs.send()
        self._do_in_turn([
            self._publish_for_panels, self._publish_schedule, self._publish_public, self._write_links, self._end_tick,
        ])

    def _do_in_turn(self, todo: List[Callable[[], None]]) -> None:
        """Do one thing, and the others in later turns of the loop, so that no datagram waits for all of them."""
        self._core.fence.check()
        try:
            todo[0]()
        finally:
            if todo[1:]:
                self._ros.loop.call_soon(self._do_in_turn, todo[1:])

    def _publish_for_panels(self) -> None:
        document = self._door.publish()
        if self._topics["gui"].is_wanted:
            self._publish("gui", self._to_gui.message(self._core.now(), document))

    def _publish_schedule(self) -> None:
        if self._ticks % PUBLIC_EVERY == 0:
            self._publish_to_public()

    def _publish_to_public(self) -> None:
        if self._topics["public"].is_wanted:
            self._publish("public", self._public_schedule.to_public(self._core.now()))

    def _write_links(self) -> None:
        if self._ticks % JOURNAL_EVERY == 0:
            self._core.each_second()

    def _end_tick(self) -> None:
        self._ticks += 1

    def _publish_public(self) -> None:
        if self._box.is_superseded:
            return  # displays show that there is no signal, and stop their clocks
        is_due, is_changed = self._ticks % PUBLIC_EVERY == 0, self._box.revision != self._public_revision
        if not is_due and not is_changed:
            return
        now = self._core.now()
        self._public_revision = self._box.revision
        view = public_view(self._box, now, self._public_results, self._public_provisional)
        timeless = view.without_time()
        if timeless != self._last_public_view or is_due:
            self._last_public_view = timeless
            self._publish("public_details", public_convert.public_details(view, now, self._uuid))
        if is_due:
            board = self._public_board.take(now, view)
            if board is not None:
                self._publish("public_board", board)
        if is_changed:
            explained = explanations(self._box, self._public_results, self._public_robot_texts)
            if explained != self._last_explained:
                self._last_explained = explained
                self._publish("public_explained", public_convert.public_explained(explained, self._uuid))

    def _publish(self, topic: str, message: object) -> None:
        self._core.fence.check()
        try:
            self._topics[topic].publish(message)
        except rospy.ROSException as error:
            if not rospy.core.is_shutdown_requested():
                rospy.logerr_throttle(1.0, f"{self._topics[topic].name} could not be published: {error}")


def _titles(content: Content) -> Dict[str, str]:
    """Return the titles of the benchmarks by their codes."""
    return {code: benchmark.desc or benchmark.name for code, benchmark in content.config.benchmarks.items()}


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
