"""What is entered for one run: the entries of the table for the desks of the box."""

from typing import Any, Callable, Dict, Mapping

from roah_rsbb.core.actions.record import CommandRecord
from roah_rsbb.core.actions.table import Target, is_plain
from roah_rsbb.core.clock import Now
from roah_rsbb.core.judges.desk import JudgeDesk
from roah_rsbb.core.referee import Refused, RunName
from roah_rsbb.core.scoring.desk import ScoreDesk
from roah_rsbb.core.scoring.sheet import Mark
from roah_rsbb.model import fields
from roah_rsbb.model.actions import ENTRIES, JUDGE_MARK, MARK

# What an entry does with the run, who enters it and the values of its fields. The desks record it.
Enter = Callable[[Now, RunName, str, Mapping[str, Any]], None]


class Entries:
    """All of `model.actions.ENTRIES`."""

    def __init__(self, scores: ScoreDesk, judges: JudgeDesk, record: CommandRecord) -> None:
        self._record = record
        self._scores = scores
        self._judges = judges
        self._all: Dict[str, Enter] = {
            MARK: lambda now, run, who, given: scores.mark(now, run, mark_of(given), who),
            JUDGE_MARK: lambda now, run, who, given: judges.mark(
                now, run, mark_of(given)._replace(judge=""), given["judge"]),
            "withdraw": lambda now, run, who, given: scores.withdraw(now, run, given["entry"], who, given["note"]),
            "take_back": lambda now, run, who, given: scores.take_back(now, run, given["id"], who, given["note"]),
            "stop_reason": lambda now, run, who, given: scores.give_stop_reason(
                now, run, given["reason"], who, given["stop"]),
            "sign_off": lambda now, run, who, given: scores.sign_off(now, run, who),
            "submit": lambda now, run, who, given: judges.submit(now, run, given["judge"], given["device"]),
            "settle": lambda now, run, who, given: judges.settle(
                now, run, mark_of(given), given["reason"], who),
            "hand_back": lambda now, run, who, given: judges.hand_back(now, run, given["judge"], given["reason"], who),
            "withdraw_sheet": lambda now, run, who, given: judges.withdraw(
                now, run, given["judge"], given["reason"], who),
            "waive": lambda now, run, who, given: judges.waive(now, run, given["reason"], who),
            "publish": lambda now, run, who, given: judges.publish(now, run, given["seconds"], who),
            "object": lambda now, run, who, given: judges.object(now, run, given["by"], given["text"], who),
            "answer": lambda now, run, who, given: judges.answer(
                now, run, given["number"], given["upheld"], given["text"], who),
        }

    def do(self, now: Now, target: Target, name: str, who: str, given: Mapping[str, Any]) -> None:
        """Enter something; see `Actions.do`. Raises `Refused`."""
        run, entry = RunName(target.zone, target.run), ENTRIES[name]
        try:
            values = fields.read(entry.fields, given)
        except fields.BadValue as bad:
            with self._record.of(run, who, name, **{key: value for key, value in given.items() if is_plain(value)}):
                raise Refused([bad.reason]) from None
        self._all[name](now, run, who, values)

    def outcome(self, target: Target, name: str, given: Mapping[str, Any]) -> Dict[str, Any]:
        """Return how the item of a mark that was entered is now, as JSON; of anything else, nothing."""
        if name not in (MARK, JUDGE_MARK):
            return {}
        run, mark = RunName(target.zone, target.run), mark_of(fields.read(ENTRIES[name].fields, given))
        entry, item = (self._scores.outcome(run, mark) if name == MARK else
                       self._judges.outcome(run, mark, given["judge"]))
        return {"number": entry, "value": item.value, "not_attempted": item.not_attempted, "text": item.text}


def mark_of(given: Mapping[str, Any]) -> Mark:
    """Return the mark in the values of an entry's fields."""
    return Mark(**{field: given[field] for field in Mark._fields if field in given})
