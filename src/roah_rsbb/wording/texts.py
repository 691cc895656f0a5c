"""Text from robots, configuration files and people, made safe to show; short lists; and what an unknown word was
probably meant to be."""

import difflib
import itertools
import json
import re
import unicodedata
from typing import Any, Dict, Iterable, List, Optional, Tuple

from roah_rsbb.model.reason import say


def visible(text: str) -> str:
    """Write out every character that cannot be printed, such as ``\\x1b``; line breaks stay.

    Such characters could send commands to a terminal or reverse the direction of writing.
    """
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() or c == "\n" else c.encode("unicode_escape", "replace").decode() for c in text)


def escaped(text: str) -> str:
    """Write out every character that cannot be printed, line breaks too: the text stays in one line."""
    return visible(text).replace("\n", "\\n")


def one_line(text: str) -> str:
    """Make visible text of one line."""
    return " ".join(visible(text).split())


def value_text(value: Any) -> str:
    """Return any JSON value as text."""
    return value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)


def bullets(lines: Iterable[str]) -> str:
    """Return one line unchanged, several as a list."""
    lines = list(lines)
    return "\n".join(lines if len(lines) < 2 else [f"• {line}" for line in lines])


# -- suggestions -----------------------------------------------------------------------------------

# Comparing takes long with many choices and long words. No competition has so many teams.
MAX_CHOICES = 200
MAX_WORD = 100

# Letters of other alphabets, small ones, and the Latin letters that they or their capitals look like; and digits.
_LOOK_ALIKE = str.maketrans(
    "\u0430\u0432\u0435\u043a\u043c\u043d\u043e\u0440\u0441\u0442\u0443\u0445\u0455\u0456\u0458"
    "\u03b1\u03b2\u03b5\u03b7\u03b9\u03ba\u03bc\u03bd\u03bf\u03c1\u03c4\u03c5\u03c7\u0131",
    "abekmhopctyxsij" "abehikmvoptyxi")
_DIGITS = str.maketrans("01i", "oll")
# Words that people add to a team's name or leave out.
_OPTIONAL_WORDS = {"at", "home", "team", "the"}
# Shorter words, and shorter names, that differ in one letter are often two.
_LONG_WORD, _LONG_NAME = 4, 5

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


def twins(names: Iterable[str]) -> List[Tuple[str, str]]:
    """Return the names that may be another spelling of an earlier one, each with that one: in case, spaces, signs,
    accents or look-alike letters, or with a typing error."""
    known: Dict[str, Tuple[str, List[str]]] = {}  # by what is compared first: the name and its words
    found: List[Tuple[str, str]] = []
    for name in itertools.islice(names, MAX_CHOICES):
        words = _words(name)
        same = "".join(words).translate(_DIGITS)
        like = known[same][:1] if same in known else tuple(
            earlier for earlier, others in known.values() if _is_typing_error(words, others))
        known.setdefault(same, (name, words))
        found += [(name, other) for other in like[:1]]
    return found


def _words(name: str) -> List[str]:
    """Return the words of a name without what people write in several ways."""
    letters = unicodedata.normalize("NFKD", name[:MAX_WORD]).casefold().translate(_LOOK_ALIKE)
    words = re.findall(r"[^\W_]+", "".join(each for each in letters if unicodedata.category(each) not in ("Mn", "Cf")))
    return [word for word in words if word not in _OPTIONAL_WORDS] or words or [name]


def _is_typing_error(words: List[str], others: List[str]) -> bool:
    """Return whether names differ in one letter, or in the order of two. A digit, or the last letter, may be what
    distinguishes two teams, as in Tigers1 and TigersB."""
    if len(words) == len(others):
        different = [pair for pair in zip(words, others) if pair[0] != pair[1]]
        if len(different) != 1:
            return False
        one, two = different[0]
    else:
        one, two = "".join(words), "".join(others)
    one, two = sorted((one, two), key=len)
    begin = next((i for i, letter in enumerate(one) if letter != two[i]), len(one))
    rest, longer = one[begin:], two[begin:]
    is_short = len(two) < _LONG_WORD or len("".join(others)) < _LONG_NAME
    if is_short or any(letter.isdigit() for letter in rest[:1] + longer[:1]):
        return False
    if len(rest) == len(longer):
        is_swapped = rest[:2] == longer[1::-1] and rest[2:] == longer[2:]
        return is_swapped or (len(rest) > 1 and rest[1:] == longer[1:])
    return rest == longer[1:]
