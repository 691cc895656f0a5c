"""The home devices of a running program: their settings, the connection to the controller, what a restart restores, and
the calls of their faces.

A box has them in its own process (`ControlledDevices` in `box/program/neighbours.py`).
"""

import asyncio
import concurrent.futures
import contextlib
import logging
import os
import socket
import time
from typing import Any, Callable, Dict, Mapping, Optional, Tuple

from roah_rsbb.devices.smartif import (
    FROM_CONTROLLER,
    OUTPUTS,
    BadSetting,
    Busy,
    Garbage,
    Home,
    Message,
    Set,
    SmartIfDecoder,
    devices_state,
    encode,
    is_ring,
)
from roah_rsbb.document.calls import DEVICES, DOOR, RING, SET_DEVICE, Call, Caller
from roah_rsbb.ground.kept_file import open_kept
from roah_rsbb.model.reason import Refused, say

# -- the connection -----------------------------------------------------------------------------------

RETRY_S = 0.2
# A controller that is started at the same time, such as the dummy, may not be there yet: this is no fault.
STARTS_S = 3.0
CONNECT_S = 3.0
# Time limit for the rest of a message, which has only a few bytes.
REST_S = 5.0
# The controller rejects a second client immediately: after this time the connection counts as accepted.
SETTLE_S = 0.3
# Detect a silent loss of the controller in about ten seconds.
KEEPALIVE = (("TCP_KEEPIDLE", 5), ("TCP_KEEPINTVL", 2), ("TCP_KEEPCNT", 3), ("TCP_USER_TIMEOUT", 10000))
# Largest amount of unread data (bytes), in case the controller stops reading.
MAX_UNREAD = 65536


class SmartIfClient:
    """The connection of a `Home`. Callbacks are called in the loop's thread.

    `on_ring()`: the bell rang. `on_status(connected, text)`: the status changed; the text says why, with the remedy.
    """

    def __init__(
        self, host: str, port: int, home: Home, on_ring: Callable[[], None], on_status: Callable[[bool, str], None],
    ) -> None:
        self._host, self._port = host, port
        self._where = f"the SmartIF controller at {host}:{port}"
        self._home = home
        self._on_ring = on_ring
        self._on_status = on_status
        self._status = (False, "")
        self._has_met = False  # the controller was reached
        self._writer: Optional[asyncio.StreamWriter] = None

    @property
    def connected(self) -> bool:
        """Whether the controller is connected."""
        return self._status[0]

    def send(self, message: Set) -> None:
        """Send a message. Without a connection, nothing is lost: a new connection begins with all values."""
        writer = self._writer
        if writer is None or writer.is_closing():
            return
        writer.write(encode(message))
        if writer.transport.get_write_buffer_size() > MAX_UNREAD:
            writer.transport.abort()

    async def run(self) -> None:
        """Run until cancelled."""
        loop = asyncio.get_event_loop()
        reported_from = loop.time() + STARTS_S
        while True:
            why = await self._session()
            if self._has_met or loop.time() >= reported_from:
                self._report(False, why)
            await asyncio.sleep(RETRY_S)

    async def _session(self) -> str:
        """Run one connection; returns why it ended."""
        try:
            reader, writer = await asyncio.wait_for(asyncio.open_connection(self._host, self._port), CONNECT_S)
        except asyncio.TimeoutError:
            return f"{self._where} does not answer: check that it is on, and check smartif_host"
        except OSError as error:
            return f"{self._where} cannot be reached ({_reason(error)}): check that it is on, and check smartif_host"
        settled = asyncio.get_event_loop().call_later(SETTLE_S, self._report, True, f"connected to {self._where}")
        try:
            self._has_met = True
            _enable_keepalive(writer)
            self._writer = writer
            for message in self._home.all():
                self.send(message)
            return await self._read(reader)
        except Garbage as error:
            return f"{self._where} does not use the SmartIF protocol ({error}): check smartif_port"
        except OSError as error:
            return f"the connection to {self._where} broke ({_reason(error)})"
        finally:
            settled.cancel()
            self._writer = None
            writer.transport.abort()

    async def _read(self, reader: asyncio.StreamReader) -> str:
        decoder = SmartIfDecoder(FROM_CONTROLLER)
        while True:
            limit = REST_S if decoder.pending else None
            try:
                data = await asyncio.wait_for(reader.read(4096), limit)
            except asyncio.TimeoutError as error:
                if getattr(error, "errno", None):
                    raise  # since Python 3.11, a failed keepalive is a TimeoutError, too
                return f"{self._where} sent an incomplete message"
            if not data:
                return f"{self._where} closed the connection"
            messages = decoder.feed(data)
            while messages:
                for message in messages:
                    if isinstance(message, Busy):
                        return f"{self._where} is connected to another client at {message.address}: end that client"
                    self._take(message)
                messages = decoder.feed(b"")

    def _take(self, message: Message) -> None:
        self._report(True, f"connected to {self._where}")
        if is_ring(message):
            self._on_ring()

    def _report(self, connected: bool, text: str) -> None:
        if (connected, text) != self._status:
            self._status = (connected, text)
            self._on_status(connected, text)


def _enable_keepalive(writer: asyncio.StreamWriter) -> None:
    connection = writer.get_extra_info("socket")
    connection.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
    for name, value in KEEPALIVE:
        with contextlib.suppress(OSError, AttributeError):  # some systems lack some of them
            connection.setsockopt(socket.IPPROTO_TCP, getattr(socket, name), value)


