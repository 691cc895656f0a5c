"""What a person may do to the box, as its faces know it: one entry for each action.

Terminal, panels, phones, documentation and the original services are made from this table. What an action does, and
when it is off, is in `core/actions/`. docs/architecture.md, "Add an action", is a walk through all that a new one
needs.
"""

import enum
from dataclasses import dataclass
from typing import Dict, List, NamedTuple, Optional, Sequence, Tuple

from roah_rsbb.model.fields import Confirmed, EventId, Field, Fixed, Number, OfSchedule, Robot, Team, Toggle, TypedText
from roah_rsbb.model.reason import Reason, Said, Template, say

# Roles of persons, which paired devices have: what each may do is `Action.roles`, and `STOPS` and `READS` below.
REFEREE, ASSISTANT, JUDGE, TIMEKEEPER, OBSERVER, ORGANISER = ROLES = (
    "referee", "assistant", "judge", "timekeeper", "observer", "organiser")
REFEREES, JUDGES = (REFEREE, ORGANISER), (JUDGE,)
# Who marks and notes, whoever starts; who starts and has the clock.
MARKERS, KEEPERS = (*REFEREES, ASSISTANT), (*REFEREES, TIMEKEEPER)
NOTERS = (*MARKERS, TIMEKEEPER)
# Who may stop a run; who sees the marks of all.
STOPS, READS = NOTERS, (*NOTERS, OBSERVER)


class Row(enum.Enum):
    """Where a face shows an action for which it has no place of its own."""

    CLOCK = "clock"  # beside the clock of the run
    MORE = "more"  # in a menu
    MODULE = "module"  # with what a benchmarking module asks of the referee


@dataclass(frozen=True)
class Action:
    """An action.

    `name`: in the journal, in calls and in JSON. `what`: what an answer is about, with the place {zone}; None: the
    label says it. `question`: asked before it is done, with the place {team}. `careful`: a phone asks for a second
    press. `leaves`: it leaves the run, so whoever does it must know that a robot of the run did not answer STOP
    (`wording.stop.leaving`). `aims`: it is meant for the event that is shown, and refused at another one.
    `is_original`: the original box has it as a service, whose name and type are fixed. `durable`: its answer waits
    until it is on the disk. `roles`: of devices that may do it. `is_open`: its form changes, and has other fields than
    here: only the core can read their values.
    """

    name: str
    label: Template
    explanation: Template
    fields: Tuple[Field, ...] = ()
    what: Optional[Template] = None
    question: Optional[Template] = None
    careful: bool = False
    leaves: bool = False
    aims: bool = False
    is_original: bool = False
    row: Row = Row.MORE
    durable: bool = False
    roles: Tuple[str, ...] = REFEREES
    is_open: bool = False

    @property
    def words(self) -> str:
        """The name as it is typed in a terminal."""
        return self.name.replace("_", "-")


_TEAM, _EVENT = say("Team"), say("Event")
_JUDGE, _NOTE, _REASON, _TEXT = say("Judge"), say("Note"), say("Reason"), say("Text")
# An event that is signed off has its result: whoever begins there again says so.
AGAIN = Confirmed("again", say("Another attempt at an event that is signed off"), required=False)
_NUMBER, _DEVICE, _ID, _ROLE = say("Number"), say("Device"), say("Id of the mark"), say("Role")
# Characters of a captain's signature, in whole units of a field of 400 times 150.
MAX_DRAWING = 4000
# `uint8` on the ROS interface.
MAX_DAMAGED = 255
# A time for objections that is left to the benchmarks file.
BY_THE_FILE_S = -1

