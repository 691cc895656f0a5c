"""Connects the core with its journal: turns effects into batches, and saved batches into a resumed box.

The changes of an event are in the journal before any of its effects but STOP leave the box (docs/architecture.md,
"Write first, then act"). In the step of the loop in which STOP leaves, a note of it goes to the supervisor and to the
standby; nothing waits for them. A core that is started again reads the notes of the supervisor, a standby that takes
over those that it has heard. Otherwise a crash before the record would leave a journal that says "running", and the
next box would let the robot prepare again.
"""

import json
from typing import Any, Callable, Collection, Dict, List, Mapping, NamedTuple, Optional, Protocol, Sequence, Set, Tuple

from roah_rsbb.core import effects
from roah_rsbb.core.box import Box
from roah_rsbb.core.continuing import BoxSaved, Saved
from roah_rsbb.core.effects import BOX, Effect, Level
from roah_rsbb.core.runs.run import UnrecordedStop
from roah_rsbb.core.views.document import clock_of
from roah_rsbb.core.zones import ZoneState, key_of
from roah_rsbb.ground.signs_of_life import CHANNEL
from roah_rsbb.journal.contents import superseded_value
from roah_rsbb.journal.log_dir import PreviousSession
from roah_rsbb.journal.records import Batch, ChangesWriter, Kind, LinkRow, Member, NewEntry, OutcomeRow, RunRow
from roah_rsbb.journal.store import Journal
from roah_rsbb.model import run_log
from roah_rsbb.model.as_json import BadData, from_json, to_json
from roah_rsbb.model.clock import Anchor, Now
from roah_rsbb.model.fields import MAX_TEXT
from roah_rsbb.model.records import By, EndReason, RunRecord
from roah_rsbb.model.results import UnsavedParts
from roah_rsbb.model.zone import RunClock
from roah_rsbb.rulebook.config import Config
from roah_rsbb.scoring.unsaved import Unsaved
from roah_rsbb.standby.beside_copy import NOT_MEASURED, Ahead

# Before the identity of the run, in the names of the notes.
PREFIX = "stop/"
# Characters of who stopped a run, in a note.
MOST_WHO = 200

BOX_STATE = "box"
ZONE_STATE = "zone:"


class _Place(NamedTuple):
    """The zone and the run to which a private port belongs."""

    zone: str
    identity: str


class _Written(NamedTuple):
    """The states of a run that are in the journal."""

    identity: str
    changes: ChangesWriter


def competition(config: Config) -> List[Any]:
    """Return what identifies a competition: its events, in the words of journals before ids."""
    return [[zone.name, *key_of(event)[:5]] for zone in config.zones for event in zone.events]


