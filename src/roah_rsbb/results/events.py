"""What happened in a run: the journal's entries as lines of text, grouped by subject, and the goals of the robots."""

import json
from typing import Any, Callable, Dict, Iterator, List, NamedTuple, Optional, Tuple

from roah_rsbb.journal.reader import JournalEntry
from roah_rsbb.journal.records import Kind
from roah_rsbb.model import run_log
from roah_rsbb.protocol import RobotState
from roah_rsbb.results.runs import RunResult
from roah_rsbb.wording.texts import value_text


class SectionLine(NamedTuple):
    """One line of a section."""

    utc: float  # seconds
    who: str  # empty: the box
    robot: str  # empty if the run has only one robot
    text: str
    kind: str  # of the journal's entry
    port: Optional[int]  # of the robot; None: all robots of the run, or none
    bad: bool = False  # refused, or a warning


class Section(NamedTuple):
    """All events on one subject, in order."""

    title: str
    events: Tuple[SectionLine, ...]


class Stretch(NamedTuple):
    """A state with its duration."""

    begin_utc: float
    end_utc: float
    name: str


def sections(result: RunResult) -> List[Section]:
    """Return all sections that are not empty, without the scores, which stand on the sheet."""
    found: Dict[str, List[SectionLine]] = {title: [] for title in TITLES}
    for title, event in in_order(result):
        found[title].append(event)
    return [Section(title, tuple(shown)) for title, shown in found.items() if shown and title != SCORES]


def in_order(result: RunResult) -> Iterator[Tuple[str, SectionLine]]:
    """Return all events in their order, each with the title of its section."""
    memory = _Memory()
    for entry in result.entries:
        known = _WORDINGS.get(entry.kind)
        if known is None:
            if entry.kind not in _NOT_SHOWN:
                yield _OTHER, _run_event(result, entry, f"{entry.kind}: {value_text(entry.value)}")
            continue
        title, wording = known
        if entry.kind == Kind.COMMAND and _dict(entry.value).get("command") == "note":
            title = _NOTES
        text = wording(memory, entry)
        if text:
            yield title, _run_event(result, entry, text)


def box_states(result: RunResult, port: int, end_utc: float) -> List[Stretch]:
    """The states that the box sent to a robot. The last one ends at `end_utc`."""
    changes = [(e.utc, value_text(e.value)) for e in result.entries if e.kind == run_log.STATE_NAME and e.port == port]
    return _stretches(changes, end_utc)


def robot_states(result: RunResult, port: int, end_utc: float) -> List[Stretch]:
    """The states that a robot reported. The last one ends at `end_utc`."""
    changes = [(e.utc, _robot_state(e.value)) for e in result.entries
               if e.kind == run_log.CLIENT_STATE and e.port == port]
    return _stretches(changes, end_utc)


def _stretches(changes: List[Tuple[float, str]], end_utc: float) -> List[Stretch]:
    found: List[Stretch] = []
    for i, (utc, name) in enumerate(changes):
        if found and found[-1].name == name:
            utc = found.pop().begin_utc
        end = changes[i + 1][0] if i + 1 < len(changes) else max(utc, end_utc)
        found.append(Stretch(utc, end, name))
    return found


def _run_event(result: RunResult, entry: JournalEntry, text: str) -> SectionLine:
    bad = entry.kind == Kind.NOTICE or (entry.kind in COMMANDS and "refused" in _dict(entry.value))
    return SectionLine(entry.utc, entry.who, result.robot_at(entry.port), text, entry.kind, entry.port, bad)


_ROBOT_STATES = {state.value: state.name for state in RobotState}


def _robot_state(value: object) -> str:
    return _ROBOT_STATES[value] if value.__class__ is int and value in _ROBOT_STATES else value_text(value)


def _dict(value: object) -> Dict[str, object]:
    return value if isinstance(value, dict) else {}


class _Memory:
    """The latest states by port, which the texts of later entries need."""

    def __init__(self) -> None:
        self.state: Dict[Optional[int], str] = {}
        self.robot: Dict[Optional[int], str] = {}
        self.score: object = None  # the last one, with its time


# Makes the text of an entry; empty if it says nothing new.
_Wording = Callable[[_Memory, JournalEntry], str]


def _state_name(memory: _Memory, entry: JournalEntry) -> str:
    memory.state[entry.port] = value_text(entry.value)
    return ""


