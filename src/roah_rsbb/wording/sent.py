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
    tr_later("The run is over, but the robot did not answer STOP: stop it by hand"),
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
    tr_later("Name the team: the zone may have gone to the event of another one"),
    tr_later("The current event of zone '{zone}' is of team {team}, not of team {named}: choose the event first"),
    tr_later("Zone '{zone}' is at another event of team {team} now: choose the event first"),
    tr_later("The event is of team {team} now: choose it again"),
    # Warnings.
    tr_later("Listening for another box before transmitting: {time} s"),
    tr_later("The setup time of {time} is over"),
    tr_later("The {time} of {phase} are over"),
    tr_later("Robot has not answered on the private channel yet"),
    tr_later("Robot has not stopped yet: it reports {state}"),
    tr_later("The robot did not answer STOP: stop it by hand. The box repeats STOP until the disconnect"),
    tr_later("No message from the robot for {time} s"),
    tr_later("No message from the robot for {time} s, but its beacons arrive: its program was restarted, or a firewall "
             "blocks the private channel. Check whether it moves"),
    tr_later("The robot has disappeared: no message for {time} s, and no beacon from its address. It may still be "
             "moving, and STOP may not reach it: check it"),
    tr_later("Clock skew of {robot} is {skew}, but must be below {limit} s: synchronise the robot's clock"),
    tr_later("The core was restarted at {time}, {down} s after its last record"),
    tr_later("Benchmarking module not connected: the run is paused until it is back"),
    tr_later("This is a replay of {run}: nothing here is live, and commands have no effect"),
    tr_later("NOT CONFIRMED: the standby does not have the last entries: {why}. To continue with one computer, delete "
             "'durable: two' in {place} and reload"),
    tr_later("not confirmed: {why}. To continue with one computer, delete 'durable: two' in {place} and reload. It "
             "counts, and is saved on this computer: do not enter it again. It is confirmed as soon as the standby has "
             "it"),
    tr_later("not confirmed: the box at {address} has taken over, and may not have this entry. Look there, and enter "
             "it there if it is missing"),
    tr_later("The standby is {standby} now, instead of {other}. If none of you paired it, a stranger has all results "
             "and passwords: pair your standby again, and give the teams new passwords"),
    # Why the standby does not have an entry.
    tr_later("it did not answer within {time} s"),
    tr_later("node roah_rsbb_backup does not report. Check that it runs"),
    tr_later("the copy is being written. If this lasts, its disk or its connection is too slow"),
    tr_later("the journal of this core is not copied yet. If this lasts, start the node roah_rsbb_backup with the "
             "log_dir of the core"),
    tr_later("no standby is paired yet. Enter on the box: {command}"),
    tr_later("no standby is connected since this computer took over. Enter 'standby rejoin' on the computer that was "
             "the box, or pair another computer"),
    tr_later("the standby is not connected. It connects by itself: check that it runs, and its cable"),
    tr_later("the standby reports: {why}"),
    tr_later("the disk is full. Free space for {folder}"),
    tr_later("its disk failed to save what was written. It is written again, and what was there before stays until "
             "that is complete. If this happens again, replace the disk"),
    tr_later("ANOTHER RSBB is transmitting from {address}, and robots obey both: stop it, or take that computer off "
             "the network"),
    tr_later("ANOTHER RSBB was heard at {address}, so this box sends nothing until you press connect. Stop the other "
             "box first, or take that computer off the network if it is none of yours"),
    tr_later("Two robots call themselves {robot}: {address} (confirmed by its password) and {others}. Connect and "
             "start use the one that knows the password. Give the other one another robot_name, or take it off the "
             "network"),
    tr_later("Two robots call themselves {robot}: {address} (confirmed by its password) and {others}. Connect and "
             "start use the one that knows the password. Give the other one another robot_name, or take it off the "
             "network. Their clocks differ: {skew} and {other}"),
    tr_later("Two robots call themselves {robot}: {address} and {others}. Connect and start use the one that knows the "
             "password. Give the other one another robot_name, or take it off the network"),
    tr_later("Two robots call themselves {robot}: {address} and {others}. Connect and start use the one that knows the "
             "password. Give the other one another robot_name, or take it off the network. Their clocks differ: "
             "{skew} and {other}"),
    tr_later("Beacons of {robot} from {address} show two clocks: somebody forges this address, or two programs there "
             "use the name. Start uses the clock of the one that knows the password. Find the other one and take it "
             "off the network"),
)

_PLACE = re.compile(r"{(\w+)}")
# The place of another sentence of the list.
_NESTED = "why"


def tr_sent(text: str) -> str:
    """Return a sentence of the core in the language of this process; one that is not in the list stays in English."""
    if language.is_english():
        return text
    found = _found(text)
    if found is None:
        return text
    return tr(found[0], **{name: tr_sent(value) if name == _NESTED else value for name, value in found[1].items()})


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
