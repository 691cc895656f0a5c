"""The box's events that concern one run by its name: scores, records, a stop.

A run is named by its identity, so that a mark that was meant for one run never goes into the next one; no identity
means the run that is connected in the zone, whatever it is.
"""

import abc
from typing import List, Optional, Union

from roah_rsbb.core import effects
from roah_rsbb.core.clock import Now
from roah_rsbb.core.effects import Effect, Level
from roah_rsbb.core.referee_record import RefereeRecord, RunName, checked_note, checked_who
from roah_rsbb.core.refused import Refused
from roah_rsbb.core.runs.phases import Phase
from roah_rsbb.core.runs.zone_run import ZoneRun
from roah_rsbb.core.scoring.finished_runs import FinishedRun, FinishedRuns
from roah_rsbb.core.scoring.records import By, RunRecord
from roah_rsbb.core.scoring.sheet import Mark
from roah_rsbb.core.zone import Zone


class ScoreEvents(RefereeRecord):
    """A part of `roah_rsbb.core.box.Box`, which has the zones and the time."""

    finished: FinishedRuns

    @abc.abstractmethod
    def tick(self, now: Now) -> None:
        """See `Box.tick`."""

    @abc.abstractmethod
    def zone(self, name: str) -> Zone:
        """See `Box.zone`."""

    @abc.abstractmethod
    def _run_in(self, zone_name: str) -> ZoneRun: ...

    @abc.abstractmethod
    def _emit(self, effect: Effect) -> None: ...

    @abc.abstractmethod
    def _notice(self, level: Level, text: str, zone: str = "") -> None: ...

    # -- looking ------------------------------------------------------------------------------------

    def records(self, now: Now) -> List[RunRecord]:
        """The records of the runs in the zones, in their order, then of those that are over, the last one first."""
        runs = [zone.run for zone in self.zones.values() if zone.run is not None]
        return [run.record(now) for run in runs] + self.finished.records()

    def record_of(self, now: Now, name: RunName) -> RunRecord:
        """The record of a run; raises `Refused`."""
        run = self._named(name)
        return run.record if isinstance(run, FinishedRun) else run.record(now)

    # -- scores -------------------------------------------------------------------------------------

    def set_score(
        self, now: Now, zone_name: str, group: str, desc: str, value: int, who: str = "", note: str = ""
    ) -> None:
        """Mark a scoring item of the run in a zone; raises `Refused`."""
        self.score(now, RunName(zone_name), Mark(group, desc, value, note=note), who)

    def score(self, now: Now, name: RunName, mark: Mark, who: str = "") -> None:
        """Mark a scoring item; where the run is over, that is a correction. Raises `Refused`."""
        self.tick(now)
        asked = {"group": mark.group, "item": mark.desc, "note": mark.note}
        asked.update({"not_attempted": True} if mark.not_attempted else {"value": mark.value})
        with self._recording(name, who, "score", **asked):
            mark = mark._replace(note=checked_note(mark.note))
            run = self._named(name)
            self._tell_correction(run, run.mark(now, checked_who(who), mark))

    def withdraw_score(self, now: Now, name: RunName, number: int, who: str = "", note: str = "") -> None:
        """An entry of a score sheet counts no more; the others are as they are. Raises `Refused`."""
        self.tick(now)
        with self._recording(name, who, "withdraw", entry=number, note=note):
            by = By(checked_who(who), checked_note(note))
            run = self._named(name)
            self._tell_correction(run, run.withdraw_score(now, by, number))

    def give_stop_reason(self, now: Now, name: RunName, reason: str, who: str = "", number: int = 0) -> None:
        """Say why a run was stopped, until it is signed off; see `RunBook.give_reason`. Raises `Refused`."""
        self.tick(now)
        with self._recording(name, who, "stop_reason", reason=reason, stop=number):
            by = By(checked_who(who), checked_note(reason))
            run = self._named(name)
            self._tell_correction(run, run.give_stop_reason(now, by, number))

    def sign_off(self, now: Now, name: RunName, who: str = "") -> None:
        """The score sheet of a run that is over is final; raises `Refused`."""
        self.tick(now)
        with self._recording(name, who, "sign_off"):
            if not name.identity:
                raise Refused(["say which run is signed off: only one that is over can be"])
            run = self._named(name)
            if not isinstance(run, FinishedRun):
                raise Refused([f"run {name.identity} is still connected: disconnect it first"])
            self._tell_correction(run, run.sign_off(now, checked_who(who)))

    # -- stop ---------------------------------------------------------------------------------------

    def stop_run(self, now: Now, name: RunName, who: str = "") -> None:
        """Stop a run; raises `Refused`. One that ended by itself a moment before stays as it is: who wanted to stop it
        must not leave it by accident, as the command *stop* would."""
        self.tick(now)
        with self._recording(name, who, "stop"):
            run = self._named(name)
            if not isinstance(run, FinishedRun) and run.phase is Phase.RUNNING:
                run.stop(now, By(checked_who(who)))

    def _named(self, name: RunName) -> Union[ZoneRun, FinishedRun]:
        """The run of that name; raises `Refused`."""
        if not name.identity:
            return self._run_in(name.zone)
        zone = self.zones.get(name.zone)  # of a run that is over the schedule may have no zone any more
        if zone is not None and zone.run is not None and zone.run.identity == name.identity:
            return zone.run
        run = self.finished.find(name.identity)
        if run.record.zone != name.zone:
            raise Refused([f"run {name.identity} was in zone '{run.record.zone}', not in '{name.zone}'"])
        return run

    def _tell_correction(self, run: Union[ZoneRun, FinishedRun], text: Optional[str]) -> None:
        """A run that goes on tells its changes by itself; of one that is over, `text` says what was corrected."""
        if not isinstance(run, FinishedRun):
            return
        record = run.record
        self._emit(effects.RecordChanged(record))
        what = f"{record.benchmark}, team {record.team}, round {record.round}, run {record.run}"
        self._notice(Level.INFO, f"{what}: {text}", record.zone)
