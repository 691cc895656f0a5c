"""Commands of `results` that rank runs and write files. Loading what they need takes longer than to list all runs."""

import argparse
import functools
import json
import os
import signal
import sys
from typing import Callable, Dict, Iterable, Iterator, List, NamedTuple, Optional, Sequence, Set, TextIO, Tuple

from roah_rsbb.journal.log import names_in
from roah_rsbb.journal.reader import JournalReader, journal_in
from roah_rsbb.model.records import RunRecord
from roah_rsbb.results import lists
from roah_rsbb.results.dataset import DatasetOptions, names_of, write_dataset
from roah_rsbb.results.export import (
    RESULT_COLUMNS,
    STANDING_COLUMNS,
    Cell,
    exported,
    exported_standings,
    library,
    result_rows,
    standing_rows,
    write_mcap,
    write_table,
)
from roah_rsbb.results.league_tables import attempts_text, rankings_text, scores_of, scores_text
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
from roah_rsbb.results.standing_pages import index_page, standings_page
from roah_rsbb.results.standings import standing_lines
from roah_rsbb.rulebook import config
from roah_rsbb.rulebook.standing_rules import Rules
from roah_rsbb.scoring import standings as ranking
from roah_rsbb.scoring.counting import Why
from roah_rsbb.scoring.standings import Standing

# The log_dir in the folder of a competition.
LOG_FOLDER = "log"
# More processes take more memory than a report may take.
MOST_PROCESSES = 3


class _Read(NamedTuple):
    """A journal, and what the files of the competition say about it."""

    reader: JournalReader
    known: List[RunRecord]
    why: Dict[str, Why]  # whether runs count, by their identities
    ranked: List[Standing]
    rules: Dict[str, Rules]
    titles: Dict[str, str]  # of the benchmarks
    competition: Competition
    in_utc: bool

    def result(self, number: int, warn: Callable[[str], None] = warn) -> RunResult:
        """Read the rest of a run. `number`: in the list of all runs."""
        record = self.known[number - 1]
        return run_result(self.reader, number, record, warn)._replace(counts=self.why[record.identity].value)

    def sheet(self, result: RunResult, appendix: bool = True) -> str:
        """Return the page of a run."""
        code = result.record.benchmark
        return sheet_page(result, self.in_utc, self.rules.get(code), self.titles.get(code, ""), appendix,
                          self.competition)


def _read(options: argparse.Namespace) -> _Read:
    competition = _competition(options)  # a picture that is missing is reported at once
    reader = open_journal(options)
    known = known_records(options, reader)
    return _Read(reader, known, why_of(options, known), _ranked(options, known), rules(options), _titles(options),
                 competition, options.utc)


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
    read = _read(options)
    identities = [record.identity for record in read.known]
    numbers = sorted({find(identities, word) + 1 for word in options.runs} if options.runs
                     else range(1, len(identities) + 1))
    if options.csv:
        rows = result_rows((read.known[number - 1] for number in numbers), options.utc, read.why)
        _write_csv(options, RESULT_COLUMNS, rows)
    if options.json:
        _write_json(options, exported(list(map(read.result, numbers)), read.ranked, read.reader.path,
                                      read.reader.as_of()))
    if options.dataset:
        os.makedirs(options.dataset, exist_ok=True)
        names = names_of(read.reader) if options.anonymous else None
        write_dataset(options.dataset, map(read.result, numbers), DatasetOptions(names, options.licence, options.title))
        print(f"the data set of {len(numbers)} runs is in {options.dataset}")
    if options.mcap:
        os.makedirs(options.mcap, exist_ok=True)
        written = [path for number in numbers for path in write_mcap(read.result(number), options.mcap)]
        print(f"the logs of {len(written)} robots in {len(numbers)} runs are in {options.mcap}")
    if options.html:
        _write_sheets(options, read, numbers, options.html, "html", _write_text)
    if options.pdf:
        with Printer() as printer:
            _warn_of_fonts(_write_sheets(options, read, numbers, options.pdf, "pdf", printer.print))
    return 0