_ALL = (
    Action("connect", say("Connect"), say("Open the private channel to the team's robot"),
           (Robot("robot", say("Robot"), required=False), AGAIN), is_original=True, what=say("Connect in {zone}")),
    Action("disconnect", say("Disconnect"), say("Leave the run and close the channel"),
           (Toggle("running", say("Also a run in progress"), required=False),),
           careful=True, leaves=True, is_original=True, what=say("Disconnect in {zone}")),
    Action("start", say("▶ START"), say("Start the run, also after a stop"), is_original=True,
           what=say("Start in {zone}"), roles=KEEPERS),
    Action("stop", say("■ STOP"), say("Stop the run. It stays connected"),
           (TypedText("reason", say("Reason for the stop"), required=False, cut=True),), is_original=True,
           roles=STOPS),
    Action("previous", say("◀ Previous"), say("Go to the zone's previous event"), careful=True, is_original=True,
           what=say("Previous in {zone}")),
    Action("next", say("Next ▶"), say("Go to the zone's next event"), careful=True, is_original=True,
           what=say("Next in {zone}")),
    Action("previous_phase", say("◀ Phase"), say("Go back to the phase before; its time continues"), row=Row.CLOCK,
           what=say("Previous phase in {zone}"), roles=KEEPERS),
    Action("next_phase", say("Next phase ▶"), say("Go to the next phase"), row=Row.CLOCK,
           what=say("Next phase in {zone}"), roles=KEEPERS),
    Action("continue", say("▶ Not stopped: continue"),
           say("After a restart: the run was not stopped. The robot prepares again, and may move"),
           question=say("Was the run of team {team} not stopped? Its robot prepares again, and may move."),
           careful=True, row=Row.CLOCK, what=say("Continue in {zone}")),
    Action("pause", say("‖ Pause"), say("Stop the clock of the run. The robot does not notice"), row=Row.CLOCK,
           what=say("Pause in {zone}"), roles=KEEPERS),
    Action("resume", say("▶ Resume clock"), say("Let the clock of the run continue"), row=Row.CLOCK,
           what=say("Resume in {zone}"), roles=KEEPERS),
    Action("open_sheet", say("Score without a robot"),
           say("Start and stop the clock yourself. Nothing is sent to a robot"),
           (Team("team", _TEAM, required=False), AGAIN), careful=True, aims=True, what=say("Score sheet in {zone}")),
    Action("no_show", say("No-show"), say("The team did not appear. Leave this event"),
           (Team("team", _TEAM), AGAIN),
           question=say("Did team {team} not appear? The zone leaves this event."), careful=True, aims=True,
           what=say("No-show in {zone}")),
    Action("withdrawn", say("Team withdrew"), say("The team withdrew. Leave this event"),
           (Team("team", _TEAM), AGAIN),
           question=say("Did team {team} withdraw? The zone leaves this event."), careful=True, leaves=True, aims=True,
           what=say("Withdrawal in {zone}")),
    Action("choose_event", say("Choose the event"), say("Go to this event of the zone's schedule"),
           (EventId("event", _EVENT), Team("team", _TEAM, required=False),
            Toggle("unsigned", say("Also leave a run that is not signed off"), required=False)), leaves=True),
    Action("operation", say("Manual operation complete"),
           say("Of a benchmarking module, whose form is filled in; without a number: the current one"),
           (Fixed("operation", _NUMBER, required=False), TypedText("answer", say("Answer"), required=False)),
           row=Row.MODULE, is_open=True),
    Action("switch", say("A switch changed"), say("Toggle the mark of a switch, counted from 1"),
           (Number("number", _NUMBER, low=1),), row=Row.MODULE),
    Action("damaged", say("Damaged switches"), say("Set how many switches were damaged"),
           (Number("number", _NUMBER, high=MAX_DAMAGED),), row=Row.MODULE),
    Action("confirm_switches", say("Confirm the switches"), say("All switches that the robot changed are entered"),
           row=Row.MODULE),
)
# All actions in a zone, in the order in which faces have them.
ACTIONS: Dict[str, Action] = {action.name: action for action in _ALL}
# What is entered for one run, in progress or over. Faces lay it out by hand, beside what it is about.
_VALUE = (TypedText("group", say("Group")), TypedText("desc", say("Item")),
          Number("value", say("Value"), required=False, low=-2**31), TypedText("text", _TEXT, required=False),
          Toggle("not_attempted", say("Not attempted"), required=False))
# Of what waited for a link to the box: how long ago it was made.
_AGO = Number("ago_ms", say("Made so long ago"), required=False, unit="ms")
# A mark is sent again until the box has it; with an `id` it is applied once.
_MARK = (*_VALUE, TypedText("added", say("What to add"), required=False), Field("judge", _JUDGE, required=False),
         TypedText("note", _NOTE, required=False), Field("id", _ID, required=False),
         Field("device", _DEVICE, required=False))
