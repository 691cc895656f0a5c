"""Exceptions in panels. One panel that fails must not end the others, and STOP least of all."""

import contextlib
import logging
import sys
import threading
import traceback
from typing import Callable, Iterator, List, Set

# Each is called with the name of the part that failed.
listeners: List[Callable[[str], None]] = []
_logged: Set[str] = set()
# What rospy.logerr uses. Without ROS, it is a logger like any other.
_logger = logging.getLogger("rosout")


def log_failures() -> None:
    """Log exceptions that nobody handles. PyQt would end the process, and with it the referee's view of all runs."""
    sys.excepthook = _log


def _log(kind, error, trace) -> None:
    _report(_part(trace), "".join(traceback.format_exception(kind, error, trace)))


@contextlib.contextmanager
def reported(part: str) -> Iterator[None]:
    """Log an exception in a `with` block instead of raising it. `part`: its name for the referee."""
    try:
        yield
    except Exception:
        _report(part, traceback.format_exc())


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
