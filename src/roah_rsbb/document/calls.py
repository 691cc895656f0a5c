"""Calls through the door: what a function of the core returns, and its answer as JSON.

An answer is `{"answer": …}`, or `{"refused": [reasons]}` if nothing was done, or, with `"known": false`, if it was done
and counts but is not on the disks yet. The reasons are those of `model/reason.py`.
"""

from typing import Any, Callable, Dict, Mapping, NamedTuple, Union

from roah_rsbb.model.reason import encoded
from roah_rsbb.model.referee import Refused


class Caller(NamedTuple):
    """Who calls: the kind of face, such as referee, and its address."""

    face: str = ""
    address: str = ""


class Waiting(NamedTuple):
    """What a call returns whose answer waits until what it did is on the disks. `wait` blocks, so it is called in a
    thread, and returns why it is not there (a reason); empty: it is."""

    wait: Callable[[], str]
    answer: Any = None


# A call is carried out in the core's loop with its arguments. It returns its answer (JSON), or `Waiting`. It may raise
# `Refused`.
Call = Callable[[Mapping[str, Any], Caller], Any]
Answered = Dict[str, Any]


def carried_out(call: Call, arguments: Mapping[str, Any], caller: Caller) -> Union[Waiting, Answered]:
    """Carry a call out; returns its answer, or for what it waits (see `waited`)."""
    try:
        found = call(arguments, caller)
    except Refused as refused:
        return {"refused": encoded(refused.reasons)}
    return found if isinstance(found, Waiting) else {"answer": found}


def waited(waiting: Waiting) -> Answered:
    """Wait, in a thread, until what was done is on the disks; returns the answer."""
    trouble = waiting.wait()
    return {"refused": encoded([trouble]), "known": False} if trouble else {"answer": waiting.answer}
