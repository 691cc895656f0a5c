"""Reads the files of resource/languages, in the format of Qt Linguist (docs/referee.md, "Language")."""

import functools
import pathlib
from typing import Callable, Container, Dict, Iterable, Optional, Tuple

from roah_rsbb.wording.language import Translate

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


def read(path: pathlib.Path) -> Texts:
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
    known = functools.lru_cache(maxsize=None)(lambda: translation(path.stem, read(path)))
    return lambda text, n: known()(text, n)


def chosen(wanted: str, known: Container[str]) -> str:
    """Return the first language that is wanted and known, else English. `wanted`: such as ``fr,de-AT;q=0.8``."""
    for name in wanted.split(","):
        name = name.partition(";")[0].strip().replace("-", "_")
        for one in (name, name.partition("_")[0]):
            if one in known:
                return one
    return ENGLISH


def form(language: str, forms: Optional[Tuple[str, ...]], n: int) -> Optional[str]:
    """Return the form of a text for a count; `n` is -1 without one. None: the text is not translated."""
    if forms is None:
        return None
    number = _FORMS.get(language.partition("_")[0], _FORMS[""])(n) if n >= 0 else 0
    return forms[min(number, len(forms) - 1)]


def translation(language: str, texts: Texts) -> Translate:
    """Return the function that translates our texts into a language. Texts without a translation stay English."""
    def translate(text: str, n: int) -> str:
        return form(language, texts.get((CONTEXT, text)), n) or text
    return translate
