"""The document of a box: everything that the faces show of it, made of the box's own objects."""

from typing import Dict, Mapping, Optional, Sequence, Tuple, TypeVar

from roah_rsbb.core.box import Box
from roah_rsbb.core.scoring.counting import Why
from roah_rsbb.core.views import sheets, views
from roah_rsbb.core.views.schedule import EventLine, ScheduleView, events_shown
from roah_rsbb.model.clock import Now
from roah_rsbb.model.document import BoxState, Document
from roah_rsbb.model.judging import Judging
from roah_rsbb.model.records import RunRecord
from roah_rsbb.model.results import RunLine, UnsavedParts

V = TypeVar("V")


class Documents:
    """Makes the document of one box again and again. What is equal to the part before is the same object."""

    def __init__(self, box: Box, uuid: str, host: str) -> None:
        """`uuid`: identity of this start of the core; `host`: broadcast address in use."""
        self._box, self._uuid, self._host = box, uuid, host
        self._views, self._schedule = views.ZoneViews(box), ScheduleView(box)
        self.last = Document(BoxState(uuid, host, 0), {}, {}, {}, {}, {})
        self._events: Optional[Sequence[EventLine]] = None  # of which the last schedule was made
        self._revision: Optional[int] = None  # of the box, to which results and judging belong
        self._lines: Dict[str, Tuple[RunRecord, Why, RunLine]] = {}  # by identity

    def look(
        self, now: Now, log_files: Mapping[int, str] = views.NO_FILES, unsaved: Sequence[UnsavedParts] = (),
    ) -> Document:
        """Return the document of this moment. `log_files`: path of each run's log by its port; `unsaved`: what is not
        on the disk yet."""
        box, last = self._box, self.last
        revision, events = box.revision, self._schedule.look(now)
        robots = _kept(last.robots, views.robots(box, now, last.robots))
        document = Document(
            views.box_state(box, now, self._uuid, self._host, unsaved), robots,
            _kept(last.zones, self._views.look(now, robots, log_files)),
            last.schedule if events is self._events else _kept(last.schedule, events_shown(events)),
            last.results if revision == self._revision else _kept(last.results, self._results(now)),
            last.judging if revision == self._revision else _kept(last.judging, self._judging(now)),
        )
        self._revision, self._events = revision, events
        if document.box == last.box:
            document = document._replace(box=last.box)
        if any(part is not before for part, before in zip(document, last)):
            self.last = document
        return self.last

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
