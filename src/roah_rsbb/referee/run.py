"""A whole run by script: choose the event, connect, start, follow the run to its end, disconnect.

The script knows no rule of the game. It waits until the core allows the next step, and shows the core's reasons.
The script only touches its own run. It learns the run's identity after *connect*, and it stops and disconnects by
identity. It never disconnects a running robot, and never a run that may be another referee's.
"""

import contextlib
import enum
import time
from typing import Any, Callable, Dict, List, NamedTuple, Optional, Tuple, Union

from roah_rsbb.model.actions import ACTIONS, Row
from roah_rsbb.model.fields import Choice
from roah_rsbb.model.reason import Refused
from roah_rsbb.model.scoring import Entered
from roah_rsbb.model.zone import CONNECTED, ENDED, IDLE, RUNNING, SheetItem, ZoneSeen
from roah_rsbb.referee.at_once import ANSWER_S, Exit, NoCore
from roah_rsbb.referee.state import BoxFollower, Change, asked_in, news
from roah_rsbb.referee.stopping import Keyboard
from roah_rsbb.referee.words import (
    GIVE_AGAIN,
    BadWord,
    EventWanted,
    form_words,
    given_in,
    given_of,
    is_one_answer,
    pick_item,
    to_confirm,
    value_of,
)
from roah_rsbb.wording.sheets import END_REASONS
from roah_rsbb.wording.stop import NOT_DELIVERED_S, Way, leaving, way_text

COMPLETED, STOPPED = "completed", "stopped"  # Zone.end_reason
# A core that crashed is restarted within seconds. After this long without it, the script gives up.
GIVE_UP_S = 60.0
STEP_S = 1.0
# A module may repeat a request, for example when no pose is available. Wait before each repetition, and give up.
AGAIN_S = 1.0
MAX_IN_A_ROW = 10
# What an empty line means while switches are asked for.
CONFIRM = ACTIONS["confirm_switches"].words

Note = Callable[[str], None]


# -- manual operations: completed automatically, or with what the referee types -------------------


class Operations(enum.Enum):
    """Who does manual operations during the run."""

    OTHERS = "others"  # at a panel, or with 'referee done'
    AUTOMATIC = "automatic"
    TYPED = "typed"


class GivenUp(Exception):
    """The operation needs a human referee."""


class AutomaticAnswers:
    """Completes each manual operation with its first answer, and confirms switches without changes."""

    def __init__(self, link, note: Note) -> None:
        self._link = link
        self._note = note
        self._done = 0  # number of the last operation
        self._text = ""  # of the last operation
        self._in_a_row = 0
        self._not_before = 0.0

    def look(self, zone: ZoneSeen) -> None:
        """Complete what a running zone requests. Raises `GivenUp`."""
        if zone.operation and zone.operation != self._done:
            self._complete(zone)
        if zone.switches is not None and zone.switches.to_confirm:
            _ignoring_others(lambda: self._link.act("confirm_switches", zone.zone))

    def _complete(self, zone: ZoneSeen) -> None:
        text, now_s = zone.manual_operation, self._link.here_s()
        again = text == self._text
        if again and now_s < self._not_before:
            return
        if again and self._in_a_row >= MAX_IN_A_ROW:
            raise GivenUp(f"asked {self._in_a_row} times in a row: {text}")
        needed = [field.label for field in asked_in(zone) if field.required and not isinstance(field, Choice)]
        if needed:
            raise GivenUp(f"{text}: it needs answers: {', '.join(needed)}")
        given = {"operation": zone.operation}
        if not _ignoring_others(lambda: self._link.act("operation", zone.zone, given)):
            return
        self._note(f"completed without a human referee: {text}")
        self._in_a_row = self._in_a_row + 1 if again else 1
        self._done, self._text, self._not_before = zone.operation, text, now_s + AGAIN_S


