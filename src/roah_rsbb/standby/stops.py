"""STOPs that the box has sent, as the standby hears of them: before they are in the journal, and so in the copy.

They are kept in a file beside the copy. The box that takes over reads it before it sends anything. It ignores those
that its journal has, and those that are empty: their runs were started again.
"""

import json
import os
from typing import Dict, Mapping

from roah_rsbb.ground import durable

FILE = "stops.json"
# The newest ones, and the characters of each: JSON has up to 6 for each character of who stopped, and why.
MOST, LONGEST = 100, 5000


def stops_in(found: object) -> Dict[str, str]:
    """Return the texts of STOPs by the identity of the run. One that is none does not keep out the others. Raises
    ValueError: these are no STOPs."""
    if not isinstance(found, dict):
        raise ValueError("no STOPs")
    return newest({identity: text for identity, text in found.items() if all(
        isinstance(each, str) and len(each) <= LONGEST for each in (identity, text))})


def newest(*stops: Mapping[str, str]) -> Dict[str, str]:
    """Return the newest of these STOPs, the oldest ones first; later arguments are newer."""
    found: Dict[str, str] = {}
    for each in stops:
        for identity, text in each.items():
            found.pop(identity, None)
            found[identity] = text
    return dict(list(found.items())[-MOST:])


def read_stops(folder: str) -> Dict[str, str]:
    """Return the texts of STOPs (`box/stops.py`) by the identity of the run; empty: none, or not readable."""
    try:
        with open(os.path.join(folder, FILE), encoding="ascii") as file:
            return stops_in(json.load(file))
    except (OSError, ValueError, RecursionError):
        return {}


def add_stops(folder: str, stops: Mapping[str, str]) -> None:
    """Keep STOPs. They are on the disk when this returns. Raises OSError."""
    before = read_stops(folder)
    found = newest(before, stops)
    if found != before:
        durable.write_file(os.path.join(folder, FILE), json.dumps(found).encode("ascii"))
