"""Commands of `results` that rank runs and write files. Loading what they need takes longer than to list all runs."""

import argparse
import json
import os
import signal
import sys
from typing import Any, Callable, Dict, Iterable, Iterator, List, Mapping, NamedTuple, Optional, Sequence, Set, TextIO

from roah_rsbb.journal.log import names_in
from roah_rsbb.journal.reader import JournalReader, journal_in
from roah_rsbb.model.records import RunRecord
from roah_rsbb.results import lists
from roah_rsbb.results import standings as ranking
from roah_rsbb.results.dataset import DatasetOptions, names_of, write_dataset
from roah_rsbb.results.events import in_order, sections_of
from roah_rsbb.results.export import (
    RESULT_COLUMNS,
    STANDING_COLUMNS,
    exported,
    exported_standings,
    library,
    result_rows,
    standing_rows,
    write_mcap,
    write_table,
)
from roah_rsbb.results.page import Competition, page, picture_address
from roah_rsbb.results.paper import blank_front, front_markup
from roah_rsbb.results.printing import Printer, browser, print_pdf, without_font
from roah_rsbb.results.program.commands import (
    BENCHMARKS_FILE,
    SCHEDULE_FILE,
    benchmarks,
    choice,
    file,
    files_of,
    known_records,
    open_journal,
    ruled,
    rules,
    warn,
    why_of,
)
from roah_rsbb.results.replay import PageParts, page_parts, replay_name, replay_of
from roah_rsbb.results.report import Assets, Compared, Site, all_pages, assets, comparison
from roah_rsbb.results.report_numbers import RunFacts, facts_of, link_period_s
from roah_rsbb.results.runs import NotPossible, RunResult, file_name, find, find_record, run_result
from roah_rsbb.results.sheet import sheet_page
from roah_rsbb.results.standings import Standing, index_page, standing_lines, standings_page
from roah_rsbb.rulebook import config
from roah_rsbb.rulebook.standing_rules import Rules
from roah_rsbb.scoring.counting import Why

# The log_dir in the folder of a competition.
LOG_FOLDER = "log"
# More processes take more memory than a report may take.
MOST_PROCESSES = 3


def export(options: argparse.Namespace) -> int:
    """The command of this name."""
    if not (options.csv or options.json or options.html or options.pdf or options.dataset or options.mcap):
        raise NotPossible("choose what to write: --csv FILE, --json FILE, --html DIR, --pdf DIR, --dataset DIR, "
                          "--mcap DIR, or several of them")
    if (options.anonymous or options.licence) and not options.dataset:
        raise NotPossible("--anonymous and --licence are for a data set: name its folder with --dataset DIR")
    # Before anything is written.
    if options.pdf:
        browser()
    if options.mcap:
        library()
    _competition(options)
    reader = open_journal(options)
    as_of = reader.as_of()
    known = known_records(options, reader)
    why = why_of(options, known)
    identities = [record.identity for record in known]
    places = sorted({find(identities, word) for word in options.runs}) if options.runs else range(len(known))
    chosen = [(place + 1, known[place]) for place in places]
    ranked = _ranked(options, known)
    if options.csv:
        rows = result_rows((r for _, r in chosen), options.utc, why)
        _write(options.csv, lambda file: write_table(
            file, RESULT_COLUMNS, rows, options.decimal_comma), "utf-8-sig")

    def results() -> Iterator[RunResult]:
        return (run_result(reader, number, record, warn)._replace(counts=why[record.identity].value)
                for number, record in chosen)

    if options.json:
        value = exported(list(results()), ranked, reader.path, as_of)
        _write(options.json, lambda file: _dump(value, file))
    if options.dataset:
        os.makedirs(options.dataset, exist_ok=True)
        names = names_of(reader) if options.anonymous else None
        write_dataset(options.dataset, results(), DatasetOptions(names, options.licence, options.title))
        print(f"the data set of {len(chosen)} runs is in {options.dataset}")
    if options.mcap:
        os.makedirs(options.mcap, exist_ok=True)
        written = [path for result in results() for path in write_mcap(result, options.mcap)]
        print(f"the logs of {len(written)} robots in {len(chosen)} runs are in {options.mcap}")
    if options.html:
        _write_pages(options, options.html, "html", _write_html, results(), chosen, ranked, why, as_of)
    if options.pdf:
        with Printer() as printer:
            _write_pages(options, options.pdf, "pdf", printer.print, results(), chosen, ranked, why, as_of)
    return 0


