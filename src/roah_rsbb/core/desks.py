"""The desks of the box: each takes what persons or modules enter for a run, in progress or finished.

`ScoreDesk`: the referee's marks, withdrawals, reasons, sign-offs, and STOP. `JudgeDesk`: what judges and the head
referee enter for a run with several judges, and objections to its result. `ModuleDesk`: the messages of benchmarking
modules. `CommandRecord` records what persons do, refusals included, for the journal.
"""

import contextlib
from typing import Callable, Dict, Iterator, List, NamedTuple, Optional, Set, Tuple, Union

from roah_rsbb.core import effects
from roah_rsbb.core.authority import Authority
from roah_rsbb.core.effects import Level, Outbox
from roah_rsbb.core.modules import Modules
from roah_rsbb.core.runs.functionality import FunctionalityRun
from roah_rsbb.core.runs.machine import RunEvent, is_possible
from roah_rsbb.core.runs.run import ZoneRun
from roah_rsbb.core.zones import NO_EVENT, NOTHING_TO_STOP, Zone, Zones
from roah_rsbb.model.actions import ROLES
from roah_rsbb.model.clock import Now
from roah_rsbb.model.modules import ModulesState, RunForModule
from roah_rsbb.model.reason import MAX_NOTE, Refused, RunName, checked_note, checked_who, say
from roah_rsbb.model.records import By, CaptainSign, ItemRecord, JudgeSheet, Phase, RunRecord, Slot
from roah_rsbb.model.scoring import SheetForm
from roah_rsbb.rulebook.benchmarks import ALL_TEAMS
from roah_rsbb.rulebook.event_ids import key_of
from roah_rsbb.scoring.book import FinishedRun, FinishedRuns, Note, RunBook
from roah_rsbb.scoring.counting import Counted, Counting, EventResult, Ruling, Why, attempts_key
from roah_rsbb.scoring.judges import ItemVerdict
from roah_rsbb.scoring.publication import PublicationState
from roah_rsbb.scoring.sheet import Mark


class CommandRecord:
    """Records every command of a referee, including refused ones."""

    def __init__(self, zones: Zones, authority: Authority, outbox: Outbox, kind: str = "command") -> None:
        """`kind`: of the journal's entries."""
        self._zones = zones
        self._authority = authority
        self._outbox = outbox
        self._kind = kind

    def of_kind(self, kind: str) -> "CommandRecord":
        """Return a record for another kind of entries."""
        return CommandRecord(self._zones, self._authority, self._outbox, kind)

    @contextlib.contextmanager
    def of(self, name: RunName, who: str, command: str, /, **arguments: object) -> Iterator[None]:
        """Record a command before its effects, or with the reasons why it is refused."""
        value: Dict[str, object] = {
            **{k: _short(v) for k, v in arguments.items() if v != ""}, "command": command}
        zone = self._zones.get(name.zone)
        run = None if zone is None else zone.run
        place = self._outbox.place()
        try:
            if self._authority.closed:
                raise Refused([self._authority.closed])
            yield
        except Refused as refused:
            value["refused"] = [_short(reason) for reason in refused.reasons]
            raise
        finally:
            if run is None and zone is not None:
                run = zone.run  # connected just now
            identity = name.identity or ("" if run is None else run.identity)
            port = _only_port(run, identity)
            self._outbox.insert(place, effects.Recorded(
                name.zone[:MAX_NOTE], identity[:MAX_NOTE], port, self._kind, value, checked_who(who)
            ))


def _short(value: object) -> object:
    """Shorten a text that is recorded: a wrong name must not fill the disk."""
    return value[:MAX_NOTE] if isinstance(value, str) else value


def _only_port(run: Optional[ZoneRun], identity: str) -> Optional[int]:
    if run is None or run.identity != identity or len(run.members()) != 1:
        return None
    return run.members()[0].port


