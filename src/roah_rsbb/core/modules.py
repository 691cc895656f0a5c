"""The box's side of benchmarking modules: which of their nodes are present, what they request, and texts of it.

A node of modules sends the list of its benchmarks twice a second. It is missing after `GONE_S` without a message, or
after a message with an empty list, which it sends at its end. If two nodes drive the same benchmark, the first keeps
it.

A module requests a goal for the robot, manual operations, and switches to enter. Here are plain records of requests and
their outcomes; the run decides what follows. Goals, results and scores become texts for the run log, and modules get
results in one form.
"""

import json
from dataclasses import dataclass, field
from typing import Dict, List, NamedTuple, Optional, Tuple

from roah_rsbb.core.runs.times import Countdown, CountdownState
from roah_rsbb.model.clock import Now
from roah_rsbb.model.messages import GoalMessage, RobotReport
from roah_rsbb.model.modules import ModuleInfo, ModulesState, Progress, Request
from roah_rsbb.model.reason import Refused, say
from roah_rsbb.model.records import ScoreValue

# Seconds: four messages in a row are missing.
GONE_S = 2.0
# No competition has more nodes. The limit keeps a fault from growing.
MAX_NODES = 32
NO_DRIVER = say("Benchmarking module not connected: nothing drives {code}. Start the box with modules:=true, and see "
                "its log: the rules may be damaged")


class _HeardNode(NamedTuple):
    state: ModulesState
    mono: float


class Driver(NamedTuple):
    """The node that drives a benchmark."""

    node: str  # identity of the process
    info: ModuleInfo


class Modules:
    """All nodes of benchmarking modules that were heard."""

    def __init__(self) -> None:
        self._heard: Dict[str, _HeardNode] = {}

    def hear(self, now: Now, state: ModulesState) -> None:
        """Take a node's message. An empty list of benchmarks means that the node has ended."""
        if not state.modules:
            self._heard.pop(state.node, None)
            return
        if state.node not in self._heard:
            self.forget_gone(now)
            if len(self._heard) >= MAX_NODES:
                return
        self._heard[state.node] = _HeardNode(state, now.mono)

    def is_repetition(self, now: Now, state: ModulesState) -> bool:
        """Whether a node that is present says only what it said before."""
        heard = self._heard.get(state.node)
        return heard is not None and heard.state == state and now.mono < heard.mono + GONE_S

    def forget_gone(self, now: Now) -> None:
        """Forget the nodes that have been silent for too long. A node that comes back is the last in the order."""
        self._heard = {node: heard for node, heard in self._heard.items() if now.mono < heard.mono + GONE_S}

    def deadline(self) -> Optional[float]:
        """Monotonic time (s) at which the next node counts as missing unless a message comes first; None: no nodes."""
        return min((heard.mono + GONE_S for heard in self._heard.values()), default=None)

    def driver(self, now: Now, code: str, zone: str) -> Optional[Driver]:
        """Return the driver of the benchmark `code` in a zone; None: it has no driver."""
        return next(iter(self._drivers(now, code, zone)), None)

    def progress(self, node: str) -> Dict[str, Progress]:
        """Return a node's last progress in each run, by the run's identity."""
        heard = self._heard.get(node)
        return {} if heard is None else {progress.run: progress for progress in heard.state.progress}

    def start_off(self, now: Now, code: str, zone: str) -> List[str]:
        """Return why no run of a functionality benchmark can be started in a zone; empty: one can."""
        driver = self.driver(now, code, zone)
        if driver is None:
            return [NO_DRIVER(code=code)]
        return list(driver.info.problems)

    def warnings(self, now: Now, code: str, zone: str) -> List[str]:
        """Return the warnings about the module of a benchmark for the referee of a zone."""
        drivers = self._drivers(now, code, zone)
        found = list(drivers[0].info.warnings) if drivers else []
        if len(drivers) > 1:
            found.append(f"{len(drivers)} nodes drive {code}: end all but one. The first one counts")
        return found

    def _drivers(self, now: Now, code: str, zone: str) -> List[Driver]:
        drivers = []
        for node, heard in self._heard.items():
            infos = [info for info in heard.state.modules if info.benchmark == code and info.zone in ("", zone)]
            if infos and now.mono < heard.mono + GONE_S:
                drivers.append(Driver(node, next((info for info in infos if info.zone), infos[0])))
        return drivers


