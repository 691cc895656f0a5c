"""A core for tests of panels: the real box, with real ROS messages and services, but without network and disk.

`FakeCore` lives in a test's process. Its robots are always there, do at once what the box asks, and execute until the
test ends the run. A test can also set what is published although the box does not say so: warnings, a log, a manual
operation and so on. As a program it is a core to try panels on: `python3 -m support.fakes.core` in test/ros, with a
roscore.
"""

import io
import threading
import time
from typing import Any, Callable, Dict, List, NamedTuple, Optional, Set, Tuple
from unittest import mock

import rospy

from helpers.commands import given_with, mark_with
from helpers.forms import shown_form
from roah_rsbb.core.actions.base import ZoneAction
from roah_rsbb.core.actions.table import Target
from roah_rsbb.core.box import Box
from roah_rsbb.core.effects import RecordChanged
from roah_rsbb.core.robots import RobotId
from roah_rsbb.core.runs.run import ZoneRun
from roah_rsbb.core.scoring.book import RunBook
from roah_rsbb.core.scoring.sheet import Mark
from roah_rsbb.core.settings import Settings
from roah_rsbb.model import fields, shown
from roah_rsbb.model.actions import ACTIONS, EVERY, MARK
from roah_rsbb.model.clock import Now, one_moment
from roah_rsbb.model.messages import RobotReport
from roah_rsbb.model.modules import form_of_one
from roah_rsbb.model.records import EndReason
from roah_rsbb.model.referee import Refused
from roah_rsbb.model.scoring import JudgesRule, ScoreKind, ScoringItem
from roah_rsbb.msg import (
    CoreDetails,
    CoreToGui,
    Judgings,
    ModuleScore,
    Results,
    RobotInfo,
    RunClock,
    RunClocks,
    Schedule,
    Superseded,
)
from roah_rsbb.nodes.core.judging_convert import JudgingBoard
from roah_rsbb.nodes.core.panel_messages import PanelMessages
from roah_rsbb.nodes.core.results_convert import ResultsBoard
from roah_rsbb.nodes.core.schedule_convert import ScheduleBoard
from roah_rsbb.nodes.core.services import CoreServices
from roah_rsbb.protocol import BoxState, RobotState
from roah_rsbb.ros import connections
from roah_rsbb.rulebook.benchmarks import Benchmark, Config, ScheduledEvent, ZonePlan
from support.fakes.node import Answers, FakeNode

EVENTS = (
    ("HGTKMH", "Task Benchmark 1", "Getting to know my home", "TestingTeam", 600.0),
    ("HWV", "Task Benchmark 2", "Welcoming visitors", "AnotherTeam", 600.0),
    ("HCFGAC", "Task Benchmark 3", "Catering for Granny Annie's Comfort", "TestingTeam", 600.0),
)
SCORING = (
    ("Achievements", ((0, "The robot detects the door with changed state"), (1, "Each piece of moved furniture"),
                      (1, "Each changed object"), (0, "Correctly executes the command given in phase 2"))),
    ("Penalized behaviours", ((1, "Multiple repetitions of human gesture or speech"), (1, "Bumps into the furniture"),
                              (1, "Stops working"))),
    ("Disqualifying behaviours", ((1, "Hits Annie or another person"), (1, "Damages the test bed"))),
)
ITEMS = tuple(ScoringItem(group, desc, ScoreKind(kind)) for group, items in SCORING for kind, desc in items)
SCHEDULE_START = 1446364800  # 2015-11-01 08:00:00 UTC
LATE_S = 720  # how late the next events are said to be
# The first robot of each team. For each further zone, the team has another one.
ROBOTS = {"TestingTeam": "mbot", "AnotherTeam": "amigo"}
# In `FakeCore.calls`, instead of a value.
NOT_ATTEMPTED = -1

# What a robot answers to the box's state.
_ANSWERS = {
    BoxState.STOP: RobotState.STOP, BoxState.PREPARE: RobotState.WAITING_GOAL,
    BoxState.WAITING_RESULT: RobotState.EXECUTING,
}


