"""The table of all actions in a zone: every call is checked, recorded and carried out here."""

from types import MappingProxyType
from typing import Any, Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple, Type

from roah_rsbb.core.actions import connecting, events, modules, running
from roah_rsbb.core.actions.base import Given, Parts, ZoneAction
from roah_rsbb.core.actions.record import CommandRecord
from roah_rsbb.core.candidates import Candidates
from roah_rsbb.core.connections import Connections
from roah_rsbb.core.effects import Outbox
from roah_rsbb.core.score_desk import ScoreDesk
from roah_rsbb.core.zones import Zone, Zones
from roah_rsbb.model import fields
from roah_rsbb.model.actions import ACTIONS, EVERY, STOP, Shown
from roah_rsbb.model.clock import Now
from roah_rsbb.model.reason import Reason, Refused, RunName, checked_who, cut_note, say
from roah_rsbb.model.records import By
from roah_rsbb.wording.suggestions import did_you_mean

# What each action of `model.actions` does.
KINDS: Tuple[Type[ZoneAction], ...] = (
    connecting.Connect, connecting.Disconnect, running.Start, running.StopRun, events.Previous, events.Next,
    running.PreviousPhase, running.NextPhase, running.Continue, running.Pause, running.ResumeClock,
    connecting.OpenSheet, connecting.RecordNoShow, connecting.Withdrawn, events.ChooseEvent,
    modules.Operation, modules.Switch, modules.Damaged, modules.ConfirmSwitches,
)

NO_ACTION = say("no action '{action}'{hint}")
NO_TEAM = say("Name the team: the zone may have gone to the event of another one")
OTHER_TEAM = say("The current event of zone '{zone}' is of team {team}, not of team {named}: choose the event first")
OTHER_EVENT = say("Zone '{zone}' is at another event of team {team} now: choose the event first")
CONFIRM = say("{question}. For another attempt, press the button again and confirm")
OTHER_RUN = say("run {run} is not connected in zone '{zone}'")


NOTHING: Mapping[str, Any] = MappingProxyType({})  # what is given with an action without fields


class Target(NamedTuple):
    """What the caller of an action sees: it is refused where that is not so any more."""

    zone: str
    run: str = ""  # identity of the run that is connected; empty: any, or none
    event: str = ""  # id of the current event; empty: any


class Actions:
    """All actions in a zone."""

    def __init__(
        self, candidates: Candidates, connections: Connections, scores: ScoreDesk, zones: Zones, record: CommandRecord,
        outbox: Outbox,
    ) -> None:
        self._zones = zones
        self._record = record
        self._outbox = outbox
        kinds = {kind.name: kind for kind in KINDS}
        parts = Parts(candidates, connections, scores)
        self._all: Dict[str, ZoneAction] = {name: kinds[name](parts) for name in ACTIONS}
        self._without_run = {
            name: Shown((action.off_without_run,), action.shown_without_run)
            for name, action in self._all.items() if action.off_without_run is not None}
        # By the name of the action: the values of its fields if none is given.
        self._nothing: Dict[str, Given] = {
            name: {field.name: field.nothing for field in action.action.fields} for name, action in self._all.items()}

    def __getitem__(self, name: str) -> ZoneAction:
        return self._all[name]

    def off(self, now: Now, zone: Zone, name: str) -> List[str]:
        """Return every reason why the button of an action is off now; empty: it is on."""
        if self._record.closed:
            return [self._record.closed]
        return self._all[name].off(now, zone, self._nothing[name])

    def shown(self, now: Now, zone: Zone) -> Dict[str, Shown]:
        """Return what faces show of all actions, in their order. It is made ten times a second for each zone."""
        closed = (self._record.closed,) if self._record.closed else ()
        kept = self._without_run if zone.run is None and not closed else NOTHING
        return {
            name: kept.get(name) or Shown(
                closed or tuple(action.off(now, zone, self._nothing[name])), action.shown(zone),
                _if_other(action.form(now, zone), action), action.text(zone), action.question(now, zone))
            for name, action in self._all.items()}

    def do(self, now: Now, target: Target, name: str, who: str = "", given: Mapping[str, Any] = NOTHING) -> None:
        """Carry out an action. `given`: the values of its fields by their names, as in JSON. Raises `Refused`."""
        if name not in self._all:
            raise Refused([NO_ACTION(action=cut_note(name), hint=did_you_mean(name, EVERY))])
        action, run = self._all[name], RunName(target.zone, target.run)
        recorded = {field.name: given[field.name] for field in action.action.fields if is_plain(given.get(field.name))
                    and given[field.name] is not False}
        zone, values, wrong = self._zones.get(target.zone), NOTHING, ""
        if zone is not None:
            try:
                values = action.read(zone, given)
                recorded = action.recorded(zone, values)
            except fields.BadValue as bad:  # it is refused below, but for STOP, which nothing may prevent
                wrong = "" if name == STOP else bad.reason
                values = self._nothing[name]
        with self._record.of(run, who, action.journaled or name, **recorded):
            zone = self._zones.named(target.zone)
            if wrong:
                raise Refused(_elsewhere(zone, target, "") or [_name_the_team(name, wrong, given)])
            team = values.get("team", "") if action.action.aims else ""
            reasons = _elsewhere(zone, target, team) or action.refused(now, zone, run, values)
            question = "" if reasons or values.get("again") else action.question(now, zone)
            if question:
                reasons = [CONFIRM(question=question)]
            if reasons:
                raise Refused(reasons)
            self._outbox.mark_changed(zone.name)
            action.do(now, zone, By(checked_who(who), cut_note(values.get("reason", ""))), values)


def confirmed_by(reasons: Sequence[str], how: str) -> List[str]:
    """Return reasons with how a face without buttons begins another attempt."""
    return [f"{reason.values['question']}. {how}"
            if isinstance(reason, Reason) and reason.template == CONFIRM else reason for reason in reasons]


def _if_other(found: Tuple[fields.Field, ...], action: ZoneAction) -> Optional[Tuple[fields.Field, ...]]:
    """Return the fields of an action if they are not those of the table."""
    return None if found is action.action.fields else found


def is_plain(value: object) -> bool:
    """Whether a value of JSON is one that a field may have."""
    return isinstance(value, (str, int))


def _name_the_team(name: str, reason: str, given: Mapping[str, Any]) -> str:
    """Return why a call is refused: what hits a team names it, and says why."""
    needs_team = any(field.name == "team" and field.required for field in ACTIONS[name].fields)
    return NO_TEAM if needs_team and not given.get("team") else reason


def _elsewhere(zone: Zone, target: Target, team: str) -> List[str]:
    """Return why the zone does not show what the caller means; empty: it does."""
    event = zone.event
    if target.run and (zone.run is None or zone.run.identity != target.run):
        return [OTHER_RUN(run=target.run, zone=zone.name)]
    if team and team != event.team:
        return [OTHER_TEAM(zone=zone.name, team=event.team, named=cut_note(team))]
    if target.event and target.event != event.id:
        return [OTHER_EVENT(zone=zone.name, team=event.team)]
    return []
