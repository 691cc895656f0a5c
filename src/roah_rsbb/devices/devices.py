"""The home devices of a running program: their settings, the connection to the controller, what a restart restores, and
the calls of their faces.

A box has them in its own process (`ControlledDevices` in `box/program/parts.py`).
"""

import asyncio
import concurrent.futures
import logging
import time
from typing import Any, Callable, Dict, Mapping, Optional, Tuple

from roah_rsbb.devices.client import SmartIfClient
from roah_rsbb.devices.home import OUTPUTS, BadSetting, Home, devices_state
from roah_rsbb.document.calls import DEVICES, DOOR, RING, SET_DEVICE, Call, Caller
from roah_rsbb.model.reason import Refused, say
from roah_rsbb.web.kept_file import open_kept

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
