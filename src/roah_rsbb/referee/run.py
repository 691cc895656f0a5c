"""A whole run by script: to the event, connect, start, follow it to its end, score sheet, disconnect.

No rule of the game is here: the core says what is allowed and why not, and this waits for it. Whatever goes
wrong, the run is not left behind: who began it stops and disconnects it (unless told to keep it).
"""

import contextlib
import enum
import sys
import time
from typing import Any, Callable, Dict, List, NamedTuple, Optional, Tuple, Union

from roah_rsbb.core.referee import Refused
from roah_rsbb.referee.answers import Automatic, GivenUp, Keyboard, Note, Typed
from roah_rsbb.referee.changes import Change, news
from roah_rsbb.referee.exits import Exit, NoCore
from roah_rsbb.referee.follow import Follower
from roah_rsbb.referee.state import COMPLETED, CONNECTED, ENDED, IDLE, RUNNING, STOPPED, Item, Zone
from roah_rsbb.referee.words import BadWord, EventWanted, pick_item, value_of

# A core that is silent for so long does not come back by itself (it would be started again in seconds).
GIVE_UP_S = 60.0
STEP_S = 1.0


class Operations(enum.Enum):
    """Who does manual operations during the run."""

    OTHERS = "others"  # at a panel, or with 'referee done'
    AUTOMATIC = "automatic"
    TYPED = "typed"


_ANSWERS: Dict[Operations, Callable[[Any, Note], Union[Automatic, Typed, None]]] = {
    Operations.OTHERS: lambda link, note: None,
    Operations.AUTOMATIC: Automatic,
    Operations.TYPED: lambda link, note: Typed(link, note, Keyboard(note).lines, ahead=not sys.stdin.isatty()),
}


class Plan(NamedTuple):
    """What the referee wants."""

    zone: str
    wait_s: float  # for connect to be possible, and again for start
    event: Optional[EventWanted] = None
    scores: Tuple[Tuple[str, str], ...] = ()  # item and value, as typed
    keep: bool = False
    operations: Operations = Operations.OTHERS


class Outcome(NamedTuple):
    """How it ended. `zone` is as it was before the disconnect; None: there was no run."""

    status: Exit
    text: str
    zone: Optional[Zone] = None


class _Failed(Exception):
    """It cannot go on."""

    def __init__(self, status: Exit, text: str) -> None:
        super().__init__(text)
        self.status = status