def _reason(error: OSError) -> str:
    return os.strerror(error.errno) if error.errno else str(error)


# -- the devices of a program -------------------------------------------------------------------------

# In log_dir.
FILE = "devices.json"
NO_DEVICE = say("there is no device {name}, or its value is not a whole number: give one of {names}")

Save = Callable[[Any], object]
_log = logging.getLogger(__name__)


class HomeDevices:
    """The devices of the flat. Everything, callbacks too, is called in the loop's thread; `save` in another one."""

    def __init__(
        self, loop: asyncio.AbstractEventLoop, host: str, port: int, *, on_state: Callable[[Home], object],
        on_bell: Callable[[], object], on_status: Callable[[bool, str], object], saved: object, save: Save,
    ) -> None:
        """`on_state(home)`: something changed. `on_status(connected, text)`: see `SmartIfClient`. `save(values)` keeps
        values, which are `saved` after a restart. With None or invalid values, every device is off."""
        self._loop = loop
        self._home = Home()
        self._home.restore(saved)
        self._on_state, self._on_bell, self._on_status = on_state, on_bell, on_status
        self._client = SmartIfClient(host, port, self._home, self.ring, self._connected)
        self._status = (False, f"connecting to the SmartIF controller at {host}:{port}")
        self._connection: Optional[asyncio.Task] = None
        self._saver = concurrent.futures.ThreadPoolExecutor(max_workers=1)
        self._save = save
        self._newest: object = None
        self._kept: object = None
        self._is_kept = True  # the last attempt to save did not fail

    def start(self) -> None:
        """Report the state and the status, and connect to the controller."""
        _log.info("%s", self._status[1])
        self.report()
        self._connection = self._loop.create_task(self._client.run())

    def report(self) -> None:
        """Report the state and the status."""
        self._on_status(*self._status)
        self._on_state(self._home)

    def close(self) -> None:
        """Disconnect. The process does not end before the newest values are saved."""
        if self._connection is not None:
            self._connection.cancel()
        self._saver.shutdown(wait=False)

    def set(self, device: str, value: int) -> None:
        """Set a device: the controller receives the value now, or when it is connected. Raises `BadSetting`."""
        self._client.send(self._home.set(device, value))
        if not self._client.connected:
            _log.warning("%s is set to %d, which the controller receives when it is connected", device, value)
        self._changed()

    def set_door(self, opened: bool) -> None:
        """Set the door and window detector, for which SmartIF has no id."""
        self._home.door = bool(opened)
        self._changed()

    def ring(self) -> None:
        """Ring the bell."""
        _log.info("The bell rings")
        nsec = time.time_ns()
        self._home.bell = (nsec // 10**9, nsec % 10**9)
        self._changed()
        self._on_bell()

    # -- for faces ------------------------------------------------------------------------------------

    def calls(self) -> Dict[str, Call]:
        """Return the calls by which faces see and operate the devices, for the door of the box."""
        return {DEVICES: self._seen, SET_DEVICE: self._operate}

    def _seen(self, _found: Mapping[str, Any], _caller: Caller) -> Dict[str, Any]:
        """Return `DevicesSeen`."""
        connected, text = self._status
        return {"devices": devices_state(self._home)._asdict(), "connected": connected, "text": text}

    def _operate(self, found: Mapping[str, Any], _caller: Caller) -> None:
        device, value = found.get("device"), found.get("value")
        names = (*OUTPUTS, DOOR, RING)
        if device not in names or type(value) is not int:
            raise Refused([NO_DEVICE(name=f"{device!r:.40}", names=", ".join(names))])
        try:
            if device == RING:
                self.ring()
            elif device == DOOR:
                self.set_door(bool(value))
            else:
                self.set(device, value)
        except BadSetting as error:
            raise Refused([str(error)]) from None

    # -- what happens ---------------------------------------------------------------------------------

    def _connected(self, connected: bool, text: str) -> None:
        self._status = (connected, text)
        _log.log(logging.INFO if connected else logging.WARNING, "%s", text)
        self._on_status(connected, text)

    def _changed(self) -> None:
        self._on_state(self._home)
        self._newest = self._home.saved()
        # In another thread, because a disk or a ROS master may be slow or missing.
        self._saver.submit(self._save_newest)

    def _save_newest(self) -> None:
        newest = self._newest
        if newest is self._kept:
            return  # values that waited for a slow disk were kept together
        try:
            self._save(newest)
        except Exception as error:
            if self._is_kept:
                _log.warning("the settings of the home devices cannot be saved for a restart: %s", error)
            self._is_kept = False
        else:
            self._kept, self._is_kept = newest, True


def open_settings(log_dir: str, launch: str = "") -> Tuple[object, Save]:
    """Return `saved` and `save` of `HomeDevices` for a file of log_dir. A damaged file is moved aside. What another
    `launch` saved is not used; empty: all is."""
    def settings(save: Save, saved: Any) -> Tuple[object, Save]:
        if saved is not None and not Home().restore(saved):
            raise ValueError("these are no settings of home devices")
        is_old = bool(launch) and saved is not None and saved.get("launch") != launch
        return None if is_old else saved, (
            lambda values: save({**values, "launch": launch})) if launch else save

    return open_kept(log_dir, FILE, settings, None, lambda text: _log.warning("%s", text), "every device is off")
