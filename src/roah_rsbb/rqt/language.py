"""The language of all windows of a process, chosen by the environment (docs/referee.md, "Language").

A language is a file in resource/languages, in the format of Qt Linguist. It is read when a program starts, so that a
corrected text needs no build.
"""

import functools
import os
import pathlib
from typing import Callable, Dict, List, Mapping, Optional, Tuple
from xml.etree import ElementTree

import rospkg

from roah_rsbb.rqt.qt import QCoreApplication, QLibraryInfo, QTranslator
from roah_rsbb.wording.language import set_translation

# The context of our texts in the files. Further contexts are those of Qt's own texts.
CONTEXT = "roah_rsbb"
# The language of the texts in the code.
SOURCE = "en"

# The forms of a text, by context and English text: one, or several for one with a count.
Texts = Dict[Tuple[str, str], Tuple[str, ...]]
_installed: List[QTranslator] = []

# Which form a count has, where it is not the first one for 1 and the second one for all others.
_FORMS: Dict[str, Callable[[int], int]] = {
    "fr": lambda n: int(n > 1),
    "ja": lambda n: 0,
    "zh": lambda n: 0,
}


def wanted(environment: Mapping[str, str]) -> List[str]:
    """Return the languages that the environment asks for, such as ["de_AT", "de"], the preferred ones first."""
    locale = next(filter(None, map(environment.get, ("LC_ALL", "LC_MESSAGES", "LANG"))), "C")
    if locale.partition(".")[0] in ("C", "POSIX"):
        return []
    names = []
    for name in [*environment.get("LANGUAGE", "").split(":"), locale]:
        name = name.partition(".")[0].partition("@")[0]
        names += [name, name.partition("_")[0]]
    return list(dict.fromkeys(filter(None, names)))


def chosen(folder: pathlib.Path, environment: Mapping[str, str]) -> str:
    """Return the first language that the environment asks for and that `folder` has; English if there is none."""
    return next((name for name in wanted(environment) if name == SOURCE or _file(folder, name).is_file()), SOURCE)


def read(path: pathlib.Path) -> Texts:
    """Return all translated texts of a file."""
    found: Texts = {}
    for context in ElementTree.parse(str(path)).getroot().iter("context"):
        name = context.findtext("name", "")
        for message in context.iter("message"):
            translation = message.find("translation")
            forms = tuple(form.text or "" for form in translation.iter("numerusform")) or (translation.text or "",)
            if all(forms) and translation.get("type") not in ("unfinished", "obsolete", "vanished"):
                found[name, message.findtext("source", "")] = forms
    return found


class Catalogue(QTranslator):
    """The texts of one language. Qt asks it for its own texts, too."""

    def __init__(self, language: str, texts: Texts) -> None:
        super().__init__()
        self._form = _FORMS.get(language.partition("_")[0], lambda n: int(n != 1))
        self._texts = texts

    def isEmpty(self) -> bool:
        return not self._texts

    def translate(self, context: str, text: str, _disambiguation: Optional[str] = None, n: int = -1) -> Optional[str]:
        forms = self._texts.get((context, text))
        if forms is None:
            return None
        return forms[min(self._form(n), len(forms) - 1)] if n >= 0 else forms[0]


def install() -> None:
    """Show the windows of this process in the language that the environment asks for. Call it once Qt has started."""
    if _installed or not wanted(os.environ):
        return
    try:
        folder = pathlib.Path(rospkg.RosPack().get_path("roah_rsbb"), "resource", "languages")
    except rospkg.ResourceNotFound:  # without the package's environment there are no files: English
        return
    language = chosen(folder, os.environ)
    if language == SOURCE:
        return
    of_qt = QTranslator()
    of_qt.load(f"qtbase_{language}", QLibraryInfo.location(QLibraryInfo.TranslationsPath))
    for translator in (of_qt, Catalogue(language, read(_file(folder, language)))):  # Qt asks the last one first
        QCoreApplication.installTranslator(translator)
        _installed.append(translator)
    set_translation(_in_this_language)


# Panels are redrawn ten times a second.
@functools.lru_cache(maxsize=4096)
def _in_this_language(text: str, n: int) -> str:
    return QCoreApplication.translate(CONTEXT, text, None, n)


def _file(folder: pathlib.Path, language: str) -> pathlib.Path:
    return folder / f"{language}.ts"