def _write_pages(
    options, folder: str, suffix: str, write: Callable[[str, str], None], results: Iterable[RunResult], chosen,
    ranked: List[Standing], why: Mapping[str, Why], as_of: float,
) -> None:
    of_rules, titles, competition = rules(options), _titles(options), _competition(options)
    sheets: Dict[str, str] = {}
    letters: Set[str] = set()
    os.makedirs(folder, exist_ok=True)
    for result in results:
        record = result.record
        sheets[record.identity] = name = f"{file_name(result.number, record)}.{suffix}"
        text = sheet_page(result, options.utc, of_rules.get(record.benchmark), titles.get(record.benchmark, ""),
                          not options.no_appendix, competition)
        letters.update(text)
        write(text, os.path.join(folder, name))
    if suffix == "pdf":
        _warn_of_fonts(letters)
    index = f"index.{suffix}"
    write(index_page(chosen, sheets, ranked, as_of, options.utc, competition, why), os.path.join(folder, index))
    print(f"{len(sheets)} score sheets and {index} are in {folder}")


def replay(options: argparse.Namespace) -> int:
    """The command of this name."""
    if options.video and len(options.runs) != 1:
        raise NotPossible("--video needs exactly one RUN, because each run has its own video")
    parts = page_parts(_resource(options, "replay"))
    os.makedirs(options.html, exist_ok=True)
    reader = open_journal(options)
    for identity in options.runs or reader.identities():
        result = run_result(reader, *find_record(reader, identity, warn), warn)
        path = os.path.join(options.html, replay_name(result.number, result.record))
        _write_html(replay_of(reader, result, parts, options.utc, warn, options.video), path)
        print(path)
    return 0


def report(options: argparse.Namespace) -> int:
    """The command of this name."""
    shared = assets(_resource(options, "report"))
    sources = [_journal_in(source) for source in options.competitions] or [options.journal]
    if len(sources) == 1:
        count = len(_write_site(options, sources[0], options.html, shared).runs)
        print(f"the report of {count} runs is in {os.path.join(options.html, 'index.html')}")
        return 0
    compared = []
    for number, (source, given) in enumerate(zip(sources, options.competitions), 1):
        name = _name_of(given)
        sub_folder = f"competition{number}"
        site = _write_site(options, source, os.path.join(options.html, sub_folder), shared, "../index.html")
        compared.append(Compared(f"{number}. {name}", f"{sub_folder}/index.html", site))
    _write_html(comparison(compared, shared), os.path.join(options.html, "index.html"))
    print(f"the reports of {len(sources)} competitions are in {os.path.join(options.html, 'index.html')}")
    return 0


def _resource(options: argparse.Namespace, name: str) -> str:
    """Return a folder in the package's folder resource."""
    return os.path.join(os.path.dirname(os.path.abspath(options.config_dir)), "resource", name)


def _journal_in(source: str) -> str:
    """Return the journal of a competition's folder, of a log_dir, or the journal itself."""
    if os.path.isfile(source) or names_in(source):
        return source
    for path in (journal_in(source), journal_in(os.path.join(source, LOG_FOLDER))):
        if os.path.exists(path):
            return path
    raise NotPossible(f"{source}: there is no journal: name the folder of a competition, a log_dir, or a journal")


def _name_of(source: str) -> str:
    """Return the name of a competition: its folder's, also if the journal in it is given."""
    folder = os.path.abspath(source)
    if os.path.isfile(folder) or names_in(folder):
        folder = os.path.dirname(folder)
    if os.path.basename(folder) == LOG_FOLDER:
        folder = os.path.dirname(folder)
    return os.path.basename(folder)


def _write_site(
    options: argparse.Namespace, journal: Optional[str], folder: str, shared: Assets, home: str = ""
) -> Site:
    """Write the pages of a competition."""
    options = argparse.Namespace(**{**vars(options), "journal": journal})
    with files_of(options):
        return _written_site(options, folder, shared, home)


