"""A core for tests of panels: the real box, with a real door, but without network and disk.

`FakeCore` lives in a test's process. Its robots are always there, do at once what the box asks, and execute until the
test ends the run. A test can also set what is published although the box does not say so: warnings, a log, a manual
operation and so on. As a program it is a core to try panels on: `python3 -m support.fakes.core` in test/ros, with a
roscore.
"""

import asyncio
import threading
import time
from functools import partial
from typing import Any, Callable, Dict, List, NamedTuple, Optional, Set, Tuple

import rosgraph
import rospy

from helpers.commands import given_with, mark_with
from helpers.forms import shown_form
from roah_rsbb.box.calls import BoxCalls
from roah_rsbb.box.door import Door
from roah_rsbb.client.places import PARAM, file_of, write_place
from roah_rsbb.core.actions.base import ZoneAction
from roah_rsbb.core.actions.table import Target
from roah_rsbb.core.box import Box
from roah_rsbb.core.robots import RobotId
from roah_rsbb.core.runs.run import ZoneRun
from roah_rsbb.core.settings import Settings
from roah_rsbb.core.views.document import Documents
from roah_rsbb.document.calls import Call, InThread, Waiting, carried_out, waited
from roah_rsbb.document.document import Written
from roah_rsbb.model import fields
from roah_rsbb.model.actions import ACTIONS, EVERY, MARK
from roah_rsbb.model.clock import Now, one_moment
from roah_rsbb.model.document import Document, RobotSeen, TabletSeen
from roah_rsbb.model.messages import RobotReport
from roah_rsbb.model.modules import form_of_one
from roah_rsbb.model.reason import Refused, decoded
from roah_rsbb.model.records import EndReason, ScoreValue
from roah_rsbb.model.scoring import ScoreKind, ScoringItem
from roah_rsbb.model.zone import LATELY_S, AllRobots, RunClock, Switches, ZoneSeen
from roah_rsbb.protocol import BoxState, RobotState
from roah_rsbb.ros import connections
from roah_rsbb.rulebook.benchmarks import Benchmark, Config, ScheduledEvent, ZonePlan
from roah_rsbb.scoring.book import RunBook
from roah_rsbb.scoring.sheet import Mark

TOKEN = "a token"
TICK_S = 0.05
# All fake cores of the process open their doors in this loop.
LOOP = asyncio.new_event_loop()
threading.Thread(target=LOOP.run_forever, name="doors", daemon=True).start()


def _in_loop(work: Callable[[], object]) -> None:
    """Do something in the loop's thread, and wait for it."""
    async def do() -> None:
        work()

    asyncio.run_coroutine_threadsafe(do(), LOOP).result()


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
_SAID = {MARK: "note", "withdraw": "note", "stop_reason": "reason"}


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
        self.module_scores: List[ScoreValue] = []
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
        """As in `ZoneSeen`."""
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
        """The run ends by itself; `reason` as in `ZoneSeen`."""
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

    def put_into(self, shown: ZoneSeen) -> ZoneSeen:
        """Return the zone with what is published beside what the box says."""
        robot = shown.robot if self.robot is None or shown.robot is None else shown.robot._replace(robot=self.robot)
        lines = tuple(self.all_robots)
        clock = shown.clock._replace(paused=self.paused or shown.clock.paused, goal=self.goal.goal,
                                     goal_limit=self.goal.goal_limit, goal_elapsed=self.goal.goal_elapsed)
        shown = shown._replace(
            log=shown.log if self.log is None else self.log,
            online_data=self.online_data or shown.online_data,
            items=shown.items if self.has_items else (),
            robot=robot,
            all_robots=AllRobots(shown.port, 0, 0, len(lines), lines) if lines else shown.all_robots,
            not_stopped=(*shown.not_stopped, *self.not_stopped),
            module_scores=tuple(self.module_scores),
            clock=clock,
        )
        asked, switches = self.asked, self.switches  # the test or a call may change them at any moment
        if asked is not None:
            operation = shown_form(asked.operation, asked.fields, asked.text)
            shown = shown._replace(manual_operation=asked.text, operation=asked.operation,
                                   actions={**shown.actions, "operation": operation})
        if switches is not None:
            shown = shown._replace(switches=Switches(tuple(sorted(switches)), self.damaged, self.switches_asked))
        return shown


