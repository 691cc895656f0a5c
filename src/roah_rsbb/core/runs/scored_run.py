"""What a run of one robot and one of all robots have in common: both are scored, ended and recorded as a whole."""

import abc
from typing import Any, Callable, Optional, Sequence, Tuple

from roah_rsbb.core import effects, run_log
from roah_rsbb.core.clock import Now
from roah_rsbb.core.effects import Effect, Level
from roah_rsbb.core.runs.clock import RunClock
from roah_rsbb.core.runs.online_data import DisplayText
from roah_rsbb.core.runs.phases import EndReason, Phase
from roah_rsbb.core.runs.run_book import Marked, RunBook
from roah_rsbb.core.scoring.records import By, RunRecord, ScoreValue
from roah_rsbb.core.scoring.sheet import Mark, ScoreSheet
from roah_rsbb.rulebook.benchmarks import Event


class ScoredRun(abc.ABC):
    """A part of `core.runs.run.Run` and of `core.runs.all_robots.AllRobotsRun`, which have the attributes."""

    identity: str
    zone: str
    event: Event
    opened_utc: float
    phase: Phase
    end_reason: Optional[EndReason]
    desc: str
    log: DisplayText
    online_data: DisplayText
    clock: RunClock
    scores: Tuple[ScoreValue, ...] = ()  # of a benchmarking module
    _emit: Callable[[Effect], None]

    def __init__(self, event: Event) -> None:
        self.book = RunBook(event.benchmark.scoring)
        self._closed_utc = 0.0

    @property
    def sheet(self) -> ScoreSheet:
        """What the referee marks."""
        return self.book.sheet

    @abc.abstractmethod
    def _say(self, now: Now, level: Level, text: str) -> None:
        """Tell the referee, in the log of the run and in that of the node."""

    @abc.abstractmethod
    def _log_ports(self) -> Sequence[int]:
        """The ports of all run logs of this run."""

    @abc.abstractmethod
    def _robot_names(self) -> Sequence[str]: ...

    # -- the referee --------------------------------------------------------------------------------

    def mark(self, now: Now, who: str, mark: Mark) -> None:
        """The referee marks a scoring item; raises `Refused` if there is no such item or value."""
        self._score_changed(now, self.book.mark(now, who, mark))

    def withdraw_score(self, now: Now, by: By, number: int) -> None:
        """An entry of the score sheet counts no more; raises `Refused`."""
        self._score_changed(now, self.book.withdraw(now, by, number))

    def give_stop_reason(self, now: Now, by: By, number: int) -> None:
        """The referee says why the run was stopped; raises `Refused`."""
        self._say(now, Level.INFO, self.book.give_reason(number, by))
        self._record_changed(now)

    def _score_changed(self, now: Now, marked: Marked) -> None:
        if marked.item is not None:
            entry = (marked.item.group, marked.item.desc, marked.item.value)
            for port in self._log_ports():
                self._emit(effects.RunLogged(port, run_log.SCORE, entry))
        self._say(now, Level.INFO, marked.text)
        self._record_changed(now)

    # -- restart of the core ------------------------------------------------------------------------

    def _take_back(self, state: Any) -> None:
        """Go on as saved: `state` is of either kind of run, and has what both save."""
        self.identity, self.opened_utc = state.identity, state.opened_utc
        self.phase, self.end_reason, self.desc = state.phase, state.end_reason, state.desc
        self.log.text, self.online_data.text = state.log, state.online_data
        self.clock.restore(state.clock)
        self.book.restore(state.book)

    # -- the record ---------------------------------------------------------------------------------

    def record(self, now: Now) -> RunRecord:
        """All that would remain of the run if it were over now."""
        event = self.event
        record = self.book.into(RunRecord(
            self.identity, self.zone, event.benchmark.code, event.team, event.round, event.run, event.scheduled,
            self.opened_utc, closed_utc=self._closed_utc,
            end_reason="" if self.end_reason is None else self.end_reason.name.lower(),
            module_scores=self.scores, robots=tuple(self._robot_names()),
        ))
        return record._replace(elapsed_s=self.clock.elapsed(now)) if self.phase is Phase.RUNNING else record

    def _note_start(self, now: Now) -> None:
        self.book.started(now)
        self._record_changed(now)

    def _note_end(self, now: Now, desc: str, by: By) -> None:
        """Write down that the run ended just now, as `end_reason` says."""
        assert self.end_reason is not None, "it ended"
        self.book.ended(now, self.end_reason.name.lower(), desc, by, self.clock.elapsed(now))
        self._record_changed(now)

    def _note_close(self, now: Now, by: By) -> None:
        """Write down that the run is left; one that still runs is stopped by that."""
        self._closed_utc = now.utc
        if self.phase is Phase.RUNNING:
            self.end_reason, self.phase = EndReason.STOPPED, Phase.ENDED
            self.book.ended(now, "stopped", EndReason.STOPPED.value, by, self.clock.elapsed(now))
        self._record_changed(now)

    def _record_changed(self, now: Now) -> None:
        self._emit(effects.RecordChanged(self.record(now)))