# Finished runs in the list of results: more than the runs of one day in any competition.
MAX_LISTED = 100
# Characters of the identity of a mark: more than a UUID has.
MAX_MARK_ID = 64
NAME_THE_RUN = say("name the run: what arrives late must not count in another run")
OTHER_ZONE = say("run {run} was in zone '{zone}', not in '{other}'")
OTHER_SHEET = say("the run was scored by the sheet of {code}: it can be moved to an event of {code} of one team. "
                  "Otherwise annul it, and enter the score at the right event ('Score without a robot')")
NO_ID = say("the event has no id: reload the configuration first, which writes it")
SAME_EVENT = say("the run belongs to this event already")
FULL = say("the team has had its {number} attempts at that event: annul one of them first")
STILL_CONNECTED = say("run {run} is still connected: disconnect it first")


class MarkOutcome(NamedTuple):
    """The result of a mark."""

    entry: int  # its number in the history; 0: it made no entry
    item: ItemRecord  # as it is now
    proposed: int = 0  # number of the proposal, if it arrived after the sign-off; 0: it is none


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

    def record_of(self, now: Now, name: RunName, event_id: str = "") -> RunRecord:
        """Return the record of a run; of a zone without a run, one with the empty sheet of its event. `event_id`: that
        of another event of the zone, whose empty sheet is meant. Raises `Refused`."""
        zone = self._zones.named(name.zone)
        if event_id or (not name.identity and zone.run is None):
            place = zone.place_named(event_id) if event_id else zone.index
            if place is None:
                raise Refused([NO_EVENT(zone=zone.name, event=event_id)])
            event = zone.events[place]
            return RunBook(event.benchmark.form).into(RunRecord("", name.zone, *key_of(event)[:5], 0.0, event=event.id))
        run = self.named(name)
        return run.record if isinstance(run, FinishedRun) else run.record(now)

    def waiting(self) -> List[Union[ZoneRun, FinishedRun]]:
        """Return the runs in the zones, in their order, then the newest finished runs that are not signed off, or have
        an objection to answer."""
        finished = [run for run in self._finished.newest_runs(MAX_LISTED) if run.record.open_objections
                    or (run.record.sign_off is None and not run.record.is_annulled)]
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
        run = self.named(name)
        proposed = (each.number for each in run.book.state.proposals if mark.id and each.mark_id == mark.id)
        return MarkOutcome(run.sheet.taken(mark.id) or 0, run.sheet.item(mark.group, mark.desc), next(proposed, 0))

    def withdraw(self, now: Now, name: RunName, number: int, who: str = "", note: str = "") -> None:
        """Withdraw an entry of a score sheet. The other entries do not change. Raises `Refused`."""
        by = By(checked_who(who), checked_note(note))
        run = self.named(name)
        self.report_correction(run, run.withdraw_score(now, by, number))

    def in_time(self, now: Now, name: RunName, number: int, in_time: bool, who: str = "") -> None:
        """Say whether what an entry of a score sheet marks was seen before the time limit. Raises `Refused`."""
        by = By(checked_who(who))
        run = self.named(name)
        self.report_correction(run, run.say_in_time(now, by, number, in_time))

    def take_back(
        self, now: Now, name: RunName, mark_id: str, who: str = "", note: str = "", ago_ms: int = 0
    ) -> None:
        """Take back a mark that set an item, once, however often this arrives. Raises `Refused`."""
        if not name.identity:
            raise Refused([NAME_THE_RUN])
        by = By(checked_who(who), checked_note(note))
        run = self.named(name)
        self.report_correction(run, run.take_back(now, by, mark_id, ago_ms))

    def captain(self, now: Now, name: RunName, sign: CaptainSign) -> None:
        """Take the captain's signature, or the refusal to sign. Raises `Refused`."""
        run = self.over_named(name)
        self.report_correction(run, run.take_captain(sign._replace(
            name=checked_who(sign.name), comment=checked_note(sign.comment), who=checked_who(sign.who))))

    def decide(self, now: Now, name: RunName, number: int, accept: bool, reason: str, who: str = "") -> None:
        """Accept or drop a mark that arrived after the sign-off. Raises `Refused`."""
        run, by = self.over_named(name), By(checked_who(who), checked_note(reason))
        self.report_correction(run, run.decide(now, by, number, accept))

    def annul(self, now: Now, name: RunName, by: By) -> None:
        """Let a run count nothing. Raises `Refused`, as the next ones."""
        run = self.over_named(name)
        self.report_correction(run, run.annul(now, _checked(by)))

    def move(self, now: Now, name: RunName, event_id: str, by: By) -> None:
        """Let a run belong to another event of its benchmark: of another team, round or time."""
        run, found = self.over_named(name), self._zones.event_named(event_id)
        record = run.record
        if found is None:
            raise Refused([NO_EVENT(zone=name.zone, event=event_id)])
        zone, event = found
        if event.benchmark.code != record.benchmark or event.team == ALL_TEAMS:
            raise Refused([OTHER_SHEET(code=record.benchmark)])
        if not event.id and zone != record.zone:
            raise Refused([NO_ID])
        slot = Slot(event.team, event.round, event.run, event.scheduled, event.id)
        if record.slot == slot:
            raise Refused([SAME_EVENT])
        there = record._replace(**slot._asdict(), changes=())
        attempts = [each for each in [*self._finished.records(), *(own.record(now) for own in self._zones.runs())]
                    if each.started_utc and not each.is_annulled and attempts_key(each) == attempts_key(there)]
        most = event.benchmark.rules.attempts
        if most and record.started_utc and not record.is_annulled and len(attempts) >= most:
            raise Refused([FULL(number=most)])
        self.report_correction(run, run.move(now, _checked(by), slot))

    def reopen(self, now: Now, name: RunName, by: By) -> None:
        """Let a signed sheet be corrected."""
        run = self.over_named(name)
        self.report_correction(run, run.reopen(now, _checked(by)))

    def undo(self, now: Now, name: RunName, by: By) -> None:
        """Take the last of these back."""
        run = self.over_named(name)
        self.report_correction(run, run.undo(now, _checked(by)))

    def over_named(self, name: RunName) -> FinishedRun:
        """Return the run of that name, which was left. Raises `Refused`."""
        run = self.named(name)
        if not isinstance(run, FinishedRun):
            raise Refused([STILL_CONNECTED(run=run.identity)])
        return run

    def note(self, now: Now, name: RunName, note: Note, who: str = "") -> None:
        """Note a moment of a run, or enter the text of a note. Raises `Refused`. A note with an identity names its run,
        and is made once, as a mark."""
        if note.id:
            if not name.identity:
                raise Refused([NAME_THE_RUN])
            check_mark_id(note.id)
        note = note._replace(text=checked_note(note.text), device=checked_who(note.device))
        run = self.named(name)
        self.report_correction(run, run.note(now, checked_who(who), note))

    def give_stop_reason(self, now: Now, name: RunName, reason: str, who: str = "", number: int = 0) -> None:
        """Set why a run was stopped, until it is signed off; see `RunBook.give_reason`. Raises `Refused`."""
        by = By(checked_who(who), checked_note(reason))
        run = self.named(name)
        self.report_correction(run, run.give_stop_reason(now, by, number))

    def sign_off(self, now: Now, name: RunName, who: str = "") -> None:
        """Make the score sheet of a finished run final. Raises `Refused`."""
        if not name.identity:
            raise Refused([say("name the run to sign off: only a run that is over can be signed off")])
        run = self.over_named(name)
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


