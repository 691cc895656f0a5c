"""Online data (strings that a robot sends until they are acknowledged), and the lines of logs for panels.

The box logs a string once. It logs the same text again only if a message without it came in between (docs/protocol.md,
"Repeated strings").
"""

from typing import Dict, List, NamedTuple, Sequence, Tuple

from roah_rsbb.core.budget import Budget
from roah_rsbb.model.clock import Now
from roah_rsbb.wording.texts import escaped

# The texts of the last message, by the name of the repeated field.
Strings = Dict[str, Tuple[str, ...]]


def receive(last: Strings, field: str, texts: Sequence[str]) -> List[str]:
    """Put the texts of one field of a fresh message into `last`. Return the new ones, in their order."""
    if not texts:
        last.pop(field, None)
        return []
    unique = dict.fromkeys(texts)
    before = frozenset(last.get(field, ()))
    last[field] = tuple(unique)
    return [text for text in unique if text not in before]


class Said(NamedTuple):
    """What a robot said, for spectators."""

    utc: float
    kind: str  # the name of the repeated field
    text: str  # one line, shortened


# Spectators read the newest ones.
MAX_SAID = 5
_MAX_SAID_SIGNS = 160


def said(now: Now, kind: str, text: str) -> Said:
    """Return a robot's text as spectators may read it: one line without control characters, and short."""
    line = " ".join("".join(sign if sign.isprintable() else " " for sign in text).split())
    return Said(now.utc, kind, line if len(line) <= _MAX_SAID_SIGNS else f"{line[:_MAX_SAID_SIGNS - 1].rstrip()}…")


class StringsBudget:
    """Limits the new strings of one robot that are logged. Each is an entry of the run log and of the journal.

    A robot normally sends something new a few times a minute. A robot that always sends something new would fill the
    disk and delay the other zones.
    """

    STRINGS_AT_ONCE, STRINGS_PER_SECOND = 500, 50
    CHARACTERS_AT_ONCE, CHARACTERS_PER_SECOND = 50_000, 5_000

    def __init__(self) -> None:
        self._strings = Budget(self.STRINGS_AT_ONCE, self.STRINGS_PER_SECOND)
        self._characters = Budget(self.CHARACTERS_AT_ONCE, self.CHARACTERS_PER_SECOND)

    def take(self, now: Now, text: str) -> bool:
        """Whether to log this string."""
        return self._strings.take(now.mono, 1) and self._characters.take(now.mono, len(text))


def with_line(text: str, line: str, size: int) -> str:
    """Add a line to a text, of which only the last `size` characters are kept (`display_log_size`).

    Whole lines are dropped where possible. A robot's text stays in one line, so it cannot imitate other lines.
    """
    text = f"{text}{escaped(line)}\n"
    start = max(0, len(text) - size)
    if start > 0 and text[start - 1] != "\n":
        next_line = text.index("\n", start) + 1
        # If the line itself is longer than `size`, its end is kept.
        start = next_line if next_line < len(text) else start
    return text[start:]
