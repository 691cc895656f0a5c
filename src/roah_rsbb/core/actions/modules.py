"""What a benchmarking module asks of the referee: a form to fill in, and switches to enter."""

import abc
from typing import Any, Dict, List, Optional, Tuple

from roah_rsbb.core.actions.base import Given, ZoneAction
from roah_rsbb.core.runs.functionality import FunctionalityRun
from roah_rsbb.core.zones import NO_RUN, Zone
from roah_rsbb.model import run_log
from roah_rsbb.model.clock import Now
from roah_rsbb.model.fields import BadValue, Field, Fixed, Number, answered
from roah_rsbb.model.modules import Request, RequestKind
from roah_rsbb.model.reason import say
from roah_rsbb.model.records import By

NO_OPERATION = say("zone '{zone}' has no manual operation now")
OVER = say("that manual operation is over; the current one is: {text}")
NO_SWITCHES = say("zone '{zone}' runs {code}, which has no switches")
NO_SWITCHES_NOW = say("zone '{zone}' has no switches to enter: they come with a goal for switches")
NOT_FINISHED = say("the switches cannot be confirmed yet: the robot has not finished")


class ModuleAction(ZoneAction):
    """An action that is shown while a module asks for it."""

    off_without_run, shown_without_run = NO_RUN, False
    kind: Optional[RequestKind] = None  # of the request that it answers; None: it answers none

    @abc.abstractmethod
    def missing(self, zone: Zone) -> List[str]:
        """Return why nothing asks for it in the zone, which has a run."""

    def shown(self, zone: Zone) -> bool:
        """See `ZoneAction`."""
        return zone.run is not None and not self.missing(zone)

    def text(self, zone: Zone) -> str:
        """See `ZoneAction`."""
        asked = self.asked(zone)
        return "" if asked is None else asked.text

    def off(self, now: Now, zone: Zone, given: Given) -> List[str]:
        """See `ZoneAction`."""
        return [NO_RUN] if zone.run is None else self.missing(zone)

    def asked(self, zone: Zone) -> Optional[Request]:
        """Return the request that it answers; None: there is none now."""
        asked = zone.run.asked if isinstance(zone.run, FunctionalityRun) else None
        return asked if asked is not None and asked.kind is self.kind else None


class Operation(ModuleAction):
    """The referee did what a module asked for, and filled in its form. `operation`: the number of the request; 0: the
    current one."""

    name, journaled, kind = "operation", "manual_operation", RequestKind.REFEREE

    def missing(self, zone: Zone) -> List[str]:
        """See `ModuleAction`."""
        return [] if self.asked(zone) is not None else [NO_OPERATION(zone=zone.name)]

    def form(self, now: Now, zone: Zone) -> Tuple[Field, ...]:
        """The number of the request, and its fields."""
        asked, number = self.asked(zone), self.action.fields[0]
        return self.action.fields if asked is None else (
            Fixed(number.name, number.label, required=False, default=asked.number), *asked.fields)

    def read(self, zone: Zone, given: Given) -> Dict[str, Any]:
        """Only an answer to the present request can be read."""
        asked, field = self.asked(zone), self.action.fields[0]
        number = field.read(given.get(field.name, 0))
        if asked is None:
            raise BadValue(NO_RUN if zone.run is None else NO_OPERATION(zone=zone.name))
        if number not in (0, asked.number):
            raise BadValue(OVER(text=asked.text))
        values = {name: value for name, value in given.items() if name != field.name}
        return {field.name: number, **answered(asked.fields, values)}

    def do(self, now: Now, zone: Zone, by: By, given: Given) -> None:
        """See `ZoneAction`."""
        _run(zone).complete_operation(now, {name: value for name, value in given.items() if name != "operation"})

    def recorded(self, zone: Zone, given: Given) -> Dict[str, Any]:
        """All of them: no is an answer, too."""
        return dict(given)


class Damaged(ModuleAction):
    """The referee enters how many switches were damaged."""

    name, journaled, topic = "damaged", "omf_damaged", run_log.OMF_DAMAGED

    def missing(self, zone: Zone) -> List[str]:
        """See `ModuleAction`."""
        if not isinstance(zone.run, FunctionalityRun):
            return [NO_SWITCHES(zone=zone.name, code=zone.event.benchmark.code)]
        return [] if zone.run.entering is not None else [NO_SWITCHES_NOW(zone=zone.name)]

    def do(self, now: Now, zone: Zone, by: By, given: Given) -> None:
        """See `ZoneAction`."""
        _run(zone).enter_switches(now, self.topic, given["number"])

    def recorded(self, zone: Zone, given: Given) -> Dict[str, Any]:
        """As earlier versions of the box called it."""
        return {self.name: given["number"]}


class Switch(Damaged):
    """The referee saw a switch change."""

    name, journaled, topic = "switch", "omf_button", run_log.OMF_BUTTON

    def form(self, now: Now, zone: Zone) -> Tuple[Field, ...]:
        """The switches that there are."""
        switches, field = _run(zone).entering if self.shown(zone) else None, self.action.fields[0]
        return self.action.fields if switches is None else (
            Number(field.name, field.label, low=1, high=len(switches.state.initial_state)),)


class ConfirmSwitches(ModuleAction):
    """The referee confirms the entered switches."""

    name, journaled, kind = "confirm_switches", "omf_complete", RequestKind.SWITCHES

    def missing(self, zone: Zone) -> List[str]:
        """See `ModuleAction`."""
        if not isinstance(zone.run, FunctionalityRun):
            return [NO_SWITCHES(zone=zone.name, code=zone.event.benchmark.code)]
        return [] if self.asked(zone) is not None else [NOT_FINISHED]

    def do(self, now: Now, zone: Zone, by: By, given: Given) -> None:
        """See `ZoneAction`."""
        _run(zone).complete_switches(now)


def _run(zone: Zone) -> FunctionalityRun:
    assert isinstance(zone.run, FunctionalityRun), "it was checked before"
    return zone.run
