"""The call `edit`: an organiser changes the schedule of the day while the box runs (docs/organiser.md, "The day is
edited").

Theory of operation. An edit is first only looked at: the answer says its effect, and identifies what was said
(`seen`). With that it is carried out, if its effect is still the same. It is then kept in log_dir
(`Configuration.keep`), recorded in the journal, and in force; and only then in the file, which is its rendering. The
edits that are kept are undone by the changes that they have.
"""

import contextlib
import hashlib
import json
from itertools import starmap
from typing import Any, Callable, Dict, List, Mapping, NamedTuple, Sequence

from roah_rsbb.box import calls
from roah_rsbb.box.configuration import Configuration, Reloads, changes_of
from roah_rsbb.core.actions.table import Target
from roah_rsbb.core.box import Box
from roah_rsbb.core.day import WithdrawnRun
from roah_rsbb.document.calls import EDIT, Caller, InThread
from roah_rsbb.document.calls import EDITS as LISTED
from roah_rsbb.ground import durable, installed
from roah_rsbb.model import fields
from roah_rsbb.model.actions import ADVANCE, EDITS, UNDO, WITHDRAW_TEAM
from roah_rsbb.model.clock import Now
from roah_rsbb.model.reason import Reason, Refused, Template, checked_note, checked_who, encoded, say
from roah_rsbb.rulebook import day, team_passwords
from roah_rsbb.rulebook.day import Day, EventChange, PlannedSlot
from roah_rsbb.rulebook.errors import ConfigErrors
from roah_rsbb.wording import sheets
from roah_rsbb.wording.texts import did_you_mean

NO_EDIT = say("There is no edit '{action}'{hint}")
OTHER_NOW = say("The effect is another one by now: look at it again")
NOT_KEPT = say("There is no edit {number} that can be undone")
COMES_BACK = say("{event}: {time} in zone '{zone}', the team does not withdraw")
NO_REASON = say("the team did not withdraw")
NOTHING_OF_TEAM = say("Team {team} has no such event to come")
WITHDRAWN = say("{event}: {time} in zone '{zone}', the team withdraws")
PASSWORD = say("Team {team} gets a password, in {path}")
STILL = say("{number} events of stage '{stage}' are still to come: who advances may change")
SHIPPED = say("{path} is a part of the program, and is not written: make a competition's folder")
NOT_WRITTEN = say("{path} cannot be written: {error}. Make it writable for this user")


class _Planned(NamedTuple):
    """What an edit would do."""

    words: List[Reason]
    changes: List[EventChange]
    events: List[str] = []  # from which a team withdraws
    undoes: int = 0  # number of the edit that it undoes; 0: none
    comes_back: List[WithdrawnRun] = []  # runs that say that a team withdrew, and no longer count
    warnings: List[Reason] = []


