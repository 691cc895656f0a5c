"""Measures the core beside clients of its door: what it costs, how much each is sent, how soon each knows.

As a program it is one client, in a process of its own: it prints the bytes a second of the documents that it is sent.
"""

import subprocess
import sys
import time
import typing
from typing import Any, List, Tuple

from roah_rsbb.client.client import Client
from roah_rsbb.model.document import Document
from roah_rsbb.ros.place import Places

if typing.TYPE_CHECKING:
    from processes import Box

LIMIT_S = 30.0
SETTLE_S = 2.0  # time in which all clients have the whole document
FOLLOWERS = (0, 1, 5)


class Counted(Client[Document]):
    """A client that counts what it is sent."""

    sent_bytes = 0

    def _take(self, link: Any, message: Any, is_first: bool) -> None:
        self.sent_bytes += len(repr(message))
        super()._take(link, message, is_first)


def cost(box: "Box", count: int, seconds: float) -> Tuple[float, float]:
    """The core's share of a processor (per cent), and the bytes a second to each of `count` clients."""
    clients = [subprocess.Popen([sys.executable, __file__, str(seconds + 1.0)], stdout=subprocess.PIPE, text=True)
               for _ in range(count)]
    time.sleep(SETTLE_S + 1.0 if count else 0.5)
    cpu = box.process.cpu_percent(seconds)
    rates = [float(client.communicate()[0]) for client in clients]
    return cpu, sum(rates) / count if count else 0.0


def changes(box: "Box", count: int) -> List[float]:
    """Milliseconds from the begin of a call until another client has what it changed."""
    caller, watcher = Client(Document, Places().find), Client(Document, Places().find)
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
    client = Counted(Document, Places().find)
    client.start()
    client.wait(lambda document: True, LIMIT_S)
    time.sleep(SETTLE_S)
    before, began = client.sent_bytes, time.monotonic()
    time.sleep(float(sys.argv[1]))
    print((client.sent_bytes - before) / (time.monotonic() - began), flush=True)
    client.close()


if __name__ == "__main__":
    main()
