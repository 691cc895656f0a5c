"""Warnings for every referee: another box, two robots of one name, steps of the box's clock."""

from typing import Dict, List, Optional, Tuple

from roah_rsbb.core.robots import ActiveRobot, Squatter
from roah_rsbb.core.tablet import HeardTablet
from roah_rsbb.model.clock import Now
from roah_rsbb.model.reason import Template, say
from roah_rsbb.wording import times

# A warning is shown for this long after its last cause.
REMEMBER_S = 10.0
CLOCK_REMEMBER_S = 60.0
NOTICE_REMEMBER_S = 60.0
TROUBLE_REMEMBER_S = 300.0
# This many causes of a kind are remembered. More than that are a flood.
MAX_KEPT = 20
# If the clocks of two robots of one name differ by this much, the warning includes both skews.
TWO_CLOCKS_S = 0.1

ANOTHER_BOX = say("ANOTHER RSBB is transmitting from {address}, and robots obey both: stop it, or take that computer "
                  "off the network")
HELD = say("ANOTHER RSBB was heard at {address}, so this box sends nothing until you press connect. Stop the other box "
           "first, or take that computer off the network if it is none of yours")
# By whether the address is confirmed by its password, and whether their clocks differ.
RIVALS: Dict[Tuple[bool, bool], Template] = {
    (True, False): say(
        "Two robots call themselves {robot}: {address} (confirmed by its password) and {others}. Connect and start use "
        "the one that knows the password. Give the other one another robot_name, or take it off the network"),
    (True, True): say(
        "Two robots call themselves {robot}: {address} (confirmed by its password) and {others}. Connect and start use "
        "the one that knows the password. Give the other one another robot_name, or take it off the network. Their "
        "clocks differ: {skew} and {other}"),
    (False, False): say(
        "Two robots call themselves {robot}: {address} and {others}. Connect and start use the one that knows the "
        "password. Give the other one another robot_name, or take it off the network"),
    (False, True): say(
        "Two robots call themselves {robot}: {address} and {others}. Connect and start use the one that knows the "
        "password. Give the other one another robot_name, or take it off the network. Their clocks differ: {skew} and "
        "{other}"),
}
TWO_CLOCKS = say("Beacons of {robot} from {address} show two clocks: somebody forges this address, or two programs "
                 "there use the name. Start uses the clock of the one that knows the password. Find the other one and "
                 "take it off the network")


