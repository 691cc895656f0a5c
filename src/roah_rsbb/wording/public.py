"""The texts of the public pages (docs/public_display.md).

Times of day are those of the venue: the public compares them with the clock on the wall.
"""

import math
from typing import Dict, Iterable, NamedTuple, Tuple

from roah_rsbb.model.document import Document, PublicEvent, PublicResult, PublicRun, PublicStanding
from roah_rsbb.model.zone import ENDED, RUNNING
from roah_rsbb.wording import module_scores, sheets, times
from roah_rsbb.wording.clock import PAUSED
from roah_rsbb.wording.language import number, tr, tr_later
from roah_rsbb.wording.replay import MARK
from roah_rsbb.wording.said import tr_said

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


def cards(document: Document) -> Tuple[RunCard, ...]:
    """Return the texts of all runs. While the clock of a run counts, its largest text has the place `TIME` for the
    countdown. Those of a replay say so."""
    many_zones = _has_many_zones(document)
    found = tuple(_card(run, many_zones) for run in document.runs_shown())
    if not document.box.is_replay:
        return found
    return tuple(card._replace(word=f"{tr(MARK)} · {card.word}" if card.word else tr(MARK)) for card in found)


def following(document: Document, utc_s: float) -> Tuple[ListLine, ...]:
    """Return the texts of the next events."""
    many_zones = _has_many_zones(document)
    return tuple(_following(event, utc_s, many_zones) for event in document.public.following)


def result_lines(results: Iterable[PublicResult], utc_s: float) -> Tuple[ListLine, ...]:
    """Return the texts of results."""
    return tuple(_result(result, utc_s) for result in results)


def standings(document: Document) -> Tuple[StandingTexts, ...]:
    """Return the texts of all standings."""
    return tuple(map(_standing, document.public.standings))


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
        "referees": tr("Referees"), "referee_page": tr("Referee's page"), "box_page": tr("Whole box"),
        "data": tr("Data for programs"), "no_results": tr("No results are public yet"),
        "no_standings": tr("No standings are public yet"),
        "pair_page": tr("Pair this device"), "displays_page": tr("What each display shows"),
        "codes_page": tr("Codes of the teams"),
        "no_events": tr("No more events"), "not_in_schedule": tr("Nothing is known of this team"),
    }


def _has_many_zones(document: Document) -> bool:
    return len({*document.public_runs, *(event.zone for event in document.public.following)}) > 1


def _card(run: PublicRun, many_zones: bool) -> RunCard:
    event = run.event
    parts = ([event.zone] if many_zones else []) + [sheets.turn(event.round, event.run)]
    if event.team == ALL_TEAMS:
        parts.append(", ".join(run.teams))
    if run.activity:
        parts.append(tr_said(run.activity))
    big, word = TIME, tr("getting ready")
    if run.phase == RUNNING:
        big, word = (f"‖ {TIME}", tr(PAUSED)) if run.is_paused else (f"▶ {TIME}", tr("running"))
    elif run.phase == ENDED:
        big, word = tr("ended"), _end(run.end_reason)
    if not run.elapsed.counting:
        seconds = run.shown_s(0.0)
        big = big.replace(TIME, times.countdown(seconds if run.limit else math.floor(seconds)))
    return RunCard(run.phase, team_text(event.team), event.benchmark, " · ".join(parts), big, word, run.is_paused)


def _following(event: PublicEvent, utc_s: float, many_zones: bool) -> ListLine:
    zone = event.zone if many_zones else ""
    return ListLine(local_time(event.scheduled_utc_s, utc_s), team_text(event.team), event.benchmark, zone)


def _standing(standing: PublicStanding) -> StandingTexts:
    return StandingTexts(standing.benchmark, tuple(
        ListLine(rank.rank, rank.team, "", "", tuple(
            f"{criterion}: {number(found)}"
            for criterion, found in zip(standing.criteria, rank.numbers) if found
        ))
        for rank in standing.ranks
    ) + tuple(ListLine("", "", "", "", (f"* {tr_said(note)}",)) for note in standing.notes))


def _result(result: PublicResult, utc_s: float) -> ListLine:
    groups = [sheets.GroupOfValues(group.name, [item.value for item in group.items], group.not_attempted)
              for group in result.groups]
    sums = [sheets.sums_text([group]) for group in groups if group.values]
    if result.points is not None:
        sums = [sheets.points_text(*result.points)]
    lines = [module_scores.readable(score) for score in result.module_scores]
    return ListLine(
        local_time(result.disconnected_utc_s, utc_s), team_text(result.event.team), result.event.benchmark,
        _end(result.end_reason), (*(f"{line.name} {line.value}" for line in lines), *sums))


def team_text(team: str) -> str:
    """Return the name of a team; it may stand for all teams."""
    return tr("All teams") if team == ALL_TEAMS else team


def _end(end_reason: str) -> str:
    """How a run ended, with a mark."""
    if not end_reason:
        return ""
    return f"{'✓' if end_reason == 'completed' else '■'} {sheets.end_reason(end_reason)}"


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
    return times.formatted(utc_s, pattern, in_utc=False)
