"""Finds the configuration files that this package ships: in a wheel, in an installed workspace or in the source."""

import pathlib

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