def _write_sheets(
    options: argparse.Namespace, read: _Read, numbers: Sequence[int], folder: str, suffix: str,
    write: Callable[[str, str], None],
) -> Set[str]:
    """Write the pages of these runs, and the index; returns their letters."""
    sheets: Dict[str, str] = {}
    letters: Set[str] = set()
    os.makedirs(folder, exist_ok=True)
    for number in numbers:
        record = read.known[number - 1]
        sheets[record.identity] = name = f"{file_name(number, record)}.{suffix}"
        text = read.sheet(read.result(number), not options.no_appendix)
        letters.update(text)
        write(text, os.path.join(folder, name))
    chosen = [(number, read.known[number - 1]) for number in numbers]
    index = f"index.{suffix}"
    write(index_page(chosen, sheets, read.ranked, read.reader.as_of(), options.utc, read.competition, read.why),
          os.path.join(folder, index))
    print(f"{len(sheets)} score sheets and {index} are in {folder}")
    return letters


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
        _write_text(replay_of(reader, result, parts, options.utc, warn, options.video), path)
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
    _write_text(comparison(compared, shared), os.path.join(options.html, "index.html"))
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
    parts = None if options.no_replays else page_parts(_resource(options, "replay"))
    os.makedirs(os.path.join(folder, "runs"), exist_ok=True)
    sheets: Dict[str, str] = {}
    replays: Dict[str, str] = {}
    runs = []
    with files_of(options):
        read = _read(options)
        as_of = read.reader.as_of()
        period_s = link_period_s(read.known, as_of)
        write = functools.partial(_write_run, read, folder, parts, period_s)
        for record, written in zip(read.known, _shared_out(write, range(1, len(read.known) + 1))):
            for text in written.warnings:
                warn(text)
            runs.append(written.facts)
            sheets[record.identity] = written.sheet
            if written.replay:
                replays[record.identity] = written.replay
        site = Site(runs, read.ranked, sheets, replays, read.titles, as_of, options.utc, shared, read.competition, home,
                    period_s)
        for name, text in all_pages(site).items():
            _write_text(text, os.path.join(folder, name))
    return site


class _WrittenRun(NamedTuple):
    """What the report needs of a run whose pages are written."""

    facts: RunFacts
    sheet: str  # file in the report's folder
    replay: str  # the same; empty: none
    warnings: List[str]


_work: List[Callable[[int], _WrittenRun]] = []  # in a process of `_shared_out`


def _shared_out(work: Callable[[int], _WrittenRun], numbers: Sequence[int]) -> Iterator[_WrittenRun]:
    """Work in several processes, because threads of Python do not compute at the same time. The results are in order.
    """
    # Imported late: no other command needs them.
    import multiprocessing
    from concurrent.futures import ProcessPoolExecutor
    from concurrent.futures.process import BrokenProcessPool

    count = min(MOST_PROCESSES, len(os.sched_getaffinity(0)), len(numbers))
    if count < 2:
        yield from map(work, numbers)
        return
    with ProcessPoolExecutor(count, multiprocessing.get_context("fork"), _begin_to_work, (work,)) as pool:
        waiting = [pool.submit(_work_on, number) for number in numbers]
        try:
            for each in waiting:
                yield each.result()
        except BrokenProcessPool:
            raise NotPossible("a process of this program ended early: free memory, and repeat the command") from None
        finally:
            for each in waiting:
                each.cancel()


def _begin_to_work(work: Callable[[int], _WrittenRun]) -> None:
    """Begin a process. What it needs comes by the fork, not as a message."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the first process ends the others
    _work[:] = [work]


def _work_on(number: int) -> _WrittenRun:
    return _work[0](number)


def _write_run(read: _Read, folder: str, parts: Optional[PageParts], link_period: int, number: int) -> _WrittenRun:
    """Write the pages of a run, perhaps in another process. `parts`: of a replay; None: without replays."""
    warnings: List[str] = []
    result = read.result(number, warnings.append)
    sheet, replay_file = f"runs/{file_name(number, result.record)}.html", ""
    _write_text(read.sheet(result), os.path.join(folder, sheet))
    if parts is not None:
        replay_file = f"runs/{replay_name(number, result.record)}"
        _write_text(replay_of(read.reader, result, parts, read.in_utc, warnings.append),
                    os.path.join(folder, replay_file))
    return _WrittenRun(facts_of(result, link_period), sheet, replay_file, warnings)


def _write_text(text: str, path: str) -> None:
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
        _write_csv(options, STANDING_COLUMNS, standing_rows(ranked))
    if options.json:
        _write_json(options, exported_standings(ranked, path, as_of))
    _write_page(options, standings_page(ranked, as_of, options.utc, _competition(options)))
    if options.tables:
        _write_tables(options.tables, ranked)
    if not (options.csv or options.json or options.html or options.pdf or options.tables):
        for standing in ranked:
            for text in standing_lines(standing):
                print(text)
        if not ranked:
            print("No run has started yet.")
    return 0


def _write_tables(directory: str, ranked: Sequence[Standing]) -> None:
    """Write the standings as RoboCup@Home publishes them."""
    scores = scores_of(ranked)
    os.makedirs(directory, exist_ok=True)
    for name, text in (("scores.csv", scores_text(scores)), ("scores.md", attempts_text(scores)),
                       ("standings.md", rankings_text(ranked))):
        _write_text(text, os.path.join(directory, name))
    print(f"{len(scores)} attempts are in {directory}")


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
    return {code: benchmark.title for code, benchmark in benchmarks(options).items()}


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
        _write_text(text, options.html)
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


def _write_csv(options: argparse.Namespace, columns: Tuple[str, ...], rows: Iterable[Dict[str, Cell]]) -> None:
    _write(options.csv, lambda file: write_table(file, columns, rows, options.decimal_comma), "utf-8-sig")


def _write_json(options: argparse.Namespace, value: object) -> None:
    _write_text(json.dumps(value, ensure_ascii=False, indent=1) + "\n", options.json)
