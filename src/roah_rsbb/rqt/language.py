"""The language of all windows of a process, chosen by the environment (docs/referee.md, "Language").

A language is a file in resource/languages, in the format of Qt Linguist. It is read when a program starts, so that a
corrected text needs no build.
"""

import functools
import os
import pathlib
from typing import List, Mapping, Optional

from roah_rsbb.ground.installed import NotShipped, shipped_folder
from roah_rsbb.rqt.qt import QCoreApplication, QLibraryInfo, QTranslator
from roah_rsbb.wording.language import CONTEXT, Texts, form_of, read_texts, set_translation

# The language of the texts in the code.
SOURCE = "en"
_installed: List[QTranslator] = []


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


class Catalogue(QTranslator):
    """The texts of one language. Qt asks it for its own texts, too."""

    def __init__(self, language: str, texts: Texts) -> None:
        super().__init__()
        self._language = language
        self._texts = texts

    def isEmpty(self) -> bool:
        return not self._texts

    def translate(self, context: str, text: str, _disambiguation: Optional[str] = None, n: int = -1) -> Optional[str]:
        return form_of(self._language, self._texts.get((context, text)), n)


def install() -> None:
    """Show the windows of this process in the language that the environment asks for. Call it once Qt has started."""
    if _installed or not wanted(os.environ):
        return
    try:
        folder = shipped_folder().parent / "resource" / "languages"
    except NotShipped:  # English
        return
    language = chosen(folder, os.environ)
    if language == SOURCE:
        return
    of_qt = QTranslator()
    of_qt.load(f"qtbase_{language}", QLibraryInfo.location(QLibraryInfo.TranslationsPath))
    for translator in (of_qt, Catalogue(language, read_texts(_file(folder, language)))):  # Qt asks the last one first
        QCoreApplication.installTranslator(translator)
        _installed.append(translator)
    set_translation(_in_this_language)


# Panels are redrawn ten times a second.
@functools.lru_cache(maxsize=4096)
def _in_this_language(text: str, n: int) -> str:
    return QCoreApplication.translate(CONTEXT, text, None, n)


def _file(folder: pathlib.Path, language: str) -> pathlib.Path:
    return folder / f"{language}.ts"
