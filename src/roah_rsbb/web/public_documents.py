"""The documents for everybody, made from what the public may see of the box (docs/web.md, "Data"), and nothing else. No
I/O and no clock.

Times are UTC seconds since 1970 of the box's clock.
"""
import html
from typing import (
    Any,
    ContextManager,
    Dict,
    Iterable,
    List,
    Optional,
    Set,
    Tuple,
)

from roah_rsbb.model.document import Document, PublicEvent, PublicResult, PublicRun
from roah_rsbb.web.numbered import BoxShown, Key, Numbered
from roah_rsbb.wording import device, public, times
from roah_rsbb.wording.language import ENGLISH, Translate, chosen, in_language, tr
from roah_rsbb.wording.public import ALL_TEAMS
from roah_rsbb.wording.public import explained as explained_texts
from roah_rsbb.wording.whole_box import REPLAY_NOT_LIVE

Data = Dict[str, Any]

STATE, SCHEDULE, RESULTS, STANDINGS, EXPLAINED = DATA = ("state", "schedule", "results", "standings", "explained")
# The texts of our pages, in the language of the reader.
WORDS, DEVICE_WORDS, PAGE_RUNS, PAGE_NEXT, PAGE_RESULTS, PAGE_STANDINGS, PAGE_EXPLAINED = TEXTS = (
    "page.words", "page.device_words", "page.runs", "page.next", "page.results", "page.standings", "page.explained",
)
FIXED_TEXTS = (WORDS, DEVICE_WORDS)  # these need no message of the core
DISPLAY = "page.display"  # what the organiser has set for a display: for this one only


# -- data -------------------------------------------------------------------------------------------


def state(document: Document, ahead_s: float) -> Data:
    """Return the runs of all zones. `ahead_s`: of the box's UTC to its monotonic clock."""
    return {
        "box": document.box.uuid,
        "public_results": document.public.results,
        "runs": [_run(run, ahead_s) for run in document.runs_shown()],
    }


def schedule(document: Document) -> Data:
    """Return the coming events, the soonest first."""
    return {"events": [_event(event) for event in document.public.following]}


def results(document: Document) -> Data:
    """Return the results that the public may see, the newest first."""
    return {
        "results": [_result(result) for result in document.results_shown(signed=True)],
        "provisional": [_result(result) for result in document.results_shown(signed=False)],
    }


def standings(document: Document) -> Data:
    """Return the standing of each benchmark."""
    return {"standings": [
        {
            "benchmark": standing.benchmark, "criteria": list(standing.criteria),
            "ranks": [{"rank": rank.rank, "team": rank.team, "numbers": list(rank.numbers)} for rank in standing.ranks],
            "notes": list(standing.notes),
        }
        for standing in document.public.standings
    ]}


def explained(document: Document) -> Data:
    """Return the runs explained."""
    return {"runs": [
        {
            "zone": run.event.zone, "about": run.about, "kind": run.kind, "doing": run.doing,
            "phases": list(run.phases), "phase": run.phase_number, "waypoints": run.are_waypoints, "goals": run.goals,
            "goals_ended": run.goals_ended, "goals_completed": run.goals_completed,
            "said": [{"robot": one.robot, "kind": one.kind, "text": one.text, "received": _time(one.utc_s)}
                     for one in run.said],
        }
        for run in document.runs_shown()
    ]}


def _event(event: PublicEvent) -> Data:
    return {
        "zone": event.zone, "benchmark": event.benchmark, "team": event.team, "round": event.round, "run": event.run,
        "scheduled": _time(event.scheduled_utc_s),
    }


def _run(run: PublicRun, ahead_s: float) -> Data:
    """A run. While its clock runs, only the time from or to which it counts is given: so it changes rarely."""
    since, seconds = run.elapsed.since, run.elapsed.seconds
    counts, has_limit = since is not None, run.limit > 0.0
    began = ahead_s + (since or 0.0) - seconds  # without pauses
    return {
        **_event(run.event),
        "teams": list(run.teams),
        "phase": run.phase,
        "end_reason": run.end_reason,
        "activity": run.activity,
        "counting": counts,
        "unlimited": not has_limit,
        "ends": _time(began + run.limit) if counts and has_limit else None,
        "counts_from": _time(began) if counts and not has_limit else None,
        "left_s": _time(run.limit - seconds) if has_limit and not counts else None,
        "elapsed_s": _time(seconds) if not has_limit and not counts else None,
    }


