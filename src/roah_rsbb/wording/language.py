"""The language of the texts on screens (docs/referee.md, "Language").

The texts in the code are English. A program with windows may set another language. The web pages get their texts in
several languages. All other programs, and everything that is sent or written to files, stay English.
"""

import contextlib
import logging
import re
import string
import threading
from typing import Any, Callable, Iterator, Mapping, Optional, Set

# Returns a text in another language; the number is the count in it, or -1 if there is none.
Translate = Callable[[str, int], str]
_translate: Optional[Translate] = None  # of the process
NO_COUNT = -1
_log = logging.getLogger(__name__)
_reported: Set[str] = set()
# An address and a version with more points are none.
_DECIMAL = re.compile(r"([+-]?\d+)\.(\d+(?: [^\d.]*)?)")


def set_translation(translate: Optional[Translate]) -> None:
    """Show all texts of this process in another language; None: in English."""
    global _translate
    _translate = translate


class _OfThread(threading.local):
    """The language of the texts that a thread makes."""

    is_set = False  # otherwise, it is that of the process
    translate: Optional[Translate] = None


_thread = _OfThread()


def _present() -> Optional[Translate]:
    return _thread.translate if _thread.is_set else _translate


@contextlib.contextmanager
def in_language(translate: Optional[Translate]) -> Iterator[None]:
    """Make the texts of this thread in another language within a `with` block; None: in English."""
    before = _thread.is_set, _thread.translate
    _thread.is_set, _thread.translate = True, translate
    try:
        yield
    finally:
        _thread.is_set, _thread.translate = before


def is_english() -> bool:
    """Whether texts are in English now."""
    return _present() is None


def number(text: str) -> str:
    """Return a decimal number, also one with its unit, with the decimal sign of the present language; another text
    unchanged. A reader of German takes the point of "866.662" for thousands."""
    found = None if is_english() else _DECIMAL.fullmatch(text)
    return text if found is None else tr("{whole}.{decimals}", whole=found[1], decimals=found[2])


class _Filling(string.Formatter):
    """Fills the places of a text, with numbers as people write them."""

    def format_field(self, value: Any, format_spec: str) -> Any:
        return number(str(super().format_field(value, format_spec)))


def tr(text: str, /, **values: Any) -> str:
    """Return a text in the present language, with the values in its places, such as ``{zone}``, and their numbers as
    `number` has them.

    `text` is positional only, because a text may have a place of this name. The value `n` is a count: a language may
    have other words for one than for several. It never raises: a text that
    cannot be translated is in English, and its places stay if even this fails. Each such text is logged once.
    """
    translate = _present()
    if translate is None:
        return _filled(text, values)
    try:
        translated = translate(text, values.get("n", NO_COUNT))
        return _Filling().format(translated, **values) if values else translated
    except Exception as error:  # whatever a catalogue does: STOP waits for no text
        _report(text, error)
        return _filled(text, values)


def _filled(text: str, values: Mapping[str, Any]) -> str:
    try:
        return text.format(**values) if values else text
    except Exception as error:
        _report(text, error)
        return text


def _report(text: str, error: Exception) -> None:
    if text not in _reported:
        _reported.add(text)
        kind = type(error).__name__
        _log.error("This text cannot be translated, so it is in English: %r (%s: %s)", text, kind, error)


def tr_later(text: str) -> str:
    """Return the text unchanged: `tr` translates it where it is shown. Texts of constants are written in it."""
    return text
