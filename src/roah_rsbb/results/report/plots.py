"""The plots of a report: their data as JSON, which resource/report/report.js draws with uPlot.

uPlot 1.6.32 (MIT licence, https://github.com/leeoniya/uPlot) is part of each page with a plot, so the pages work
offline and can be mailed. Each plot stands beside a table with the same numbers.
"""

import os
from typing import Any, Dict, List, NamedTuple, Optional, Sequence, Tuple

from roah_rsbb.results.page import Markup, joined, json_block, tag
from roah_rsbb.wording.texts import visible

LIBRARY, STYLE, SCRIPT = "uPlot.iife.min.js", "uPlot.min.css", "report.js"
# More ticks of an axis cannot be read.
MAX_TICKS = 24


class Assets(NamedTuple):
    """The files that become part of the pages."""

    library: str
    style: str
    script: str


def assets(folder: str) -> Assets:
    """Read the files in the package's folder resource/report. Raises OSError."""
    texts = []
    for name in (LIBRARY, STYLE, SCRIPT):
        with open(os.path.join(folder, name), encoding="utf-8") as file:
            texts.append(file.read())
    return Assets(*texts)


class Axes(NamedTuple):
    """What the axes show."""

    x: str
    y: str
    least: float = 0.0  # the y axis reaches at least this
    bars: bool = False
    lines: bool = True  # between the points; not if neighbours have nothing to do with each other


Values = Sequence[Optional[float]]


def plot(identity: str, axes: Axes, labels: Sequence[str], values: Dict[str, Values],
         places: Optional[Sequence[float]] = None) -> Markup:
    """Build a plot. `values`: for each series, a value for each label. `places`: positions of the labels on the x axis,
    rising; None: equal distances."""
    xs = list(range(len(labels))) if places is None else [round(place, 3) for place in places]
    labels = [visible(label) for label in labels]
    data: Dict[str, Any] = {
        "x": axes.x, "y": axes.y, "least": axes.least, "bars": axes.bars, "lines": axes.lines,
        "labels": labels,
        "ticks": _ticks(xs, labels), "series": [visible(name) for name in values],
        "data": [xs, *([None if v is None else round(v, 4) for v in each] for each in values.values())],
    }
    return joined((tag("div", Markup(""), class_="plot", data_plot=identity), json_block(identity, data)))


def _ticks(xs: Sequence[float], labels: Sequence[str]) -> List[Tuple[float, str]]:
    """Return the labels that fit below the axis, at different places."""
    least = (xs[-1] - xs[0]) / MAX_TICKS if xs else 0.0
    found: List[Tuple[float, str]] = []
    for x, label in zip(xs, labels):
        if not found or x - found[-1][0] > least:
            found.append((x, label))
    return found