_ENTRIES = (
    Action("mark", say("Mark an item"), say("Set an item of the score sheet, or add to it"),
           (*_MARK, _AGO, Field("role", _ROLE, required=False)), durable=True, roles=(*MARKERS, *JUDGES)),
    Action("judge_mark", say("Mark an item of a judge"), say("On the judge's own sheet"), _MARK, durable=True,
           roles=JUDGES),
    Action("withdraw", say("Withdraw the entry"), say("The entry of the score sheet no longer counts; others stay"),
           (Number("entry", _NUMBER, low=1), TypedText("note", _NOTE, required=False)), durable=True),
    Action("in_time", say("It was in time"),
           say("What an entry marks was seen before the time limit, so it counts; it was entered later"),
           (Number("entry", _NUMBER, low=1), Toggle("late", say("No, it was late"), required=False)), durable=True),
    Action("take_back", say("Take back the mark"), say("A mark that set an item no longer counts"),
           (Field("id", _ID), TypedText("note", _NOTE, required=False), _AGO), durable=True, roles=MARKERS),
    Action("note", say("Note this moment"),
           say("With the clock of the run. Its text can be entered later: name the note by its number or its id"),
           (TypedText("text", _TEXT, required=False), Number("number", _NUMBER, required=False),
            Field("id", say("Id of the note"), required=False), Field("device", _DEVICE, required=False),
            Field("role", _ROLE, required=False), _AGO), durable=True, roles=NOTERS),
    Action("captain", say("Captain's signature"),
           say("The captain read the score sheet of a run that is over, and signs it or refuses, with the reason"),
           (TypedText("name", say("Name of the captain")), TypedText("comment", say("Comment"), required=False),
            TypedText("drawing", say("Signature"), required=False, characters=MAX_DRAWING),
            Toggle("refused", say("Refuses to sign"), required=False)), durable=True),
    Action("decide", say("Decide on a late mark"),
           say("It was made before the sign-off and arrived after it. If it is accepted, you sign the new sheet"),
           (Number("number", _NUMBER, low=1), Toggle("accept", say("Accept it"), required=False),
            TypedText("reason", _REASON, required=False)), durable=True),
    Action("annul", say("Annul the run"),
           say("It is kept and shown, counts nothing, and gives its attempt back"),
           (TypedText("reason", _REASON),), durable=True),
    Action("move", say("Move the run"),
           say("To the right event of the same benchmark: of another team, round or time"),
           (EventId("event", _EVENT), TypedText("reason", _REASON)), durable=True),
    Action("reopen", say("Reopen the sheet"),
           say("A signed sheet can be corrected again. It is kept; the next sign-off makes a new version"),
           (TypedText("reason", _REASON),), durable=True),
    Action("undo", say("Take it back"), say("The last of annulled, moved and reopened no longer holds for the run"),
           (TypedText("reason", _REASON),), durable=True),
    Action("stop_reason", say("Record why it ended"), say("Possible until the run is signed off"),
           (TypedText("reason", _REASON, required=False), Number("stop", _NUMBER, required=False)), durable=True),
    Action("sign_off", say("Sign off"), say("The score sheet of a run that is over becomes final"), durable=True),
    Action("submit", say("Submit the sheet"), say("The judge's own sheet is locked"),
           (Field("judge", _JUDGE), Field("device", _DEVICE, required=False)), durable=True, roles=JUDGES),
    Action("settle", say("Settle"), say("The head referee gives the item on which judges differ its value"),
           (*_VALUE, TypedText("reason", _REASON, required=False)), durable=True),
    Action("hand_back", say("Hand back: look again"), say("The judge looks again, and submits again"),
           (Field("judge", _JUDGE), TypedText("reason", _REASON, required=False)), durable=True),
    Action("withdraw_sheet", say("Withdraw the sheet"),
           say("The judge's sheet no longer counts; another can take its place"),
           (Field("judge", _JUDGE), TypedText("reason", _REASON, required=False)), durable=True),
    Action("waive", say("Do not wait for missing judges"), say("The run is scored with the sheets that are there"),
           (TypedText("reason", _REASON, required=False),), durable=True),
    Action("publish", say("Publish as provisional"),
           say("Objections are possible for some time; -1: as the benchmarks file says"),
           (Number("seconds", say("Time for objections"), required=False, low=BY_THE_FILE_S, unit="s",
                   default=BY_THE_FILE_S),), durable=True),
    Action("object", say("Enter an objection"),
           say("To a result, also a protest after the sign-off: as long as the rules allow it"),
           (TypedText("by", say("Who objects"), required=False), TypedText("text", _TEXT, required=False),
            Number("second", say("Second of the run that it is about"), required=False, unit="s")), durable=True),
    Action("answer", say("Answer the objection"),
           say("The sheet is corrected separately: one that is upheld reopens a signed sheet"),
           (Number("number", _NUMBER, low=1), Toggle("upheld", say("Upheld"), required=False),
            TypedText("text", _TEXT, required=False)), durable=True),
)
ENTRIES: Dict[str, Action] = {action.name: action for action in _ENTRIES}
EVERY: Dict[str, Action] = {**ACTIONS, **ENTRIES}
# What an organiser does to the schedule of the day: first shown, then done (`box/day_edits.py`).
_ZONE, _AN_EVENT = OfSchedule("zone", say("Zone"), of="zone"), OfSchedule("event", _EVENT, of="event")
_OTHER_ZONE = OfSchedule("zone", say("To zone"), required=False, of="zone")
_AT = TypedText("time", say("To time"), required=False)
_WHY = TypedText("reason", _REASON, required=False)
WITHDRAW_TEAM, ADVANCE, UNDO = "withdraw_team", "advance", "undo"
_EDITS = (
    Action("shift", say("A zone is late"),
           say("Shift the events of a zone that are to come today, by minutes such as 40, or so that the next one "
               "begins at a time such as 14:20"),
           (_ZONE, TypedText("time", say("Minutes, or time")), _WHY)),
    Action("swap", say("Swap two events"), say("Two events exchange their times and zones"),
           (_AN_EVENT, OfSchedule("other", say("Other event"), of="event"), _WHY)),
    Action("move", say("Move an event"),
           say("To a time such as 14:20, a day such as 2026-11-30, both, or another zone"),
           (_AN_EVENT, _AT, _OTHER_ZONE, _WHY)),
    Action("insert", say("Add an event"), say("A new event of a team, at a time such as 14:20"),
           (_ZONE, OfSchedule("benchmark", say("Benchmark"), of="benchmark"),
            OfSchedule("team", _TEAM, of="team"), TypedText("time", say("Time")), _WHY)),
    Action("remove", say("Remove an event"), say("It will not take place"), (_AN_EVENT, _WHY)),
    Action("repeat", say("Repeat an event"),
           say("The team gets the same event again, after the last one of the zone or at a time such as 14:20"),
           (_AN_EVENT, _AT, _OTHER_ZONE, _WHY)),
    Action(WITHDRAW_TEAM, say("A team withdraws"), say("From all events to come, those of a day, or one"),
           (OfSchedule("team", _TEAM, of="team"), OfSchedule("day", say("Only this day"), required=False, of="day"),
            OfSchedule("event", say("Only this event"), required=False, of="event"), _WHY)),
    Action("add_team", say("A late team"),
           say("With a password, and an event for each benchmark and round that other teams do from today on"),
           (TypedText("team", say("Name that its robot announces"), characters=100), _WHY)),
    Action(ADVANCE, say("Teams advance"),
           say("Those who advance from a stage, such as to the Final, take the places of its events, the best team "
               "last; with a time, its events begin there"),
           (TypedText("stage", say("Stage, if several have finalists"), required=False), _OTHER_ZONE, _AT,
            Number("minutes", say("Minutes from one to the next"), required=False, high=600, unit="min"), _WHY)),
    Action(UNDO, say("Undo"), say("Put the events of an edit back, if nobody changed them since"),
           (Number("number", _NUMBER, low=1), _WHY)),
)
EDITS: Dict[str, Action] = {action.name: action for action in _EDITS}


