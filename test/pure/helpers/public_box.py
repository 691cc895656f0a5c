"""What the public may see of a box, as tests want it."""

from helpers.shown_box import MONO, NOW, ShownBox
from roah_rsbb.model.document import (
    Public,
    PublicEvent,
    PublicGroup,
    PublicItem,
    PublicRank,
    PublicResult,
    PublicRun,
    PublicStanding,
    RobotText,
)
from roah_rsbb.model.records import GroupPoints, ScoreValue, SheetPoints
from roah_rsbb.model.zone import Count


def event(zone="Home", team="Alpha", after_s=600.0):
    return PublicEvent(zone, "Visitors", team, 2, 3, NOW + after_s)


def run(zone="Home", phase="running", counting=True, left=90.0, elapsed=None, doing="executing", kind="task", **fields):
    """A run, `left` seconds before its end at MONO; with `elapsed` seconds it has no limit."""
    limit, seconds = (600.0, 600.0 - left) if elapsed is None else (0.0, elapsed)
    return PublicRun(event(zone), ("Alpha",), phase, kind, doing, limit=limit,
                     elapsed=Count(seconds, MONO if counting else None), **fields)


def explanation(zone="Home", **fields):
    """A run with all that explains it."""
    return run(zone, **{"about": {"en": "Visitors ring.", "de": "Besucher klingeln."},
                        "said": (RobotText("", "visitor", "Postman", NOW - 5.0),), **fields})


def result(team="Alpha", value=3, signed=True):
    group = PublicGroup("Achievements", (PublicItem("doors", "count", value), PublicItem("greeted", "bool", 1)), 0)
    return PublicResult(
        event(team=team), "completed", NOW - 60.0, signed, (group,), (ScoreValue("", "error", "0.5", "m", "Distance"),),
        SheetPoints("4.5", (GroupPoints("Achievements", "4.5"),)))


def standing():
    return PublicStanding("Visitors", ("Achievements",), (PublicRank("1", "Alpha", ("4.5",)),))


class PublicBox(ShownBox):
    """A box whose public sections a test sets. It has no document before it publishes something."""

    def __init__(self, runs=(), following=(), results=(), standings=()):
        super().__init__()
        self.document = None
        if runs or following:
            self.publish(runs, following, results, standings)

    def publish(self, runs=(), following=(), results=(), standings=()):
        """The box publishes this and nothing else."""
        if self.document is None:
            self.show()
        before, of_zones = self.document, {one.event.zone: one for one in runs}
        self.document = before._replace(
            box=before.box._replace(zones=tuple(dict.fromkeys([*of_zones, *(one.zone for one in following)]))),
            public=Public("scores", tuple(following), tuple(standings)), public_runs=of_zones,
            public_results={str(number): one for number, one in enumerate(results)})