def _checked(by: By) -> By:
    return By(checked_who(by.who), checked_note(by.reason))


def check_mark_id(mark_id: str) -> None:
    """Check the identity of a mark; raises `Refused`."""
    if not mark_id.strip() or not mark_id.isprintable() or len(mark_id) > MAX_MARK_ID:
        raise Refused([say("the id '{id}' cannot identify a mark: give each mark a new UUID")(
            id=mark_id[:MAX_MARK_ID])])


class RunJudging(NamedTuple):
    """What a judge or the head referee may see of a run's judges now."""

    record: RunRecord  # has the sheets of all judges: show those of others only if `is_complete`
    # Judges that the benchmark asks for; 0: it has no judges with sheets of their own.
    count: int  # type: ignore[assignment] # it hides tuple.count, which nobody calls
    agreement: str
    missing: int
    is_complete: bool
    verdicts: Tuple[ItemVerdict, ...]  # empty: not complete
    active: Tuple[JudgeSheet, ...]  # the sheets that were not withdrawn, by the judges' names
    own: Optional[JudgeSheet]
    own_items: Tuple[ItemRecord, ...]
    own_form: Optional[SheetForm]  # of these items


class JudgeDesk:
    """Takes what judges and the head referee enter. Each run is named by its identity. `Entries` checks and records it
    first."""

    def __init__(self, scores: ScoreDesk, outbox: Outbox) -> None:
        self._scores = scores
        self._outbox = outbox

    # -- looking ------------------------------------------------------------------------------------

    def judging(self, now: Now, name: RunName, judge: str = "") -> RunJudging:
        """Return the judging of a run, with the sheet of `judge` (empty: of nobody). Raises `Refused`."""
        return self._judging(now, self._scores.named(name), checked_who(judge))

    def waiting(self, now: Now) -> List[RunJudging]:
        """Return the judging of all runs that wait (`ScoreDesk.waiting`), and have judges, a published result, rules
        that ask for one, or an objection."""
        return [self._judging(now, run) for run in self._scores.waiting()
                if run.book.judges.rule is not None or run.book.form.objection_time
                or run.book.publication.state != PublicationState()]

    def _judging(self, now: Now, run: Union[ZoneRun, FinishedRun], judge: str = "") -> RunJudging:
        judges = run.book.judges
        rule = judges.rule
        has_own = rule is not None and bool(judge)
        return RunJudging(
            run.record if isinstance(run, FinishedRun) else run.record(now), 0 if rule is None else rule.count,
            "" if rule is None else rule.agreement.value, judges.missing(), judges.is_complete(), judges.verdicts(),
            judges.active(), judges.own_sheet(judge) if has_own else None, judges.own_items(judge) if has_own else (),
            judges.own_form(judge) if has_own else None,
        )

    # -- judges -------------------------------------------------------------------------------------

    def mark(self, now: Now, name: RunName, mark: Mark, judge: str) -> None:
        """Mark an item on a judge's own sheet, unless this mark was applied before. Raises `Refused`."""
        check_mark_id(mark.id)
        judge, note = checked_who(judge), checked_note(mark.note)
        marked = mark._replace(note=note, device=checked_who(mark.device), role="judge")
        if not self.is_applied(name, mark, judge):
            self._change(now, name, lambda book: _silent(book.judges.mark(now, judge, marked)))

    def is_applied(self, name: RunName, mark: Mark, judge: str) -> bool:
        """Whether a mark was applied before, which is no error even after the sign-off. Raises `Refused`."""
        return bool(name.identity) and self._scores.named(name).book.judges.is_applied(checked_who(judge), mark)

    def outcome(self, name: RunName, mark: Mark, judge: str) -> MarkOutcome:
        """Return the result of a mark that was applied. Raises `Refused`."""
        return MarkOutcome(*self._scores.named(name).book.judges.outcome(checked_who(judge), mark))

    def submit(self, now: Now, name: RunName, judge: str, device: str = "") -> None:
        """Submit a judge's sheet. Raises `Refused`."""
        named, device = checked_who(judge), checked_who(device)
        if not self._named(name).book.judges.is_submitted(named):
            self._change(now, name, lambda book: book.judges.submit(now, named, device))

    # -- the head referee ---------------------------------------------------------------------------

    def hand_back(self, now: Now, name: RunName, judge: str, reason: str, who: str = "") -> None:
        """Hand a judge's sheet back, so that the judge looks again. Raises `Refused`."""
        by = By(checked_who(who), checked_note(reason))
        self._change(now, name, lambda book: book.judges.hand_back(now, by, checked_who(judge)))

    def withdraw(self, now: Now, name: RunName, judge: str, reason: str, who: str = "") -> None:
        """Withdraw a judge's sheet. Raises `Refused`."""
        by = By(checked_who(who), checked_note(reason))
        self._change(now, name, lambda book: book.judges.withdraw(now, by, checked_who(judge)))

    def waive(self, now: Now, name: RunName, reason: str, who: str = "") -> None:
        """Do not wait for missing judges. Raises `Refused`."""
        by = By(checked_who(who), checked_note(reason))
        self._change(now, name, lambda book: book.judges.waive(now, by))

    def settle(self, now: Now, name: RunName, mark: Mark, reason: str, who: str = "") -> None:
        """Settle an item with a value and a reason. Raises `Refused`."""
        by = By(checked_who(who), checked_note(reason))
        self._change(now, name, lambda book: book.judges.settle(now, by, mark))

    # -- publication --------------------------------------------------------------------------------

    def publish(self, now: Now, name: RunName, seconds: float = -1.0, who: str = "") -> None:
        """Publish the result of a finished run as provisional. `seconds`: as in `Publication`. Raises `Refused`."""
        by = By(checked_who(who))
        self._over_named(name)
        self._change(now, name, lambda book: book.publication.publish(now, by, seconds))

    def object(self, now: Now, name: RunName, by: str, text: str, who: str = "", second: int = 0) -> None:
        """Enter an objection. Raises `Refused`."""
        run = self._over_named(name)
        self._scores.report_correction(run, run.object(now, checked_who(who), checked_who(by), checked_note(text),
                                                       second))

    def answer(self, now: Now, name: RunName, number: int, upheld: bool, text: str, who: str = "") -> None:
        """Answer an objection. Raises `Refused`."""
        run = self._over_named(name)
        self._scores.report_correction(run, run.answer(now, By(checked_who(who), checked_note(text)), number, upheld))

    # -- inside -------------------------------------------------------------------------------------

    def _over_named(self, name: RunName) -> FinishedRun:
        if not name.identity:
            raise Refused([NAME_THE_RUN])
        return self._scores.over_named(name)

    def _named(self, name: RunName) -> Union[ZoneRun, FinishedRun]:
        if not name.identity:
            raise Refused([NAME_THE_RUN])
        return self._scores.named(name)

    def _change(self, now: Now, name: RunName, change: Callable[[RunBook], str]) -> None:
        run = self._named(name)
        text = run.change_book(now, change)
        if isinstance(run, FinishedRun):
            if text:
                self._scores.report_correction(run, text)
            else:
                self._outbox.emit(effects.RecordChanged(run.record))


