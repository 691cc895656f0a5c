"""How a result becomes final: it is published as provisional, teams may object, and it is signed off. The rules may
give time for objections after that, too.

The time limit is a time of day, because teams read it, and because it must survive a restart of the computer.
"""

import math
from dataclasses import dataclass, field
from typing import List, Optional

from roah_rsbb.model.clock import Now
from roah_rsbb.model.reason import Refused, joined, say
from roah_rsbb.model.records import By, Objection, PublicationRecord, Published
from roah_rsbb.model.scoring import SheetForm
from roah_rsbb.wording import times

MAX_OBJECTIONS = 50
# Seconds. The time limit of a rulebook has the same bound.
MAX_OBJECTION_TIME_S = 86400.0

TOO_LATE = say("objections were possible until {time}. An organiser who finds the score wrong can reopen the sheet")
UNTIL = say("objections are possible until {time}: wait, or publish again with a shorter time limit")


@dataclass
class PublicationState:
    """The publication of a result, and the objections to it."""

    published: Optional[Published] = None
    objections: List[Objection] = field(default_factory=list)

    @classmethod
    def of(cls, record: PublicationRecord) -> "PublicationState":
        """Return the state that a record contains."""
        return cls(record.published, list(record.objections))


class Publication:
    """The publication of the result of one run."""

    def __init__(self, form: SheetForm, state: PublicationState) -> None:
        self.state = state
        self._limit_s, self._protest_s = form.objection_time, form.protest_time

    def publish(self, now: Now, by: By, seconds: float) -> str:
        """Publish the result as provisional. `seconds`: time for objections; negative: that of the benchmarks file.

        A result can be published again, with another time limit. Returns a text for the referees, as all changes do.
        Raises `Refused`.
        """
        limit_s = self._limit_s if seconds < 0 else seconds
        if limit_s > MAX_OBJECTION_TIME_S:
            raise Refused([say("{limit} s for objections: at most {most} are possible")(
                limit=f"{limit_s:g}", most=f"{MAX_OBJECTION_TIME_S:g}")])
        self.state.published = Published(now.utc, by.who, now.utc + limit_s)
        return f"Published as provisional: objections are possible until {times.at_venue(now.utc + limit_s)}"

    def until(self, signed_utc: float) -> float:
        """Return until when (UTC seconds) objections are possible. `signed_utc`: of the sign-off; 0.0: none."""
        if self._protest_s and (signed_utc or not self._limit_s):
            return signed_utc + self._protest_s if signed_utc else math.inf
        published = self.state.published
        return math.inf if published is None else published.until_utc

    def object(self, now: Now, who: str, by: str, text: str, second: int, signed_utc: float) -> str:
        """Enter an objection of `by` about a second of the run. Raises `Refused`."""
        if self.state.published is None and self._limit_s and not signed_utc:
            raise Refused([say("the result is not published yet: publish it as provisional first")])
        until = self.until(signed_utc)
        if now.utc > until:
            raise Refused([TOO_LATE(time=times.at_venue(until)) if signed_utc else
                           say("objections were possible until {time}: the organiser can publish the result again, "
                               "with another time limit")(time=times.at_venue(until))])
        missing = [name for name, value in (
            (say("who objects"), by), (say("the text of the objection"), text)) if not value]
        if missing:
            raise Refused([say("enter {missing}")(missing=joined(missing, ", "))])
        if len(self.state.objections) >= MAX_OBJECTIONS:
            raise Refused([say("{most} objections were entered: no more are kept")(most=MAX_OBJECTIONS)])
        number = len(self.state.objections) + 1
        self.state.objections.append(Objection(number, now.utc, by, text, who, second=second))
        return f"Objection {number} of {by}: {text}"

    def answer(self, now: Now, by: By, number: int, upheld: bool) -> str:
        """Answer an objection. A new answer replaces an earlier one. Raises `Refused`."""
        if not 1 <= number <= len(self.state.objections):
            raise Refused([say("there is no objection {number}: {count} were entered")(
                number=number, count=len(self.state.objections))])
        if not by.reason:
            raise Refused([say("an answer to an objection needs a text: type one")])
        objection = self.state.objections[number - 1]
        self.state.objections[number - 1] = objection._replace(
            answered_utc=now.utc, answered_by=by.who, upheld=upheld, answer=by.reason)
        return f"Objection {number} of {objection.by} {'upheld' if upheld else 'rejected'}: {by.reason}"

    def not_ready(self, now: Now) -> List[str]:
        """Return why the result cannot become final; empty: it can, as far as objections are concerned."""
        state = self.state
        waiting = [str(objection.number) for objection in state.objections if not objection.answered_utc]
        reasons: List[str] = [] if not waiting else [
            say("answer objection {numbers} first")(numbers=", ".join(waiting))]
        if state.published is None and self._limit_s:
            reasons.append(say("publish the result as provisional first: the rules give time for objections"))
        if state.published is not None and now.utc < state.published.until_utc:
            until = times.at_venue(state.published.until_utc)
            reasons.append(UNTIL(time=until))
        return reasons

    def record(self) -> PublicationRecord:
        """Return the state in the form in which the run's record contains it."""
        return PublicationRecord(self.state.published, tuple(self.state.objections))
