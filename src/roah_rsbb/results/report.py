"""The report of a competition: statistics of its runs, as a folder of pages (docs/results.md, "Report").

All texts of robots and people are escaped (`results/page.py`). The data of plots is JSON, which
resource/report/report.js draws with uPlot. uPlot 1.6.32 (MIT licence, https://github.com/leeoniya/uPlot) is part of
each page with a plot, so the pages work offline and can be mailed. Each plot stands beside a table with the same
numbers.
"""

from typing import Any, Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple

from roah_rsbb.results.page import (
    NO_COMPETITION,
    Child,
    Competition,
    Markup,
    joined,
    json_block,
    page,
    resource_texts,
    table,
    tag,
)
from roah_rsbb.results.report_numbers import (
    LATE_S,
    LINK_PERIODS_S,
    ItemLine,
    LinkFacts,
    RunFacts,
    Spread,
    delay_lines,
    end_lines,
    goal_lines,
    item_lines,
    link_of_teams,
    links,
    phase_lines,
    spread,
    teams,
    unsigned,
)
from roah_rsbb.results.runs import run_state_text, taken_text
from roah_rsbb.results.standing_pages import linked, standing_markup
from roah_rsbb.results.standings import benchmark_name
from roah_rsbb.scoring.standings import Standing
from roah_rsbb.wording import sheets
from roah_rsbb.wording.texts import one_line, visible
from roah_rsbb.wording.times import NOTHING, date_time, optional_date_time

STYLE = """
body { max-width: 270mm; } nav { margin: 0 0 4mm; display: flex; flex-wrap: wrap; gap: 1mm 5mm; }
.wide { overflow-x: auto; } .wide th[role] { cursor: pointer; } .wide th[aria-sort=ascending]::after { content: " ▲"; }
.wide th[aria-sort=descending]::after { content: " ▼"; } .wide td { white-space: normal; } .plot { margin: 2mm 0; }
.wide td.share, .wide td.from { white-space: nowrap; } meter { width: 18mm; vertical-align: middle; }
.uplot { font: 9pt "IBM Plex Sans", "DejaVu Sans", Verdana, sans-serif; } .u-legend { font-size: 9pt; }
table.u-legend { width: auto; } .u-legend td, .u-legend th { border: 0; min-width: 0; }
@media screen { html { background: var(--surface-page); }
  body { padding: 2mm 6mm 6mm; border-radius: 3mm; background: #fff; }
  nav { gap: 0 5mm; border-bottom: .3mm solid var(--line); } a { color: inherit; }
  nav > * { padding: 2mm 0 1.5mm; border-bottom: .8mm solid transparent; font-weight: bold; text-decoration: none;
    color: var(--text-quiet); } nav > :not(a) { border-color: var(--text); color: var(--text); } }
@media screen and (max-width: 150mm) { .wide td { min-width: 20mm; } .wide td:last-child { min-width: 50mm; } }
@media print { nav { display: none; } .wide { overflow: visible; } body { font-size: 8pt; }
  @page { size: A4 landscape; } }
"""
# More lines in a plot cannot be distinguished.
MAX_SERIES = 24


# -- plots ------------------------------------------------------------------------------------------

# More ticks of an axis cannot be read.
MAX_TICKS = 24


class Assets(NamedTuple):
    """The files that become part of the pages."""

    library: str
    style: str
    script: str


def assets(folder: str) -> Assets:
    """Read the files in the package's folder resource/report. Raises OSError."""
    return Assets(*resource_texts(folder, "uPlot.iife.min.js", "uPlot.min.css", "report.js"))


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


# -- the pages --------------------------------------------------------------------------------------


class Site(NamedTuple):
    """What all pages of a competition need."""

    runs: Sequence[RunFacts]
    standings: Sequence[Standing]
    sheets: Mapping[str, str]  # files of the runs' sheets by identity
    replays: Mapping[str, str]  # files of the runs' replays by identity
    titles: Mapping[str, str]  # of the benchmarks
    as_of_utc: float
    in_utc: bool
    assets: Assets
    competition: Competition = NO_COMPETITION
    home: str = ""  # the page that compares competitions; empty: none
    link_period_s: int = LINK_PERIODS_S[-1]


PAGES = (
    ("index.html", "Standings"), ("runs.html", "Runs"), ("teams.html", "Teams"), ("items.html", "Items"),
    ("times.html", "Times"), ("link.html", "Link"), ("missing.html", "Missing"),
)


def all_pages(site: Site) -> Dict[str, str]:
    """Return the pages by their file names."""
    builders = (_standings, _runs, _teams, _items, _times, _links, _missing)
    return {name: _page(site, name, title, builder(site)) for (name, title), builder in zip(PAGES, builders)}


