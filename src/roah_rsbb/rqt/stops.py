"""STOP: which run it stops, and the way of each STOP until the robot has it (docs/referee.md, "How to stop a robot").

STOP has a way of its own. What it stops follows from the zones that run and the zone that is shown. No text, no sorting
and no widget takes part in it.
"""

import math
import time
from dataclasses import dataclass
from functools import partial
from typing import Dict, Iterable, List, NamedTuple, Tuple

from roah_rsbb.model.zone import ENDED, RUNNING
from roah_rsbb.rqt.calls import CallOutcome, Calls
from roah_rsbb.rqt.model import NOT_HEARD, Model
from roah_rsbb.rqt.qt import QObject, QTimer, Signal
from roah_rsbb.wording import stop
from roah_rsbb.wording.language import tr, tr_later
from roah_rsbb.wording.stop import Way
from roah_rsbb.wording.whole_box import REPLAY_NO_COMMANDS, SUPERSEDED_NO_COMMANDS

LOOK_MS = 100
# How long a STOP that reached its robot, or that the box refused, stays on the screen.
DONE_S = 8.0
FAILED_S = 15.0
# After a press, STOP does not pass to the only other run for this time (s): whoever is frightened presses twice.
SAME_S = 2.0

NONE_RUNS = tr_later("No zone is running")


class StopTarget(NamedTuple):
    """What STOP stops now."""

    zone: str = ""  # empty: nothing
    why_off: str = ""


def stoppable(model: Model) -> List[str]:
    """Return the zones whose runs can be stopped here."""
    return [] if model.is_replay or model.is_superseded else model.running_zones()


def target_of(model: Model) -> StopTarget:
    """Return what STOP stops: the run of the zone that is shown, else the only run."""
    shown, running = model.zone_name, stoppable(model)
    if model.is_replay or model.is_superseded:
        return StopTarget(why_off=tr(REPLAY_NO_COMMANDS if model.is_replay else SUPERSEDED_NO_COMMANDS))
    if shown in running:
        return StopTarget(shown)
    if len(running) == 1:
        return StopTarget(running[0])
    if running:
        return StopTarget(why_off=tr(stop.OTHERS_RUN, zone=shown, zones=", ".join(running)))
    return StopTarget(why_off=tr(NOT_HEARD if model.document is None else NONE_RUNS))


@dataclass
class SentStop:
    """A STOP that was sent."""

    zone: str
    identity: str  # of the run; empty: not known
    sent_mono: float
    calls: int = 0  # that wait for an answer
    box_has_it: bool = False
    refused: str = ""  # why the box did not stop the run
    way: Way = Way.SENT
    is_over: bool = False  # the box reported that the run is over
    is_done: bool = False
    until_mono: float = math.inf  # when it disappears from the screen


