"""The program that copies the journal, continuously: to a second folder, such as a USB stick (docs/backup.md), and to a
standby, which is a second computer (docs/standby.md).

It reads the journal in log_dir, which the core writes. The core never waits for it: it is a process of its own, a child
of the box's supervisor. Through the door of the box it says once a second how complete each copy is, and the core warns
the referees if one is behind.
"""

import contextlib
import enum
import functools
import json
import logging
import math
import os
import signal
import sys
import threading
import time
from typing import IO, Any, Callable, Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple

from roah_rsbb.box.program.main import log_to_terminal
from roah_rsbb.box.settings import BoxSettings, of_words
from roah_rsbb.box.standing_by import wait_for_takeover
from roah_rsbb.client.client import Client, Offer
from roah_rsbb.client.places import DoorPlace, door_file_in, read_place
from roah_rsbb.core.copies import STANDBY
from roah_rsbb.document.calls import COPIED, COPY, COPY_REPORT, HELPER, STOPPED, Caller
from roah_rsbb.ground import linux
from roah_rsbb.ground.durable import close_to_others
from roah_rsbb.ground.params import BadParams
from roah_rsbb.ground.signs_of_life import CONNECTED, LOOK_S, TAKEN, Lifeline, Watch
from roah_rsbb.ground.signs_of_life import STANDBY as SIGN_OF_STANDBY
from roah_rsbb.journal import epochs
from roah_rsbb.journal import log_dir as log_dirs
from roah_rsbb.journal.copy_folder import Stick
from roah_rsbb.journal.copy_follower import PARENT, CopySettings, Follower, ReportedCopy, copy_settings
from roah_rsbb.journal.log import NewerFormat
from roah_rsbb.journal.log_dir import JOURNAL
from roah_rsbb.model.document import Document
from roah_rsbb.model.reason import Refused, encode
from roah_rsbb.standby import pairing
from roah_rsbb.standby.beside_copy import PackedModules, TooLarge, newest, stops_in
from roah_rsbb.standby.box_end import BoxEnd, Herald
from roah_rsbb.standby.channel import MODULES, NETWORK, PASSWORDS
from roah_rsbb.standby.pairing import read_standby
from roah_rsbb.standby.remote import CoreState

# -- handing over -------------------------------------------------------------------------------------

# A supervisor (of roslaunch, or `box/program/supervisor.py`) starts a core that ended again, and ends one that hangs,
# so that referees keep their panels and pages. If no core answers after that, for example because the disk does not,
# the standby becomes the box. Before, the old core is ended, so that it can send nothing whatever happens to it, and
# the copy is completed.

# Seconds without a sign of life of any core, after which the box hands over: if nobody starts another core,
NOBODY_S = 3.0
# if the core that hangs still exists after it was killed, because it waits for its disk,
HUNG_S = 4.0
# if the next core is being started: it usually answers 1 to 4 s after the end of the one before.
STARTING_S = 20.0
# Seconds for the last part of the copy, and for the answer of the standby.
COPY_S, ANSWER_S = 3.0, 5.0
# For the lock of the journal. A disk that hangs gives none.
LOCK_S = 2.0

_log = logging.getLogger(__name__)


class Owner(enum.Enum):
    """Who has the journal of this computer."""

    NOBODY = "nobody"
    HUNG = "hung"  # the core that does not answer
    NEXT = "next"  # a core that is starting


PATIENCE_S = {Owner.NOBODY: NOBODY_S, Owner.HUNG: HUNG_S, Owner.NEXT: STARTING_S}


def is_due(silent_s: float, owner: Owner, is_connected: bool) -> bool:
    """Whether to hand over now. `silent_s`: since the last sign of life of a core; `is_connected`: the standby is."""
    return is_connected and silent_s >= PATIENCE_S[owner]


