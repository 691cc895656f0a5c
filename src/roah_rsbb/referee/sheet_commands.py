"""The terminal referee's commands for runs and score sheets: what may be said with words, and corrections."""

from typing import Any, Callable, Dict, List, Optional, Tuple

from roah_rsbb.core.referee import Refused
from roah_rsbb.referee import sheet_view as sheet_view
from roah_rsbb.referee import view as view
from roah_rsbb.referee.exits import Exit
from roah_rsbb.referee.link import Link
from roah_rsbb.referee.sheets import RunLine, Sheet, pick_run, sheet_of
from roah_rsbb.referee.state import IDLE, Item
from roah_rsbb.referee.words import pick_item, pick_zone, value_of

# Instead of a value.
NOT_ATTEMPTED = ("not-attempted", "n/a")


def runs(link: Link, options: Any, output: Any) -> Exit:
    """All runs of a zone, or of all zones."""
    zone = None if options.zone is None else _zone_name(link, options.zone)
    found = [run for run in link.runs() if zone in (None, run.zone)]
    if output.json:
        output.object({"runs": found})
        return Exit.OK
    for name in [z.zone for z in link.box.zones if zone in (None, z.zone)]:
        lines = sheet_view.run_lines([run for run in found if run.zone == name], output.paint)
        output.lines(lines if zone else [f"{name}:", *(f"    {line}" for line in lines)])
    return Exit.OK


def sheet(link: Link, options: Any, output: Any) -> Exit:
    """A score sheet with its history."""
    zone, run = _which(link, options)
    return _show(link, zone, run, "sheet", output)


def score(link: Link, options: Any, output: Any) -> Exit:
    """Set an item: with a note, as not attempted, or of a run that is over."""
    zone, run = _which(link, options)
    item = pick_item(options.item, _sheet(link, zone, run).items)
    not_attempted = options.value.lower() in NOT_ATTEMPTED
    value = 0 if not_attempted else value_of(options.value, item)
    link.mark(zone, _identity(run), item, value, not_attempted, options.note, options.referee)
    new: Item = _sheet(link, zone, run).items[item.number - 1]
    if output.json:
        output.object({"ok": True, "command": "score", "zone": zone, **new._asdict()})
    else:
        output.lines([view.item_line(new)])
    return Exit.OK


def withdraw(link: Link, options: Any, output: Any) -> Exit:
    """Let an entry of the history count no more."""
    zone, run = _which(link, options)
    link.withdraw(zone, _identity(run), options.entry, options.note, options.referee)
    return _show(link, zone, run, "withdraw", output)


def reason(link: Link, options: Any, output: Any) -> Exit:
    """Say why a run was stopped."""
    zone, run = _which(link, options)
    link.give_reason(zone, _identity(run), options.end, options.text, options.referee)
    return _show(link, zone, run, "reason", output)


def sign_off(link: Link, options: Any, output: Any) -> Exit:
    """The score sheet of a run that is over is final."""
    zone, run = _which(link, options)
    link.sign_off(zone, _identity(run), options.referee)
    return _show(link, zone, run, "sign-off", output)


DO: Dict[str, Callable[[Link, Any, Any], Exit]] = {
    "runs": runs, "sheet": sheet, "withdraw": withdraw, "reason": reason, "sign-off": sign_off,
}


def _show(link: Link, zone: str, run: Optional[RunLine], command: str, output: Any) -> Exit:
    shown = _sheet(link, zone, run)
    if output.json:
        output.object({"ok": True, "command": command, "zone": zone, "sheet": shown})
    else:
        output.lines(sheet_view.sheet_lines(shown, output.paint))
    return Exit.OK


def _which(link: Link, options: Any) -> Tuple[str, Optional[RunLine]]:
    """The zone, and the run that is meant; None: the one that is connected. Raises `Refused`, `BadWord`."""
    zone = _zone_name(link, options.zone)
    if options.run is not None:
        known: List[RunLine] = [run for run in link.runs() if run.zone == zone]
        return zone, pick_run(options.run, known)
    if link.box.zone(zone).phase == IDLE:
        raise Refused(["No run is connected. For one that is over give its name, such as '--run last' (see 'runs')"])
    return zone, None


def _identity(run: Optional[RunLine]) -> str:
    return "" if run is None else run.identity


def _sheet(link: Link, zone: str, run: Optional[RunLine]) -> Sheet:
    return sheet_of(link.run_sheet(zone, _identity(run)))


def _zone_name(link: Link, word: str) -> str:
    return pick_zone(word, [zone.zone for zone in link.box.zones])
