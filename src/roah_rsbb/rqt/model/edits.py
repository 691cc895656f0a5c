"""Changes that the referee made in a panel, until what is published contains them."""

from typing import Callable, Dict, Generic, Hashable, NamedTuple, Optional, TypeVar

Value = TypeVar("Value", bound=Hashable)  # any value but None
Mark = TypeVar("Mark")


class _Edit(NamedTuple):
    wish: Hashable
    sent: Optional[Hashable]  # value in the call that waits for its answer; None: answered
    mark: object = None  # of the answer


class Edits(Generic[Mark]):
    """Edits by item. Each item has at most one call in progress, so that calls cannot overtake each other."""

    def __init__(self, is_confirmed: Callable[[Mark], bool]) -> None:
        """`is_confirmed`: whether what is published now contains a change, by the mark of its answer."""
        self._is_confirmed = is_confirmed
        self._edits: Dict[Hashable, _Edit] = {}

    def wish(self, item: Hashable, value: Value) -> Optional[Value]:
        """Note that the referee set `value`. Returns the value to send now; None: another call is in progress."""
        edit = self._edits.get(item)
        if edit is not None and edit.sent is not None:
            self._edits[item] = edit._replace(wish=value)
            return None
        self._edits[item] = _Edit(value, sent=value)
        return value

    def carried_out(self, item: Hashable, mark: Mark, is_now: Optional[Hashable] = None) -> Optional[Hashable]:
        """Note that the call was answered. Returns the value to send next, if it changed meanwhile.

        `is_now`: the value of the item after the call, if the answer has it. Others may have changed it, too.
        """
        edit = self._edits.get(item)
        if edit is None:
            return None
        if edit.wish != edit.sent:
            self._edits[item] = _Edit(edit.wish, sent=edit.wish)
            return edit.wish
        self._edits[item] = _Edit(edit.wish if is_now is None else is_now, None, mark)
        return None

    def failed(self, item: Hashable) -> None:
        """Note that the call failed. The item shows the published value again."""
        self._edits.pop(item, None)

    def value(self, item: Hashable, published: Value) -> Value:
        """Return the value to show while `published` is published."""
        edit = self._edits.get(item)
        if edit is None:
            return published
        if edit.sent is None and self._is_confirmed(edit.mark):
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
