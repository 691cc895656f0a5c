"""A STOP from the terminal, and the keyboard on which it is typed (docs/referee.md, "STOP in the terminal").

A STOP waits for no other call, and no other zone: the client has a connection and a thread for it. It is sent until the
core answers. Then it is followed until the robots report STOP.
"""

import contextlib
import queue
import signal
import sys
import threading
import time
from typing import TYPE_CHECKING, Any, Callable, Dict, List, NamedTuple, Optional, Sequence, Tuple

from roah_rsbb.document.document import Followed
from roah_rsbb.model.as_json import BadData
from roah_rsbb.model.document import Document
from roah_rsbb.model.reason import decode
from roah_rsbb.model.zone import ENDED, RUNNING, ZoneSeen
from roah_rsbb.referee.at_once import EarlyStop, Exit, is_all
from roah_rsbb.referee.words import STOPS, BadWord, pick_zone, stop_wanted
from roah_rsbb.wording.stop import DONE, LOST, NOT_DELIVERED_S, Way, way, way_text
from roah_rsbb.wording.texts import nearest

if TYPE_CHECKING:
    from roah_rsbb.client.client import Answer

# How often the way is looked at while nothing happens.
STEP_S = 1.0
# A STOP is sent until the box has it, or the program ends.
FOREVER_S = 1e9
# A program in the background of its terminal cannot read it. It looks again after this time.
BACKGROUND_S = 1.0
# Named in a line while no zone is known.
ALL_ZONES, THE_RUN = "all zones", "the run"
STOP_HINT = "type 'stop' to stop the run, 'stop all' to stop the runs of all zones"
STOP_HINT_ALL = "type 'stop ZONE' to stop a run, 'stop all' to stop the runs of all zones"


class StopLine(NamedTuple):
    """How far the STOP of a zone came. Its fields are those of the JSON output."""

    zone: str
    way: str
    text: str
    not_stopped: Tuple[str, ...] = ()  # robots that do not report STOP
    trouble: str = ""  # why it is not delivered or not recorded, or why nothing is heard of the robot, with the remedy

    @property
    def is_lost(self) -> bool:
        """Whether the referee must stop the robot by hand."""
        return Way(self.way) in LOST


class ZoneStop:
    """The STOP of one zone: what is known of it."""

    def __init__(self, zone: str, sent_s: float, before: Optional[ZoneSeen] = None) -> None:
        """`sent_s`: monotonic time; `before`: the zone as it was then."""
        self.zone = zone
        self.is_sent = False
        self.sent_s = sent_s
        self.before = before
        self.answered_s: Optional[float] = None  # when the core answered, monotonic; None: it did not yet
        self.number = 0  # of the document that shows the effect
        self.refused: Tuple[str, ...] = ()
        self.after: Optional[ZoneSeen] = None
        self.trouble = self.unsaved = ""

    def send(self, link: Any) -> None:
        """Send it until the core answers."""
        def take(answer: "Answer") -> None:
            self.take(answer)
            link.wake()

        self.is_sent = True
        link.stop(self.zone, "", take, FOREVER_S, node=link.node, by=link.referee)

    def take(self, answer: "Answer") -> None:
        """Take the core's answer."""
        self.is_sent = True
        self.refused, self.number = tuple(answer.reasons), answer.number
        if answer.is_answered and not answer.reasons:
            self.answered_s = time.monotonic()
            self.unsaved = decode(answer.answer.get("unsaved", "")) if isinstance(answer.answer, dict) else ""

    def look(self, link: Any) -> None:
        """Look at the document, if it shows the effect of the STOP."""
        self.trouble = link.trouble
        if self.refused or not self.has_answer or not link.is_confirmed(self.number) or link.document is None:
            return
        moving = () if self.after is None else self.after.not_stopped
        self.after = link.document.zones.get(self.zone)
        if self.after is None:
            self.refused = (f"zone '{self.zone}' is no longer in the schedule",)
        elif self.after.phase not in (RUNNING, ENDED) and moving:
            self.refused = (f"the run was left before {', '.join(moving)} answered STOP: stop by hand",)
        elif self.after.phase not in (RUNNING, ENDED):
            self.refused = self.after.off("stop") or ("no run is in progress",)

    @property
    def since_s(self) -> float:
        """From when the time counts, monotonic."""
        return self.sent_s if self.after is not None or self.answered_s is None else self.answered_s

    @property
    def has_answer(self) -> bool:
        """Whether the core has answered."""
        return self.answered_s is not None

    @property
    def was_running(self) -> bool:
        """Whether this STOP concerns a run: one in progress, or one that began before the STOP arrived."""
        before = "" if self.before is None else self.before.phase
        return before == RUNNING or (self.after is not None and self.after.phase == ENDED != before)

    @property
    def is_over(self) -> bool:
        """Whether nothing more is to be done."""
        return bool(self.refused) or Way(self.line(float("inf")).way) in DONE

    def line(self, now_s: float) -> StopLine:
        """Return how far it came. A robot is judged by what the core has published since its answer. While none of
        this has come, the time counts from the answer."""
        after = self.after
        where = way(now_s - self.since_s, self.has_answer, after)
        robots = () if after is None or where in DONE else after.not_stopped
        known = after or self.before
        text = way_text(where, self.zone, known is not None and not known.by_hand)
        return StopLine(self.zone, where.value, text, robots,
                        self.trouble if after is None and where in LOST else self.unsaved)

    def status(self) -> Exit:
        """Return the exit status if it ends now."""
        if self.refused:
            return Exit.REFUSED
        return Exit.OK if self.is_over else Exit.NOT_COMPLETED if self.has_answer else Exit.NO_CORE


