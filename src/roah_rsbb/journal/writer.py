"""Turns batches into records, and keeps what the journal contains. Nothing here opens, locks or repairs."""

from typing import Any, Optional, Sequence

from roah_rsbb.document.difference import SAME, difference
from roah_rsbb.journal import records
from roah_rsbb.journal.batch import Batch
from roah_rsbb.journal.changes import COMPLETE_EVERY, ChangesReader
from roah_rsbb.journal.contents import Opened
from roah_rsbb.journal.log import Files, Log
from roah_rsbb.journal.records import Lines, Top


class Writer:
    """Adds to one journal. Call all methods in one thread; `log.sync` may be called in another."""

    def __init__(self, folder: str, opened: Opened, files: Optional[Files] = None) -> None:
        """`opened`: what is in the folder."""
        self.contents = opened.contents
        self.log = Log(folder, self.contents.summary, self.contents.place, files)
        if opened.newest is not None:
            self.log.continue_after(opened.segments, opened.newest)

    def begin_session(self, session: Sequence[Any], competition: Any) -> None:
        """Add a start of the core."""
        self._add({records.SESSION: session, records.COMPETITION: competition}, len(self.contents.sessions) + 1)

    def set_competition(self, competition: Any) -> None:
        """Add a change of the schedule."""
        self._add({records.COMPETITION: competition}, len(self.contents.sessions))

    def add(self, batch: Batch, session: Optional[int] = None) -> None:
        """Add the changes of an event. `session`: its number, if it is not the newest one. Raises TypeError or
        ValueError for what is not JSON; then an empty record is added."""
        contents = self.contents
        lines = records.lines_of(batch, contents.entry)
        states = {name: self._change(name, state) for name, state in batch.states.items()}
        states = {name: change for name, change in states.items() if change is not None}
        if states:
            lines[records.STATES] = states
        self._add(lines, len(contents.sessions) if session is None else session)

    def _add(self, lines: Lines, session: int) -> None:
        contents = self.contents
        utc, mono = records.time_of(lines) or (contents.utc, contents.last[0])
        entry = contents.entry + sum(len(lines.get(letter, ())) for letter in records.OF_ENTRIES)
        top = Top(utc, mono, session, entry, "".join(lines), records.identities_of(lines, contents.run_of.get))
        try:
            payload = records.encode(top, lines)
        except (TypeError, ValueError, RecursionError):
            self.log.append(records.encode(Top(utc, mono, session, contents.entry, "", ()), {}))
            raise
        with self.log.lock:
            self.log.append(payload)
            contents.take(top, lines.get)

    def _change(self, name: str, state: Any) -> Any:
        """Return how a state changed since the journal has it; None: it did not."""
        known = self.contents.states.get(name, ChangesReader())
        is_due = known.state is None or known.number % COMPLETE_EVERY == 0
        change = [state] if is_due else difference(known.state, state)
        return None if change is SAME else {"number": known.number + 1, "change": change}
