"""Suggestions for an unknown word: the choice that was probably meant, or all choices."""

import difflib
import itertools
from typing import Iterable, Optional

from roah_rsbb.model.reason import say

# Comparing takes long with many choices and long words. No competition has so many teams.
MAX_CHOICES = 200
MAX_WORD = 100

DID_YOU_MEAN, THERE_IS = say(": did you mean '{choice}'?"), say(": there is {choices}")


def nearest(word: str, choices: Iterable[str]) -> Optional[str]:
    """Return the choice that `word` was probably meant to be, ignoring case; None if none is similar."""
    by_folded = {choice.casefold(): choice for choice in itertools.islice(choices, MAX_CHOICES)}
    near = difflib.get_close_matches(word[:MAX_WORD].casefold(), list(by_folded), n=1)
    return by_folded[near[0]] if near else None


def did_you_mean(word: str, choices: Iterable[str]) -> str:
    """Return the end of an error message about an unknown word: the nearest choice, or else all of them."""
    choices = list(choices)
    near = nearest(word, choices)
    if near is not None:
        return DID_YOU_MEAN(choice=near)
    return THERE_IS(choices=", ".join(f"'{choice}'" for choice in choices))
