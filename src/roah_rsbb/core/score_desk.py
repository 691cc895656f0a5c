"""The referee's scores: marks, withdrawals, reasons and sign-offs, in runs in progress and finished runs."""

from typing import Callable, Dict, List, NamedTuple, Optional, Set, Tuple, Union

from roah_rsbb.core import effects
from roah_rsbb.core.actions.record import CommandRecord
from roah_rsbb.core.effects import Level, Outbox
from roah_rsbb.core.runs.phases import RunEvent, is_possible
from roah_rsbb.core.runs.run import ZoneRun
from roah_rsbb.core.zones import NOTHING_TO_STOP, Zone, Zones
from roah_rsbb.model.clock import Now
from roah_rsbb.model.reason import Refused, RunName, checked_note, checked_who, say
from roah_rsbb.model.records import By, ItemRecord, Phase, RunRecord
from roah_rsbb.rulebook.event_ids import key_of
from roah_rsbb.scoring.book import FinishedRun, FinishedRuns, RunBook
from roah_rsbb.scoring.counting import Counted, Counting, EventResult, Ruling, Why
from roah_rsbb.scoring.sheet import Mark

# Finished runs in the list of results: more than the runs of one day in any competition.
MAX_LISTED = 100
# Characters of the identity of a mark: more than a UUID has.
MAX_MARK_ID = 64
# Who may mark.
ROLES = ("referee", "judge", "organiser")
NAME_THE_RUN = say("name the run: what arrives late must not count in another run")
OTHER_ZONE = say("run {run} was in zone '{zone}', not in '{other}'")
STILL_CONNECTED = say("run {run} is still connected: disconnect it first")


class MarkOutcome(NamedTuple):
    """The result of a mark."""

    entry: int  # its number in the history; 0: it made no entry
    item: ItemRecord  # as it is now


