"""The document of a box: everything that the faces show of it, made of the box's own objects."""

from typing import Dict, Mapping, Optional, Sequence, Tuple, TypeVar

from roah_rsbb.core.box import Box
from roah_rsbb.core.views import sheets, views
from roah_rsbb.core.views.public import NOTHING_ALLOWED, Publicity, PublicViews
from roah_rsbb.core.views.schedule import EventLine, ScheduleView, events_shown
from roah_rsbb.model.clock import Now
from roah_rsbb.model.document import BoxSeen, Document
from roah_rsbb.model.reason import say
from roah_rsbb.model.records import RunRecord
from roah_rsbb.model.results import Judging, RunLine, UnsavedParts
from roah_rsbb.scoring.counting import Why

# Until an end of a run is on all disks on which it must be.
END_UNSAVED = say("The end of the run is not recorded yet: write it down until this line is gone")

V = TypeVar("V")


class Documents:
    """Makes the document of one box again and again. What is equal to the part before is the same object."""

    def __init__(self, box: Box, uuid: str, host: str, publicity: Publicity = NOTHING_ALLOWED) -> None:
        """`uuid`: identity of this start of the core; `host`: broadcast address in use; `publicity`: what the public
        may see."""
        self._box, self._uuid, self._host = box, uuid, host
        self._views, self._schedule, self._public = views.ZoneViews(box), ScheduleView(box), PublicViews(box, publicity)
        self.last = Document(BoxSeen(uuid, host, 0), {}, {}, {}, {}, {})
        self.fault: Optional[Exception] = None  # why the last look has nothing new for the public
        self._events: Optional[Sequence[EventLine]] = None  # of which the last schedule was made
        self._revision: Optional[int] = None  # of the box, to which the sections belong that only events change
        self._lines: Dict[str, Tuple[RunRecord, Why, RunLine]] = {}  # by identity

    def look(
        self, now: Now, log_files: Mapping[int, str] = views.NO_FILES, unsaved: Sequence[UnsavedParts] = (),
    ) -> Document:
        """Return the document of this moment. `log_files`: path of each run's log by its port; `unsaved`: what is not
        on the disk yet."""
        box, last = self._box, self.last
        revision, events = box.revision, self._schedule.look(now)
        robots = _kept(last.robots, views.robots(box, now, last.robots))
        ended = {parts.identity for parts in unsaved if parts.stops}
        zones = _kept(last.zones, {
            name: zone._replace(warnings=(*zone.warnings, END_UNSAVED)) if zone.identity in ended else zone
            for name, zone in self._views.look(now, robots, log_files).items()})
        document = last._replace(
            box=views.box_state(box, now, self._uuid, self._host, unsaved), robots=robots, zones=zones,
            schedule=last.schedule if events is self._events else _kept(last.schedule, events_shown(events)))
        has_changed = revision != self._revision
        if has_changed:
            document = document._replace(
                results=_kept(last.results, self._results(now)), judging=_kept(last.judging, self._judging(now)))
        if has_changed or zones is not last.zones:
            document = self._publicly(document, now, has_changed)
        self._revision, self._events = revision, events
        if document.box == last.box:
            document = document._replace(box=last.box)
        if document.public == last.public:
            document = document._replace(public=last.public)
        if any(part is not before for part, before in zip(document, last)):
            self.last = document
        return self.last

    def _publicly(self, document: Document, now: Now, has_changed: bool) -> Document:
        """Return the document with what the public may see. If that cannot be made, which is an error of this program,
        the public sees what it saw before, and the referees see all else."""
        last = self.last
        try:
            found = document._replace(public_runs=_kept(last.public_runs, self._public.runs(document.zones)))
            if has_changed:
                found = found._replace(public=self._public.others(now),
                                       public_results=_kept(last.public_results, self._public.results(now)))
        except Exception as error:
            self.fault = error
            return document
        self.fault = None
        return found

    def _results(self, now: Now) -> Dict[str, RunLine]:
        scores, before = self._box.scores, self._lines
        why = {ruling.record.identity: ruling.why for ruling in scores.rulings(now)}
        self._lines = {}
        for record in map(sheets.timeless, scores.records(now)):
            known, counts = before.get(record.identity), why[record.identity]
            if known is None or known[1] is not counts or known[0] != record:
                known = record, counts, sheets.run_line(record, counts)
            self._lines[record.identity] = known
        return {identity: line for identity, (_, _, line) in self._lines.items()}

    def _judging(self, now: Now) -> Dict[str, Judging]:
        return {one.record.identity: sheets.judging(one) for one in self._box.judges.unsigned(now)}


def _kept(before: Dict[str, V], now: Dict[str, V]) -> Dict[str, V]:
    """Return the entries of a section, as the same objects as before where they are equal."""
    found = {key: before[key] if key in before and before[key] == value else value for key, value in now.items()}
    if len(found) == len(before) and all(before.get(key) is value for key, value in found.items()):
        return before
    return found
