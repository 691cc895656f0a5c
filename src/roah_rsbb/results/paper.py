"""The front page of a score sheet: one A4 page with everything that is signed, filled in or blank.

It has the run, its scores with units, points and totals, remarks, and lines for two signatures. A long sheet is set in
two or three columns of smaller letters. Text that is too long for the page is cut with "…". The appendix has all of it.
"""

from decimal import Decimal
from fractions import Fraction
from functools import partial
from typing import Dict, Iterable, Iterator, List, NamedTuple, Optional, Sequence, Tuple

from roah_rsbb.model.reason import Reason
from roah_rsbb.model.records import ItemRecord, RunRecord, SheetPoints
from roah_rsbb.model.scoring import ScoreKind, ScoringItem
from roah_rsbb.results.page import NO_COMPETITION, Child, Competition, Markup, tag
from roah_rsbb.results.runs import run_state_text, signature_of, taken_s, taken_text
from roah_rsbb.results.standings import DISQUALIFIED, benchmark_name, criteria_of, number_text, number_with_unit
from roah_rsbb.rulebook.benchmarks import NO_LIMIT, Benchmark, ScheduledEvent
from roah_rsbb.rulebook.standing_rules import DEFAULT, Rules
from roah_rsbb.scoring.counting import amount_of, exact
from roah_rsbb.scoring.standings import standing_of_run
from roah_rsbb.scoring.timeline import captain_signs
from roah_rsbb.scoring.tree import LATE, RULINGS
from roah_rsbb.wording import sheets
from roah_rsbb.wording.sheets import counting_text, scores_by_group
from roah_rsbb.wording.texts import one_line
from roah_rsbb.wording.timeline import captain_text
from roah_rsbb.wording.times import NOTHING, date_time, elapsed, optional_date_time

SIGNERS = ("Referee: name, date, signature", "Team: name, date, signature")
# Further remarks are only in the appendix. The empty lines below them are for handwriting.
MAX_REMARKS = 5
EMPTY_LINES, EMPTY_LINES_BLANK = 2, 5
_YES_OR_NO = "☐\u00a0yes ☐\u00a0no"  # no line ends between a box and its answer
# The longest texts on the page, characters.
MAX_FACT, MAX_ITEM, MAX_VALUE, MAX_REMARK = 60, 110, 30, 150
MORE = "… {} more in the appendix"


class Layout(NamedTuple):
    """How the scores are set."""

    name: str  # CSS class
    columns: int
    line_mm: float  # height of a line
    letters: int  # in a line, beside value and points


# The first one that holds all scores is used.
LAYOUTS = (Layout("one", 1, 5.6, 70), Layout("two", 2, 4.6, 33), Layout("three", 3, 3.6, 22))
# Height for the scores: somewhat less than the page has, because columns cannot be filled evenly. Facts that take
# several lines, and remarks, reduce it.
SCORES_MM = 135.0
FACT_MM, FACT_LETTERS = 4.8, 33
COMPETITION_MM = 17.0
MAX_COMPETITION = 70  # letters of its title
REMARK_MM, REMARK_LETTERS = 5.0, 80


class Line(NamedTuple):
    """A scoring item, or a value of the benchmarking module."""

    what: str
    value: str
    points: str = ""


class Group(NamedTuple):
    """Lines with a title."""

    title: str
    lines: Tuple[Line, ...]


class Front(NamedTuple):
    """The texts of the page."""

    title: str
    state: str  # below the title: whether the sheet is signed off
    facts: Tuple[Tuple[str, str], ...]
    groups: Tuple[Group, ...]
    totals: Tuple[Tuple[str, str], ...]
    remarks: Tuple[str, ...]
    empty_lines: int
    competition: Competition = NO_COMPETITION
    captain: Tuple[str, str] = (SIGNERS[1], "")  # what stands below the team's line, and the signature on it


def cut(text: str, letters: int) -> str:
    """Return a text in one line of limited length."""
    text = one_line(text)
    return text if len(text) <= letters else text[:letters - 1] + "…"


# -- the texts --------------------------------------------------------------------------------------


