"""A run's score sheet for the terminal."""

from typing import Iterator, List, Tuple

from roah_rsbb.core.scoring.records import RunRecord, ScoreEntry, grouped
from roah_rsbb.results.link_summary import link_lines
from roah_rsbb.results.run_result import RunResult
from roah_rsbb.results.story import sections
from roah_rsbb.wording import result_texts
from roah_rsbb.wording.module_scores import by_group
from roah_rsbb.wording.result_texts import line, moment, optional_moment

# Strikes through what is between them, on terminals that can.
_STRUCK, _PLAIN = "\033[9m", "\033[29m"


def list_lines(records: List[RunRecord], in_utc: bool) -> Iterator[str]:
    """All runs, one a line, under a line of titles."""
    rows = [("No.", "Connected", "Zone", "Benchmark", "Team", "Round", "Run", "Time", "Sheet", "State")]
    rows += [_row(number, record, in_utc) for number, record in enumerate(records, 1)]
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    for row in rows:
        yield "  ".join(cell.ljust(width) for cell, width in zip(row, widths)).rstrip()


def _row(number: int, record: RunRecord, in_utc: bool) -> Tuple[str, ...]:
    return (
        str(number), moment(record.opened_utc, in_utc), line(record.zone), line(record.benchmark), line(record.team),
        str(record.round), str(record.run),
        result_texts.duration(record.elapsed_s) if record.started_utc else result_texts.NOTHING,
        "signed off" if record.sign_off else "open", line(result_texts.state_of(record)),
    )


def sheet_lines(result: RunResult, in_utc: bool, strike: bool) -> Iterator[str]:
    """The whole sheet. `strike`: the terminal can strike through."""
    record = result.record
    yield (f"{line(record.benchmark)}, team {line(record.team)}, round {record.round}, run {record.run} "
           f"({line(record.identity)})")
    yield ""
    for name, value in facts(result, in_utc):
        yield f"{name + ':':14}{value}"
    yield from _items(record)
    yield from _history(record, in_utc, strike)
    yield from _stops(record, in_utc)
    for title, lines in by_group(record.module_scores):
        yield from _titled(f"Module's score: {line(title)}", [f"{line(s.name)}: {line(s.value)}" for s in lines])
    for section in sections(result):
        yield from _titled(section.title, [
            f"{result_texts.clock(h.utc, in_utc)}  {_by(h.who)}{line(h.robot) + ': ' if h.robot else ''}{line(h.text)}"
            for h in section.happenings
        ])
    for robot in result.robots:
        yield from _titled(f"Link of {line(robot.robot)} of team {line(robot.team)}", link_lines(robot.link))


def facts(result: RunResult, in_utc: bool) -> List[Tuple[str, str]]:
    """What a run was: names and texts."""
    record = result.record
    return [
        ("Zone", line(record.zone)),
        ("Robots", ", ".join(f"{line(r.robot)} of team {line(r.team)} (port {r.port})" for r in result.robots)
         or result_texts.robots_text(record)),
        ("Scheduled", moment(record.scheduled, in_utc)),
        ("Connected", moment(record.opened_utc, in_utc)),
        ("Started", optional_moment(record.started_utc, in_utc)),
        ("Disconnected", optional_moment(record.closed_utc, in_utc)),
        ("Time", result_texts.duration(record.elapsed_s) if record.started_utc else result_texts.NOTHING),
        ("End", line(result_texts.state_of(record))),
        ("Sheet", result_texts.sign_off_text(record, in_utc)),
        ("Run logs", ", ".join(line(r.log_file) for r in result.robots if r.log_file) or result_texts.NOTHING),
    ]


def _titled(title: str, lines: List[str]) -> Iterator[str]:
    if lines:
        yield ""
        yield title
        for text in lines:
            yield f"  {text}"


def _by(who: str) -> str:
    return f"[{line(who)}] " if who else ""


def _items(record: RunRecord) -> Iterator[str]:
    for group, items in grouped(record.items).items():
        yield from _titled(line(group), [
            f"{result_texts.item_value(item.kind, item.value, item.not_attempted):>13}  {line(item.desc)}"
            + ("  (CORRECTED)" if item.corrected else "")
            for item in items
        ])


def change_text(record: RunRecord, entry: ScoreEntry) -> str:
    """What an entry changed."""
    kind = next((i.kind for i in record.items if (i.group, i.desc) == (entry.group, entry.desc)), "uint")
    old = result_texts.item_value(kind, entry.old, entry.old_not_attempted)
    return f"{old} -> {result_texts.item_value(kind, entry.value, entry.not_attempted)}"


def withdrawn_text(entry: ScoreEntry, in_utc: bool) -> str:
    """Who withdrew an entry, when and why."""
    by = f" by {line(entry.withdrawn_by)}" if entry.withdrawn_by else ""
    note = f": {line(entry.withdrawn_note)}" if entry.withdrawn_note else ""
    mark = ", a correction" if entry.withdrawal_corrects else ""
    return f"withdrawn{by}, {moment(entry.withdrawn_utc, in_utc)}{mark}{note}"


def _history(record: RunRecord, in_utc: bool, strike: bool) -> Iterator[str]:
    def shown(entry: ScoreEntry) -> str:
        mark = "CORRECTION: " if entry.correction else ""
        note = f" ({line(entry.note)})" if entry.note else ""
        text = f"{mark}{_by(entry.who)}{line(entry.group)}: {line(entry.desc)}: {change_text(record, entry)}{note}"
        if entry.withdrawn_utc:
            struck = f"{_STRUCK}{text}{_PLAIN}" if strike else text
            text = f"{struck}  -- {withdrawn_text(entry, in_utc)}"
        return f"{entry.number:3}  {moment(entry.utc, in_utc)}  {text}"

    yield from _titled("History of the score sheet", [shown(entry) for entry in record.history])


def _stops(record: RunRecord, in_utc: bool) -> Iterator[str]:
    yield from _titled("Ends", [
        f"{moment(s.utc, in_utc)}  {_by(s.who)}{line(s.desc) or result_texts.end_text(s.end_reason)}"
        + (f"; reason given{' by ' + line(s.reason_by) if s.reason_by else ''}: {line(s.reason)}" if s.reason else "")
        for s in record.stops
    ])
