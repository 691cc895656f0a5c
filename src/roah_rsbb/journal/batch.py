"""The data that an event adds to the journal, as one record. Values are those of JSON: no tuples in what changes."""

from dataclasses import dataclass, field
from typing import Any, Dict, List, NamedTuple, Optional


class NewEntry(NamedTuple):
    """An entry to be written."""

    utc: float  # UTC seconds
    mono: float  # seconds on the monotonic clock of the session
    zone: str
    identity: str  # of the run; empty if it belongs to no run
    port: Optional[int]  # of the robot's private channel; None if it belongs to no robot
    who: str  # the originator: a referee's node or a robot's address; empty: the box
    kind: str
    value: Any  # JSON's value


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
    outcome: Any  # JSON's value


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
    sample: Any  # JSON's value


@dataclass
class Batch:
    """The changes of one event."""

    entries: List[NewEntry] = field(default_factory=list)
    runs: List[RunRow] = field(default_factory=list)
    members: List[Member] = field(default_factory=list)
    log_files: Dict[int, str] = field(default_factory=dict)  # path of the run log by port
    outcomes: Dict[str, OutcomeRow] = field(default_factory=dict)  # by the run's identity
    states: Dict[str, Any] = field(default_factory=dict)  # JSON's value of the state for a restart by its name
    links: List[LinkRow] = field(default_factory=list)

    def is_empty(self) -> bool:
        """Whether there is nothing to write."""
        return not any(vars(self).values())