class Watches:
    """The warnings of the whole box. A method that adds a warning returns its text if it is new, else None."""

    def __init__(self, listen_duration: float) -> None:
        self._listen_duration = listen_duration
        self._started: Optional[float] = None
        # (kind, cause) -> (monotonic time until which it is shown, text)
        self._kept: Dict[Tuple[str, object], Tuple[float, str]] = {}
        self._devices_trouble = ""
        self._journal_trouble = ""
        self._held_by = ""

    @property
    def held_by(self) -> str:
        """The address of another box that this one heard before it sent anything. It sends nothing until a referee
        connects a robot. Empty: it need not wait."""
        return self._held_by

    def start(self, now: Now) -> None:
        """Begin the time in which the box only listens, in the first call."""
        if self._started is None:
            self._started = now.mono

    def listening_left(self, now: Now) -> float:
        """Return for how many more seconds the box only listens."""
        if self._started is None:
            return self._listen_duration
        return max(0.0, self._started + self._listen_duration - now.mono)

    def foreign_box(self, now: Now, host: str) -> Optional[str]:
        """Warn of another box that transmits: two boxes confuse every robot."""
        return self._keep(
            now, ("box", host), ANOTHER_BOX(address=host), REMEMBER_S)

    def hold(self, host: str) -> Optional[str]:
        """Send nothing, because of another box. The warning stays until `release`."""
        is_new, self._held_by = host != self._held_by, host
        return self._held_text() if is_new else None

    def release(self) -> None:
        """Begin to send: a referee connects a robot in spite of the other box."""
        self._held_by = ""

    def _held_text(self) -> str:
        return HELD(address=self._held_by)

    def rivals(self, now: Now, robot: ActiveRobot) -> Optional[str]:
        """Warn of several hosts that use one robot's name, if there are any. A robot that moved is no longer where the
        warning before says."""
        rivals = robot.rivals(now)
        if not robot.is_here(rivals):
            if robot.has_moved:
                self._kept.pop(("rival", robot.id), None)
            return None
        hosts = sorted(rivals, key=lambda host: -rivals[host].mono)
        others = " and ".join(hosts[:2]) + (f" and {len(hosts) - 2} more" if len(hosts) > 2 else "")
        mine, theirs = robot.skew.seconds or 0.0, rivals[hosts[0]].skew
        differ = abs(mine - theirs) >= TWO_CLOCKS_S
        skews = {"skew": times.skew(mine), "other": times.skew(theirs)} if differ else {}
        text = RIVALS[robot.host == robot.confirmed_host, differ](
            robot=str(robot.id), address=robot.host, others=others, **skews)
        return self._keep(now, ("rival", robot.id), text, REMEMBER_S)

    def two_clocks(self, now: Now, robot: ActiveRobot) -> Optional[str]:
        """Warn of beacons that show two clocks at one address, if there are any."""
        if not robot.has_two_clocks(now):
            return None
        return self._keep(
            now, ("clocks", robot.id),
            TWO_CLOCKS(robot=str(robot.id), address=robot.host), REMEMBER_S)

    def squatter(self, now: Now, squatter: Squatter) -> Optional[str]:
        """Warn of a host that announces more robots than the list accepts."""
        where = (f"{squatter.host} announces at least {squatter.robots} robots" if squatter.robots > 1 else
                 f"Many addresses, such as {squatter.host}, announce robots")
        return self._keep(
            now, ("squatter", squatter.host if squatter.robots > 1 else None),
            f"{where}, the last of team {squatter.team}, but none with a password. Only some of them are "
            "listed. Find that computer and take it off the network",
            REMEMBER_S,
        )

    def complaint(self, now: Now, text: str) -> None:
        """Warn of unreadable datagrams on the public channel. The latest text stays for a while."""
        self._kept["complaint", None] = (now.mono + REMEMBER_S, text)

    def trouble(self, now: Now, text: str) -> Optional[str]:
        """Warn of something on this computer that does not work."""
        return self._keep(now, ("trouble", text), text, TROUBLE_REMEMBER_S)

    def notice(self, now: Now, text: str) -> Optional[str]:
        """Show what this start found out about the time before it, such as a journal that is not continued."""
        return self._keep(now, ("notice", text), text, NOTICE_REMEMBER_S)

    def repaired(self, text: str) -> None:
        """Remove the warning of a trouble with this text."""
        self._kept.pop(("trouble", text), None)

    def journal(self, text: str) -> bool:
        """Set why the journal cannot be written, for as long as this lasts; empty: it can. Return whether it is new."""
        is_new, self._journal_trouble = text != self._journal_trouble, text
        return is_new

    def not_listed(self, now: Now, host: str) -> Optional[str]:
        """Warn of a robot that is not listed, because the list is full or the name is unusable."""
        return self._keep(
            now, ("not listed", None),
            f"Beacons from {host} are ignored: too many robots, or the name is empty or too long",
            REMEMBER_S,
        )

    def tablet(self, now: Now, host: str, heard: HeardTablet) -> Optional[str]:
        """Warn of a TabletBeacon that does not count, if it is one."""
        if heard.absurd:
            return self._keep(now, ("tablet", "absurd"),
                              f"The tablet at {host} sends {heard.absurd}. Until then it is ignored", REMEMBER_S)
        if heard.rival_of:
            return self._keep(
                now, ("tablet", "rival"),
                f"Two tablets are on: {heard.rival_of} counts, {host} is ignored. Switch off the wrong one",
                REMEMBER_S,
            )
        return None

    def devices(self, connected: bool, text: str) -> None:
        """Set whether the devices' controller is reached; `text` gives the reason if not."""
        self._devices_trouble = "" if connected else f"Home devices: {text}"

    def devices_warnings(self) -> List[str]:
        """Return the problem with the devices' controller, while it lasts."""
        return [self._devices_trouble] if self._devices_trouble else []

    def device_refused(self, now: Now, device: str, value: int, reason: str) -> str:
        """Warn that a robot's command to a device failed."""
        text = f"{device} was not set to {value} as the robot commanded: {reason}"
        self._keep(now, ("device", device), text, REMEMBER_S)
        return text

    def clock_stepped(self, now: Now, step: float) -> str:
        """Warn that the box's own clock was set by `step` seconds."""
        text = f"The clock of this computer was set by {step:+.3f} s: skews are measured again"
        self._keep(now, ("clock", None), text, CLOCK_REMEMBER_S)
        return text

    def restarted(self, now: Now, text: str) -> None:
        """End the time in which the box only listens: runs continue after a restart of the core."""
        self._listen_duration = 0.0
        self._keep(now, ("restart", None), text, CLOCK_REMEMBER_S)

    def warnings(self, now: Now) -> List[str]:
        """Return the current warnings for every referee."""
        self._kept = {key: kept for key, kept in self._kept.items() if kept[0] >= now.mono}
        journal = [self._journal_trouble] if self._journal_trouble else []
        held = [self._held_text()] if self._held_by else []
        return held + journal + [text for _, text in self._kept.values()]

    def _keep(self, now: Now, key: Tuple[str, object], text: str, seconds: float) -> Optional[str]:
        old = self._kept.get(key)
        is_new = old is None or old[0] < now.mono
        if old is None and self._count(key[0]) >= MAX_KEPT:
            self.warnings(now)
            if self._count(key[0]) >= MAX_KEPT:
                return None
        self._kept[key] = (now.mono + seconds, text)
        return text if is_new else None

    def _count(self, kind: str) -> int:
        return sum(1 for known, _ in self._kept if known == kind)


# If the offset between the clocks changes by this much between two calls, somebody has set UTC: NTP slews by at most
# 0.5 ms a second.
STEP_S = 0.05


class ClockWatch:
    """Detects steps of the box's own UTC clock by comparing it with the monotonic one."""

    def __init__(self) -> None:
        self._offset: Optional[float] = None

    def look(self, now: Now) -> float:
        """Return by how many seconds UTC was stepped since the last call; 0.0: it was not."""
        offset = now.utc - now.mono
        step = 0.0 if self._offset is None else offset - self._offset
        self._offset = offset
        return step if abs(step) > STEP_S else 0.0
