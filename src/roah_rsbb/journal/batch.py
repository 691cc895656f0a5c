"""The data that one event adds to the journal, in one transaction."""

from typing import Dict, NamedTuple, Optional, Tuple


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


class RunOutcome(NamedTuple):
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


class Batch(NamedTuple):
    """Everything that one event writes, in one transaction."""

    entries: Tuple[NewEntry, ...] = ()
    runs: Tuple[RunRow, ...] = ()
    members: Tuple[Member, ...] = ()
    log_files: Tuple[Tuple[int, str], ...] = ()  # port and path of its run log
    outcomes: Tuple[Tuple[str, RunOutcome], ...] = ()  # by the run's identity
    states: Tuple[Tuple[str, str], ...] = ()  # name and JSON of the state for a restart
    links: Tuple[LinkRow, ...] = ()

    def is_empty(self) -> bool:
        """Whether there is nothing to write."""
        return not any(self)


class Pending:
    """Waiting batches, which one transaction writes. Of values that replace each other, only the newest waits."""

    def __init__(self) -> None:
        self.entries: list = []
        self.runs: list = []
        self.members: list = []
        self.links: list = []
        self.log_files: Dict[int, str] = {}
        self.outcomes: Dict[str, RunOutcome] = {}
        self.states: Dict[str, str] = {}

    def add(self, batch: Batch) -> None:
        """Append a batch."""
        self.entries += batch.entries
        self.runs += batch.runs
        self.members += batch.members
        self.links += batch.links
        self.log_files.update(batch.log_files)
        self.outcomes.update(batch.outcomes)
        self.states.update(batch.states)

    def is_empty(self) -> bool:
        """Whether nothing waits."""
        return not (self.entries or self.runs or self.members or self.links or self.log_files or self.outcomes
                    or self.states)