class Stops(QObject):
    """Sends each STOP until the box has it, and follows it to the robot."""

    changed = Signal()

    def __init__(self, model: Model, calls: Calls) -> None:
        super().__init__()
        self._model = model
        self._calls = calls
        self._sent: List[SentStop] = []
        self._pressed = ("", -math.inf)  # the zone that was stopped last, and the monotonic time (s)
        # Since when (monotonic seconds) runs that are over wait for their robots, by zone and identity.
        self._waiting: Dict[Tuple[str, str], float] = {}
        self._timer = QTimer(self, interval=LOOK_MS, timeout=self._look)
        model.updated.connect(self._on_update)
        model.ticked.connect(self._on_update)

    def end(self) -> None:
        """Stop following."""
        self._model.updated.disconnect(self._on_update)
        self._model.ticked.disconnect(self._on_update)
        self._timer.stop()
        self._calls.forget(self)

    def target(self) -> StopTarget:
        """Return what STOP stops now."""
        target, (pressed, mono) = target_of(self._model), self._pressed
        if target.zone not in ("", self._model.zone_name) and time.monotonic() - mono < SAME_S:
            return StopTarget(pressed)
        return target

    def stop(self, zones: Iterable[str]) -> None:
        """Stop the runs in these zones. Nothing here ignores a STOP: one that is on its way is sent again at once."""
        now = time.monotonic()
        for zone in zones:
            self._pressed = (zone, now)
            identity = self._model.identity_of(zone)
            self._sent = [one for one in self._sent
                          if one.zone != zone or (one.identity == identity and not one.refused and not one.box_has_it)]
            found = next((one for one in self._sent if one.zone == zone), None)
            if found is None:
                found = SentStop(zone, identity, now)
                self._sent.append(found)
            self._try(found)
        self._timer.start()
        self.changed.emit()

    def sent(self) -> List[SentStop]:
        """Return all that are shown, those first of which the referee must know, and of these the newest."""
        return sorted(self._sent, key=lambda one: (not one.refused and one.way not in stop.LOST, one.way in stop.DONE,
                                                   -one.sent_mono))

    def _on_update(self) -> None:
        if not self._model.is_old and not self._model.is_replay:
            self._take_unanswered(time.monotonic())

    def _take_unanswered(self, now: float) -> None:
        """Follow what others stopped, too, and what ended by itself, once a robot does not answer."""
        before, self._waiting = self._waiting, {}
        for zone in self._model.document.zones.values():
            if zone.phase != ENDED or not zone.not_stopped:
                continue
            key = zone.zone, zone.identity
            since = self._waiting[key] = before.get(key, now)
            if now - since >= stop.NOT_DELIVERED_S and all(one.zone != zone.zone for one in self._sent):
                self._sent.append(SentStop(*key, since, box_has_it=True, way=Way.LOST_ROBOT, is_over=True))
                self._timer.start()
                self.changed.emit()

    def _try(self, one: SentStop) -> None:
        one.calls += 1
        self._calls.stop(self, one.zone, one.identity, partial(self._answered, one))

    def _answered(self, one: SentStop, outcome: CallOutcome) -> None:
        one.calls -= 1
        if not outcome.error:
            one.box_has_it = True
        elif outcome.is_answered and not one.box_has_it:
            one.refused = outcome.error
            one.until_mono = time.monotonic() + FAILED_S
        QTimer.singleShot(0, self._look)

    def _look(self) -> None:
        """Follow each STOP, and send it again if the box did not answer."""
        now = time.monotonic()
        for one in self._sent:
            self._follow(one, now)
            if not one.box_has_it and not one.refused and not one.calls:
                self._try(one)
        self._sent = [one for one in self._sent if now < one.until_mono]
        if not self._sent:
            self._timer.stop()
        self.changed.emit()

    def _follow(self, one: SentStop, now: float) -> None:
        zone = None if self._model.is_old else self._model.zone_of(one.zone)
        is_same = zone is not None and one.identity in ("", zone.identity)
        runs = is_same and zone.phase == RUNNING
        if runs and (one.is_over or one.is_done):
            one.until_mono = now  # the referee continued the run
            return
        if zone is not None and not runs:
            one.box_has_it, one.refused, one.is_over = True, "", True
        if zone is not None and not is_same and one.identity:
            one.until_mono = min(one.until_mono, now)  # the run was left: the STOP concerns nobody any more
            return
        one.way = stop.way(now - one.sent_mono, one.box_has_it, zone if is_same else None)
        if one.way in stop.DONE and not one.is_done:
            one.is_done, one.until_mono = True, now + DONE_S


REFUSED = tr_later("refused")


def short_of(one: SentStop) -> str:
    """Return the same as `text_of` in few words, for a place that has the name of the zone."""
    return tr(REFUSED if one.refused else stop.SHORT[one.way])


def brief_of(sent: Iterable[SentStop]) -> str:
    """Return which robots the referee must stop by hand, in few words; empty: none."""
    zones = {way: ", ".join(one.zone for one in sent if one.way is way) for way in stop.LOST}
    return "   ".join(tr("{way}, stop by hand: {zones}", way=tr(stop.SHORT[way]), zones=zones[way])
                      for way in stop.LOST if zones[way])


def text_of(one: SentStop) -> Tuple[str, bool]:
    """Return what the referee reads of a STOP, and whether they must act."""
    if one.refused:
        return tr("✘ {what} failed: {error}", what=tr("Stop {zones}", zones=one.zone), error=one.refused), True
    return stop.way_text(one.way, one.zone), one.way in stop.LOST
