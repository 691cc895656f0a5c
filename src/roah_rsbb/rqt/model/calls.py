"""Service calls off the Qt thread. Their outcome is delivered on the Qt thread."""

import collections
import contextlib
import json
import threading
import time
import uuid
from typing import Any, Callable, Counter, Dict, Mapping, NamedTuple

import rospy

from roah_rsbb.model.actions import MARK
from roah_rsbb.model.fields import given_text
from roah_rsbb.ros import refusals
from roah_rsbb.ros.connections import REFEREE_HEADER
from roah_rsbb.ros.known_services import KnownService
from roah_rsbb.rqt.qt import QObject, QTimer, Signal
from roah_rsbb.srv import Act, GetClock
from roah_rsbb.wording.device import NO_WEB
from roah_rsbb.wording.language import tr
from roah_rsbb.wording.said import tr_said

# Timeout of a call. A later answer is ignored.
TIMEOUT_S = 5.0
# Limit of calls of a service that wait at the same time: a node that hangs must not fill this process with threads.
MAX_WAITING = 16
# It has no such limit: nothing ignores a STOP, and each call ends (known_services.py).
STOP = "/core/stop_run"
# A mark that was not answered is sent again after this time (s).
AGAIN_S = 0.2
# Of the person at a panel, for marks.
ROLE = "referee"


class RefereeName(QObject):
    """The name of the referee at this client. It is recorded with everything that the referee does."""

    changed = Signal(str)

    def __init__(self) -> None:
        super().__init__()
        self.name = ""

    def set(self, name: str) -> None:
        """Set the name, in all panels."""
        if name != self.name:
            self.name = name
            self.changed.emit(name)


class CallOutcome(NamedTuple):
    """How a call ended."""

    error: str  # for the referee; empty: it was carried out
    result: Any = None
    is_answered: bool = True  # false: nobody answered, so it may have been carried out


class Marked(NamedTuple):
    """The result of a mark."""

    clock_s: float  # of the box after it, UTC seconds
    answer: Mapping[str, Any]  # see `Act.answer`


class _Waiting(NamedTuple):
    owner: object
    what: str
    done: Callable[[CallOutcome], None]