class Handover:
    """Watches the core, in a thread, and hands over."""

    def __init__(self, log_dir: str, is_connected: Callable[[], bool], ask: Callable[[object], None],
                 by: Callable[[], str], lifeline: Lifeline, now: Callable[[], float] = time.monotonic) -> None:
        """`ask` has the copy completed, and then `complete` called with the question. `by` returns the address of the
        standby. `lifeline`: to the supervisor, which counts on a standby that takes over."""
        self._log_dir = log_dir
        self._is_connected, self._ask, self._by = is_connected, ask, by
        self._watch = Watch(log_dir, now)
        self._lifeline, self._said, self._is_refused = lifeline, "", False
        self._is_handing_over = False
        self._question: object = None
        self._is_complete, self._is_taken, self._ended = threading.Event(), threading.Event(), threading.Event()
        self._thread = threading.Thread(target=self._work, name="handover", daemon=True)

    def start(self) -> None:
        """Start to watch."""
        self._thread.start()

    def end(self) -> None:
        """End the thread soon."""
        self._ended.set()

    def state(self) -> CoreState:
        """From any thread: what the standby hears of the core."""
        return CoreState(self._watch.silence.is_alive, self._is_handing_over)

    def complete(self, question: object) -> bool:
        """From any thread: the copy is complete. Returns whether this was the question of a handover."""
        is_own = question is self._question
        if is_own:
            self._is_complete.set()
        return is_own

    def taken(self) -> None:
        """From any thread: the standby becomes the box."""
        self._is_taken.set()

    def _work(self) -> None:
        while not self._ended.wait(LOOK_S):
            self.look()
        self._watch.close()

    def look(self) -> None:
        """Hand over, if that is due."""
        self._watch.look()
        silence = self._watch.silence
        self._is_refused &= not silence.is_alive
        self._inform()
        owner = Owner.NEXT if self._watch.is_starting else Owner.NOBODY
        if not silence.pid or not is_due(silence.seconds, owner, self._is_connected()):
            return
        if self._is_refused and self._lifeline.has_supervisor:
            return  # it stops the robots: see `box/program/supervisor.py`
        self._watch.kill()
        lock: Optional[log_dirs.Lock] = None
        holder, owner = 0, Owner.HUNG
        if self._watch.is_gone:  # otherwise it has the journal
            lock, holder, owner = self._lock()
        try:
            if is_due(silence.seconds, owner, self._is_connected()):
                self._hand_over(lock, holder)
        finally:
            self._is_handing_over = False
            if lock is not None:
                os.close(lock.fd)

    def _inform(self) -> None:
        """Let the supervisor know whether a standby takes over."""
        says = TAKEN if self._is_taken.is_set() else CONNECTED if self._is_connected() and not self._is_refused else ""
        if says != self._said:
            self._said = says
            if says:
                self._lifeline.keep(SIGN_OF_STANDBY, says)
            else:
                self._lifeline.drop(SIGN_OF_STANDBY)
        self._lifeline.send()

    def _wait(self, event: threading.Event, seconds: float) -> bool:
        """Wait for an event, and let the supervisor know meanwhile; returns whether it came."""
        until_mono = time.monotonic() + seconds
        while not event.wait(LOOK_S) and time.monotonic() < until_mono:
            self._inform()
        return event.is_set()

    def _lock(self) -> Tuple[Optional[log_dirs.Lock], int, Owner]:
        """Lock the journal, if the disk allows that in time; returns the lock, or who has it."""
        trial = _Trial(functools.partial(log_dirs.lock, self._log_dir))
        self._wait(trial.ended, LOCK_S)
        lock = trial.take()
        if lock is not None:
            return lock, 0, Owner.NOBODY
        return None, log_dirs.holder_of(self._log_dir), Owner.NEXT if trial.ended.is_set() else Owner.HUNG

    def _hand_over(self, lock: Optional[log_dirs.Lock], holder: int) -> None:
        if holder:
            with contextlib.suppress(OSError):
                os.kill(holder, signal.SIGKILL)
        _log.error("The core does not answer, and none was started again within %g s: handing over to the standby",
                   self._watch.silence.seconds)
        for event in (self._is_complete, self._is_taken):
            event.clear()
        self._question = object()
        self._ask(self._question)
        if not self._wait(self._is_complete, COPY_S):
            _log.error("The copy could not be completed: the standby may lack the last entries")
        self._is_handing_over = True
        if not self._wait(self._is_taken, ANSWER_S):
            self._is_refused = True
            _log.error("The standby does not take over: see its terminal. A core that is started here continues")
            return
        _log.error("The standby has taken over")
        self._watch.silence.forget()
        if lock is not None:  # otherwise the next core asks the standby before it begins
            try:
                epochs.hand_over(lock.path, time.time(), self._by())
            except (OSError, NewerFormat) as error:
                _log.error("%s cannot be written: %s", lock.path, error)


class _Trial:
    """Locks the journal in a thread of its own. A lock that comes too late is given back."""

    def __init__(self, lock: Callable[[], log_dirs.Lock]) -> None:
        self.ended = threading.Event()
        self._lock, self._is_late, self._mutex = lock, False, threading.Lock()
        self._found: Optional[log_dirs.Lock] = None
        threading.Thread(target=self._work, name="lock for the handover", daemon=True).start()

    def _work(self) -> None:
        found: Optional[log_dirs.Lock] = None
        with contextlib.suppress(log_dirs.CannotWriteJournal):
            found = self._lock()
        with self._mutex:
            if self._is_late and found is not None:
                os.close(found.fd)
            elif not self._is_late:
                self._found = found
        self.ended.set()

    def take(self) -> Optional[log_dirs.Lock]:
        """Return the lock; None: there is none, and none is kept that comes from now on."""
        with self._mutex:
            self._is_late = True
            return self._found


