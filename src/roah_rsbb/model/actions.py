"""What a person may do to the box, as its faces know it: one entry for each action.

Terminal, panels, phones, documentation and the original services are made from this table. What an action does, and
when it is off, is in `core/actions/`. docs/architecture.md, "Add an action", is a walk through all that a new one
needs.
"""

import enum
from dataclasses import dataclass
from typing import Dict, Optional, Tuple

from roah_rsbb.model.fields import Event, Field, Robot, Team, Text, Toggle
from roah_rsbb.model.reason import Template, say


class Row(enum.Enum):
    """Where a face shows an action for which it has no place of its own."""

    CLOCK = "clock"  # beside the clock of the run
    MORE = "more"  # in a menu


@dataclass(frozen=True)
class Action:
    """An action.

    `name`: in the journal, in calls and in JSON. `what`: what an answer is about, with the place {zone}; None: the
    label says it. `question`: asked before it is done, with the place {team}. `careful`: a phone asks for a second
    press. `leaves`: it leaves the run, so whoever does it must know that a robot of the run did not answer STOP
    (`wording.stop.leaving`). `aims`: it is meant for the event that is shown, and refused at another one.
    `is_original`: the original box has it as a service, whose name and type are fixed.
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

    @property
    def words(self) -> str:
        """The name as it is typed in a terminal."""
        return self.name.replace("_", "-")


_TEAM = say("Team")

_ALL = (
    Action("connect", say("Connect"), say("Open the private channel to the team's robot"),
           (Robot("robot", say("Robot"), required=False),), is_original=True, what=say("Connect in {zone}")),
    Action("disconnect", say("Disconnect"), say("Leave the run and close the channel"),
           (Toggle("running", say("Also a run in progress"), required=False),),
           careful=True, leaves=True, is_original=True, what=say("Disconnect in {zone}")),
    Action("start", say("▶ START"), say("Start the run, also after a stop"), is_original=True,
           what=say("Start in {zone}")),
    Action("stop", say("■ STOP"), say("Stop the run. It stays connected"),
           (Text("reason", say("Reason for the stop"), required=False, cut=True),), is_original=True),
    Action("previous", say("◀ Previous"), say("Go to the zone's previous event"), careful=True, is_original=True,
           what=say("Previous in {zone}")),
    Action("next", say("Next ▶"), say("Go to the zone's next event"), careful=True, is_original=True,
           what=say("Next in {zone}")),
    Action("previous_phase", say("◀ Phase"), say("Go back to the phase before; its time continues"), row=Row.CLOCK,
           what=say("Previous phase in {zone}")),
    Action("next_phase", say("Next phase ▶"), say("Go to the next phase"), row=Row.CLOCK,
           what=say("Next phase in {zone}")),
    Action("pause", say("‖ Pause"), say("Stop the clock of the run. The robot does not notice"), row=Row.CLOCK,
           what=say("Pause in {zone}")),
    Action("resume", say("▶ Resume clock"), say("Let the clock of the run continue"), row=Row.CLOCK,
           what=say("Resume in {zone}")),
    Action("open_sheet", say("Score without a robot"),
           say("Start and stop the clock yourself. Nothing is sent to a robot"),
           (Team("team", _TEAM, required=False),), careful=True, aims=True, what=say("Score sheet in {zone}")),
    Action("no_show", say("No-show"), say("The team did not appear. Leave this event"), (Team("team", _TEAM),),
           question=say("Did team {team} not appear? The zone leaves this event."), careful=True, aims=True,
           what=say("No-show in {zone}")),
    Action("withdrawn", say("Team withdrew"), say("The team withdrew. Leave this event"), (Team("team", _TEAM),),
           question=say("Did team {team} withdraw? The zone leaves this event."), careful=True, leaves=True, aims=True,
           what=say("Withdrawal in {zone}")),
    Action("choose_event", say("Choose the event"), say("Go to this event of the zone's schedule"),
           (Event("event", say("Event")), Team("team", _TEAM, required=False),
            Toggle("unsigned", say("Also leave a run that is not signed off"), required=False)), leaves=True),
)
# All actions in a zone, in the order in which faces have them.
ACTIONS: Dict[str, Action] = {action.name: action for action in _ALL}
# STOP has a way of its own in every face and in the core, with nothing of this table in it.
STOP = "stop"
