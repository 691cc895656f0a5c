"""What a team may know of its own robot, in words (docs/web.md, "Pages of teams").

The functions work on anything with the fields of CoreToGui, CoreDetails and Schedule; ROS is not imported.
"""

from typing import Any, Dict, List, Optional

from roah_rsbb.model import shown
from roah_rsbb.wording.language import tr
from roah_rsbb.wording.public import ALL_TEAMS, local_time
from roah_rsbb.wording.said import tr_said

_NOT_BEGUN = ("next", "later")


def facts(team: str, gui: Any, details: Any, schedule: Optional[Any]) -> List[str]:
    """Return what the box knows of a team's robots, of the zones whose event is the team's, and of its next event."""
    now = gui.clock.to_sec()
    of_zone: Dict[str, Any] = {one.zone: one for one in details.zones}
    robots = [robot for robot in gui.active_robots if robot.team == team]
    lines = [line for robot in robots for line in _robot(robot, now)] or [tr("The box does not hear the robot")]
    lines += [_zone(zone, of_zone[zone.zone], now)
              for zone in gui.zones if zone.team in (team, ALL_TEAMS) and zone.zone in of_zone]
    following = [event for event in ([] if schedule is None else schedule.events)
                 if event.team in (team, ALL_TEAMS) and event.state in _NOT_BEGUN]
    if following:
        event = min(following, key=lambda one: one.begins.to_sec())
        lines.append(tr("Next event: {benchmark} in zone {zone}, about {time}", benchmark=event.benchmark,
                        zone=event.zone, time=local_time(event.begins.to_sec(), now)))
    return lines


def _robot(robot: Any, now: float) -> List[str]:
    skew_s = robot.skew.to_sec()
    heard = tr("The box hears {robot}, last {seconds} s ago", robot=robot.robot,
               seconds=_seconds(now - robot.beacon.to_sec()))
    text = tr("Its clock is {seconds} s ahead of the box", seconds=f"{abs(skew_s):.3f}") if skew_s > -0.0005 else tr(
        "Its clock is {seconds} s behind the box", seconds=f"{-skew_s:.3f}")
    return [heard, text]


def _zone(zone: Any, details: Any, now: float) -> str:
    if details.phase == "idle":
        reasons = "; ".join(tr_said(reason) for reason in shown.off(details, "connect"))
        if reasons:
            return tr("In zone {zone}, connect is off: {reasons}", zone=zone.zone, reasons=reasons)
        return tr("In zone {zone}, the robot can be connected now", zone=zone.zone)
    last = details.last_message.to_sec()
    if not last:
        return tr("In zone {zone}, the robot is connected. No message of it has come yet", zone=zone.zone)
    return tr("In zone {zone}, the robot is connected. Its state: {state}. Last message {seconds} s ago",
              zone=zone.zone, state=details.robot_state, seconds=_seconds(now - last))


def _seconds(seconds: float) -> str:
    return f"{max(0.0, seconds):.0f}"
