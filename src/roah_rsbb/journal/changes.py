"""The states of a run in the journal: small entries record how a large state changes (`document/difference.py`)."""

from typing import Any, Dict, Optional

from roah_rsbb.document.difference import SAME, changed, difference

# A complete state follows after this many differences, so that a damaged entry hides no more than these.
COMPLETE_EVERY = 200


class ChangesWriter:
    """Makes the entries of one run's states: a complete state, then differences (docs/journal.md, "entries")."""

    def __init__(self) -> None:
        self._number = 0
        self._last: Any = None

    def entry(self, state: Any) -> Optional[Dict[str, Any]]:
        """Return the value of the next entry; None: the state is the same as in the last one."""
        change = [state] if self._number % COMPLETE_EVERY == 0 else difference(self._last, state)
        if change is SAME:
            return None
        self._number += 1
        self._last = state
        return {"number": self._number, "change": change}


class ChangesReader:
    """Follows the states of one run. After a damaged or missing entry, it waits for the next complete state."""

    def __init__(self, number: int = 0, state: Any = None) -> None:
        self.number = number  # of the last entry
        self.state = state  # None: not known

    def take(self, value: Any) -> Any:
        """Take the value of the next entry; returns the state; None: it is not known."""
        try:
            number, change = value["number"], value["change"]
            is_complete = isinstance(change, list) and len(change) == 1
            is_next = number == self.number + 1 and self.state is not None
            self.state = changed(self.state, change) if is_next or is_complete else None
            self.number = number
        except (TypeError, KeyError, ValueError):
            self.state = None
        return self.state
