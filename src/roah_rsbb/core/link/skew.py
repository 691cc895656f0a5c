"""Clock skew of a robot, estimated from the times in its messages.

Skew is the robot's clock minus the box's: positive means that the robot's clock is ahead. Every message gives a sample:
its `time` minus the moment of arrival at the box's computer. A delay in the network makes a sample smaller than the
true skew, never larger. The largest sample of the last few seconds is therefore the best one. Benchmarks may start only
within `allowed_skew` (docs/protocol.md, "Timing").
"""

import operator
from collections import deque
from typing import Deque, List, NamedTuple, Optional, Tuple

from roah_rsbb.model.clock import Mono
from roah_rsbb.model.reason import say
from roah_rsbb.wording import times

# Three beacons: after this long, a corrected clock has replaced all old samples.
WINDOW_S = 2.5
# For robots that send every few milliseconds, this many samples are enough.
MAX_SAMPLES = 64
THE_ROBOT = say("the robot")
UNKNOWN = say("Clock skew of {robot} is not known yet")
TOO_BIG = say("Clock skew of {robot} is {skew}, but must be below {limit} s: synchronise the robot's clock")

_SKEW = operator.itemgetter(1)


class SkewSample(NamedTuple):
    """A skew, and when it was measured."""

    mono: Mono
    seconds: float


class SkewEstimate:
    """The skew of one robot, in seconds."""

    def __init__(self, first: Optional[SkewSample] = None) -> None:
        """`first`: the estimate from before a restart."""
        self._samples: Deque[Tuple[float, float]] = deque()
        self.seconds: Optional[float] = None
        if first is not None:
            self.sample(first.mono, first.seconds)

    @property
    def count(self) -> int:
        """The number of samples behind the estimate."""
        return len(self._samples)

    def sample(self, mono: float, skew: float) -> float:
        """Take a sample of `skew` (s) that arrived at `mono` (s); return the new estimate (s)."""
        samples = self._samples
        last = samples[-1] if samples else None
        is_best_gone = False
        while samples and (len(samples) == MAX_SAMPLES or samples[0][0] < mono - WINDOW_S):
            is_best_gone |= samples.popleft()[1] == self.seconds
        if last is not None and not samples:
            # The first message after a silence may have been delayed for seconds while the network found a route. As
            # the only sample, it would make a correct clock look wrong.
            samples.append((mono, last[1]))
        samples.append((mono, skew))
        if self.seconds is None or is_best_gone:
            self.seconds = max(samples, key=_SKEW)[1]
        elif skew > self.seconds:
            self.seconds = skew
        return self.seconds

    def restart(self) -> None:
        """Drop all samples, because one of the two clocks was set."""
        self._samples.clear()
        self.seconds = None


def within(skew: Optional[float], allowed: float) -> bool:
    """Whether a skew is known and below the allowed one, in both directions (docs/protocol.md, "Timing")."""
    return skew is not None and abs(skew) < allowed


def skew_off(whose: str, skew: Optional[float], allowed: float) -> List[str]:
    """Return why a skew (s) prevents a benchmark; empty: it does not."""
    if within(skew, allowed):
        return []
    if skew is None:
        return [UNKNOWN(robot=whose)]
    return [TOO_BIG(robot=whose, skew=times.skew(skew), limit=f"{allowed:.3f}")]
