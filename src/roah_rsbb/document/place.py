"""Where the door of a box is, and the token that opens it: a file that only its owner may read."""

import errno
import json
import os
from typing import NamedTuple

_FULL = (errno.ENOSPC, errno.EDQUOT)


class NotFound(Exception):
    """Nobody knows where the door is. The text names the remedy."""


class OnlyStops(NotFound):
    """The box has no door, because it only sends STOP. The text says why."""


class DoorPlace(NamedTuple):
    """The address of a door (ws://…), and its token."""

    url: str
    token: str


def new_token() -> str:
    """Return a random token."""
    import secrets  # late, as below: a STOP that begins only reads a place

    return secrets.token_urlsafe(32)


def write_place(path: str, url: str, token: str, why: str = "") -> None:
    """Write the file of a door; `why`: why there is none. Raises OSError.

    On a full disk, the file of the door before is written over, which has as many bytes."""
    from roah_rsbb.ground.durable import write_file

    os.makedirs(os.path.dirname(path), exist_ok=True)
    content = json.dumps({"url": url, "token": token, **({"why": why} if why else {})}).encode()
    try:
        write_file(path, content)
    except OSError as error:
        size = os.path.getsize(path) if os.path.exists(path) else 0
        if error.errno not in _FULL or size < len(content):
            raise
        with open(path, "r+b", buffering=0) as file:
            file.write(content.ljust(size))


def read_place(path: str) -> DoorPlace:
    """Return the place in a file. Raises `NotFound`."""
    try:
        with open(path, encoding="utf-8") as file:
            found = json.load(file)
        if "why" in found:
            raise OnlyStops(str(found["why"]))
        return DoorPlace(str(found["url"]), str(found["token"]))
    except OSError as error:
        raise NotFound(f"{path}: {error.strerror}: start the box on this computer as the same user") from None
    except (ValueError, KeyError, TypeError, RecursionError):
        raise NotFound(f"{path} is damaged: start the box again, which writes it") from None