class Typed:
    """Asks in the terminal. `lines` returns what was typed since its last call, without waiting.

    `ahead`: lines typed before a question answer it. Scripts do this; a human's earlier lines are not answers.
    """

    def __init__(self, link, note: Note, lines: Callable[[], List[str]], ahead: bool) -> None:
        self._link = link
        self._note = note
        self._lines = lines
        self._ahead = ahead
        self._asked: Optional[object] = None
        self._done: Optional[object] = None  # the completed request, which the zone shows a moment longer
        self._typed: List[str] = []

    def look(self, zone: ZoneSeen) -> None:
        """Show what a running zone requests, and pass on what was typed."""
        self._typed += self._lines()
        asked = _asked(zone)
        if asked != self._done:
            self._done = None
        if asked is None or self._done is not None:
            self._asked = None
        elif asked != self._asked:
            self._asked = asked
            self._note(_prompt(zone))
        elif self._typed:
            self._take(zone, asked, self._typed.pop(0))
            return
        if not self._ahead:
            self._typed.clear()

    def _take(self, zone: ZoneSeen, asked: object, line: str) -> None:
        try:
            if zone.operation:
                given = given_in(line, asked_in(zone))
                self._link.act("operation", zone.zone, {"operation": zone.operation, **given})
                self._done = asked
            elif self._enter(zone, line):
                self._done = asked
        except (BadWord, Refused, NoCore) as error:
            self._note(f"not done: {error}")
            self._asked = None  # ask again

    def _enter(self, zone: ZoneSeen, line: str) -> bool:
        """Do an action of the module's row. Return whether the switches are confirmed."""
        word, *words = line.split() or [CONFIRM]
        action = next((one for one in ACTIONS.values() if one.row is Row.MODULE and one.words == word), None)
        if action is None:
            raise BadWord(f"'{word}' is not asked for")
        self._link.act(action.name, zone.zone, given_of(words, action.fields))
        return word == CONFIRM


def _asked(zone: ZoneSeen) -> Optional[object]:
    """Return the referee's current request in a form that can be compared."""
    if zone.operation:
        return zone.operation, zone.manual_operation, asked_in(zone)
    return "switches" if zone.switches is not None and zone.switches.to_confirm else None


def _prompt(zone: ZoneSeen) -> str:
    if not zone.operation:
        return "type 'switch NUMBER' for each switch that changed, 'damaged NUMBER', and an empty line to confirm"
    fields = asked_in(zone)
    if not fields:
        return "press Enter when it is done"
    if not is_one_answer(fields):
        return f"type a value for each, in this order or as NAME=VALUE: {form_words(fields)}"
    usual = fields[0].choices[0] if isinstance(fields[0], Choice) else "" if fields[0].required else "none"
    return f"type {form_words(fields)}{usual and f' (Enter: {usual})'}"


def _ignoring_others(job: Callable[[], None]) -> bool:
    """Return whether the job was done. Another referee may be quicker, and a core that restarts asks again."""
    try:
        job()
    except (Refused, NoCore):
        return False
    return True


# -- the run ------------------------------------------------------------------------------------------

_ANSWERS: Dict[Operations, Callable[[Any, Note, Optional[Keyboard]], Union[AutomaticAnswers, Typed, None]]] = {
    Operations.OTHERS: lambda link, note, keyboard: None,
    Operations.AUTOMATIC: lambda link, note, keyboard: AutomaticAnswers(link, note),
    Operations.TYPED: lambda link, note, keyboard: Typed(link, note, keyboard.lines, ahead=not keyboard.is_terminal),
}


class ScriptPlan(NamedTuple):
    """The run that the referee wants."""

    zone: str
    wait_s: float  # for connect to be possible, and again for start
    event: Optional[EventWanted] = None
    scores: Tuple[Tuple[str, str], ...] = ()  # item and value, as typed
    keep: bool = False
    operations: Operations = Operations.OTHERS
    robot: str = ""  # name of the team's robot to connect; empty: the core chooses one
    again: bool = False  # another attempt at an event that is signed off