def _written_site(options: argparse.Namespace, folder: str, shared: Assets, home: str) -> Site:
    of_rules, titles, competition = rules(options), _titles(options), _competition(options)
    parts = None if options.no_replays else page_parts(_resource(options, "replay"))
    os.makedirs(os.path.join(folder, "runs"), exist_ok=True)
    sheets: Dict[str, str] = {}
    replays: Dict[str, str] = {}
    runs = []
    reader = open_journal(options)
    known = known_records(options, reader)
    ranked = _ranked(options, known)
    as_of = reader.as_of()
    period_s = link_period_s(known, as_of)
    about = _AboutRuns(
        folder, of_rules, titles, competition, parts, options.utc, period_s, why_of(options, known))
    for record, written in zip(known, _written_runs(reader, about, known)):
        for text in written.warnings:
            warn(text)
        runs.append(written.facts)
        sheets[record.identity] = written.sheet
        if written.replay:
            replays[record.identity] = written.replay
    site = Site(runs, ranked, sheets, replays, titles, as_of, options.utc, shared, competition, home, period_s)
    for name, text in all_pages(site).items():
        _write_html(text, os.path.join(folder, name))
    return site


class _AboutRuns(NamedTuple):
    """What the pages of all runs need."""

    folder: str
    rules: Dict[str, Rules]
    titles: Dict[str, str]
    competition: Competition
    replay_parts: Optional[PageParts]  # None: without replays
    in_utc: bool
    link_period_s: int
    why: Dict[str, Why]  # whether runs count, by their identities


class _WrittenRun(NamedTuple):
    """What the report needs of a run whose pages are written."""

    facts: RunFacts
    sheet: str  # file in the report's folder
    replay: str  # the same; empty: none
    warnings: List[str]


_shared: List[Any] = []  # in a process of `_written_runs`: the journal, and what the pages of all runs need


def _written_runs(reader: JournalReader, about: _AboutRuns, known: Sequence[RunRecord]) -> Iterator[_WrittenRun]:
    """Write the pages of all runs in several processes, because threads of Python do not compute at the same time."""
    # Imported late: no other command needs them.
    import multiprocessing
    from concurrent.futures import ProcessPoolExecutor
    from concurrent.futures.process import BrokenProcessPool

    count = min(MOST_PROCESSES, len(os.sched_getaffinity(0)), len(known))
    if count < 2:
        yield from (_write_run(reader, about, *run) for run in enumerate(known, 1))
        return
    with ProcessPoolExecutor(count, multiprocessing.get_context("fork"), _share, (reader, about)) as pool:
        runs = [pool.submit(_write_shared_run, *run) for run in enumerate(known, 1)]
        try:
            for run in runs:
                yield run.result()
        except BrokenProcessPool:
            raise NotPossible("a process of this program ended early: free memory, and repeat the command") from None
        finally:
            for run in runs:
                run.cancel()


