"""A box as the terminal's referee sees it, and a link to a core that a test plays, in simulated time."""

from typing import Any, Callable, Dict, List, Optional, Sequence

from helpers.forms import shown_form
from roah_rsbb.model.actions import ACTIONS, Row, Shown
from roah_rsbb.model.clock import Now
from roah_rsbb.model.document import BoxSeen, Document, RobotSeen
from roah_rsbb.model.fields import Field
from roah_rsbb.model.reason import Refused
from roah_rsbb.model.results import EventSeen, RunLine, RunSheet
from roah_rsbb.model.scoring import Entered
from roah_rsbb.model.zone import (
    CONNECTED,
    ENDED,
    IDLE,
    RUNNING,
    Count,
    Event,
    RobotInRun,
    RunClock,
    SheetItem,
    ZoneSeen,
)
from roah_rsbb.referee.at_once import NoCore

UTC0 = 1447000000.0  # 2015-11-08 16:26:40Z
MONO0 = 1000.0
NOW = Now(MONO0, UTC0)
TICK_S = 0.1
LONG_S = 300.0  # simulated; no test plans anything after that
SILENT_S = 1.2
ITEMS = (
    SheetItem("Achievements", "Detects the door", "bool"),
    SheetItem("Achievements", "Moved furniture", "uint"),
    SheetItem("Penalized", "Bumps into the furniture", "uint"),
)
EVENTS = tuple(
    Event(f"e{run}", code, f"Name of {code}", f"What {code} is", "TestingTeam", 1, run, UTC0 + 600 * run)
    for run, code in enumerate(("HGTKMH", "HWV", "HGTKMH", "HCFGAC"), 1)
)
ROBOT = RobotInRun("mbot", 6667, "PREPARE", "PREPARING", skew=0.0123, heard=True)
RUN_CLOCK = RunClock(600.0, Count(87.7, MONO0), goal_limit=60.0, goal=2, goal_elapsed=Count(15.0, MONO0))


def off_as(off: Dict[str, Sequence[str]]) -> Dict[str, Shown]:
    """The actions of a zone with the reasons why they are off."""
    return {name: Shown(tuple(reasons)) for name, reasons in off.items()}


def zone(**fields: Any) -> ZoneSeen:
    """A zone without a run. `off`: the reasons why actions are off, instead of `actions`."""
    off = fields.pop("off", dict.fromkeys(ACTIONS, ()))
    default = ZoneSeen("Home A", EVENTS[0], state=("Robot ready",), actions=off_as(off), timeout=600.0,
                       clock=RunClock(600.0))
    return default._replace(**fields)


def running_zone(**fields: Any) -> ZoneSeen:
    """A zone with a run that was started."""
    return zone(**{"phase": RUNNING, "identity": "HGTKMH-6667-1", "robot": ROBOT, "items": ITEMS,
                   "log_file": "/logs/run.bag", "clock": RUN_CLOCK, **fields})


def asked(of: ZoneSeen, number: int, text: str, *fields: Field) -> ZoneSeen:
    """A zone in which a manual operation is asked for; number 0: it is over."""
    shown = shown_form(number, fields, text) if number else Shown((), False)
    return of._replace(operation=number, manual_operation=text, actions={**of.actions, "operation": shown})


def robot(name: str = "mbot", team: str = "TestingTeam", skew: float = 0.0123,
          silent_since: Optional[float] = None) -> RobotSeen:
    """An active robot."""
    return RobotSeen(team, name, skew, silent_since)


def box(*zones: ZoneSeen, robots: Sequence[RobotSeen] = (robot(),), **fields: Any) -> Document:
    """A box with these zones, or one zone without a run. `fields`: of its state."""
    named = {one.zone: one for one in zones or (zone(),)}
    state = BoxSeen("uuid-1", "127.255.255.255", 6666, zones=tuple(named))._replace(**fields)
    return Document(state, {f"{one.robot} of team {one.team}": one for one in robots}, named, {}, {}, {})


NO_RUN = {"phase": IDLE, "identity": "", "robot": None, "items": (), "end_reason": ""}