def _result(result: PublicResult) -> Data:
    return {
        **_event(result.event),
        "end_reason": result.end_reason,
        "disconnected": _time(result.disconnected_utc_s),
        "groups": [
            {
                "name": group.name, "not_attempted": group.not_attempted,
                "items": [item._asdict() for item in group.items],
            }
            for group in result.groups
        ],
        "module_scores": [
            {"name": score.name, "value": score.value, "unit": score.unit, "description": score.desc}
            for score in result.module_scores
        ],
        "points": None if result.points is None else {
            "total": result.points.total,
            "groups": [{"name": group.name, "points": group.points} for group in result.points.groups],
            "for_team": result.points.for_team or "0",
        },
    }


def _time(seconds: float) -> float:
    return round(seconds, 3)


# -- texts of pages ---------------------------------------------------------------------------------


def page_words(language: str, title: str, utc_s: Optional[float], utc_offset_s: int) -> Data:
    """Return the fixed texts of all pages. `title`: of the competition; `utc_s`: the box's clock; None: not known."""
    return {
        "language": language, "title": title, "date": "" if utc_s is None else public.date(utc_s),
        "utc_offset_s": utc_offset_s,
        **public.page_words(),
    }


def page_runs(document: Document, ahead_s: float) -> Data:
    """Return the texts of all runs with the times that the page counts itself, and the mark of a replay. `ahead_s`: see
    `state`."""
    return {"replay": tr(REPLAY_NOT_LIVE) if document.box.is_replay else "", "runs": [
        {**card._asdict(), **{name: _run(run, ahead_s)[name] for name in (
            "zone", "teams", "ends", "counts_from", "left_s")}, "limit": run.limit}
        for card, run in zip(public.cards(document), document.runs_shown())
    ]}


def page_next(document: Document, utc_s: float) -> Data:
    """Return the texts of the coming events."""
    return {"lines": _lines(public.following(document, utc_s), document.public.following)}


def page_results(document: Document, utc_s: float) -> Data:
    """Return the texts of the results."""
    found = {"results": document.results_shown(signed=True), "provisional": document.results_shown(signed=False)}
    return {name: _lines(public.result_lines(results, utc_s, document.public.standings),
                         [result.event for result in results])
            for name, results in found.items()}


def page_standings(document: Document) -> Data:
    """Return the texts of the standings."""
    return {"standings": [
        {**one._asdict(), "title": public.standing_title(one.title), "ranks": [rank._asdict() for rank in one.ranks],
         "notes": [note._asdict() for note in one.notes]}
        for one in public.standings(document)
    ]}


def page_explained(document: Document, language: str) -> Data:
    """Return the texts that explain the runs."""
    return {"runs": [
        {"zone": run.event.zone, **texts._asdict(), "steps": [step._asdict() for step in texts.steps]}
        for run in document.runs_shown()
        for texts in [explained_texts(run, language)]
    ]}


def _lines(lines: Iterable[public.ListLine], events: Iterable[PublicEvent]) -> List[Data]:
    """The texts of lines with the zone and the team by which a page chooses them, and which run it is."""
    return [{**line._asdict(), "zone": event.zone, "of_team": event.team,
             "key": f"{event.zone}/{event.scheduled_utc_s:.0f}/{event.team}/{event.round}/{event.run}"}
            for line, event in zip(lines, events)]


# UTC slews. While the times of runs differ by less, they are the same.
SAME_TIME_S = 0.05
Day = Tuple[str, int]
_NO_DAY = ("", 0)


