"""What all actions have, and what they get."""

import abc
from typing import Any, Dict, List, Mapping, NamedTuple, Optional, Tuple

from roah_rsbb.core.connections import Candidates, Connections
from roah_rsbb.core.desks import ScoreDesk
from roah_rsbb.core.zones import Zone
from roah_rsbb.model.actions import ACTIONS
from roah_rsbb.model.clock import Now
from roah_rsbb.model.fields import Field, read
from roah_rsbb.model.reason import RunName
from roah_rsbb.model.records import By

Given = Mapping[str, Any]  # the values of an action's fields, all of them


class Parts(NamedTuple):
    """What actions may use of the box."""

    candidates: Candidates
    connections: Connections
    scores: ScoreDesk


class ZoneAction(abc.ABC):
    """An action in a zone. `off`, `refused` and `do` get the values of all fields of the action."""

    name: str  # in `model.actions`
    # Why it is off in every zone without a run; None: that depends. Many zones have no run most of the time.
    off_without_run: Optional[str] = None
    shown_without_run = True
    journaled = ""  # in the journal, where earlier versions of the box used another name

    def __init__(self, parts: Parts) -> None:
        self._candidates = parts.candidates
        self._connections = parts.connections
        self._scores = parts.scores
        self.action = ACTIONS[self.name]  # what faces know of it

    def shown(self, zone: Zone) -> bool:
        """Whether faces show it in this zone, beside what they lay out themselves."""
        return True

    def form(self, now: Now, zone: Zone) -> Tuple[Field, ...]:
        """Return its fields as they are now."""
        return self.action.fields

    def text(self, zone: Zone) -> str:
        """Return what the referee should do, in the words of a benchmarking module; empty: the explanation says it."""
        return ""

    def question(self, now: Now, zone: Zone) -> str:
        """Return what whoever calls it must have confirmed (field `again`); empty: nothing."""
        return ""

    def read(self, zone: Zone, given: Given) -> Dict[str, Any]:
        """Return the values of all its fields. Raises `BadValue`."""
        return read(self.action.fields, given)

    @abc.abstractmethod
    def off(self, now: Now, zone: Zone, given: Given) -> List[str]:
        """Return every reason why its button is off; empty: it is on."""

    def refused(self, now: Now, zone: Zone, target: RunName, given: Given) -> List[str]:
        """Return every reason why a call of it is refused; empty: it is done. `target`: the run that the caller
        means."""
        return self.off(now, zone, given)

    @abc.abstractmethod
    def do(self, now: Now, zone: Zone, by: By, given: Given) -> None:
        """Carry it out. Nothing is off, or refused."""

    def recorded(self, zone: Zone, given: Given) -> Dict[str, Any]:
        """Return what the journal keeps of the fields: no toggle that is off."""
        return {name: value for name, value in given.items() if value is not False}
