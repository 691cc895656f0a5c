"""The table of all actions in a zone, and of the entries for one run, which the desks of the box carry out.

Every call is checked, recorded and carried out here.
"""

from types import MappingProxyType
from typing import Any, Callable, Dict, List, Mapping, NamedTuple, Optional, Tuple, Type

from roah_rsbb.core.actions import modules, runs
from roah_rsbb.core.actions.base import Given, Parts, ZoneAction
from roah_rsbb.core.authority import Authority
from roah_rsbb.core.connections import Candidates, Connections
from roah_rsbb.core.desks import CommandRecord, JudgeDesk, ScoreDesk
from roah_rsbb.core.effects import Outbox
from roah_rsbb.core.zones import Zone, Zones
from roah_rsbb.model import fields
from roah_rsbb.model.actions import ACTIONS, CONFIRM, ENTRIES, EVERY, JUDGE_MARK, JUDGES, MARK, STOP, Shown
from roah_rsbb.model.clock import Now
from roah_rsbb.model.reason import Refused, RunName, checked_who, cut_note, say
from roah_rsbb.model.records import By, CaptainSign
from roah_rsbb.scoring.book import Note
from roah_rsbb.scoring.sheet import Mark
from roah_rsbb.wording.texts import did_you_mean

# What each action of `model.actions` does: the classes of these files that have its name.
KINDS: Tuple[Type[ZoneAction], ...] = tuple(
    kind for file in (runs, modules) for kind in vars(file).values()
    if isinstance(kind, type) and issubclass(kind, ZoneAction) and "name" in vars(kind))

NO_ACTION = say("no action '{action}'{hint}")
NO_TEAM = say("Name the team: the zone may have gone to the event of another one")
OTHER_TEAM = say("The current event of zone '{zone}' is of team {team}, not of team {named}: choose the event first")
OTHER_EVENT = say("Zone '{zone}' is at another event of team {team} now: choose the event first")
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
        authority: Authority, outbox: Outbox,
    ) -> None:
        self._zones = zones
        self._record = record
        self._authority = authority
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
        if self._authority.closed:
            return [self._authority.closed]
        return self._all[name].off(now, zone, self._nothing[name])

    def shown(self, now: Now, zone: Zone) -> Dict[str, Shown]:
        """Return what faces show of all actions, in their order. It is made ten times a second for each zone."""
        closed = (self._authority.closed,) if self._authority.closed else ()
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


NO_VALUE = say("The item gets no value: give its value, or say that it was not attempted")
# Fields whose journal has another name than calls.
_JOURNALED = {"desc": "item", "id": "mark"}
# How an item gets its value: the journal keeps the one that decides.
_SETS = ("not_attempted", "added", "text", "value")
# Kinds of the journal besides commands.
JUDGING, PUBLICATION = "judging", "publication"

# What an entry does with the run, who enters it and the values of its fields.
Enter = Callable[[Now, RunName, str, Mapping[str, Any]], None]


class _Entry(NamedTuple):
    """One of `model.actions.ENTRIES`."""

    do: Enter
    kind: str = "command"  # in the journal
    journaled: str = ""  # in the journal, where it has another name