class CoreJournal:
    """Records what the box does."""

    def __init__(self, box: Box, journal: Journal) -> None:
        self._box = box
        self._journal = journal
        self._places: Dict[int, _Place] = {}
        self._batch = Batch()
        self._written: Dict[str, _Written] = {}  # by zone
        self._records: List[RunRecord] = []
        self._unsaved = Unsaved()
        self._ticket = 0
        self._is_lost = False
        self._takers: Dict[type, Callable[[Now, Any], None]] = {
            effects.RunOpened: self._opened,
            effects.SheetOpened: self._sheet_opened,
            effects.RunResumed: self._resumed,
            effects.RunLogged: self._logged,
            effects.RunClosed: self._closed,
            effects.AimChannel: self._aimed,
            effects.TimeoutRung: self._rung,
            effects.Superseded: self._superseded,
            effects.Notice: self._noticed,
            effects.Recorded: self._recorded,
            effects.RecordChanged: self._record_changed,
        }

    def on_written(self, call: Callable[[], object]) -> None:
        """Set what is called, in another thread, when the disk takes data again: see `is_waiting`."""
        self._journal.on_written = call

    def is_waiting(self, ticket: int) -> bool:
        """Whether the disk hangs and has not taken this record yet."""
        return self._journal.is_waiting(ticket)

    def record(self, now: Now, todo: Sequence[Effect]) -> int:
        """Write the changes of an event; `todo` are its effects, before they are carried out. Returns the ticket of the
        record; 0: there is nothing to record."""
        for effect in todo:
            taker = self._takers.get(type(effect))
            if taker is not None:
                taker(now, effect)
        changed = self._box.outbox.take_changed()
        for name in sorted(changed):
            self._state_changed(now, name)
        if self._batch.is_empty():
            return 0
        batch, self._batch = self._batch, Batch()
        records, self._records = self._records, []
        self._ticket = self._journal.write(batch)
        for record in records:
            self._unsaved.changed(now.mono, self._ticket, record)
        return self._ticket

    @property
    def next_ticket(self) -> int:
        """The ticket of the next record."""
        return self._journal.next_ticket

    def end_of(self, port: int, todo: Sequence[Effect]) -> Optional[RunRecord]:
        """Return the record of the run of a robot if the run ends with these effects of an event."""
        identity = self.place(port).identity
        found = [effect.record for effect in todo
                 if isinstance(effect, effects.RecordChanged) and effect.record.identity == identity]
        return found[-1] if found and found[-1].end_reason and found[-1].stops else None

    def lost(self) -> None:
        """Note that an internal error prevented a record."""
        self._is_lost = True

    def ticket(self) -> Optional[int]:
        """The ticket of the newest record (`Journal.why_not_saved`); None: an internal error prevented a record since
        the last call."""
        lost, self._is_lost = self._is_lost, False
        return None if lost else self._ticket

    def unsaved(self, now: Now, saved: Callable[[int], int] = lambda ticket: ticket) -> Tuple[UnsavedParts, ...]:
        """Return the parts of the runs' records that have been waiting for the disk for a while. `saved` returns the
        newest ticket that needs no other disk, of those up to its argument."""
        return self._unsaved.look(now.mono, saved(self._journal.saved))

    def restore(self, records: Sequence[RunRecord]) -> None:
        """Take the records that were in the journal at the start."""
        self._unsaved.restore(records)

    def log_file(self, port: int, path: str) -> None:
        """Record the path of a robot's run log."""
        self._journal.write(Batch(log_files={port: path}))

    def log_file_before(self, port: int) -> str:
        """The path of a robot's run log before the restart; empty if unknown."""
        return self._journal.previous.log_files.get(port, "")

    def each_second(self, now: Now, unreadable: Mapping[int, int]) -> None:
        """Call this once a second: writes the link records and waiting data.

        `unreadable`: see `Zones.link_samples`.
        """
        samples = self._box.zones.link_samples(now, unreadable)
        if samples:
            self._journal.write(Batch(links=[
                LinkRow(port, now.utc, now.mono, to_json(sample)) for port, sample in samples
            ]))
        self._journal.look()

    # -- effects ------------------------------------------------------------------------------------

    def _state_changed(self, now: Now, name: str) -> None:
        """Write a state for a restart, and how it changed for replays."""
        if name == BOX:
            self._batch.states[BOX_STATE] = to_json(self._box.restart.saved())
            return
        zone = self._box.zones.get(name)
        if zone is None:  # it was removed
            return
        state = to_json(zone.saved())
        self._batch.states[ZONE_STATE + name] = state
        if zone.run is None:
            self._written.pop(name, None)
            return
        written = self._written.get(name)
        if written is None or written.identity != zone.run.identity:
            written = self._written[name] = _Written(zone.run.identity, ChangesWriter())
        clock = _clock_value(clock_of(zone.run, zone.event.benchmark, now), now.mono)
        change = written.changes.entry({"zone": state, "clock": clock})
        if change is not None:
            self._add(now, _Place(name, written.identity), None, "", Kind.STATE, change)

    def place(self, port: int) -> _Place:
        """Return where the run of a robot is; its names are empty: there is none."""
        return self._places.get(port, _Place("", ""))

    def _add(self, now: Now, place: _Place, port: Any, who: str, kind: str, value: object) -> None:
        self._batch.entries.append(
            NewEntry(now.utc, now.mono, place.zone, place.identity, port, who, kind, value))

    def _opened(self, _now: Now, effect: effects.RunOpened) -> None:
        self._find_place(effect.port)
        run = self._box.zones.run_at(effect.port)
        whole = self._box.zones[run.zone].run
        self._batch.runs.append(RunRow(whole.identity, run.zone, *key_of(whole.event)[:5], whole.opened_utc))
        self._batch.members.append(Member(effect.port, whole.identity, run.robot.team, run.robot.robot))

    def _sheet_opened(self, _now: Now, effect: effects.SheetOpened) -> None:
        r = effect.record
        self._batch.runs.append(
            RunRow(r.identity, r.zone, r.benchmark, r.team, r.round, r.run, r.scheduled, r.opened_utc))

    def _resumed(self, _now: Now, effect: effects.RunResumed) -> None:
        self._find_place(effect.port)

    def _find_place(self, port: int) -> None:
        """Assign later entries of a port to the run that begins or resumes, even after its end."""
        self._places[port] = self._place_of_zone(self._box.zones.run_at(port).zone)

    def _place_of_zone(self, zone: str) -> _Place:
        run = self._box.zones[zone].run
        return _Place(zone, "" if run is None else run.identity)

    def _logged(self, now: Now, effect: effects.RunLogged) -> None:
        who = ""
        if effect.topic in run_log.FROM_ROBOT:
            run = self._box.zones.run_at(effect.port)
            who = "" if run is None else run.link.host or ""
        self._add(now, self.place(effect.port), effect.port, who, effect.topic, effect.value)

    def _closed(self, _now: Now, effect: effects.RunClosed) -> None:
        self._places.pop(effect.port, None)

    def _aimed(self, now: Now, effect: effects.AimChannel) -> None:
        self._add(now, self.place(effect.port), effect.port, effect.host, Kind.ADDRESS, effect.host)

    def _rung(self, now: Now, effect: effects.TimeoutRung) -> None:
        self._add(now, self._place_of_zone(effect.zone), None, "", Kind.TIMEOUT, None)

    def _noticed(self, now: Now, effect: effects.Notice) -> None:
        if effect.zone and effect.level >= Level.WARNING:
            said = {"level": effect.level.name, "text": effect.text}
            self._add(now, self._place_of_zone(effect.zone), None, "", Kind.NOTICE, said)

    def _superseded(self, now: Now, effect: effects.Superseded) -> None:
        self._add(now, _Place("", ""), None, effect.by, Kind.EPOCH,
                  superseded_value(effect.epoch, effect.cut, effect.by))

    def _recorded(self, now: Now, effect: effects.Recorded) -> None:
        self._add(now, _Place(effect.zone, effect.identity), effect.port, effect.who, effect.kind, effect.value)

    def _record_changed(self, _now: Now, effect: effects.RecordChanged) -> None:
        record = effect.record
        self._batch.outcomes[record.identity] = OutcomeRow(record.closed_utc or None, to_json(record))
        self._records.append(record)


