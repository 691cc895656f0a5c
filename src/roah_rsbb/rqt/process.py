"""What each process with windows needs, in rqt as in our own window: the language, and that a fault in one panel ends
neither the others nor STOP.

- An exception that nobody handled is logged, and the parts that failed are named to `listeners`.
- Python's garbage is collected in Qt's thread only. By itself, Python collects it in whichever thread creates an
  object, such as one of rospy's. If that destroys a widget while Qt handles an event of it, the program crashes.
"""

import contextlib
import gc
import logging
import sys
import threading
import traceback
from typing import Callable, Iterator, List, Optional, Set

from roah_rsbb.rqt import language
from roah_rsbb.rqt.qt import QApplication, QTimer

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
    language.install()
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
