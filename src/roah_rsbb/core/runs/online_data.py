"""Online data: strings that a robot keeps sending until they are acknowledged.

The box logs a string once; it logs the same text again only after a message that did not contain it
came in between (docs/protocol.md, "Repeated strings"). Only fresh messages may be put in.
"""

from typing import FrozenSet, Iterable, List, Tuple

from roah_rsbb.core.budget import Budget
from roah_rsbb.core.clock import Now


class RepeatedStrings:
    """One field of repeated strings of one robot on one channel."""

    def __init__(self) -> None:
        self._last: FrozenSet[str] = frozenset()

    def saved(self) -> Tuple[str, ...]:
        """The state for the journal."""
        return tuple(sorted(self._last))

    def restore(self, state: Tuple[str, ...]) -> None:
        """What was received before a restart is not new after it."""
        self._last = frozenset(state)

    def receive(self, texts: Iterable[str]) -> List[str]:
        """Take one message's strings; return those that are new, in their order."""
        unique = dict.fromkeys(texts)
        new = [text for text in unique if text not in self._last]
        self._last = frozenset(unique)
        return new


class StringsBudget:
    """How many new strings of one robot are logged: each is an entry of the run log and of the journal.

    A robot has something to say a few times a minute. One that says something new all the time would fill the disk
    and hold up the other zones.
    """

    STRINGS_AT_ONCE, STRINGS_PER_SECOND = 500, 50
    CHARACTERS_AT_ONCE, CHARACTERS_PER_SECOND = 50_000, 5_000

    def __init__(self) -> None:
        self._strings = Budget(self.STRINGS_AT_ONCE, self.STRINGS_PER_SECOND)
        self._characters = Budget(self.CHARACTERS_AT_ONCE, self.CHARACTERS_PER_SECOND)

    def take(self, now: Now, text: str) -> bool:
        """Whether this string is logged."""
        return self._strings.take(now.mono, 1) and self._characters.take(now.mono, len(text))


class DisplayText:
    """Lines for a panel, of which only the last characters are kept (`display_log_size`)."""

    def __init__(self, size: int) -> None:
        self._size = size
        self.text = ""

    def add(self, line: str) -> None:
        """Append a line; what no longer fits goes, a whole line at a time where possible."""
        text = f"{self.text}{line}\n"
        start = max(0, len(text) - self._size)
        if start > 0 and text[start - 1] != "\n":
            next_line = text.index("\n", start) + 1
            # The line itself may be longer than everything: then its end is kept.
            start = next_line if next_line < len(text) else start
        self.text = text[start:]
