"""Changes that the referee made in a panel, until the core publishes them.

A message from before the change still holds the old value. It may arrive after the answer to the change, on another
connection, and must not overwrite what the referee sees.
"""

from typing import Dict, Hashable, NamedTuple, Optional, TypeVar

Value = TypeVar("Value", bound=Hashable)  # any value but None


class _Edit(NamedTuple):
    wish: Hashable
    sent: Optional[Hashable]  # value in the call that waits for its answer; None: answered
    since: float = 0.0  # once answered: later messages include the change


class Edits:
    """Edits by item. Each item has at most one call in progress, so that calls cannot overtake each other.

    Clocks are those of the messages, in seconds. Where messages have none, use any clock that never goes back.
    """

    def __init__(self, margin_s: float = 0.0) -> None:
        """`margin_s`: how long after the answer to a change an older message may still arrive."""
        self._margin_s = margin_s
        self._edits: Dict[Hashable, _Edit] = {}

    def wish(self, item: Hashable, value: Value) -> Optional[Value]:
        """Note that the referee set `value`. Returns the value to send now; None: another call is in progress."""
        edit = self._edits.get(item)
        if edit is not None and edit.sent is not None:
            self._edits[item] = edit._replace(wish=value)
            return None
        self._edits[item] = _Edit(value, sent=value)
        return value

    def carried_out(
        self, item: Hashable, clock_s: float, is_now: Optional[Hashable] = None
    ) -> Optional[Hashable]:
        """Note that the call was answered at `clock_s`. Returns the value to send next, if it changed meanwhile.

        `is_now`: the value of the item after the call, if the answer has it. Others may have changed it, too.
        """
        edit = self._edits.get(item)
        if edit is None:
            return None
        if edit.wish != edit.sent:
            self._edits[item] = _Edit(edit.wish, sent=edit.wish)
            return edit.wish
        self._edits[item] = _Edit(edit.wish if is_now is None else is_now, None, clock_s + self._margin_s)
        return None

    def failed(self, item: Hashable) -> None:
        """Note that the call failed. The item shows the published value again."""
        self._edits.pop(item, None)

    def value(self, item: Hashable, published: Value, clock_s: float) -> Value:
        """Return the value to show when a message of `clock_s` says `published`."""
        edit = self._edits.get(item)
        if edit is None:
            return published
        if edit.sent is None and clock_s > edit.since:
            del self._edits[item]
            return published
        return edit.wish

    def is_waiting(self, item: Hashable) -> bool:
        """Whether a change of this item is still waiting for its answer."""
        edit = self._edits.get(item)
        return edit is not None and edit.sent is not None

    def clear(self) -> None:
        """Forget all edits: other items are shown."""
        self._edits.clear()