def saved_state(
    before: PreviousSession, now: Now, boot: str, ahead_of: Callable[[str], Ahead] = lambda boot: NOT_MEASURED,
    stops: Mapping[str, str] = {},
) -> Tuple[Saved, List[str]]:
    """The state from which the box resumes, and warnings about unreadable parts.

    `ahead_of` returns how far the clocks of this computer are ahead of those of a boot of the computer before.
    `stops`: what is known of STOPs of the box before, which its journal may not have (`box/stops.py`).
    """
    def here(anchor: Anchor) -> Anchor:
        return anchor._replace(utc=anchor.utc + ahead_of(anchor.boot).utc_s)

    def shift_of(anchor: Anchor) -> float:
        if last is not None and anchor.boot == last.boot:
            return shift  # as the times in the states
        return here(anchor).shift(now, boot, ahead_of(anchor.boot).mono_s)
    warnings: List[str] = []
    last = None if before.last is None else here(Anchor(before.last.mono, before.last.utc, before.last.boot_id))
    shift = 0.0 if last is None else last.shift(now, boot, ahead_of(last.boot).mono_s)
    box, zones, records = BoxSaved(), {}, []
    for name, state in before.states.items():
        try:
            if name == BOX_STATE:
                box = from_json(BoxSaved, state, shift)
            elif name.startswith(ZONE_STATE):
                zones[name[len(ZONE_STATE):]] = from_json(ZoneState, state, shift)
        except (BadData, ValueError, RecursionError) as error:
            what = "home devices and tablet" if name == BOX_STATE else f"zone {name[len(ZONE_STATE):]}"
            warnings.append(f"The journal's state of {what} cannot be read: {error}. It starts from its initial state")
    for outcome in before.outcomes:
        try:
            records.append(from_json(RunRecord, outcome))
        except (BadData, ValueError, RecursionError) as error:
            warnings.append(f"The journal's record of a run cannot be read, and cannot be corrected here: {error}")
    utc, mono = (now.utc, now.mono) if last is None else (last.utc, last.mono + shift)
    return Saved(utc, box, zones, tuple(records), mono=mono, stopped=unrecorded(stops, records, shift_of)), warnings


