"""A referee who conducts a run through the door of the box, as panels do, and retries every command."""

import json
import re
from typing import Any, Callable, Dict, List, NamedTuple, Optional, Tuple

import rosbag
from crew import ROBOT
from support.door_client import NoAnswer, Refusal, SeenZone
from support.waiting import wait_until

from box import SPEECH, Box
from roah_rsbb.model.actions import MARK

# Seconds, on a machine that does much else, with an outage in between.
LIMIT_S = 240.0
# HOMF: what the referee enters for each goal: switches, and how many are damaged.
SWITCHES = (((2, 3), 0), ((1, 2), 1))


class Entry(NamedTuple):
    """One entry of a run log; `utc` in seconds."""

    topic: str
    value: Any
    utc: float


class Result(NamedTuple):
    """A run that is over."""

    code: str
    end_reason: str
    module_scores: Dict[Tuple[str, str], Any]
    marked: Dict[Tuple[str, str], int]  # by the referee, and shown by the box
    logs: List[List[Entry]]  # one; of each robot, where all ran at once
    left_out: int  # how many robots were not ready at the start, where all ran at once

    def values(self, topic: str, log: int = 0) -> List[Any]:
        """All values on a topic."""
        return [entry.value for entry in self.logs[log] if entry.topic == topic]


class Referee:
    """Conducts one run in a zone that is named by its benchmark."""

    def __init__(self, box: Box, code: str, number: int) -> None:
        """`number` of the round."""
        self._box, self._code, self._number = box, code, number
        self._switches = list(SWITCHES)
        self._marked: Dict[Tuple[str, str], int] = {}
        self._left_out = 0

    def conduct(self, robots: int = 1) -> Result:
        """Conduct the whole run. `robots`: the number of robots that must be active first, if all run at once."""
        self.connect(robots)
        self.start()
        return self.finish()

    def connect(self, robots: int = 1) -> int:
        """Connect; returns the private port."""
        box, zone = self._box, self._code
        box.wait_details(zone, lambda d: d.event.round == self._number, "it is the round's event", LIMIT_S)
        if zone == SPEECH:
            self._connect_all(robots)
        else:
            self._insist("connect", lambda d: d.phase != "idle")
        return box.zone_details(zone).port

    def _connect_all(self, robots: int) -> None:
        """Wait until the robots' skew is allowed: on a bad network it may leave the allowed range again. One that a
        trouble added, and that has ended since, may still be active, but must not be in the run."""
        box = self._box
        while True:
            ready = f"{robots} robots ready"
            box.wait_details(SPEECH, lambda d, ready=ready: ready in _state(d), ready, LIMIT_S)
            self._insist("connect", lambda d: d.phase != "idle")
            connected = box.wait_details(
                SPEECH, lambda d: _counts(_state(d)) and d.robots, "robots are connected", LIMIT_S)
            if len(connected) == robots and all(line.startswith(f"{ROBOT} of team") for line in connected):
                return
            box.command("disconnect", SPEECH)
            box.wait_phase(SPEECH, "idle")

    def start(self) -> None:
        """Start as soon as the box lets us: a bad network may take its leave just then."""
        if self._code == SPEECH:
            self._box.wait_details(
                SPEECH, lambda d: _all_ready(_state(d)), "all robots are ready", LIMIT_S)
        self._insist("start", lambda d: d.phase not in ("idle", "connected"))
        # On a slow machine, a robot's skew may leave the allowed range just then.
        warnings = self._box.last_details(self._code).warnings
        self._left_out = sum("left out until it is ready" in text for text in warnings)

    def finish(self) -> Result:
        """Run from start to the end, and return the log."""
        box, zone = self._box, self._code
        done = 0
        self._mark()
        while True:
            details = box.wait_details(
                zone, lambda d, done=done: self._something(d, done) and d, "the run ends, or asks the referee", LIMIT_S)
            if details.phase == "ended":
                break
            if details.operation > done:
                done = details.operation
                box.act("operation", zone, operation=done)
            else:
                self._enter_switches()
        wait_until(
            lambda: self._shown() == self._marked, lambda: f"{zone} shows the marks; it has {self._shown()}", LIMIT_S)
        module_scores = {(s.group, s.name): json.loads(s.value) for s in details.module_scores}
        box.command("disconnect", zone)
        box.wait_phase(zone, "idle")
        return Result(zone, details.end_reason, module_scores, self._marked, self._read_logs(), self._left_out)

    def _shown(self) -> Dict[Tuple[str, str], int]:
        return {(item.group, item.desc): item.value for item in self._box.last_details(self._code).items}

    def _something(self, details: SeenZone, done: int) -> bool:
        return details.phase == "ended" or details.operation > done or _are_to_confirm(details)

    def _insist(self, command: str, done: Any) -> None:
        """Repeat a command until it is accepted: a robot may be silent at that moment."""
        refusal = ""

        def attempt() -> bool:
            nonlocal refusal
            if done(self._box.zone_details(self._code)):
                return True
            try:
                self._box.command(command, self._code)
            except (Refusal, NoAnswer) as error:
                refusal = str(error)
            return False

        wait_until(attempt, lambda: f"{command} in {self._code}: {refusal}", LIMIT_S)

    @staticmethod
    def _until_answered(call: Callable[[], object]) -> None:
        """Repeat a call that may come twice: the core may be killed just then."""

        def attempt() -> bool:
            try:
                call()
            except NoAnswer:
                return False
            return True

        wait_until(attempt, "the core answers", LIMIT_S)

    def _mark(self) -> None:
        """Mark each scoring item with a different value."""
        for place, item in enumerate(self._box.zone_details(self._code).items):
            value = (place + 1) % 2 if item.type == "bool" else place + 1
            self._until_answered(lambda item=item, value=value: self._box.act(
                MARK, self._code, group=item.group, desc=item.desc, value=value))
            self._marked[item.group, item.desc] = value

    def _enter_switches(self) -> None:
        pressed, damaged = self._switches.pop(0)
        for switch in pressed:
            self._box.act("switch", self._code, number=switch)
        self._box.act("damaged", self._code, number=damaged)
        self._box.act("confirm_switches", self._code)
        self._box.wait_details(self._code, lambda d: not _are_to_confirm(d), "they are confirmed", LIMIT_S)

    def _read_logs(self) -> List[List[Entry]]:
        wait_until(self._box.has_all_logs, "the logs of runs that are over are made")
        return [_entries(path) for path in self._box.logs_of(self._code, self._number)]


def _state(details: SeenZone) -> str:
    return "\n".join(details.lines)


def _are_to_confirm(details: SeenZone) -> bool:
    return details.switches is not None and details.switches.to_confirm


def _counts(state: str) -> Optional[Tuple[int, int]]:
    """How many robots are connected, and ready, as the referee reads it."""
    found = re.search(r"Robots connected: (\d+) / ready: (\d+)", state)
    return None if found is None else (int(found.group(1)), int(found.group(2)))


def _all_ready(state: str) -> bool:
    counts = _counts(state)
    return counts is not None and counts[0] == counts[1]


def _entries(path: Any) -> List[Entry]:
    with rosbag.Bag(str(path)) as bag:
        return [Entry(topic, getattr(message, "data", message), stamp.to_sec())
                for topic, message, stamp in bag.read_messages()]
