"""What each process with windows needs, in rqt as in our own window: the language, and that a fault in one panel ends
neither the others nor STOP.

- The environment chooses the language (docs/referee.md, "Language"): a file in resource/languages, in the format of Qt
  Linguist. It is read when a program starts, so that a corrected text needs no build.
- An exception that nobody handled is logged, and the parts that failed are named to `listeners`.
- Python's garbage is collected in Qt's thread only. By itself, Python collects it in whichever thread creates an
  object, such as one of rospy's. If that destroys a widget while Qt handles an event of it, the program crashes.
"""

import contextlib
import gc
import logging
import os
import pathlib
import sys
import threading
import traceback
from typing import Callable, Iterator, List, Mapping, Optional, Set

from roah_rsbb.ground.installed import NotShipped, shipped_folder
from roah_rsbb.rqt.qt import QApplication, QCoreApplication, QLibraryInfo, QTimer, QTranslator
from roah_rsbb.wording.language import ENGLISH, Texts, chosen, form_of, read_texts, set_translation, translation

# Each is called with the name of the part that failed.
listeners: List[Callable[[str], None]] = []
_logged: Set[str] = set()
# What rospy.logerr uses. Without ROS, it is a logger like any other.
_logger = logging.getLogger("rosout")

PERIOD_MS = 1000
_collector: Optional[QTimer] = None


def prepare() -> None:
    """Prepare this process, once Qt has started, in Qt's thread. Further calls have no effect."""
    global _collector
    sys.excepthook = _log  # PyQt would end the process, and with it the referee's view of all runs
    _install_language()
    if _collector is None:
        gc.disable()
        _collector = QTimer(QApplication.instance())
        _collector.timeout.connect(_collect)
        _collector.start(PERIOD_MS)


def _collect() -> None:
    """Collect the oldest generation that is due by Python's own thresholds."""
    for generation in (2, 1, 0):
        if gc.get_count()[generation] > gc.get_threshold()[generation]:
            gc.collect(generation)
            return


@contextlib.contextmanager
def reported(part: str) -> Iterator[None]:
    """Log an exception in a `with` block instead of raising it. `part`: its name for the referee."""
    try:
        yield
    except Exception:
        _report(part, traceback.format_exc())


def _log(kind, error, trace) -> None:
    _report(_part(trace), "".join(traceback.format_exception(kind, error, trace)))


def _report(part: str, text: str) -> None:
    # A part that fails each time it is drawn would fill the log.
    if text not in _logged:
        _logged.add(text)
        # rospy may ask the master before it logs, and a master that hangs must not stop the window.
        threading.Thread(target=lambda: _logger.error("%s failed. Please report this: %s", part, text),
                         daemon=True).start()
    for listener in tuple(listeners):
        listener(part)


def _part(trace) -> str:
    """Return the name of the outermost part of a window in a traceback, such as ScoringPanel."""
    while trace is not None:
        owner = trace.tb_frame.f_locals.get("self")
        if owner is not None:
            return type(owner).__name__
        trace = trace.tb_next
    return "?"


# -- the language ---------------------------------------------------------------------------------

_installed: List[QTranslator] = []


def chosen_language(folder: pathlib.Path, environment: Mapping[str, str]) -> str:
    """Return the first language that the environment asks for and that `folder` has; English if there is none."""
    locale = next(filter(None, map(environment.get, ("LC_ALL", "LC_MESSAGES", "LANG"))), "C")
    if locale.partition(".")[0] in ("C", "POSIX"):
        return ENGLISH
    names = (name.partition(".")[0].partition("@")[0] for name in (*environment.get("LANGUAGE", "").split(":"), locale))
    return chosen(",".join(names), {ENGLISH, *(path.stem for path in folder.glob("*.ts"))})


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


def _install_language() -> None:
    """Show the windows of this process in the language that the environment asks for."""
    if _installed:
        return
    try:
        folder = shipped_folder().parent / "resource" / "languages"
    except NotShipped:  # English
        return
    name = chosen_language(folder, os.environ)
    if name == ENGLISH:
        return
    of_qt, texts = QTranslator(), read_texts(folder / f"{name}.ts")
    of_qt.load(f"qtbase_{name}", QLibraryInfo.location(QLibraryInfo.TranslationsPath))
    for translator in (of_qt, Catalogue(name, texts)):  # Qt asks the last one first
        QCoreApplication.installTranslator(translator)
        _installed.append(translator)
    set_translation(translation(name, texts))