# -- copying ------------------------------------------------------------------------------------------

NAME = "roah_rsbb_backup"  # of this program
PERIOD_S = 1.0
# Locked by this program, in log_dir.
LOCK = "copies.lock"
LOCK_LOOK_S = 0.1
# Without a supervisor and without a box, until it ends.
LEFT_S = 30.0
# For the last part of the journal; a stick that hangs must not keep the program from ending.
END_S = 5.0


class _Question(NamedTuple):
    """The box asks whether the standby has everything up to a ticket."""

    box: str  # its uuid
    journal: str
    ticket: int


def _own_address(bind_host: str) -> str:
    """Return the address at which the core of this computer hears datagrams from this computer."""
    return "127.0.0.1" if bind_host == "0.0.0.0" else bind_host


class Copying:
    """The copies, from the start of the program to its end. Call everything in one thread."""

    def __init__(self, settings: CopySettings, name: str, find: Callable[[], DoorPlace], lifeline: Lifeline) -> None:
        """Start to copy. `name`: of this program; `find`: see `Client`; `lifeline`: see `Handover`. Raises OSError."""
        self._settings, self._lifeline = settings, lifeline
        self._copies: List[ReportedCopy] = []
        self._modules: Optional[PackedModules] = None
        self._said = ""  # what is wrong with them
        self._stops: Dict[str, str] = {}  # of the box
        self._box = Client(Document, find, face=HELPER,
                           offer=Offer({COPY: self._on_asked, STOPPED: self._on_stopped} if settings.standby_port
                                       else {}, name))
        if settings.backup_dir:
            _log.info("Copying the journal to %s", settings.backup_dir)
            self._add(settings.backup_dir, Follower(settings.log_dir, Stick(
                settings.backup_dir, settings.log_dir).open, on_answer=self._on_copied))
        self._box_end: Optional[BoxEnd] = None
        if settings.standby_port:
            self._serve_standby(settings)
        self._box.start()

    def report(self) -> None:
        """Report to the box how complete the copies are. Call it every `PERIOD_S`."""
        self._pack_modules()
        for copy in self._copies:
            news = copy.news()
            self._box.call(COPY_REPORT, **{
                **news._asdict(), "behind_s": news.behind_s if math.isfinite(news.behind_s) else None,
                "trouble": encode(news.trouble), "notice": encode(news.notice)})

    def close(self) -> None:
        """End the copies when they have everything that is in the journal, but wait no longer than `END_S`."""
        self._complete()
        if self._box_end is not None:
            self._handover.end()
            self._herald.end()
            self._box_end.close()
        for copy in self._copies:
            copy.follower.end(END_S)
        self._box.close()

    def _add(self, place: str, follower: Follower, notice: Callable[[], str] = lambda: "") -> None:
        self._copies.append(ReportedCopy(place, follower, notice))

    def _serve_standby(self, settings: CopySettings) -> None:
        log_dir, port = settings.log_dir, settings.standby_port
        self._handover = Handover(log_dir, lambda: self._box_end.is_connected,
                                  lambda question: self._copies[-1].follower.ask(question), self._standby_host,
                                  self._lifeline)
        self._herald = Herald(log_dir, (_own_address(settings.bind_host), port),
                              lambda: self._handover.state().is_alive)
        self._box_end = end = BoxEnd(log_dir, settings.bind_host, port, lambda text: _log.warning("%s", text),
                                     self._herald.answer, lambda: self._handover.state()._replace(stops=self._stops),
                                     self._handover.taken)
        self._herald.start()
        network, modules = (os.path.join(end.folder, name) for name in (NETWORK, MODULES))
        self._modules = PackedModules(settings.modules_dir, modules) if settings.modules_dir else None
        with open(network, "w", encoding="utf-8") as file:
            json.dump({"rsbb_host": settings.rsbb_host, "rsbb_port": settings.rsbb_port, "standby_port": port,
                       **settings.of_venue}, file)
        self._add(STANDBY, Follower(log_dir, end.open_copy, {
            PASSWORDS: settings.passwords_file, NETWORK: network, MODULES: modules}, on_answer=self._on_copied),
                  lambda: end.notice)
        self._handover.start()
        # Everybody on this computer can read the log, so the code is not in it.
        known = f"The standby is {end.name}. Another one" if end.is_paired else "A standby"
        _log.warning("%s can be paired on TCP port %d. For a code, enter on this computer: %s",
                     known, end.port, pairing.command(log_dir))

    def _pack_modules(self) -> None:
        trouble = ""
        if self._modules is not None:
            try:
                self._modules.look()
            except (OSError, TooLarge) as error:
                trouble = str(error)
        if trouble and trouble != self._said:
            _log.warning("%s", trouble)
        self._said = trouble

    def _standby_host(self) -> str:
        standby = read_standby(self._settings.log_dir)
        return "" if standby is None else standby.host

    def _on_asked(self, found: Mapping[str, Any], _caller: Caller) -> None:
        """The box asks; `_on_copied` answers. It asks again with each report, so an answer may get lost."""
        box, journal, ticket = (found.get(name) for name in ("box", "journal", "ticket"))
        if not isinstance(box, str) or not isinstance(journal, str) or type(ticket) is not int:
            raise Refused(["only the box asks whether there is a copy"])
        self._copies[-1].follower.ask(_Question(box, journal, ticket))

    def _on_stopped(self, found: Mapping[str, Any], _caller: Caller) -> None:
        """The box has sent STOP, which its journal does not have yet."""
        try:
            self._stops = newest(self._stops, stops_in(found.get("stops")))
        except ValueError:
            raise Refused(["only the box says which runs it has stopped"]) from None
        self._copies[-1].follower.wake()

    def _on_copied(self, question: object) -> None:
        """In a thread: a copy has everything for which it was asked."""
        if isinstance(question, threading.Event):
            question.set()
        elif isinstance(question, _Question):
            # Another box may also ask, but its journal is not copied.
            if question.journal == self._copies[-1].follower.progress.journal:
                self._box.call(COPIED, box=question.box, ticket=question.ticket)
        else:
            self._handover.complete(question)

    def _complete(self) -> None:
        """Let those that work get what the core wrote last."""
        working = [copy.follower for copy in self._copies if not copy.follower.progress.trouble]
        answers = [threading.Event() for _ in working]
        for follower, answer in zip(working, answers):
            follower.ask(answer)
        for answer in answers:
            answer.wait(END_S)


