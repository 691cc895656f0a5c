"""A box as the terminal's referee sees it, and a link to a core that a test plays, in simulated time."""

from typing import Callable, Dict, List, Optional

from roah_rsbb.model.actions import ACTIONS, Row
from roah_rsbb.model.referee import Refused
from roah_rsbb.referee.exits import NoCore
from roah_rsbb.referee.state import (
    CONNECTED,
    ENDED,
    IDLE,
    RUNNING,
    BoxSnapshot,
    EventSnapshot,
    RobotSnapshot,
    RunTimes,
    SheetItem,
    ZoneSnapshot,
)
from roah_rsbb.referee.words import Entered

UTC0 = 1447000000.0  # 2015-11-08 16:26:40Z
TICK_S = 0.1
LONG_S = 300.0  # simulated; no test plans anything after that
ITEMS = (
    SheetItem(1, "Achievements", "Detects the door", "bool", 0),
    SheetItem(2, "Achievements", "Moved furniture", "uint", 0),
    SheetItem(3, "Penalized", "Bumps into the furniture", "uint", 0),
)
EVENTS = tuple(
    EventSnapshot(code, f"Name of {code}", f"What {code} is", "TestingTeam", 1, run, UTC0 + 600 * run, 600.0)
    for run, code in enumerate(("HGTKMH", "HWV", "HGTKMH", "HCFGAC"), 1)
)


RUN_TIMES = RunTimes(
    ("Run: time left 8:33", "Goal: time left 0:45", "Used: 1:27 of 10:00"), "", 600.0, 87.7, True, 2, 60.0, 15.0, True,
    0.0,
)


def zone(**fields) -> ZoneSnapshot:
    """A zone without a run."""
    default = ZoneSnapshot(
        zone="Home A", event=EVENTS[0], phase=IDLE, identity="", end_reason="", timer_s=600.0,
        state=("Robot ready",), robot="", port=0, box_state="", robot_state="", skew_s=None,
        last_message_utc_s=None, messages_saved=0, manual_operation="", warnings=(),
        off={command: [] for command in ACTIONS}, score=(), log_file="", log="", online_data="",
        times=RunTimes(("Time limit of the run 10:00",), "", 600.0, 0.0, False, 0, 60.0, 0.0, False, 0.0),
    )
    return default._replace(**fields)


def running_zone(**fields) -> ZoneSnapshot:
    """A zone with a run that was started."""
    return zone(**{
        "phase": RUNNING, "identity": "HGTKMH-6667-1", "robot": "mbot", "port": 6667,
        "box_state": "PREPARE", "robot_state": "PREPARING", "skew_s": 0.0123,
        "last_message_utc_s": UTC0 - 0.5, "score": ITEMS, "log_file": "/logs/run.bag",
        "timer_s": 512.3, "times": RUN_TIMES, **fields,
    })


def robot(name: str = "mbot", team: str = "TestingTeam", skew_s: float = 0.0123) -> RobotSnapshot:
    """An active robot."""
    return RobotSnapshot(team, name, skew_s, UTC0 - 0.5, 0.5)


def box(*zones: ZoneSnapshot, **fields) -> BoxSnapshot:
    """A box with these zones, or one zone without a run."""
    default = BoxSnapshot(UTC0, "OK", "127.255.255.255", "6666", "uuid-1", (), (robot(),), zones or (zone(),))
    return default._replace(**fields)


# Fields of a zone that come on /core/details; the others come on /core/to_gui.
DETAILS = ("phase", "identity", "end_reason", "robot", "port", "box_state", "robot_state", "skew_s", "off", "log_file")


NO_RUN = {"phase": IDLE, "identity": "", "robot": "", "port": 0, "score": (), "end_reason": ""}


