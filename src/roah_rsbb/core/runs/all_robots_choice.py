"""Which robots take part when all take part at once, and why the others cannot.

All active robots within skew are connected; one that cannot take part keeps nobody else from it (docs/benchmarks.md,
"HSUF"). The referee is told who is left out and why, and may disconnect and connect again to have a late one.
"""

from typing import TYPE_CHECKING, List, NamedTuple, Tuple

from roah_rsbb.core.clock import Now
from roah_rsbb.core.link.skew import skew_off
from roah_rsbb.core.robots import ActiveRobot
from roah_rsbb.core.runs.phases import Phase
from roah_rsbb.core.zone import Zone

if TYPE_CHECKING:  # the box holds this, not the other way round
    from roah_rsbb.core.box import Box


class Choice(NamedTuple):
    """All active robots that are not in the zone's run, by team and name."""

    fit: Tuple[ActiveRobot, ...]
    unfit: Tuple[str, ...]  # who cannot take part, and why, a text each


def choose(box: "Box", zone: Zone, now: Now) -> Choice:
    """Who could be connected to a zone's run now."""
    inside = () if zone.run is None else tuple(member.robot for member in zone.run.members())
    fit: List[ActiveRobot] = []
    unfit: List[str] = []
    for robot in box.robots.all(now):
        if robot.id in inside:
            continue
        reasons = _reasons(box, robot, now)
        if reasons:
            unfit.append(f"{robot.id} cannot take part: {'; '.join(reasons)}")
        else:
            fit.append(robot)
    return Choice(tuple(fit), tuple(unfit))


def nobody_off(box: "Box", zone: Zone, now: Now) -> List[str]:
    """Why nobody can be connected; empty: somebody can."""
    choice = choose(box, zone, now)
    if choice.fit:
        return []
    return list(choice.unfit) or [
        f"No robot is active: no beacon arrives on UDP port {box.settings.rsbb_port}"
    ]


def outsiders(box: "Box", zone: Zone, now: Now) -> List[str]:
    """What the referee should know of robots that are not in the run, as long as that can be changed."""
    if zone.run is not None and zone.run.phase is not Phase.CONNECTED:
        return []
    choice = choose(box, zone, now)
    if zone.run is None:
        return list(choice.unfit)
    again = "is active, but not in this run: disconnect and connect again to have it"
    return [f"{robot.id} {again}" for robot in choice.fit] + list(choice.unfit)


def _reasons(box: "Box", robot: ActiveRobot, now: Now) -> List[str]:
    run = box.run_of(robot.id)
    if run is not None:
        return [f"it is in a run in zone {run.zone}"]
    reasons: List[str] = []
    if not box.robots.has_password(robot.id.team):
        reasons.append("its team has no password in the passwords file")
    if robot.is_late(now):
        reasons.append(f"it was not heard for {now.mono - robot.last_heard.mono:.0f} s")
    return reasons + skew_off("the robot", robot.skew.seconds, box.settings.allowed_skew)
