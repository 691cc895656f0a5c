"""The data that events add to the journal, in one transaction."""

from dataclasses import dataclass, field
from typing import Dict, List, NamedTuple, Optional


class NewEntry(NamedTuple):
    """An entry to be written."""

    utc: float  # UTC seconds
    mono: float  # seconds on the monotonic clock of the session
    zone: str
    identity: str  # of the run; empty if it belongs to no run
    port: Optional[int]  # of the robot's private channel; None if it belongs to no robot
    who: str  # the originator: a referee's node or a robot's address; empty: the box
    kind: str
    value: str  # JSON


class RunRow(NamedTuple):
    """A run to be written."""

    identity: str
    zone: str
    benchmark: str
    team: str
    round: int
    run: int
    scheduled: float
    opened_utc: float


class OutcomeRow(NamedTuple):
    """The present record of a run."""

    closed_utc: Optional[float]  # None: still connected
    outcome: str  # JSON


class Member(NamedTuple):
    """A robot that takes part in a run."""

    port: int
    identity: str
    team: str
    robot: str


class LinkRow(NamedTuple):
    """One second of a robot's link record."""

    port: int
    utc: float
    mono: float
    sample: str  # JSON


@dataclass
class Batch:
    """What one transaction writes: the changes of one event, or of all events that wait. Of values that replace each
    other, it has only the newest."""

    entries: List[NewEntry] = field(default_factory=list)
    runs: List[RunRow] = field(default_factory=list)
    members: List[Member] = field(default_factory=list)
    log_files: Dict[int, str] = field(default_factory=dict)  # path of the run log by port
    outcomes: Dict[str, OutcomeRow] = field(default_factory=dict)  # by the run's identity
    states: Dict[str, str] = field(default_factory=dict)  # JSON of the state for a restart by its name
    links: List[LinkRow] = field(default_factory=list)

    def add(self, later: "Batch") -> None:
        """Append a later batch."""
        self.entries += later.entries
        self.runs += later.runs
        self.members += later.members
        self.links += later.links
        self.log_files.update(later.log_files)
        self.outcomes.update(later.outcomes)
        self.states.update(later.states)

    def is_empty(self) -> bool:
        """Whether there is nothing to write."""
        return not any(vars(self).values())