class FakeLink:
    """A link to a core of one zone. Time advances by `next` only; `at` plans what happens when.

    `true_box` is what the core has. `box` is what has arrived of it: `details_late_s` gives the delay of each
    CoreDetails in turn.
    """

    def __init__(self) -> None:
        self.time = 0.0
        self.heard = 0.0
        self.silent = False
        self.dead = False  # silent, and no service answers
        self.extra_off: Dict[str, List[str]] = {}
        self.details_late_s: Callable[[], float] = lambda: 0.0
        self.true_box = box(self._with_off(zone()))
        self.box = self.true_box
        self.commands: List[str] = []
        self.scores: Dict[str, int] = {}
        self.answers: Dict[str, List[Optional[Exception]]] = {}  # for a command: what its next calls raise
        self.index = 0
        self.given: List[tuple] = []  # answers to manual operations and entries for switches, as they came
        self._plans: List[tuple] = []
        self._connects = 0
        self._details_on_the_way: List[tuple] = []  # when it arrives, when it was published, the box then
        self._details: tuple = (0.0, self.true_box)  # when it was published, the box then

    # -- what a test plays ---------------------------------------------------------------------------

    def at(self, seconds: float, what: Callable[[], None]) -> None:
        """Plan an event."""
        self._plans.append((seconds, what))

    def change(self, **fields) -> None:
        """Change the zone."""
        new = self._with_off(self.zone._replace(**fields))
        self.true_box = self.true_box._replace(zones=(new,), clock_utc_s=UTC0 + self.time)

    def end(self, reason: str) -> None:
        """End the run."""
        self.change(phase=ENDED, end_reason=reason)

    def die(self) -> None:
        """The core's process is gone."""
        self.silent = self.dead = True

    def restart(self, **fields) -> None:
        """The core is started again; without `fields` its zone has no run any more."""
        self.silent = self.dead = False
        self.index = 0
        self.true_box = self.true_box._replace(box_uuid=self.true_box.box_uuid + "'")
        self.change(**(fields or {**NO_RUN, "event": EVENTS[0]}))

    def block(self, command: str, *reasons: str) -> None:
        """Reasons why a command is off, beside its own; none: it is free again."""
        self.extra_off = {**self.extra_off, command: list(reasons)}
        self.change()

    @property
    def zone(self) -> ZoneSnapshot:
        """The zone as the core has it now."""
        return self.true_box.zones[0]

    def connect(self) -> None:
        """Somebody connects a robot; each run has another identity."""
        self._connects += 1
        self.change(phase=CONNECTED, identity=f"run {self._connects}", robot="mbot", port=6667, score=ITEMS,
                    end_reason="")

    # -- what a Link does ----------------------------------------------------------------------------

    def now(self) -> float:
        """Simulated seconds."""
        return self.time

    @property
    def silence_s(self) -> float:
        """For how long nothing was published."""
        return self.time - self.heard

    def next(self, limit_s: float) -> Optional[BoxSnapshot]:
        """The next tick, or None after `limit_s` of silence."""
        deadline = self.time + limit_s
        while self.time < deadline:
            self.time = min(self.time + TICK_S, deadline)
            assert self.time < LONG_S, "nothing ends this run"
            while True:
                due = [plan for plan in self._plans if plan[0] <= self.time]
                if not due:
                    break
                self._plans.remove(due[0])
                due[0][1]()
            if not self.silent:
                self.heard = self.time
                self._publish()
                return self.box
        return None

    def _publish(self) -> None:
        """Details arrive in their order, each after its delay."""
        arrives = self.time + self.details_late_s()
        if self._details_on_the_way:
            arrives = max(arrives, self._details_on_the_way[-1][0])
        self._details_on_the_way.append((arrives, self.time, self.true_box))
        while self._details_on_the_way and self._details_on_the_way[0][0] <= self.time:
            self._details = self._details_on_the_way.pop(0)[1:]
        zones = self.true_box.zones
        if zones and self._details[1].zones:
            old = self._details[1].zones[0]
            zones = (zones[0]._replace(**{name: getattr(old, name) for name in DETAILS}),)
        self.box = self.true_box._replace(zones=zones, box_uuid=self._details[1].box_uuid)

    def settle(self) -> BoxSnapshot:
        """As the real one: by the core's clock."""
        if self.dead:
            raise NoCore("gone")
        clock = self.time
        while True:
            if self.next(2.0) is None:
                raise NoCore("silent")
            if self._details[0] > clock:
                return self.box

    def act(self, action: str, name: str, given: Optional[dict] = None, run: str = "") -> None:
        """Do an action as the core would: in this run, if one is named, and with this robot."""
        if ACTIONS[action].row is Row.MODULE:
            self._enter(action, given or {})
            return
        self._call(action, name)
        if run and run != self.zone.identity:
            raise Refused([f"run {run} is not connected"])
        if action == "disconnect" and self.zone.phase == RUNNING:
            raise Refused([f"run {run} is running: stop it first"])
        if self.zone.off[action]:
            raise Refused(self.zone.off[action])
        {
            "connect": self.connect,
            "start": lambda: self.change(phase=RUNNING),
            "stop": lambda: self.end("stopped"),
            "disconnect": lambda: self.change(**NO_RUN),
            "next": lambda: self._move(1),
            "previous": lambda: self._move(-1),
        }[action]()
        if given:
            self.change(**given)

    def stop_run(self, name: str, identity: str) -> None:
        """As the core: only the run of that identity."""
        self._call("stop_run", name)
        if identity == self.zone.identity and self.zone.phase == RUNNING:
            self.end("stopped")

    def _call(self, command: str, name: str) -> None:
        assert name == self.zone.zone
        if self.dead:
            raise NoCore("gone")
        self.commands.append(command)
        answer = (self.answers.get(command) or [None]).pop(0)
        if answer is not None:
            raise answer

    def mark(self, name: str, identity: str, item: SheetItem, entered: Entered) -> None:
        """Mark an item."""
        assert identity == self.zone.identity
        answer = (self.answers.get("mark") or [None]).pop(0)
        if answer is not None:
            raise answer
        now = next(i for i in self.zone.score if i.item == item.item)
        value = now.value + int(entered.added) if entered.added else entered.value
        self.scores[item.item] = value
        self.change(score=tuple(i._replace(value=value) if i.item == item.item else i for i in self.zone.score))

    def _enter(self, action: str, given: dict) -> None:
        """What a benchmarking module asked for. As in the core, the number of an operation must be right."""
        self._give(action, *given.values())
        if action == "operation":
            if self.zone.operation is None or self.zone.operation.number != given["operation"]:
                raise Refused(["that manual operation is over"])
            self.change(operation=None)
        elif action == "confirm_switches":
            self.change(switches=None)

    def _give(self, *what: object) -> None:
        answer = (self.answers.get(what[0]) or [None]).pop(0)
        if answer is not None:
            raise answer
        self.given.append(what)

    def _move(self, by: int) -> None:
        self.index += by
        self.change(event=EVENTS[self.index])

    def _with_off(self, fresh: ZoneSnapshot) -> ZoneSnapshot:
        index = EVENTS.index(fresh.event)
        idle, extra = fresh.phase == IDLE, self.extra_off
        own = {
            "connect": [] if idle else ["Already connected"],
            "start": [] if fresh.phase in (CONNECTED, ENDED) else ["Not now"],
            "stop": ["No run"] if idle else [],
            "disconnect": ["No run"] if idle else [],
            "previous": [] if idle and index > 0 else ["first event"],
            "next": [] if idle and index < len(EVENTS) - 1 else ["last event"],
        }
        own = {command: own.get(command, ["Not in this test"]) for command in ACTIONS}
        return fresh._replace(off={command: own[command] + extra.get(command, []) for command in ACTIONS})