class Stopping:
    """A STOP of one zone, or of all zones."""

    def __init__(
        self, link: Any, word: str, report: Callable[[StopLine], None], own_zone: str = "",
        before: Optional[Document] = None, sent: Optional[EarlyStop] = None,
    ) -> None:
        """`link`: a `link.Link` that was started; it need not be open. `word` names the zone, or all; empty:
        `own_zone`, or else the only run in progress. `report` takes each new line. `before`: the box as it is, if that
        is known. `sent`: what was sent of it already."""
        self._link = link
        self._word = word
        self.is_all = is_all(word)  # as far as is known
        self._report = report
        self._own_zone = own_zone
        self._before = before
        self._begun_s = time.monotonic() if sent is None else sent.sent_s
        self._answers: Dict[str, Answer] = {}
        self._zones: Optional[List[ZoneStop]] = None  # None: not known yet
        # In case a zone has exactly this name, it is sent before the zones are known.
        name = "" if self.is_all else word or own_zone
        self._shown: Dict[str, StopLine] = {}
        self._named = ZoneStop(name or (ALL_ZONES if self.is_all else THE_RUN), self._begun_s)
        if sent is not None:
            from roah_rsbb.client.client import answer_of  # late: help, and completion in bash, need no connection

            self._answers = {zone: answer_of(one) for zone, one in sent.answers.items()}
            followed = Followed(Document)
            with contextlib.suppress(BadData):  # the link says the remedy
                followed.take(sent.first)
                self._before = followed.document
        if name and not self._answers:
            self._named.send(link)

    def run(self) -> None:
        """Stop. Returns when all robots have stopped, or the core has refused it. Raises `BadWord` for an unknown zone.
        KeyboardInterrupt ends it."""
        news = self._link.news
        while True:
            box = self._link.document or (self._before if self._answers else None)
            if self._zones is None and box is not None:
                self._zones = self._begun(box)
            for one in self._zones if self._zones is not None else [self._named]:
                one.look(self._link)
            self._show()
            if self._is_over():
                return
            news = self._link.wait_news(news, self._step_s())

    def _begun(self, box: Document) -> List[ZoneStop]:
        """Begin to stop each zone."""
        before = self._before or box
        found = []
        for name in self._names(box):
            one = self._named if self._named.is_sent and name == self._named.zone else ZoneStop(name, self._begun_s)
            one.before = before.zones.get(name)
            if name in self._answers:
                one.take(self._answers[name])
            elif not one.is_sent:
                one.send(self._link)
            found.append(one)
        return found

    def _step_s(self) -> float:
        """Return until when nothing is lost by the time that passes."""
        now_s = time.monotonic()
        moments = [one.since_s + NOT_DELIVERED_S - now_s for one in self._zones or [self._named]]
        return min([STEP_S, *(left for left in moments if left > 0.0)])

    def _is_over(self) -> bool:
        """Whether all robots have stopped. Where all zones are stopped, others only show that they had nothing to
        stop: a robot of an earlier run may be gone for good."""
        found = self.result()
        return self._zones is not None and all(
            one.is_over or (one not in found and one.after is not None) for one in self._zones)

    def result(self) -> List[ZoneStop]:
        """Return the zones that it concerns."""
        return [one for one in self._zones or () if not self.is_all or one.was_running]

    def status(self) -> Exit:
        """Return the exit status if it ends now: that of the zone that came least far."""
        if self._zones is None:
            return Exit.NO_CORE
        found = [one.status() for one in self.result()]
        return next((one for one in (Exit.NO_CORE, Exit.NOT_COMPLETED, Exit.REFUSED) if one in found), Exit.OK)

    def _show(self) -> None:
        now_s = time.monotonic()
        if self._zones is None:
            lines = [line for line in [self._named.line(now_s)] if line.is_lost]
        else:
            lines = [one.line(now_s) for one in self.result() if not one.refused]
        for line in lines:
            if self._shown.get(line.zone) != line:
                self._shown[line.zone] = line
                self._report(line)

    def _names(self, box: Document) -> Sequence[str]:
        """Return the zones to stop. Where all are stopped, the core decides which of them have a run in progress."""
        names = list(box.box.zones)
        self.is_all = is_all(self._word, names)
        if self.is_all:
            return names
        if self._word or self._own_zone:
            return [pick_zone(self._word or self._own_zone, names)]
        running = [zone.zone for zone in box.zones.values() if zone.phase == RUNNING]
        if len(running) != 1:
            raise BadWord(f"{len(running) or 'no'} runs are in progress: type 'stop ZONE', or 'stop all'")
        return running


