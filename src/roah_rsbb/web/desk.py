"""What paired devices are shown: the newest messages for referees, and the documents made from them. No I/O, no clock.

Documents are made only for zones and languages that a connected device shows.
"""

import functools
from typing import Any, Dict, Iterable, List, Optional, Set

from roah_rsbb.web import documents, zone_documents
from roah_rsbb.web.numbered import Document, Key, Numbered
from roah_rsbb.web.store import Store
from roah_rsbb.wording import team_page
from roah_rsbb.wording.said import learn_details

ZONE, CLOCK, ZONES = "page.zone", "page.clock", "page.zones"
# What STOP needs, without a text: of a zone, or with "" of all zones.
STOP = "page.stop"
NO_STOP: Key = (STOP,)  # of devices that may stop nothing


class Desk(Numbered):
    """The documents for devices. The fixed texts of pages are those of the store."""

    SILENT_S = 1.5  # the core publishes the zones ten times a second

    def __init__(self, store: Store) -> None:
        super().__init__(store.session)
        self._store = store
        self._gui: Optional[Any] = None
        self._details: Optional[Any] = None
        self._clocks: Optional[Any] = None
        self._schedule: Optional[Any] = None
        self._runs: List[Any] = []
        self._judgings: List[Any] = []
        self._shown: Set[Key] = set()  # pairs of language and zone
        self._put(NO_STOP, zone_documents.stop_page([], False))

    # -- from the core --------------------------------------------------------------------------------

    def on_results(self, results) -> None:
        """Take Results."""
        self._runs = list(results.runs)

    def on_schedule(self, schedule) -> None:
        """Take Schedule."""
        self._schedule = schedule

    def on_judging(self, judging) -> None:
        """Take Judgings."""
        self._judgings = list(judging.runs)

    def on_clocks(self, clocks) -> None:
        """Take RunClocks."""
        self._clocks = clocks

    def on_details(self, details) -> None:
        """Take CoreDetails. What STOP needs is made first. A device of a zone that is gone has nothing to stop."""
        self._make_one((STOP, ""), lambda: zone_documents.stop_page(details.zones, True))
        for zone in details.zones:
            self._make_one((STOP, zone.zone), functools.partial(zone_documents.stop_page, [zone], False))
        names = {zone.zone for zone in details.zones}
        for key in [key for key in self._documents if key[0] == STOP and key[1:] and key[1] not in ("", *names)]:
            self._make_one(key, lambda: zone_documents.stop_page([], False))
        learn_details(details)
        self._details = details

    def on_gui(self, mono: float, gui) -> None:
        """Take CoreToGui, which arrived at `mono` (monotonic seconds), and make the documents again."""
        if self._gui is not None and gui.clock == self._gui.clock:
            return  # the latched one, which a core that hangs sends, too
        self._gui = gui
        if self._details is not None:
            self._heard_mono = mono
        self._clock.sample(mono, gui.clock.to_sec())
        for language, zone in self._shown:
            self._make(language, zone)

    def forget(self) -> None:
        """The topics are not subscribed to any more. The documents stay, but they are old until both the zones and
        their details have come again: details from before would show a run of before."""
        self._details = self._clocks = None
        self._heard_mono = float("-inf")

    # -- for devices ----------------------------------------------------------------------------------

    def zones(self) -> List[str]:
        """Return all zones, in the order of the schedule."""
        return [] if self._gui is None else [zone.zone for zone in self._gui.zones]

    def team_facts(self, team: str, language: str) -> Optional[List[str]]:
        """Return what the box knows of a team's robot; None: the core was not heard yet."""
        if self._gui is None or self._details is None:
            return None
        with self._store.speaking(language):
            return team_page.facts(team, self._gui, self._details, self._schedule)

    def show(self, zones: Iterable[Key]) -> None:
        """Make documents for these pairs of language and zone from now on, and for no others."""
        wanted = set(zones)
        for language, zone in wanted - self._shown:
            self._make(language, zone)
        self._shown = wanted

    def keys(self, language: str, zone: str) -> List[Key]:
        """Return the keys of all documents of a page."""
        return [*self._store.keys(documents.FIXED_TEXTS, language), (ZONES, language), (ZONE, language, zone),
                (CLOCK, language, zone)]

    def document(self, key: Key) -> Document:
        """Return a document."""
        return self._store.document(key) if key[0] in documents.FIXED_TEXTS else super().document(key)

    def piece(self, key: Key) -> str:
        """Return a document as a part of a message."""
        return self._store.piece(key) if key[0] in documents.FIXED_TEXTS else super().piece(key)

    def _make(self, language: str, zone_name: str) -> None:
        gui, details = self._gui, self._details
        if gui is None or details is None:
            return
        details_of: Dict[str, Any] = {one.zone: one for one in details.zones}
        zone = next((one for one in gui.zones if one.zone == zone_name), None)
        with self._store.speaking(language):
            self._make_one((ZONES, language), lambda: zone_documents.zones_page(gui.zones, details_of))
            if zone is None and zone_name not in details_of:  # it is gone
                self._put((ZONE, language, zone_name), None)
                self._put((CLOCK, language, zone_name), None)
            if zone is None or zone_name not in details_of:
                return
            of_zone = details_of[zone_name]
            clock = next((one for one in (self._clocks.zones if self._clocks else ()) if one.zone == zone_name), None)
            self._make_one((ZONE, language, zone_name), lambda: zone_documents.zone_page(
                zone, of_zone, details.warnings, self._runs, self._judgings, gui.clock.to_sec()))
            if clock is not None and clock.identity == of_zone.identity:  # else that of this run has not come yet
                passed_s = gui.clock.to_sec() - self._clocks.clock.to_sec()
                self._make_one((CLOCK, language, zone_name), lambda: zone_documents.clock_page(clock, passed_s))
