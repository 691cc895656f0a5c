"""The referee's scores: marks, withdrawals, reasons and sign-offs, of runs in progress and of finished ones."""

from typing import Callable, List, Optional, Union

from roah_rsbb.core import effects
from roah_rsbb.core.clock import Now
from roah_rsbb.core.commands import CommandRecord
from roah_rsbb.core.effects import Level, Outbox
from roah_rsbb.core.referee import Refused, RunName, checked_note, checked_who
from roah_rsbb.core.runs.run import ZoneRun
from roah_rsbb.core.scoring.book import FinishedRun, FinishedRuns
from roah_rsbb.core.scoring.records import By, Phase, RunRecord
from roah_rsbb.core.scoring.sheet import Mark
from roah_rsbb.core.zones import Zones

# Finished runs in the list of results: more than a day of any competition.
MAX_LISTED = 100


class ScoreDesk:
    """Takes what the referee says of one run, which is named by its identity or by its zone."""

    def __init__(
        self,
        tick: Callable[[Now], None],
        zones: Zones,
        finished: FinishedRuns,
        record: CommandRecord,
        outbox: Outbox,
    ) -> None:
        """`tick` does what is due by now: every event does that first."""
        self._tick = tick
        self._zones = zones
        self._finished = finished
        self._record = record
        self._outbox = outbox

    # -- looking ------------------------------------------------------------------------------------

    def records(self, now: Now) -> List[RunRecord]:
        """The records of the runs in the zones, in their order, then of the newest finished runs, the last first."""
        return [run.record(now) for run in self._zones.runs()] + self._finished.records(MAX_LISTED)

    def record_of(self, now: Now, name: RunName) -> RunRecord:
        """The record of a run; raises `Refused`."""
        run = self._named(name)
        return run.record if isinstance(run, FinishedRun) else run.record(now)

    # -- scores -------------------------------------------------------------------------------------

    def mark(self, now: Now, name: RunName, mark: Mark, who: str = "") -> None:
        """Mark a scoring item; in a finished run that is a correction. Raises `Refused`."""
        self._tick(now)
        asked = {"group": mark.group, "item": mark.desc, "note": mark.note}
        asked.update({"not_attempted": True} if mark.not_attempted else {"value": mark.value})
        with self._record.of(name, who, "score", **asked):
            mark = mark._replace(note=checked_note(mark.note))
            run = self._named(name)
            self._report_correction(run, run.mark(now, checked_who(who), mark))

    def withdraw(self, now: Now, name: RunName, number: int, who: str = "", note: str = "") -> None:
        """Withdraw an entry of a score sheet. The other entries stay as they are. Raises `Refused`."""
        self._tick(now)
        with self._record.of(name, who, "withdraw", entry=number, note=note):
            by = By(checked_who(who), checked_note(note))
            run = self._named(name)
            self._report_correction(run, run.withdraw_score(now, by, number))

    def give_stop_reason(self, now: Now, name: RunName, reason: str, who: str = "", number: int = 0) -> None:
        """Say why a run was stopped, until it is signed off; see `RunBook.give_reason`. Raises `Refused`."""
        self._tick(now)
        with self._record.of(name, who, "stop_reason", reason=reason, stop=number):
            by = By(checked_who(who), checked_note(reason))
            run = self._named(name)
            self._report_correction(run, run.give_stop_reason(now, by, number))

    def sign_off(self, now: Now, name: RunName, who: str = "") -> None:
        """Make the score sheet of a finished run final; raises `Refused`."""
        self._tick(now)
        with self._record.of(name, who, "sign_off"):
            if not name.identity:
                raise Refused(["say which run is signed off: only one that is over can be"])
            run = self._named(name)
            if not isinstance(run, FinishedRun):
                raise Refused([f"run {name.identity} is still connected: disconnect it first"])
            self._report_correction(run, run.sign_off(now, checked_who(who)))

    # -- stop ---------------------------------------------------------------------------------------

    def stop(self, now: Now, name: RunName, who: str = "") -> None:
        """Stop the named run; raises `Refused`.

        A run that ended by itself a moment before stays as it is. The command *stop* would leave it.
        """
        self._tick(now)
        with self._record.of(name, who, "stop"):
            run = self._named(name)
            if not isinstance(run, FinishedRun):
                if run.phase is Phase.RUNNING:
                    run.stop(now, By(checked_who(who)))
                return
            zone = self._zones.get(name.zone)
            if zone is not None and zone.run is not None and zone.run.phase is Phase.RUNNING:
                # A panel with late details names the run before: its referee must not believe that this one stopped.
                raise Refused([f"run {name.identity} is over, but run {zone.run.identity} is running in zone "
                               f"'{name.zone}': stop again"])

    def _named(self, name: RunName) -> Union[ZoneRun, FinishedRun]:
        """The run of that name; raises `Refused`."""
        if not name.identity:
            return self._zones.run_in(name.zone)
        zone = self._zones.get(name.zone)  # the zone of a finished run may no longer be in the schedule
        if zone is not None and zone.run is not None and zone.run.identity == name.identity:
            return zone.run
        run = self._finished.find(name.identity)
        if run.record.zone != name.zone:
            raise Refused([f"run {name.identity} was in zone '{run.record.zone}', not in '{name.zone}'"])
        return run

    def _report_correction(self, run: Union[ZoneRun, FinishedRun], text: Optional[str]) -> None:
        """Report what was corrected in a finished run. A run in progress reports its changes itself."""
        if not isinstance(run, FinishedRun):
            return
        record = run.record
        self._outbox.emit(effects.RecordChanged(record))
        what = f"{record.benchmark}, team {record.team}, round {record.round}, run {record.run}"
        self._outbox.notice(Level.INFO, f"{what}: {text}", record.zone)
