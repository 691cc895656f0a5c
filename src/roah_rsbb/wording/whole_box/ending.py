"""How faces ask before the whole box is ended (docs/referee.md, "Core Status")."""

from typing import Iterable

from roah_rsbb.model.reason import say
from roah_rsbb.model.zone import RUNNING, ZoneSeen
from roah_rsbb.wording.language import tr_later

QUESTION, YES = tr_later("End the whole RSBB?"), tr_later("End the RSBB")
ENDS_ALL = tr_later("This ends the core and everything started with it, for all referees.")
RUNS = tr_later("Runs in progress: {runs}")
# Why the box does not end.
IN_PROGRESS = say("Runs in progress: {runs}. End the box when they are over, or confirm that it is to end now: they "
                  "continue when it is started again")
NOT_LAUNCHED = say("No launch file started this box ({error}): end it where it was started, with Ctrl-C")


def running(zones: Iterable[ZoneSeen]) -> str:
    """Return the runs in progress with their robots; empty: there are none."""
    return ", ".join(f"{zone.zone} ({zone.robot_name})" for zone in zones if zone.phase == RUNNING)
