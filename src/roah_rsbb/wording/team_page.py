"""What a team may know of its own robot, in words (docs/web.md, "Pages of teams")."""

from typing import List, Optional

from roah_rsbb.model.clock import Now
from roah_rsbb.model.document import Document, RobotSeen
from roah_rsbb.model.zone import IDLE, ZoneSeen
from roah_rsbb.wording.language import tr
from roah_rsbb.wording.public import ALL_TEAMS, local_time
from roah_rsbb.wording.said import tr_said

_NOT_BEGUN = ("next", "later")


def facts(team: str, document: Document, now: Now) -> List[str]:
    """Return what the box knows of a team's robots, of the zones whose event is the team's, and of its next event.
    `now`: on the box's clocks."""
    robots = [robot for robot in document.robots.values() if robot.team == team]
    lines = [line for robot in robots for line in _robot(robot, now)] or [tr("The box does not hear the robot")]
    zones = [document.zones[name] for name in document.box.zones if name in document.zones]
    lines += [_zone(zone, now) for zone in zones if zone.event.team in (team, ALL_TEAMS)]
    following = [event for event in document.events() if event.team in (team, ALL_TEAMS) and event.state in _NOT_BEGUN]
    if following:
        event = min(following, key=lambda one: one.begins_utc_s)
        lines.append(tr("Next event: {benchmark} in zone {zone}, about {time}", benchmark=event.benchmark,
                        zone=event.zone, time=local_time(event.begins_utc_s, now.utc)))
    return lines


def _robot(robot: RobotSeen, now: Now) -> List[str]:
    heard = tr("The box hears {robot}, last {seconds} s ago", robot=robot.robot,
               seconds=_seconds(robot.silent_since, now))
    seconds = f"{abs(robot.skew):.2f}"
    text = tr("Its clock is {seconds} s ahead of the box", seconds=seconds) if robot.skew >= 0.0 else tr(
        "Its clock is {seconds} s behind the box", seconds=seconds)
    return [heard, text]


def _zone(zone: ZoneSeen, now: Now) -> str:
    if zone.phase == IDLE:
        reasons = "; ".join(tr_said(reason) for reason in zone.off("connect"))
        if reasons:
            return tr("In zone {zone}, connect is off: {reasons}", zone=zone.zone, reasons=reasons)
        return tr("In zone {zone}, the robot can be connected now", zone=zone.zone)
    robot = zone.robot
    if robot is None or not robot.heard:
        return tr("In zone {zone}, the robot is connected. No message of it has come yet", zone=zone.zone)
    return tr("In zone {zone}, the robot is connected. Its state: {state}. Last message {seconds} s ago",
              zone=zone.zone, state=robot.robot_state, seconds=_seconds(robot.silent_since, now))


def _seconds(silent_since: Optional[float], now: Now) -> str:
    """Return the seconds of a silence in words; None: there is none."""
    return f"{max(0.0, now.mono - silent_since):.0f}" if silent_since is not None else tr("less than 2")
