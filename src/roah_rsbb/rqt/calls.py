"""Calls of the box, and of other nodes' services, which never block: outcomes are delivered on the Qt thread. And what
the referee changed with them, until what is published contains it.
"""

import collections
import contextlib
import threading
import uuid
from typing import Any, Callable, Counter, Dict, Generic, Hashable, Mapping, NamedTuple, Optional, TypeVar

from roah_rsbb.client.client import Answer, Client
from roah_rsbb.model.actions import MARK
from roah_rsbb.model.document import Document
from roah_rsbb.rqt.qt import QObject, QTimer, Signal
from roah_rsbb.wording.language import tr, tr_said

# Timeout of a call. A later answer is ignored.
TIMEOUT_S = 5.0
# Limit of calls of a service that wait at the same time: a node that hangs must not fill this process with threads.
MAX_WAITING = 16
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
    number: int = 0  # of the document that contains what it did


Done = Callable[[CallOutcome], None]


class CallFailed(Exception):
    """A call failed; the text is for the referee."""

    def __init__(self, text: str, is_answered: bool) -> None:
        """`is_answered`: otherwise it may have been carried out."""
        super().__init__(text)
        self.is_answered = is_answered


class _Waiting(NamedTuple):
    owner: object
    done: Done


class Calls(QObject):
    """Makes all calls of a process. Use it from the Qt thread only."""

    _answered = Signal(int, object)

    def __init__(self, afar: Client[Document], referee: RefereeName, node: Callable[[], str]) -> None:
        """`referee`, `node`: their name, and that of this program, go with each call."""
        super().__init__()
        self._node = node
        self._afar = afar
        self._referee = referee
        self._waiting: Dict[int, _Waiting] = {}
        self._threads: Counter[str] = collections.Counter()  # by what they call
        self._next = 0
        self._answered.connect(self._deliver)

    @property
    def are_waiting(self) -> bool:
        """Whether a call waits for its answer."""
        return bool(self._waiting) or any(self._threads.values())

    # -- of the box -----------------------------------------------------------------------------------

    def call(self, owner: object, name: str, done: Done, again: bool = False, **arguments: Any) -> None:
        """Make a call of the box (docs/door.md, "Calls"). `done` receives the outcome, unless `owner` was forgotten.
        `again`: see `Client.call`."""
        self._afar.call(name, self._on_answer(owner, name, done), TIMEOUT_S, again, **{**arguments, **self._who()})

    def act(
        self, owner: object, action: str, zone: str, run: str, given: Mapping[str, Any], done: Done, event: str = "",
        again: bool = False,
    ) -> None:
        """Do one of `model.actions.EVERY`. `run`, `event`: what the referee means; `given`: the values of its
        fields."""
        self.call(owner, "act", done, again, action=action, zone=zone, run=run, event=event, given=dict(given))

    def mark(self, owner: object, zone: str, run: str, given: Mapping[str, Any], done: Done) -> None:
        """Mark a scoring item. `given`: the values of the action's fields, without an id.

        The core applies a mark once. So it is sent again while there is no answer, for example while the core restarts.
        """
        self.act(owner, MARK, zone, run, {**given, "id": str(uuid.uuid4()), "role": ROLE}, done, again=True)

    def stop(self, owner: object, zone: str, run: str, done: Done) -> None:
        """Stop a run: on a way of its own, again and again for `TIMEOUT_S`."""
        self._afar.stop(zone, run, self._on_answer(owner, "stop", done), TIMEOUT_S, **self._who())

    def _who(self) -> Dict[str, str]:
        return {"by": self._referee.name, "node": self._node()}

    def _on_answer(self, owner: object, name: str, done: Done) -> Callable[[Answer], None]:
        """Return what takes the answer, in the client's thread."""
        token = self._wait(owner, done)
        return lambda answer: self._emit(token, lambda: self._outcome(name, answer))

    def _outcome(self, name: str, answer: Answer) -> CallOutcome:
        if answer.is_answered:
            return CallOutcome("; ".join(map(tr_said, answer.reasons)), answer.answer, True, answer.number)
        return CallOutcome(tr("no answer: {why} ({error})", why=missing(), error=self._afar.why)
                           if self._afar.why else _late(name), is_answered=False)

    # -- of other programs ----------------------------------------------------------------------------

    def run(self, owner: object, what: str, job: Callable[[], Any], done: Done) -> None:
        """Run `job`, which may raise `CallFailed`, in a thread; `done` receives its result or error, unless `owner` was
        forgotten."""
        if self._threads[what] >= MAX_WAITING:
            done(CallOutcome(tr("{what}: not sent, because {n} commands are still waiting for an answer",
                                what=what, n=self._threads[what]), is_answered=False))
            return
        self._threads[what] += 1
        token = self._wait(owner, done)
        QTimer.singleShot(int(TIMEOUT_S * 1000), lambda: self._deliver(
            token, lambda: CallOutcome(_late(what), is_answered=False)))
        threading.Thread(target=self._work, args=(token, what, job), name=what, daemon=True).start()

    def forget(self, owner: object) -> None:
        """Deliver nothing more to `owner`, which is closing."""
        self._waiting = {t: w for t, w in self._waiting.items() if w.owner is not owner}

    def _work(self, token: int, what: str, job: Callable[[], Any]) -> None:
        try:
            outcome = CallOutcome("", job())
        except Exception as e:  # the referee reads any error beside the command
            outcome = CallOutcome(str(e) or type(e).__name__, None, isinstance(e, CallFailed) and e.is_answered)

        def ended() -> CallOutcome:
            self._threads[what] -= 1
            return outcome

        self._emit(token, ended)

    # -- answers --------------------------------------------------------------------------------------

    def _wait(self, owner: object, done: Done) -> int:
        self._next += 1
        self._waiting[self._next] = _Waiting(owner, done)
        return self._next

    def _emit(self, token: int, make: Callable[[], CallOutcome]) -> None:
        """Hand an outcome to the Qt thread, which also makes it: texts are translated there."""
        with contextlib.suppress(RuntimeError):  # the process is ending
            self._answered.emit(token, make)

    def _deliver(self, token: int, make: Callable[[], CallOutcome]) -> None:
        outcome, waiting = make(), self._waiting.pop(token, None)
        if waiting is not None:
            waiting.done(outcome)


