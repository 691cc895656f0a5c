"""What the referee changed on a score sheet, until the core shows it.

A message that was published before a change reached the core still holds the old value. It may arrive
after the answer to the change, on another connection, and must not overwrite what the referee sees.
"""

from typing import Dict, Hashable, NamedTuple, Optional

# Error of the estimated box clock, seconds.
MARGIN_S = 0.1


class _Edit(NamedTuple):
    wish: int
    sent: Optional[int]  # value in the call that waits for its answer; None: answered
    since: float = 0.0  # once answered: box's clock from which on messages include the change


class ScoreEdits:
    """Edits by item. At most one call an item is under way, so that calls cannot overtake each other."""

    def __init__(self) -> None:
        self._edits: Dict[Hashable, _Edit] = {}

    def wish(self, item: Hashable, value: int) -> Optional[int]:
        """The referee wants `value`; returns the value to send now, or None while another call waits."""
        edit = self._edits.get(item)
        if edit is not None and edit.sent is not None:
            self._edits[item] = edit._replace(wish=value)
            return None
        self._edits[item] = _Edit(value, sent=value)
        return value

    def carried_out(self, item: Hashable, box_clock_s: float) -> Optional[int]:
        """The core answered, at `box_clock_s`; returns the value to send next, if it changed meanwhile."""
        edit = self._edits.get(item)
        if edit is None:
            return None
        if edit.wish != edit.sent:
            self._edits[item] = _Edit(edit.wish, sent=edit.wish)
            return edit.wish
        self._edits[item] = _Edit(edit.wish, None, box_clock_s + MARGIN_S)
        return None

    def failed(self, item: Hashable) -> None:
        """The call failed: the item shows again what the core says."""
        self._edits.pop(item, None)

    def value(self, item: Hashable, published: int, clock_s: float) -> int:
        """The value to show, when a message of `clock_s` (box's clock) says `published`."""
        edit = self._edits.get(item)
        if edit is None:
            return published
        if edit.sent is None and clock_s >= edit.since:
            del self._edits[item]
            return published
        return edit.wish

    def is_waiting(self, item: Hashable) -> bool:
        """Whether a change of this item still waits for the core."""
        edit = self._edits.get(item)
        return edit is not None and edit.sent is not None

    def clear(self) -> None:
        """Another sheet is shown."""
        self._edits.clear()
