"""The texts of the public pages (docs/public_display.md), and of those of teams (docs/web.md, "Pages of teams").

Times of day are those of the venue: the public compares them with the clock on the wall.
"""

import math
from typing import Dict, Iterable, List, NamedTuple, Optional, Tuple

from roah_rsbb.model.clock import Now
from roah_rsbb.model.document import (
    Document,
    PublicEvent,
    PublicRank,
    PublicResult,
    PublicRun,
    PublicStanding,
    RobotSeen,
    RobotText,
)
from roah_rsbb.model.reason import Reason
from roah_rsbb.model.zone import ENDED, IDLE, RUNNING, ZoneSeen
from roah_rsbb.wording import sheets, times
from roah_rsbb.wording.language import number, tr, tr_later, tr_said, tr_words
from roah_rsbb.wording.times import PAUSED
from roah_rsbb.wording.whole_box import REPLAY

ALL_TEAMS = "ALL"
WAITING = tr_later("Waiting for the referee box")
NO_ANSWER = tr_later("The box does not answer yet. This page continues by itself.")
NO_SCRIPT = tr_later("This page needs JavaScript: allow it in the browser's settings.")
NO_PAGE = tr_later("There is no such page")
FIRST_PAGE = tr_later("All pages of this box")
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

    look: str  # its colour and icon: see `sheets.look`
    team: str
    benchmark: str
    place: str  # zone, round and run, teams
    big: str  # the largest text: the countdown
    word: str  # the state in words; colour is never the only sign
    is_paused: bool = False


class ListLine(NamedTuple):
    """The texts of a coming event or of a result."""

    time: str
    team: str
    benchmark: str
    last: str  # an event's zone, or how the run of a result ended
    scores: Tuple[Tuple[str, str], ...] = ()  # names and values, below the other texts
    planned: str = ""  # the scheduled time of an event that is late
    look: str = ""  # of a result: see `sheets.look`
    points: str = ""  # of a result; empty: it has none, or they are not public
    rank: str = ""  # of its team in the standing of its benchmark, with it


class NoteText(NamedTuple):
    """What a reader must know of a standing."""

    note: str
    team: str  # of which it is; empty: of all


class StandingTexts(NamedTuple):
    """The texts of a benchmark's standing."""

    title: str
    criteria: Tuple[str, ...]
    ranks: Tuple[PublicRank, ...]
    notes: Tuple[NoteText, ...]


def cards(document: Document) -> Tuple[RunCard, ...]:
    """Return the texts of all runs. While the clock of a run counts, its largest text has the place `TIME` for the
    countdown. Those of a replay say so."""
    many_zones = _has_many_zones(document)
    found = tuple(_card(run, many_zones) for run in document.runs_shown())
    if not document.box.is_replay:
        return found
    return tuple(card._replace(word=f"{tr(REPLAY)} · {card.word}" if card.word else tr(REPLAY)) for card in found)


def following(document: Document, utc_s: float) -> Tuple[ListLine, ...]:
    """Return the texts of the next events."""
    many_zones = _has_many_zones(document)
    return tuple(_following(event, utc_s, many_zones) for event in document.public.following)


def result_lines(results: Iterable[PublicResult], utc_s: float,
                 standings: Iterable[PublicStanding] = ()) -> Tuple[ListLine, ...]:
    """Return the texts of results."""
    ranks = {(standing.benchmark, rank.team): rank.rank for standing in standings for rank in standing.ranks}
    return tuple(_result(result, utc_s, ranks.get((result.event.benchmark, result.event.team), ""))
                 for result in results)


def standings(document: Document) -> Tuple[StandingTexts, ...]:
    """Return the texts of all standings."""
    return tuple(map(_standing, document.public.standings))


def standing_title(title: str) -> str:
    """Return the title above the standing of a benchmark."""
    return tr("Standing: {benchmark}", benchmark=title)


def page_words() -> Dict[str, str]:
    """Return the fixed texts of the pages in browsers, by the names that the pages use."""
    return tr_words(
        waiting=WAITING, nothing_runs=NOTHING_RUNS, schedule_is_done=SCHEDULE_IS_DONE, no_signal=NO_SIGNAL, runs=RUNS,
        next=NEXT, results=RESULTS, provisional=PROVISIONAL, display="Public display", overlay="Overlay for video",
        all_zones="all zones", teams="Teams", standings="Standings", data="Data for programs",
        no_results="No results are public yet", no_standings="No standings are public yet",
        pair_page="Pair this device", displays_page="What each display shows", codes_page="Codes of the teams",
        no_events="No more events", all_events="All {number} events", not_in_schedule="Nothing is known of this team",
        late="{time} instead of {planned}", points="Points", rank="Rank", rank_is="Rank {rank}", team="Team",
        zones_here="Each zone will have a line here with its team, its state and its clock.",
        teams_here="The teams will be listed here as soon as the box has a schedule.",
        watch="Watch", watch_how="Clocks, results and standings as they happen.",
        watch_now="Runs in progress: {number}",
        referee="Referee", referee_how="Start and stop runs, mark the score sheet, sign it off.",
        referee_now="Needs a code of the organiser",
        team_how="See your robot's link, your times and your results.", team_now="Teams: {number}",
        organise="Organise", organise_how="Schedule, zones, results, devices and displays.",
        organise_now="Events to come: {number}", more="More pages",
    )