class ScriptOutcome(NamedTuple):
    """How the script ended."""

    status: Exit
    text: str
    zone: Optional[ZoneSeen] = None  # before the disconnect; None: there was no run


class _Own(enum.IntEnum):
    """How far the script's own run has come."""

    NONE = 0
    CONNECTING = 1  # a connect was sent, and not answered
    CONNECTED = 2
    STARTING = 3  # a start was sent, and not answered
    STARTED = 4


class _Failed(Exception):
    """The script cannot continue."""

    def __init__(self, status: Exit, text: str) -> None:
        super().__init__(text)
        self.status = status


class RunScript:
    """One run. `link` is an open Link; `report` gets every change; without a keyboard nothing is typed."""

    def __init__(
        self, link, plan: ScriptPlan, report: Callable[[Change], None], keyboard: Optional[Keyboard] = None
    ) -> None:
        self._link = link
        self._keyboard = keyboard
        self._answers = _ANSWERS[plan.operations](link, self._note, keyboard)
        self._plan = plan
        self._report = report
        self._follower = BoxFollower(link, plan.zone)
        self._own = _Own.NONE
        self._run = ""  # identity of the run; empty: not known yet
        self._is_sure = True  # the run is not another referee's
        self._event = self._zone().event
        self._uuid = self._follower.box.box.uuid  # of the core that has our run
        self._scores: List[Tuple[SheetItem, Entered]] = []  # to be set
        self._unmarked = ""  # why a score could not be set

    def run(self) -> ScriptOutcome:
        """Run the script to its end. Ctrl-C (KeyboardInterrupt) stops the run and leaves it."""
        try:
            self._prepare()
            while True:
                outcome = self._STEPS[self._shown()](self)
                if outcome is not None:
                    return outcome
        except _Failed as failed:
            return self._leave(failed.status, str(failed))
        except Refused as refused:
            return self._leave(Exit.REFUSED, f"refused: {refused}")
        except BadWord as bad:
            return self._leave(Exit.USAGE, str(bad))
        except GivenUp as given_up:
            return self._stop_and_leave(f"the run did not complete: {given_up}")
        except NoCore as gone:
            return ScriptOutcome(Exit.NO_CORE, f"{gone}{self._left_behind()}")
        except KeyboardInterrupt:
            return self._interrupted()

    # -- before the run -----------------------------------------------------------------------------

    def _prepare(self) -> None:
        zone = self._zone()
        if zone.phase != IDLE:
            raise _Failed(Exit.REFUSED, f"a run is in zone '{zone.zone}' already ({zone.phase}): disconnect it first")
        self._event = zone.event
        event = self._event.id if self._plan.event is None else self._found(self._plan.event)
        items = self._link.run_sheet(self._plan.zone, "", event).items if self._plan.scores else ()
        for word, text in self._plan.scores:
            item = items[pick_item(word, items) - 1]
            self._scores.append((item, value_of(text, item)))
        self._go_to(event)

    def _found(self, wanted: EventWanted) -> str:
        """Return the id of an event: the next one that fits, from the zone's on, else the last one before."""
        events = [event for event in self._follower.box.events() if event.zone == self._plan.zone]
        at = next((place for place, event in enumerate(events) if event.current), 0)
        for event in [*events[at:], *reversed(events[:at])]:
            if wanted.fits(event):
                if event.signed_utc_s is not None and not event.current and not self._plan.again:
                    raise Refused([f"{wanted} is signed off. {GIVE_AGAIN}"])
                return event.id
        seen = [EventWanted(event.code, event.round, event.run, event.team if wanted.team else "") for event in events]
        raise BadWord(f"no event {wanted} in zone '{self._plan.zone}': there are "
                      + ", ".join(dict.fromkeys(map(str, seen))))

    def _go_to(self, event: str) -> None:
        """Go to the event of that id. If the core does not answer, wait for it."""
        while self._zone().event.id != event:
            try:
                self._link.act("choose_event", self._plan.zone, {"event": event, "unsigned": True})
            except NoCore as gone:
                self._note(f"waiting for the box: {gone}")
                self._wait(GIVE_UP_S, self._is_heard_after(self._link.here_s()))
            self._settle()
        self._event = self._zone().event

    # -- the steps: each returns the outcome, or None for the next step -------------------------------

    def _connect(self) -> None:
        if self._attempt("connect", _Own.CONNECTING):
            if self._zone().phase == IDLE:
                raise _Failed(Exit.REFUSED, "the run did not begin: see the box's log")
            self._take(is_sure=True)

    def _take(self, is_sure: bool = False) -> None:
        """Take the run that has come into the zone as the script's own."""
        zone = self._zone()
        if self._own is _Own.NONE:
            raise _Failed(Exit.REFUSED, f"another referee was quicker: zone '{zone.zone}' is {zone.phase}")
        self._own, self._is_sure = _Own.CONNECTED, is_sure
        self._run, self._uuid = zone.identity, self._follower.box.box.uuid

    def _start(self) -> None:
        if self._own is _Own.STARTED:
            raise _Failed(Exit.NOT_COMPLETED, f"the run did not complete: it is {CONNECTED} again")
        if self._attempt("start", _Own.STARTING):
            self._own = _Own.STARTED

    def _play(self) -> None:
        self._mark()
        if self._is_stopped():  # typed while the start was on its way: the start may have come later
            with contextlib.suppress(Refused, NoCore):
                self._link.stop_run(self._plan.zone, self._run)
        self._step(STEP_S)
        if self._answers is not None and self._shown() == (True, RUNNING):
            self._answers.look(self._zone())

    def _mark(self) -> None:
        """Set the scores, now that the run has been started."""
        self._own = _Own.STARTED
        while self._scores:
            item, value = self._scores.pop(0)
            try:
                self._link.mark(self._plan.zone, self._run, item, value)
            except (Refused, NoCore) as error:
                self._unmarked = f"; '{item.desc}' = {value.added or value.text or value.value} failed: {error}"
                self._note(self._unmarked[2:])

    def _end(self) -> ScriptOutcome:
        self._mark()
        zone = self._zone()
        if zone.end_reason == COMPLETED:
            status = Exit.REFUSED if self._unmarked else Exit.OK
            return self._leave(status, f"the run is completed{self._unmarked}")
        if zone.end_reason == STOPPED:
            # Whoever stopped it may want to start it again.
            text = ("stopped, and left connected" if self._is_stopped()
                    else "stopped by another referee, and left connected for that one")
            return ScriptOutcome(Exit.NOT_COMPLETED, text, zone)
        return self._leave(Exit.NOT_COMPLETED, f"the run did not complete: {END_REASONS[zone.end_reason]}")

    def _lose(self) -> None:
        """Connect again, if a restart of the core has lost the run before it was started."""
        if self._zone().phase != IDLE or self._follower.box.box.uuid == self._uuid:
            raise _Failed(Exit.NOT_COMPLETED, "the run did not complete: another referee disconnected it")
        if self._own is _Own.STARTED:
            raise _Failed(Exit.NOT_COMPLETED, "the run did not complete: it was lost when the box was restarted")
        self._note("the box was restarted: connecting again")
        self._run, self._own = "", _Own.NONE

    # By whether the zone shows our run (None: there is none yet), and by its phase.
    _STEPS: Dict[Tuple[Optional[bool], str], Callable[["RunScript"], Optional[ScriptOutcome]]] = {
        (None, IDLE): _connect,
        **dict.fromkeys(((None, CONNECTED), (None, RUNNING), (None, ENDED)), _take),
        (True, CONNECTED): _start,
        (True, RUNNING): _play,
        (True, ENDED): _end,
        **dict.fromkeys(((False, IDLE), (False, CONNECTED), (False, RUNNING), (False, ENDED)), _lose),
    }

    def _shown(self) -> Tuple[Optional[bool], str]:
        zone = self._zone()
        return zone.identity == self._run if self._run else None, zone.phase

    def _attempt(self, command: str, asked: _Own) -> bool:
        """Give a command as soon as it is allowed; `asked`: how far the run has come then. Returns True once the core
        carried it out, or False as soon as the zone is another one's, or in another phase."""
        shown = self._shown()
        deadline = self._link.here_s() + self._plan.wait_s
        known: Tuple[str, ...] = ()
        while self._shown() == shown:
            question = () if self._plan.again else to_confirm(self._zone().action(command))
            if question:
                raise Refused(list(question))
            if self._is_stopped():
                raise _Failed(Exit.NOT_COMPLETED, "stopped before the run began")
            gone: Optional[NoCore] = None
            if not self._run:
                self._hold_event()
            reasons = tuple(self._zone().off(command))
            if not reasons:
                try:
                    self._give(command, asked)
                except Refused as refused:
                    reasons = tuple(refused.reasons)  # the zone changed since the snapshot
                except NoCore as error:
                    gone = error  # the core may come back
                    reasons = ("the box does not answer",)
                else:
                    self._settle()
                    return True
            for reason in news(known, reasons):
                self._note(f"waiting to {command}: {reason}")
            known = reasons
            left = deadline - self._link.here_s()
            if left <= 0:
                raise gone or Refused(list(reasons))
            self._step(min(left, STEP_S))
        return False

    def _hold_event(self) -> None:
        """Check that the zone is still at the wanted event: a restarted core may be at its first event."""
        if self._zone().event == self._event:
            return
        event = self._zone().event
        if self._follower.box.box.uuid == self._uuid:
            raise _Failed(Exit.REFUSED, f"another referee moved the zone to {event.code}/{event.round}/{event.run}")
        self._uuid = self._follower.box.box.uuid
        self._go_to(self._event.id)

    def _give(self, command: str, asked: _Own) -> None:
        given = {"robot": self._plan.robot, "again": self._plan.again} if command == "connect" else {}
        before, self._own = self._own, asked
        try:
            self._link.act(command, self._plan.zone, {name: value for name, value in given.items() if value})
        except Refused:
            self._own = before
            raise

    # -- leaving ------------------------------------------------------------------------------------

    def _leave(self, status: Exit, text: str, wait_s: float = GIVE_UP_S) -> ScriptOutcome:
        """Disconnect our run, unless the plan keeps it. If the core is down, wait for it. A run whose robots do not
        stop stays connected: after the disconnect the box would not repeat STOP."""
        zone = self._our_zone()
        if zone is None:
            return ScriptOutcome(status, text)
        if self._plan.keep:
            return ScriptOutcome(status, f"{text}; left connected", zone)
        unsure = Exit.NO_CORE if status is Exit.OK else status
        if not self._is_sure:
            return ScriptOutcome(
                unsure, f"{text}; left connected: the box did not confirm the connect, so the run may be another "
                "referee's", zone,
            )
        try:
            self._wait(NOT_DELIVERED_S, lambda: not self._moving())
            if self._moving():
                lost = way_text(Way.LOST_ROBOT, zone.zone)
                return ScriptOutcome(
                    unsure, f"{text}; left connected\n{lost}\n{', '.join(self._moving())}", self._our_zone())
            return ScriptOutcome(status, text + self._disconnect(wait_s), zone)
        except NoCore as gone:
            return ScriptOutcome(unsure, f"{text}; it could not be disconnected: {gone}", zone)

    def _moving(self) -> Tuple[str, ...]:
        """Return the robots that do not report STOP after the end of our run."""
        zone = self._our_zone()
        return zone.not_stopped if zone is not None and leaving(zone) else ()

    def _disconnect(self, wait_s: float) -> str:
        """Return why the run stays connected; empty: it was left. Raises `NoCore`."""
        deadline = self._link.here_s() + wait_s
        is_waiting, kept = False, ""
        while True:
            try:
                self._link.act("disconnect", self._plan.zone, run=self._run)
            except Refused as refused:
                kept = f"; left connected: {refused}"
            except NoCore as gone:
                if self._link.here_s() >= deadline:
                    raise
                if not is_waiting:
                    self._note(f"waiting to disconnect: {gone}")
                is_waiting = True
                self._wait(STEP_S)
                continue
            with contextlib.suppress(NoCore):
                self._settle()
            return "" if self._our_zone() is None else kept

    def _stop_and_leave(self, text: str) -> ScriptOutcome:
        """Stop and leave our run, which is still running."""
        try:
            self._link.stop_run(self._plan.zone, self._run)
            self._settle()
        except (Refused, NoCore) as error:
            return ScriptOutcome(Exit.NOT_COMPLETED, f"{text}; it could not be stopped: {error}{self._left_behind()}")
        return self._leave(Exit.NOT_COMPLETED, text)

    def _is_stopped(self) -> bool:
        return self._keyboard is not None and self._keyboard.is_stopped

    def _interrupted(self) -> ScriptOutcome:
        """Handle Ctrl-C: stop our run unless it is over, and leave it. A second Ctrl-C ends the script at once."""
        text = "interrupted"
        try:
            if self._own is not _Own.NONE:
                self._note("interrupted: leaving the run")
                with contextlib.suppress(NoCore):  # a core that publishes nothing may still obey
                    self._settle()
                if not self._run and self._zone().phase != IDLE:
                    self._take()
                # A STOP before the effect of a start would be refused, and the robot would start after that.
                self._wait(ANSWER_S, lambda: self._own < _Own.STARTING or self._zone().phase != CONNECTED)
                if self._shown() == (True, RUNNING):
                    self._link.stop_run(self._plan.zone, self._run)
                    self._settle()
                    text = "interrupted, the run was stopped"
            return self._leave(Exit.INTERRUPTED, text, wait_s=0.0)
        except KeyboardInterrupt:
            return ScriptOutcome(Exit.INTERRUPTED, f"interrupted twice{self._left_behind()}")
        except (Refused, NoCore, _Failed) as error:
            return ScriptOutcome(Exit.INTERRUPTED, f"interrupted, but {error}{self._left_behind()}")

    def _left_behind(self) -> str:
        may_run = self._own is not _Own.NONE
        return ": THE RUN MAY STILL BE RUNNING, check with 'referee status'" if may_run else ""

    # -- shared -------------------------------------------------------------------------------------

    def _zone(self) -> ZoneSeen:
        zone = self._follower.box.zones.get(self._plan.zone)
        if zone is None:
            raise _Failed(Exit.NOT_COMPLETED, f"zone '{self._plan.zone}' is no longer in the schedule")
        return zone

    def _our_zone(self) -> Optional[ZoneSeen]:
        """Return the zone while it shows our run."""
        zone = self._follower.box.zones.get(self._plan.zone)
        return zone if zone is not None and self._run and zone.identity == self._run else None

    def _step(self, limit_s: float) -> None:
        for change in self._follower.step(limit_s):
            self._report(change)
        if self._link.silence_s > GIVE_UP_S:
            raise NoCore(f"the box has been silent for {GIVE_UP_S:.0f} s: check the launch on the box's computer")

    def _is_heard_after(self, moment_s: float) -> Callable[[], bool]:
        return lambda: self._link.here_s() - self._link.silence_s > moment_s

    def _wait(self, limit_s: float, is_over: Callable[[], bool] = lambda: False) -> None:
        deadline = self._link.here_s() + limit_s
        while not is_over() and self._link.here_s() < deadline:
            self._step(min(deadline - self._link.here_s(), STEP_S))

    def _settle(self) -> None:
        """Wait for the effect of the last command, and report it."""
        self._link.settle()
        self._step(0.0)

    def _note(self, text: str) -> None:
        self._report(Change(time.time(), "note", self._plan.zone, {"text": text}))
