"""The way of a STOP: sent, received by the box, received by the robot (docs/referee.md, "How to stop a robot")."""

import enum
from typing import Optional

from roah_rsbb.model.zone import ENDED, RUNNING, ZoneSeen
from roah_rsbb.wording.language import tr, tr_later

# After this time (s) without an answer of the box, or of the robot, the referee must act.
NOT_DELIVERED_S = 1.0


class Way(enum.Enum):
    """How far a STOP came. The values are the names on the web pages."""

    SENT = "sent"  # the box has not confirmed it
    AT_BOX = "at_box"  # the robot has not confirmed it
    STOPPED = "stopped"  # all robots of the run report STOP
    NO_ROBOT = "no_robot"  # the run has no robot: the clock is stopped
    LOST_BOX = "lost_box"  # the box does not answer
    LOST_ROBOT = "lost_robot"  # the robot does not report STOP


TEXTS = {
    Way.SENT: tr_later("STOP {zone}: sent …"),
    Way.AT_BOX: tr_later("STOP {zone}: the box has it. Waiting for the robot …"),
    Way.STOPPED: tr_later("STOP {zone}: the robot has stopped"),
    Way.NO_ROBOT: tr_later("STOP {zone}: the clock is stopped. It reached no robot"),
    Way.LOST_BOX: tr_later("STOP {zone}: NOT DELIVERED. Stop the robot by hand. Trying again …"),
    Way.LOST_ROBOT: tr_later("STOP {zone}: NO ANSWER FROM THE ROBOT. Stop it by hand. Trying again …"),
}
# The same, of a run that has no robot, or of which nothing is known yet.
BOX_HAS_IT = tr_later("STOP {zone}: the box has it …")
# The same in few words, for places that have the name of the zone.
SHORT = {
    Way.SENT: tr_later("sent …"),
    Way.AT_BOX: tr_later("the box has it …"),
    Way.STOPPED: tr_later("has stopped"),
    Way.NO_ROBOT: tr_later("clock stopped"),
    Way.LOST_BOX: tr_later("NOT DELIVERED"),
    Way.LOST_ROBOT: tr_later("NO ANSWER"),
}
OTHERS_RUN = tr_later("Nothing is running in {zone}. Running: {zones}. Choose one of them, or hold STOP ALL")
# Before a referee leaves a run whose robot has not stopped.
LEAVING = tr_later("{robots} did not answer STOP. After the disconnect the box does not repeat it: stop by hand first")
# Ways on which the referee must stop the robot by hand.
LOST = (Way.LOST_BOX, Way.LOST_ROBOT)
DONE = (Way.STOPPED, Way.NO_ROBOT)


def way(passed_s: float, box_has_it: bool, zone: Optional[ZoneSeen]) -> Way:
    """Return how far a STOP came, `passed_s` seconds after it was sent.

    `box_has_it`: the box answered, or reports that the run is over. `zone`: as it is since then; None: that is not
    known, or it shows another run.
    """
    is_late = passed_s >= NOT_DELIVERED_S
    if not box_has_it:
        return Way.LOST_BOX if is_late else Way.SENT
    if zone is not None and zone.by_hand:
        return Way.NO_ROBOT
    if zone is None or zone.phase == RUNNING or zone.not_stopped:
        return Way.LOST_ROBOT if is_late else Way.AT_BOX
    return Way.STOPPED


def leaving(zone: ZoneSeen) -> str:
    """Return what the referee must know, and confirm, before they leave the run in a zone; empty: nothing. Ask for
    *disconnect*, *withdrawn* and *choose_event*: all of them leave a run."""
    if zone.phase != ENDED or not zone.not_stopped:
        return ""
    return tr(LEAVING, robots=", ".join(zone.not_stopped))


def way_text(where: Way, zone: str, has_robot: bool = True) -> str:
    """Return the text for the referee. `has_robot`: the run is known to have one."""
    return tr(TEXTS[where] if has_robot or where is not Way.AT_BOX else BOX_HAS_IT, zone=zone)
