"""Sentences that the core sends, for screens in other languages. They are in English on the ROS interface.

A sentence that is not in this list is shown in English. A test compares the list with the core's texts.
"""

import functools
import re
from typing import Dict, List, Optional, Pattern, Tuple

from roah_rsbb.wording import language
from roah_rsbb.wording.language import tr, tr_later

SENTENCES: Tuple[str, ...] = (
    # The state of a run, and how it ended.
    tr_later("All OK for start"),
    tr_later("Can be restarted. The clock kept running"),
    tr_later("Can be restarted. The clock is stopped"),
    tr_later("Clock paused by the referee"),
    tr_later("Attempt {number} of {all}"),
    tr_later("Without a robot: only the referee starts and stops the clock"),
    tr_later("Robot ready to accept connection: {robot}"),
    tr_later("{number} robots ready to accept connection: {robots}"),
    tr_later("Several robots of team {team} are active ({robots}): choose which one connects"),
    tr_later("Connected: waiting for the robot's first message"),
    tr_later("Requested the robot to prepare for a new goal"),
    tr_later("Robot preparing for the task"),
    tr_later("Robot prepared, executing (no explicit goal)"),
    tr_later("Robot prepared, goal sent"),
    tr_later("Robot received the goal, waiting for its result"),
    tr_later("Robot fell back to {state}: preparing again"),
    tr_later("Messages saved: {number}"),
    tr_later("Started: the benchmarking module begins"),
    tr_later("Manual operation: {text}"),
    tr_later("Goal completed by the robot"),
    tr_later("Goal timed out"),
    tr_later("Benchmark complete"),
    tr_later("Benchmark stopped by the referee"),
    tr_later("Benchmark completed by the robot"),
    tr_later("Stopped due to timeout"),
    tr_later("Benchmark over: every goal timed out"),
    tr_later("Stopped: the robot saves no offline data (messages saved stays 0)"),
    tr_later("Stopped: the benchmarking module cannot continue"),
    tr_later("No-show: the team did not appear"),
    tr_later("The team withdrew"),
    # Why the time of a run does not count.
    tr_later("manual operation"),
    tr_later("the benchmarking module is missing"),
    tr_later("by the referee"),
    # Why a command is off.
    tr_later("Already connected"),
    tr_later("Already started"),
    tr_later("A run is connected: disconnect it first"),
    tr_later("A run is running: stop it first"),
    tr_later("No run is running"),
    tr_later("The run was started, so its team appeared"),
    tr_later("No run is connected"),
    tr_later("No run is connected: press connect first"),
    tr_later("No run is connected, so there is nothing to stop"),
    tr_later("The run is not started: disconnect to leave it"),
    tr_later("The run is over: disconnect to leave it"),
    tr_later("The run ended by timeout: disconnect, and connect for a new run"),
    tr_later("The run's time is up (the clock kept running after the stop): disconnect, and connect for a new run"),
    tr_later("The rules of this benchmark do not allow a restart: disconnect, and connect for a new run"),
    tr_later("The rules of this benchmark do not allow a pause"),
    tr_later("The clock is paused"),
    tr_later("The clock is not paused"),
    tr_later("This benchmark has no phases"),
    tr_later("This is the first phase"),
    tr_later("This is the last phase"),
    tr_later("This is the zone's first event"),
    tr_later("This is the zone's last event"),
    tr_later("No robot of team {team} is active: none of its beacons arrives on UDP port {port}"),
    tr_later("No robot is active: no beacon arrives on UDP port {port}"),
    tr_later("Robot {robot} is in a run in zone {zone}"),
    tr_later("The box is still listening for another box, for {time} s"),
    # Warnings.
    tr_later("Listening for another box before transmitting: {time} s"),
    tr_later("The setup time of {time} is over"),
    tr_later("The {time} of {phase} are over"),
    tr_later("Robot has not answered on the private channel yet"),
    tr_later("Robot has not stopped yet: it reports {state}"),
    tr_later("No message from the robot for {time} s"),
    tr_later("Clock skew of {robot} is {skew}, but must be below {limit} s: synchronise the robot's clock"),
    tr_later("Benchmarking module not connected: the run is paused until it is back"),
    tr_later("This is a replay of {run}: nothing here is live, and commands have no effect"),
    tr_later("ANOTHER RSBB is transmitting from {address}: stop it, robots obey both"),
)

_PLACE = re.compile(r"{(\w+)}")


def tr_sent(text: str) -> str:
    """Return a sentence of the core in the language of this process; one that is not in the list stays in English."""
    if language.is_english():
        return text
    found = _found(text)
    return text if found is None else tr(found[0], **found[1])


# Panels are redrawn ten times a second.
@functools.lru_cache(maxsize=1024)
def _found(text: str) -> Optional[Tuple[str, Dict[str, str]]]:
    """Return the sentence of the list, and the values in its places."""
    for sentence, pattern in _patterns():
        match = pattern.fullmatch(text)
        if match:
            return sentence, match.groupdict()
    return None


@functools.lru_cache(maxsize=1)
def _patterns() -> List[Tuple[str, Pattern[str]]]:
    return [(sentence, _pattern(sentence)) for sentence in SENTENCES]


def _pattern(sentence: str) -> Pattern[str]:
    parts = _PLACE.split(sentence)  # a text, then the name of a place, and so on
    return re.compile("".join(f"(?P<{part}>.+?)" if index % 2 else re.escape(part) for index, part in enumerate(parts)))
