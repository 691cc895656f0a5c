"""A command that makes no sense now: it changes nothing and says why, with every reason."""

import difflib
from typing import Iterable, List


class Refused(Exception):
    """A referee's command was refused. `reasons` holds every reason, each with its remedy."""

    def __init__(self, reasons: List[str]) -> None:
        super().__init__("; ".join(reasons))
        self.reasons = reasons


def did_you_mean(word: str, choices: Iterable[str]) -> str:
    """The end of an error message about an unknown word: the nearest choice, else all of them."""
    choices = list(choices)
    near = difflib.get_close_matches(word, choices, n=1)
    if near:
        return f": did you mean '{near[0]}'?"
    return ": there is " + ", ".join(f"'{c}'" for c in choices)