def _share(*shared: object) -> None:
    """Begin a process of `_written_runs`. What it needs comes by the fork."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the first process ends the others
    _shared[:] = shared


def _write_shared_run(number: int, record: RunRecord) -> _WrittenRun:
    return _write_run(*_shared, number, record)


def _write_run(reader: JournalReader, about: _AboutRuns, number: int, record: RunRecord) -> _WrittenRun:
    """Write the pages of a run, perhaps in another process."""
    warnings: List[str] = []
    result = run_result(reader, number, record, warnings.append, with_payloads=False)
    result = result._replace(counts=about.why[record.identity].value)
    events = list(in_order(result, with_scores=True))
    shown = sections_of(events)
    warned = sum(event.bad for section in shown for event in section.events)
    facts = facts_of(result, warned, about.link_period_s)
    sheet, replay_file = f"runs/{file_name(number, record)}.html", ""
    rules, title = about.rules.get(record.benchmark), about.titles.get(record.benchmark, "")
    _write_html(sheet_page(result, about.in_utc, rules, title, competition=about.competition, shown=shown),
                os.path.join(about.folder, sheet))
    if about.replay_parts is not None:
        replay_file = f"runs/{replay_name(number, record)}"
        _write_html(replay_of(reader, result, about.replay_parts, about.in_utc, warnings.append, events=events),
                    os.path.join(about.folder, replay_file))
    return _WrittenRun(facts, sheet, replay_file, warnings)


def _write_html(text: str, path: str) -> None:
    _write(path, lambda file: file.write(text))


def standings(options: argparse.Namespace) -> int:
    """The command of this name."""
    reader = open_journal(options, checks_all=False)
    ranked = _ranked(options, known_records(options, reader))
    path, as_of = reader.path, reader.as_of()
    codes = [standing.benchmark for standing in ranked]
    unknown = [code for code in options.benchmarks if code not in codes]
    if unknown:
        raise NotPossible(f"there are no runs of {', '.join(unknown)}; there are some of {', '.join(codes) or 'none'}")
    if options.benchmarks:
        ranked = [standing for standing in ranked if standing.benchmark in options.benchmarks]
    if options.csv:
        _write(options.csv, lambda file: write_table(
            file, STANDING_COLUMNS, standing_rows(ranked), options.decimal_comma), "utf-8-sig")
    if options.json:
        _write(options.json, lambda file: _dump(exported_standings(ranked, path, as_of), file))
    _write_page(options, standings_page(ranked, as_of, options.utc, _competition(options)))
    if not (options.csv or options.json or options.html or options.pdf):
        for standing in ranked:
            for text in standing_lines(standing):
                print(text)
        if not ranked:
            print("No run has started yet.")
    return 0


def blank(options: argparse.Namespace) -> int:
    """The command of this name."""
    if not (options.html or options.pdf):
        raise NotPossible("choose what to write: --html FILE, --pdf FILE, or both")
    loaded, plans = config.load_schedule(file(options, BENCHMARKS_FILE), file(options, SCHEDULE_FILE))
    unknown = [code for code in options.benchmarks if code not in loaded]
    if unknown:
        raise NotPossible(f"there is no benchmark {', '.join(unknown)}; there are {', '.join(loaded)}")
    events = [(plan.name, event) for plan in plans for event in plan.events]
    events.sort(key=lambda line: line[1].scheduled)
    with_event = {event.benchmark.code for _, event in events}
    sheets = [blank_front(event.benchmark, zone, event, options.utc) for zone, event in events
              if not options.benchmarks or event.benchmark.code in options.benchmarks]
    sheets += [blank_front(benchmark) for code, benchmark in loaded.items()
               if (code in options.benchmarks or not options.benchmarks) and code not in with_event]
    competition = _competition(options)
    _write_page(options, page("Score sheets", *(
        front_markup(front._replace(competition=competition)) for front in sheets)))
    print(f"{len(sheets)} empty score sheets are in {' and '.join(filter(None, (options.html, options.pdf)))}")
    return 0


def checklist(options: argparse.Namespace) -> int:
    """The command of this name."""
    _, plans = config.load_schedule(file(options, BENCHMARKS_FILE), file(options, SCHEDULE_FILE))
    lines = lists.checklist(plans, ruled(options, known_records(options, open_journal(options))), options.utc)
    for text in lists.check_lines(lines, options.utc, options.missing):
        print(text)
    return 0 if all(line.is_final for line in lines) else 1


# -- shared -----------------------------------------------------------------------------------------


def _titles(options: argparse.Namespace) -> Dict[str, str]:
    return {code: benchmark.desc or benchmark.name for code, benchmark in benchmarks(options).items()}


def _competition(options: argparse.Namespace) -> Competition:
    try:
        return Competition(options.title, picture_address(options.logo) if options.logo else "")
    except ValueError as error:
        raise NotPossible(str(error)) from None
    except OSError as error:
        raise NotPossible(f"{options.logo}: {error.strerror}: choose another picture with --logo") from None


def _write_page(options: argparse.Namespace, text: str) -> None:
    """Write a page as the options say."""
    if options.html:
        _write_html(text, options.html)
    if options.pdf:
        _make_folder_of(options.pdf)
        print_pdf(text, options.pdf)
        _warn_of_fonts(text)


def _warn_of_fonts(letters: Iterable[str]) -> None:
    missing = without_font(letters)
    if missing:
        warn(f"no font of this computer has {' '.join(missing)}, so the PDF has boxes instead. Install one (sudo apt "
             "install fonts-noto-color-emoji fonts-noto-cjk fonts-noto-core), and print again")


def _ranked(options: argparse.Namespace, known: List[RunRecord]) -> List[Standing]:
    return ranking.standings(known, rules(options), choice(options, known), _titles(options))


def _write(path: str, write: Callable[[TextIO], object], encoding: str = "utf-8") -> None:
    """Write a complete file, or leave the old one unchanged; `-` is standard output."""
    if path == "-":
        write(sys.stdout)
        return
    draft = f"{path}.draft"
    _make_folder_of(path)
    try:
        with open(draft, "w", encoding=encoding, errors="backslashreplace", newline="") as file:
            write(file)
        os.replace(draft, path)
    except BaseException:
        if os.path.exists(draft):
            os.remove(draft)
        raise


def _make_folder_of(path: str) -> None:
    os.makedirs(os.path.dirname(path) or ".", exist_ok=True)


def _dump(value: object, file: TextIO) -> None:
    json.dump(value, file, ensure_ascii=False, indent=1)
    file.write("\n")