class Entries:
    """All of `model.actions.ENTRIES`."""

    def __init__(self, zones: Zones, scores: ScoreDesk, judges: JudgeDesk, record: CommandRecord) -> None:
        self._zones = zones
        self._scores = scores
        self._judges = judges
        self._all = {
            MARK: _Entry(lambda now, run, who, given: scores.mark(now, run, mark_of(given), who)),
            JUDGE_MARK: _Entry(
                lambda now, run, who, given: judges.mark(now, run, mark_of(given), who), JUDGE_MARK, MARK),
            "withdraw": _Entry(
                lambda now, run, who, given: scores.withdraw(now, run, given["entry"], who, given["note"])),
            "in_time": _Entry(
                lambda now, run, who, given: scores.in_time(now, run, given["entry"], not given["late"], who)),
            "take_back": _Entry(
                lambda now, run, who, given: scores.take_back(
                    now, run, given["id"], who, given["note"], given["ago_ms"])),
            "note": _Entry(lambda now, run, who, given: scores.note(now, run, Note(**given), who)),
            "captain": _Entry(lambda now, run, who, given: scores.captain(now, run, CaptainSign(
                now.utc, given["name"], given["refused"], given["comment"], given["drawing"], who))),
            "decide": _Entry(
                lambda now, run, who, given: scores.decide(
                    now, run, given["number"], given["accept"], given["reason"], who)),
            "annul": _Entry(lambda now, run, who, given: scores.annul(now, run, By(who, given["reason"]))),
            "move": _Entry(
                lambda now, run, who, given: scores.move(now, run, given["event"], By(who, given["reason"]))),
            "reopen": _Entry(lambda now, run, who, given: scores.reopen(now, run, By(who, given["reason"]))),
            "undo": _Entry(lambda now, run, who, given: scores.undo(now, run, By(who, given["reason"]))),
            "stop_reason": _Entry(
                lambda now, run, who, given: scores.give_stop_reason(now, run, given["reason"], who, given["stop"])),
            "sign_off": _Entry(lambda now, run, who, given: scores.sign_off(now, run, who)),
            "submit": _Entry(lambda now, run, who, given: judges.submit(now, run, who, given["device"]), JUDGING),
            "settle": _Entry(
                lambda now, run, who, given: judges.settle(now, run, mark_of(given), given["reason"], who), JUDGING),
            "hand_back": _Entry(
                lambda now, run, who, given: judges.hand_back(now, run, given["judge"], given["reason"], who), JUDGING),
            "withdraw_sheet": _Entry(
                lambda now, run, who, given: judges.withdraw(now, run, given["judge"], given["reason"], who),
                JUDGING, "withdraw"),
            "waive": _Entry(lambda now, run, who, given: judges.waive(now, run, given["reason"], who), JUDGING),
            "publish": _Entry(
                lambda now, run, who, given: judges.publish(now, run, given["seconds"], who), PUBLICATION),
            "object": _Entry(
                lambda now, run, who, given: judges.object(
                    now, run, given["by"], given["text"], who, given["second"]), PUBLICATION),
            "answer": _Entry(
                lambda now, run, who, given: judges.answer(
                    now, run, given["number"], given["upheld"], given["text"], who), PUBLICATION),
        }
        self._records: Dict[str, CommandRecord] = {
            entry.kind: record.of_kind(entry.kind) for entry in self._all.values()}

    def do(self, now: Now, target: Target, name: str, who: str, given: Mapping[str, Any]) -> None:
        """Enter something; see `Actions.do`. Raises `Refused`."""
        run, entry, action = RunName(target.zone, target.run), self._all[name], ENTRIES[name]
        values: Dict[str, Any] = {}
        reasons: List[str] = []
        try:
            values = fields.read(action.fields, given)
        except fields.BadValue as bad:  # it is refused below
            reasons = [bad.reason]
            known = {field.name for field in action.fields}
            values = {key: value for key, value in given.items() if key in known and is_plain(value)}
        if action.roles == JUDGES:  # what a judge does is done under the judge's own name
            who, values = str(values.get("judge", who)), {**values, "judge": ""}
        with self._records[entry.kind].of(run, who, entry.journaled or name, **_asked(values)):
            if not run.identity:
                self._zones.named(run.zone)
            if reasons:
                raise Refused(reasons)
            if _has_no_value(values, given) and not self._is_applied(name, run, who, values):
                raise Refused([NO_VALUE])
            entry.do(now, run, who, values)

    def _is_applied(self, name: str, run: RunName, who: str, values: Mapping[str, Any]) -> bool:
        """Whether a mark was applied before: one that is sent again is no error, whatever is wrong with it now."""
        mark = mark_of(values)
        return ((name == MARK and self._scores.is_applied(run, mark))
                or (name == JUDGE_MARK and self._judges.is_applied(run, mark, who)))

    def outcome(self, target: Target, name: str, given: Mapping[str, Any]) -> Dict[str, Any]:
        """Return how the item of a mark that was entered is now, as JSON; of anything else, nothing."""
        if name not in (MARK, JUDGE_MARK):
            return {}
        run, mark = RunName(target.zone, target.run), mark_of(fields.read(ENTRIES[name].fields, given))
        entry, item, proposed = (self._scores.outcome(run, mark) if name == MARK else
                                 self._judges.outcome(run, mark, given["judge"]))
        return {"number": entry, "value": item.value, "not_attempted": item.not_attempted, "text": item.text,
                **({"proposed": proposed} if proposed else {})}


def _has_no_value(values: Mapping[str, Any], given: Mapping[str, Any]) -> bool:
    """Whether a mark gives its item no value: it would set it to 0. An empty text takes a judge's rating away."""
    return "not_attempted" in values and "value" not in given and not (
        any(values.get(name) for name in _SETS) or (given.get("judge") and "text" in given))


def _asked(values: Mapping[str, Any]) -> Dict[str, Any]:
    """Return the values of an entry as the journal has them."""
    asked = {name: value for name, value in values.items() if name != "ago_ms" or value}
    if "desc" in values:
        decides = next((name for name in _SETS if values.get(name)), "text" if values.get("judge") else "value")
        others = {*_SETS, "judge"} - ({decides, "judge"} if decides in ("text", "value") else {decides})
        asked = {name: value for name, value in asked.items() if name not in others}
    return _journaled(asked)


def _journaled(values: Mapping[str, Any]) -> Dict[str, Any]:
    """Return values by the names that the journal has for their fields."""
    return {_JOURNALED.get(name, name): value for name, value in values.items()}


def mark_of(given: Mapping[str, Any]) -> Mark:
    """Return the mark in the values of an entry's fields."""
    return Mark(**{field: given[field] for field in Mark._fields if field in given})
