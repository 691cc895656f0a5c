"""What is entered for one run: the entries of the table for the desks of the box."""

from typing import Any, Callable, Dict, List, Mapping, NamedTuple

from roah_rsbb.core.actions.record import CommandRecord
from roah_rsbb.core.actions.table import Target, is_plain
from roah_rsbb.core.judge_desk import JudgeDesk
from roah_rsbb.core.score_desk import ScoreDesk
from roah_rsbb.core.zones import Zones
from roah_rsbb.model import fields
from roah_rsbb.model.actions import ENTRIES, JUDGE_MARK, JUDGES, MARK
from roah_rsbb.model.clock import Now
from roah_rsbb.model.reason import Refused, RunName, say
from roah_rsbb.scoring.sheet import Mark

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
            "take_back": _Entry(
                lambda now, run, who, given: scores.take_back(now, run, given["id"], who, given["note"])),
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
                lambda now, run, who, given: judges.object(now, run, given["by"], given["text"], who), PUBLICATION),
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
        entry, item = (self._scores.outcome(run, mark) if name == MARK else
                       self._judges.outcome(run, mark, given["judge"]))
        return {"number": entry, "value": item.value, "not_attempted": item.not_attempted, "text": item.text}


def _has_no_value(values: Mapping[str, Any], given: Mapping[str, Any]) -> bool:
    """Whether a mark gives its item no value: it would set it to 0. An empty text takes a judge's rating away."""
    return "not_attempted" in values and "value" not in given and not (
        any(values.get(name) for name in _SETS) or (given.get("judge") and "text" in given))


def _asked(values: Mapping[str, Any]) -> Dict[str, Any]:
    """Return the values of an entry as the journal has them."""
    asked = dict(values)
    if "desc" in values:
        decides = next((name for name in _SETS if values.get(name)), "text" if values.get("judge") else "value")
        others = {*_SETS, "judge"} - ({decides, "judge"} if decides in ("text", "value") else {decides})
        asked = {name: value for name, value in values.items() if name not in others}
    return _journaled(asked)


def _journaled(values: Mapping[str, Any]) -> Dict[str, Any]:
    """Return values by the names that the journal has for their fields."""
    return {_JOURNALED.get(name, name): value for name, value in values.items()}


def mark_of(given: Mapping[str, Any]) -> Mark:
    """Return the mark in the values of an entry's fields."""
    return Mark(**{field: given[field] for field in Mark._fields if field in given})
