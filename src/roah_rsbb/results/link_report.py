"""The link record of a robot: a summary in words, and a plot over time (SVG without external parts)."""

import math
from typing import Callable, List, NamedTuple, Optional, Sequence

from roah_rsbb.model.messages import LinkSample
from roah_rsbb.results.events import Stretch
from roah_rsbb.results.page import Markup, joined, tag
from roah_rsbb.results.runs import LinkSecond
from roah_rsbb.wording.texts import one_line
from roah_rsbb.wording.times import skew, time_with_tenths

# One lost datagram does not make a silence this long.
GAP_S = 2.5


def link_lines(link: Sequence[LinkSecond]) -> List[str]:
    """Summarize the link record of a robot in words; empty without a record."""
    if not link:
        return []
    samples = [second.sample for second in link]
    received, lost = sum(s.received for s in samples), sum(s.lost for s in samples)
    due = received + lost
    share = f" ({lost / due:.1%})" if due else ""
    lines = [
        f"{received} messages in {sum(s.seconds for s in samples):.0f} s; {lost} lost on the way to the box{share}, "
        f"{sum(s.duplicates for s in samples)} duplicates, {sum(s.stale for s in samples)} out of order, "
        f"{sum(s.unreadable for s in samples)} unreadable",
        f"longest silence {max(s.gap_s for s in samples):.1f} s; seconds with a silence over {GAP_S:g} s: "
        f"{sum(1 for s in samples if s.gap_s > GAP_S)}; latest message {max(s.late_s for s in samples):.3f} s behind",
        f"{sum(s.answers for s in samples)} reactions to the box, {sum(s.unanswered for s in samples)} datagrams of "
        "the box that the robot had not received half a second later",
    ]
    trips = [s.round_trip_s for s in samples if s.round_trip_s is not None]
    longest = [s.round_trip_max_s for s in samples if s.round_trip_max_s is not None]
    if trips:
        lines.append(
            f"round trip with the robot's own delay: {min(trips):.3f} s at best, {max(longest):.3f} s at worst")
    skews = [s.skew_s for s in samples if s.skew_s is not None]
    if skews:
        lines.append(f"clock skew {skew(min(skews))} to {skew(max(skews))}")
    hosts = list(dict.fromkeys(s.host for s in samples if s.host))
    if hosts:
        lines.append(f"robot's address: {', '.join(one_line(host) for host in hosts)}")
    return lines


# -- the plot ---------------------------------------------------------------------------------------


WIDTH, LEFT, RIGHT = 720.0, 86.0, 8.0
STRIP, SPACE, ROW = 54.0, 13.0, 15.0
# More columns cannot be distinguished on paper.
MAX_COLUMNS = 600
# A larger distance between samples means that the box was down.
NO_RECORD_S = 3.0
# Marked in the plot: when a robot counts as silent (`core/link`), and the usual limit of the skew
# (docs/protocol.md, "Timing").
SILENT_S = 3.0
ALLOWED_SKEW_S = 0.1

_STEPS_S = (1, 2, 5, 10, 30, 60, 120, 300, 600, 1200, 1800, 3600, 7200, 14400, 43200, 86400)
_MAX_TICKS = 8
_FILLS = {
    "STOP": "#d8d8d8", "PREPARE": "#ffe08a", "PREPARING": "#ffe08a", "GOAL_TX": "#b5d3f2", "WAITING_GOAL": "#b5d3f2",
    "WAITING_RESULT": "#9ad79a", "EXECUTING": "#9ad79a", "RESULT_TX": "#e3b7e8",
}
_OTHER_FILL = "#ffffff"
_LETTER = 5.4  # width of a letter of the states' names


class LinkRows(NamedTuple):
    """The states that are drawn below the link record."""

    box: Sequence[Stretch]
    robot: Sequence[Stretch]


class _Column(NamedTuple):
    """Consecutive seconds of the record that are drawn together."""

    begin_utc: float
    end_utc: float
    begin_x: float
    end_x: float
    lost: int
    unanswered: int
    gap_s: float
    late_s: float
    round_trip_s: Optional[float]
    round_trip_max_s: Optional[float]
    skew_s: Optional[float]


class _Scale(NamedTuple):
    """Maps UTC seconds to x coordinates."""

    begin: float
    end: float

    def x(self, utc: float) -> float:
        share = (utc - self.begin) / (self.end - self.begin)
        return LEFT + min(1.0, max(0.0, share)) * (WIDTH - LEFT - RIGHT)


