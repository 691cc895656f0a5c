"""`rosrun roah_rsbb replay`: panels and public displays show an earlier run again (docs/results.md, "On panels and
displays").

The node publishes what the core published at the time: the topics that panels, terminal and public display read. A box
of the core's own code makes the messages from the states in the journal. Everything is marked as a replay, and the
core's services refuse every command.
"""

import contextlib
import os
import sys
import uuid
from typing import Any, Callable, List

import rosgraph
import rospy

from roah_rsbb.box.calls import BoxCalls
from roah_rsbb.box.door import BoxDoor
from roah_rsbb.client.places import NotFound, read_place, write_place
from roah_rsbb.comm.sockets import ANY_HOST
from roah_rsbb.ground.arguments import Parser, number
from roah_rsbb.journal.reader import JournalError, JournalReader
from roah_rsbb.model.clock import Now
from roah_rsbb.model.document import REPLAY as PREFIX
from roah_rsbb.model.reason import Refused
from roah_rsbb.results.runs import NotPossible
from roah_rsbb.ros import connections
from roah_rsbb.ros.core.original import CoreServices, OriginalTopics
from roah_rsbb.ros.loop_services import LoopServices
from roah_rsbb.ros.node import RosLoop
from roah_rsbb.ros.places import ANSWER_S, REPLAY, live_core, place_of_node, publish_door
from roah_rsbb.ros.replayed_box import CannotReplay, ReplayedBox, configuration, read_run
from roah_rsbb.rulebook.errors import ConfigErrors

PERIOD_S = 0.1  # of the panels' messages, as in the core
PUBLIC_EVERY = 5
CLOCK_STEP_S = 1e-6  # from the clock of one message to that of the next, if no time passes
CORE_EVERY = 20  # ticks between two looks for a core
FASTEST = 64.0
LONGEST_TICK_S = 2 * PERIOD_S
# While panels are served, they wait for a core's answer. One that has started answers the next time.
QUICK_ANSWER_S = 0.5

_DESCRIPTION = """\
Publishes what the core published in an earlier run, for training referees and for testing displays. Start panels and
public displays as usual: the run begins with the first one. They are marked with REPLAY, and every command is refused.
After the end of the run, its last moment stays. End the replay with Ctrl-C.
"""
_EPILOG = """\
Examples:
  replay ~/.ros/roah_rsbb/roah_rsbb_journal 3
  replay /media/usb/roah_rsbb_journal 3 --speed 8

RUN is a run's number in 'rosrun roah_rsbb results list', its identity, or the beginning of its identity. A ROS master
must be running, and no core. The benchmarks and the schedule come from configuration.json beside the journal.
The exit status is 1 if the run cannot be replayed, or if a core is running.
"""


def beside_a_core(node: str) -> str:
    """Return why no replay can run beside a core."""
    return (f"the core {node} is running: a replay beside it would mix with its messages. End the core first, or use "
            "another ROS master: 'roscore -p 11312', and ROS_MASTER_URI=http://localhost:11312 for the replay and its "
            "panels")


class _OpenDoor:
    """The door of a node that is no box, such as a replay."""

    def __init__(self, door: BoxDoor) -> None:
        self._door, self._place = door, place_of_node()

    def open(self) -> None:
        """Let clients in, and say where. Logs what prevents it: the original interface remains."""
        host, path = self._place.bind, self._place.door_file
        try:
            port = self._door.open(host)
            if path:
                write_place(path, f"ws://{'127.0.0.1' if host == ANY_HOST else host}:{port}/door", self._door.token)
            publish_door(self._place, port, self._door.token)
        except OSError as error:
            rospy.logerr("Panels cannot follow this box: %s", error)

    def close(self) -> None:
        """End all connections. The file goes, unless another box has written its own."""
        self._door.close()
        with contextlib.suppress(OSError, NotFound):
            if self._place.door_file and read_place(self._place.door_file).token == self._door.token:
                os.unlink(self._place.door_file)


