"""What clients may call through the door of the box (docs/door.md, "Calls"), and what the original services call.

Everything runs in the core's loop, but for the waits until something is on the disks.
"""

import logging
from typing import Any, Callable, Dict, List, Mapping, NamedTuple, Optional

from roah_rsbb.box import standby_answers
from roah_rsbb.core.actions.table import Target
from roah_rsbb.core.box import Box
from roah_rsbb.core.desks import RunJudging
from roah_rsbb.core.views import sheets
from roah_rsbb.document.calls import Call, Caller, Waiting
from roah_rsbb.model.actions import EVERY
from roah_rsbb.model.as_json import to_json
from roah_rsbb.model.clock import Now
from roah_rsbb.model.document import Document
from roah_rsbb.model.fields import is_encodable
from roah_rsbb.model.reason import Refused, RunName, checked_who, encode, say
from roah_rsbb.model.results import RunSheet
from roah_rsbb.wording import whole_box

# The answer if a result counts, but is not on the disk yet.
NOT_SAVED = say("not saved: {why}. It counts, and is saved as soon as the disk can be written: do not enter it again. "
                "Free or repair the disk of log_dir")
NOT_RECORDED = say("not saved: internal error. It counts until the box ends. Report the error in the box's log")
NO_OBJECT = say("The values of the fields are not a JSON object, such as {example}")(example='{"robot": "r1"}')
UNKNOWN = say("The call has {name}, which is unknown: the values of the fields of an action go into given")
NO_TEXT = say("{name} is not a text of at most {most} characters")
# The longest valid note has 500 characters. Processing a huge text would delay all zones.
MAX_TEXT = 5000
ARGUMENTS_OF_ACT = {"action", "zone", "run", "event", "given", "by", "node"}

_log = logging.getLogger(__name__)


class Disks(NamedTuple):
    """How the box waits until what was done is on the disks."""

    ticket: Callable[[], Optional[int]]  # the journal's of the last change; None: its record failed
    why_not_saved: Callable[[int], str]  # blocks until it is on the disk; returns why it is not
    ask_standby: Callable[[int], Optional[standby_answers.Answer]]  # None: the answer does not wait for it
    why_not_recorded: Callable[[int], str]  # without a wait; empty: it is, or will be within a moment


NO_DISKS = Disks(lambda: 0, lambda ticket: "", lambda ticket: None, lambda ticket: "")