class FakeCore:
    """Publishes as the core does and answers its services. Tests change its attributes at any time."""

    def __init__(
        self, zones: tuple = ("Home A", "Home B"), box_uuid: str = "fake", silent: bool = False,
        items: Tuple[ScoringItem, ...] = ITEMS,
    ) -> None:
        """`silent`: publish and answer nothing until the test sets this to False. `items`: of all benchmarks."""
        self._items = items
        self.calls: List[tuple] = []  # see _CALLS
        self.words: List[tuple] = []  # (identity, note, referee) of the calls that have them
        self.refuse: Optional[str] = None  # reason with which every service fails
        self.answer_gate = threading.Event()  # cleared: services do not answer
        self.answer_gate.set()
        self.held = ""  # the only method that waits for the gate, such as "sign_off"; empty: all
        self.deaf = False  # the robots do not obey the box any more
        self._speaks = threading.Event()
        self.silent = silent
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
        self._documents, self._written = Documents(self.box, box_uuid, "127.255.255.255"), Written(Document)
        self._robots_speak()
        self.look()
        self._calls: Dict[str, Call] = {}
        self._door: Optional[Door] = None
        for name, call in BoxCalls(self.box, self._serve).named().items():
            self.add_call(name, call)
        _in_loop(self._open)

    def _new_box(self, zones: tuple) -> Box:
        benchmarks = {code: Benchmark(code, name, desc, s, s, self._items)
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
        self.silent = False
        self.leave()

    def leave(self) -> None:
        """The core's process has ended."""
        door, self._door = self._door, None
        if door is not None:
            _in_loop(door.close)

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
                self.box.outbox.take()
                self.box.outbox.take_changed()

    def _now(self) -> Now:
        # One clock only: a pause between the readings of two would be a step of the clock.
        mono = time.monotonic() + self._passed_s
        return Now(mono, mono + self._utc_at_0)

    def _robots_speak(self) -> None:
        """All robots say what they have to say."""
        for robot, host in self._hosts.items():
            if self.box.zones.run_of(robot) is None:
                now = self._now()
                self.box.arrivals.on_robot_beacon(now, host, robot.team, robot.robot, _wire(now))
        for run in () if self.deaf else self.box.zones.members():
            for _ in range(3):
                now, asked = self._now(), run.message.state
                report = RobotReport(_wire(now), 1, _ANSWERS[asked])
                self.box.arrivals.on_robot_report(now, run.port, self._hosts[run.robot], report)
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

    # -- the door -----------------------------------------------------------------------------------

    @property
    def silent(self) -> bool:
        """Whether the core hangs: it publishes and answers nothing."""
        return not self._speaks.is_set()

    @silent.setter
    def silent(self, silent: bool) -> None:
        (self._speaks.clear if silent else self._speaks.set)()

    def clock(self) -> float:
        """The box's clock, UTC seconds."""
        return self._now().utc

    def add_call(self, name: str, call: Call) -> None:
        """Answer another call."""
        self._calls[name] = partial(self._call, call)
        door = self._door
        if door is not None:
            _in_loop(partial(door.add_calls, {name: self._calls[name]}))

    def _open(self) -> None:
        self._door = Door(LOOP, TOKEN, self._calls, self._now, self._written)
        url = f"ws://127.0.0.1:{self._door.open('127.0.0.1')}/door"
        write_place(file_of(rosgraph.get_master_uri()), url, TOKEN)
        rospy.set_param(PARAM, {"url": url, "token": TOKEN})
        self._tick()

    def publish(self) -> None:
        """Publish now what the test changed."""
        door = self._door
        if door is not None:
            self.look()
            _in_loop(door.publish)

    def _tick(self) -> None:
        """Publish as the core does, and give signs of life, unless it is silent."""
        door = self._door
        if door is None:
            return
        LOOP.call_later(TICK_S, self._tick)
        if not self.silent:
            self.look()
            door.publish()
            door.sign()

    @property
    def number(self) -> int:
        """Of the document."""
        return self._written.number

    def look(self) -> None:
        """Let the document be what the box is now. A core that is not silent publishes it soon."""
        with self._lock:
            self.event(self.box.timers.tick)
            now = self._now()
            self._written.update(self._put_into(self._documents.look(now), now), now)

    def _call(self, call: Call, arguments: Any, caller: Any) -> InThread:
        """Carry a call out in a thread, because a test may let it wait."""
        def make() -> Any:
            self._speaks.wait()
            found = carried_out(call, arguments, caller)
            answer = waited(found) if isinstance(found, (InThread, Waiting)) else found
            if "refused" in answer:
                raise Refused(decoded(answer["refused"]))
            self.look()
            return answer["answer"]

        return InThread(make)

    def _put_into(self, document: Document, now: Now) -> Document:
        """Set what is published beside what the box says; and robots and a tablet whose times a test can rely on."""
        silent_since = round(now.mono - self.heard_ago_s, 1) if self.heard_ago_s > LATELY_S else None
        robots = {f"{robot} of team {team}": RobotSeen(team, robot, skew, silent_since)
                  for team, robot, skew in self.robots}
        tablet = TabletSeen(self.tablet_heard, None, True, round(now.utc) - 75, round(now.utc) - 12, 1.5, 3.25)
        schedule = {key: event._replace(begins_utc_s=event.scheduled_utc_s + LATE_S)
                    if event.state in ("next", "later") else event for key, event in document.schedule.items()}
        return document._replace(
            box=document.box._replace(tablet=tablet, superseded_by=self.superseded_by),
            robots=robots, schedule=schedule,
            zones={name: self.zones[name].put_into(zone) for name, zone in document.zones.items()})


def _wire(now: Now) -> tuple:
    return divmod(int(now.utc * 1e9), 10**9)


def main() -> None:
    """A core to look at panels with."""
    connections.init_node("roah_rsbb_core")
    FakeCore()
    rospy.spin()


if __name__ == "__main__":
    main()
