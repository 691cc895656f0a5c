"""Finds the configuration files and pages that this package ships: in a wheel, installed, or in the source."""

import pathlib
from typing import Optional

PACKAGE = pathlib.Path(__file__).resolve().parents[1]


class NotShipped(Exception):
    """The files are missing. The text says what to do."""


def shipped_folder() -> pathlib.Path:
    """The folder with benchmarks.yaml and modules/; raises NotShipped."""
    places = [PACKAGE / "shipped", PACKAGE.parents[1] / "config",
              *(parent / "share" / "roah_rsbb" / "config" for parent in PACKAGE.parents)]
    for place in places:
        if (place / "benchmarks.yaml").is_file():
            return place
    raise NotShipped(f"the shipped benchmarks.yaml is missing near {PACKAGE}: install the package again")


def pages_folder() -> Optional[pathlib.Path]:
    """The folder with docs/, whose pages the findings name. None: the pages are not installed."""
    places = [PACKAGE / "shipped", PACKAGE.parents[1], pathlib.Path("/usr/share/doc/roah-rsbb")]
    # Debian packages compress long pages.
    return next((place for place in places if any((place / "docs").glob("protocol.md*"))), None)
