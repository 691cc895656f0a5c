"""A busy competition as the public sees it: the public sections of a box's document."""

from typing import Any, Dict

from roah_rsbb.model.document import (
    Public,
    PublicEvent,
    PublicGroup,
    PublicItem,
    PublicRank,
    PublicResult,
    PublicRun,
    PublicStanding,
    RobotText,
)
from roah_rsbb.model.records import ScoreValue
from roah_rsbb.model.zone import Count

BENCHMARKS = ("Getting to know my home", "Welcoming visitors", "Catering for Granny Annie's Comfort")
TEAMS = ("BrassButlers", "CopperKettle", "HomeAlone", "TeaAtFive")
REASONS = ("completed", "timeout", "stopped", "no_messages_saved", "module_failed")
LIMIT_S = 600.0


def _event(number: int, utc_s: float) -> PublicEvent:
    return PublicEvent(f"Home {number + 1}", BENCHMARKS[number % 3], TEAMS[number % 4], 1 + number // 12,
                       1 + number % 3, utc_s // 60 * 60 + 600 * number)


def _run(number: int, utc_s: float, **fields: Any) -> PublicRun:
    return PublicRun(_event(number, utc_s), (TEAMS[number],), kind="task", limit=LIMIT_S, **fields)


def _result(number: int, utc_s: float) -> PublicResult:
    groups = (("Achievements", (3, 1), 0), ("Penalized behaviours", (2,), 1))
    return PublicResult(
        _event(number, utc_s), REASONS[number % 5], utc_s - 300.0 * (number + 1), True,
        tuple(PublicGroup(name, tuple(PublicItem("item", "count", value) for value in values), not_attempted)
              for name, values, not_attempted in groups), (ScoreValue("", "reached", "4", "", "Waypoints reached"),))


def scene(utc_s: float, mono: float) -> Dict[str, Any]:
    """Return the sections: three runs, of which the first counts from `mono` on, results, and a standing."""
    runs = (
        _run(0, utc_s, phase="running", doing="executing", elapsed=Count(29.0, mono), phases=("Explore", "Command"),
             phase_number=2,
             about={"en": "The robot explores the home and reports what has changed since it last saw it. Then it "
                          "carries out a command."},
             said=(RobotText("", "notifications", "I have found a box that was moved", utc_s),
                   RobotText("", "final_command", "Bring the mug to the table", utc_s))),
        _run(1, utc_s, phase="connected", doing="waiting"),
        _run(2, utc_s, phase="ended", doing="ended", end_reason="completed", elapsed=Count(312.0)))
    ranks = tuple(PublicRank(str(rank), team, (str(9 - rank), f"0.{rank} m")) for rank, team in enumerate(TEAMS, 1))
    standing = PublicStanding(BENCHMARKS[0], ("Achievements", "Distance error (less is better)"), ranks)
    return {
        "public": Public("scores", tuple(_event(number, utc_s) for number in range(3, 15)), (standing,)),
        "public_runs": {run.event.zone: run for run in runs},
        "public_results": {str(number): _result(number, utc_s) for number in range(5)},
    }