def _clock_value(clock: RunClock, mono: float) -> Dict[str, Any]:
    """Return the times of a run at a moment as JSON values, in seconds with three decimals, without those that are 0
    (docs/journal.md, "entries")."""
    values = {
        "limit": clock.limit, "elapsed": clock.spent(mono), "counting": clock.elapsed.counting,
        "paused": str(clock.paused), "goal_limit": clock.goal_limit, "goal": clock.goal,
        "goal_elapsed": clock.goal_spent(mono), "goal_counting": clock.goal_elapsed.counting,
        "after_stop": clock.after_stop(mono), "setup_limit": clock.setup_limit,
        "setup_elapsed": clock.setup_elapsed.at(mono), "setup_counting": clock.setup_elapsed.counting,
        "phases": clock.phases, "phase_number": clock.phase_number, "phase_name": clock.phase_name,
        "phase_limit": clock.phase_limit, "phase_elapsed": clock.phase_elapsed.at(mono),
    }
    return {name: round(value, 3) if isinstance(value, float) else value for name, value in values.items() if value}


# -- STOPs that left before their record ------------------------------------------------------------


class Memory(Protocol):
    """A small memory outside of this process: see `signs_of_life.Lifeline`. Nothing waits, and nothing raises."""

    kept: Mapping[str, str]  # what the core before had kept when it ended

    def keep(self, name: str, value: str) -> object:
        """Keep a text under this name."""

    def drop(self, name: str) -> object:
        """Keep it no longer."""

    def send(self) -> object:
        """Say that this process lives."""


class NoMemory:
    """Without a supervisor, nothing is kept."""

    kept: Mapping[str, str] = {}

    def keep(self, name: str, value: str) -> None:
        """Keep nothing."""

    def drop(self, name: str) -> None:
        """There is nothing."""

    def send(self) -> None:
        """Nobody listens."""


class ChannelNotes:
    """The open private channels, for a core that only sends STOP (`program/barest.py`)."""

    def __init__(self, memory: Memory) -> None:
        self._memory = memory
        self._noted = {name: memory.kept[name] for name in memory.kept if name.startswith(CHANNEL)}

    def look(self, channels: Mapping[int, Sequence[object]]) -> None:
        """Note what the channels are now, by port."""
        found = {f"{CHANNEL}{port}": json.dumps(channel) for port, channel in channels.items()}
        for name, value in found.items():
            if self._noted.get(name) != value:
                self._memory.keep(name, value)
        for name in self._noted.keys() - found.keys():
            self._memory.drop(name)
        self._noted = found


class _Note(NamedTuple):
    ticket: int  # of the record
    text: str


