"""Windows without ROS: their choices are in their settings, and all else is asked of the box."""

import threading
import time
from typing import Optional

from roah_rsbb.client.client import Answer, Client
from roah_rsbb.document.calls import DEVICES, EXIT, SET_DEVICE
from roah_rsbb.document.written import read
from roah_rsbb.model.document import Document
from roah_rsbb.model.messages import DevicesSeen
from roah_rsbb.rqt.app import application
from roah_rsbb.rqt.host import ControllerStatus, DevicesAfar, WindowHost, ZoneChoice
from roah_rsbb.rqt.model.calls import Calls, Done, missing
from roah_rsbb.rqt.qt import QSettings
from roah_rsbb.wording.said import tr_said

# Interval at which the box is asked for the home devices, seconds.
ASK_S = 0.5
_ZONE = "zone"


class HostWithoutRos(WindowHost):
    """This computer alone."""

    def __init__(self, name: str, utc: bool = False) -> None:
        """`name`: of the window, for its settings and the box's records. `utc`: it shows times in UTC."""
        self._name, self._utc = name, utc
        self._ended = threading.Event()
        self.zone, self.devices = ZoneSetting(QSettings("roah_rsbb", name)), DevicesOfBox()

    @property
    def node(self) -> str:
        return self._name

    def begin(self, name: str) -> None:
        application.end_at_signals(self, application.ORDERLY_S)

    @property
    def has_ended(self) -> bool:
        return self._ended.is_set()

    def end(self) -> None:
        self._ended.set()

    def times_in_utc(self) -> bool:
        return self._utc

    def exit(self, calls: Calls, owner: object, anyway: bool, done: Done) -> None:
        calls.call(owner, EXIT, done, anyway=anyway)


class ZoneSetting(ZoneChoice):
    """The zone, kept in the settings."""

    def __init__(self, settings: QSettings) -> None:
        self._settings = settings
        self._value = str(settings.value(_ZONE, ""))

    @property
    def value(self) -> str:
        return self._value

    def choose(self, zone: str) -> None:
        self._value = zone
        self._settings.setValue(_ZONE, zone)


class DevicesOfBox(DevicesAfar):
    """The home devices of a box, which is asked for them."""

    def __init__(self) -> None:
        self._afar: Optional[Client[Document]] = None
        self._answer: Optional[Answer] = None  # one that is new
        self._due_mono = 0.0  # inf: an answer is due

    def start(self, afar: Client[Document]) -> None:
        self.why_missing = missing()  # until it answers
        self._afar = afar

    def look(self) -> None:
        answer, self._answer = self._answer, None
        if answer is not None:
            self._show(answer)
        if self._afar is not None and time.monotonic() >= self._due_mono:
            self._due_mono = float("inf")
            self._afar.call(DEVICES, self._take)

    def _take(self, answer: Answer) -> None:
        """In the client's thread."""
        self._answer = answer
        self._due_mono = time.monotonic() + ASK_S

    def _show(self, answer: Answer) -> None:
        self.why_missing = missing() if not answer.is_answered else "; ".join(map(tr_said, answer.reasons))
        if self.why_missing:
            return
        found = read(DevicesSeen, answer.answer)
        state, status = found.devices, ControllerStatus(found.connected, found.text)
        # What has not changed stays the same object: panels compare it.
        self.state = self.state if self.state == state else state
        self.status = self.status if self.status == status else status

    def set(self, calls: Calls, owner: object, device: str, value: int, done: Done) -> None:
        calls.call(owner, SET_DEVICE, done, device=device, value=value)