def _has_many_zones(document: Document) -> bool:
    return len({*document.public_runs, *(event.zone for event in document.public.following)}) > 1


def _card(run: PublicRun, many_zones: bool) -> RunCard:
    event = run.event
    parts = ([event.zone] if many_zones else []) + [sheets.turn(event.round, event.run)]
    if event.team == ALL_TEAMS:
        parts.append(", ".join(run.teams))
    if run.activity:
        parts.append(tr_said(run.activity))
    big, word = TIME, tr("ready")
    if run.phase == RUNNING:
        word = tr(PAUSED) if run.is_paused else tr("running")
    elif run.phase == ENDED:
        word = sheets.end_reason(run.end_reason) if run.end_reason else tr("ended")
    if not run.elapsed.counting:
        seconds = run.shown_s(0.0)
        big = times.countdown(seconds if run.limit else math.floor(seconds))
    return RunCard(sheets.look(run.phase, run.end_reason), team_text(event.team), event.benchmark, " · ".join(parts),
                   big, word, run.is_paused)


def _following(event: PublicEvent, utc_s: float, many_zones: bool) -> ListLine:
    planned, begins = (local_time(moment_s, utc_s) for moment_s in (
        event.scheduled_utc_s, max(event.scheduled_utc_s, event.begins_utc_s)))
    return ListLine(
        begins, team_text(event.team), event.benchmark, event.zone if many_zones else "",
        planned="" if begins == planned else planned)


def _standing(standing: PublicStanding) -> StandingTexts:
    return StandingTexts(
        standing.benchmark, standing.criteria,
        tuple(rank._replace(numbers=tuple(map(number, rank.numbers))) for rank in standing.ranks),
        tuple(NoteText(tr_said(note), str(note.values.get("team", "")) if isinstance(note, Reason) else "")
              for note in standing.notes))


def _result(result: PublicResult, utc_s: float, rank: str) -> ListLine:
    groups = [sheets.GroupOfValues(group.name, [item.value for item in group.items], group.not_attempted)
              for group in result.groups]
    sums = [(group.name, sheets.sum_text(group)) for group in groups if group.values]
    if result.points is not None:
        sums = [(tr_said(name), number(points)) for name, points in sheets.groups_shown(result.points)]
        if result.points.for_team:
            sums.append((tr("For the team"), number(result.points.for_team)))
    lines = [sheets.score_line(score) for score in result.module_scores]
    return ListLine(
        local_time(result.disconnected_utc_s, utc_s), team_text(result.event.team), result.event.benchmark,
        sheets.end_reason(result.end_reason), (*((line.name, line.value) for line in lines), *sums),
        look=sheets.look(ENDED, result.end_reason),
        points="" if result.points is None else number(result.points.total), rank=rank)


def team_text(team: str) -> str:
    """Return the name of a team; it may stand for all teams."""
    return tr("All teams") if team == ALL_TEAMS else team


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


# -- a run, explained to spectators (docs/web.md, "Displays") --------------------------------------

DONE, NOW, LATER = "done", "now", "later"
_ENGLISH = "en"
_PREPARES, _EXECUTES = tr_later("The robot prepares"), tr_later("The robot carries out its task")
_REFEREE = tr_later("The referee is at work")
_GOAL, _WAYPOINT = tr_later("The robot carries out the goal"), tr_later("The robot drives to the waypoint")
_ORDER = {"waiting": 0, "referee": 1, "between": 1, "preparing": 2, "executing": 3, "ended": 4}
_SAID = {
    "notifications": tr_later("Robot: {words}"), "activation_event": tr_later("Event: {words}"),
    "visitor": tr_later("Visitor: {words}"), "final_command": tr_later("Command: {words}"),
}


class ShownStep(NamedTuple):
    """A step of a run."""

    text: str
    state: str  # done, now or later


class ExplainedTexts(NamedTuple):
    """The texts of a run."""

    about: str  # may be empty
    steps: Tuple[ShownStep, ...]
    now: str  # one sentence
    progress: str  # may be empty
    said: Tuple[str, ...]  # the newest last


def explained(run: PublicRun, language: str) -> ExplainedTexts:
    """Return the texts of a run."""
    return ExplainedTexts(
        _about(run, language), tuple(_steps(run)), _now(run), _progress(run), tuple(map(_said, run.said)))


def _about(run: PublicRun, language: str) -> str:
    """The text in a language. If that is missing, the English one, or else the first one."""
    for name in (language, language.partition("_")[0], _ENGLISH):
        if name in run.about:
            return run.about[name]
    return next(iter(run.about.values()), "")