def front_of(record: RunRecord, rules: Optional[Rules], title: str, in_utc: bool, counts: str = "") -> Front:
    """Return the texts of a run's front page. `title`: the benchmark's title; empty: not known. `counts`: whether the
    run counts, see `RunResult`."""
    ended = run_state_text(record) + (f", after {taken_text(record)} min" if taken_s(record) is not None else "")
    return Front(
        benchmark_name(record.benchmark, title),
        "Annulled: it counts nothing" if record.is_annulled else
        "Score sheet" if record.sign_off else "Score sheet, not signed off: may still change",
        (
            ("Team", record.team), ("Round, run", f"{record.round}, {record.run}"),
            ("Robot", robots_of(record)), ("Zone", record.zone),
            ("Scheduled", date_time(record.scheduled, in_utc)),
            ("Started", optional_date_time(record.started_utc, in_utc)),
            ("Disconnected", optional_date_time(record.closed_utc, in_utc)), ("End", ended),
            ("Sheet", signature_of(record, in_utc)), ("Run", record.identity),
            *([("Counting", counting_text(counts)), ("", "")] if counts else []),
        ),
        (*_item_groups(record, rules), *_module_groups(record)),
        tuple(_totals(record, rules)),
        tuple(_remarks(record)),
        EMPTY_LINES, captain=_captain_of(record, in_utc),
    )


def _captain_of(record: RunRecord, in_utc: bool) -> Tuple[str, str]:
    """Return what stands below the team's line, and the signature on it."""
    if not record.captain:
        return SIGNERS[1], ""
    sign = captain_signs(record)[-1]
    text = captain_text(sign, partial(date_time, in_utc=in_utc))
    return cut(f"{text}: {sign.comment}" if sign.comment else text, MAX_FACT), sign.drawing


def robots_of(record: RunRecord) -> str:
    """Return the robots of a run in words."""
    by_hand = "none: scored by hand" if record.started_utc else NOTHING
    return ", ".join(record.robots) or by_hand


def _limit_text(seconds: float) -> str:
    return "none" if seconds == NO_LIMIT else f"{elapsed(seconds)} min"


def blank_front(
    benchmark: Benchmark, zone: str = "", event: Optional[ScheduledEvent] = None, in_utc: bool = False
) -> Front:
    """Return the texts of a sheet to be filled in by hand: of an event, or of any run of a benchmark."""
    known = event is not None
    groups: Dict[str, List[ScoringItem]] = {}
    for item in benchmark.form.items:
        groups.setdefault(item.group, []).append(item)
    return Front(
        benchmark_name(benchmark.code, benchmark.title),
        "Score sheet, to be filled in by hand",
        (
            ("Team", event.team if known else ""), ("Round, run", f"{event.round}, {event.run}" if known else ""),
            ("Robot", ""), ("Zone", zone),
            ("Scheduled", date_time(event.scheduled, in_utc) if known else ""), ("Started", ""),
            ("Ended", ""), ("Time limit", _limit_text(benchmark.total_timeout)),
            ("Time", ""), ("End", "☐ completed  ☐ stopped  ☐ timeout"),
        ),
        tuple(Group(name, tuple(map(_blank_line, items))) for name, items in groups.items()),
        (("Total", ""),),
        (),
        EMPTY_LINES_BLANK,
    )


def _blank_line(item: ScoringItem) -> Line:
    """Return the line of an item to be filled in by hand, with the points that it gives."""
    if item.kind is ScoreKind.CHOICE:
        choices = "  ".join(f"☐ {choice.name}{_in_brackets(choice.points)}" for choice in item.choices)
        return Line(f"{item.desc}: {choices}", "")
    if item.kind is ScoreKind.RATING:
        return Line(f"{item.desc}{_in_brackets(item.points)}", "  ".join(f"{judge}: __" for judge in item.judges))
    if item.kind is ScoreKind.DECIMAL and not item.unit and item.points == 1:
        return Line(item.desc, "points")
    return Line(f"{item.desc}{_in_brackets(item.points)}", _blank_value(item))


def _blank_value(item: ScoringItem) -> str:
    """Return what stands where the value is written: its answers, its unit, or the most of a count."""
    if item.kind is ScoreKind.BOOL:
        return _YES_OR_NO
    return item.unit or ("" if item.most is None else f"≤ {number_text(exact(item.most))}")


def _in_brackets(points: Optional[Decimal]) -> str:
    return "" if points is None else f" ({number_text(exact(points))})"