def _page(site: Site, name: str, title: str, body: List[Child]) -> str:
    items = [tag("b", text) if file == name else tag("a", text, href=file) for file, text in PAGES]
    if site.home:
        items.insert(0, tag("a", "All competitions", href=site.home))
    return report_page(
        title, site.assets, site.competition.markup(), tag("nav", *items), tag("h1", title),
        tag("p", f"{len(site.runs)} {'run' if len(site.runs) == 1 else 'runs'}. As of "
                 f"{date_time(site.as_of_utc, site.in_utc)}", class_="small"), *body)


def report_page(title: str, assets: Assets, *body: Child) -> str:
    """Build a page with the style and the scripts of a report."""
    has_plot = any('class="plot"' in part for part in body if isinstance(part, Markup))
    scripts = (assets.library, assets.script) if has_plot else (assets.script,)
    return page(title, *body, scripts=scripts, style=STYLE + (assets.style if has_plot else ""))


def sortable(headings: Sequence[Child], rows: Sequence[Sequence[Child]], classes: Sequence[str] = ()) -> Markup:
    """Build a table that a click on a heading sorts."""
    markup = table(headings, rows, classes)
    return tag("div", Markup(markup.replace("<table>", '<table class="sorted">', 1)), class_="wide")


def seconds_text(seconds: Optional[float]) -> str:
    """Return seconds for a column of numbers."""
    return NOTHING if seconds is None else f"{seconds:.1f}"


def share_markup(share: Optional[float]) -> Child:
    """Return a share in per cent with a bar."""
    if share is None:
        return NOTHING
    return joined((f"{share:.0%} ", tag("meter", Markup(""), min=0, max=1, value=round(share, 4))))


# -- pages ------------------------------------------------------------------------------------------


def _standings(site: Site) -> List[Child]:
    if not site.standings:
        return [tag("p", "No run has started yet.")]
    return [tag("div", standing_markup(standing, site.sheets), class_="wide") for standing in site.standings]


def _runs(site: Site) -> List[Child]:
    rows = [
        (str(run.number), date_time(r.opened_utc, site.in_utc), r.zone, linked(r.benchmark, r.identity, site.sheets),
         r.team, f"{r.round} / {r.run}", taken_text(r), _points(run),
         run_state_text(r, run.counts), str(len(r.stops)), str(run.warnings),
         sheets.sheet_state(r.closed_utc, r.sign_off),
         linked("replay", r.identity, site.replays) if r.identity in site.replays else "")
        for run in site.runs for r in (run.record,)
    ]
    return [sortable(
        ("No.", "Connected", "Zone", "Benchmark", "Team", "Round / run", "Time", "Points", "State", "Ends", "Warnings",
         "Sheet", *(("Replay",) if site.replays else ())),
        [row if site.replays else row[:-1] for row in rows],
        ("number", "when", "", "", "team", "", "number", "number", "", "number", "number"))]


def _points(run: RunFacts) -> str:
    return run.record.points.total if run.record.points is not None else ""


def _teams(site: Site) -> List[Child]:
    ranks: Dict[str, List[str]] = {}
    for standing in site.standings:
        for line in standing.lines:
            name = standing.benchmark or standing.title
            ranks.setdefault(line.team, []).append(f"{one_line(name)}: {line.rank}{'=' if line.tied else ''}")
    links = link_of_teams(site.runs)
    rows = []
    for team in teams(site.runs):
        runs = [run for run in site.runs if run.record.team == team]
        delays = spread(run.delay_s for run in runs)
        link = links.get(team, LinkFacts())
        rows.append((
            team, str(len(runs)), str(sum(run.is_over for run in runs)),
            str(sum(run.record.end_reason == "completed" for run in runs)),
            str(len(unsigned(runs))), _minutes(delays.median), _percent(link.lost_share),
            seconds_text(link.longest_gap_s if link.seconds else None), ", ".join(ranks.get(team, ())) or NOTHING))
    body: List[Child] = [sortable(
        ("Team", "Runs", "Started and over", "Completed", "Not signed off", "Median delay, min", "Lost messages, %",
         "Longest silence, s", "Ranks"), rows,
        ("team", *("number",) * 7))]
    for team in teams(site.runs):
        runs = [run for run in site.runs if run.record.team == team]
        body += [tag("h2", team), tag("p", *_separated(
            linked(f"{run.record.benchmark} {run.record.round} / {run.record.run}", run.record.identity, site.sheets)
            for run in runs))]
    return body


def _separated(children) -> List[Child]:
    found: List[Child] = []
    for child in children:
        found += [", ", child] if found else [child]
    return found


def _minutes(seconds: Optional[float]) -> str:
    return NOTHING if seconds is None else f"{seconds / 60.0 + 0.0:.1f}"


def _percent(share: Optional[float]) -> str:
    return NOTHING if share is None else f"{100.0 * share:.2f}"


