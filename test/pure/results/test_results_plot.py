"""The picture of a link record: its parts and their positions."""

import re
import xml.etree.ElementTree as ElementTree

import pytest

from helpers.journals import UTC0
from roah_rsbb.model.messages import LinkSample
from roah_rsbb.results.events import Stretch
from roah_rsbb.results.link_report import LEFT, MAX_COLUMNS, RIGHT, WIDTH, LinkRows, link_plot
from roah_rsbb.results.runs import LinkSecond

NAME = "{http://www.w3.org/2000/svg}"
INSIDE = WIDTH - LEFT - RIGHT
NO_ROWS = LinkRows((), ())


class Plot:
    """A picture of samples, a second each from UTC0 on; `end` seconds after UTC0 it ends."""

    def __init__(self, samples, end=None, rows=NO_ROWS, every=1.0):
        link = [LinkSecond(UTC0 + every * (i + 1), sample) for i, sample in enumerate(samples)]
        self.end = every * len(samples) if end is None else end
        self.svg = link_plot(link, UTC0, UTC0 + self.end, rows, in_utc=True)
        self.root = ElementTree.fromstring(self.svg)

    def all(self, kind):
        return list(self.root.iter(NAME + kind))

    def bars(self, fill):
        """(begin, end) in seconds and (base, top) in y of the bars of this colour."""
        paths = [path.get("d") for path in self.all("path") if path.get("fill") == fill]
        found = re.findall(r"M([-.0-9]+) ([-.0-9]+)H([-.0-9]+)V([-.0-9]+)H", "".join(paths))
        return [(self.seconds(x), self.seconds(right), float(base), float(top)) for x, base, right, top in found]

    def seconds(self, x):
        return round((float(x) - LEFT) / INSIDE * self.end, 1)

    def titles(self):
        return [title.text for title in self.all("title")]


GOOD = LinkSample(1.0, received=1, gap_s=1.0, skew_s=0.0)


def test_losses_are_drawn_above_or_below_the_middle():
    plot = Plot([GOOD] * 3 + [GOOD._replace(lost=5, unanswered=2)] + [GOOD] * 6)
    [(begin, end, base, top)] = plot.bars("#c33")
    assert (begin, end) == (3.0, 4.0)
    [(_, _, same_base, below)] = plot.bars("#36c")
    assert top < base == same_base < below
    assert (base - top) / (below - base) == pytest.approx(2.5, rel=0.01)


def test_a_long_record_is_drawn_in_fewer_columns_that_lose_nothing():
    samples = [GOOD] * 3000
    samples[1700:1704] = [GOOD._replace(lost=3)] * 4
    samples[100] = GOOD._replace(gap_s=20.0)
    plot = Plot(samples)
    assert len(plot.bars("#555")) <= MAX_COLUMNS
    whole = Plot([GOOD._replace(lost=12)] * 10).bars("#c33")[0]
    [(begin, end, base, top)] = plot.bars("#c33")
    assert (begin, end) == (1700.0, 1705.0)
    assert base - top == pytest.approx(whole[2] - whole[3]), "12 fill the scale"
    tallest = max(plot.bars("#555"), key=lambda bar: bar[2] - bar[3])
    assert tallest[0] <= 100.0 < tallest[1]


def test_nothing_is_drawn_outside_of_the_run():
    plot = Plot([GOOD._replace(lost=1)] * 10, end=5.0)
    assert all(0.0 <= begin <= 5.0 for begin, _, _, _ in plot.bars("#555"))
    assert max(end for _, end, _, _ in plot.bars("#555")) <= 5.1


def test_times_without_a_record_are_grey():
    assert "no record: the box was down" not in Plot([GOOD] * 10).titles()
    plot = Plot([GOOD] * 3, every=10.0, end=60.0)
    grey = [r for r in plot.all("rect") if r.get("fill-opacity")]
    assert [plot.seconds(r.get("x")) for r in grey] == [0.0, 10.0, 20.0, 30.0]
    assert [round(float(r.get("width")) / INSIDE * 60.0) for r in grey] == [9, 9, 9, 30]
    [line] = [path.get("d") for path in plot.all("path") if path.get("stroke") == "#111"]
    assert line.count("M") == 3, "the skew's line has the same gaps"
    [line] = [path.get("d") for path in Plot([GOOD] * 3).all("path") if path.get("stroke") == "#111"]
    assert line.count("M") == 1


def test_round_trips_are_dots_and_late_messages_bars():
    plot = Plot([GOOD, GOOD._replace(round_trip_s=0.05, round_trip_max_s=0.4, late_s=0.2), GOOD])
    dots = plot.all("circle")
    assert [plot.seconds(dot.get("cx")) for dot in dots] == [1.5, 1.5]
    assert len({dot.get("cy") for dot in dots}) == 2
    assert [(b, e) for b, e, _, _ in plot.bars("#888")] == [(1.0, 2.0)]


def test_states_under_it():
    rows = LinkRows((Stretch(UTC0, UTC0 + 40.0, "PREPARE"), Stretch(UTC0 + 40.0, UTC0 + 41.0, "STOP")),
                (Stretch(UTC0, UTC0 + 60.0, "<evil>"),))
    plot = Plot([GOOD] * 60, rows=rows)
    assert {"PREPARE, 40.0 s", "STOP, 1.0 s", "<evil>, 60.0 s"} <= set(plot.titles())
    words = [text.text for text in plot.all("text")]
    assert "PREPARE" in words
    assert "STOP" not in words, "there is no room for it"
    assert "<evil>" not in plot.svg


def test_the_axis_has_round_times():
    words = [text.text for text in Plot([GOOD] * 60).all("text") if ":" in text.text and text.text[0].isdigit()]
    assert words == ["11:00:00", "11:00:10", "11:00:20", "11:00:30", "11:00:40", "11:00:50", "11:01:00"]
    assert Plot([GOOD], end=0.0).svg, "a run without any length has a picture, too"
