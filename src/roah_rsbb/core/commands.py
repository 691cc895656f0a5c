"""The referee's commands: for each, every reason why it is refused now, and what it does.

The same reasons that switch a panel's button off refuse the command itself, because the state may have
changed since the panel was drawn.
"""

from typing import TYPE_CHECKING, Callable, Dict, List, NamedTuple, Sequence

from roah_rsbb.core.clock import Now
from roah_rsbb.core.link.skew import skew_off
from roah_rsbb.core.robots import ActiveRobot
from roah_rsbb.core.runs import all_robots_choice
from roah_rsbb.core.runs.phases import EndReason, Phase
from roah_rsbb.core.scoring.records import By
from roah_rsbb.core.zone import Zone
from roah_rsbb.rulebook.benchmarks import Kind

if TYPE_CHECKING:  # the box holds the commands, not the other way round
    from roah_rsbb.core.box import Box

DISCONNECT_FIRST = "A run is connected: disconnect it first"
NO_RUN = "No run is connected: press connect first"


class Command(NamedTuple):
    """A command to a zone."""

    reasons_off: Callable[["Box", Zone, Now], List[str]]
    execute: Callable[["Box", Zone, Now, By], None]


# -- connect --------------------------------------------------------------------------------------


def robots_to_connect(box: "Box", zone: Zone, now: Now) -> Sequence[ActiveRobot]:
    """The robots that *connect* would take: all that can take part, or the team's one that is in no run, heard
    just now, longest known."""
    if zone.event.benchmark.kind is Kind.REFEREE_ONLY:
        return all_robots_choice.choose(box, zone, now).fit
    return [robot for robot in box.robots.of_team(now, zone.event.team) if box.run_of(robot.id) is None][:1]


def _connect_off(box: "Box", zone: Zone, now: Now) -> List[str]:
    if zone.run is not None:
        return ["Already connected"]
    reasons: List[str] = []
    listening = box.listening_left(now)
    if listening > 0:
        reasons.append(f"The box is still listening for another box, for {listening:.0f} s")
    robots = robots_to_connect(box, zone, now)
    if zone.event.benchmark.kind is Kind.REFEREE_ONLY:
        reasons += all_robots_choice.nobody_off(box, zone, now)
    else:
        reasons += _robot_off(box, zone, now, robots)
    return reasons + box.capacity().off([robot.id for robot in robots])


def _robot_off(box: "Box", zone: Zone, now: Now, robots: Sequence[ActiveRobot]) -> List[str]:
    team = zone.event.team
    if not robots:
        busy = [(r, box.run_of(r.id)) for r in box.robots.of_team(now, team)]
        if not busy:
            return [f"No robot of team {team} is active: none of its beacons arrives on UDP port "
                    f"{box.settings.rsbb_port}"]
        return [f"Robot {r.id} is in a run in zone {run.zone}" for r, run in busy if run is not None]
    return skew_off(f"robot {robots[0].id}", robots[0].skew.seconds, box.settings.allowed_skew)


# -- start, stop, disconnect ----------------------------------------------------------------------


def _start_off(box: "Box", zone: Zone, now: Now) -> List[str]:
    run = zone.run
    if run is None:
        return [NO_RUN]
    if run.phase is Phase.RUNNING:
        return ["Already started"]
    reasons: List[str] = []
    if run.end_reason is EndReason.TIMEOUT:
        reasons.append("The run ended by timeout: disconnect, and connect for a new run")
    elif run.clock.is_over(now):
        reasons.append(
            "The run's time is up (it went on after the stop): disconnect, and connect for a new run"
        )
    return reasons + run.start_off(now)


def _stop_off(box: "Box", zone: Zone, now: Now) -> List[str]:
    return [] if zone.run is not None else ["No run is connected: there is nothing to stop"]


def _stop(box: "Box", zone: Zone, now: Now, by: By) -> None:
    """The first press ends the run, the second one leaves it."""
    if zone.run.phase is Phase.RUNNING:
        zone.run.stop(now, by)
    else:
        box.leave(now, zone, by)


def _disconnect_off(box: "Box", zone: Zone, now: Now) -> List[str]:
    return [] if zone.run is not None else ["No run is connected"]


# -- previous, next -------------------------------------------------------------------------------


def _previous_off(box: "Box", zone: Zone, now: Now) -> List[str]:
    off = [DISCONNECT_FIRST] if zone.run is not None else []
    return off + (["This is the zone's first event"] if zone.at_first else [])


def _next_off(box: "Box", zone: Zone, now: Now) -> List[str]:
    off = [DISCONNECT_FIRST] if zone.run is not None else []
    return off + (["This is the zone's last event"] if zone.at_last else [])


COMMANDS: Dict[str, Command] = {
    "connect": Command(_connect_off, lambda box, zone, now, by: box.connect(now, zone)),
    "disconnect": Command(_disconnect_off, lambda box, zone, now, by: box.leave(now, zone, by)),
    "start": Command(_start_off, lambda box, zone, now, by: zone.run.start(now)),
    "stop": Command(_stop_off, _stop),
    "previous": Command(_previous_off, lambda box, zone, now, by: zone.move(-1)),
    "next": Command(_next_off, lambda box, zone, now, by: zone.move(1)),
}