_COUNTED = ("Runs count that were started and are over. An item is achieved, or a penalty given, if its value is not 0 "
            "at the end.")


def _items(site: Site) -> List[Child]:
    body: List[Child] = [tag("p", f"{_COUNTED} The time is from the last start to its first mark.")]
    lines = item_lines(site.runs)
    for number, code in enumerate(dict.fromkeys(line.benchmark for line in lines)):
        of_code = [line for line in lines if line.benchmark == code]
        body.append(tag("h2", _benchmark(site, code)))
        body.append(plot(f"items{number}", Axes("Item", "Runs, %", 100.0, bars=True), [
            str(i) for i in range(1, len(of_code) + 1)], {"achieved": [100.0 * line.share for line in of_code]}))
        body.append(sortable(
            ("No.", "Group", "Item", "Runs", "Achieved", "Share", "Not attempted", "First after, s: least", "median",
             "most"),
            [(str(i), line.group, line.name, str(line.runs), str(line.achieved), share_markup(line.share),
              str(line.not_attempted), *_spread(line.after_s)) for i, line in enumerate(of_code, 1)],
            ("number", "", "what", "number", "number", "share", *("number",) * 4)))
    return body


def _spread(numbers: Spread) -> Tuple[str, str, str]:
    return seconds_text(numbers.least), seconds_text(numbers.median), seconds_text(numbers.most)


def _benchmark(site: Site, code: str) -> str:
    return benchmark_name(code, site.titles.get(code, ""))


def _times(site: Site) -> List[Child]:
    return [*_ends(site), *_delays(site), *_time_tables(site)]


def _ends(site: Site) -> List[Child]:
    lines = end_lines(site.runs)
    reasons = sorted({reason for line in lines for reason in line.ends})
    headings = [sheets.end_reason(reason) if reason else "never started, or not over" for reason in reasons]
    return [
        tag("h2", "Ends and attempts"),
        sortable(("Benchmark", "Runs", *headings, "Restarts in runs", "Repeated runs"), [
            (_benchmark(site, line.benchmark), str(line.runs), *(str(line.ends.get(reason, 0)) for reason in reasons),
             str(line.restarts), str(line.repeated)) for line in lines
        ], ("", *("number",) * (len(reasons) + 3))),
    ]


def _delays(site: Site) -> List[Child]:
    body: List[Child] = [
        tag("h2", "Delays against the schedule"),
        tag("p", "From the scheduled time to the last start, in minutes."),
        sortable(("Zone", "Starts", "Least", "Median", "Most", f"More than {LATE_S / 60:.0f} min late"), [
            (line.zone, str(line.delays_s.count), _minutes(line.delays_s.least), _minutes(line.delays_s.median),
             _minutes(line.delays_s.most), str(line.late)) for line in delay_lines(site.runs)
        ], ("", *("number",) * 5)),
    ]
    started = sorted((run.record.scheduled, run.record.zone, run.delay_s) for run in site.runs
                     if run.delay_s is not None)
    if started:
        moments = sorted({scheduled for scheduled, _, _ in started})
        place = {moment: i for i, moment in enumerate(moments)}
        values: Dict[str, List[Optional[float]]] = {}
        for scheduled, zone, delay in started:
            values.setdefault(zone, [None] * len(moments))[place[scheduled]] = delay / 60.0
        body.insert(2, plot(
            "delays", Axes("Scheduled", "Delay, min"), [date_time(moment, site.in_utc)[5:16] for moment in moments],
            dict(sorted(values.items())[:MAX_SERIES]), [moment - moments[0] for moment in moments]))
    return body


def _time_tables(site: Site) -> List[Child]:
    body: List[Child] = []
    for title, what, lines in (
        ("Times of phases", "Phase", phase_lines(site.runs)),
        ("Times of goals", "Goal", goal_lines(site.runs)),
    ):
        if not lines:
            continue
        body += [tag("h2", title), sortable(
            ("Benchmark", what, "Runs", "Ended", "Seconds: least", "median", "most"),
            [(line.benchmark, line.name, str(line.runs), str(line.seconds.count), *_spread(line.seconds))
             for line in lines], ("", "", *("number",) * 5))]
    return body