class Calls(QObject):
    """Makes all calls of a process. Use it from the Qt thread only."""

    _answered = Signal(int, str, object)

    def __init__(self, referee: RefereeName) -> None:
        """`referee`: their name goes with each call."""
        super().__init__()
        self._referee = referee
        self._waiting: Dict[int, _Waiting] = {}
        self._threads: Counter[str] = collections.Counter()  # by what they call
        self._next = 0
        self._answered.connect(self._on_answer)

    def service(
        self, owner: object, name: str, kind: type, request: tuple, done: Callable[[CallOutcome], None]
    ) -> None:
        """Call the service `name` of type `kind` with the request's fields; `done` receives the outcome."""
        headers = self._headers()
        self.run(owner, name, lambda: KnownService(name, kind, headers=headers)(*request), done)

    def act(
        self, owner: object, action: str, zone: str, run: str, given: Mapping[str, Any],
        done: Callable[[CallOutcome], None], event: str = "", referee: str = "",
    ) -> None:
        """Do one of `model.actions.EVERY`. `run`, `event`: what the referee means, see `Act`; `given`: the values of
        its fields; `referee`: who was asked, if it was somebody before a change of the name."""
        self.service(owner, "/core/act", Act, (action, zone, run, event, given_text(given), referee), done)

    def learn(self, owner: object, name: str, kind: type) -> None:
        """Find the service `name`, so that a later call does not depend on the master."""
        self.run(owner, f"{name}/address", KnownService(name, kind).learn, lambda outcome: None)

    def mark(self, owner: object, zone: str, run: str, given: Mapping[str, Any],
             done: Callable[[CallOutcome], None]) -> None:
        """Mark a scoring item; the result is a `Marked`. `given`: the values of the action's fields, without an id.

        The core applies a mark once. So it is sent again while there is no answer, for example while the core restarts.
        Only messages with a later clock than that of the result surely contain the mark.
        """
        mark = given_text({**given, "id": str(uuid.uuid4()), "role": ROLE})
        headers = self._headers()

        def job() -> Marked:
            answer = _until_answered(
                lambda: KnownService("/core/act", Act, headers=headers)(MARK, zone, run, "", mark, ""))
            return Marked(KnownService("/core/clock", GetClock)().clock.to_sec(), json.loads(answer.answer))

        self.run(owner, MARK, job, done)

    def run(self, owner: object, what: str, job: Callable[[], Any], done: Callable[[CallOutcome], None]) -> None:
        """Run `job` in a thread; `done` receives its result or error, unless `owner` was forgotten."""
        if what != STOP and self._threads[what] >= MAX_WAITING:
            done(CallOutcome(tr("{what}: not sent, because {n} commands are still waiting for an answer",
                                what=what, n=self._threads[what]), is_answered=False))
            return
        self._threads[what] += 1
        self._next += 1
        token = self._next
        self._waiting[token] = _Waiting(owner, what, done)
        QTimer.singleShot(int(TIMEOUT_S * 1000), lambda: self._on_late(token))
        threading.Thread(target=self._work, args=(token, what, job), name=what, daemon=True).start()

    def _headers(self) -> Dict[str, str]:
        who = {REFEREE_HEADER: self._referee.name} if self._referee.name else {}
        return {refusals.HEADER: refusals.VALUES, **who}

    def forget(self, owner: object) -> None:
        """Deliver nothing more to `owner`, which is closing."""
        self._waiting = {t: w for t, w in self._waiting.items() if w.owner is not owner}

    def _work(self, token: int, what: str, job: Callable[[], Any]) -> None:
        try:
            outcome = CallOutcome("", job())
        except Exception as e:  # the referee reads any error beside the command
            outcome = CallOutcome(failure_text(str(e)) or type(e).__name__, None, refusals.was_answered(str(e)))
        with contextlib.suppress(RuntimeError):  # the process is ending
            self._answered.emit(token, what, outcome)

    def _on_answer(self, token: int, what: str, outcome: CallOutcome) -> None:
        self._threads[what] -= 1
        self._deliver(token, outcome)

    def _on_late(self, token: int) -> None:
        if token in self._waiting:
            what = self._waiting[token].what
            self._deliver(token, CallOutcome(
                tr("{what}: no answer within {time:.0f} s: {why}", what=what, time=TIMEOUT_S, why=_missing(what)),
                is_answered=False))

    def _deliver(self, token: int, outcome: CallOutcome) -> None:
        waiting = self._waiting.pop(token, None)
        if waiting is not None:
            waiting.done(outcome)


def _until_answered(call: Callable[[], Any]) -> Any:
    """Call until there is an answer, or the time is over. It waits in its own thread, because a start of the core is no
    event here."""
    until_mono = time.monotonic() + TIMEOUT_S
    while True:
        try:
            return call()
        except rospy.ServiceException as error:
            if refusals.was_answered(str(error)) or time.monotonic() + AGAIN_S > until_mono:
                raise
        time.sleep(AGAIN_S)


def _missing(text: str) -> str:
    """Return what to check, for a service that `text` names."""
    if "/web/" in text:
        return f"{tr(NO_WEB)}."
    return tr("is the core running? Check the state when it is back.")


# How rospy begins to say that it did not reach a service.
_UNREACHED = ("unable to connect to service", "unable to contact master", "transport error")


def failure_text(raised: str) -> str:
    """Return the core's reasons, or what to check if there was no answer."""
    if raised.endswith("unavailable") or raised.startswith(_UNREACHED):
        return tr("no answer: {why} ({error})", why=_missing(raised), error=raised)
    return "; ".join(map(tr_said, refusals.reasons(raised)))
