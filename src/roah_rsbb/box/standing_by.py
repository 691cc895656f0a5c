"""Programs wait here: on the standby until it takes over (docs/standby.md), a core until the one before has ended."""

import logging
import sys
import time
from typing import Any, Callable, Optional

from roah_rsbb.journal.log_dir import CannotWriteJournal, JournalInUse, Lock, lock
from roah_rsbb.standby.pairing import is_standby

WAITING = "This computer is a standby: waiting for a takeover"
LOOK_S = 0.02
# Seconds between two warnings about a process that still has the journal.
REPEAT_S = 10.0

_log = logging.getLogger(__name__)


def never() -> bool:
    """A program that only a signal ends."""
    return False


def wait_for_takeover(log_dir: str, is_ended: Callable[[], Any] = never) -> None:
    """Return when this computer is the box. Ends the process if it is interrupted before, or `is_ended`."""
    if not is_standby(log_dir):
        return
    _log.info("%s", WAITING)
    while is_standby(log_dir):
        _pause(is_ended)


def wait_for_journal(log_dir: str, is_ended: Callable[[], Any] = never) -> Optional[Lock]:
    """Lock the journal, as soon as no other process uses it: its runs are those that this core continues. Ends the
    process if it is interrupted before, or `is_ended`. Returns None if the folder cannot be written."""
    warned, said_at = "", 0.0
    while True:
        try:
            found = lock(log_dir)
        except JournalInUse as error:
            if str(error) != warned or time.monotonic() >= said_at + REPEAT_S:
                warned, said_at = str(error), time.monotonic()
                _log.warning("%s", warned)
        except CannotWriteJournal:
            return None  # this is reported when the journal is opened
        else:
            if warned:
                _log.info("The other process has ended: continuing with its journal %s", found.path)
            return found
        _pause(is_ended)


def _pause(is_ended: Callable[[], Any]) -> None:
    try:
        if is_ended():
            sys.exit(0)
        time.sleep(LOOK_S)
    except KeyboardInterrupt:
        sys.exit(0)