def _links(site: Site) -> List[Child]:
    found = links(site.runs)
    if not found:
        return [tag("p", "There is no record of any link.")]
    begins = sorted({begin for _, begin in found})
    # An empty period after each, unless it is there: no line crosses a night.
    begins = sorted({*begins, *(begin + site.link_period_s for begin in begins[:-1])})
    names = sorted({team for team, _ in found})
    values = {team: [_hundred(found.get((team, begin), LinkFacts()).lost_share) for begin in begins] for team in names}
    ranked = sorted(names, key=lambda team: (-(max((v or 0.0) for v in values[team])), team))
    labels = [date_time(begin, site.in_utc)[5:16] for begin in begins]
    return [
        tag("p", "Messages that were lost on the way to the box, in per cent of those that were due, in periods of "
                 f"{site.link_period_s // 60} min."),
        plot("lost", Axes("Begin of the period", "Lost messages, %", 1.0), labels,
             {team: values[team] for team in ranked[:MAX_SERIES]}, [begin - begins[0] for begin in begins]),
        *([tag("p", f"The plot shows the {MAX_SERIES} teams with the largest losses.", class_="small")]
          if len(names) > MAX_SERIES else []),
        sortable(("Team", "From", "Received", "Lost", "Lost, %", "Longest silence, s", "Latest message, s behind",
                  "Seconds"), [
            (team, date_time(begin, site.in_utc)[:16], str(link.received), str(link.lost), _percent(link.lost_share),
             seconds_text(link.longest_gap_s), f"{link.latest_s:.3f}", f"{link.seconds:.0f}")
            for (team, begin), link in found.items()
        ], ("team", "from", *("number",) * 6)),
        tag("p", "docs/results.md explains how each number is measured and what its limits are.", class_="small"),
    ]


def _hundred(share: Optional[float]) -> Optional[float]:
    return None if share is None else 100.0 * share


def _missing(site: Site) -> List[Child]:
    missing = unsigned(site.runs)
    still = [run for run in site.runs if not run.record.closed_utc]
    body: List[Child] = [
        tag("p", f"{len(missing)} of {sum(bool(run.record.end_reason) for run in site.runs)} runs that are over are "
                 "not signed off.")]
    if missing:
        body.append(sortable(("No.", "Run", "Zone", "Ended", "State"), [
            (str(run.number), linked(sheets.run_name(r.benchmark, r.team, r.round, r.run), r.identity, site.sheets),
             r.zone, optional_date_time(r.closed_utc, site.in_utc), run_state_text(r))
            for run in missing for r in (run.record,)
        ], ("number", "what", "", "when")))
    if still:
        body += [tag("h2", "Still connected"), tag("p", *_separated(
            linked(sheets.run_name(r.benchmark, r.team, r.round, r.run), r.identity, site.sheets)
            for run in still for r in (run.record,)))]
    return body


# -- several competitions ---------------------------------------------------------------------------


class Compared(NamedTuple):
    """A competition beside others."""

    name: str
    home: str  # the file of its first page
    site: Site


def comparison(sites: Sequence[Compared], assets: Assets) -> str:
    """Build the page that compares competitions."""
    rows = []
    for each in sites:
        runs = each.site.runs
        over = [run for run in runs if run.is_over]
        delays = spread(run.delay_s for run in runs)
        total = LinkFacts()
        for link in link_of_teams(runs).values():
            total = total.plus(link)
        rows.append((
            tag("a", each.name, href=each.home), str(len(runs)), str(len(teams(runs))), str(len(over)),
            str(sum(run.record.end_reason == "completed" for run in over)), _minutes(delays.median),
            _percent(total.lost_share), str(len(unsigned(runs)))))
    body: List[Child] = [sortable(
        ("Competition", "Runs", "Teams", "Started and over", "Completed", "Median delay, min", "Lost messages, %",
         "Not signed off"), rows, ("", *("number",) * 7))]
    lines = {
        each.name: {(line.benchmark, line.group, line.name): line for line in item_lines(each.site.runs)}
        for each in sites
    }
    keys = list(dict.fromkeys(key for each in sites for key in lines[each.name]))
    if keys:
        body += [tag("h2", "Items"), tag("p", _COUNTED)]
    for number, code in enumerate(dict.fromkeys(key[0] for key in keys)):
        of_code = [key for key in keys if key[0] == code]
        site = next((each.site for each in sites if each.site.titles.get(code)), sites[0].site)
        shares = {each.name: [_achieved(lines[each.name].get(key)) for key in of_code] for each in sites}
        body += [
            tag("h3", _benchmark(site, code)),
            plot(f"items{number}", Axes("Item", "Runs, %", 100.0, lines=False),
                 [str(i) for i in range(1, len(of_code) + 1)],
                 {name: [_hundred(share) for share in each] for name, each in shares.items()}),
            sortable(("No.", "Group", "Item", *(f"{each.name}: achieved" for each in sites)), [
                (str(i), key[1], key[2], *(share_markup(shares[each.name][i - 1]) for each in sites))
                for i, key in enumerate(of_code, 1)
            ], ("number", "", "what", *("share",) * len(sites))),
        ]
    return report_page("Competitions", assets, tag("h1", "Competitions"), *body)


def _achieved(line: Optional[ItemLine]) -> Optional[float]:
    return None if line is None else line.share
