"""The copy on the standby, as the box sees it, and the standby's end of it. No sockets."""

import contextlib
import time
from typing import Callable, Optional

from roah_rsbb.copies.copy import CannotWriteCopy, Copy, FileContent
from roah_rsbb.copies.folder import CopyFolder
from roah_rsbb.copies.rows import Rows
from roah_rsbb.journal import schema
from roah_rsbb.journal.file import boot_id
from roah_rsbb.standby.clocks import ClockDifference
from roah_rsbb.standby.messages import (
    BadMessage,
    Message,
    files_message,
    files_of,
    known_message,
    known_of,
    rows_message,
    rows_of,
)

OPEN, WRITE, SET_ASIDE, BEAT = "open", "write", "set_aside", "beat"
# Each end hears the other one at least this often.
BEAT_S = 0.5


class RemoteCopy(Copy):
    """The box's end: a copy in a folder of the standby.

    A part that is not the last is written by the standby while the box reads the next one. If it could not be written,
    the copy is closed, and what it has is asked again when it is opened.
    """

    def __init__(
        self, send: Callable[[Message], None], receive: Callable[[], Message],
        now: Callable[[], float] = time.monotonic, utc: Callable[[], float] = time.time,
    ) -> None:
        """`send` sends a message, and `receive` waits for its answer. Both raise `CannotWriteCopy`."""
        super().__init__()
        self._send_raw, self._receive, self._now, self._utc = send, receive, now, utc
        self._heard_mono = now()
        self._is_answer_due = False
        self._open(OPEN)

    def check(self) -> None:
        """Hear from the standby, if it did not answer lately."""
        if self._now() - self._heard_mono >= BEAT_S:
            self._ask({"do": BEAT})

    def write(self, rows: Rows, beside: FileContent) -> None:
        """Send rows and files."""
        message = {"do": WRITE, "rows": rows_message(rows), "files": files_message(beside)}
        if rows.is_last:
            self.box_uuid = str(self._ask(message).get("box_uuid", ""))
        else:
            self._take_answer()
            self._send(message)
            self._is_answer_due = True
        self.known.add(rows)

    def set_aside(self) -> None:
        """Let the standby begin a new copy."""
        self._open(SET_ASIDE)

    def close(self) -> None:
        """The standby closes its copy when it is opened again. An answer that is due belongs to this request: it must
        not be taken for the answer to a later one."""
        with contextlib.suppress(CannotWriteCopy):
            self._take_answer()

    def _open(self, how: str) -> None:
        answer = self._ask({"do": how, "version": schema.VERSION, "boot": boot_id()})
        try:
            self.known = known_of(answer)
        except BadMessage as error:
            raise CannotWriteCopy(f"the standby answers nonsense ({error}). Install the same version there") from None
        self.box_uuid, self.aside = str(answer.get("box_uuid", "")), str(answer.get("aside", ""))

    def _send(self, message: Message) -> None:
        self._send_raw({**message, "utc": self._utc()})

    def _ask(self, message: Message) -> Message:
        self._take_answer()
        self._send(message)
        return self._answer()

    def _take_answer(self) -> None:
        if self._is_answer_due:
            self._is_answer_due = False
            self._answer()

    def _answer(self) -> Message:
        answer = self._receive()
        self._heard_mono = self._now()
        if "error" in answer:
            raise CannotWriteCopy(f"the standby reports: {answer['error']}")
        return answer


class Receiver:
    """The standby's end: carries out the requests of the box."""

    def __init__(self, folder: str, utc: Callable[[], float] = time.time) -> None:
        self._folder, self._utc = folder, utc
        self._copy: Optional[CopyFolder] = None
        self._clocks: Optional[ClockDifference] = None

    def answer(self, message: Message) -> Message:
        """Carry out a request; returns the answer. Raises `BadMessage`."""
        came = self._utc()
        try:
            answer = self._carry_out(message)
        except CannotWriteCopy as error:
            self.close()
            return {"error": str(error)}
        self._clocks.hear(_time_in(message), came)
        return answer

    def close(self) -> None:
        """Close the copy."""
        if self._copy is not None:
            self._copy.close()
            self._copy = None

    def _carry_out(self, message: Message) -> Message:
        what = message.get("do")
        if what == OPEN:
            self.close()
            if message.get("version") != schema.VERSION:
                raise CannotWriteCopy("box and standby have different versions of roah_rsbb. Install the same one on "
                                      "both")
            self._copy = CopyFolder(self._folder)
            self._clocks = ClockDifference(self._folder, str(message.get("boot")))
            return self._opened(self._copy)
        if self._copy is None:
            raise CannotWriteCopy("the copy is not open")
        if what == SET_ASIDE:
            self._copy.set_aside()
            return self._opened(self._copy)
        if what == WRITE:
            self._copy.check()
            rows, files = rows_of(message.get("rows", {})), files_of(message.get("files", {}))
            self._copy.write(rows, files)
            return {"box_uuid": self._copy.box_uuid}
        if what == BEAT:
            self._copy.check()
            return {}
        raise BadMessage(f"unknown request {what!r}")

    @staticmethod
    def _opened(copy: CopyFolder) -> Message:
        return {**known_message(copy.known), "box_uuid": copy.box_uuid, "aside": copy.aside}


def _time_in(message: Message) -> float:
    try:
        return float(message["utc"])
    except (KeyError, TypeError, ValueError):
        raise BadMessage("it has no time") from None
