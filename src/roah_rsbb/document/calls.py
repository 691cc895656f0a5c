"""Calls through the door: what a function of the core returns, and its answer as JSON.

An answer is `{"answer": …}`, or `{"refused": [reasons]}` if nothing was done, or, with `"known": false`, if it was done
and counts but is not on the disks yet. The reasons are those of `model/reason.py`.
"""

from typing import Any, Callable, Dict, Mapping, NamedTuple, Union

from roah_rsbb.model.reason import Refused, encoded

MAX_MESSAGE_BYTES = 64 * 1024  # of a client's message to the door
HELPER = "helper"  # the face of a program that only calls and offers calls: it is sent no document
# Between the box and the program that copies its journal (docs/door.md, "Calls of the program that copies"): its
# reports, what the standby has, the box's question, and STOPs that are not in the journal yet.
COPY_REPORT, COPIED, COPY, STOPPED = "copy_report", "copied", "copy", "stopped"
EXIT = "exit"  # ends the box
EDIT, EDITS = "edit", "edits"  # of the schedule of the day: looks at one, or does it; lists them
# Those of the home devices (docs/door.md, "Calls of the home devices").
DEVICES, SET_DEVICE = "devices", "set_device"
# What can be set beside `protocol.SWITCHES` and `PERCENTAGES`: the door and window detector, and a ring of the bell.
DOOR, RING = "door_win_detect", "bell"


class Caller(NamedTuple):
    """Who calls: the kind of face, such as referee, and its address."""

    face: str = ""
    address: str = ""


class InThread(NamedTuple):
    """What a call returns whose answer takes long: `make` is called in a thread, and returns it. It may raise
    `Refused`."""

    make: Callable[[], Any]


class Waiting(NamedTuple):
    """What a call returns whose answer waits until what it did is on the disks. `wait` blocks, so it is called in a
    thread, and returns why it is not there (a reason); empty: it is."""

    wait: Callable[[], str]
    answer: Any = None


# A call is carried out in the core's loop with its arguments. It returns its answer (JSON), or one of the above. It may
# raise `Refused`.
Call = Callable[[Mapping[str, Any], Caller], Any]
Answered = Dict[str, Any]
Later = Union[InThread, Waiting]


def carried_out(call: Call, arguments: Mapping[str, Any], caller: Caller) -> Union[Later, Answered]:
    """Carry a call out; returns its answer, or what it waits for (see `waited`)."""
    try:
        found = call(arguments, caller)
    except Refused as refused:
        return {"refused": encoded(refused.reasons)}
    return found if isinstance(found, (InThread, Waiting)) else {"answer": found}


def waited(waiting: Later) -> Answered:
    """Make the answer of a call that takes long, in a thread."""
    if isinstance(waiting, InThread):
        try:
            return {"answer": waiting.make()}
        except Refused as refused:
            return {"refused": encoded(refused.reasons)}
    trouble = waiting.wait()
    return {"refused": encoded([trouble]), "known": False} if trouble else {"answer": waiting.answer}


PAIR, PAIRED, REVOKE, TEAM_CODES = WEB_CALLS = ("pair", "paired", "revoke", "team_codes")
