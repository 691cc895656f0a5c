"""A core for tests of panels: real ROS messages and services, a referee's view of a run, no robots.

`FakeCore` lives in a test's process and does what the test requests. As a program it is a core to try
panels on: `python3 -m support.fakes.core` in test/ros, with a roscore.
"""

import threading
import time
from typing import Callable, Dict, List, NamedTuple, Optional, Set

import rospy
from std_srvs.srv import Empty

from roah_rsbb.core.scoring.book import FinishedRuns, RunBook
from roah_rsbb.core.scoring.records import By, RunRecord, ScoreValue
from roah_rsbb.core.scoring.sheet import Mark
from roah_rsbb.msg import (
    CoreDetails,
    CoreToGui,
    CoreToPublic,
    ModuleScore,
    Results,
    RobotInfo,
    RunClock,
    RunClocks,
    Schedule,
    ScheduleEvent,
    ScheduleInfo,
    ZoneDetails,
    ZoneScoreGroup,
    ZoneState,
)
from roah_rsbb.nodes.core.results_convert import summary_message
from roah_rsbb.ros import refusals
from roah_rsbb.rulebook.benchmarks import Benchmark, ScoreKind, ScoringItem
from roah_rsbb.srv import ChooseEvent, GetClock, LeaveRun, ManualOperationAnswer, StopRun, Zone, ZoneScore, ZoneUInt8
from support.fakes.node import FakeNode
from support.fakes.scores import SCORE_SERVICES, FakeScores, present

COMMANDS = ("connect", "disconnect", "start", "stop", "previous", "next")
FIELDS = {"previous": "prev"}
NODE = FakeNode(
    {"/core/to_gui": CoreToGui, "/core/details": CoreDetails, "/core/to_public": CoreToPublic,
     "/core/clocks": RunClocks, "/core/results": Results, "/core/schedule": Schedule},
    {
        **{f"/core/{command}": Zone for command in COMMANDS},
        "/core/stop_run": StopRun,
        "/core/leave_run": LeaveRun,
        "/core/choose_event": ChooseEvent,
        "/core/clock": GetClock,
        "/core/set_score": ZoneScore,
        **SCORE_SERVICES,
        "/core/manual_operation_answer": ManualOperationAnswer,
        "/core/omf_switches/complete": Zone,
        "/core/omf_switches/button": ZoneUInt8,
        "/core/omf_switches/damaged": ZoneUInt8,
    },
)
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


class Asked(NamedTuple):
    """A manual operation."""

    operation: int
    text: str
    choices: tuple = ()
    asks_text: bool = False