class BoxCalls:
    """The calls of one box."""

    def __init__(self, box: Box, event: Callable[..., None], disks: Disks = NO_DISKS) -> None:
        """`event` calls a method of the box with arguments, in the loop's thread."""
        self._box, self._event, self._disks = box, event, disks

    def named(self) -> Dict[str, Call]:
        """Return all calls by their names."""
        return {"act": self._act, "stop": self._stop, "sheet": self._sheet, "judges": self._judges}

    def do(self, waits: bool, method: Callable[..., object], *arguments: object) -> Callable[[], str]:
        """Call a method of the box with arguments. Return what waits, in another thread, until the change is on the
        disks, and says why it is not; empty: it is. `waits`: the answer waits for that. Raises `Refused`."""
        disks = self._disks
        disks.ticket()  # discards earlier internal errors: only this event counts
        self._event(method, *arguments)
        ticket = disks.ticket()
        # The standby is asked at once: it writes while the disk of this computer does.
        of_standby = disks.ask_standby(ticket) if waits and ticket is not None else None

        def wait() -> str:
            if ticket is None:
                return NOT_RECORDED if waits else ""
            why = disks.why_not_saved(ticket) if waits and ticket else ""
            return NOT_SAVED(why=why) if why else standby_answers.wait(of_standby)

        return wait

    def act(self, target: Target, action: str, who: str, given: Mapping[str, Any]) -> Waiting:
        """Do one of `model.actions.EVERY`. Raises `Refused`."""
        known = EVERY.get(action)
        wait = self.do(known is None or known.durable, self._box.act, target, action, who, given)
        return Waiting(wait, self._box.entries.outcome(target, action, given) or None)

    def stop(self, name: RunName, who: str) -> Callable[[], str]:
        """Stop a run; see `do`. Raises `Refused`."""
        return self.do(False, self._box.scores.stop, name, who)

    def sheet(self, name: RunName, event: str = "") -> RunSheet:
        """Return the score sheet of a run, or of an event; see `ScoreDesk.record_of`. Raises `Refused`."""
        def look(now: Now) -> None:
            record = self._box.scores.record_of(now, name, event)
            found.append(sheets.run_sheet(record, self._box.scores.why(now, record.identity)))

        found: List[RunSheet] = []
        self._event(look)
        return found[0]

    def judging(self, name: RunName, judge: str = "") -> RunJudging:
        """Return what a judge may see of a run; without a name, what the head referee may see. Raises `Refused`."""
        found: List[RunJudging] = []
        self._event(lambda now: found.append(self._box.judges.judging(now, name, judge)))
        return found[0]

    # -- through the door -----------------------------------------------------------------------------

    def _act(self, found: Mapping[str, Any], caller: Caller) -> Any:
        for name in sorted(found.keys() - ARGUMENTS_OF_ACT):
            raise Refused([UNKNOWN(name=repr(name[:40]))])
        given = found.get("given", {})
        if not isinstance(given, dict):
            raise Refused([NO_OBJECT])
        target = Target(text(found, "zone"), text(found, "run"), text(found, "event"))
        waiting = self.act(target, text(found, "action"), who_of(found), given)
        action = EVERY.get(text(found, "action"))
        return waiting if action is not None and action.durable else waiting.answer

    def _stop(self, found: Mapping[str, Any], caller: Caller) -> Any:
        """STOP has left when this returns. It waits for no disk; the answer says where it is missing."""
        self.stop(run_of(found), who_of(found))
        ticket = self._disks.ticket()
        why = "" if ticket is None else self._disks.why_not_recorded(ticket)
        return {"unsaved": encode(why)} if why else None

    def _sheet(self, found: Mapping[str, Any], caller: Caller) -> Any:
        return to_json(self.sheet(run_of(found), text(found, "event")))

    def _judges(self, found: Mapping[str, Any], caller: Caller) -> Any:
        return to_json(sheets.judged_run(self.judging(run_of(found), text(found, "judge"))))


def exit_call(document: Callable[[], Document], end: Callable[[], Any]) -> Call:
    """Return the call `exit`. `document` returns the box's newest one; `end` ends the box, and returns what a `Call`
    does."""
    def carried_out(found: Mapping[str, Any], _caller: Caller) -> Any:
        box = document()
        # Those of a superseded box continue on the one that took over.
        runs = "" if box.box.superseded_by else whole_box.runs_in_progress(box.zones.values())
        if runs and found.get("anyway") is not True:
            raise Refused([whole_box.IN_PROGRESS(runs=runs)])
        _log.info("The box ends, because %s asked for it", checked_who(who_of(found)) or "a client")
        return end()

    return carried_out


def text(found: Mapping[str, Any], name: str) -> str:
    """Return a text in the arguments of a call; empty: it is not among them. Raises `Refused`."""
    value = found.get(name, "")
    if not isinstance(value, str) or len(value) > MAX_TEXT or not is_encodable(value):
        raise Refused([NO_TEXT(name=name, most=MAX_TEXT)])
    return value


def run_of(found: Mapping[str, Any]) -> RunName:
    """Return the run that a call names. Raises `Refused`."""
    return RunName(text(found, "zone"), text(found, "run"))


def who_of(found: Mapping[str, Any]) -> str:
    """Return who calls: the name that the referee typed, and the program. Raises `Refused`."""
    return full_name(text(found, "by"), text(found, "node"))


def full_name(name: str, node: str) -> str:
    """Return who calls, for the records: the name that the referee typed, if any, and the program."""
    name = name.strip()
    return f"{name} ({node})" if name and node else name or node