def _steps(run: PublicRun) -> List[ShownStep]:
    """The phases of a task or, without them, what happens in every run. Goals repeat, so their
    steps are never done while the run continues."""
    if run.phases:
        is_over = run.doing == "ended"
        present = run.phase_number
        return [ShownStep(name, DONE if is_over or number < present else NOW if number == present else LATER)
                for number, name in enumerate(run.phases, 1)]
    if run.doing == "by_hand":
        return []
    now = _ORDER[run.doing]
    if run.kind == "functionality":
        texts = [(1, _REFEREE), (2, _PREPARES), (3, _WAYPOINT if run.are_waypoints else _GOAL)]
        return [ShownStep(tr(text), DONE if now == _ORDER["ended"] else NOW if number == now else LATER)
                for number, text in texts]
    return [ShownStep(tr(text), DONE if number < now else NOW if number == now else LATER)
            for number, text in ((2, _PREPARES), (3, _EXECUTES))]


def _now(run: PublicRun) -> str:
    if run.doing == "executing" and run.kind == "functionality":
        if run.are_waypoints:
            return tr("The robot drives to waypoint {number}", number=run.goals)
        return tr("The robot carries out goal {number}", number=run.goals)
    if run.doing == "executing" and run.kind == "all robots":
        return tr("All robots carry out the task at the same time")
    return {
        "waiting": tr("The robot waits for the start"), "preparing": tr(_PREPARES), "executing": tr(_EXECUTES),
        "referee": tr(_REFEREE), "between": tr("The next goal follows"),
        "by_hand": tr("The referee starts and stops the clock"), "ended": tr("The run is over"),
    }[run.doing]


def _progress(run: PublicRun) -> str:
    if not run.goals_ended:
        return ""
    if run.goals_completed is None:
        return tr("Waypoints done: {number}", number=run.goals_ended) if run.are_waypoints else tr(
            "Goals done: {number}", number=run.goals_ended)
    if run.are_waypoints:
        return tr("Waypoints reached: {number} of {all}", number=run.goals_completed, all=run.goals_ended)
    return tr("Goals completed: {number} of {all}", number=run.goals_completed, all=run.goals_ended)


def _said(one: RobotText) -> str:
    text = tr(_SAID.get(one.kind, _SAID["notifications"]), words=one.text)
    return f"{one.robot}: {text}" if one.robot else text


# -- what a team may know of its own robot ---------------------------------------------------------

_NOT_BEGUN = ("next", "later")


def team_facts(team: str, document: Document, now: Now) -> List[str]:
    """Return what the box knows of a team's robots, of the zones whose event is the team's, and of its next event.
    `now`: on the box's clocks."""
    robots = [robot for robot in document.robots.values() if robot.team == team]
    lines = [line for robot in robots for line in _robot(robot, now)] or [tr("The box does not hear the robot")]
    zones = [document.zones[name] for name in document.box.zones if name in document.zones]
    lines += [_zone(zone, now) for zone in zones if zone.event.team in (team, ALL_TEAMS)]
    following = [event for event in document.events() if event.team in (team, ALL_TEAMS) and event.state in _NOT_BEGUN]
    if following:
        event = min(following, key=lambda one: one.begins_utc_s)
        lines.append(tr("Next event: {benchmark} in zone {zone}, about {time}", benchmark=event.benchmark,
                        zone=event.zone, time=local_time(event.begins_utc_s, now.utc)))
    return lines


def _robot(robot: RobotSeen, now: Now) -> List[str]:
    heard = tr("The box hears {robot}, last {seconds} s ago", robot=robot.robot,
               seconds=_seconds(robot.silent_since, now))
    seconds = f"{abs(robot.skew):.2f}"
    text = tr("Its clock is {seconds} s ahead of the box", seconds=seconds) if robot.skew >= 0.0 else tr(
        "Its clock is {seconds} s behind the box", seconds=seconds)
    return [heard, text]


def _zone(zone: ZoneSeen, now: Now) -> str:
    if zone.phase == IDLE:
        reasons = "; ".join(tr_said(reason) for reason in zone.off("connect"))
        if reasons:
            return tr("In zone {zone}, connect is off: {reasons}", zone=zone.zone, reasons=reasons)
        return tr("In zone {zone}, the robot can be connected now", zone=zone.zone)
    robot = zone.robot
    if robot is None or not robot.heard:
        return tr("In zone {zone}, the robot is connected. No message of it has come yet", zone=zone.zone)
    return tr("In zone {zone}, the robot is connected. Its state: {state}. Last message {seconds} s ago",
              zone=zone.zone, state=robot.robot_state, seconds=_seconds(robot.silent_since, now))


def _seconds(silent_since: Optional[float], now: Now) -> str:
    """Return the seconds of a silence in words; None: there is none."""
    return f"{max(0.0, now.mono - silent_since):.0f}" if silent_since is not None else tr("less than 2")
