"""A second of the link record: how well a robot and the box hear each other. `core/link/record.py` measures it."""

from typing import NamedTuple, Optional

# No robot needs longer to answer. A later answer is not an answer to the first datagrams.
ANSWER_S = 0.5


class LinkSample(NamedTuple):
    """Measurements of a robot's link since the previous sample, usually for one second.

    From the robot to the box:
    `received`: datagrams that were newer than all before.
    `lost`: datagrams that the robot must have sent, but that did not arrive in order. This is based on the robot's
    times: the next message is due a second after each message, and ten in half a second after a change of state. They
    are counted when the next message arrives, so during a silence only `gap_s` grows. Not counted: losses at the end of
    a run, bursts of a robot from which no burst was received yet, bursts after new online data, and most of a burst
    that was cut short. Too large for a robot that sends less often than the rules require. A delayed datagram counts as
    lost, and as `stale` when it arrives.
    `skipped_states`: states that the robot went through without the box receiving them. Usually their datagrams were
    lost. A robot that goes through two states at once sends none for the first.
    `duplicates`, `stale`: datagrams that arrived twice, or after a newer one. Copies of older ones are stale, too.
    `unreadable`: datagrams that could not be decrypted or parsed, whoever sent them to this port.
    `gap_s`: the longest time without a newer message up to the sample, in seconds, including the part before the
    previous sample. Up to about 1 s is normal.
    `late_s`: the difference in delay between the slowest message and the fastest of the last 2.5 s, in seconds. Causes
    are a radio that waits or repeats, and a busy robot. The delay common to all messages is not included.

    From the box to the robot, and back. The robot does not acknowledge what it receives. This direction is therefore
    only visible where the robot must react: to the box's changes of state, and to the acknowledgement of online data.
    `answers`: how many of these the robot reacted to. `unanswered`: datagrams of the box, at least `ANSWER_S` old, that
    a newer message of the robot does not react to. They were lost, or the robot is slow. Too large for a robot that
    repeats acknowledged strings. `round_trip_s`, `round_trip_max_s`: the shortest and the longest time, in seconds,
    from first sending something to the arrival of the reaction. This includes the robot's own delay (up to 0.2 s if it
    reads its messages five times a second), and repetitions if the first datagrams were lost. The shortest one of a run
    is closest to the network's. None: nothing was sent that needs a reaction.

    Clocks, robot's minus box's, in seconds:
    `skew_s`: the largest difference of the last 2.5 s between a message's time and its arrival. The true skew is
    larger than this by the travel time of the fastest message. None: nothing was heard since a clock was set.
    `skew_max_s`: an upper limit of the true skew. A reaction is sent after what it reacts to, which gives the limit.
    """

    seconds: float  # since the previous sample
    received: int = 0
    lost: int = 0
    skipped_states: int = 0
    duplicates: int = 0
    stale: int = 0
    unreadable: int = 0
    gap_s: float = 0.0
    late_s: float = 0.0
    answers: int = 0
    unanswered: int = 0
    round_trip_s: Optional[float] = None
    round_trip_max_s: Optional[float] = None
    skew_s: Optional[float] = None
    skew_max_s: Optional[float] = None
    host: str = ""  # the robot's address; empty: not known yet
