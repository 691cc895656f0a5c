"""The schedule as the referees see it."""

from typing import NamedTuple, Optional

from roah_rsbb.model.reason import Said


class EventSeen(NamedTuple):
    """An event of the schedule with its state and results. Times are UTC seconds."""

    id: str  # by which it is known, whatever else changes
    number: int  # in the schedule of its zone, from 1
    zone: str
    code: str  # of the benchmark
    benchmark: str  # its full name
    team: str  # ALL: all robots at once
    round: int
    run: int
    scheduled_utc_s: float
    begins_utc_s: float  # when it began, or the estimated time
    state: str  # done, connected, running, ended, next, later or skipped
    current: bool  # its zone is at this event
    identity: str = ""  # of the run that counts; if none does, of the last one that is over; empty: none
    end_reason: str = ""
    score: Said = ""  # of that run; empty also while another attempt is in the zone
    signed_utc_s: Optional[float] = None  # None: not signed off
    signed_by: str = ""
    counts: str = ""  # whether that run counts, see `wording.counting`

    @property
    def late_s(self) -> float:
        """By how many seconds it began, or will begin, after its scheduled time; at least 0."""
        return max(0.0, self.begins_utc_s - self.scheduled_utc_s)

    @property
    def unsigned(self) -> bool:
        """Whether a run is over, and one that counts is not signed off."""
        return self.state == "ended" or (bool(self.identity) and self.signed_utc_s is None)
