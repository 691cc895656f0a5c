"""What faces show of the actions in a zone: why a button is off, whether it is shown, its fields as they are now.

The core writes it as JSON into ZoneDetails.actions, and every face reads it here.
"""

import functools
import json
from typing import Any, Dict, Iterable, List, NamedTuple, Optional, Sequence, Tuple

from roah_rsbb.model.actions import ACTIONS
from roah_rsbb.model.fields import Field, field_of
from roah_rsbb.model.reason import Reason, Said, decode, decoded, encode, encoded


class Shown(NamedTuple):
    """An action in a zone."""

    off: Tuple[Said, ...] = ()  # the reasons why its button is off; empty: it is on
    shown: bool = True  # whether faces show it beside what they lay out themselves
    fields: Optional[Tuple[Field, ...]] = None  # as they are now; None: as in `ACTIONS`
    text: str = ""  # what the referee should do, in the words of a module; empty: the action's explanation says it


def written(actions: Iterable[Tuple[str, Shown]]) -> str:
    """Return the actions of a zone, by their names, as JSON. What is as in `ACTIONS`, or usual, is left out."""
    return json.dumps({name: _written(name, action) for name, action in actions}, ensure_ascii=False)


def _written(name: str, action: Shown) -> Dict[str, Any]:
    return {
        **({"off": encoded(action.off)} if action.off else {}),
        **({} if action.shown else {"shown": False}),
        **({} if action.fields is None else {"fields": [field.form() for field in action.fields]}),
        **({"text": action.text} if action.text else {}),
    }


@functools.lru_cache(maxsize=256)
def read(text: str) -> Dict[str, Shown]:
    """Return the actions in JSON. The result of a call is kept: do not change it."""
    return {name: _read(name, found) for name, found in json.loads(text or "{}").items()}


def _read(name: str, found: Dict[str, Any]) -> Shown:
    known = ACTIONS[name].fields if name in ACTIONS else ()
    fields = tuple(map(field_of, found["fields"])) if "fields" in found else known
    return Shown(tuple(decoded(found.get("off", ()))), found.get("shown", True), fields, found.get("text", ""))


def of(details: Any, name: str) -> Shown:
    """Return an action in a zone. `details`: ZoneDetails. One that the box does not know is off, without a reason."""
    return read(details.actions).get(name, Shown(shown=False))


def off(details: Any, name: str) -> Tuple[str, ...]:
    """Return why the button of an action is off; empty: it is on. `details`: ZoneDetails."""
    return of(details, name).off


def robots_to_choose(details: Any) -> Tuple[str, ...]:
    """Return the team's robots from which the referee chooses one; empty: there is no choice. `details`:
    ZoneDetails."""
    found: Tuple[str, ...] = next((getattr(field, "choices", ()) for field in of(details, "connect").fields or ()), ())
    return found


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
