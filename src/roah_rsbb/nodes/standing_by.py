"""Nodes wait here: on the standby until it takes over (docs/standby.md), a core until the one before it has ended."""

import sys
import time
from typing import Optional

import rospy

from roah_rsbb.journal.file import CannotWriteJournal, JournalInUse, Lock, lock
from roah_rsbb.standby.partners import is_standby

# Name of the core's node.
CORE = "roah_rsbb_core"
WAITING = "This computer is a standby: waiting for a takeover"
LOOK_S = 0.02
# Seconds between two warnings about a process that still has the journal.
REPEAT_S = 10.0


def wait_for_takeover(log_dir: str) -> None:
    """Return when this computer is the box. Ends the process if it is interrupted before."""
    if not is_standby(log_dir):
        return
    rospy.loginfo("%s", WAITING)
    while is_standby(log_dir):
        _pause()


def wait_for_journal(log_dir: str) -> Optional[Lock]:
    """Lock the journal, as soon as no other process uses it: its runs are those that this core continues. Ends the
    process if it is interrupted before. Returns None if the folder cannot be written."""
    warned, said_at = "", 0.0
    while True:
        try:
            found = lock(log_dir)
        except JournalInUse as error:
            if str(error) != warned or time.monotonic() >= said_at + REPEAT_S:
                warned, said_at = str(error), time.monotonic()
                rospy.logwarn("%s", warned)
        except CannotWriteJournal:
            return None  # this is reported when the journal is opened
        else:
            if warned:
                rospy.loginfo("The other process has ended: continuing with its journal %s", found.path)
            return found
        _pause()


def _pause() -> None:
    try:
        if rospy.is_shutdown():
            sys.exit(0)
        time.sleep(LOOK_S)
    except KeyboardInterrupt:
        sys.exit(0)
