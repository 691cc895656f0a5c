"""The file with the paired devices."""

from typing import Callable

from roah_rsbb.web.kept_file import open_kept
from roah_rsbb.web.pairing import Sessions

NAME = "web_sessions.json"


def open_sessions(folder: str, report: Callable[[str], None]) -> Sessions:
    """Return the sessions that are kept in a folder. A damaged file is moved aside, and `report` is called."""
    return open_kept(folder, NAME, Sessions, [], report, "pair the devices again")
