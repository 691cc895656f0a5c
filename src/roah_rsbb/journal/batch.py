"""What is put into the journal at once: all that one event changed."""

from typing import Dict, NamedTuple, Optional, Tuple


class Entry(NamedTuple):
    """One thing that happened."""

    utc: float  # UTC seconds
    mono: float  # seconds on the monotonic clock of the session
    zone: str
    identity: str  # of the run; empty: it belongs to none
    port: Optional[int]  # of the robot's private channel; None: it belongs to no robot
    who: str  # who did it: a referee's node, a robot's address; empty: the box
    kind: str
    value: str  # JSON


class RunRow(NamedTuple):
    """A run that began."""

    identity: str
    zone: str
    benchmark: str
    team: str
    round: int
    run: int
    scheduled: float
    opened_utc: float


class Outcome(NamedTuple):
    """A run's record, as it is now."""

    closed_utc: Optional[float]  # None: it is still connected
    outcome: str  # JSON


class Member(NamedTuple):
    """A robot's part in a run."""

    port: int
    identity: str
    team: str
    robot: str


class LinkRow(NamedTuple):
    """A second of a robot's link record."""

    port: int
    utc: float
    mono: float
    sample: str  # JSON


class Batch(NamedTuple):
    """What one event left to be written: all of it, or nothing."""

    entries: Tuple[Entry, ...] = ()
    runs: Tuple[RunRow, ...] = ()
    members: Tuple[Member, ...] = ()
    log_files: Tuple[Tuple[int, str], ...] = ()  # port and path of its run log
    outcomes: Tuple[Tuple[str, Outcome], ...] = ()  # by the run's identity
    states: Tuple[Tuple[str, str], ...] = ()  # name and JSON: what a restart goes on from
    links: Tuple[LinkRow, ...] = ()

    def is_empty(self) -> bool:
        """Whether there is nothing to write."""
        return not any(self)


class Pending:
    """Batches that wait: one transaction writes them all. Of what replaces an older value only the newest waits."""

    def __init__(self) -> None:
        self.entries: list = []
        self.runs: list = []
        self.members: list = []
        self.links: list = []
        self.log_files: Dict[int, str] = {}
        self.outcomes: Dict[str, Outcome] = {}
        self.states: Dict[str, str] = {}

    def add(self, batch: Batch) -> None:
        """Put a batch behind those that are there."""
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
