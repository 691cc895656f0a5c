"""Effects: the actions that the core requests, in their order.

The core itself does no I/O (docs/architecture.md, "The core does no I/O"). Its driver calls `Outbox.take` after
each event and carries out the effects one after the other. A record is written before what it causes leaves the box
(docs/architecture.md, "Write first, then act").
"""

import enum
from typing import Any, Callable, Dict, List, NamedTuple, Optional, Set, Union

from roah_rsbb.model.messages import BoxMessage
from roah_rsbb.model.records import RunRecord


class How(enum.Enum):
    """When a BoxMessage leaves (docs/protocol.md, "Channels" and "Timing")."""

    CHANGE = "at once, then the burst"
    REPLY = "at once, one extra time"
    QUIET = "with the next regular one"


class PortTaken(NamedTuple):
    """Record that this private port is used, for the whole competition."""

    port: int


class OpenChannel(NamedTuple):
    """Open a private channel. If that fails, call `Arrivals.on_channel_failed`."""

    port: int
    team: str
    host: Optional[str]  # the sender of the robot's beacon
    version: int = 0  # of the configuration with the team's password


class AimChannel(NamedTuple):
    """Send to this host from now on: the robot's address was confirmed, or changed."""

    port: int
    host: str


class CloseChannel(NamedTuple):
    """Close a private channel without a last message."""

    port: int


class SendState(NamedTuple):
    """The message that the channel on `port` sends from now on."""

    port: int
    message: BoxMessage
    how: How


class SendBeacon(NamedTuple):
    """Something in the beacon changed: send it at once."""


class TimeoutRung(NamedTuple):
    """A run ended by timeout: publish it (topic /timeout)."""

    zone: str


class SetDevice(NamedTuple):
    """A robot commands a device."""

    zone: str
    device: str  # switch_1, switch_2, switch_3, dimmer or blinds
    value: int  # switches 0 or 1, the others per cent


class RunOpened(NamedTuple):
    """A run begins: open its log."""

    port: int  # identifies the run in the whole competition
    team: str
    round: int
    run: int
    robot: str = ""  # its name, if the run may include several robots of the team


class SheetOpened(NamedTuple):
    """A run without a robot begins."""

    record: RunRecord


class RunResumed(NamedTuple):
    """A run continues after a restart of the core, and so does its log."""

    port: int


class RunLogged(NamedTuple):
    """An entry of the run log. `roah_rsbb.model.run_log` has the topics and their kinds of value."""

    port: int
    topic: str
    value: object


class RunClosed(NamedTuple):
    """A run is over and was left: close its log."""

    port: int


class RecordChanged(NamedTuple):
    """The record of a run changed, possibly of a finished one: write this record."""

    record: RunRecord


class Recorded(NamedTuple):
    """A referee gave a command, to a zone or to the box: record it, even if it was refused."""

    zone: str  # empty: none
    identity: str  # of the run; empty: none
    port: Optional[int]  # of the run, if it has exactly one
    kind: str  # "command", "reload", "judge_mark", "judging" or "publication"
    value: Dict[str, Any]  # JSON; a command: its name ("command"), its arguments, the reasons of a refusal
    who: str


class Superseded(NamedTuple):
    """A standby took over from this box: stop sending at once, and record it."""

    epoch: int  # of the new box
    cut: int  # number of the last entry of this journal that the new box has
    by: str  # its address


class ModuleRunsChanged(NamedTuple):
    """Something changed that benchmarking modules need, or whether they are needed: publish `Box.modules.runs` at
    once."""


class Level(enum.IntEnum):
    """Severity of a notice."""

    INFO = 1
    WARNING = 2
    ERROR = 3


class Notice(NamedTuple):
    """A line for the log of the node, and of the zone if one is named."""

    level: Level
    text: str
    zone: str = ""


class AnotherBox(NamedTuple):
    """Another box was heard while this one only listened. It sends nothing for now. Programs of teams end then."""

    host: str  # of the other box


Effect = Union[
    PortTaken, OpenChannel, AimChannel, CloseChannel, SendState, SendBeacon, TimeoutRung, SetDevice,
    RunOpened, SheetOpened, RunResumed, RunLogged, RunClosed, RecordChanged, Recorded,
    Superseded, ModuleRunsChanged, Notice, AnotherBox,
]

# The name of the state that belongs to no zone, in `Outbox.take_changed`.
BOX = ""


def _changes_state(effect: Effect) -> bool:
    """Whether an effect of a run means that a state to be saved has changed."""
    if isinstance(effect, SendState):
        return effect.how is How.CHANGE
    return not isinstance(effect, AimChannel)


class Outbox:
    """Collects the effects of an event, and the names of the states that changed."""

    def __init__(self) -> None:
        self._effects: List[Effect] = []
        self._changed: Set[str] = set()
        self.revisions: Dict[str, int] = {}
        """For each zone a number that rises whenever the zone's state changes."""
        self.revision = 0
        """Rises with each change of any zone's state, and whenever the record of a run changes."""
        self.emitted = 0
        """Rises with each effect, except messages that only acknowledge what a robot says."""

    def emit(self, effect: Effect) -> None:
        """Add an effect that belongs to no run."""
        if isinstance(effect, SendBeacon):
            self.mark_box_changed()
        elif isinstance(effect, RecordChanged):
            self.revision += 1
        if not isinstance(effect, SendState) or effect.how is How.CHANGE:
            self.emitted += 1
        self._effects.append(effect)

    def is_empty(self) -> bool:
        """Whether there are no effects since `take`."""
        return not self._effects

    def of_zone(self, zone: str) -> Callable[[Effect], None]:
        """Return the `emit` for the run in this zone."""

        def emit(effect: Effect) -> None:
            if _changes_state(effect):
                self.mark_changed(zone)
            self.emit(effect)

        return emit

    def notice(self, level: Level, text: str, zone: str = "") -> None:
        """Add a line for the log."""
        self.emit(Notice(level, text, zone))

    def mark_box_changed(self) -> None:
        """Mark the state that belongs to no zone as changed. It is saved with the next effect."""
        self._changed.add(BOX)

    def mark_changed(self, zone: str) -> None:
        """Mark the zone's state as changed, for changes outside its run."""
        self._changed.add(zone)
        self.mark_shown(zone)

    def revision_of(self, zone: str) -> int:
        """Return a number that rises whenever the zone's state changes."""
        return self.revisions.get(zone, 0)

    def mark_shown(self, zone: str) -> None:
        """Mark something as changed that is only shown of a zone: it needs not be saved."""
        self.revisions[zone] = self.revision_of(zone) + 1
        self.revision += 1

    def place(self) -> int:
        """Return the position after the effects so far."""
        return len(self._effects)

    def insert(self, place: int, effect: Effect) -> None:
        """Insert an effect before those that were added after the call of `place`."""
        self._effects.insert(place, effect)

    def drop_since(self, place: int) -> None:
        """Drop the effects that were added after the call of `place`."""
        del self._effects[place:]

    def take(self) -> List[Effect]:
        """Return the effects since the last call."""
        taken, self._effects = self._effects, []
        return taken

    def take_changed(self) -> Set[str]:
        """Return the names of the zones whose state changed since the last call, and `BOX` for the rest."""
        changed, self._changed = self._changed, set()
        return changed