# Characters of a result. It is kept with every step and repeated to the modules. Modules refuse longer results
# (`roah_rsbb.bmbox.framework.results`), so a result that is cut here is refused there.
MAX_RESULT = 4000


class _ObjectField(NamedTuple):
    name: str  # in a RobotReport of 2015
    key: str  # in the YAML of 2019


_OBJECT_FIELDS = (
    _ObjectField("object_class", "class"), _ObjectField("object_name", "instance"),
    _ObjectField("object_pose_x", "x"), _ObjectField("object_pose_y", "y"), _ObjectField("object_pose_theta", "theta"),
)


def result_text(report: RobotReport) -> str:
    """Return a robot's result as YAML, whichever form it came in (docs/protocol.md, "Goals and results").

    It is cut at `MAX_RESULT`. Empty: the report has no result.
    """
    if report.generic_result is not None:
        return report.generic_result[:MAX_RESULT]
    given = {f.key: getattr(report, f.name) for f in _OBJECT_FIELDS if getattr(report, f.name) is not None}
    return json.dumps(given, ensure_ascii=False)[:MAX_RESULT] if given else ""


def goal_json(request: Request) -> str:
    """A goal for the run log."""
    return json.dumps({
        "number": request.number, "text": request.text, "goal": request.goal, "pose": request.pose,
        "initial_state": request.initial_state, "switches": request.switches, "timeout": request.timeout,
    }, ensure_ascii=False)


def scores_json(scores: Tuple[ScoreValue, ...]) -> str:
    """A module's score for the run log; values keep their types."""
    return json.dumps([
        {"group": s.group, "name": s.name, "value": _value(s.value), "unit": s.unit, "desc": s.desc} for s in scores
    ], ensure_ascii=False)


def _value(text: str) -> object:
    try:
        return json.loads(text)
    except ValueError:
        return text


# Bytes for the rest of a datagram that carries a goal: frame, cipher, code, state, acknowledgement, a pose.
GOAL_OVERHEAD = 140
# No referee makes more changes. Something is lying on the keyboard.
MAX_CHANGES = 1000


@dataclass
class GoalState:
    """The progress of a goal."""

    clock: CountdownState = field(default_factory=CountdownState)
    told: Optional[Now] = None  # when the robot was first asked to execute


class RunningGoal:
    """A goal under way."""

    def __init__(self, request: Request, state: Optional[GoalState] = None) -> None:
        self.state = state or GoalState()
        self.request = request
        self.message = GoalMessage(request.goal, request.pose, request.initial_state, request.switches)
        self.clock = Countdown(request.timeout or float("inf"), self.state.clock)

    def start(self, now: Now) -> None:
        """Start the countdown if the goal has a timeout."""
        if self.request.timeout:
            self.clock.start(now)

    def executing_s(self, mono: float) -> float:
        """Return for how many seconds the robot has been executing the goal at `mono` (s); 0.0: not yet."""
        told = self.state.told
        return 0.0 if told is None else max(0.0, mono - told.mono)


@dataclass
class SwitchesState:
    """The referee's entries."""

    initial_state: Tuple[bool, ...]
    changed: List[int] = field(default_factory=list)
    damaged: int = 0


class NumberedSwitches:
    """The switches as the referee sees them, numbered from 1."""

    def __init__(self, state: SwitchesState) -> None:
        self.state = state

    @property
    def changed(self) -> List[int]:
        """The switches that changed, in order. A switch that changed twice occurs twice."""
        return self.state.changed

    @property
    def damaged(self) -> int:
        """How many switches were damaged."""
        return self.state.damaged

    def press(self, switch: int) -> None:
        """Note that the referee saw a switch change. Raises `Refused`."""
        count = len(self.state.initial_state)
        if not 1 <= switch <= count:
            raise Refused([say("there is no switch {switch}: they are numbered 1 to {count}")(
                switch=switch, count=count)])
        if len(self.changed) >= MAX_CHANGES:
            raise Refused([say("no more than {most} changes of switches can be entered")(most=MAX_CHANGES)])
        self.changed.append(switch)

    @property
    def on(self) -> Tuple[int, ...]:
        """The switches that are on now."""
        states = enumerate(self.state.initial_state, 1)
        return tuple(number for number, on in states if on ^ (self.changed.count(number) % 2 == 1))