class _Strip:
    """The strip of one quantity: where it is, and the scale of its values."""

    def __init__(self, top: float, low: float, high: float) -> None:
        self.top, self.low, self.high = top, low, high

    def y(self, value: float) -> float:
        share = (min(self.high, max(self.low, value)) - self.low) / (self.high - self.low)
        return self.top + STRIP * (1.0 - share)

    def frame(self, title: str, unit: str) -> Markup:
        bottom = self.top + STRIP
        return joined((
            tag("rect", x=LEFT, y=self.top, width=WIDTH - LEFT - RIGHT, height=STRIP, fill="none", stroke="#999"),
            _text(2, self.top + 10, title, weight="bold"), _text(2, self.top + 21, unit),
            _text(LEFT - 3, self.top + 8, f"{self.high:.3g}", anchor="end"),
            _text(LEFT - 3, bottom, f"{self.low:.3g}", anchor="end"),
        ))

    def level(self, value: float) -> Markup:
        """A horizontal line at a value."""
        if not self.low < value < self.high:
            return Markup("")
        y = _n(self.y(value))
        return tag("line", x1=LEFT, x2=WIDTH - RIGHT, y1=y, y2=y, stroke="#b00", stroke_dasharray="3 3")


def link_plot(link: Sequence[LinkSecond], begin_utc: float, end_utc: float, rows: LinkRows, in_utc: bool) -> Markup:
    """Draw the link record of a run from `begin_utc` to `end_utc`."""
    scale = _Scale(begin_utc, max(end_utc, begin_utc + 1.0))
    columns = _columns(link, scale)
    parts: List[Markup] = []
    top = 4.0
    for draw in (_silence, _losses, _delays, _skews):
        parts.append(draw(columns, top))
        top += STRIP + SPACE
    parts.append(_no_record(link, scale, top - SPACE))
    parts += [_states("Box", rows.box, scale, top), _states("Robot", rows.robot, scale, top + ROW + 3)]
    top += 2 * ROW + 3
    parts.append(_axis(scale, top, in_utc))
    return tag(
        "svg", *parts, xmlns="http://www.w3.org/2000/svg", viewBox=f"0 0 {WIDTH:g} {top + 18:g}", role="img",
        font_family="DejaVu Sans, Verdana, sans-serif", font_size="8",
    )


def _columns(link: Sequence[LinkSecond], scale: _Scale) -> List[_Column]:
    """Combine neighbouring samples so that there are at most `MAX_COLUMNS`."""
    together = max(1, math.ceil(len(link) / MAX_COLUMNS))
    fields = LinkSample(*zip(*(second.sample for second in link)))  # each field has the values of all samples
    found: List[_Column] = []
    for i in range(0, len(link), together):
        part = slice(i, i + together)
        last = min(i + together, len(link)) - 1
        begin, end = max(link[i].utc - link[i].sample.seconds, scale.begin), link[last].utc
        found.append(_Column(
            begin, end, _n(scale.x(begin)), _n(scale.x(end)), sum(fields.lost[part]), sum(fields.unanswered[part]),
            max(fields.gap_s[part]), max(fields.late_s[part]), _extreme(min, fields.round_trip_s[part]),
            _extreme(max, fields.round_trip_max_s[part]), _extreme(max, fields.skew_s[part]),
        ))
    return found


def _extreme(of: Callable[..., float], values: Sequence[Optional[float]]) -> Optional[float]:
    known = [value for value in values if value is not None]
    return of(known) if known else None


def _bars(columns: List[_Column], strip: _Strip, value: Callable[[_Column], float], fill: str) -> Markup:
    """A bar from 0 to the value of each column."""
    path, base = [], _n(strip.y(0.0))
    for column in columns:
        height = value(column)
        if height:
            x = column.begin_x
            path.append(f"M{x} {base}H{max(column.end_x, _n(x + 0.6))}V{_n(strip.y(height))}H{x}Z")
    return tag("path", d="".join(path), fill=fill) if path else Markup("")


def _silence(columns: List[_Column], top: float) -> Markup:
    strip = _Strip(top, 0.0, max([4.0, *(c.gap_s for c in columns)]))
    return joined((
        _bars(columns, strip, lambda c: c.gap_s, "#555"), strip.level(SILENT_S), strip.frame("Silence", "s"),
    ))


