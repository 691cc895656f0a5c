"""The language of the texts on screens (docs/referee.md, "Language").

The texts in the code are English. A program with windows may set another language. The web pages get their texts in
several languages. All other programs, and everything that is sent or written to files, stay English.
"""

import contextlib
from typing import Any, Callable, Iterator, Optional

# Returns a text in another language; the number is the count in it, or -1 if there is none.
Translate = Callable[[str, int], str]
_translate: Optional[Translate] = None
NO_COUNT = -1


def set_translation(translate: Optional[Translate]) -> None:
    """Show all texts of this process in another language; None: in English."""
    global _translate
    _translate = translate


@contextlib.contextmanager
def in_language(translate: Optional[Translate]) -> Iterator[None]:
    """Make texts in another language within a `with` block; None: in English. Only one thread may make texts then."""
    global _translate
    before, _translate = _translate, translate
    try:
        yield
    finally:
        _translate = before


def is_english() -> bool:
    """Whether all texts of this process are in English."""
    return _translate is None


def tr(text: str, **values: Any) -> str:
    """Return a text in the language of this process, with the values in its places, such as ``{zone}``.

    The value `n` is a count: a language may have other words for one than for several.
    """
    if _translate is not None:
        text = _translate(text, values.get("n", NO_COUNT))
    return text.format(**values) if values else text


def tr_later(text: str) -> str:
    """Return the text unchanged: `tr` translates it where it is shown. Texts of constants are written in it."""
    return text
