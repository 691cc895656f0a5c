"""Measures the core beside clients of its door and phones: what they cost, how much each is sent, how soon each knows.

As a program it is one client, in a process of its own: it prints the bytes a second of the documents that it is sent.
"""

import sys
import time
import typing
from typing import Any, List, NamedTuple

from roah_rsbb.client.client import Client
from roah_rsbb.client.places import DoorPlaces
from roah_rsbb.model.document import Document

if typing.TYPE_CHECKING:
    import processes

LIMIT_S = 30.0
SETTLE_S = 2.0  # time in which all clients have the whole document


class Counted(Client[Document]):
    """A client that counts what it is sent."""

    sent_bytes = 0

    def _take(self, link: Any, message: Any, is_first: bool) -> None:
        self.sent_bytes += len(repr(message))
        super()._take(link, message, is_first)


class Cost(NamedTuple):
    """What clients and phones cost: shares of a processor (per cent), and bytes a second to each."""

    core_percent: float
    client_rate: float
    phone_rate: float


def cost(box: "processes.Box", count: int, phones: int, seconds: float) -> Cost:
    """Measure beside `count` clients and some phones. The box has pages."""
    import gateway
    from processes import Measured

    readers = gateway.Viewers(box.web_port, phones, gateway.Phone(box).cookie) if phones else None
    clients = [Measured(sys.executable, __file__, str(seconds + 1.0)) for _ in range(count)]
    time.sleep(SETTLE_S + 1.0 if count else 0.5)
    core_percent = box.process.cpu_percent(seconds)
    for client in clients:
        client.wait_ended()
    rates = [float(client.lines[-1]) for client in clients]
    phone_rate = readers.close() if readers else 0.0
    return Cost(core_percent, sum(rates) / count if count else 0.0, phone_rate)


def changes(count: int) -> List[float]:
    """Milliseconds from the begin of a call until another client has what it changed."""
    caller, watcher = Client(Document, DoorPlaces().find), Client(Document, DoorPlaces().find)
    for client in (caller, watcher):
        client.start()
        client.wait(lambda document: True, LIMIT_S)
    taken = []
    try:
        for number in range(count):
            before = watcher.document.zones["zone 0"].event
            began = time.monotonic()
            caller.call("act", action="previous" if number % 2 else "next", zone="zone 0")
            watcher.wait(lambda document, before=before: document.zones["zone 0"].event != before, LIMIT_S)
            taken.append((time.monotonic() - began) * 1e3)
    finally:
        caller.close()
        watcher.close()
    return taken


def main() -> None:
    """Be one client."""
    client = Counted(Document, DoorPlaces().find)
    client.start()
    client.wait(lambda document: True, LIMIT_S)
    time.sleep(SETTLE_S)
    before, began = client.sent_bytes, time.monotonic()
    time.sleep(float(sys.argv[1]))
    print((client.sent_bytes - before) / (time.monotonic() - began), flush=True)
    client.close()


if __name__ == "__main__":
    main()