def _losses(columns: List[_Column], top: float) -> Markup:
    """Bars above the middle: lost on the way to the box. Below: lost on the way to the robot."""
    most = max([5, *(max(c.lost, c.unanswered) for c in columns)])
    strip = _Strip(top, -most, most)
    return joined((
        _bars(columns, strip, lambda c: c.lost, "#c33"),
        _bars(columns, strip, lambda c: -c.unanswered, "#36c"), strip.frame("Lost", "datagrams"),
        _text(2, top + 33, "above: to the box"), _text(2, top + 43, "below: to the robot"),
    ))


def _delays(columns: List[_Column], top: float) -> Markup:
    trips = [(c, t) for c in columns for t in {c.round_trip_s, c.round_trip_max_s} if t is not None]
    strip = _Strip(top, 0.0, max([0.2, *(c.late_s for c in columns), *(t for _, t in trips)]))
    dots = [
        tag("circle", cx=_n((c.begin_x + c.end_x) / 2), cy=_n(strip.y(t)), r=1.8, fill="#36c")
        for c, t in trips
    ]
    return joined((
        _bars(columns, strip, lambda c: c.late_s, "#888"), *dots, strip.frame("Delay", "s"),
        _text(2, top + 33, "bars: late messages"), _text(2, top + 43, "dots: round trips"),
    ))


def _skews(columns: List[_Column], top: float) -> Markup:
    known = [c for c in columns if c.skew_s is not None]
    most = max([1.2 * ALLOWED_SKEW_S, *(abs(c.skew_s) for c in known)])
    strip = _Strip(top, -most, most)
    path, before = [], -math.inf
    for c in known:
        joins = c.begin_utc - before < NO_RECORD_S
        path.append(f"{'L' if joins else 'M'}{c.begin_x} {_n(strip.y(c.skew_s))}H{c.end_x}")
        before = c.end_utc
    return joined((
        strip.level(ALLOWED_SKEW_S), strip.level(-ALLOWED_SKEW_S),
        tag("path", d="".join(path), fill="none", stroke="#111"), strip.frame("Clock skew", "s"),
    ))


def _no_record(link: Sequence[LinkSecond], scale: _Scale, bottom: float) -> Markup:
    """Grey areas where there is no record."""
    recorded = [(second.utc - second.sample.seconds, second.utc) for second in link]
    parts: List[Markup] = []
    for (_, end), (begin, _) in zip([(0.0, scale.begin), *recorded], [*recorded, (scale.end, 0.0)]):
        if begin - end > NO_RECORD_S:
            x = scale.x(end)
            parts.append(tag("rect", tag("title", "no record: the box was down"), x=_n(x), y=4,
                             width=_n(scale.x(begin) - x), height=_n(bottom - 4), fill="#000", fill_opacity="0.12"))
    return joined(parts)


def _states(title: str, stretches: Sequence[Stretch], scale: _Scale, top: float) -> Markup:
    parts: List[Markup] = [_text(2, top + 10, title, weight="bold")]
    for stretch in stretches:
        x, width = scale.x(stretch.begin_utc), scale.x(stretch.end_utc) - scale.x(stretch.begin_utc)
        seconds = f"{stretch.name}, {stretch.end_utc - stretch.begin_utc:.1f} s"
        parts.append(tag("rect", tag("title", seconds), x=_n(x), y=top, width=_n(max(width, 0.3)), height=ROW,
                         fill=_FILLS.get(stretch.name, _OTHER_FILL), stroke="#666", stroke_width="0.3"))
        if width > _LETTER * len(stretch.name) + 4:
            parts.append(_text(x + 3, top + 10.5, stretch.name))
    return joined(parts)


def _axis(scale: _Scale, top: float, in_utc: bool) -> Markup:
    seconds = scale.end - scale.begin
    step = next((s for s in _STEPS_S if seconds / s <= _MAX_TICKS), seconds / _MAX_TICKS)
    parts: List[Markup] = []
    tick = math.ceil(scale.begin / step) * step
    while tick <= scale.end:
        x = _n(scale.x(tick))
        parts += [
            tag("line", x1=x, x2=x, y1=4, y2=_n(top), stroke="#000", stroke_opacity="0.15"),
            _text(x, top + 12, time_with_tenths(tick, in_utc)[:8], anchor="middle" if x < WIDTH - 40 else "end"),
        ]
        tick += step
    return joined(parts)


def _text(x: float, y: float, text: str, anchor: Optional[str] = None, weight: Optional[str] = None) -> Markup:
    return tag("text", text, x=_n(x), y=_n(y), text_anchor=anchor, font_weight=weight)


def _n(number: float) -> float:
    """Round a coordinate to two decimals."""
    return round(number, 2)