class Store(Numbered):
    """The documents of the gateway."""

    def __init__(self, box: BoxShown, languages: Dict[str, Translate], title: str = "",
                 logos: Optional[Dict[str, str]] = None) -> None:
        """`languages`: those besides English, by name such as ``de``. `title`: of the competition.

        `logos`: paths of the teams' logos, by team.
        """
        super().__init__(box)
        self._languages: Dict[str, Optional[Translate]] = {ENGLISH: None, **languages}
        self._title = title
        self.logos = logos or {}
        self._shown: Set[str] = set()  # languages that somebody has asked for
        self._ahead_s = 0.0  # of the box's UTC to its monotonic clock

    def look(self) -> bool:
        """Make documents again: the box, or only its clocks, may have changed. Returns whether any has changed."""
        before, document = self.changes, self.box.document
        if document is None or self.is_heard:
            self._look(document)
        return self.changes != before

    def teams(self) -> List[str]:
        """Return all teams that are known, in alphabetical order."""
        document = self.box.document
        if document is None:
            return []
        teams = {team for run in document.public_runs.values() for team in run.teams}
        teams.update(event.team for event in document.public.following)
        teams.update(event.team for event in document.schedule.values())
        teams.update(result.event.team for result in document.public_results.values())
        teams.update(rank.team for standing in document.public.standings for rank in standing.ranks)
        return sorted(teams - {ALL_TEAMS})

    # -- for readers ----------------------------------------------------------------------------------

    def language(self, wanted: str) -> str:
        """Return the first language that is wanted and available, else English. `wanted`: such as ``fr,de-AT``."""
        return chosen(wanted, self._languages)

    def speaking(self, language: str) -> ContextManager[None]:
        """Translate texts to one of the known languages in a `with` block."""
        return in_language(self._languages[language])

    def keys(self, names: Iterable[str], language: str) -> List[Key]:
        """Return the keys of documents. Texts in a language are made from the first time that it is asked for."""
        keys = [(name, language if name in TEXTS else "") for name in names]
        if language not in self._shown and any(name in TEXTS for name, _ in keys):
            self._shown.add(language)
            self._look(self.box.document)
        return keys

    def first_frame(self) -> str:
        """Return what a page shows until its script has heard the box, as HTML in the language of the moment."""
        document = self.box.document
        runs = () if document is None else public.cards(document)
        lines = [f'<div class="zone band {run.look}"><div class="who"><b class="team">{html.escape(run.team)}</b> '
                 f'<p>{html.escape(run.benchmark)}</p></div><b class="when">{html.escape(run.word)}</b></div>'
                 for run in runs]
        return (f'<div class="first"><p class="title">{html.escape(self._title)}</p>'
                f'<div class="zones">{"".join(lines)}</div>'
                f'<p class="waiting">{tr(public.WAITING)}</p><p class="late">{tr(public.NO_ANSWER)}</p></div>')

    def put_display(self, display_id: str, data: Data) -> None:
        """Make the document with what the organiser has set for a display."""
        self._put((DISPLAY, display_id), data)

    def drop_display(self, display_id: str) -> None:
        """Forget a display that is closed."""
        self._drop((DISPLAY, display_id))

    def known_languages(self) -> List[str]:
        """Return the names of all languages."""
        return list(self._languages)

    def answer(self, name: str) -> str:
        """Return a document of data as the answer to a request."""
        document = self.document((name, ""))
        return (f'{{"session":"{self.session}","number":{document.number},{self._now()},'
                f'"data":{document.text}}}')

    # -- making documents -----------------------------------------------------------------------------

    def _look(self, document: Optional[Document]) -> None:
        """Make what is made of parts that have changed; without a document, only the fixed texts."""
        now = self.box.now()
        if document is not None:
            times.use_zone(document.public.time_zone)
        day = None if document is None else _day(now.utc)
        if document is not None:
            if abs(now.utc - now.mono - self._ahead_s) >= SAME_TIME_S:
                self._ahead_s = now.utc - now.mono
            self._make_data(document)
        for language in self._shown:
            with self.speaking(language):
                self._make_words(language, day, now.utc)
                if document is not None:
                    self._make_texts(document, language, day, now.utc)

    def _make_data(self, document: Document) -> None:
        public, ahead_s = document.public, self._ahead_s
        self._renew((STATE, ""), (_runs_of(document), public.results, ahead_s),
                    lambda: state(document, ahead_s))
        self._renew((SCHEDULE, ""), public.following, lambda: schedule(document))
        self._renew((RESULTS, ""), document.public_results, lambda: results(document))
        self._renew((STANDINGS, ""), public.standings, lambda: standings(document))
        self._renew((EXPLAINED, ""), _runs_of(document), lambda: explained(document))

    def _make_words(self, language: str, day: Optional[Day], utc_s: float) -> None:
        self._renew((WORDS, language), day, lambda: {
            **page_words(language, self._title, None if day is None else utc_s, (day or _NO_DAY)[1]),
            "logos": list(self.logos)})
        self._renew((DEVICE_WORDS, language), None, device.page_words)

    def _make_texts(self, document: Document, language: str, day: Optional[Day], utc_s: float) -> None:
        public, runs, results, ahead_s = document.public, document.public_runs, document.public_results, self._ahead_s
        # Whether there are several zones is part of the texts of runs and events.
        self._renew((PAGE_RUNS, language), (_runs_of(document), public.following, ahead_s),
                    lambda: page_runs(document, ahead_s))
        self._renew((PAGE_NEXT, language), (tuple(runs), public.following, day),
                    lambda: page_next(document, utc_s))
        self._renew((PAGE_RESULTS, language), (results, public.standings, day), lambda: page_results(document, utc_s))
        self._renew((PAGE_STANDINGS, language), public.standings, lambda: page_standings(document))
        self._renew((PAGE_EXPLAINED, language), _runs_of(document),
                    lambda: page_explained(document, language))


def _runs_of(document: Document) -> Tuple[object, ...]:
    """Of what texts of runs are made."""
    return document.public_runs, document.box.zones, document.box.uuid


def _day(utc_s: float) -> Day:
    """The local day, and the offset of local time to UTC in seconds."""
    return times.day_of(utc_s), times.offset_s(utc_s)
