"""Measures the gateway for browsers: from a change in the core to its readers, and what it costs the core."""

import http.cookies
import json
import pathlib
import random
import signal
import sys
import time
import urllib.request
from typing import Dict, List, NamedTuple, Optional

from processes import Box, Measured, wait
from support.waiting import wait_until

from roah_rsbb.client.client import Client
from roah_rsbb.client.places import DoorPlaces
from roah_rsbb.model.document import Document

VIEWERS = pathlib.Path(__file__).resolve().parent / "viewers.py"
SETTLE_S = 2.0
# Pauses between changes are random, so that they meet every moment of the core's 10 Hz tick.
LONGEST_PAUSE_S = 0.6


class Cost(NamedTuple):
    """What changes took and cost."""

    late_ms: List[float]  # of each reader and change
    core_percent: float


def organisers_code() -> Dict[str, str]:
    """Wait until the gateway makes a code for an organiser's device; returns it with its address."""
    found: List[Dict[str, str]] = []

    def made() -> bool:
        answer = client.call("pair", role="organiser").result()
        if answer.is_answered and not answer.reasons:
            found.append(answer.answer)
        return bool(found)

    client = Client(Document, DoorPlaces().find)
    client.start()
    wait(made, "the gateway makes a code")
    client.close()
    return found[0]


class Phone:
    """A paired device of an organiser, without a browser."""

    def __init__(self, box: Box) -> None:
        self._url = f"http://127.0.0.1:{box.web_port}"
        self.cookie = ""
        self._send("pair", {"code": organisers_code()["code"], "person": f"Bench {time.monotonic_ns()}"})

    def command(self, name: str, fields: Dict[str, object]) -> None:
        """Send a command as the page does."""
        self._send(f"commands/{name}", fields)

    def _send(self, path: str, body: Dict[str, object]) -> None:
        request = urllib.request.Request(f"{self._url}/api/v1/{path}", json.dumps(body).encode(), {
            "Origin": self._url, "Content-Type": "application/json", "Cookie": self.cookie})
        with urllib.request.urlopen(request, timeout=10) as answer:
            given = http.cookies.SimpleCookie(answer.headers.get("Set-Cookie", ""))
        self.cookie = "; ".join(f"{name}={one.value}" for name, one in given.items()) or self.cookie


class Viewers:
    """A process with many readers of what the public sees, or, with a cookie, of what phones show."""

    def __init__(self, port: int, count: int, cookie: str = "") -> None:
        self._process = Measured(sys.executable, str(VIEWERS), str(port), str(count), cookie)
        self._process.wait_printed("ready")
        self._read = 1

    def close(self) -> float:
        """End the process; returns the bytes a second to each reader."""
        self._process.signal(signal.SIGTERM)
        self._process.wait_ended()
        return float(self._process.lines[-1])

    def times(self) -> List[float]:
        """Wait until all readers got the next change; returns when (monotonic seconds)."""
        self._read += 1
        wait_until(lambda: len(self._process.lines) >= self._read, lambda: f"a change is read: {self._process.text}")
        return json.loads(self._process.lines[self._read - 1])


def change(box: Box, viewers: Optional[Viewers], count: int) -> Cost:
    """Move a zone to its other event and back, `count` times."""
    time.sleep(SETTLE_S)
    dice, late_ms = random.Random(5), []
    began, core = time.monotonic(), box.process.cpu_s()
    for number in range(count):
        at = time.monotonic()
        box.command("previous" if number % 2 else "next", 0)
        if viewers is not None:
            late_ms += [(when - at) * 1e3 for when in viewers.times()]
        time.sleep(max(0.0, at + dice.uniform(0.2, LONGEST_PAUSE_S) - time.monotonic()))
    seconds = time.monotonic() - began
    return Cost(late_ms, 100.0 * (box.process.cpu_s() - core) / seconds)