def _acted(zone: str, action: str, given: Any) -> tuple:
    """An action as tests see it."""
    if action == MARK:
        return ("score", zone, given["group"], given["desc"],
                NOT_ATTEMPTED if given.get("not_attempted") else
                f"{int(given['added']):+d}" if given.get("added") else given["value"])
    if action == "choose_event":
        return action, zone, EVENTS[int(given["event"].rpartition("e")[2]) - 1][0], given.get("unsigned", False)
    if EVERY[action].is_open:
        others = {name: value for name, value in given.items() if name != "operation"}
        return action, zone, given["operation"], *(others.values() or [""])
    values = fields.read(EVERY[action].fields, given)
    return action, zone, *(values[name] for name in _SEEN.get(action, ()) if values[name] != "" or name == "answer")


# The method of the box that a service calls -> the call as tests see it.
_CALLS: Dict[str, Callable[..., tuple]] = {
    "act": lambda target, action, who, given: _acted(target.zone, action, given),
    "stop": lambda run, who: ("stop_run", run.zone),
}
# Of the values of an action, which tests see with its name and its zone.
_SEEN = {
    "connect": ("robot",), "open_sheet": ("team",), "no_show": ("team",), "withdrawn": ("team",),
    "withdraw": ("entry",), "stop_reason": ("stop",), "switch": ("number",), "damaged": ("number",),
}
# What the referee said with these: the note or reason.
_SAID = {MARK: "note", "withdraw": "note", "stop_reason": "reason", "sign_off": ""}


class Asked(NamedTuple):
    """A manual operation."""

    operation: int
    text: str
    choices: tuple = ()
    asks_text: bool = False
    form: tuple = ()  # of other fields

    @property
    def fields(self) -> tuple:
        """What the referee fills in."""
        return self.form or fields.form_of(form_of_one(self.choices, self.asks_text))


class FakeZone:
    """A zone of the box, and what is published of it beside that."""

    def __init__(self, core: "FakeCore", name: str) -> None:
        self.name = name
        self._core = core
        self.extra_off: Dict[str, List[str]] = {}  # command to reasons why it is off, beside the box's
        self.has_items = True  # for the referee to score
        self.warnings: List[str] = []  # beside the box's
        # Instead of what the box says:
        self.robot: Optional[str] = None
        self.log: Optional[str] = None
        self.paused = ""  # why the time does not count
        # The box's zones have none of these:
        self.online_data = ""
        self.all_robots: List[str] = []  # lines of all robots at once
        self.asked: Optional[Asked] = None  # manual operation
        self.goal = RunClock()  # its fields of the goal
        self.module_scores: List[ModuleScore] = []
        self.switches: Optional[Set[int]] = None  # HOMF: those that are on
        self.damaged = 0
        self.switches_asked = False
        self.not_stopped: List[str] = []  # robots that do not report STOP, beside those of the box

    @property
    def run(self) -> Optional[ZoneRun]:
        """The box's run in this zone."""
        return self._core.box.zones[self.name].run

    @property
    def book(self) -> RunBook:
        """What the box writes down of the run."""
        return self.run.book

    @property
    def index(self) -> int:
        """The number of the current event."""
        return self._core.box.zones[self.name].index

    @property
    def phase(self) -> str:
        """As in ZoneDetails."""
        run = self.run
        return "idle" if run is None else run.phase.value

    @property
    def identity(self) -> str:
        """Of the run; may be set."""
        run = self.run
        return "" if run is None else run.identity

    @identity.setter
    def identity(self, identity: str) -> None:
        self.run.state.identity = identity

    @property
    def scores(self) -> Dict[tuple, int]:
        """The values of the items, without zeros."""
        run = self.run
        return {} if run is None else {(i.group, i.desc): i.value for i in run.sheet.items() if i.value}

    def command(self, *commands: str) -> None:
        """Some referee gives commands."""
        for command in commands:
            self._core.event(self._core.box.act, Target(self.name), command, "/referee", given_with(command))

    def mark(self, mark: Mark, who: str, identity: str = "") -> None:
        """Some referee marks an item."""
        self._core.event(self._core.box.act, Target(self.name, identity), "mark", who, mark_with(mark))

    def end(self, reason: str) -> None:
        """The run ends by itself; `reason` as in ZoneDetails."""
        self._core.event(lambda now: self.run._end(now, EndReason[reason.upper()]))

    def pause(self, why: str) -> None:
        """The time of the run does not count; empty: it counts again."""
        self.paused = why
        self._core.event(lambda now: self.run.clock.set_paused(now, bool(why)))

    def takes(self, action: str, _zone: str, *given: Any) -> bool:
        """Whether an action is about something that only this zone has; then it is done."""
        asked = self.asked
        if action == "operation" and asked is not None and asked.operation == given[0]:
            self.asked = None
        elif action == "switch" and self.switches is not None:
            self.switches = self.switches ^ {given[0]}
        elif action == "damaged" and self.switches is not None:
            self.damaged = given[0]
        elif action == "confirm_switches" and self.switches is not None:
            self.switches_asked = False
        else:
            return False
        return True

    def put_into(self, state: Any, details: Any, clock: RunClock) -> None:
        """Set in the messages what is published beside what the box says."""
        state.log = state.log if self.log is None else self.log
        state.online_data = self.online_data or state.online_data
        state.scoring = state.scoring if self.has_items else []
        details.items = details.items if self.has_items else []
        details.robot = (self.robot or details.robot) if self.phase != "idle" else ""
        details.robots = list(self.all_robots)
        details.not_stopped += self.not_stopped
        details.module_scores = list(self.module_scores)
        clock.paused = self.paused or clock.paused
        for field in ("goal", "goal_limit", "goal_elapsed", "goal_counting"):
            setattr(clock, field, getattr(self.goal, field))
        asked, switches = self.asked, self.switches  # the test or a call may change them at any moment
        if asked is not None:
            state.manual_operation = asked.text
            details.operation = asked.operation
            operation = shown_form(asked.operation, asked.fields, asked.text)
            details.actions = shown.written({**shown.read(details.actions), "operation": operation}.items())
        if switches is not None:
            state.omf, state.omf_switches = True, bytes(sorted(switches))
            state.omf_damaged, state.omf_complete = self.damaged, self.switches_asked


