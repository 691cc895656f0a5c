"""The language of the texts on screens (docs/referee.md, "Language").

The texts in the code are English. A program with windows may set another language. The web pages get their texts in
several languages. All other programs, and everything that is sent or written to files, stay English. The translations
are in resource/languages, in the format of Qt Linguist.
"""

import contextlib
import functools
import logging
import pathlib
import re
import string
import threading
from typing import Any, Callable, Container, Dict, Iterable, Iterator, Mapping, Optional, Set, Tuple

from roah_rsbb.model.reason import Reason

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


def tr_words(**texts: str) -> Dict[str, str]:
    """Return texts by their names in the present language. Their places stay: a page fills them."""
    return {name: tr(text) for name, text in texts.items()}


def tr_later(text: str) -> str:
    """Return the text unchanged: `tr` translates it where it is shown. Texts of constants are written in it."""
    return text


# -- sentences of the box --------------------------------------------------------------------------


def tr_said(text: str) -> str:
    """Return a sentence of the box in the language of this process. It never raises."""
    return text if is_english() else tr_reason(text)


def tr_reason(text: str) -> str:
    """Return a reason in the language of this process; a text that is none is translated as it is."""
    if not isinstance(text, Reason):
        return tr(text)
    return tr(text.template, **{
        name: tr_reason(value) if isinstance(value, Reason) else value for name, value in text.values.items()})


# -- the files of translations ---------------------------------------------------------------------

ENGLISH = "en"  # the language of the texts in the code
# The context of our texts in the files. Further contexts are those of Qt's own texts.
CONTEXT = "roah_rsbb"

# The forms of a text, by context and English text: one form, or several if the text has a count.
Texts = Dict[Tuple[str, str], Tuple[str, ...]]

# The index of the form for a count, by language.
_FORMS: Dict[str, Callable[[int], int]] = {
    "": lambda n: int(n != 1),  # most of them
    "fr": lambda n: int(n > 1),
    "ja": lambda n: 0,
    "zh": lambda n: 0,
}


def read_texts(path: pathlib.Path) -> Texts:
    """Return all translated texts of a file."""
    from xml.etree import ElementTree  # imported late: most boxes never need it

    found: Texts = {}
    for context in ElementTree.parse(str(path)).getroot().iter("context"):
        name = context.findtext("name", "")
        for message in context.iter("message"):
            translation = message.find("translation")
            assert translation is not None  # Qt writes one, even if it is empty
            forms = tuple(form.text or "" for form in translation.iter("numerusform")) or (translation.text or "",)
            if all(forms) and translation.get("type") not in ("unfinished", "obsolete", "vanished"):
                found[name, message.findtext("source", "")] = forms
    return found


def translations(files: Iterable[pathlib.Path]) -> Dict[str, Translate]:
    """Return what files translate, by their languages. A file is read when somebody needs its language."""
    return {path.stem: _read_late(path) for path in files}


def _read_late(path: pathlib.Path) -> Translate:
    known = functools.lru_cache(maxsize=None)(lambda: translation(path.stem, read_texts(path)))
    return lambda text, n: known()(text, n)


def chosen(wanted: str, known: Container[str]) -> str:
    """Return the first language that is wanted and known, else English. `wanted`: such as ``fr,de-AT;q=0.8``."""
    for name in wanted.split(","):
        name = name.partition(";")[0].strip().replace("-", "_")
        for one in (name, name.partition("_")[0]):
            if one in known:
                return one
    return ENGLISH


def form_of(language: str, forms: Optional[Tuple[str, ...]], n: int) -> Optional[str]:
    """Return the form of a text for a count; `n` is -1 without one. None: the text is not translated."""
    if forms is None:
        return None
    number = _FORMS.get(language.partition("_")[0], _FORMS[""])(n) if n >= 0 else 0
    return forms[min(number, len(forms) - 1)]


def translation(language: str, texts: Texts) -> Translate:
    """Return the function that translates our texts into a language. Texts without a translation stay English."""
    def translate(text: str, n: int) -> str:
        return form_of(language, texts.get((CONTEXT, text)), n) or text
    return translate
