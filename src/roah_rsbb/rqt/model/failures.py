"""Exceptions in panels."""

import sys
import traceback

import rospy


def log_failures() -> None:
    """Log exceptions that nobody handles. PyQt would end the process, and with it the referee's view of all runs."""
    sys.excepthook = _log


def _log(kind, error, trace) -> None:
    text = "".join(traceback.format_exception(kind, error, trace))
    rospy.logerr("A panel failed. Please report this: %s", text)
