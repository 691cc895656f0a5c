"""What the referee types: answers to manual operations and questions, and STOP. Manual operations may also be completed
automatically."""

import enum
import queue
import signal
import sys
import threading
import time
from typing import Callable, List, Optional

from roah_rsbb.model.actions import ACTIONS, Row
from roah_rsbb.model.fields import Choice
from roah_rsbb.model.reason import Refused
from roah_rsbb.model.zone import ZoneSeen
from roah_rsbb.referee.exits import NoCore
from roah_rsbb.referee.state import asked_in
from roah_rsbb.referee.stopping import TypedStops
from roah_rsbb.referee.words import BadWord, form_words, given_in, given_of, is_one_answer

# A module may repeat a request, for example when no pose is available. Wait before each repetition, and give up.
AGAIN_S = 1.0
MAX_IN_A_ROW = 10
# A program in the background of its terminal cannot read it. It looks again after this time.
BACKGROUND_S = 1.0
# What an empty line means while switches are asked for.
CONFIRM = ACTIONS["confirm_switches"].words

Note = Callable[[str], None]


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


class Keyboard:
    """Lines of standard input, read in the background. Use it in a `with` block.

    A line such as "stop", "stop all" or "stop Home A" stops at once, whatever the program waits for. It is no answer.
    At the end of the block, the program waits until each STOP has come to its robots.
    """

    def __init__(
        self, stops: TypedStops, at_end: Callable[[], None] = lambda: None, begin_s: float = 0.0,
        at_begin: Callable[[], None] = lambda: None,
    ) -> None:
        """`at_end` is called when the input has ended. If the block lasts longer than `begin_s` seconds, `at_begin` is
        called, and reading begins: what is typed before is for the shell."""
        self._stops = stops
        self._at_end = at_end
        self._begin_s = begin_s
        self._at_begin = at_begin
        self._is_over = threading.Event()
        self._read: queue.Queue = queue.Queue()
        self.is_terminal = sys.stdin.isatty()

    def __enter__(self) -> "Keyboard":
        if self.is_terminal:
            signal.signal(signal.SIGTTIN, signal.SIG_IGN)  # in the background, reading fails and does not suspend
        threading.Thread(target=self._work, name="keyboard", daemon=True).start()
        return self

    def __exit__(self, kind: Optional[type], *_error: object) -> None:
        self._is_over.set()
        if kind is not KeyboardInterrupt:
            self._stops.wait()

    @property
    def is_stopped(self) -> bool:
        """Whether a STOP was typed for the zone of this program, or for all zones."""
        return self._stops.of_own_zone

    def lines(self) -> List[str]:
        """Return what was typed since the last call."""
        found: List[str] = []
        while True:
            try:
                line = self._read.get_nowait()
            except queue.Empty:
                return found
            if line is None:
                self._at_end()
            else:
                found.append(line)

    def answer(self, ask: Callable[[], None]) -> str:
        """Ask, and wait for the next line; empty at the end of the input. Ask again after each STOP."""
        ask()
        self._stops.after = ask
        try:
            return self._read.get() or ""
        finally:
            self._stops.after = None

    def _work(self) -> None:
        if self._is_over.wait(self._begin_s):
            return
        self._at_begin()
        while True:
            try:
                line = sys.stdin.readline()
            except OSError:
                time.sleep(BACKGROUND_S)
                continue
            if not line:
                self._read.put(None)
            elif not self._stops.take(line):
                self._read.put(line.strip())
            self._stops.wake()
            if not line:
                return