class Keyboard:
    """Lines of standard input, read in the background. Use it in a `with` block.

    A line such as "stop", "stop all" or "stop Home A" stops at once, in a thread of its own, whatever the program waits
    for. It is no answer. At the end of the block, the program waits until each STOP has come to its robots.
    """

    def __init__(
        self, link: Any, report: Callable[[StopLine], None], note: Callable[[str], None], own_zone: str = "",
        has_answers: bool = True, at_end: str = "", begin_s: float = 0.0,
    ) -> None:
        """`link`: see `Stopping`. `note` shows why a STOP was not sent, `at_end` when the input has ended, and how STOP
        is typed. `own_zone` is the zone of a "stop" without one. `has_answers`: whether other lines may be answers to
        questions. If the block lasts longer than `begin_s`, that is shown, and reading begins: what is typed before is
        for the shell."""
        self._link = link
        self._report = report
        self._note = note
        self._own_zone = own_zone
        self._has_answers = has_answers
        self._at_end = at_end
        self._begin_s = begin_s
        self._after: Optional[Callable[[], None]] = None  # called after each STOP
        self._stops: List[threading.Thread] = []
        self._starting = threading.Lock()  # each of them is waited for, and none before it begins
        self._is_over = threading.Event()
        self._read: queue.Queue = queue.Queue()
        self.is_terminal = sys.stdin.isatty()
        self.is_stopped = False  # a STOP was typed for the zone of this program, or for all zones

    def __enter__(self) -> "Keyboard":
        if self.is_terminal:
            signal.signal(signal.SIGTTIN, signal.SIG_IGN)  # in the background, reading fails and does not suspend
        threading.Thread(target=self._work, name="keyboard", daemon=True).start()
        return self

    def __exit__(self, kind: Optional[type], *_error: object) -> None:
        self._is_over.set()
        if kind is not KeyboardInterrupt:
            self.wait()

    def show_hint(self) -> None:
        """Show how STOP is typed."""
        self._note(self._hint)

    def wait(self) -> None:
        """Wait until all robots have stopped."""
        with self._starting:
            stops = list(self._stops)
        for thread in stops:
            thread.join()

    def lines(self) -> List[str]:
        """Return what was typed since the last call."""
        found: List[str] = []
        with contextlib.suppress(queue.Empty):
            while True:
                line = self._read.get_nowait()
                if line is not None:
                    found.append(line)
                elif self._at_end:
                    self._note(self._at_end)
        return found

    def answer(self, ask: Callable[[], None]) -> str:
        """Ask, and wait for the next line; empty at the end of the input. Ask again after each STOP."""
        ask()
        self._after = ask
        try:
            return self._read.get() or ""
        finally:
            self._after = None

    def take(self, line: str) -> bool:
        """Whether the line is a STOP, which has begun then."""
        word = stop_wanted(line)
        if word is None:
            typed = line.strip()
            is_like_stop = nearest(typed.partition(" ")[0], STOPS) is not None
            if typed and (is_like_stop or not self._has_answers):
                self._note(f"{'NOT STOPPED: ' if is_like_stop else ''}'{typed}' is no command: {self._hint}")
            return False
        if is_all(word) or self._own_zone.casefold().startswith(word.casefold()):
            self.is_stopped = True
        # The program may stop its own run itself before the STOP has looked at the zones.
        stopping = Stopping(self._link, word, self._report, self._own_zone, self._link.document)
        thread = threading.Thread(target=self._stop, args=(stopping,), name="typed stop", daemon=True)
        with self._starting:
            self._stops.append(thread)
            thread.start()
        return True

    @property
    def _hint(self) -> str:
        return STOP_HINT if self._own_zone else STOP_HINT_ALL

    def _stop(self, stopping: Stopping) -> None:
        try:
            stopping.run()
            for one in stopping.result():
                if one.refused:
                    self._note(f"stop {one.zone} was refused: {'; '.join(one.refused)}")
            if not stopping.result():
                self._note("no run is in progress")
        except BadWord as bad:
            self._note(f"NOT STOPPED: {bad}")
        after = self._after
        if after is not None:
            after()

    def _work(self) -> None:
        if self._begin_s:
            if self._is_over.wait(self._begin_s):
                return
            self.show_hint()
        line = "?"
        while line:
            try:
                line = sys.stdin.readline()
            except OSError:
                time.sleep(BACKGROUND_S)
                continue
            if not line:
                self._read.put(None)
            elif not self.take(line):
                self._read.put(line.strip())
            self._link.wake()