class ScoreDesk:
    """Takes the referee's scores for a run, which is named by its identity or its zone."""

    def __init__(
        self,
        tick: Callable[[Now], None],
        zones: Zones,
        finished: FinishedRuns,
        record: CommandRecord,
        outbox: Outbox,
    ) -> None:
        """`tick` does what is due by now. Every event calls it first."""
        self._tick = tick
        self._zones = zones
        self._finished = finished
        self._record = record
        self._outbox = outbox
        self._counting = Counting()
        self._counted: Tuple[int, Counted] = (-1, Counted([], []))  # for a revision, as the next one
        self._results: Tuple[int, Dict[Tuple[str, int], EventResult]] = (-1, {})
        self._over: Tuple[int, Set[Tuple[str, int]]] = (-1, set())

    # -- looking ------------------------------------------------------------------------------------

    def records(self, now: Now) -> List[RunRecord]:
        """Return the records of the runs in the zones, in their order, then of finished runs, the newest first."""
        return [run.record(now) for run in self._zones.runs()] + [
            run.record for run in self._finished.newest_runs(MAX_LISTED)]

    def rulings(self, now: Now) -> List[Ruling]:
        """Return which runs count, and why or why not: finished ones, the oldest first, then those in the zones."""
        return self._count(now).rulings

    def event_results(self, now: Now) -> List[EventResult]:
        """Return the results of each team at each event of which a run is over."""
        return self._count(now).results

    def _count(self, now: Now) -> Counted:
        if self._counted[0] != self._outbox.revision:
            records = self._finished.records()[::-1] + [run.record(now) for run in self._zones.runs()]
            counted = self._counting.look(records, self._finished.ranking, self._finished.event_rules())
            self._counted = self._outbox.revision, counted
        return self._counted[1]

    def results(self, now: Now) -> Dict[Tuple[str, int], EventResult]:
        """Return the results of the events of the schedule, by zone and place in it."""
        if self._results[0] != self._outbox.revision:
            self._results = self._outbox.revision, {
                place: result for result in self.event_results(now)
                for place in self._zones.places_of(result.shown.record)}
        return self._results[1]

    def is_signed_off(self, now: Now, zone: Zone) -> bool:
        """Return whether the current event of a zone has a result, and it is final."""
        result = self.results(now).get((zone.name, zone.index))
        return result is not None and result.signed

    def events_over(self) -> Set[Tuple[str, int]]:
        """Return the events that need no run any more, see `Zones.over`."""
        if self._over[0] != self._outbox.revision:
            self._over = self._outbox.revision, self._zones.over(self._finished.records())
        return self._over[1]

    def why(self, now: Now, identity: str) -> Optional[Why]:
        """Return why a run counts or not; None: it is not known any more."""
        return next((ruling.why for ruling in self.rulings(now) if ruling.record.identity == identity), None)

    def record_of(self, now: Now, name: RunName) -> RunRecord:
        """Return the record of a run; of a zone without a run, one with the empty sheet of its event. Raises `Refused`.
        """
        if not name.identity and self._zones.named(name.zone).run is None:
            event = self._zones[name.zone].event
            return RunBook(event.benchmark.form).into(RunRecord("", name.zone, *key_of(event)[:5], 0.0, event=event.id))
        run = self.named(name)
        return run.record if isinstance(run, FinishedRun) else run.record(now)

    def unsigned(self) -> List[Union[ZoneRun, FinishedRun]]:
        """Return the runs in the zones, in their order, then the newest finished runs that are not signed off."""
        finished = [run for run in self._finished.newest_runs(MAX_LISTED) if run.record.sign_off is None]
        return [*self._zones.runs(), *finished]

    # -- scores -------------------------------------------------------------------------------------

    def mark(self, now: Now, name: RunName, mark: Mark, who: str = "") -> None:
        """Mark a scoring item. In a finished run, this is a correction. Raises `Refused`.

        A mark with an identity names its run by the run's own, so one that arrives again changes no other run, and is
        applied once.
        """
        if mark.id:
            if not name.identity:
                raise Refused([NAME_THE_RUN])
            check_mark_id(mark.id)
        if mark.role and mark.role not in ROLES:
            raise Refused([say("no role '{role}': choose one of {choices}")(
                role=mark.role, choices=", ".join(ROLES))])
        mark = mark._replace(note=checked_note(mark.note), device=checked_who(mark.device))
        run = self.named(name)
        self.report_correction(run, run.mark(now, checked_who(who), mark))

    def is_applied(self, name: RunName, mark: Mark) -> bool:
        """Whether a mark was applied before. Raises `Refused`."""
        return self.named(name).sheet.is_applied(mark)

    def outcome(self, name: RunName, mark: Mark) -> MarkOutcome:
        """Return the result of a mark that was applied. Raises `Refused`."""
        sheet = self.named(name).sheet
        return MarkOutcome(sheet.taken(mark.id) or 0, sheet.item(mark.group, mark.desc))

    def withdraw(self, now: Now, name: RunName, number: int, who: str = "", note: str = "") -> None:
        """Withdraw an entry of a score sheet. The other entries do not change. Raises `Refused`."""
        by = By(checked_who(who), checked_note(note))
        run = self.named(name)
        self.report_correction(run, run.withdraw_score(now, by, number))

    def take_back(self, now: Now, name: RunName, mark_id: str, who: str = "", note: str = "") -> None:
        """Take back a mark that set an item, once, however often this arrives. Raises `Refused`."""
        if not name.identity:
            raise Refused([NAME_THE_RUN])
        by = By(checked_who(who), checked_note(note))
        run = self.named(name)
        self.report_correction(run, run.take_back(now, by, mark_id))

    def give_stop_reason(self, now: Now, name: RunName, reason: str, who: str = "", number: int = 0) -> None:
        """Set why a run was stopped, until it is signed off; see `RunBook.give_reason`. Raises `Refused`."""
        by = By(checked_who(who), checked_note(reason))
        run = self.named(name)
        self.report_correction(run, run.give_stop_reason(now, by, number))

    def sign_off(self, now: Now, name: RunName, who: str = "") -> None:
        """Make the score sheet of a finished run final. Raises `Refused`."""
        if not name.identity:
            raise Refused([say("name the run to sign off: only a run that is over can be signed off")])
        run = self.named(name)
        if not isinstance(run, FinishedRun):
            raise Refused([STILL_CONNECTED(run=name.identity)])
        self.report_correction(run, run.sign_off(now, checked_who(who)))

    # -- stop ---------------------------------------------------------------------------------------

    def stop(self, now: Now, name: RunName, who: str = "") -> None:
        """Stop the named run. Raises `Refused`.

        A run that has just ended by itself does not change, while the command *stop* would leave it.
        """
        self._tick(now)
        with self._record.of(name, who, "stop"):
            run = self.named(name) if name.identity else self._zones.run_in(name.zone, NOTHING_TO_STOP)
            if not isinstance(run, FinishedRun):
                if is_possible(run.phase, RunEvent.END):
                    run.stop(now, By(checked_who(who)))
                return
            zone = self._zones.get(name.zone)
            if zone is not None and zone.run is not None and zone.run.phase is Phase.RUNNING:
                # A panel with old details names the previous run. Its referee must not think that this run stopped.
                raise Refused([say("run {run} is over, but run {other} is running in zone '{zone}': stop again")(
                    run=name.identity, other=zone.run.identity, zone=name.zone)])

    def named(self, name: RunName) -> Union[ZoneRun, FinishedRun]:
        """Return the run of that name. Raises `Refused`."""
        if not name.identity:
            return self._zones.run_in(name.zone)
        zone = self._zones.get(name.zone)  # the zone of a finished run may no longer be in the schedule
        if zone is not None and zone.run is not None and zone.run.identity == name.identity:
            return zone.run
        for other in self._zones.runs():
            if other.identity == name.identity:
                raise Refused([OTHER_ZONE(run=name.identity, zone=other.zone, other=name.zone)])
        if zone is None and name.identity not in self._finished:
            self._zones.named(name.zone)  # that it does not exist explains more
        run = self._finished.find(name.identity)
        if run.record.zone != name.zone:
            raise Refused([OTHER_ZONE(run=name.identity, zone=run.record.zone, other=name.zone)])
        return run

    def report_correction(self, run: Union[ZoneRun, FinishedRun], text: Optional[str]) -> None:
        """Report a correction of a finished run. A run in progress reports its changes itself."""
        if not isinstance(run, FinishedRun) or not text:
            return
        record = run.record
        self._outbox.emit(effects.RecordChanged(record))
        what = f"{record.benchmark}, team {record.team}, round {record.round}, run {record.run}"
        self._outbox.notice(Level.INFO, f"{what}: {text}", record.zone)


def check_mark_id(mark_id: str) -> None:
    """Check the identity of a mark; raises `Refused`."""
    if not mark_id.strip() or not mark_id.isprintable() or len(mark_id) > MAX_MARK_ID:
        raise Refused([say("the id '{id}' cannot identify a mark: give each mark a new UUID")(
            id=mark_id[:MAX_MARK_ID])])