class ReplayNode:
    """Shows the moments of a run one after the other."""

    def __init__(self, shown: ReplayedBox, speed: float) -> None:
        self._shown = shown
        self._speed = speed
        self._uuid = f"{PREFIX}{uuid.uuid4()}"
        self._ros = RosLoop()
        self._status = 0
        self._ticks = 0
        self._last_s = 0.0  # of the loop's clock
        self._has_begun = self._said_end = False
        box = shown.box
        calls = BoxCalls(box, self._event)
        self._door = BoxDoor(self._ros.loop, box, self._uuid, "", lambda: self._shown.now, dict, tuple, calls.named(),
                             lambda: None)
        self._published = _OpenDoor(self._door)
        self._topics = OriginalTopics(self._ros, box, self._now, self._door.publish, PREFIX)
        CoreServices(box, LoopServices(self._ros.loop), calls)

    def run(self) -> int:
        """Run until shut down; returns the exit status."""
        self._last_s = self._ros.loop.time()
        self._ros.loop.call_soon(self._published.open)  # it serves in the loop that is running
        self._tick()
        self._ros.run()
        self._published.close()
        self._ros.close()
        return self._status

    def _event(self, method: Callable[..., Any], *arguments: object) -> None:
        """Answer calls that only read, and refuse every command."""
        if arguments:
            raise Refused(self._shown.box.warnings(self._shown.now))
        method(self._shown.now)

    def _tick(self) -> None:
        self._ros.loop.call_later(PERIOD_S, self._tick)
        now_s = self._ros.loop.time()
        # If this process was stopped for a while, nothing is skipped.
        passed_s, self._last_s = min(now_s - self._last_s, LONGEST_TICK_S), now_s
        # It begins when somebody listens: a panel, a terminal, or the web pages.
        self._has_begun = self._has_begun or self._door.is_followed or self._topics.are_wanted
        if not self._has_begun:
            passed_s = 0.0
        self._door.written.rate = self._speed if self._has_begun and not self._shown.is_over else 0.0
        try:
            self._shown.show(self._shown.now.utc + passed_s * self._speed)
            core = live_core(REPLAY, QUICK_ANSWER_S, False) if self._ticks % CORE_EVERY == CORE_EVERY - 1 else None
        except CannotReplay as error:
            self._fail(str(error))
            return
        except OSError:  # the master is gone, and no core can start
            core = None
        if core is not None:
            self._fail(beside_a_core(core))
            return
        self._topics.publish_to_gui()
        if self._ticks % PUBLIC_EVERY == 0:
            self._topics.publish_to_public()
        if self._shown.is_over and not self._said_end:
            self._said_end = True
            rospy.loginfo("The run is over. Its last moment stays: end the replay with Ctrl-C")
        self._ticks += 1

    def _now(self) -> Now:
        # Original panels mark a message as old if its clock did not advance: so it does, even if no time passes.
        return self._shown.now.later(self._ticks * CLOCK_STEP_S)

    def _fail(self, text: str) -> None:
        rospy.logfatal("%s", text)
        self._status = 1
        self._ros.stop(text)


def _options(arguments: List[str]) -> Any:
    parser = Parser("replay", _DESCRIPTION, _EPILOG)
    parser.add_argument("journal", metavar="JOURNAL", help="the journal, or a copy of it")
    parser.add_argument("run", metavar="RUN", help="number in the list of runs, or identity")
    parser.add_argument("--speed", metavar="N", type=number(1.0, FASTEST), default=1.0,
                        help="how many times as fast; 1 to 64, default 1")
    parser.add_argument("--benchmarks-file", metavar="YAML", help="instead of the one that the core kept")
    parser.add_argument("--schedule-file", metavar="YAML", help="instead of the one that the core kept")
    return parser.parse_args(arguments)


def main() -> None:
    """Run the program."""
    options = _options(rospy.myargv()[1:])
    try:
        reader = JournalReader(options.journal)
        warnings: List[str] = []
        run = read_run(reader, options.run, warnings)
        log_dir = os.path.dirname(os.path.abspath(options.journal))
        shown = ReplayedBox(run, configuration(log_dir, run, options.benchmarks_file, options.schedule_file))
        for text in warnings:
            print(f"replay: {text}", file=sys.stderr)
        core = live_core(REPLAY, ANSWER_S, True)
    except (JournalError, NotPossible, CannotReplay, ConfigErrors) as error:
        sys.exit(f"replay: {error}")
    except OSError:
        sys.exit(f"replay: no ROS master answers at {rosgraph.get_master_uri()}: start one with 'roscore'")
    if core is not None:
        sys.exit(f"replay: {beside_a_core(core)}")
    connections.init_node(REPLAY.lstrip("/"), disable_signals=True)
    rospy.loginfo("Replaying %s", run.name)
    sys.exit(ReplayNode(shown, options.speed).run())
