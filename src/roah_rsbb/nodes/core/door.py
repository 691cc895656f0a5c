"""The door of the box in the core node: what it offers, and where clients find it (docs/door.md)."""

import asyncio
import contextlib
import os
import threading
import time
import xmlrpc.client
from http.client import HTTPException
from typing import Callable, Mapping, Optional, Sequence, Tuple

import rosgraph
import rospy

from roah_rsbb.box.door import Door
from roah_rsbb.core.box import Box
from roah_rsbb.core.views.document import Documents
from roah_rsbb.core.views.public import NOTHING_ALLOWED, Publicity
from roah_rsbb.document.calls import Call
from roah_rsbb.document.document import Written
from roah_rsbb.document.place import NotFound, new_token, read_place, write_place
from roah_rsbb.model.clock import Now
from roah_rsbb.model.document import Document
from roah_rsbb.model.results import UnsavedParts
from roah_rsbb.ros.place import PARAM, file_of
from roah_rsbb.web.serving import ANY_HOST, ServeError

# Seconds. Shortest time between what clients are sent: of events, because many robots change something in each; and of
# calls, whose effect a referee waits for.
GAP_S, CALLS_GAP_S = 0.05, 0.005
SIGN_S = 0.5
RETRY_S = 1.0


class BoxDoor:
    """Keeps the document of a box current, and its door open. Call everything in the loop's thread."""

    def __init__(
        self, loop: asyncio.AbstractEventLoop, box: Box, uuid: str, host: str, now: Callable[[], Now],
        log_files: Callable[[], Mapping[int, str]], unsaved: Callable[[], Sequence[UnsavedParts]],
        calls: Mapping[str, Call], check: Callable[[], None], publicity: Publicity = NOTHING_ALLOWED,
    ) -> None:
        """`host`: broadcast address in use; `log_files`, `unsaved`: see `Documents.look`; `calls`, `check`: see `Door`;
        `publicity`: what the public may see."""
        self._loop, self._now, self._log_files, self._unsaved = loop, now, log_files, unsaved
        self._documents = Documents(box, uuid, host, publicity)
        self._box = box
        self._seen: Optional[Tuple[int, int]] = None  # what the document was made of
        self._written = Written(Document)
        self._token = new_token()
        self._soon: Optional[asyncio.TimerHandle] = None
        self._sent_mono = float("-inf")
        self._door = Door(loop, self._token, {name: self._current(call) for name, call in calls.items()}, now,
                          self._written, check)
        self.document = self._documents.last
        self._is_current = True
        self._path = ""  # of the file that says where the door is

    def open(self) -> None:
        """Let clients in, and publish where it is. Logs what prevents it, with the remedy: the original interface
        remains."""
        host = rosgraph.network.get_bind_address()
        try:
            port = self._door.open(host)
        except ServeError as error:
            rospy.logerr("No panel can follow this box: %s", error)
            return
        self._sign()
        local, remote = "127.0.0.1" if host == ANY_HOST else host, rosgraph.network.get_host_name()
        _publish(lambda: rospy.set_param(PARAM, {"url": _url(remote, port), "token": self._token}))
        if rospy.resolve_name(PARAM) == PARAM:  # the file is that of the only box at this master
            _publish(lambda: self._write_place(_url(local, port)))

    def _write_place(self, url: str) -> None:
        self._path = file_of(rosgraph.get_master_uri())
        if self._path:
            write_place(self._path, url, self._token)

    @property
    def is_followed(self) -> bool:
        """Whether there is a client."""
        return self._door.is_followed

    @property
    def rate(self) -> float:
        """How fast the clocks pass; of a replay."""
        return self._written.rate

    @rate.setter
    def rate(self, rate: float) -> None:
        self._written.rate = rate

    def close(self) -> None:
        """End all connections. The file goes, so that nobody looks for a box that is over."""
        self._door.close()
        if self._path:
            with contextlib.suppress(OSError, NotFound):
                if read_place(self._path).token == self._token:  # another box may have written its own
                    os.unlink(self._path)

    def changed(self) -> None:
        """Note that an event changed something: clients are sent it soon."""
        self._publish_within(GAP_S)

    def called(self) -> None:
        """Note that a referee has made a call, whose effect others wait for."""
        self._publish_within(CALLS_GAP_S)

    def _publish_within(self, gap_s: float) -> None:
        due = max(self._loop.time(), self._sent_mono + gap_s)
        if self._soon is None or due < self._soon.when():
            if self._soon is not None:
                self._soon.cancel()
            self._soon = self._loop.call_at(due, self.publish)

    def publish(self) -> Document:
        """Send clients what has changed; returns the document. What only time changes is looked at once a second."""
        if self._soon is not None:
            self._soon.cancel()
        self._soon, self._sent_mono = None, self._loop.time()
        seen = self._box.happenings, int(self._sent_mono)
        if seen != self._seen:
            self._seen = seen
            self._look()
        self._door.publish()
        return self.document

    def _look(self) -> Document:
        """Make the document again. If that fails, which is an error of this program, clients see that it is old."""
        now = self._now()
        try:
            self.document = self._documents.look(now, self._log_files(), self._unsaved())
            self._written.update(self.document, now)
            self._is_current = True
            if self._documents.fault is not None:
                rospy.logerr_throttle_identical(
                    60.0, f"internal error, please report it: the public sees nothing new ({self._documents.fault!r})")
        except Exception as error:
            self._is_current = False
            rospy.logerr_throttle_identical(60.0, f"internal error, please report it: {error}", exc_info=True)
        return self.document

    def _current(self, call: Call) -> Call:
        """Return a call after which the document contains what it did."""
        def carried_out(arguments, caller):
            try:
                return call(arguments, caller)
            finally:
                self._look()
                self.called()

        return carried_out

    def _sign(self) -> None:
        self._loop.call_later(SIGN_S, self._sign)
        self.publish()
        if self._is_current:
            self._door.sign()


def _url(host: str, port: int) -> str:
    return f"ws://{host}:{port}/door"


def _publish(where: Callable[[], object]) -> None:
    """Publish where the door is, until it succeeds. In a thread, because a disk or a master may hang."""
    def run() -> None:
        while not rospy.is_shutdown():
            try:
                where()
                return
            except (OSError, rospy.ROSException, xmlrpc.client.Error, HTTPException) as error:
                rospy.logerr_throttle_identical(60.0, f"Some panels cannot find this box, which tries again: {error}")
                time.sleep(RETRY_S)

    threading.Thread(target=run, name="door", daemon=True).start()
