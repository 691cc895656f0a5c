"""The language of all windows of a process, chosen by the environment (docs/referee.md, "Language").

A language is a file in resource/languages, in the format of Qt Linguist. It is read when a program starts, so that a
corrected text needs no build.
"""

import os
import pathlib
from typing import List, Mapping, Optional

from roah_rsbb.ground.installed import NotShipped, shipped_folder
from roah_rsbb.rqt.qt import QCoreApplication, QLibraryInfo, QTranslator
from roah_rsbb.wording import language
from roah_rsbb.wording.language import ENGLISH, Texts, form_of, read_texts, set_translation, translation

_installed: List[QTranslator] = []


def chosen(folder: pathlib.Path, environment: Mapping[str, str]) -> str:
    """Return the first language that the environment asks for and that `folder` has; English if there is none."""
    locale = next(filter(None, map(environment.get, ("LC_ALL", "LC_MESSAGES", "LANG"))), "C")
    if locale.partition(".")[0] in ("C", "POSIX"):
        return ENGLISH
    names = (name.partition(".")[0].partition("@")[0] for name in (*environment.get("LANGUAGE", "").split(":"), locale))
    return language.chosen(",".join(names), {ENGLISH, *(path.stem for path in folder.glob("*.ts"))})


class Catalogue(QTranslator):
    """The texts of one language, for those that are Qt's own."""

    def __init__(self, name: str, texts: Texts) -> None:
        super().__init__()
        self._language = name
        self._texts = texts

    def isEmpty(self) -> bool:
        return not self._texts

    def translate(self, context: str, text: str, _disambiguation: Optional[str] = None, n: int = -1) -> Optional[str]:
        return form_of(self._language, self._texts.get((context, text)), n)


def install() -> None:
    """Show the windows of this process in the language that the environment asks for. Call it once Qt has started."""
    if _installed:
        return
    try:
        folder = shipped_folder().parent / "resource" / "languages"
    except NotShipped:  # English
        return
    name = chosen(folder, os.environ)
    if name == ENGLISH:
        return
    of_qt, texts = QTranslator(), read_texts(folder / f"{name}.ts")
    of_qt.load(f"qtbase_{name}", QLibraryInfo.location(QLibraryInfo.TranslationsPath))
    for translator in (of_qt, Catalogue(name, texts)):  # Qt asks the last one first
        QCoreApplication.installTranslator(translator)
        _installed.append(translator)
    set_translation(translation(name, texts))
