"""Files of JSON that a program keeps, for its user only: each is complete or unchanged after a power cut."""

import asyncio
import concurrent.futures
import json
import os
import threading
from typing import Any, Callable, TypeVar

from roah_rsbb.ground import durable

T = TypeVar("T")
Save = Callable[[Any], None]


class SavedBeside:
    """Saves in threads, one after the other: while a disk hangs, the loop serves pages and STOP.

    They are daemons, because a process must be able to end beside a disk that hangs.
    """

    def __init__(self, save: Save) -> None:
        """`save` keeps a content and raises OSError."""
        self._save = save
        self.newest: concurrent.futures.Future[None] = concurrent.futures.Future()
        """Ends when the newest content is on the disk, with an OSError if it cannot be saved."""
        self.newest.set_result(None)

    def keep(self, content: Any) -> None:
        """Begin to save a content."""
        before, self.newest = self.newest, concurrent.futures.Future()
        self.newest.set_running_or_notify_cancel()  # who waits may give up
        threading.Thread(target=self._work, args=(before, content, self.newest), name="kept", daemon=True).start()

    async def wait(self) -> None:
        """Wait until the newest content is on the disk. Raises OSError."""
        await asyncio.wrap_future(self.newest)

    def _work(
        self, before: "concurrent.futures.Future[None]", content: Any, kept: "concurrent.futures.Future[None]",
    ) -> None:
        concurrent.futures.wait([before])
        try:
            self._save(content)
        except Exception as error:
            kept.set_exception(error)
        else:
            kept.set_result(None)


def open_kept(
    folder: str, name: str, make: Callable[[Save, Any], T], nothing: Any, report: Callable[[str], None], remedy: str,
) -> T:
    """Return `make(save, content)` for the content of a file, or for `nothing` if there is no file. `save` writes it.

    A damaged file is moved aside, and `report` is called. `remedy`: what to do in that case.
    """
    path = os.path.join(folder, name)

    def save(content: Any) -> None:
        os.makedirs(folder, exist_ok=True)
        durable.write_file(path, json.dumps(content, indent=1, ensure_ascii=False).encode("utf-8"))

    try:
        with open(path, encoding="utf-8") as file:
            return make(save, json.load(file))
    except FileNotFoundError:
        return make(save, nothing)
    except (OSError, ValueError, TypeError, KeyError, AttributeError, RecursionError) as error:
        report(f"cannot read {path} ({error}): {remedy}")
        try:
            os.replace(path, f"{path}.damaged")
        except OSError as failed:
            report(f"cannot move {path} aside ({failed})")
        return make(save, nothing)