def _item_groups(record: RunRecord, rules: Optional[Rules]) -> Iterator[Group]:
    if record.points is not None:
        yield from _groups_with_points(record, record.points)
        return
    rules = rules or DEFAULT
    for name, items in sheets.grouped_shown(record.items).items():
        lines = [Line(_what(item), _value(item), _points(rules, [item])) for item in items]
        total = _points(rules, items)
        if total and len(items) > 1:
            lines.append(Line(f"Total of {name}", "", total))
        yield Group(name, tuple(lines))


def _groups_with_points(record: RunRecord, points: SheetPoints) -> Iterator[Group]:
    """Yield the groups of a sheet that gives points."""
    totals = dict(points.groups)
    groups = sheets.grouped_shown(record.items)
    for name, items in groups.items():
        lines = [Line(_what(item), _value(item), item.points) for item in items]
        if name in totals and (len(items) > 1 or totals[name] != items[0].points):
            lines.append(Line(f"Total of {name}", "", totals[name]))
        yield Group(name, tuple(lines))
    for name in totals:
        if name not in groups:
            yield Group(name, (Line("Bonus", "", totals[name]),))


def _what(item: ItemRecord) -> str:
    return f"{item.desc} ({sheets.CORRECTED})" if item.corrected else item.desc


def _value(item: ItemRecord) -> str:
    text = sheets.in_words(item)
    return f"{text} ×" if item.kind in ("uint", "int") and text == str(item.value) else text


def _points(rules: Rules, items: Sequence[ItemRecord]) -> str:
    """Return what items contribute to the criteria of the ranking; empty: they do not count."""
    counted = [
        exact(term.weight) * amount_of(item)
        for item in items for criterion in rules.criteria for term in criterion.terms
        if term.counts(item.group, item.desc)
    ]
    return number_text(sum(counted, Fraction(0))) if counted else ""


def _module_groups(record: RunRecord) -> Iterator[Group]:
    for name, lines in scores_by_group(record.module_scores):
        yield Group(f"Module: {name}", tuple(Line(line.name, line.value) for line in lines))


def _totals(record: RunRecord, rules: Optional[Rules]) -> Iterator[Tuple[str, str]]:
    """Yield the points, and the numbers by which the run is ranked."""
    if record.points is not None:
        yield "Points", record.points.total
        if record.points.for_team:
            yield "For the team", record.points.for_team
    if not record.started_utc or (record.points is not None and rules is None):
        return
    standing = standing_of_run(record, rules)
    (team,) = standing.lines
    for name, number, unit in zip(criteria_of(standing), team.runs[0].numbers, standing.units):
        line = name, number_with_unit(number, unit)
        if record.points is None or line != ("Points", record.points.total):
            yield line
    if team.disqualified:
        yield "Result", DISQUALIFIED


def _remarks(record: RunRecord) -> Iterator[str]:
    yield from map(sheets.outage_text, record.outages)
    for stop in record.stops:
        if stop.reason:
            yield f"{stop.desc or sheets.end_reason(stop.end_reason)}: {stop.reason}"
    for entry in record.history:
        if entry.note and not entry.withdrawn_utc:
            yield f"{entry.desc}: {entry.note}"
    yield from _rulings(record)
    for objection in record.publication.objections:
        decision = f"{'upheld' if objection.upheld else 'rejected'}: {objection.answer}" if objection.answered_utc \
            else "not answered"
        yield f"Objection of {objection.by}: {objection.text}: {decision}"


def _rulings(record: RunRecord) -> Iterator[str]:
    """Yield what does not count on the sheet, and why. What came too late is one remark."""
    steps = [] if record.points is None else [step for step in record.points.steps if isinstance(step, Reason)]
    late = [step.values for step in steps if step.template == LATE]
    if late:
        marks = ", ".join(f"{each['item']} ({each['time']})" for each in late)
        yield f"After the limit of {late[0]['limit']}, so not counted: {marks}"
    yield from (step for step in steps if step.template in RULINGS and step.template != LATE)


# -- the page ---------------------------------------------------------------------------------------


def layout_of(front: Front) -> Tuple[Layout, Tuple[Group, ...]]:
    """Return the layout of a page's scores, and the groups cut to what fits."""
    height = SCORES_MM - _other_mm(front)
    for layout in LAYOUTS:
        if sum(_height(group, layout) for group in front.groups) <= layout.columns * int(height / layout.line_mm):
            return layout, front.groups
    layout = LAYOUTS[-1]
    left = layout.columns * int(height / layout.line_mm) - 2
    fitting, count = [], 0
    for group in front.groups:
        lines: List[Line] = []
        left -= 2
        for line in group.lines:
            left -= _lines(line, layout)
            if left < 0:
                break
            lines.append(line)
        if lines:
            fitting.append(group._replace(lines=tuple(lines)))
            count += len(lines)
    missing = sum(len(group.lines) for group in front.groups) - count
    return layout, (*fitting, Group(MORE.format(missing), ()))


