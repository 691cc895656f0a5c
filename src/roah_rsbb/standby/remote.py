"""The copy on the standby, as the box sees it, and the standby's end of it. No sockets."""

import time
from types import MappingProxyType
from typing import Callable, Mapping, NamedTuple, Optional

from roah_rsbb.ground.linux import boot_id
from roah_rsbb.journal import log
from roah_rsbb.journal.copy_folder import CannotWriteCopy, Copy, CopyFolder, FileContent, Part
from roah_rsbb.model.clock import Now
from roah_rsbb.model.reason import decode, encode, say
from roah_rsbb.standby.beside_copy import ClockDifference, add_stops, stops_in
from roah_rsbb.standby.channel import BadMessage, Message, files_of, held_of, part_of

OPEN, WRITE, WRITE_FILES, SET_ASIDE, COMPLETE, BEAT = (
    "open", "write", "write_files", "set_aside", "complete", "beat")
# Of the messages, and of the journal in them. Versions with other messages had numbers up to 4.
VERSION = (5, log.VERSION)
# Each end hears the other one at least this often.
BEAT_S = 0.5
# In an answer: the standby becomes the box.
TAKES_OVER = "takes_over"

_REPORTS = say("the standby reports: {why}")
_VERSIONS = say("box and standby have different versions of roah_rsbb. Install the same one on both")
_NO_STOPS = say("a STOP cannot be kept: {error}. Free or repair its disk")
_NONSENSE = say("the standby answers nonsense ({error}). Install the same version there")


class CoreState(NamedTuple):
    """What the box's computer says of its core, which is another process than the one that copies."""

    is_alive: bool = True
    hand_over: bool = False  # it does not send anything any more, and the copy is complete
    stops: Mapping[str, str] = MappingProxyType({})  # it may not have recorded them: `standby/beside_copy.py`


class RemoteCopy(Copy):
    """The box's end: a copy in a folder of the standby."""

    def __init__(
        self, ask: Callable[[Message], Message],
        now: Callable[[], float] = time.monotonic, utc: Callable[[], float] = time.time,
        core: Callable[[], CoreState] = CoreState, on_taken: Callable[[], None] = lambda: None,
    ) -> None:
        """`ask` sends a message and returns the answer; it raises `CannotWriteCopy`. `on_taken` is called when the
        standby becomes the box."""
        super().__init__()
        self._ask_raw, self._now, self._utc = ask, now, utc
        self._core, self._on_taken = core, on_taken
        self._said = CoreState()
        self._known: Mapping[str, str] = {}  # the STOPs that the standby knows
        self._heard_mono = now()
        self._is_new = False
        self._open(OPEN)

    def check(self) -> None:
        """Hear from the standby, if it did not answer lately, or if the state of the core changed."""
        if self._now() - self._heard_mono >= BEAT_S or self._core() != self._said:
            self._ask({"do": BEAT})

    def write_files(self, files: FileContent) -> None:
        """Send files."""
        self._ask({"do": WRITE_FILES, "files": files})

    def write(self, part: Part) -> None:
        """Send a part of a segment."""
        self._ask({"do": WRITE, **part._asdict()})
        self.note(part)

    def set_aside(self, journal: str) -> None:
        """Let the standby begin a new copy."""
        self._open(SET_ASIDE, journal)
        self._is_new = True

    def complete(self) -> None:
        """Let the standby use the new copy."""
        if self._is_new:
            self.aside = str(self._ask({"do": COMPLETE}).get("aside", ""))
            self._is_new = False

    def close(self) -> None:
        """The standby closes its copy when it is opened again."""

    def _open(self, how: str, journal: str = "") -> None:
        answer = self._ask({"do": how, "version": VERSION, "boot": boot_id(), "journal": journal})
        try:
            self.open(held_of(answer))
        except BadMessage as error:
            raise CannotWriteCopy(_NONSENSE(error=str(error))) from None
        self.aside = str(answer.get("aside", ""))

    def _ask(self, message: Message) -> Message:
        self._said = core = self._core()
        news = {} if core.stops == self._known else {"stops": dict(core.stops)}
        answer = self._ask_raw({**message, "utc": self._utc(), "mono": self._now(), "is_alive": core.is_alive,
                                "hand_over": core.hand_over, **news})
        self._heard_mono = self._now()
        if "error" in answer:
            raise CannotWriteCopy(_REPORTS(why=decode(answer.get("reason", answer["error"]))))
        self._known = core.stops
        if answer.get(TAKES_OVER):
            self._on_taken()
        return answer


class Receiver:
    """The standby's end: carries out the requests of the box."""

    def __init__(
        self, folder: str, utc: Callable[[], float] = time.time, mono: Callable[[], float] = time.monotonic,
    ) -> None:
        self._folder, self._utc, self._mono = folder, utc, mono
        self._copy: Optional[CopyFolder] = None
        self._clocks: Optional[ClockDifference] = None

    def answer(self, message: Message) -> Message:
        """Carry out a request; returns the answer. Raises `BadMessage`."""
        came = Now(self._mono(), self._utc())
        try:
            self._take_stops(message.get("stops", {}))
            answer = self._carry_out(message)
        except CannotWriteCopy as error:
            return {"error": str(error), "reason": encode(error.args[0])}
        self._clocks.hear(_moment_in(message), came)
        return answer

    def close(self) -> None:
        """Close the copy."""
        if self._copy is not None:
            self._copy.close()
            self._copy = None

    def _take_stops(self, stops: object) -> None:
        try:
            add_stops(self._folder, stops_in(stops))
        except ValueError:
            raise BadMessage("STOPs") from None
        except OSError as error:
            raise CannotWriteCopy(_NO_STOPS(error=error.strerror or error)) from None

    def _carry_out(self, message: Message) -> Message:
        what = message.get("do")
        if what == OPEN:
            if message.get("version") != list(VERSION):
                raise CannotWriteCopy(_VERSIONS)
            self.close()
            self._copy = CopyFolder(self._folder)
            self._clocks = ClockDifference(self._folder, str(message.get("boot")))
            return self._opened(self._copy)
        if self._copy is None:
            raise CannotWriteCopy("the copy is not open")
        if what == SET_ASIDE:
            self._copy.set_aside(str(message.get("journal")))
            return self._opened(self._copy)
        if what == COMPLETE:
            self._copy.complete()
            return {"aside": self._copy.aside}
        self._copy.check()
        if what == WRITE:
            self._copy.write(part_of(message))
        elif what == WRITE_FILES:
            self._copy.write_files(files_of(message.get("files")))
        elif what != BEAT:
            raise BadMessage(f"unknown request {what!r}")
        return {}

    @staticmethod
    def _opened(copy: CopyFolder) -> Message:
        return {"held": copy.held, "aside": copy.aside}


def _moment_in(message: Message) -> Now:
    try:
        return Now(float(message["mono"]), float(message["utc"]))
    except (KeyError, TypeError, ValueError):
        raise BadMessage("it has no time") from None
