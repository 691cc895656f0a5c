"""Differences between two JSON values: how a large one changes, in few bytes, for readers and the journal.

A difference is itself JSON. `[value]` replaces a value. An object has the differences of the fields that change; null
removes a field. `[[[index, difference] …], [items]]` changes items of a list and appends others; `[index, number,
[items]]` removes so many of its items there, and appends others. `[number, text]` removes characters at the beginning
of a text and appends others.
"""

from typing import Any, Dict, List, Optional

# The two values are equal.
SAME = object()
# A shorter text is replaced, and so is a list with at most this many items.
LONG_TEXT = 64
SHORT_LIST = 2
# At most this many items that were removed at one place are looked for.
MOST_REMOVED = 2
# The beginning of the new text is searched for in the old one: this many characters, at most at so many places.
_BEGIN = 48
MOST_PLACES = 100


def difference(old: Any, new: Any) -> Any:
    """Return the difference from `old` to `new`; `SAME`: they are equal."""
    if old == new and old.__class__ is new.__class__:
        return SAME
    if isinstance(old, dict) and isinstance(new, dict):
        found: Dict[str, Any] = {key: None for key in old if key not in new}
        for key, value in new.items():
            change = difference(old[key], value) if key in old else [value]
            if change is not SAME:
                found[key] = change
        return found
    if isinstance(old, list) and isinstance(new, list) and len(old) > SHORT_LIST:
        return _of_lists(old, new)
    if isinstance(old, str) and isinstance(new, str) and min(len(old), len(new)) >= LONG_TEXT:
        more = added(old, new)
        if more is not None:
            return [len(old) + len(more) - len(new), more]
    return [new]


def changed(old: Any, by: Any) -> Any:
    """Return `old` changed by a difference. Unchanged parts are shared with `old`. Raises ValueError."""
    try:
        if by.__class__ is dict:
            new = {**old}
            for key, change in by.items():
                if change is None:
                    del new[key]
                elif change.__class__ is list and len(change) == 1:  # as below: most changes are new values
                    new[key] = change[0]
                else:
                    new[key] = changed(old.get(key), change)
            return new
        if len(by) == 1:
            return by[0]
        if len(by) == 3:
            place, count, added = by
            return old[:place] + old[place + count:] + added
        first, added = by
        if isinstance(added, str):
            return old[first:] + added
        items = list(old)
        for index, change in first:
            items[index] = changed(items[index], change)
        return items + added
    except (TypeError, KeyError, IndexError, AttributeError) as error:
        raise ValueError(f"the change does not fit the state before it: {error}") from None


def added(old: str, new: str) -> Optional[str]:
    """Return the text that `new` adds to `old`, of which it may lack the beginning. None: it is another text."""
    if new.startswith(old):
        return new[len(old):]
    if len(new) < LONG_TEXT:  # so short an overlap could be a coincidence
        return None
    dropped = -1
    for _ in range(MOST_PLACES):
        dropped = old.find(new[:_BEGIN], dropped + 1)
        if dropped < 0:
            return None
        if new.startswith(old[dropped:]):
            return new[len(old) - dropped:]
    return None


def _of_lists(old: List[Any], new: List[Any]) -> Any:
    place = next((i for i, (before, after) in enumerate(zip(old, new)) if before != after), min(len(old), len(new)))
    for count in range(1, min(MOST_REMOVED, len(old) - place) + 1):
        kept = len(old) - count
        if place < kept <= len(new) and old[place + count:] == new[place:kept]:
            return [place, count, new[kept:]]
    if len(old) > len(new):
        return [new]
    pairs = [[i, difference(*both)] for i, both in enumerate(zip(old, new))]
    return [[pair for pair in pairs if pair[1] is not SAME], new[len(old):]]