class RunScript:
    """One run. `link` is an open Link; `tell` gets every change."""

    def __init__(self, link, plan: Plan, tell: Callable[[Change], None]) -> None:
        self._link = link
        self._answers = _ANSWERS[plan.operations](link, self._note)
        self._plan = plan
        self._tell = tell
        self._follower = Follower(link, plan.zone)
        self._began = False  # connected by us (or just about to be)
        self._event = self._zone().event
        self._uuid = link.box.box_uuid  # of the core that has our run
        self._scores: List[Tuple[Item, int]] = []
        self._unmarked = ""  # what could not be marked

    def run(self) -> Outcome:
        """From the start to the end. Ctrl-C (KeyboardInterrupt) stops the run and leaves it."""
        try:
            return self._whole()
        except _Failed as failed:
            return self._leave(failed.status, str(failed))
        except Refused as refused:
            return self._leave(Exit.REFUSED, f"refused: {refused}")
        except BadWord as bad:
            return self._leave(Exit.USAGE, str(bad))
        except GivenUp as given_up:
            return self._leave(Exit.NOT_COMPLETED, f"the run did not complete: {given_up}")
        except NoCore as gone:
            return Outcome(Exit.NO_CORE, f"{gone}{self._left_behind()}")
        except KeyboardInterrupt:
            return self._interrupted()

    # -- the steps ----------------------------------------------------------------------------------

    def _whole(self) -> Outcome:
        zone = self._zone()
        if zone.phase != IDLE:
            raise _Failed(Exit.REFUSED, f"a run is in zone '{zone.zone}' already ({zone.phase}): disconnect it first")
        if self._plan.event is not None:
            self._go_to(self._plan.event)
        self._event = self._zone().event
        while True:
            self._connect()
            self._resolve_scores()
            if self._start():
                return self._to_the_end()

    def _go_to(self, wanted: EventWanted) -> None:
        """Look at the zone's events from here to the last one, then from here to the first one."""
        start, seen = self._zone().event, []
        for command in ("next", "previous"):
            while not wanted.fits(self._zone().event):
                event = self._zone().event
                seen.append(f"{event.code}/{event.round}/{event.run}")
                if self._zone().off[command]:
                    break
                self._move(command)
            else:
                return
        while self._zone().event != start and not self._zone().off["next"]:
            self._move("next")
        there_are = ", ".join(dict.fromkeys(seen))
        raise BadWord(f"no event {wanted} in zone '{self._plan.zone}': there are {there_are}")

    def _move(self, command: str) -> None:
        """Go to the next or previous event; a core that goes meanwhile is waited for, and nothing is moved then."""
        try:
            self._link.command(command, self._plan.zone)
            self._settle()
        except NoCore as gone:
            self._note(f"waiting for the core: {gone}")
            self._until_heard()

    def _connect(self) -> None:
        self._attempt("connect", IDLE)
        zone = self._zone()
        if zone.phase == IDLE:
            raise _Failed(Exit.REFUSED, "the run was not begun: the core's log says why")
        if not self._began:
            raise _Failed(Exit.REFUSED, f"another referee was quicker: zone '{zone.zone}' is {zone.phase}")
        self._uuid = self._link.box.box_uuid

    def _start(self) -> bool:
        """Start the run and mark the scores; False: a restart of the core lost the run before it was started."""
        self._attempt("start", CONNECTED)
        phase = self._zone().phase
        if phase == IDLE and self._link.box.box_uuid != self._uuid:
            self._note("the core was restarted: connecting again")
            return False
        if phase == IDLE:
            raise _Failed(Exit.NOT_COMPLETED, self._how_it_went())
        for item, value in self._scores:
            self._mark(item, value)
        return True

    def _mark(self, item: Item, value: int) -> None:
        try:
            self._link.set_score(self._plan.zone, item.group, item.item, value)
        except (Refused, NoCore) as error:
            self._unmarked = f"; '{item.item}' was not set to {value}: {error}"
            self._note(self._unmarked[2:])

    def _attempt(self, command: str, phase: str) -> None:
        """Give a command as soon as it is allowed; returns once the zone is no longer in `phase`, or was
        not moved by the command."""
        deadline = self._link.now() + self._plan.wait_s
        told: Tuple[str, ...] = ()
        while self._zone().phase == phase:
            gone: Optional[NoCore] = None
            if phase == IDLE:
                self._began = False
                self._hold_event()
            reasons = tuple(self._zone().off[command])
            if not reasons:
                try:
                    self._began = True
                    self._link.command(command, self._plan.zone)
                    self._settle(with_details=True)
                    return
                except Refused as refused:
                    self._began = phase != IDLE
                    reasons = tuple(refused.reasons)  # it changed meanwhile
                except NoCore as error:
                    gone = error  # it may come back
                    reasons = ("the core does not answer",)
            for reason in news(told, reasons):
                self._note(f"waiting to {command}: {reason}")
            told = reasons
            left = deadline - self._link.now()
            if left <= 0:
                raise gone or Refused(list(reasons))
            self._step(min(left, STEP_S))

    def _hold_event(self) -> None:
        """Never connect for another event than the one meant: a core that was restarted may be at its first one."""
        if self._zone().event == self._event:
            return
        self._settle()  # the two topics of a core that begins may come one after the other
        event = self._zone().event
        if self._link.box.box_uuid == self._uuid:
            raise _Failed(Exit.REFUSED, f"another referee moved the zone to {event.code}/{event.round}/{event.run}")
        self._uuid = self._link.box.box_uuid
        self._go_to(EventWanted(self._event.code, self._event.round, self._event.run))

    def _resolve_scores(self) -> None:
        self._scores = []
        for word, text in self._plan.scores:
            item = pick_item(word, self._zone().score)
            self._scores.append((item, value_of(text, item)))

    def _to_the_end(self) -> Outcome:
        while self._zone().phase == RUNNING:
            self._step(STEP_S)
            if self._answers is not None and self._zone().phase == RUNNING:
                self._answers.look(self._zone())
        with contextlib.suppress(NoCore):  # the last lines and scores, if they come
            self._settle()
        zone = self._zone()
        if zone.phase != ENDED:
            raise _Failed(Exit.NOT_COMPLETED, self._how_it_went())
        if zone.end_reason == COMPLETED:
            status = Exit.REFUSED if self._unmarked else Exit.OK
            return self._leave(status, f"the run is completed{self._unmarked}")
        if zone.end_reason == STOPPED:
            # Who stopped it may want to start it again.
            return Outcome(Exit.NOT_COMPLETED, "stopped by another referee, and left connected for that one", zone)
        return self._leave(Exit.NOT_COMPLETED, f"the run did not complete: {zone.end_reason.replace('_', ' ')}")

    def _how_it_went(self) -> str:
        """Why there is no run any more, or not as we left it."""
        phase = self._zone().phase
        if phase != IDLE:
            return f"the run did not complete: another referee made it {phase}"
        if self._link.box.box_uuid != self._uuid:
            return "the run did not complete: it was lost when the core was restarted"
        return "the run did not complete: another referee disconnected it"

    # -- leaving ------------------------------------------------------------------------------------

    def _leave(self, status: Exit, text: str) -> Outcome:
        """Disconnect what we began, unless it is to be kept."""
        zone = self._link.box.zone(self._plan.zone)
        if zone is None or zone.phase == IDLE or not self._began:
            return Outcome(status, text)
        if self._plan.keep:
            return Outcome(status, f"{text}; left connected", zone)
        try:
            self._link.command("disconnect", self._plan.zone)
            self._settle()
        except Refused:
            pass  # another referee was quicker
        except NoCore as gone:
            return Outcome(status, f"{text}; it could not be disconnected: {gone}", zone)
        return Outcome(status, text, zone)

    def _interrupted(self) -> Outcome:
        """Ctrl-C: a referee's stop, if the run is ours and not over; a second Ctrl-C leaves at once."""
        text = "interrupted"
        try:
            if self._began:
                self._note("interrupted: leaving the run")
                with contextlib.suppress(NoCore):  # a core that only publishes nothing may still obey
                    self._settle()
                if self._zone().phase == RUNNING:
                    self._link.command("stop", self._plan.zone)
                    self._settle(with_details=True)
                    text = "interrupted, the run was stopped"
            return self._leave(Exit.INTERRUPTED, text)
        except KeyboardInterrupt:
            return Outcome(Exit.INTERRUPTED, f"interrupted twice{self._left_behind()}")
        except (Refused, NoCore, _Failed) as error:
            return Outcome(Exit.INTERRUPTED, f"interrupted, but {error}{self._left_behind()}")

    def _left_behind(self) -> str:
        return ": THE RUN MAY STILL BE GOING ON, look with 'referee status'" if self._began else ""

    # -- shared -------------------------------------------------------------------------------------

    def _zone(self) -> Zone:
        zone = self._link.box.zone(self._plan.zone)
        if zone is None:
            raise _Failed(Exit.NOT_COMPLETED, f"zone '{self._plan.zone}' is no longer in the schedule")
        return zone

    def _step(self, limit_s: float) -> None:
        for change in self._follower.step(limit_s):
            self._tell(change)
        if self._link.silence_s > GIVE_UP_S:
            raise NoCore(f"the core has been silent for {GIVE_UP_S:.0f} s: look at the launch on the box's computer")

    def _until_heard(self) -> None:
        """Go on once the core, which did not answer, publishes again."""
        self._step(STEP_S)  # what it said before is still to come in
        while self._link.silence_s > STEP_S:
            self._step(STEP_S)

    def _settle(self, with_details: bool = False) -> None:
        """Go on once what the last command did is published; `with_details`: see `Link.settle`."""
        self._link.settle(with_details)
        self._step(0.0)

    def _note(self, text: str) -> None:
        self._tell(Change(time.time(), "note", self._plan.zone, {"text": text}))
