"""What everybody is shown of the box: the documents made from what is public. No I/O and no clock."""

from typing import ContextManager, Dict, Iterable, List, Optional, Set, Tuple

from roah_rsbb.model.document import Document
from roah_rsbb.web import documents
from roah_rsbb.web.documents import TEXTS, Data
from roah_rsbb.web.numbered import BoxShown, Key, Numbered
from roah_rsbb.wording import device, times
from roah_rsbb.wording.language import ENGLISH, Translate, chosen, in_language
from roah_rsbb.wording.public import ALL_TEAMS

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

    def put_display(self, display_id: str, data: Data) -> None:
        """Make the document with what the organiser has set for a display."""
        self._put((documents.DISPLAY, display_id), data)

    def drop_display(self, display_id: str) -> None:
        """Forget a display that is closed."""
        self._drop((documents.DISPLAY, display_id))

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
        self._renew((documents.STATE, ""), (_runs_of(document), public.results, ahead_s),
                    lambda: documents.state(document, ahead_s))
        self._renew((documents.SCHEDULE, ""), public.following, lambda: documents.schedule(document))
        self._renew((documents.RESULTS, ""), document.public_results, lambda: documents.results(document))
        self._renew((documents.STANDINGS, ""), public.standings, lambda: documents.standings(document))
        self._renew((documents.EXPLAINED, ""), _runs_of(document), lambda: documents.explained(document))

    def _make_words(self, language: str, day: Optional[Day], utc_s: float) -> None:
        self._renew((documents.WORDS, language), day, lambda: {
            **documents.page_words(language, self._title, None if day is None else utc_s, (day or _NO_DAY)[1]),
            "logos": list(self.logos)})
        self._renew((documents.DEVICE_WORDS, language), None, device.page_words)

    def _make_texts(self, document: Document, language: str, day: Optional[Day], utc_s: float) -> None:
        public, runs, results, ahead_s = document.public, document.public_runs, document.public_results, self._ahead_s
        # Whether there are several zones is part of the texts of runs and events.
        self._renew((documents.PAGE_RUNS, language), (_runs_of(document), public.following, ahead_s),
                    lambda: documents.page_runs(document, ahead_s))
        self._renew((documents.PAGE_NEXT, language), (tuple(runs), public.following, day),
                    lambda: documents.page_next(document, utc_s))
        self._renew((documents.PAGE_RESULTS, language), (results, day), lambda: documents.page_results(document, utc_s))
        self._renew((documents.PAGE_STANDINGS, language), public.standings, lambda: documents.page_standings(document))
        self._renew((documents.PAGE_EXPLAINED, language), _runs_of(document),
                    lambda: documents.page_explained(document, language))


def _runs_of(document: Document) -> Tuple[object, ...]:
    """Of what texts of runs are made."""
    return document.public_runs, document.box.zones, document.box.uuid


def _day(utc_s: float) -> Day:
    """The local day, and the offset of local time to UTC in seconds."""
    return times.day_of(utc_s), times.offset_s(utc_s)
