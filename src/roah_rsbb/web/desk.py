"""What paired devices are shown of the box: the documents made from its own one. No I/O, no clock.

Documents are made only for zones and languages that a connected device shows, and again only if what they are made of
has changed.
"""

import functools
from typing import Iterable, List, Optional, Set

from roah_rsbb.model.clock import Now
from roah_rsbb.model.document import Document
from roah_rsbb.model.zone import ZoneSeen
from roah_rsbb.web import documents, zone_documents
from roah_rsbb.web.box_page.documents import PartShown, made_of, part_name, part_page
from roah_rsbb.web.numbered import Key, Numbered, NumberedDocument
from roah_rsbb.web.store import Store
from roah_rsbb.wording import public
from roah_rsbb.wording.whole_box import LinkQuality

ZONE, CLOCK, ZONES = "page.zone", "page.clock", "page.zones"
# What STOP needs, without a text: of a zone, or with "" of all zones.
STOP = "page.stop"
NO_STOP: Key = (STOP,)  # of devices that may stop nothing


class Desk(Numbered):
    """The documents for devices. The fixed texts of pages are those of the store."""

    def __init__(self, store: Store) -> None:
        super().__init__(store.box, store.session)
        self._store = store
        self._shown: Set[Key] = set()  # see `show`
        self._links = LinkQuality()
        self._put(NO_STOP, zone_documents.stop_page([], False))

    def zones(self) -> List[str]:
        """Return all zones, in the order of the schedule."""
        return [zone.zone for zone in self._zones()]

    def team_facts(self, team: str, language: str) -> Optional[List[str]]:
        """Return what the box knows of a team's robot; None: it was not heard yet."""
        document = self.box.document
        if document is None:
            return None
        with self._store.speaking(language):
            return public.team_facts(team, document, self.box.now())

    def show(self, shown: Iterable[Key]) -> None:
        """Make documents for these from now on, and for no others: language and zone, and where a part of the page of
        the whole box is open, that part and the zone in which its device may act; empty: all zones."""
        self._shown = set(shown)
        self.look()

    def look(self) -> bool:
        """Make documents again: the box, or only its clocks, may have changed. Returns whether any has changed. What
        STOP needs is made first. A device of a zone that is gone has nothing to stop."""
        document, before, zones = self.box.document, self.changes, self._zones()
        if document is None:
            return False
        successor = document.box.superseded_by
        for name in {"", *document.zones, *(key[1] for key in self._made_of if key[0] == STOP)}:
            own = [zone for zone in zones if name in ("", zone.zone)]
            self._renew((STOP, name), (own, successor),
                        functools.partial(zone_documents.stop_page, own, name == "", successor))
        now = self.box.now()
        self._links.look(document, now.mono)  # also while nobody sees it: it depends on the past
        for language, name in {key[:2] for key in self._shown}:
            with self._store.speaking(language):
                self._renew((ZONES, language), zones, lambda: zone_documents.zones_page(zones))
                self._make(document, language, name, now)
        for language, name, part, own in (key for key in self._shown if len(key) > 2):
            key, shown = (part_name(part), language, name, own), PartShown(
                document, name, own, now, self._links)
            if self.box.is_old and key in self._made_of:
                continue  # its clocks stop
            with self._store.speaking(language):
                self._renew(key, made_of(part, shown), functools.partial(part_page, part, shown))
        return self.changes != before

    def _make(self, document: Document, language: str, name: str, now: Now) -> None:
        """Make the documents of a zone in a language, which texts have now."""
        zone = document.zones.get(name)
        if zone is None:  # it is gone
            self._renew((ZONE, language, name), None, lambda: None)
            self._renew((CLOCK, language, name), None, lambda: None)
            return
        counts = zone_documents.counts(zone.clock) and not self.box.is_old
        self._renew(
            (ZONE, language, name), (zone, document.box.warnings, document.results, document.judging,
                                     zone_documents.moment(document, now.utc)),
            lambda: zone_documents.zone_page(zone, document, now.utc))
        self._renew((CLOCK, language, name), (zone.clock, zone.phase, now.mono if counts else None),
                    lambda: zone_documents.clock_page(zone, now.mono))

    def _zones(self) -> List[ZoneSeen]:
        document = self.box.document
        return [] if document is None else [
            document.zones[name] for name in document.box.zones if name in document.zones]

    # -- for devices ----------------------------------------------------------------------------------

    def keys(self, language: str, zone: str, part: str = "", own: str = "") -> List[Key]:
        """Return the keys of all documents of a page; see `show`."""
        return [*self._store.keys(documents.FIXED_TEXTS, language), (ZONES, language), (ZONE, language, zone),
                (CLOCK, language, zone), *([(part_name(part), language, zone, own)] if part else [])]

    def document(self, key: Key) -> NumberedDocument:
        """Return a document."""
        return self._store.document(key) if key[0] in documents.FIXED_TEXTS else super().document(key)

    def piece(self, key: Key) -> str:
        """Return a document as a part of a message."""
        return self._store.piece(key) if key[0] in documents.FIXED_TEXTS else super().piece(key)