class FakeZone:
    """A zone and the run in it; changes as a real one does, in few strokes."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.index = 0
        self.phase = "idle"
        self.has_items = True  # for the referee to score
        self.robot = "mbot"
        self.all_robots: List[str] = []  # lines of all robots at once
        self.end_reason = ""
        self.started = 0.0
        self.left_s = EVENTS[0][4]
        self.elapsed_s = 0.0  # before a pause, and at the end of the run
        self.paused = ""  # why the time does not count
        self.goal = RunClock()  # its fields of the goal
        self.log = ""
        self.online_data = ""
        self.scores: Dict[tuple, int] = {}
        self.book = RunBook(ITEMS)
        self.identity = ""
        self.opened = 0.0
        self.finished = FinishedRuns({code: Benchmark(code, name, desc, left, left, ()) for code, name, desc, _, left
                                      in EVENTS})
        self.extra_off: Dict[str, List[str]] = {}  # command to reasons why it is off, beside its own
        self.warnings: List[str] = []
        self.asked: Optional[Asked] = None  # manual operation
        self.module_scores: List[ModuleScore] = []
        self.switches: Optional[Set[int]] = None  # HOMF: those that are on
        self.damaged = 0
        self.switches_asked = False

    def off(self) -> Dict[str, List[str]]:
        """Why each command is off."""
        free, running = self.phase == "idle", self.phase == "running"
        own = {
            "connect": [] if free else ["Already connected"],
            "disconnect": ["No run is connected"] if free else [],
            "start": ["No run is connected: press connect first"] if free else ["Already started"] if running else [],
            "stop": [] if running else ["No run is connected, so there is nothing to stop"] if free
            else ["The run is over: disconnect to leave it"],
            "previous": ([] if free else ["A run is connected: disconnect it first"])
            + (["This is the zone's first event"] if self.index == 0 else []),
            "next": ([] if free else ["A run is connected: disconnect it first"])
            + (["This is the zone's last event"] if self.index == len(EVENTS) - 1 else []),
        }
        return {command: reasons + self.extra_off.get(command, []) for command, reasons in own.items()}

    def command(self, command: str) -> None:
        """Carry a command out."""
        steps: Dict[str, Callable[[], None]] = {
            "connect": lambda: self._to("connected"),
            "disconnect": lambda: self._to("idle"),
            "start": self._start,
            "stop": self._stop,
            "previous": lambda: self._move(-1),
            "next": lambda: self._move(1),
        }
        steps[command]()
        self.log += f"{time.strftime('%H:%M:%S', time.gmtime())} {command}\n"

    def record(self) -> RunRecord:
        """The record of the run, as the real core makes it."""
        code, _, _, team, _ = EVENTS[self.index]
        scores = tuple(ScoreValue(s.group, s.name, s.value, s.unit, s.desc) for s in self.module_scores)
        return self.book.into(RunRecord(
            self.identity, self.name, code, team, 1, self.index + 1, SCHEDULE_START, self.opened,
            end_reason=self.end_reason, module_scores=scores, robots=(self.robot,),
        ))

    def mark(self, mark: Mark, who: str) -> None:
        """The referee marks an item."""
        item = self.book.mark(present(), who, mark).item
        self.scores[(mark.group, mark.desc)] = item.value

    def timer(self) -> float:
        """Seconds left."""
        return self.left_s - (time.monotonic() - self.started if self.phase == "running" else 0.0)

    def elapsed(self) -> float:
        """Seconds that counted."""
        counting = self.phase == "running" and not self.paused
        return self.elapsed_s + (time.monotonic() - self.started if counting else 0.0)

    def pause(self, why: str) -> None:
        """The time of the run does not count; empty: it counts again."""
        self.elapsed_s, self.started, self.paused = self.elapsed(), time.monotonic(), why

    def clock(self) -> RunClock:
        """The times of the run."""
        goal, seconds = self.goal, rospy.Duration.from_sec
        return RunClock(
            self.name, self.identity, self.phase, seconds(EVENTS[self.index][4]), seconds(self.elapsed()),
            self.phase == "running" and not self.paused, self.paused, goal.goal_limit, goal.goal, goal.goal_elapsed,
            goal.goal_counting, seconds(120.0 if self.phase == "ended" else 0.0),
        )

    def _to(self, phase: str) -> None:
        if phase == "idle" and self.identity:
            self.finished.add(self.record()._replace(closed_utc=time.time()))
            self.identity = ""
        self.phase, self.end_reason, self.elapsed_s, self.paused = phase, "", 0.0, ""
        self.left_s = EVENTS[self.index][4]
        if phase == "connected":
            self.scores, self.book, self.opened = {}, RunBook(ITEMS), time.time()
            self.identity = f"{EVENTS[self.index][0]}-6667-{self.opened:.3f}"

    def _start(self) -> None:
        self._to("running")
        self.book.started(present())
        self.started = time.monotonic()

    def _stop(self) -> None:
        if self.phase == "running":
            self.elapsed_s = self.elapsed()
            self.phase, self.end_reason, self.left_s = "ended", "stopped", 120.0
            self.book.ended(present(), "stopped", "Benchmark stopped by the referee", By("/referee"), self.elapsed_s)
        else:
            self._to("idle")

    def _move(self, by: int) -> None:
        self.index += by
        self._to("idle")


class FakeCore(FakeScores):
    """Publishes as the core does and answers its services. Tests change its attributes at any time."""

    def __init__(self, zones: tuple = ("Home A", "Home B"), auto_publish: bool = True) -> None:
        self.zones = {name: FakeZone(name) for name in zones}
        self.calls: List[tuple] = []  # (command, zone) and ("set_score" or "score", zone, group, desc, value)
        self.words: List[tuple] = []  # (identity, note, referee) of the calls that have them
        self.refuse: Optional[str] = None  # reason with which every service fails
        self.answer_gate = threading.Event()  # cleared: services do not answer
        self.answer_gate.set()
        self.silent = False
        self.box_warnings: List[str] = []
        self.heard_ago_s = 0.4
        self.robots = [("TestingTeam", "mbot", 0.0123), ("AnotherTeam", "amigo", -0.0871)]
        self.status = "OK"
        self.tablet_heard = True
        self._last_results: Optional[Results] = None
        self._last_schedule: Optional[Schedule] = None
        NODE.begin(self, {
            **{f"/core/{c}": lambda request, c=c: self._on_command(c, request) for c in COMMANDS},
            "/core/stop_run": self._on_stop_run,
            "/core/leave_run": self._on_leave_run,
            "/core/choose_event": self._on_choose_event,
            "/core/clock": lambda _: [rospy.Time.from_sec(time.time())],
            "/core/set_score": self._on_score,
            **self.score_answers(),
            "/core/manual_operation_answer": self._on_operation,
            "/core/omf_switches/complete": self._on_switches_complete,
            "/core/omf_switches/button": self._on_switch,
            "/core/omf_switches/damaged": self._on_damaged,
        })
        self._timer = rospy.Timer(rospy.Duration(0.1), self._tick) if auto_publish else None

    def close(self) -> None:
        """The test case is over."""
        self.answer_gate.set()
        if self._timer is not None:
            self._timer.shutdown()
        NODE.end(self)

    def leave(self) -> None:
        """Topics and services are gone, as if the core's process had ended."""
        self.close()
        NODE.leave()

    # -- topics -------------------------------------------------------------------------------------

    def publish(self, clock: Optional[float] = None, scores: Optional[Dict[tuple, int]] = None) -> None:
        """Publish once; `clock` and `scores` (of the first zone) make it an older message."""
        now = rospy.Time.from_sec(time.time() if clock is None else clock)
        gui = self.gui_message(now)
        if scores is not None:
            gui.zones[0].scoring = _scoring(scores)
        NODE.publish(self, "/core/to_gui", gui)
        NODE.publish(self, "/core/details", self.details_message(now))
        NODE.publish(self, "/core/clocks", RunClocks(now, "fake", [zone.clock() for zone in self.zones.values()]))
        NODE.publish(self, "/core/to_public", self.public_message(now))
        results = Results("fake", [summary_message(record) for record in self.records()])
        if results != self._last_results:
            self._last_results = results
            NODE.publish(self, "/core/results", results)
        schedule = Schedule(rospy.Time(), "fake", self._schedule_events())
        if schedule != self._last_schedule:
            self._last_schedule = schedule
            NODE.publish(self, "/core/schedule", schedule)

    def gui_message(self, now: rospy.Time) -> CoreToGui:
        """CoreToGui at `now`."""
        message = CoreToGui(clock=now, status=self.status, addr="127.255.255.255", port="6666")
        message.active_robots = [
            RobotInfo(team, robot, rospy.Duration.from_sec(skew), now - rospy.Duration.from_sec(self.heard_ago_s))
            for team, robot, skew in self.robots
        ]
        message.zones = [self._zone_state(zone) for zone in self.zones.values()]
        if self.tablet_heard:
            message.tablet_last_beacon = now - rospy.Duration.from_sec(0.6)
        message.tablet_display_map = True
        message.tablet_call_time = now - rospy.Duration.from_sec(75)
        message.tablet_position_time = now - rospy.Duration.from_sec(12)
        message.tablet_position_x, message.tablet_position_y = 1.5, 3.25
        return message

    def details_message(self, now: rospy.Time) -> CoreDetails:
        """CoreDetails at `now`."""
        zones = []
        for zone in self.zones.values():
            connected = zone.phase != "idle"
            details = ZoneDetails(zone=zone.name, phase=zone.phase, end_reason=zone.end_reason)
            details.robot = zone.robot if connected else ""
            details.port = 6667 if connected else 0
            details.identity = zone.identity
            details.not_attempted = [item.not_attempted for item in zone.book.sheet.items()] if connected else []
            details.robots = list(zone.all_robots)
            details.warnings = list(zone.warnings)
            details.module_scores = list(zone.module_scores)
            if zone.asked is not None:
                details.operation, details.operation_asks_text = zone.asked.operation, zone.asked.asks_text
                details.operation_choices = list(zone.asked.choices)
            for command, reasons in zone.off().items():
                setattr(details, f"{FIELDS.get(command, command)}_off", reasons)
            zones.append(details)
        return CoreDetails(clock=now, box_uuid="fake", warnings=list(self.box_warnings), zones=zones)

    def public_message(self, now: rospy.Time) -> CoreToPublic:
        """CoreToPublic at `now`."""
        message = CoreToPublic(clock=time.strftime("%Y-%m-%d %H:%M:%S", time.gmtime(now.to_sec())))
        for number in range(len(EVENTS)):
            for zone in self.zones.values():
                if number >= zone.index:
                    _, _, desc, team, _ = EVENTS[number]
                    at = time.strftime("%Y-%m-%d %H:%M:%S", time.gmtime(now.to_sec() // 3600 * 3600 + 1800 * number))
                    running = number == zone.index and zone.phase != "idle"
                    message.schedule.append(ScheduleInfo(team, desc, 1, number + 1, at, running))
        return message

    def _zone_state(self, zone: FakeZone) -> ZoneState:
        code, name, desc, team, timeout = EVENTS[zone.index]
        off = zone.off()
        state = ZoneState(zone=zone.name, name=name, code=code, desc=desc, team=team, round=1)
        state.run = zone.index + 1
        state.timeout = rospy.Duration.from_sec(timeout)
        state.schedule = rospy.Time(SCHEDULE_START + 1800 * zone.index)
        state.timer = rospy.Duration.from_sec(zone.timer())
        lines = {"idle": off["connect"] or ["Robot ready to accept connection: TestingTeam mbot"],
                 "connected": off["start"] or ["All OK for start"]}.get(zone.phase, [zone.phase])
        state.state = "\n".join(lines + [f"WARNING: {w}" for w in zone.warnings])
        for command, reasons in off.items():
            setattr(state, f"{FIELDS.get(command, command)}_enabled", not reasons)
        state.log, state.online_data = zone.log, zone.online_data
        state.manual_operation = "" if zone.asked is None else zone.asked.text
        if zone.switches is not None:
            state.omf, state.omf_switches = True, bytes(sorted(zone.switches))
            state.omf_damaged, state.omf_complete = zone.damaged, zone.switches_asked
        state.scoring = [] if zone.phase == "idle" or not zone.has_items else _scoring(zone.scores)
        return state

    def _tick(self, _event: object) -> None:
        if not self.silent:
            self.publish()

    # -- services -----------------------------------------------------------------------------------

    def _on_command(self, command: str, request: object) -> list:
        self.calls.append((command, request.zone))
        self._answer()
        reasons = self.zones[request.zone].off()[command]
        if reasons:
            raise rospy.ServiceException(refusals.error_text(reasons))
        self.zones[request.zone].command(command)
        return []

    def _on_stop_run(self, request: object) -> list:
        self.calls.append(("stop_run", request.zone))
        self._answer()
        zone = self.zones[request.zone]
        if request.identity not in ("", zone.identity):
            raise rospy.ServiceException(f"no run {request.identity}")
        if zone.phase == "running":
            zone.command("stop")
        return []

    def _on_leave_run(self, request: object) -> list:
        self.calls.append(("leave_run", request.zone))
        self._answer()
        zone = self.zones[request.zone]
        if request.identity != zone.identity or zone.phase == "running":
            raise rospy.ServiceException(f"run {request.identity} is running, or not connected")
        zone.command("disconnect")
        return []

    def _schedule_events(self) -> List[ScheduleEvent]:
        """The events of all zones. They are a quarter of an hour apart, and 12 minutes late."""
        events = []
        for zone in self.zones.values():
            last = {record.benchmark: record for record in reversed(zone.finished.records())}
            for index, (code, _, desc, team, _) in enumerate(EVENTS):
                at = SCHEDULE_START + 900 * index
                event = ScheduleEvent(
                    zone=zone.name, code=code, benchmark=desc, team=team, round=1, run=index + 1,
                    schedule=rospy.Time(at), begins=rospy.Time(at + 720), current=index == zone.index, state="later",
                )
                record = last.get(code)
                if record is not None:
                    event.identity, event.end_reason, event.state = record.identity, record.end_reason, "done"
                    if record.sign_off is not None:
                        event.signed = rospy.Time.from_sec(record.sign_off.utc)
                if event.current:
                    event.state = "next" if zone.phase == "idle" else zone.phase
                events.append(event)
        return sorted(events, key=lambda event: event.schedule)

    def _on_choose_event(self, request: object) -> list:
        self.calls.append(("choose_event", request.zone, request.code, request.unsigned))
        self._answer()
        zone = self.zones[request.zone]
        if zone.phase == "ended":
            zone.command("disconnect")
        zone.index = [event[0] for event in EVENTS].index(request.code)
        return []

    def _on_score(self, request: object) -> list:
        score = request.score
        self.calls.append(("set_score", request.zone, score.group, score.desc, score.value))
        self._answer()
        self.zones[request.zone].mark(Mark(score.group, score.desc, score.value), "")
        return []

    def _on_operation(self, request: object) -> list:
        self.calls.append(("operation", request.zone, request.operation, request.answer))
        self._answer()
        self.zones[request.zone].asked = None
        return []

    def _on_switch(self, request: object) -> list:
        self.calls.append(("switch", request.zone, request.data))
        self._answer()
        self.zones[request.zone].switches ^= {request.data}
        return []

    def _on_damaged(self, request: object) -> list:
        self.calls.append(("damaged", request.zone, request.data))
        self._answer()
        self.zones[request.zone].damaged = request.data
        return []

    def _on_switches_complete(self, request: object) -> list:
        self.calls.append(("switches complete", request.zone))
        self._answer()
        self.zones[request.zone].switches_asked = False
        return []

    def _answer(self) -> None:
        self.answer_gate.wait()
        if self.refuse is not None:
            raise rospy.ServiceException(self.refuse)


def _scoring(scores: Dict[tuple, int]) -> List[ZoneScoreGroup]:
    return [
        ZoneScoreGroup(
            group, [kind for kind, _ in items], [desc for _, desc in items],
            [scores.get((group, desc), 0) for _, desc in items],
        )
        for group, items in SCORING
    ]


def main() -> None:
    """A core to look at panels with; /fake_core/hang switches its topics off and on."""
    rospy.init_node("roah_rsbb_core")
    core = FakeCore()

    def hang(_request: object) -> list:
        core.silent = not core.silent
        return []

    rospy.Service("/fake_core/hang", Empty, hang)
    rospy.spin()


if __name__ == "__main__":
    main()