def _late(what: str) -> str:
    return tr("{what}: no answer within {time:.0f} s: {why}", what=what, time=TIMEOUT_S, why=missing())


def missing() -> str:
    """Return what to check if there was no answer."""
    return tr("is the box running? Check the state when it is back.")


Value = TypeVar("Value", bound=Hashable)  # any value but None
Mark = TypeVar("Mark")


class _Edit(NamedTuple):
    wish: Hashable
    sent: Optional[Hashable]  # value in the call that waits for its answer; None: answered
    mark: object = None  # of the answer


class Edits(Generic[Mark]):
    """Edits by item. Each item has at most one call in progress, so that calls cannot overtake each other."""

    def __init__(self, is_confirmed: Callable[[Mark], bool]) -> None:
        """`is_confirmed`: whether what is published now contains a change, by the mark of its answer."""
        self._is_confirmed = is_confirmed
        self._edits: Dict[Hashable, _Edit] = {}

    def wish(self, item: Hashable, value: Value) -> Optional[Value]:
        """Note that the referee set `value`. Returns the value to send now; None: another call is in progress."""
        edit = self._edits.get(item)
        if edit is not None and edit.sent is not None:
            self._edits[item] = edit._replace(wish=value)
            return None
        self._edits[item] = _Edit(value, sent=value)
        return value

    def carried_out(self, item: Hashable, mark: Mark, is_now: Optional[Hashable] = None) -> Optional[Hashable]:
        """Note that the call was answered. Returns the value to send next, if it changed meanwhile.

        `is_now`: the value of the item after the call, if the answer has it. Others may have changed it, too.
        """
        edit = self._edits.get(item)
        if edit is None:
            return None
        if edit.wish != edit.sent:
            self._edits[item] = _Edit(edit.wish, sent=edit.wish)
            return edit.wish
        self._edits[item] = _Edit(edit.wish if is_now is None else is_now, None, mark)
        return None

    def failed(self, item: Hashable) -> None:
        """Note that the call failed. The item shows the published value again."""
        self._edits.pop(item, None)

    def value(self, item: Hashable, published: Value) -> Value:
        """Return the value to show while `published` is published."""
        edit = self._edits.get(item)
        if edit is None:
            return published
        if edit.sent is None and self._is_confirmed(edit.mark):
            del self._edits[item]
            return published
        return edit.wish

    def is_waiting(self, item: Hashable) -> bool:
        """Whether a change of this item is still waiting for its answer."""
        edit = self._edits.get(item)
        return edit is not None and edit.sent is not None

    def clear(self) -> None:
        """Forget all edits: other items are shown."""
        self._edits.clear()