class _Offered:
    """The services of the core, by name: their types, and the functions that answer them in rospy's threads."""

    def __init__(self, box: Any, event: Optional[Callable[..., None]]) -> None:
        self.kinds: Dict[str, type] = {}
        self.answers: Answers = {}
        CoreServices(box, self, event)

    def add(self, name: str, kind: type, handle: Callable[[Any], Any], wait: Optional[Callable[[Any], Any]] = None,
            is_urgent: bool = False) -> None:
        """As `LoopServices.add`."""
        self.kinds[name] = kind
        self.answers[name] = handle if wait is None else lambda request: wait(handle(request))


def _read(message: Any) -> Any:
    """What a subscriber gets: the core publishes messages whose parts are ready-made bytes."""
    buffer = io.BytesIO()
    message.serialize(buffer)
    return next(kind for kind in TOPICS.values() if isinstance(message, kind))().deserialize(buffer.getvalue())


TOPICS = {
    "/core/to_gui": CoreToGui, "/core/details": CoreDetails, "/core/clocks": RunClocks, "/core/results": Results,
    "/core/schedule": Schedule, "/core/judging": Judgings,
    "/core/superseded": Superseded,
}
NODE = FakeNode(TOPICS, _Offered(mock.Mock(), None).kinds)  # the types do not depend on the box


