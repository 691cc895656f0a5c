"""What a core publishes for the public display, as a test wants it: real messages without runs."""

import threading
import time
from typing import List, Sequence, Tuple

import rospy

from roah_rsbb.msg import (
    ModuleScore,
    PublicBoard,
    PublicDetails,
    PublicEvent,
    PublicExplained,
    PublicExplanation,
    PublicRank,
    PublicResult,
    PublicRun,
    PublicSaid,
    PublicStanding,
    ZoneScoreGroup,
)

TOPIC, BOARD_TOPIC, EXPLAINED_TOPIC = "/core/public_details", "/core/public_board", "/core/public_explained"
BENCHMARKS = ("Getting to know my home", "Welcoming visitors", "Catering for Granny Annie's Comfort")
TEAMS = ("BrassButlers", "CopperKettle", "HomeAlone", "TeaAtFive")
PERIOD_S = 0.5
# The display must look the same at any time of day at which the tests run.
NOON = time.mktime((2026, 11, 21, 12, 0, 0, 0, 0, -1))


def stamp(utc_s: float) -> rospy.Time:
    """A ROS time."""
    return rospy.Time.from_sec(utc_s)


def event(number: int, now_s: float = NOON) -> PublicEvent:
    """An ordinary event of a competition; at `now_s` the first one begins."""
    return PublicEvent(
        f"Home {number + 1}", BENCHMARKS[number % 3], TEAMS[number % 4], 1 + number // 12, 1 + number % 3,
        stamp(now_s // 60 * 60 + 600 * number),
    )


class FakePublic:
    """Publishes what is in `runs`, `following` and `finished`, twice a second until `silent`."""

    def __init__(self, now_s: float = NOON, silent: bool = False) -> None:
        """The box's clock begins at `now_s`, UTC seconds."""
        self.lock = threading.RLock()  # held while it publishes; hold it for several changes that belong together
        self._ahead_of_mono_s = now_s - time.monotonic()
        self.box_uuid = "fake"
        self.results = "none"
        self.runs: List[PublicRun] = []
        self.following: List[PublicEvent] = []
        self.finished: List[PublicResult] = []
        self.said_utc_s = 0.0  # clock of the newest message
        self._silent = silent
        self.ahead_s = 0.0  # of the box's clock
        self._topic = rospy.Publisher(TOPIC, PublicDetails, queue_size=1, latch=True)
        self._board = rospy.Publisher(BOARD_TOPIC, PublicBoard, queue_size=1, latch=True)
        self._explained = rospy.Publisher(EXPLAINED_TOPIC, PublicExplained, queue_size=1, latch=True)
        self._timer = rospy.Timer(rospy.Duration(PERIOD_S), self._tick)

    def close(self) -> None:
        """End: the topic is gone."""
        self._timer.shutdown()
        self._topic.unregister()
        self._board.unregister()
        self._explained.unregister()

    @property
    def silent(self) -> bool:
        """Whether it publishes nothing by itself."""
        return self._silent

    @silent.setter
    def silent(self, silent: bool) -> None:
        with self.lock:  # after the last message
            self._silent = silent

    def _tick(self, _event: object) -> None:
        with self.lock:
            if not self._silent:
                self.publish()

    def now(self) -> float:
        """The box's clock, UTC seconds."""
        return time.monotonic() + self._ahead_of_mono_s + self.ahead_s

    def event(self, number: int) -> PublicEvent:
        """An event; the first one begins now."""
        return event(number, self.now())

    def publish(self) -> None:
        """Publish once."""
        with self.lock:
            clock = stamp(self.now())
            self.said_utc_s = clock.to_sec()
            self._topic.publish(PublicDetails(
                clock, self.box_uuid, self.results, list(self.runs), list(self.following), list(self.finished)))

    def publish_board(self, provisional: Sequence[PublicResult] = (), teams: Sequence[str] = TEAMS) -> None:
        """Publish the results of `finished` as signed off, others as provisional, and a standing of these teams."""
        standing = PublicStanding(BENCHMARKS[0], ["Achievements", "Distance error (less is better)"], [
            PublicRank(str(rank), team, [str(9 - rank), f"0.{rank} m"]) for rank, team in enumerate(teams, 1)])
        self._board.publish(PublicBoard(self.box_uuid, list(self.finished), list(provisional), [standing]))

    def publish_explained(self) -> None:
        """Publish what explains the first run."""
        said = [PublicSaid("", kind, text, stamp(self.now())) for kind, text in (
            ("notifications", "I have found a box that was moved"), ("final_command", "Bring the mug to the table"))]
        self._explained.publish(PublicExplained(self.box_uuid, [PublicExplanation(
            zone=self.event(0).zone, languages=["en"], kind="task", doing="executing", phases=["Explore", "Command"],
            phase=2, about=["The robot explores the home and reports what has changed since it last saw it. Then it "
                            "carries out a command."], said=said)]))

    def run(self, number: int = 0, phase: str = "running", left_s: float = 571.0, **fields: object) -> PublicRun:
        """A run in its own zone. Its clock counts while it runs."""
        counting = phase == "running"
        run = PublicRun(event=self.event(number), teams=[TEAMS[number % 4]], phase=phase, counting=counting)
        run.ends = stamp(self.now() + left_s if counting else 0.0)
        run.left = rospy.Duration.from_sec(left_s)
        for name, value in fields.items():
            setattr(run, name, value)
        return run

    def result(self, number: int = 0, end_reason: str = "completed", scores: bool = False) -> PublicResult:
        """A run that is over."""
        result = PublicResult(
            event=self.event(number), end_reason=end_reason, disconnected=stamp(self.now() - 300.0 * (number + 1))
        )
        if scores:
            result.scoring = [_group("Achievements", 3, 1), _group("Penalized behaviours", 2)]
            result.not_attempted = [0, 1]
            result.module_scores = [ModuleScore("", "reached", "4", "", "Waypoints reached")]
        return result


def _group(name: str, *values: int) -> ZoneScoreGroup:
    return ZoneScoreGroup(name, [1] * len(values), [f"item {i}" for i in range(len(values))], list(values))


def scene(fake: FakePublic, runs: int, scores: bool = True) -> Tuple[int, int]:
    """Publish a busy competition with this many runs. Returns the numbers of results and coming events."""
    with fake.lock:
        return _scene(fake, runs, scores)


def _scene(fake: FakePublic, runs: int, scores: bool) -> Tuple[int, int]:
    reasons = ("completed", "timeout", "stopped", "no_messages_saved", "module_failed")
    fake.runs = [fake.run(i, left_s=571.0 + i) for i in range(runs)]
    if runs > 1:
        fake.runs[1] = fake.run(1, "connected", left_s=600.0)
    if runs > 2:
        fake.runs[2] = fake.run(2, "ended", end_reason="completed")
    fake.following = [fake.event(runs + i) for i in range(12)]
    fake.results = "scores" if scores else "none"
    fake.finished = [fake.result(i, reasons[i % 5], scores=True) for i in range(5)] if scores else []
    return len(fake.finished), len(fake.following)