class DayEdits:
    """Looks at edits, carries them out, and lists them."""

    def __init__(self, box: Box, configuration: Configuration, reloads: Reloads,
                 in_loop: Callable[[Callable[[], Any]], Any], event: Callable[..., None],
                 now: Callable[[], Now]) -> None:
        """For `in_loop` and `event`, see `Reloads`."""
        self._box, self._configuration, self._reloads = box, configuration, reloads
        self._in_loop, self._event, self._now = in_loop, event, now

    def named(self) -> Dict[str, Any]:
        """Return the calls by their names."""
        return {EDIT: self._call, LISTED: lambda _found, _caller: self.listed()}

    def listed(self) -> List[Dict[str, Any]]:
        """Return the edits, the newest first."""
        names = "number", "utc", "who", "action", "reason", "words", "undone"
        return [{**{name: edit[name] for name in names},
                 "can_undo": bool(edit["changes"] or edit["runs"]) and not edit["undone"]}
                for edit in reversed(self._configuration.edits)]

    def _call(self, found: Mapping[str, Any], caller: Caller) -> InThread:
        action, seen, who, given = (calls.text(found, "action"), calls.text(found, "seen"), calls.who_of(found),
                                    found.get("given", {}))
        if not isinstance(given, dict):
            raise Refused([calls.NO_OBJECT])
        return InThread(lambda: self.edit(action, given, seen, who))

    def edit(self, action: str, given: Mapping[str, Any], seen: str, who: str) -> Dict[str, Any]:
        """Return the effect of an edit; with what was `seen`, carry it out. Call it in another thread than the loop's.
        Raises `Refused`."""
        if action not in EDITS:
            raise Refused([NO_EDIT(action=action, hint=did_you_mean(action, EDITS))])
        try:
            values = fields.read(EDITS[action].fields, given)
            with self._reloads.alone():
                return self._edit(action, values, seen, who)
        except fields.BadValue as bad:
            raise Refused([bad.reason]) from None
        except ConfigErrors as errors:
            raise Refused(str(errors).splitlines()) from None

    def _edit(self, action: str, values: Mapping[str, Any], seen: str, who: str) -> Dict[str, Any]:
        reason = checked_note(values["reason"])
        now, events = self._in_loop(lambda: (self._now(), self._box.day.events()))
        before = Day(self._configuration.content.config.zones, events.open, events.to_come, now.utc)
        planned = self._planned(before, action, values)
        new_team = values["team"] if action == day.add_team.__name__ else ""
        content, passwords = self._configuration.content, None
        if new_team:
            passwords = team_passwords.with_team(self._configuration.passwords, new_team)
        if planned.changes:
            content = self._configuration.edited(planned.changes, passwords)
        warnings = [*planned.warnings, *day.warnings(before, content.config.zones, planned.changes)]
        off = self._in_loop(lambda: self._box.reload.off(content.config))
        if off:
            raise Refused(off)
        said = [*planned.words, *([PASSWORD(team=new_team, path=self._configuration.passwords)] if new_team else [])]
        digest = hashlib.sha256(json.dumps([encoded(said), encoded(warnings)]).encode()).hexdigest()[:16]
        answer = {"effects": encoded(said), "warnings": encoded(warnings), "seen": digest, "done": False, "trouble": ""}
        if not seen:
            return answer
        if seen != digest:
            raise Refused([OTHER_NOW])
        if passwords is not None:
            self._write_passwords(passwords)
        record = {
            "number": max((edit["number"] for edit in self._configuration.edits), default=0) + 1, "utc": now.utc,
            "who": checked_who(who), "action": action, "reason": reason, "words": encoded(said), "undone": 0,
            "changes": planned.changes, "runs": [], "written": not planned.changes}
        edits = [*({**edit, "undone": record["number"]} if edit["number"] == planned.undoes else edit
                   for edit in self._configuration.edits), record]
        if not planned.changes:
            record["runs"] = self._in_loop(lambda: self._carry_out(planned, values.get("team", ""), who, reason))
            self._configuration.keep_edits(edits)
            return {**answer, "done": True}
        errors = self._reloads.apply(content, list(map(str, said)), who, edits=edits)
        if errors:
            raise Refused(errors)
        trouble = self._configuration.write_schedule(content.texts.texts[1], content.config.zones)
        return {**answer, "done": True, "trouble": encoded([trouble])[0]}

    def _carry_out(self, planned: _Planned, team: str, who: str, reason: str) -> List[WithdrawnRun]:
        """Let a team withdraw, or not, in the loop's thread. Return the runs that say that it does."""
        for run in planned.comes_back:
            with contextlib.suppress(Refused):  # somebody annulled it
                self._event(self._box.act, Target(run.zone, run.identity), "annul", who,
                            {"reason": reason or str(NO_REASON)})
        self._event(self._box.day.go_back, {run.event for run in planned.comes_back})
        found: List[WithdrawnRun] = []
        if planned.events:
            self._event(lambda now: found.extend(self._box.day.withdraw(now, planned.events, team, who, reason)))
        for run in found if sheets.person(who) not in ("", sheets.NO_NAME) else ():
            with contextlib.suppress(Refused):  # several judges score it
                self._event(self._box.act, Target(run.zone, run.identity), "sign_off", who, {})
        return found

    def _write_passwords(self, text: str) -> None:
        path = self._configuration.passwords
        if installed.is_shipped(path):
            raise Refused([SHIPPED(path=path)])
        try:
            durable.replace_keeping(path, text.encode("utf-8"), 0)
        except OSError as error:
            raise Refused([NOT_WRITTEN(path=path, error=error.strerror)]) from None

    def _planned(self, before: Day, action: str, values: Mapping[str, Any]) -> _Planned:
        if action == WITHDRAW_TEAM:
            found = _of_team(before, values)
            return _Planned([_words(WITHDRAWN, before.slots[event], before) for event in found], [], found)
        if action == UNDO:
            edit = next((edit for edit in self._configuration.edits
                         if edit["number"] == values["number"] and not edit["undone"]), None)
            if edit is None:
                raise Refused([NOT_KEPT(number=values["number"])])
            slots = before.slots
            if not edit["changes"]:
                left = [run for run in starmap(WithdrawnRun, edit["runs"]) if run.event in slots]
                return _Planned([_words(COMES_BACK, slots[run.event], before) for run in left], [], [], edit["number"],
                                left)
            changes = day.undone(changes_of(edit))
            day.applied(before.slots, changes)
            return _Planned(day.words(changes, before.today), changes, undoes=edit["number"])
        if action == ADVANCE:
            return self._advance(before, values)
        changes = day.EDITS[action](before, values)
        return _Planned(day.words(changes, before.today), changes)

    def _advance(self, before: Day, values: Mapping[str, Any]) -> _Planned:
        """Let the teams that advance from a stage take the events of the tests that only they run."""
        found = self._in_loop(lambda: self._box.day.advancing(values["stage"]))
        known = self._configuration.content.config.benchmarks
        changes = day.advance(before, values, found.teams, [known[code] for code in found.tests if code in known])
        coming = [event for event in before.to_come if before.slots[event].benchmark in found.of_all]
        still = [STILL(number=len(coming), stage=found.stage)] if coming else []
        return _Planned([*found.said, *day.words(changes, before.today)], changes, warnings=[*still, *found.remarks])


def _words(template: Template, slot: PlannedSlot, today: Day) -> Reason:
    return template(event=slot.name, time=day.shown(slot.scheduled, today.today), zone=slot.zone)


def _of_team(before: Day, values: Mapping[str, Any]) -> List[str]:
    """Return the events to come from which a team withdraws. Raises `Refused`."""
    team, event, when = values["team"], values["event"], values["day"]
    found: Sequence[str] = [name for name, slot in before.slots.items() if name in before.open and slot.team == team
                            and event in ("", name) and when in ("", day.day_of(slot.scheduled))]
    if not found:
        raise Refused([NOTHING_OF_TEAM(team=team)])
    return sorted(found, key=lambda name: before.slots[name].scheduled)
