"""The texts of the public display, made from PublicDetails (docs/public_display.md, "For programs").

The functions work on anything with the fields of PublicDetails; ROS is not imported. Times of day are local times of
the computer that makes the texts: the public compares them with the clock on the wall.
"""

import math
import time
from typing import Any, Dict, Iterable, List, NamedTuple, Tuple

from roah_rsbb.wording import module_scores, sheets, times
from roah_rsbb.wording.clock import PAUSED
from roah_rsbb.wording.language import tr, tr_later
from roah_rsbb.wording.replay import MARK, is_replay

ALL_TEAMS = "ALL"
WAITING = tr_later("Waiting for the referee box")
NOTHING_RUNS = tr_later("Nothing is running at the moment")
SCHEDULE_IS_DONE = tr_later("The schedule is done")
NO_SIGNAL = tr_later("No signal since {time}: this is the last known state")
RUNS = tr_later("Runs")
NEXT = tr_later("Next")
RESULTS = tr_later("Results")
PROVISIONAL = tr_later("Provisional results")
# In a run's largest text, the place of the countdown.
TIME = "{time}"
DAYS = (
    tr_later("Monday"), tr_later("Tuesday"), tr_later("Wednesday"), tr_later("Thursday"), tr_later("Friday"),
    tr_later("Saturday"), tr_later("Sunday"),
)
MONTHS = (
    tr_later("January"), tr_later("February"), tr_later("March"), tr_later("April"), tr_later("May"), tr_later("June"),
    tr_later("July"), tr_later("August"), tr_later("September"), tr_later("October"), tr_later("November"),
    tr_later("December"),
)


class RunCard(NamedTuple):
    """The texts of a run."""

    phase: str  # connected, running or ended
    team: str
    benchmark: str
    place: str  # zone, round and run, teams
    big: str  # the largest text: the countdown
    word: str  # the state of the run; colour is never the only sign
    is_paused: bool = False


class ListLine(NamedTuple):
    """The texts of a coming event, of a result, or of a team in a standing."""

    time: str  # or the rank
    team: str
    benchmark: str
    last: str  # an event's zone, or how the run of a result ended
    scores: Tuple[str, ...] = ()  # below the other texts


class StandingTexts(NamedTuple):
    """The texts of a benchmark's standing."""

    title: str
    lines: Tuple[ListLine, ...]


def cards(details: Any) -> Tuple[RunCard, ...]:
    """Return the texts of all runs. Their largest text has the place `TIME` for the countdown. Those of a replay say
    so."""
    many_zones = _has_many_zones(details)
    found = tuple(_card(run, many_zones) for run in details.runs)
    if not is_replay(details.box_uuid):
        return found
    return tuple(card._replace(word=f"{tr(MARK)} · {card.word}" if card.word else tr(MARK)) for card in found)


def still(card: RunCard, run: Any, clock_s: float) -> str:
    """Return the largest text of a run. If its clock runs, the text has the place `TIME` for the countdown."""
    return card.big if run.counting else _at(card, run, clock_s, clock_s)


def _at(card: RunCard, run: Any, utc_s: float, clock_s: float) -> str:
    return card.big.replace(TIME, times.countdown(_shown_s(run, utc_s, clock_s)))


def following(details: Any, utc_s: float) -> Tuple[ListLine, ...]:
    """Return the texts of the next events."""
    many_zones = _has_many_zones(details)
    return tuple(_following(event, utc_s, many_zones) for event in details.following)


def result_lines(results: Iterable[Any], utc_s: float) -> Tuple[ListLine, ...]:
    """Return the texts of results."""
    return tuple(_result(result, utc_s) for result in results)


def standings(board: Any) -> Tuple[StandingTexts, ...]:
    """Return the texts of all standings."""
    return tuple(_standing(standing) for standing in board.standings)


def standing_title(title: str) -> str:
    """Return the title above the standing of a benchmark."""
    return tr("Standing: {benchmark}", benchmark=title)


def page_words() -> Dict[str, str]:
    """Return the fixed texts of the pages in browsers, by the names that the pages use."""
    return {
        "waiting": tr(WAITING), "nothing_runs": tr(NOTHING_RUNS), "schedule_is_done": tr(SCHEDULE_IS_DONE),
        "no_signal": tr(NO_SIGNAL, time=TIME), "runs": tr(RUNS), "next": tr(NEXT), "results": tr(RESULTS),
        "provisional": tr(PROVISIONAL), "display": tr("Public display"), "overlay": tr("Overlay for video"),
        "all_zones": tr("all zones"), "teams": tr("Teams"), "standings": tr("Standings"),
        "referees": tr("Referees"), "referee_page": tr("Referee's page"),
        "data": tr("Data for programs"), "no_results": tr("No results are public yet"),
        "no_standings": tr("No standings are public yet"),
        "pair_page": tr("Pair this device"), "displays_page": tr("What each display shows"),
        "codes_page": tr("Codes of the teams"),
        "no_events": tr("No more events"), "not_in_schedule": tr("Nothing is known of this team"),
    }