def _silent(_item: ItemRecord) -> str:
    """Return no text for the log, because others must not read what a judge marks."""
    return ""


class ModuleDesk:
    """Takes the modules' messages about functionality runs."""

    def __init__(self, tick: Callable[[Now], None], zones: Zones, modules: Modules, authority: Authority) -> None:
        """`tick` does what is due by now. Every event calls it first."""
        self._tick = tick
        self._zones = zones
        self._modules = modules
        self._authority = authority

    def on_modules(self, now: Now, state: ModulesState) -> None:
        """A node of benchmarking modules reports its benchmarks and its progress in runs."""
        if self._modules.is_repetition(now, state) and not self._functionality_runs():
            self._modules.hear(now, state)  # twice a second, and nothing happens in the box
            return
        self._tick(now)
        if self._authority.closed:
            return
        self._modules.hear(now, state)
        self._update_runs(now)

    def runs(self) -> Tuple[RunForModule, ...]:
        """Return what benchmarking modules need to know of the functionality runs."""
        return tuple(run.for_module() for run in self._functionality_runs())

    def deadline(self) -> Optional[float]:
        """Monotonic time (s) at which `tick` has something to do; None: never."""
        return self._modules.deadline()

    def tick(self, now: Now) -> None:
        """Pause the runs whose node is missing by now. Earlier events come first."""
        due = self._modules.deadline()
        while due is not None and due <= now.mono:
            then = Now(due, now.utc + (due - now.mono))
            for run in self._zones.runs():
                run.tick(then)
            self._modules.forget_gone(then)
            self._update_runs(then)
            due = self._modules.deadline()

    def _functionality_runs(self) -> List[FunctionalityRun]:
        return [run for run in self._zones.members() if isinstance(run, FunctionalityRun)]

    def _update_runs(self, now: Now) -> None:
        for run in self._functionality_runs():
            run.on_modules(now)
