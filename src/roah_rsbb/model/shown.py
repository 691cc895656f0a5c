"""What faces show of the actions in a zone: why a button is off, whether it is shown, its fields as they are now."""

import functools
import json
from typing import Any, Iterable, List, NamedTuple, Optional, Sequence, Tuple

from roah_rsbb.model.fields import Field
from roah_rsbb.model.reason import Reason, Said, decode, encode


class Shown(NamedTuple):
    """An action in a zone."""

    off: Tuple[Said, ...] = ()  # the reasons why its button is off; empty: it is on
    shown: bool = True  # whether faces show it beside what they lay out themselves
    fields: Optional[Tuple[Field, ...]] = None  # as they are now; None: as in `ACTIONS`
    text: str = ""  # what the referee should do, in the words of a module; empty: the action's explanation says it


def said(texts: Iterable[str]) -> str:
    """Return reasons as JSON, for `said_in`."""
    found: List[Any] = [encode(text) for text in texts]
    return json.dumps(found, ensure_ascii=False) if found else ""


@functools.lru_cache(maxsize=256)
def said_in(text: str) -> Tuple[Reason, ...]:
    """Return the reasons in JSON; none if they cannot be read, because no text may prevent a STOP."""
    try:
        return tuple(map(decode, json.loads(text))) if text else ()
    except (ValueError, TypeError, RecursionError):
        return ()


def restored(texts: Sequence[str], text: str) -> List[str]:
    """Return texts as the reasons that they were, if these are in the JSON beside them."""
    known = {str(reason): reason for reason in said_in(text)}
    return [known.get(one, one) for one in texts]