def _state_desc(memory: _Memory, entry: JournalEntry) -> str:
    return f"Box: {memory.state.get(entry.port, '')}: {value_text(entry.value)}"


def _client_state(memory: _Memory, entry: JournalEntry) -> str:
    name = _robot_state(entry.value)
    if memory.robot.get(entry.port) == name:
        return ""
    memory.robot[entry.port] = name
    return f"Robot: {name}"


def _as_it_is(_memory: _Memory, entry: JournalEntry) -> str:
    return value_text(entry.value)


def _saying(word: str) -> _Wording:
    """Return the wording: a word, a colon and the value."""
    return lambda _memory, entry: f"{word}: {value_text(entry.value)}"


def _only(text: str) -> _Wording:
    """Return the wording: a fixed text."""
    return lambda _memory, _entry: text


def _goal(_memory: _Memory, entry: JournalEntry) -> str:
    return "Goal: " + "; ".join(_goal_parts(entry.value))


def _command(_memory: _Memory, entry: JournalEntry) -> str:
    command = dict(_dict(entry.value))
    name = value_text(command.pop("command", "?"))
    refused = command.pop("refused", None)
    desc, group = command.pop("desc", None), command.pop("group", None)
    words = [name if desc is None else f"{name}: {value_text(desc)}",  # what was marked comes first: lists cut the text
             *(f"{key}: {value_text(value)}" for key, value in command.items()),
             *([] if group is None else [f"group: {value_text(group)}"])]
    if refused is not None:
        reasons = refused if isinstance(refused, list) else [refused]
        words.append("REFUSED: " + "; ".join(value_text(reason) for reason in reasons))
    return "; ".join(words)


def _notice(_memory: _Memory, entry: JournalEntry) -> str:
    notice = _dict(entry.value)
    return f"{value_text(notice.get('level', ''))}: {value_text(notice.get('text', ''))}"


def _score(memory: _Memory, entry: JournalEntry) -> str:
    """Word a score once: in a run of several robots, each robot's log has the same scores."""
    score = entry.utc, entry.value
    if score == memory.score:
        return ""
    memory.score = score
    group, item, *values = entry.value if isinstance(entry.value, list) else ("", value_text(entry.value))
    return ": ".join(value_text(part) for part in (group, item, *values))


def _goal_value(value: object) -> Optional[Dict[str, Any]]:
    """Return a goal as the journal has it, as JSON or as its text; None: it is something else."""
    try:
        goal = json.loads(value) if isinstance(value, str) else value
    except ValueError:
        return None
    return goal if isinstance(goal, dict) else None


def _goal_parts(value: object) -> Iterator[str]:
    """Name the parts of a goal (`core/modules.py`) that are set."""
    goal = _goal_value(value)
    if goal is None:
        yield value_text(value)
        return
    if goal.get("text"):
        yield value_text(goal["text"])
    for key in ("goal", "pose", "initial_state", "switches"):
        if goal.get(key):
            yield f"{key.replace('_', ' ')}: {value_text(goal[key])}"
    if goal.get("timeout"):
        yield f"{value_text(goal['timeout'])} s"


_STATES = "Timeline of states"
_GOALS = "Goals and results"
_OPERATIONS = "Manual operations"
_COMMANDS = "Referee's commands"
_NOTES = "Notes"
_JUDGES = "Judges"
_OBJECTIONS = "Objections"
_ONLINE_DATA = "Online data"
_DEVICES = "Home devices and tablet"
_WARNINGS = "Warnings"
_OTHER = "Other"
SCORES = "Scores"
TITLES = (
    _STATES, _GOALS, _OPERATIONS, SCORES, _NOTES, _COMMANDS, _JUDGES, _OBJECTIONS, _ONLINE_DATA, _DEVICES, _WARNINGS,
    _OTHER,
)

