"""Online data: strings that a robot keeps sending until they are acknowledged; and texts of lines for panels.

The box logs a string once. It logs the same text again only after a message that did not contain it came in between
(docs/protocol.md, "Repeated strings").
"""

from typing import Dict, List, Sequence, Tuple

from roah_rsbb.core.budget import Budget
from roah_rsbb.core.clock import Now
from roah_rsbb.wording.plain import plain

# Of each field of repeated strings, by its name: the texts of the last message.
Strings = Dict[str, Tuple[str, ...]]


def receive(last: Strings, field: str, texts: Sequence[str]) -> List[str]:
    """Put a fresh message's texts of one field into `last`; return those that are new, in their order."""
    if not texts:
        last.pop(field, None)
        return []
    unique = dict.fromkeys(texts)
    before = frozenset(last.get(field, ()))
    last[field] = tuple(unique)
    return [text for text in unique if text not in before]


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


def with_line(text: str, line: str, size: int) -> str:
    """Return a text with one more line, of which only the last `size` characters are kept (`display_log_size`).

    Whole lines are dropped where possible. What a robot says stays one line: it can forge no other.
    """
    text = f"{text}{plain(line)}\n"
    start = max(0, len(text) - size)
    if start > 0 and text[start - 1] != "\n":
        next_line = text.index("\n", start) + 1
        # The line itself may be longer than everything: then its end is kept.
        start = next_line if next_line < len(text) else start
    return text[start:]