def _parent() -> int:
    """Return the process that started this one, which may be gone already."""
    return int(os.environ.get(PARENT, os.getppid()))


def _only_one(log_dir: str) -> IO[str]:
    """Lock the log_dir for this program, in the place of one whose supervisor is gone; returns the file of the lock.
    Raises OSError."""
    os.makedirs(log_dir, exist_ok=True)
    file = open(os.path.join(log_dir, LOCK), "a+", encoding="ascii")  # noqa: SIM115
    until_mono = time.monotonic() + 2 * END_S
    while True:
        try:
            linux.lock(file.fileno())
            break
        except BlockingIOError:
            file.seek(0)
            pid, parent = map(int, (file.read() or "0 0").split())
            is_left = linux.status_of(pid)[1:2] not in ([], [str(parent)])
            if not is_left or time.monotonic() > until_mono:
                raise OSError(f"process {pid} copies the journal in {log_dir} already: end it, or wait until its box "
                              "has ended") from None
            with contextlib.suppress(ProcessLookupError):
                os.kill(pid, signal.SIGTERM)
            time.sleep(LOCK_LOOK_S)
    file.truncate(0)
    file.write(f"{os.getpid()} {_parent()}")
    file.flush()
    return file


def main(arguments: Optional[Sequence[str]] = None) -> None:
    """Copy the journal of a box. `arguments`: `CopySettings.words`."""
    close_to_others()
    log_to_terminal()
    ended, parent, lifeline = threading.Event(), _parent(), Lifeline()
    for number in linux.ending_signals():  # a terminal sends them to all; this program ends after the box
        signal.signal(number, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, lambda *_: ended.set())
    values: Dict[str, str] = of_words(sys.argv[1:] if arguments is None else arguments)
    try:
        settings = copy_settings(BoxSettings(values))
        wait_for_takeover(settings.log_dir, lambda: ended.is_set() or os.getppid() != parent)
        lock = _only_one(settings.log_dir)
        copying = Copying(settings, NAME, lambda: read_place(door_file_in(settings.log_dir)), lifeline)
    except (BadParams, OSError) as error:
        sys.exit(f"The journal is not copied: {error}")
    journal_lock, left_s = os.path.join(settings.log_dir, f"{JOURNAL}.lock"), 0.0
    while not ended.wait(PERIOD_S) and left_s < LEFT_S:
        copying.report()
        # Without its parent, it copies and hands over as long as there is a box.
        is_left = os.getppid() != parent and not linux.is_locked(journal_lock)
        left_s = left_s + PERIOD_S if is_left else 0.0
    copying.close()
    lock.close()
