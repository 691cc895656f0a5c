"""A STOP from the terminal (docs/referee.md, "STOP in the terminal").

A STOP has its own connections and threads: it waits for no other call, and no other zone. It is sent until the core
answers. Then it is followed until the robots report STOP.
"""

import contextlib
import threading
import time
from typing import Any, Callable, Dict, List, NamedTuple, Optional, Sequence, Tuple

from roah_rsbb.model.referee import Refused
from roah_rsbb.referee.exits import Exit, NoCore
from roah_rsbb.referee.state import ENDED, RUNNING, BoxSnapshot, ZoneSnapshot
from roah_rsbb.referee.words import BadWord, is_all, pick_zone, stop_wanted
from roah_rsbb.wording.stop import DONE, LOST, Way, way, way_text

# How often the way is looked at while nothing is heard, and how soon a failed attempt is repeated.
STEP_S, AGAIN_S = 0.1, 0.2
# Named in a line while no zone is known.
ALL_ZONES, THE_RUN = "all zones", "the run"


class StopLine(NamedTuple):
    """How far the STOP of a zone came. Its fields are those of the JSON output."""

    zone: str
    way: str
    text: str
    not_stopped: Tuple[str, ...] = ()  # robots that do not report STOP
    trouble: str = ""  # why it is not delivered, or why nothing is heard of the robot, with the remedy

    @property
    def is_lost(self) -> bool:
        """Whether the referee must stop the robot by hand."""
        return Way(self.way) in LOST


class ZoneStop:
    """The STOP of one zone: what is known of it."""

    def __init__(self, zone: str, sent_s: float, before: Optional[ZoneSnapshot] = None) -> None:
        """`sent_s`: monotonic time; `before`: the zone as it was then."""
        self.zone = zone
        self.sent_s = sent_s
        self.before = before
        self.answered_s: Optional[float] = None  # when the core answered last, monotonic; None: it did not yet
        self.clock: Optional[float] = None  # of the core after its answer; later snapshots show the effect
        self.refused: Tuple[str, ...] = ()
        self.after: Optional[ZoneSnapshot] = None
        self.trouble = ""

    def take(self, link: Any, box: BoxSnapshot) -> None:
        """Take a snapshot, if it shows the effect of the STOP."""
        if self.clock is None or not link.shows_after(self.clock):
            return
        moving = () if self.after is None else self.after.not_stopped
        self.after = box.zone(self.zone)
        if self.after is None:
            self.refused = (f"zone '{self.zone}' is no longer in the schedule",)
        elif self.after.phase not in (RUNNING, ENDED) and moving:
            self.refused = (f"the run was left before {', '.join(moving)} answered STOP: stop by hand",)
        elif self.after.phase not in (RUNNING, ENDED):
            self.refused = tuple(self.after.off["stop"]) or ("no run is in progress",)

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
        since_s = self.sent_s if after is not None or self.answered_s is None else self.answered_s
        where = way(
            now_s - since_s, self.has_answer, after is not None and after.by_hand,
            after is None or after.phase == RUNNING or bool(after.not_stopped),
        )
        robots = () if after is None or where in DONE else after.not_stopped
        return StopLine(self.zone, where.value, way_text(where, self.zone), robots,
                        self.trouble if after is None and where in LOST else "")

    def status(self) -> Exit:
        """Return the exit status if it ends now."""
        if self.refused:
            return Exit.REFUSED
        return Exit.OK if self.is_over else Exit.NOT_COMPLETED if self.has_answer else Exit.NO_CORE


