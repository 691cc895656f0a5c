"""What faces say of the whole box: the tablet, the robots that it hears, the home devices, its end; and how they mark
one that is not live."""

import collections
import math
from typing import Deque, Dict, Hashable, Iterable, List, NamedTuple, Optional, Tuple

from roah_rsbb.model.clock import Now
from roah_rsbb.model.document import Document, TabletSeen
from roah_rsbb.model.reason import say
from roah_rsbb.model.zone import RUNNING, ZoneSeen
from roah_rsbb.wording import times
from roah_rsbb.wording.language import number, tr, tr_later
from roah_rsbb.wording.times import Moments

# -- the box itself and the tablet (docs/referee.md, "Core Status" and "Tablet Status") ------------

BOX_FACTS = (tr_later("Broadcast to"), tr_later("UDP port"), tr_later("Robots"), tr_later("Running"))
TABLET_FACTS = (tr_later("Last heard"), tr_later("Display"), tr_later("Last call"), tr_later("Position"),
          tr_later("Position received"))
# After this long without a message the tablet is silent: it sends every second.
TABLET_SILENT_S = 5.0


def box_facts(document: Document) -> Tuple[str, ...]:
    """Return the texts of all `BOX_FACTS`."""
    running = sum(zone.phase == RUNNING for zone in document.zones.values())
    return (document.box.host, str(document.box.port), str(len(document.robots)),
            tr("{number} of {n} zones", number=running, n=len(document.zones)))


def tablet_facts(seen: TabletSeen, now: Now, moments: Moments) -> List[Tuple[str, float]]:
    """Return the texts of all of `TABLET_FACTS`, each with the moment that it is about in UTC seconds; 0.0: none."""
    silent_s = 0.0 if seen.silent_since is None else now.mono - seen.silent_since
    silent = f"  {tr('⚠ silent')}" if silent_s > TABLET_SILENT_S else ""
    heard, call, position = ((moments.and_age(utc_s, now.utc), utc_s) for utc_s in (
        now.utc - silent_s if seen.heard else 0.0, seen.call_utc_s, seen.position_utc_s))
    place = tr("x {x:.2f} m, y {y:.2f} m", x=seen.position_x, y=seen.position_y) if seen.position_utc_s else tr("none")
    return [(heard[0] + silent, heard[1]), (tr("Map") if seen.display_map else tr("Call button"), 0.0), call,
            (place, 0.0), position]


# -- the robots that the box hears, and the quality of their links ---------------------------------

ROBOT_COLUMNS = (
    tr_later("Team"), tr_later("Robot"), tr_later("Link"), tr_later("Clock skew"), tr_later("Run in zone"),
    tr_later("Last heard"),
)
LINK, SKEW = 2, 3  # columns that are explained
# What waits for somebody.
TO_SIGN, TO_ANSWER = tr_later("Score sheets to sign off"), tr_later("Objections to answer")
TO_DECIDE = tr_later("Marks from before the sign-off to decide on")
TO_SETTLE, ALONE = tr_later("Items to settle"), tr_later("Zones without the phone of a referee")
NO_RUN, NO_ROBOT = "–", tr_later("No robot is heard")

# Older silences are ignored, seconds.
WINDOW_S = 10.0
# Between two looks, of which pages without readers have one a second; after a longer time, nothing is known, seconds.
MISSED_S = 2.5


class _Level(NamedTuple):
    up_to_s: float
    text: str


# A robot sends each second; after 3 s without a message the core warns.
LEVELS = (_Level(1.6, tr_later("▮▮▮ good")), _Level(3.0, tr_later("▮▮▯ gaps")), _Level(10.0, tr_later("▮▯▯ poor")))
SILENT = tr_later("▯▯▯ silent")


class _Robot:
    def __init__(self) -> None:
        self.since: Optional[float] = None
        self.gaps: Deque[Tuple[float, float]] = collections.deque()  # (when it ended, how long it was)


class LinkQuality:
    """Watches all robots. Times: seconds of the box's clock. Let it look each second, and when the document changes."""

    def __init__(self) -> None:
        self._robots: Dict[Hashable, _Robot] = {}
        self._mono = -math.inf

    def look(self, document: Document, mono: float) -> None:
        """Look at the robots of a document at the moment `mono`."""
        self.observe(mono, {name: robot.silent_since for name, robot in document.robots.items()})

    def observe(self, mono: float, silent: Dict[Hashable, Optional[float]]) -> None:
        """Record since when each robot is silent, at the moment `mono`; None: it is not. Robots that are missing are
        forgotten."""
        if not 0.0 <= mono - self._mono <= MISSED_S:
            self._robots.clear()
        self._mono = mono
        self._robots = {name: self._robots.get(name) or _Robot() for name in silent}
        for name, robot in self._robots.items():
            since = silent[name]
            if robot.since is not None and since != robot.since:
                robot.gaps.append((mono, (mono if since is None else since) - robot.since))
            robot.since = since
            while robot.gaps and mono - robot.gaps[0][0] > WINDOW_S:
                robot.gaps.popleft()

    def longest_silence_s(self, name: Hashable) -> Optional[float]:
        """Return the longest silence that ended within the window or still lasts, 0.0 if there was none; None: unknown
        robot."""
        robot = self._robots.get(name)
        if robot is None:
            return None
        return max([0.0 if robot.since is None else self._mono - robot.since, *(length for _, length in robot.gaps)])


def link_text(longest_silence_s: Optional[float]) -> str:
    """Return it as bars and a word, with the number if something is wrong."""
    if longest_silence_s is None:
        return ""
    for level in LEVELS:
        if longest_silence_s <= level.up_to_s:
            silence = number(f"{longest_silence_s:.1f} s")
            return tr(level.text) if level is LEVELS[0] else f"{tr(level.text)}, {silence}"
    return tr(SILENT)


