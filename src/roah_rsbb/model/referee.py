"""What comes with a referee's command: the run it names, who gives it, their note; and the refusal with its reasons."""

from typing import List, NamedTuple

from roah_rsbb.model.reason import say

# Characters of a note or a reason, and of a name.
MAX_NOTE = 500
MAX_WHO = 120


class Refused(Exception):
    """A referee's command was refused and changed nothing. `reasons` has every reason, each with its remedy."""

    def __init__(self, reasons: List[str]) -> None:
        super().__init__("; ".join(reasons))
        self.reasons = reasons


class RunName(NamedTuple):
    """Names a run of a zone by its identity, so that a mark for one run never goes into the next."""

    zone: str
    identity: str = ""  # empty: the run that is connected in the zone


def note_line(text: str) -> str:
    """Return a typed text as one line that can be shown anywhere."""
    return " ".join("".join(c if c.isprintable() else " " for c in text).split())


def checked_note(text: str) -> str:
    """Return a note or reason as one line; raises `Refused` if it is too long."""
    note = note_line(text)
    if len(note) > MAX_NOTE:
        raise Refused([say("the note has {number} characters: at most {most} are kept, shorten it")(
            number=len(note), most=MAX_NOTE)])
    return note


def cut_note(text: str) -> str:
    """Return a note or reason as one line, cut to the maximum length."""
    return note_line(text[:4 * MAX_NOTE])[:MAX_NOTE]


def checked_who(who: str) -> str:
    """Return a name as one line, cut to the maximum length."""
    return note_line(who[:4 * MAX_WHO])[:MAX_WHO]