class Stopping:
    """A STOP of one zone, or of all zones."""

    def __init__(
        self, make_link: Callable[[], Any], word: str, report: Callable[[StopLine], None], own_zone: str = "",
        before: Optional[BoxSnapshot] = None,
    ) -> None:
        """`make_link` returns a `link.Link` that is not open. `word` names the zone, or all; empty: `own_zone`, or else
        the only run in progress. `report` takes each new line. `before`: the zones as they are, if that is known."""
        self._make_link = make_link
        self._word = word
        self.is_all = is_all(word)  # as far as is known
        self._report = report
        self._own_zone = own_zone
        self._before = before
        self._begun_s = time.monotonic()
        self._news = threading.Event()
        self._zones: Optional[List[ZoneStop]] = None  # None: not known yet
        self._trouble = ""
        self._answered = ""  # the zone for which the core has answered already
        self._answered_s: Optional[float] = None  # and when
        self._bad: Optional[BadWord] = None
        self._is_ended = False
        self._shown: Dict[str, StopLine] = {}

    def run(self) -> None:
        """Stop. Returns when all robots have stopped, or the core has refused it. Raises `BadWord` for an unknown zone.
        KeyboardInterrupt ends the attempts."""
        threading.Thread(target=self._send_at_once, name="stop at once", daemon=True).start()
        threading.Thread(target=self._listen, name="stop", daemon=True).start()
        try:
            while True:
                self._news.wait(STEP_S)
                self._news.clear()
                is_over = self._is_over()
                self._show()
                if self._bad is not None:
                    raise self._bad
                if is_over:
                    return
        finally:
            self._is_ended = True

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
            name = ALL_ZONES if self.is_all else self._word or self._own_zone or THE_RUN
            unknown = ZoneStop(name, self._begun_s)
            unknown.trouble, unknown.answered_s = self._trouble, self._answered_s
            lines = [line for line in [unknown.line(now_s)] if line.is_lost]
        else:
            lines = [one.line(now_s) for one in self.result() if not one.refused]
        for line in lines:
            if self._shown.get(line.zone) != line:
                self._shown[line.zone] = line
                self._report(line)

    # -- its threads --------------------------------------------------------------------------------

    def _send_at_once(self) -> None:
        """Send it before the zones are known, in case a zone has exactly this name."""
        name = "" if self.is_all else self._word or self._own_zone
        if name:
            with contextlib.suppress(Refused, NoCore):
                self._make_link().try_to_stop(name)
                self._answered_s, self._answered = time.monotonic(), name

    def _listen(self) -> None:
        """Find the zones, begin to stop each of them, and follow what the core publishes."""
        link = self._make_link()
        with contextlib.closing(link):
            while not self._is_ended:
                try:
                    box = link.open()
                    break
                except NoCore as gone:
                    self._trouble = str(gone)
                    self._news.set()
                    time.sleep(AGAIN_S)  # there is no event for the start of a core
            else:
                return
            try:
                names = self._names(box)
            except BadWord as bad:
                self._bad = bad
                self._news.set()
                return
            before = self._before or box
            zones = [ZoneStop(name, self._begun_s, before.zone(name)) for name in names]
            for one in zones:
                one.answered_s = self._answered_s if one.zone == self._answered else None
                threading.Thread(target=self._send, args=(one,), name=f"stop {one.zone}", daemon=True).start()
            self._zones = zones
            while not self._is_ended:
                self._news.set()
                newest = link.next(1.0)
                for one in zones if newest is not None else ():
                    one.take(link, newest)

    def _names(self, box: BoxSnapshot) -> Sequence[str]:
        """Return the zones to stop. Where all are stopped, the core decides which of them have a run in progress."""
        names = [zone.zone for zone in box.zones]
        self.is_all = is_all(self._word, names)
        if self.is_all:
            return names
        if self._word:
            return [pick_zone(self._word, names)]
        if self._own_zone:
            return [pick_zone(self._own_zone, names)]
        running = [zone.zone for zone in box.zones if zone.phase == RUNNING]
        if len(running) != 1:
            raise BadWord(f"{len(running) or 'no'} runs are in progress: type 'stop ZONE', or 'stop all'")
        return running

    def _send(self, one: ZoneStop) -> None:
        """Send STOP until the core answers; then ask when that was."""
        link = self._make_link()
        while not self._is_ended and one.clock is None and not one.refused:
            try:
                if not one.has_answer:
                    link.try_to_stop(one.zone)
                    one.answered_s = time.monotonic()
                    self._news.set()
                one.clock = link.try_clock()
                one.answered_s = time.monotonic()
            except Refused as refused:
                one.refused = tuple(refused.reasons)
            except NoCore as gone:
                one.trouble = str(gone)
                self._news.set()
                time.sleep(AGAIN_S)
        self._news.set()


class TypedStops:
    """The STOPs that are typed at prompts. Each begins at once, in its own thread."""

    def __init__(
        self, make_link: Callable[[], Any], report: Callable[[StopLine], None], note: Callable[[str], None],
        own_zone: str = "", box: Callable[[], Optional[BoxSnapshot]] = lambda: None,
    ) -> None:
        """`note` shows why a STOP was not sent, and `own_zone` is the zone of a "stop" without one. `box` returns the
        zones as the program knows them: it may stop its own one itself before the STOP has found it."""
        self._make_link = make_link
        self._report = report
        self._note = note
        self._own_zone = own_zone
        self._box = box
        self._threads: List[threading.Thread] = []
        self.of_own_zone = False  # the zone of this command was stopped, or all zones
        self.after: Optional[Callable[[], None]] = None  # called after each STOP

    def take(self, line: str) -> bool:
        """Whether the line is a STOP, which has begun then."""
        word = stop_wanted(line)
        if word is None:
            return False
        if is_all(word) or self._own_zone.casefold().startswith(word.casefold()):
            self.of_own_zone = True
        stopping = Stopping(self._make_link, word, self._report, self._own_zone, self._box())
        thread = threading.Thread(target=self._work, args=(stopping,), name="typed stop", daemon=True)
        self._threads.append(thread)
        thread.start()
        return True

    def wait(self) -> None:
        """Wait until all robots have stopped."""
        for thread in list(self._threads):
            thread.join()

    def _work(self, stopping: Stopping) -> None:
        try:
            stopping.run()
            for one in stopping.result():
                if one.refused:
                    self._note(f"stop {one.zone} was refused: {'; '.join(one.refused)}")
            if not stopping.result():
                self._note("no run is in progress")
        except BadWord as bad:
            self._note(f"NOT STOPPED: {bad}")
        after = self.after
        if after is not None:
            after()