def _other_mm(front: Front) -> float:
    """Return the height of the parts that not all pages have: the competition, remarks, facts of several lines."""
    facts = [wrapped_lines(cut(value, MAX_FACT), FACT_LETTERS) - 1 for _, value in front.facts]
    remarks = [min(2, wrapped_lines(cut(remark, MAX_REMARK), REMARK_LETTERS)) for remark in front.remarks[:MAX_REMARKS]]
    rows = [max(pair) for pair in zip(facts[::2], facts[1::2])]
    head = COMPETITION_MM if any(front.competition) else 0.0
    return head + FACT_MM * sum(rows) + REMARK_MM * sum(remarks)


def _height(group: Group, layout: Layout) -> int:
    """Return roughly how many lines a group takes. Its title counts as two."""
    return 2 + sum(_lines(line, layout) for line in group.lines)


def _lines(line: Line, layout: Layout) -> int:
    return wrapped_lines(cut(line.what, MAX_ITEM), layout.letters)


def wrapped_lines(text: str, letters: int) -> int:
    """Return how many lines a text takes, if a line breaks between words only."""
    lines, used = 1, 0
    for word in text.split():
        length = min(len(word), letters)
        if used and used + 1 + length > letters:
            lines, used = lines + 1, 0
        used += length + (1 if used else 0)
    return lines


def front_markup(front: Front) -> Markup:
    """Build the page."""
    layout, groups = layout_of(front)
    competition = front.competition._replace(title=cut(front.competition.title, MAX_COMPETITION))
    parts: List[Child] = [
        competition.markup(), tag("h1", cut(front.title, MAX_FACT)), tag("p", front.state), _facts(front.facts),
        tag("div", *(_group(group) for group in groups), class_=f"scores {layout.name}"),
    ]
    if front.totals:
        parts.append(tag("table", *_rows(front.totals), class_="totals"))
    parts += [tag("h2", "Remarks"), *_remark_lines(front)]
    below, drawing = front.captain
    drawn = [tag("svg", tag("path", d=drawing, fill="none", stroke="currentColor", stroke_width="3"),
                 viewBox="0 0 400 150")] if drawing else []
    signatures = tag("div", tag("div", SIGNERS[0]), tag("div", *drawn, below), class_="signatures")
    return tag("div", tag("div", *parts, class_="content"), signatures, class_="front")


def _facts(facts: Sequence[Tuple[str, str]]) -> Markup:
    """Build a table with two facts in each row."""
    cells = [(tag("th", name), tag("td", cut(value, MAX_FACT))) for name, value in facts]
    return tag("table", *(tag("tr", *pair, *other) for pair, other in zip(cells[::2], cells[1::2])), class_="facts")


def _group(group: Group) -> Markup:
    has_points = any(line.points for line in group.lines)
    rows = [
        tag("tr", tag("td", cut(line.what, MAX_ITEM)), tag("td", cut(line.value, MAX_VALUE), class_="value"),
            *((tag("td", line.points, class_="number"),) if has_points else ()))
        for line in group.lines
    ]
    heads: List[str] = ["Value", "Points"] if has_points else ["Value"]
    head = tag("tr", tag("th", cut(group.title, MAX_ITEM), class_="title"),
               *(tag("th", head, class_="number") for head in heads if group.lines))
    return tag("table", tag("tbody", head, *rows))  # no thead, which a browser repeats in the next column


def _rows(pairs: Iterable[Tuple[str, str]]) -> Iterator[Markup]:
    for name, value in pairs:
        yield tag("tr", tag("th", name), tag("td", value, class_="number"))


def _remark_lines(front: Front) -> Iterator[Markup]:
    for remark in front.remarks[:MAX_REMARKS]:
        yield tag("p", cut(remark, MAX_REMARK), class_="remark")
    if len(front.remarks) > MAX_REMARKS:
        yield tag("p", MORE.format(len(front.remarks) - MAX_REMARKS))
    for _ in range(front.empty_lines):
        yield tag("p", class_="line")