def column_explanations() -> Dict[int, str]:
    """Return what some columns mean, by their index."""
    return {
        LINK: tr("Longest silence of the robot in the last {time:.0f} s. It sends every second.", time=WINDOW_S),
        SKEW: tr("The robot's clock minus the box's: + is ahead, - is behind"),
    }


def robot_rows(document: Document, mono: float, links: LinkQuality) -> List[Tuple[str, ...]]:
    """Return the texts of all columns for each robot, in alphabetical order, at the moment `mono`."""
    return [(
        robot.team, robot.robot, link_text(links.longest_silence_s(name)), times.skew(robot.skew),
        document.zone_of(name) or NO_RUN,
        times.ago(0.0 if robot.silent_since is None else mono - robot.silent_since),
    ) for name, robot in sorted(document.robots.items(), key=lambda item: item[1][:2])]


# -- the home devices: names, states and commands, the bell, the controller (docs/devices.md) ------


class TwoStates(NamedTuple):
    """The states 0 and 1 of a device that has only these, and the commands that set them."""

    states: Tuple[str, str]
    commands: Tuple[str, str]


_SWITCH = TwoStates((tr_later("off"), tr_later("ON")), (tr_later("Turn off"), tr_later("Turn on")))
_DOOR = TwoStates((tr_later("closed"), tr_later("OPEN")), (tr_later("Close"), tr_later("Open")))
# All devices that are set, by the names of `DevicesState`, in the order of the faces. Those without states are
# percentages.
DEVICES: Dict[str, Optional[TwoStates]] = {
    "switch_1": _SWITCH, "switch_2": _SWITCH, "switch_3": _SWITCH, "dimmer": None, "blinds": None,
    "door_win_detect": _DOOR}
_NAMES = {"dimmer": tr_later("Dimmer"), "blinds": tr_later("Blinds"), "door_win_detect": tr_later("Door")}
BELL, RING = tr_later("Bell"), tr_later("♪ Ring")
# Marks a value that nobody has confirmed.
UNCONFIRMED = " …"
PERCENT = 100
# How long a ring is highlighted.
RINGS_S = 5.0

AWAY = tr_later("What you set here takes effect when the controller is connected again.")
NO_DEVICES = say("this box controls no home devices: start it with devices:=true")


def device_name(device: str) -> str:
    """Return the name of a device."""
    return tr(_NAMES[device]) if device in _NAMES else tr("Switch {number}", number=device[-1])


def device_states(device: str) -> List[str]:
    """Return the texts of the states 0 and 1 of a device; none: it is a percentage."""
    kind = DEVICES[device]
    return [] if kind is None else [f"{mark} {tr(state)}" for mark, state in zip("○●", kind.states)]


def device_commands(device: str) -> List[Tuple[str, int]]:
    """Return the commands that set a device to a certain value, each with that."""
    kind = DEVICES[device]
    if kind is None:
        return [("0 %", 0), (f"{PERCENT} %", PERCENT)]
    return [(tr(kind.commands[value]), value) for value in (1, 0)]


def bell_text(rang_s: float, now_s: float, moments: Moments) -> Tuple[str, bool]:
    """Return when the bell rang last, and whether it rings now."""
    text, rings = tr("Last ring: {time}", time=moments.and_age(rang_s, now_s)), 0 < rang_s > now_s - RINGS_S
    return f"{tr('♪ RINGS')}  ·  {text}" if rings else text, rings


def controller_text(is_connected: bool, text: str) -> Tuple[str, str]:
    """Return whether the controller is connected, and what else is to be known. `text`: details, or the reason."""
    if is_connected:
        return tr("● connected"), text
    return tr("NOT CONNECTED"), f"{text}\n{tr(AWAY)}".strip()


# -- its configuration, and its end ----------------------------------------------------------------

RELOAD = tr_later("Reload configuration")
RELOAD_ERRORS = tr_later("Nothing was changed. Correct this first:")
RELOAD_APPLY = tr_later("Apply these changes? Connected runs keep what they began with.")
RELOAD_RESCORED = tr_later("Scored by the changed sheets, these runs that are over would have other points:")
RELOAD_FOR_ALL = tr_later("Apply to the runs that are over, too")
RELOAD_SAME, RELOAD_DONE = tr_later("The files contain what is in force"), tr_later("The changes are in force")
END_QUESTION, END_NOW = tr_later("End the whole RSBB?"), tr_later("End the RSBB")
ENDS_ALL = tr_later("This ends the box and everything started with it, for all referees.")
END_RUNS = tr_later("Runs in progress: {runs}")
# Why the box does not end.
IN_PROGRESS = say("Runs in progress: {runs}. End the box when they are over, or confirm that it is to end now: they "
                  "continue when it is started again")
NOT_LAUNCHED = say("No launch file started this box ({error}): end it where it was started, with Ctrl-C")


def runs_in_progress(zones: Iterable[ZoneSeen]) -> str:
    """Return the runs in progress with their robots; empty: there are none."""
    return ", ".join(f"{zone.zone} ({zone.robot_name})" for zone in zones if zone.phase == RUNNING)


# -- a replay of an earlier run, so that nobody takes it for a live box ----------------------------

REPLAY = tr_later("REPLAY")
REPLAY_NOT_LIVE = tr_later("REPLAY: not live")
REPLAY_NO_COMMANDS = tr_later("This is a replay: commands have no effect")


# -- a box from which another one took over (docs/standby.md, "The old box") -----------------------

SUPERSEDED_NOT_LIVE = tr_later("superseded: not live")
SUPERSEDED_NO_COMMANDS = tr_later("Another box has taken over: commands have no effect here")