class FakeLink:
    """A link to a core of one zone. Time advances by `next` only; `at` plans what happens when. `box` is the newest
    document that has arrived."""

    trouble = "the box hangs, restart it"

    def __init__(self) -> None:
        self.time = 0.0
        self.heard = 0.0
        self.silent = False
        self.dead = False  # silent, and no call is answered
        self.extra_off: Dict[str, List[str]] = {}
        self.signed_off = False  # what begins a run is refused, unless it is `again`
        self.events = EVENTS
        self.signed: List[str] = []  # ids of events that are signed off
        self.sheets = {event.id: ITEMS for event in EVENTS}
        self.true_box = self.box = box()
        self.commands: List[str] = []
        self.scores: Dict[str, int] = {}
        self.answers: Dict[str, List[Optional[Exception]]] = {}  # for a command: what its next calls raise
        self.given: List[tuple] = []  # answers to manual operations and entries for switches, as they came
        self._plans: List[tuple] = []
        self._connects = 0
        self.change()

    # -- what a test plays ---------------------------------------------------------------------------

    def at(self, seconds: float, what: Callable[[], None]) -> None:
        """Plan an event."""
        self._plans.append((seconds, what))

    def change(self, **fields: Any) -> None:
        """Change the zone."""
        self._set(self.zone._replace(**fields))

    def ask(self, number: int, text: str = "", *fields: Field) -> None:
        """A manual operation is asked for, or over."""
        self._set(asked(self.zone, number, text, *fields))

    def _set(self, new: ZoneSeen) -> None:
        new = self._with_off(new)
        schedule = {event.id: EventSeen(
            event.id, number, new.zone, event.code, event.name, event.team, event.round, event.run, event.scheduled,
            event.scheduled, "next", event == new.event, signed_utc_s=UTC0 if event.id in self.signed else None)
            for number, event in enumerate(self.events, 1)}
        self.true_box = self.true_box._replace(zones={new.zone: new}, schedule=schedule)
        if not self.time:
            self.box = self.true_box  # the link was open before

    def at_event(self, name: str) -> None:
        """The zone is at the event of that id."""
        self.change(event=next(event for event in self.events if event.id == name))

    def end(self, reason: str) -> None:
        """End the run."""
        self.change(phase=ENDED, end_reason=reason)

    def die(self) -> None:
        """The core's process is gone."""
        self.silent = self.dead = True

    def restart(self, **fields: Any) -> None:
        """The core is started again; without `fields` its zone has no run any more."""
        self.silent = self.dead = False
        self.true_box = self.true_box._replace(box=self.true_box.box._replace(uuid=self.true_box.box.uuid + "'"))
        self.change(**(fields or {**NO_RUN, "event": EVENTS[0]}))

    def block(self, command: str, *reasons: str) -> None:
        """Reasons why a command is off, beside its own; none: it is free again."""
        self.extra_off = {**self.extra_off, command: list(reasons)}
        self.change()

    @property
    def zone(self) -> ZoneSeen:
        """The zone as the core has it now."""
        return self.true_box.zones["Home A"]

    def connect(self) -> None:
        """Somebody connects a robot; each run has another identity."""
        self._connects += 1
        self.change(phase=CONNECTED, identity=f"run {self._connects}", robot=ROBOT, items=ITEMS, end_reason="")

    # -- what a Link does ----------------------------------------------------------------------------

    def here_s(self) -> float:
        """Simulated seconds."""
        return self.time

    def now(self) -> Now:
        """The box's clocks."""
        return NOW.later(self.time)

    @property
    def silence_s(self) -> float:
        """For how long nothing was heard."""
        return self.time - self.heard

    @property
    def is_old(self) -> bool:
        """Whether that is too long."""
        return self.silence_s > SILENT_S

    def next(self, limit_s: float) -> None:
        """Wait for news, or for so long."""
        deadline = self.time + limit_s
        while self.time < deadline and self._is_known():
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
        self._hear()

    def _is_known(self) -> bool:
        return self.silent or self.box is self.true_box

    def _hear(self) -> None:
        if not self.silent:
            self.box = self.true_box

    def settle(self) -> None:
        """What was answered is in the document."""
        self._hear()

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
        if self.zone.off(action):
            raise Refused([*self.zone.off(action)])
        if self.zone.action(action).question and not (given or {}).get("again"):
            raise Refused([str(self.zone.action(action).question)])
        {
            "connect": self.connect,
            "start": lambda: self.change(phase=RUNNING),
            "stop": lambda: self.end("stopped"),
            "disconnect": lambda: self.change(**NO_RUN),
            "choose_event": lambda: self.at_event(given["event"]),
        }[action]()
        if given and "robot" in given:
            self.change(robot=ROBOT._replace(robot=given["robot"]))

    def run_sheet(self, name: str, identity: str, event: str) -> RunSheet:
        """The empty sheet of an event."""
        assert (name, identity) == (self.zone.zone, "")
        return RunSheet(RunLine("", 0, name, "HGTKMH", "TestingTeam", 1, 1, 0.0), (), 0.0, self.sheets[event], (), ())

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
        now = next(i for i in self.zone.items if i.desc == item.desc)
        value = now.value + int(entered.added) if entered.added else entered.value
        self.scores[item.desc] = value
        self.change(items=tuple(i._replace(value=value) if i.desc == item.desc else i for i in self.zone.items))

    def _enter(self, action: str, given: dict) -> None:
        """What a benchmarking module asked for. As in the core, the number of an operation must be right."""
        self._give(action, *given.values())
        if action == "operation":
            if not self.zone.operation or self.zone.operation != given["operation"]:
                raise Refused(["that manual operation is over"])
            self.ask(0)
        elif action == "confirm_switches":
            self.change(switches=None)

    def _give(self, *what: object) -> None:
        answer = (self.answers.get(what[0]) or [None]).pop(0)
        if answer is not None:
            raise answer
        self.given.append(what)

    def _with_off(self, fresh: ZoneSeen) -> ZoneSeen:
        idle = fresh.phase == IDLE
        own = {
            "connect": [] if idle else ["Already connected"],
            "start": [] if fresh.phase in (CONNECTED, ENDED) else ["Not now"],
            "stop": ["No run"] if idle else [],
            "disconnect": ["No run"] if idle else [],
            "choose_event": [] if idle else ["A run is connected"],
        }
        off = off_as({name: [*own.get(name, ["Not in this test"]), *self.extra_off.get(name, [])] for name in ACTIONS})
        if idle and self.signed_off:
            off["connect"] = off["connect"]._replace(question="Signed off")
        return fresh._replace(actions={**off, "operation": fresh.actions["operation"]})