def allowed(role: str) -> List[str]:
    """Return the names of all actions that a role may do."""
    return [name for name, action in EVERY.items() if role in action.roles]


# STOP has a way of its own in every face and in the core, with nothing of this table in it.
STOP = "stop"
# What referees count and set on a score sheet, and judges on their own.
MARK, JUDGE_MARK = "mark", "judge_mark"
OBJECT = "object"  # which a team may do on its page, too


class Shown(NamedTuple):
    """An action in a zone."""

    off: Tuple[Said, ...] = ()  # the reasons why its button is off; empty: it is on
    shown: bool = True  # whether faces show it beside what they lay out themselves
    fields: Optional[Tuple[Field, ...]] = None  # as they are now; None: as in `ACTIONS`
    text: str = ""  # what the referee should do, in the words of a module; empty: the action's explanation says it
    question: Said = ""  # asked before it is done, which then gives `Confirmed`; empty: nothing but the action's own


# -- what a caller must confirm ---------------------------------------------------------------------

CONFIRM = say("{question}. For another attempt, press the button again and confirm")
UNSIGNED = say("The run of {code}, team {team}, round {round}, run {run} is not signed off: confirm to leave it")


def confirmed_by(reasons: Sequence[str], how: str) -> List[str]:
    """Return reasons with how a face without buttons begins another attempt."""
    return [f"{reason.values['question']}. {how}"
            if isinstance(reason, Reason) and reason.template == CONFIRM else reason for reason in reasons]
