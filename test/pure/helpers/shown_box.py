"""A box as its client shows it."""

from helpers.commands import actions_shown
from helpers.public_messages import NOW
from roah_rsbb.model.clock import Now
from roah_rsbb.model.document import BoxState, Document
from roah_rsbb.model.zone import Event, RobotInRun, Zone

MONO = 500.0
EVENT = Event("kx2", "HCFGAC", "Task Benchmark 3", "Catering", "Alpha", 1, 2, NOW)


def zone_of(name="Home", off=None, asked=None, team="Alpha", **fields):
    """A zone with a running run. `off`, `asked`: see `actions_shown`."""
    return Zone(**{
        "zone": name, "event": EVENT._replace(team=team), "phase": "running", "identity": "run 1",
        "state": ("All OK for start",), "warnings": ("No message from the robot for 3 s",),
        "robot": RobotInRun("R", 6701, "GOAL_TX"), "not_stopped": ("R",),
        "actions": actions_shown({"start": ["Already started"]} if off is None else off, asked=asked), **fields})


class ShownBox:
    """What `Client` has; a test sets it."""

    def __init__(self, *zones):
        self.is_old = False
        self.why = ""
        self.mono = MONO
        self.document = None
        self.show(*zones)

    def show(self, *zones, warnings=(), **sections):
        """The box has these zones now."""
        before = self.document or Document(BoxState("uuid", "", 0), {}, {}, {}, {}, {})
        self.document = before._replace(
            box=before.box._replace(zones=tuple(zone.zone for zone in zones), warnings=tuple(warnings)),
            zones={zone.zone: zone for zone in zones}, **sections)

    def now(self):
        return Now(self.mono, NOW + self.mono - MONO)
