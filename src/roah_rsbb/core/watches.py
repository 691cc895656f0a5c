"""Warnings for every referee: another box, two robots of one name, steps of the box's clock."""

from typing import Dict, List, Optional, Tuple

from roah_rsbb.core.effects import Level, Outbox
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
    """The warnings of the whole box. A warning that is new is a line of the log, too."""

    def __init__(self, listen_duration: float, outbox: Outbox) -> None:
        self._listen_duration = listen_duration
        self._outbox = outbox
        self._started: Optional[float] = None
        # (kind, cause) -> (monotonic time until which it is shown, text)
        self._kept: Dict[Tuple[str, object], Tuple[float, str]] = {}
        self._journal_trouble = ""
        self._held_by = ""

    @property
    def held_by(self) -> str:
        """The address of another box that this one heard before it sent anything. It sends nothing until a referee
        connects a robot. Empty: it need not wait."""
        return self._held_by

    def start(self, now: Now) -> None:
        """Begin the time in which the box only listens."""
        self._started = now.mono

    def listening_left(self, now: Now) -> float:
        """Return for how many more seconds the box only listens."""
        if self._started is None:
            return self._listen_duration
        return max(0.0, self._started + self._listen_duration - now.mono)

    def end_listening(self) -> None:
        """End the time in which the box only listens."""
        self._listen_duration = 0.0

    def foreign_box(self, now: Now, host: str) -> None:
        """Warn of another box that transmits: two boxes confuse every robot."""
        self._warn(now, ("box", host), ANOTHER_BOX(address=host), level=Level.ERROR)

    def hold(self, host: str) -> None:
        """Send nothing, because of another box. The warning stays until `release`."""
        is_new, self._held_by = host != self._held_by, host
        if is_new:
            self._outbox.notice(Level.ERROR, self._held_text())

    def release(self) -> None:
        """Begin to send: a referee connects a robot in spite of the other box."""
        self._held_by = ""

    def _held_text(self) -> str:
        return HELD(address=self._held_by)

    def rivals(self, now: Now, robot: ActiveRobot) -> None:
        """Warn of several hosts that use one robot's name, if there are any. A robot that moved is no longer where the
        warning before says."""
        rivals = robot.rivals(now)
        if not robot.is_here(rivals):
            if robot.has_moved:
                self._kept.pop(("rival", robot.id), None)
            return
        hosts = sorted(rivals, key=lambda host: -rivals[host].mono)
        others = " and ".join(hosts[:2]) + (f" and {len(hosts) - 2} more" if len(hosts) > 2 else "")
        mine, theirs = robot.skew.seconds or 0.0, rivals[hosts[0]].skew
        differ = abs(mine - theirs) >= TWO_CLOCKS_S
        skews = {"skew": times.skew(mine), "other": times.skew(theirs)} if differ else {}
        text = RIVALS[robot.host == robot.confirmed_host, differ](
            robot=str(robot.id), address=robot.host, others=others, **skews)
        self._warn(now, ("rival", robot.id), text)

    def two_clocks(self, now: Now, robot: ActiveRobot) -> None:
        """Warn of beacons that show two clocks at one address, if there are any."""
        if robot.has_two_clocks(now):
            self._warn(now, ("clocks", robot.id), TWO_CLOCKS(robot=str(robot.id), address=robot.host))

    def squatter(self, now: Now, squatter: Squatter) -> None:
        """Warn of a host that announces more robots than the list accepts."""
        where = (f"{squatter.host} announces at least {squatter.robots} robots" if squatter.robots > 1 else
                 f"Many addresses, such as {squatter.host}, announce robots")
        self._warn(now, ("squatter", squatter.host if squatter.robots > 1 else None),
                   f"{where}, the last of team {squatter.team}, but none with a password. Only some of them are "
                   "listed. Find that computer and take it off the network")

    def complaint(self, now: Now, text: str) -> None:
        """Warn of datagrams on the public channel. The latest text stays for a while."""
        self._kept["complaint", None] = (now.mono + REMEMBER_S, text)
        self._outbox.notice(Level.WARNING, text)

    def trouble(self, now: Now, text: str) -> None:
        """Warn of something on this computer that does not work. `text` names the remedy."""
        self._warn(now, ("trouble", text), text, TROUBLE_REMEMBER_S, Level.ERROR)

    def notice(self, now: Now, text: str) -> None:
        """Warn of what this start found out about the time before it, such as a journal that is not continued."""
        self._warn(now, ("notice", text), text, NOTICE_REMEMBER_S)

    def repaired(self, _now: Now, trouble: str, text: str) -> None:
        """End the warning of a trouble. `text` says that it is over."""
        self._kept.pop(("trouble", trouble), None)
        self._outbox.notice(Level.INFO, text)

    def journal(self, _now: Now, trouble: str) -> None:
        """Warn of a journal that cannot be written, for as long as this lasts. `trouble` names the remedy; empty:
        everything is written again."""
        is_new, self._journal_trouble = trouble != self._journal_trouble, trouble
        if is_new:
            self._outbox.notice(*((Level.ERROR, trouble) if trouble else (Level.INFO, "The journal is written again")))

    def not_listed(self, now: Now, host: str) -> None:
        """Warn of a robot that is not listed, because the list is full or the name is unusable."""
        self._warn(now, ("not listed", None),
                   f"Beacons from {host} are ignored: too many robots, or the name is empty or too long")

    def tablet(self, now: Now, host: str, heard: HeardTablet) -> None:
        """Warn of a TabletBeacon that does not count, if it is one."""
        if heard.absurd:
            self._warn(now, ("tablet", "absurd"),
                       f"The tablet at {host} sends {heard.absurd}. Until then it is ignored")
        if heard.rival_of:
            self._warn(now, ("tablet", "rival"),
                       f"Two tablets are on: {heard.rival_of} counts, {host} is ignored. Switch off the wrong one")

    def device_refused(self, now: Now, device: str, value: int, reason: str) -> str:
        """Warn that a robot's command to a device failed. Its run is a better place in the log: the text is returned.
        """
        text = f"{device} was not set to {value} as the robot commanded: {reason}"
        self._keep(now, ("device", device), text, REMEMBER_S)
        return text

    def clock_stepped(self, now: Now, step: float) -> None:
        """Warn that the box's own clock was set by `step` seconds."""
        text = f"The clock of this computer was set by {step:+.3f} s: skews are measured again"
        self._keep(now, ("clock", None), text, CLOCK_REMEMBER_S)
        self._outbox.notice(Level.WARNING, text)

    def restarted(self, now: Now, text: str) -> None:
        """End the time in which the box only listens: runs continue after a restart of the core."""
        self.end_listening()
        self._keep(now, ("restart", None), text, CLOCK_REMEMBER_S)

    def warnings(self, now: Now) -> List[str]:
        """Return the current warnings for every referee."""
        self._kept = {key: kept for key, kept in self._kept.items() if kept[0] >= now.mono}
        journal = [self._journal_trouble] if self._journal_trouble else []
        held = [self._held_text()] if self._held_by else []
        return held + journal + [text for _, text in self._kept.values()]

    def _warn(self, now: Now, key: Tuple[str, object], text: str, seconds: float = REMEMBER_S,
              level: Level = Level.WARNING) -> None:
        if self._keep(now, key, text, seconds):
            self._outbox.notice(level, text)

    def _keep(self, now: Now, key: Tuple[str, object], text: str, seconds: float) -> bool:
        """Show a warning for so long. Return whether it is new."""
        old = self._kept.get(key)
        is_new = old is None or old[0] < now.mono
        if old is None and self._count(key[0]) >= MAX_KEPT:
            self.warnings(now)
            if self._count(key[0]) >= MAX_KEPT:
                return False
        self._kept[key] = (now.mono + seconds, text)
        return is_new

    def _count(self, kind: str) -> int:
        return sum(1 for known, _ in self._kept if known == kind)
