"""What the gateway knows: the newest public messages, and the documents made from them. No I/O and no clock."""

import time
from typing import Any, Callable, ContextManager, Dict, Iterable, List, Optional, Set, Tuple

from roah_rsbb.web import documents
from roah_rsbb.web.documents import DATA, TEXTS, Data
from roah_rsbb.web.numbered import Key, Numbered
from roah_rsbb.wording import device
from roah_rsbb.wording.language import Translate, in_language
from roah_rsbb.wording.public import ALL_TEAMS

ENGLISH = "en"


class Store(Numbered):
    """The documents of the gateway."""

    SILENT_S = 1.5  # the core publishes for the public twice a second

    def __init__(self, languages: Dict[str, Translate], title: str = "", session: str = "",
                 logos: Optional[Dict[str, str]] = None) -> None:
        """`languages`: those besides English, by name such as ``de``. `title`: of the competition.

        `logos`: paths of the teams' logos, by team.
        """
        super().__init__(session)
        self._languages: Dict[str, Optional[Translate]] = {ENGLISH: None, **languages}
        self._title = title
        self.logos = logos or {}
        self._shown: Set[str] = set()  # languages that somebody has asked for
        self._details: Optional[Any] = None
        self._board: Optional[Any] = None
        self._explained: Optional[Any] = None
        self._state: Optional[Data] = None
        self._day: Optional[Tuple[int, int, int]] = None

    # -- from the core --------------------------------------------------------------------------------

    def on_details(self, mono: float, details) -> None:
        """Take PublicDetails, which arrived at `mono` (monotonic seconds)."""
        before = self._details
        if details == before:
            return
        self._details, self._heard_mono = details, mono
        self._clock.sample(mono, details.clock.to_sec())
        day = _day(details.clock.to_sec())
        if before is None or day != self._day:  # texts name days
            self._day = day
            self._make(DATA + TEXTS)
            return
        self._make((documents.STATE, documents.PAGE_RUNS))
        if details.following != before.following or _zones(details) != _zones(before):
            self._make((documents.SCHEDULE, documents.PAGE_NEXT))
        if self._board is None and details.finished != before.finished:
            self._make((documents.RESULTS, documents.PAGE_RESULTS))

    def on_board(self, board) -> None:
        """Take PublicBoard."""
        self._board = board
        if self._details is not None:
            self._make((documents.RESULTS, documents.STANDINGS, documents.PAGE_RESULTS, documents.PAGE_STANDINGS))

    def on_explained(self, explained) -> None:
        """Take PublicExplained."""
        self._explained = explained
        if self._details is not None:
            self._make((documents.EXPLAINED, documents.PAGE_EXPLAINED))

    def zones(self) -> List[str]:
        """Return all zones, in alphabetical order."""
        return [] if self._details is None else sorted(_zones(self._details))

    def teams(self) -> List[str]:
        """Return all teams that are known, in alphabetical order."""
        details, board = self._details, self._board
        if details is None:
            return []
        ended = list(details.finished) if board is None else [*board.results, *board.provisional]
        ranked = () if board is None else board.standings
        teams = {team for run in details.runs for team in run.teams}
        teams.update(event.team for event in [*details.following, *(result.event for result in ended)])
        teams.update(rank.team for standing in ranked for rank in standing.ranks)
        return sorted(teams - {ALL_TEAMS})

    # -- for readers ----------------------------------------------------------------------------------

    def language(self, wanted: str) -> str:
        """Return the first language that is wanted and available, else English. `wanted`: such as ``fr,de-AT``."""
        for name in wanted.split(","):
            name = name.partition(";")[0].strip().replace("-", "_")
            for known in (name, name.partition("_")[0]):
                if known in self._languages:
                    return known
        return ENGLISH

    def speaking(self, language: str) -> ContextManager[None]:
        """Translate texts to one of the known languages in a `with` block."""
        return in_language(self._languages[language])

    def keys(self, names: Iterable[str], language: str) -> List[Key]:
        """Return the keys of documents. Texts in a language are made from the first time that it is asked for."""
        keys = [(name, language if name in TEXTS else "") for name in names]
        if language not in self._shown and any(name in TEXTS for name, _ in keys):
            self._shown.add(language)
            self._make_texts(language, documents.FIXED_TEXTS if self._details is None else TEXTS)
        return keys

    def put_display(self, display_id: str, data: Data) -> None:
        """Make the document with what the organiser has set for a display."""
        self._put((documents.DISPLAY, display_id), data)

    def drop_display(self, display_id: str) -> None:
        """Forget a display that is closed."""
        self._drop((documents.DISPLAY, display_id))

    def known_languages(self) -> List[str]:
        """Return the names of all languages."""
        return list(self._languages)

    def answer(self, name: str, mono: float) -> str:
        """Return a document of data as the answer to a request."""
        document = self.document((name, ""))
        return (f'{{"session":"{self.session}","number":{document.number},{self._now(mono)},'
                f'"data":{document.text}}}')

    # -- making documents -----------------------------------------------------------------------------

    def _make(self, names: Iterable[str]) -> None:
        details, board = self._details, self._board
        if documents.STATE in names:
            self._state = documents.state(details, self._state)
            self._put((documents.STATE, ""), self._state)
        makers: Dict[str, Callable[[], Data]] = {
            documents.SCHEDULE: lambda: documents.schedule(details),
            documents.RESULTS: lambda: documents.results(details, board),
            documents.STANDINGS: lambda: documents.standings(board),
            documents.EXPLAINED: lambda: documents.explained(details, self._explained),
        }
        for name in names:
            if name in makers:
                self._make_one((name, ""), makers[name])
        for language in self._shown:
            self._make_texts(language, names)

    def _make_texts(self, language: str, names: Iterable[str]) -> None:
        details, board = self._details, self._board
        utc_s = None if details is None else details.clock.to_sec()
        offset_s = 0 if self._day is None else self._day[2]
        makers: Dict[str, Callable[[], Data]] = {
            documents.WORDS: lambda: {
                **documents.page_words(language, self._title, utc_s, offset_s), "logos": list(self.logos)},
            documents.DEVICE_WORDS: device.page_words,
            documents.PAGE_RUNS: lambda: documents.page_runs(details, self._state["runs"]),
            documents.PAGE_NEXT: lambda: documents.page_next(details, utc_s),
            documents.PAGE_RESULTS: lambda: documents.page_results(details, board, utc_s),
            documents.PAGE_STANDINGS: lambda: documents.page_standings(board),
            documents.PAGE_EXPLAINED: lambda: documents.page_explained(details, self._explained, language),
        }
        with self.speaking(language):
            for name in names:
                if name in makers:
                    self._make_one((name, language), makers[name])


def _zones(details) -> Set[str]:
    """All zones: whether there are several is part of the texts."""
    return {run.event.zone for run in details.runs} | {event.zone for event in details.following}


def _day(utc_s: float) -> Tuple[int, int, int]:
    """The local day, and the offset of local time to UTC in seconds."""
    try:
        local = time.localtime(utc_s)
    except (OverflowError, OSError, ValueError):  # a clock that is far off must not stop the gateway
        return (0, 0, 0)
    return (local.tm_year, local.tm_yday, local.tm_gmtoff)