_WORDINGS: Dict[str, Tuple[str, _Wording]] = {
    run_log.STATE_NAME: (_STATES, _state_name),
    run_log.STATE_DESC: (_STATES, _state_desc),
    run_log.CLIENT_STATE: (_STATES, _client_state),
    Kind.ADDRESS: (_STATES, _saying("Robot's address")),
    Kind.TIMEOUT: (_STATES, _only("Timeout")),
    run_log.END: (_STATES, _only("Disconnected")),
    run_log.GOAL: (_GOALS, _goal),
    run_log.RESULT: (_GOALS, _saying("Result")),
    run_log.MANUAL_OPERATION: (_OPERATIONS, _as_it_is),
    run_log.SWITCHES: (_OPERATIONS, _saying("Switches")),
    Kind.COMMAND: (_COMMANDS, _command),
    Kind.JUDGING: (_JUDGES, _command),
    Kind.PUBLICATION: (_OBJECTIONS, _command),
    run_log.NOTIFICATION: (_ONLINE_DATA, _saying("notification")),
    run_log.ACTIVATION_EVENT: (_ONLINE_DATA, _saying("activation event")),
    run_log.VISITOR: (_ONLINE_DATA, _saying("visitor")),
    run_log.COMMAND: (_ONLINE_DATA, _saying("final command")),
    run_log.DISPLAY_MAP: (_DEVICES, _saying("display_map")),
    **{run_log.device_topic(device): (_DEVICES, _saying(device)) for device in run_log.DEVICES},
    Kind.NOTICE: (_WARNINGS, _notice),
    run_log.SCORE: (SCORES, _score),
    run_log.MODULE_SCORE: (SCORES, _only("Score of the benchmarking module changed")),
}
# Kinds of entries that are commands of people.
COMMANDS = frozenset((Kind.COMMAND, Kind.JUDGING, Kind.PUBLICATION))
# Entries that repeat others, or that the score sheet shows. The marks of judges are shown when they submit.
_NOT_SHOWN = frozenset((
    run_log.STATE, run_log.BOX_STATE, run_log.BOX_PAYLOAD, run_log.CLIENT_PAYLOAD, run_log.SCORE_TEXT, Kind.JUDGE_MARK,
    run_log.HOPF_RESULT, run_log.OMF_BUTTON, run_log.OMF_DAMAGED, run_log.OMF_COMPLETE,
))


# -- goals ------------------------------------------------------------------------------------------


# The box's states that end a goal on which the robot works.
_ENDS = ("PREPARE", "STOP")
_WORKING = "WAITING_RESULT"


class SentGoal(NamedTuple):
    """A goal that the box sent, such as a waypoint."""

    number: int  # 1, 2, … within the run
    port: Optional[int]  # of the robot
    text: str
    timeout_s: Optional[float]
    utc: float  # when it was given, UTC seconds
    # From the robot's begin to its end, which the box took, or the timeout; None: it did not end.
    seconds: Optional[float] = None
    result: str = ""  # as the robot reported it


def goals(result: RunResult) -> List[SentGoal]:
    """Return the goals of a run in their order."""
    found: List[SentGoal] = []
    current: Dict[Optional[int], int] = {}  # places in `found` by port
    begun: Dict[int, JournalEntry] = {}  # by place
    for entry in result.entries:
        if entry.kind == run_log.GOAL:
            _end(found, begun, current.get(entry.port), entry)  # the next goal ends the one before
            current[entry.port] = len(found)
            found.append(_sent(len(found) + 1, entry.port, entry.value, entry.utc))
        place = current.get(entry.port)
        if place is None:
            continue
        if entry.kind == run_log.RESULT:
            found[place] = found[place]._replace(result=value_text(entry.value))
        elif entry.kind == run_log.STATE_NAME and entry.value == _WORKING:
            begun.setdefault(place, entry)
        elif entry.kind == run_log.STATE_NAME and entry.value in _ENDS:
            _end(found, begun, place, entry)
    return found


def _end(found: List[SentGoal], begun: Dict[int, JournalEntry], place: Optional[int], end: JournalEntry) -> None:
    """End a goal on which the robot works."""
    if place in begun and found[place].seconds is None:
        begin = begun[place]
        # UTC may have been set in between. The monotonic clocks of two starts of the core may have nothing in common.
        seconds = end.mono - begin.mono if end.session == begin.session else end.utc - begin.utc
        found[place] = found[place]._replace(seconds=seconds)


def _sent(number: int, port: Optional[int], value: object, utc: float) -> SentGoal:
    parts = _goal_value(value)
    if parts is None:
        return SentGoal(number, port, value_text(value), None, utc)
    timeout = parts.get("timeout")
    is_number = isinstance(timeout, (int, float)) and timeout > 0
    return SentGoal(number, port, value_text(parts.get("text") or ""), float(timeout) if is_number else None, utc)
