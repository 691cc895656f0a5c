"""A box as its client shows it."""

from helpers.commands import actions_shown
from roah_rsbb.model.clock import Now
from roah_rsbb.model.document import BoxSeen, Document
from roah_rsbb.model.zone import Event, RobotInRun, ZoneSeen

NOW = 1_800_000_000.0  # 2027-01-15 08:00:00 UTC
MONO = 500.0
EVENT = Event("kx2", "HCFGAC", "Task Benchmark 3", "Catering", "Alpha", 1, 2, NOW)


def zone_of(name="Home", off=None, asked=None, team="Alpha", **fields):
    """A zone with a running run. `off`, `asked`: see `actions_shown`."""
    return ZoneSeen(**{
        "zone": name, "event": EVENT._replace(team=team), "phase": "running", "identity": "run 1",
        "state": ("All OK for start",), "warnings": ("No message from the robot for 3 s",),
        "robot": RobotInRun("R", 6701, "GOAL_TX"), "not_stopped": ("R",),
        "actions": actions_shown({"start": ["Already started"]} if off is None else off, asked=asked), **fields})


class ShownBox:
    """What `Client` has; a test sets it."""

    def __init__(self, *zones):
        self.is_old = False
        self.why = ""
        self.mono, self._slewn_s = MONO, 0.0
        self.document = None
        self.show(*zones)

    def show(self, *zones, warnings=(), **sections):
        """The box has these zones now."""
        before = self.document or Document(BoxSeen("uuid", "", 0), {}, {}, {}, {}, {})
        self.document = before._replace(
            box=before.box._replace(zones=tuple(zone.zone for zone in zones), warnings=tuple(warnings)),
            zones={zone.zone: zone for zone in zones}, **sections)

    def now(self):
        return Now(0.0, 0.0) if self.document is None else Now(self.mono, NOW + self.mono - MONO + self._slewn_s)

    def utc_slews(self, seconds):
        """The box's clock of the day is set forward."""
        self._slewn_s += seconds