class StopNotes:
    """The notes of STOPs whose record is not on the disk. Call everything in the loop's thread."""

    def __init__(self, memory: Memory, inform_standby: Callable[[Mapping[str, str]], object], boot: str) -> None:
        """`inform_standby` passes texts of STOPs by the identity of the run to the standby, if there is one. An empty
        text withdraws the one before. `boot` identifies the start of this computer."""
        self._memory, self._inform_standby, self._boot = memory, inform_standby, boot
        self._notes: Dict[str, _Note] = {}  # by the identity of the run
        self._passed: Set[str] = set()  # the runs of those that the standby has, which keeps them
        self._again: Set[str] = set()  # of those, the runs that were started again
        self._earlier = [name for name in memory.kept if name.startswith(PREFIX)]
        for name in self._earlier:  # this core may end, too, before it has recorded them
            memory.keep(name, memory.kept[name])

    def before(self) -> Dict[str, str]:
        """The texts of the core before, by the identity of the run."""
        return {name[len(PREFIX):]: self._memory.kept[name] for name in self._earlier}

    def resumed(self, ticket: int) -> None:
        """The STOPs of the core before are in the journal with this ticket."""
        self._notes.update((identity, _Note(ticket, text)) for identity, text in self.before().items())
        self._passed.update(self._notes)

    def sent(self, now: Now, record: RunRecord, ticket: int) -> None:
        """STOP was sent `now` to a robot of a run, and is recorded next, with this ticket. `record`: what is."""
        stop = record.stops[-1]
        text = json.dumps([now.mono, stop.utc, stop.end_reason, stop.who[:MOST_WHO], stop.reason[:MAX_TEXT],
                           self._boot], ensure_ascii=False)
        self._notes[record.identity] = _Note(ticket, text)
        self._passed.add(record.identity)
        self._again.discard(record.identity)
        self._memory.keep(PREFIX + record.identity, text)
        self._inform_standby({record.identity: text})

    def starts(self, identity: str) -> None:
        """A robot of this run is sent something else now, because a referee started the run again: withdraw its note,
        as a full disk may have a record of neither."""
        if identity in self._passed:
            self._passed.discard(identity)
            self._again.add(identity)
            self._forget(identity)
            self._inform_standby({identity: ""})

    def look(self, saved: int, running: Callable[[], Collection[str]]) -> None:
        """Forget those whose record is on the disk: tickets up to `saved`. The standby hears the others again, and of
        each run that was started again, because its copy may lack that for longer: `running` returns the runs in
        progress."""
        for identity in [each for each, note in self._notes.items() if note.ticket <= saved]:
            self._forget(identity)
        if self._again:
            self._again.intersection_update(running())
        if self._notes or self._again:
            self._inform_standby({**dict.fromkeys(self._again, ""),
                                  **{identity: note.text for identity, note in self._notes.items()}})

    def _forget(self, identity: str) -> None:
        self._notes.pop(identity, None)
        self._memory.drop(PREFIX + identity)


def unrecorded(
    stops: Mapping[str, str], records: List[RunRecord], shift_of: Callable[[Anchor], float],
) -> Dict[str, UnrecordedStop]:
    """Return those of the texts of STOPs that no record has, and that came after the last start that a record has, by
    the identity of the run. `shift_of` returns by how many seconds a moment is moved on the monotonic clock: each
    note has the boot of its box, which may be another one than that of the journal's last record."""
    known = {record.identity: max([record.started_utc, *(stop.utc for stop in record.stops)]) for record in records}
    found: Dict[str, UnrecordedStop] = {}
    for identity, text in stops.items():
        try:
            mono, utc, reason, who, why, boot = json.loads(text)
            if utc > known.get(identity, 0.0):
                found[identity] = UnrecordedStop(
                    Now(mono + shift_of(Anchor(mono, utc, boot)), utc), EndReason[reason.upper()], By(who, why))
        except (ValueError, TypeError, KeyError, AttributeError, RecursionError):
            continue  # withdrawn, or of another version: the robot still gets nothing before a referee decides
    return found
