"""What one reader of live data is sent. No I/O.

A reader that is slow gets the newest documents when it can take them, and never those that were replaced meanwhile. So
no queue grows, however slow it is.
"""

from typing import Dict, List, Optional

from roah_rsbb.web.numbered import Key, Made, Numbered


class Viewer:
    """A reader of some documents. Ask `next` for a message only when the one before is sent."""

    def __init__(self, store: Numbered, keys: List[Key]) -> None:
        self._store = store
        self._keys = keys
        self._sent: Optional[Dict[Key, int]] = None  # the number of each document; None: nothing was sent
        self._beat_is_due = False

    def beat(self) -> None:
        """The reader is to be sent the clock."""
        self._beat_is_due = True

    def next(self, made: Optional[Made] = None) -> Optional[str]:
        """Return the next message; None: nothing is to be sent. `made`: what other readers were sent at this moment."""
        made = {} if made is None else made
        numbers = {key: self._store.document(key).number for key in self._keys}
        if self._sent is None:
            self._sent = numbers
            return self._store.message("snapshot", self._keys, made)
        if self._sent != numbers:
            changed = [key for key in self._keys if self._sent[key] != numbers[key]]
            self._sent = numbers
            return self._store.message("change", changed, made)
        if self._beat_is_due:
            self._beat_is_due = False
            return self._store.beat(self._keys, made)
        return None
