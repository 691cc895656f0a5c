"""What the box and the program that copies its journal say to each other through the door (docs/door.md).

That program is a process of its own (`standby/program/copying.py`): the core never waits for a copy.
"""

import json
import math
from typing import Any, Dict, Mapping

from roah_rsbb.box.assembly import CoreAssembly
from roah_rsbb.box.door import BoxDoor
from roah_rsbb.core.copies import CopyReport
from roah_rsbb.document.calls import COPIED, COPY, COPY_REPORT, STOPPED, Call, Caller
from roah_rsbb.model.reason import Refused, decode

BOX = Caller("box")
MAX_REPORT = 4000  # characters of a report
_MALFORMED = "a malformed message of the program that copies the journal: install the same version there as on the box"


class CopyCalls:
    """The box's end. Call everything in the loop's thread."""

    def __init__(self, uuid: str, core: CoreAssembly, door: BoxDoor) -> None:
        """`uuid`: of this start of the box, because its tickets are only its own."""
        self._uuid, self._core, self._door = uuid, core, door

    def named(self) -> Dict[str, Call]:
        """The calls of the program that copies."""
        return {COPY_REPORT: self._report, COPIED: self._copied}

    def ask(self, ticket: int) -> None:
        """Ask whether the standby has everything up to a ticket of the journal. The answer is the call `COPIED`; a
        question is lost if nobody copies."""
        self._door.ask(COPY, {"box": self._uuid, "journal": self._core.store.identity, "ticket": ticket}, BOX)

    def pass_stops(self, stops: Mapping[str, str]) -> None:
        """Pass STOPs that were sent to the standby, before their records are written. Nothing waits for it."""
        self._door.announce(STOPPED, {"stops": dict(stops)}, BOX)

    def _report(self, found: Mapping[str, Any], _caller: Caller) -> None:
        behind_s = found.get("behind_s")
        if len(json.dumps(found)) > MAX_REPORT:
            raise Refused([_MALFORMED])
        place, journal, missing = (_checked(found, name, kind) for name, kind in (
            ("place", str), ("journal", str), ("missing_bytes", int)))
        report = CopyReport(
            place, journal == self._core.store.identity,
            math.inf if behind_s is None else max(0.0, _checked(found, "behind_s", (int, float))), missing,
            *(decode(found[name]) if found.get(name) else "" for name in ("trouble", "notice")))
        self._core.event(self._core.box.on_copy_report, report)
        self._core.standby.look()

    def _copied(self, found: Mapping[str, Any], _caller: Caller) -> None:
        if _checked(found, "box", str) == self._uuid:
            self._core.standby.on_answer(_checked(found, "ticket", int))


def _checked(found: Mapping[str, Any], name: str, kind: Any) -> Any:
    value = found.get(name)
    if not isinstance(value, kind) or isinstance(value, bool):
        raise Refused([_MALFORMED])
    return value
