"""What zones, commands and views need of a run, of one robot or of all robots at once."""

from typing import List, Optional, Protocol, Sequence

from roah_rsbb.core.clock import Now
from roah_rsbb.core.runs.clock import RunClock
from roah_rsbb.core.runs.online_data import DisplayText
from roah_rsbb.core.runs.phases import EndReason, Phase
from roah_rsbb.core.runs.run import Run
from roah_rsbb.core.scoring.records import NOBODY, By, RunRecord
from roah_rsbb.core.scoring.sheet import Mark, ScoreSheet
from roah_rsbb.rulebook.benchmarks import Event


class ZoneRun(Protocol):
    """The run in a zone. `Run` is one, for a single robot; `AllRobotsRun` another, which has many of them."""

    event: Event
    identity: str  # the name of the run: no other run of this or another competition has it
    opened_utc: float  # UTC seconds of *connect*
    phase: Phase
    end_reason: Optional[EndReason]
    desc: str  # what is the matter, in one line
    clock: RunClock
    sheet: ScoreSheet
    log: DisplayText
    online_data: DisplayText

    def members(self) -> Sequence[Run]:
        """The runs of single robots in it, each with a private channel of its own."""

    def without(self, member: Run) -> Optional["ZoneRun"]:
        """What is left of the run without one of its members, which was closed; None: nothing."""

    def start(self, now: Now) -> None:
        """Start, or start again after a stop; `start_off` was empty."""

    def stop(self, now: Now, by: By = NOBODY) -> None:
        """The referee ends the run."""

    def mark(self, now: Now, who: str, mark: Mark) -> None:
        """The referee marks a scoring item; raises `Refused`."""

    def withdraw_score(self, now: Now, by: By, number: int) -> None:
        """An entry of the score sheet counts no more; raises `Refused`."""

    def give_stop_reason(self, now: Now, by: By, number: int) -> None:
        """The referee says why the run was stopped; raises `Refused`."""

    def record(self, now: Now) -> RunRecord:
        """All that would remain of the run if it were over now."""

    def warn(self, now: Now, text: str) -> None:
        """What goes wrong around this run: its referee reads it in the log."""

    def close(self, now: Now, by: By = NOBODY) -> None:
        """Leave the run, with all its channels."""

    def deadline(self) -> Optional[float]:
        """The monotonic time (s) at which `tick` has something to do, if nothing happens before."""

    def tick(self, now: Now) -> None:
        """Do what is due by now, the members' things, too."""

    def timer(self, now: Now) -> float:
        """Seconds left, as the referee sees them."""

    def start_off(self, now: Now) -> List[str]:
        """Why the run cannot be started, apart from its clock's reasons."""

    def warnings(self, now: Now) -> List[str]:
        """What the referee should look at now."""

    def status_lines(self, now: Now) -> List[str]:
        """What the referee should know of the run, besides what is the matter and the warnings."""
