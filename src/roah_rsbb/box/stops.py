"""STOPs that left before their record was written: what the next box must know of them.

In the step of the loop in which STOP leaves, a note of it goes to the supervisor and to the standby; nothing waits for
them. A core that is started again reads the notes of the supervisor, a standby that takes over those that it has heard.
Otherwise a crash before the record would leave a journal that says "running", and the next box would let the robot
prepare again.
"""

import json
from typing import Callable, Collection, Dict, List, Mapping, NamedTuple, Protocol, Sequence, Set

from roah_rsbb.core.runs.run import UnrecordedStop
from roah_rsbb.ground.signs_of_life import CHANNEL
from roah_rsbb.model.clock import Now
from roah_rsbb.model.fields import MAX_TEXT
from roah_rsbb.model.records import By, EndReason, RunRecord
from roah_rsbb.model.saved import Anchor

# Before the identity of the run, in the names of the notes.
PREFIX = "stop/"
# Characters of who stopped a run, in a note.
MOST_WHO = 200


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