def _has_many_zones(details: Any) -> bool:
    return len({event.zone for event in _events(details)}) > 1


def _events(details: Any) -> List[Any]:
    return [run.event for run in details.runs] + list(details.following)


def _shown_s(run: Any, utc_s: float, clock_s: float) -> float:
    """Return the seconds that are left or, without a limit, counted. `clock_s`: the time of the message."""
    if run.unlimited:
        elapsed_s: float = run.elapsed.to_sec()
        return math.floor(elapsed_s + (max(0.0, utc_s - clock_s) if run.counting else 0.0))
    left_s: float = run.ends.to_sec() - utc_s if run.counting else run.left.to_sec()
    return left_s


def _card(run: Any, many_zones: bool) -> RunCard:
    event = run.event
    parts = ([event.zone] if many_zones else []) + [sheets.turn(event.round, event.run)]
    if event.team == ALL_TEAMS:
        parts.append(", ".join(run.teams))
    if run.activity:
        parts.append(run.activity)
    big, word = TIME, tr("getting ready")
    if run.phase == "running":
        big, word = (f"▶ {TIME}", tr("running")) if run.counting else (f"‖ {TIME}", tr(PAUSED))
    elif run.phase == "ended":
        big, word = tr("ended"), _end(run.end_reason)
    return RunCard(run.phase, team_text(event.team), event.benchmark, " · ".join(parts), big, word,
                   is_paused=run.phase == "running" and not run.counting)


def _following(event: Any, utc_s: float, many_zones: bool) -> ListLine:
    zone = event.zone if many_zones else ""
    return ListLine(_when(event.scheduled, utc_s), team_text(event.team), event.benchmark, zone)


def _standing(standing: Any) -> StandingTexts:
    return StandingTexts(standing.benchmark, tuple(
        ListLine(rank.rank, rank.team, "", "", tuple(
            f"{criterion}: {number}" if number else criterion
            for criterion, number in zip(standing.criteria, rank.numbers) if number
        ))
        for rank in standing.ranks
    ))


def _result(result: Any, utc_s: float) -> ListLine:
    event = result.event
    groups = [
        sheets.GroupOfValues(group.group_name, group.current_values, not_attempted)
        for group, not_attempted in zip(result.scoring, result.not_attempted)
    ]
    sums = [sheets.sums_text([group]) for group in groups if group.values]
    if result.points.total:
        points = [(group.name, group.points) for group in result.points.groups]
        sums = [sheets.points_text(result.points.total, points)]
    lines = [module_scores.readable(score) for score in result.module_scores]
    return ListLine(
        _when(result.disconnected, utc_s), team_text(event.team), event.benchmark,
        _end(result.end_reason),
        (*(f"{line.name} {line.value}" for line in lines), *sums),
    )


def team_text(team: str) -> str:
    """Return the name of a team; it may stand for all teams."""
    return tr("All teams") if team == ALL_TEAMS else team


def _end(end_reason: str) -> str:
    """How a run ended, with a mark."""
    if not end_reason:
        return ""
    return f"{'✓' if end_reason == 'completed' else '■'} {sheets.end_reason(end_reason)}"


def _when(moment: Any, utc_s: float) -> str:
    return local_time(moment.to_sec(), utc_s)


def local_time(utc_s: float, now_utc_s: float) -> str:
    """Return a time of today, or a date and time."""
    pattern = "%Y-%m-%d %H:%M:%S"
    return times.short_time(_local(pattern, utc_s), _local(pattern, now_utc_s))


def date(utc_s: float) -> str:
    """Return a local date, such as "Thursday, 3 December 2026"."""
    numbers = _local("%u %d %m %Y", utc_s).split()
    if len(numbers) < 4:
        return "?"
    weekday, day, month, year = map(int, numbers)
    return tr("{weekday}, {day} {month} {year}",
              weekday=tr(DAYS[weekday - 1]), day=day, month=tr(MONTHS[month - 1]), year=year)


def _local(pattern: str, utc_s: float) -> str:
    try:
        return time.strftime(pattern, time.localtime(utc_s))
    except (OverflowError, OSError, ValueError):  # a clock that is far off must not stop the display
        return "?"