class FakeCore:
    """Publishes as the core does and answers its services. Tests change its attributes at any time."""

    def __init__(
        self, zones: tuple = ("Home A", "Home B"), box_uuid: str = "fake", silent: bool = False,
        items: Tuple[ScoringItem, ...] = ITEMS, judges: Optional[JudgesRule] = None,
    ) -> None:
        """`silent`: publish nothing until the test sets this to False. `items`, `judges`: of all benchmarks."""
        self._judges = judges
        self._items = items
        self.calls: List[tuple] = []  # see _CALLS
        self.words: List[tuple] = []  # (identity, note, referee) of the calls that have them
        self.refuse: Optional[str] = None  # reason with which every service fails
        self.answer_gate = threading.Event()  # cleared: services do not answer
        self.answer_gate.set()
        self.held = ""  # the only method that waits for the gate, such as "sign_off"; empty: all
        self.deaf = False  # the robots do not obey the box any more
        self._silent = silent
        self._speaking = threading.Lock()  # held while it publishes by itself
        self.said_utc_s = 0.0  # clock of the newest messages
        self.box_warnings: List[str] = []
        self.superseded_by = ""
        self.heard_ago_s = 0.4
        self.robots = [("TestingTeam", "mbot", 0.0123), ("AnotherTeam", "amigo", -0.0871)]  # as they are published
        self.tablet_heard = True
        self._lock = threading.RLock()
        self._passed_s = 0.0
        begin = one_moment(time.monotonic, time.time)
        self._utc_at_0 = begin.utc - begin.mono
        self._hosts = {
            RobotId(team, name if not other else f"{name} {other + 1}"): f"10.0.{number}.{other + 2}"
            for number, (team, name) in enumerate(ROBOTS.items()) for other in range(len(zones))
        }
        self.box_uuid = box_uuid
        self.box = self._new_box(zones)
        self.zones = {name: FakeZone(self, name) for name in zones}
        self._results, self._schedule = ResultsBoard(self.box, box_uuid), ScheduleBoard(self.box, box_uuid)
        self._judging = JudgingBoard(self.box, box_uuid)
        self._robots_speak()
        NODE.begin(self, _Offered(self.box, self._serve).answers)
        self._timer = rospy.Timer(rospy.Duration(0.1), self._tick)

    def _new_box(self, zones: tuple) -> Box:
        benchmarks = {code: Benchmark(code, name, desc, s, s, self._items, judges=self._judges)
                      for code, name, desc, _, s in EVENTS}
        plans = tuple(ZonePlan(zone, tuple(
            ScheduledEvent(benchmarks[code], team, 1, number, SCHEDULE_START + 1800.0 * (number - 1),
                           f"z{place}e{number}")
            for number, (code, _, _, team, _) in enumerate(EVENTS, 1)
        )) for place, zone in enumerate(zones))
        config = Config(benchmarks, dict.fromkeys(ROBOTS, "a password"), plans)
        box = Box(config, Settings(listen_duration=0.0, auto_next=False), lambda beacon: 100)
        for name in ACTIONS:
            self._add_reasons(box.actions[name])
        warnings_of = box.warnings_of
        box.warnings_of = lambda now, name: warnings_of(now, name) + self.zones[name].warnings
        box.warnings = lambda now: list(self.box_warnings)
        return box

    def _add_reasons(self, action: ZoneAction) -> None:
        """Let an action also be off for the reasons of the test."""
        own = action.off
        action.off = lambda now, zone, given: (
            own(now, zone, given) + self.zones[zone.name].extra_off.get(action.name, []))

    def close(self) -> None:
        """The test case is over."""
        self.answer_gate.set()
        self._timer.shutdown()
        NODE.end(self)

    def leave(self) -> None:
        """Topics and services are gone, as if the core's process had ended."""
        self.close()
        NODE.leave()

    # -- the box ------------------------------------------------------------------------------------

    def pass_time(self, seconds: float) -> None:
        """From now on, it is later."""
        self._passed_s += seconds

    def event(self, method: Callable[..., Any], *arguments: Any) -> None:
        """Put an event into the box; the robots do at once what the box asks then."""
        with self._lock:
            try:
                method(self._now(), *arguments)
            finally:
                self._robots_speak()
                if any(isinstance(effect, RecordChanged) for effect in self.box.take_effects()):
                    self._results.on_record_changed()
                    self._judging.on_record_changed()
                self.box.take_changed()

    def _now(self) -> Now:
        # One clock only: a pause between the readings of two would be a step of the clock.
        mono = time.monotonic() + self._passed_s
        return Now(mono, mono + self._utc_at_0)

    def _robots_speak(self) -> None:
        """All robots say what they have to say."""
        for robot, host in self._hosts.items():
            if self.box.zones.run_of(robot) is None:
                now = self._now()
                self.box.on_robot_beacon(now, host, robot.team, robot.robot, _wire(now))
        for run in () if self.deaf else self.box.zones.members():
            for _ in range(3):
                now, asked = self._now(), run.message.state
                report = RobotReport(_wire(now), 1, _ANSWERS[asked])
                self.box.on_robot_report(now, run.port, self._hosts[run.robot], report)
                if run.message.state is asked:
                    break

    def _serve(self, method: Callable[..., Any], *arguments: Any) -> None:
        """A service calls the box."""
        name = method.__name__
        if name in _CALLS:
            call = _CALLS[name](*arguments)
            self._hear(name, *arguments)
            name = call[0] if name == "act" else name
            self.calls.append(call)
            if self.held in ("", name):
                self.answer_gate.wait()
            if self.refuse is not None:
                raise Refused([self.refuse])
            if call[1] in self.zones and self.zones[call[1]].takes(*call):
                return
        self.event(method, *arguments)

    def _hear(self, method: str, *arguments: Any) -> None:
        """Note what the referee said."""
        if method == "act" and arguments[1] in _SAID:
            target, action, who, given = arguments
            self.words.append((target.run, given.get(_SAID[action], ""), who.rpartition(" (")[0]))

    # -- topics -------------------------------------------------------------------------------------

    @property
    def silent(self) -> bool:
        """Whether the core publishes nothing by itself."""
        return self._silent

    @silent.setter
    def silent(self, silent: bool) -> None:
        with self._speaking:  # after the last messages
            self._silent = silent

    def clock(self) -> float:
        """The box's clock, UTC seconds."""
        return self._now().utc

    def _tick(self, _event: object) -> None:
        with self._speaking:
            if not self._silent:
                self.publish()

    def publish(self, clock: Optional[float] = None, scores: Optional[Dict[tuple, int]] = None) -> None:
        """Publish once; `clock` and `scores` (of the first zone) make it an older message."""
        with self._lock:  # also while it is sent: an older message must not come after a newer one
            self.event(self.box.tick)
            now = self._now()
            made = PanelMessages(self.box, self.box_uuid, "127.255.255.255")  # a new one: all of it is news
            gui, details, clocks = _read(made.to_gui(now, {})), _read(made.details(now)), _read(made.clocks(now))
            results, schedule, judging = (
                board.take(now) for board in (self._results, self._schedule, self._judging))
            for event in () if schedule is None else schedule.events:
                if event.state in ("next", "later"):
                    event.begins = event.schedule + rospy.Duration(LATE_S)
            for zone, *messages in zip(self.zones.values(), gui.zones, details.zones, clocks.zones):
                zone.put_into(*messages)
            self._put_into(gui)
            if clock is not None:
                gui.clock = details.clock = clocks.clock = rospy.Time.from_sec(clock)
            self.said_utc_s = gui.clock.to_sec()
            if scores is not None:
                for group in gui.zones[0].scoring:
                    group.current_values = [scores.get((group.group_name, desc), 0) for desc in group.descriptions]
            taken_over = Superseded(self.box_uuid, self.superseded_by) if self.superseded_by else None
            for message in (gui, details, clocks, results, schedule, judging, taken_over):
                if message is not None:
                    topic = next(name for name, kind in TOPICS.items() if isinstance(message, kind))
                    NODE.publish(self, topic, message)

    def _put_into(self, gui: CoreToGui) -> None:
        """Set the robots and the tablet, whose times a test can rely on."""
        ago = rospy.Duration.from_sec
        gui.active_robots = [
            RobotInfo(team, robot, ago(skew), gui.clock - ago(self.heard_ago_s)) for team, robot, skew in self.robots
        ]
        gui.tablet_last_beacon = gui.clock - ago(0.6) if self.tablet_heard else rospy.Time()
        gui.tablet_display_map = True
        gui.tablet_call_time, gui.tablet_position_time = gui.clock - ago(75), gui.clock - ago(12)
        gui.tablet_position_x, gui.tablet_position_y = 1.5, 3.25


def _wire(now: Now) -> tuple:
    return divmod(int(now.utc * 1e9), 10**9)


def main() -> None:
    """A core to look at panels with."""
    connections.init_node("roah_rsbb_core")
    FakeCore()
    rospy.spin()


if __name__ == "__main__":
    main()
