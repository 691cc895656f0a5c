"""Finds the files of the folder `modules/` that apply in a zone (docs/organiser.md, "modules/").

A file `modules/ZONE/NAME` replaces `modules/NAME` for the runs in that zone, as a whole. So two arenas can run the
same benchmark at once, with their own waypoints and markers.
"""

import os
from typing import List

# Folders with such names belong to tools, such as editors.
_NOT_ZONES = (".", "_")


def zone_folders(folder: str) -> List[str]:
    """Return the names of the zones that have files of their own, sorted."""
    try:
        names = sorted(os.listdir(folder))
    except OSError:
        return []
    return [name for name in names if not name.startswith(_NOT_ZONES) and os.path.isdir(os.path.join(folder, name))]


def file_in(folder: str, zone: str, name: str) -> str:
    """Return the path of the file that applies in a zone: its own, or else the one of all zones."""
    own = own_file(folder, zone, name)
    return own if own and os.path.lexists(own) else os.path.join(folder, name)


def own_file(folder: str, zone: str, name: str) -> str:
    """Return the path of a zone's own file, whether it exists or not; empty if no folder can have the zone's name."""
    if not zone or "/" in zone or "\0" in zone or zone.startswith(_NOT_ZONES):
        return ""
    return os.path.join(folder, zone, name)
