"""The box itself and the tablet, as faces show them (docs/referee.md, "Core Status" and "Tablet Status")."""

from typing import List, Tuple

from roah_rsbb.model.clock import Now
from roah_rsbb.model.document import Document, TabletSeen
from roah_rsbb.model.zone import RUNNING
from roah_rsbb.wording.language import tr, tr_later
from roah_rsbb.wording.times import Moments

FACTS = (tr_later("Broadcast to"), tr_later("UDP port"), tr_later("Robots"), tr_later("Running"))
TABLET = (tr_later("Last heard"), tr_later("Display"), tr_later("Last call"), tr_later("Position"),
          tr_later("Position received"))
# After this long without a message the tablet is silent: it sends every second.
TABLET_SILENT_S = 5.0


def facts(document: Document) -> Tuple[str, ...]:
    """Return the texts of all `FACTS`."""
    running = sum(zone.phase == RUNNING for zone in document.zones.values())
    return (document.box.host, str(document.box.port), str(len(document.robots)),
            tr("{number} of {n} zones", number=running, n=len(document.zones)))


def tablet(seen: TabletSeen, now: Now, moments: Moments) -> List[Tuple[str, float]]:
    """Return the texts of all of `TABLET`, each with the moment that it is about in UTC seconds; 0.0: none."""
    silent_s = 0.0 if seen.silent_since is None else now.mono - seen.silent_since
    silent = f"  {tr('⚠ silent')}" if silent_s > TABLET_SILENT_S else ""
    heard, call, position = ((moments.and_age(utc_s, now.utc), utc_s) for utc_s in (
        now.utc - silent_s if seen.heard else 0.0, seen.call_utc_s, seen.position_utc_s))
    place = tr("x {x:.2f} m, y {y:.2f} m", x=seen.position_x, y=seen.position_y) if seen.position_utc_s else tr("none")
    return [(heard[0] + silent, heard[1]), (tr("Map") if seen.display_map else tr("Call button"), 0.0), call,
            (place, 0.0), position]
