"""The referee's stop, as panels send it."""

from typing import Callable, Optional

from roah_rsbb.msg import ZoneDetails
from roah_rsbb.rqt.model.calls import Outcome
from roah_rsbb.rqt.panels.panel import Panel
from roah_rsbb.srv import StopRun


def stop_run(panel: Panel, zone: str, details: Optional[ZoneDetails], done: Callable[[Outcome], None]) -> None:
    """Stop the run that the referee sees.

    One that ends in the moment of the click is not left: that is what /core/stop does with a run that is over.
    """
    identity = "" if details is None else details.identity
    panel.client.calls.service(panel, "/core/stop_run", StopRun, (zone, identity), done)
