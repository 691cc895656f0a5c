"""Finds the configuration files and pages that this package ships: in a wheel, installed, or in the source."""

import pathlib
from typing import Optional

PACKAGE = pathlib.Path(__file__).resolve().parent
_PLACES = (PACKAGE / "shipped_files", PACKAGE.parents[1], *(up / "share" / "roah_rsbb" for up in PACKAGE.parents))


class NotShipped(Exception):
    """The files are missing. The text says what to do."""


def shipped_file(path: str) -> pathlib.Path:
    """The place of a file of the top folder, such as launch/roah_rsbb.launch; raises NotShipped."""
    for place in _PLACES:
        if (place / path).is_file():
            return place / path
    raise NotShipped(f"the shipped {path} is missing near {PACKAGE}: install the package again")


def shipped_folder() -> pathlib.Path:
    """The folder `config` with benchmarks.yaml and modules/, beside the folder `resource`; raises NotShipped."""
    return shipped_file("config/benchmarks.yaml").parent


def pages_folder() -> Optional[pathlib.Path]:
    """The folder with docs/, whose pages the findings name. None: the pages are not installed."""
    places = (*_PLACES, pathlib.Path("/usr/share/doc/roah-rsbb"))
    # Debian packages compress long pages.
    return next((place for place in places if any((place / "docs").glob("protocol.md*"))), None)
