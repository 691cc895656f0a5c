"""The terminal's commands for a run with several judges, and for objections (docs/referee.md, "Several judges")."""

from typing import Any, Callable, Dict, List, Optional

from roah_rsbb.model.reason import Refused
from roah_rsbb.model.results import JudgedRun, Judging, ObjectionLine, RunLine
from roah_rsbb.model.scoring import Entered
from roah_rsbb.model.zone import SheetItem
from roah_rsbb.referee.exits import Exit
from roah_rsbb.referee.link import Link
from roah_rsbb.referee.output import Output
from roah_rsbb.referee.sheets import pick_run
from roah_rsbb.referee.state import run_json
from roah_rsbb.referee.view import BOLD, YELLOW, Style
from roah_rsbb.referee.words import NOT_ATTEMPTED, BadWord, pick_item, pick_zone, value_of
from roah_rsbb.wording import judging, sheets
from roah_rsbb.wording.judging import Judged
from roah_rsbb.wording.texts import escaped

_IN = "    "

# -- which run --------------------------------------------------------------------------------------


def _which(link: Link, options: Any) -> JudgedRun:
    """Return the run that the options name; by default the one of the zone that is not final. Raises `BadWord`."""
    zone = pick_zone(options.zone, link.box.box.zones)
    if options.run is not None:
        runs = [run for run in link.box.runs() if run.zone == zone]
        return link.judging(zone, pick_run(options.run, runs).identity)
    unsigned = [one.identity for one in judging.judgings_of(link.box, zone)]
    identities = [identity for identity in unsigned if identity in link.box.judging] or unsigned
    if not identities:
        raise Refused([f"zone '{zone}' has no run that is not signed off. Name another run with --run (see 'runs')"])
    if len(identities) > 1:
        raise BadWord("\n  ".join([f"zone '{zone}' has {len(identities)} such runs: name one with --run",
                                   *identities]))
    return link.judging(zone, identities[0])


def _show(link: Link, which: Judging, options: Any, output: Output) -> Exit:
    """Print a run after a command."""
    link.settle()
    shown = link.judging(which.zone, which.identity)
    run = link.box.results.get(which.identity)
    if output.json:
        output.object({
            "ok": True, "command": f"judges {options.action}", "zone": which.zone,
            "run": None if run is None else run_json(run), "judging": shown.judging,
            "items": judging.judged_of(shown), "objections": judging.objections_of(shown)})
    else:
        output.lines(lines_of(run, shown, link.now().utc, output.style))
    return Exit.OK


# -- actions ----------------------------------------------------------------------------------------


def _list(link: Link, options: Any, output: Output) -> Exit:
    """Print the progress of the judges; for a single zone also what they submitted."""
    if options.zone is not None:
        return _show(link, _which(link, options).judging, options, output)
    if options.run is not None:
        raise BadWord("give the zone of the run before --run")
    found = list(link.box.judging.values())
    if output.json:
        output.object({"runs": found})
        return Exit.OK
    lines = [line for one in found for line in (
        f"{escaped(one.zone)}: {_title(link.box.results.get(one.identity), one)}",
        *_progress(one, link.now().utc, output.style))]
    output.lines(lines or ["no run that judges score, and no provisional result"])
    return Exit.OK


def _settle(link: Link, options: Any, output: Output) -> Exit:
    which = _which(link, options)
    item = which.items[pick_item(options.item, which.items) - 1]
    is_not = options.value.lower() in NOT_ATTEMPTED
    value = Entered(not_attempted=True) if is_not else settled_value(options.value, item)
    return _act(link, which, options, output, "settle", group=item.group, desc=item.desc, value=value.value,
                text=value.text, not_attempted=value.not_attempted, reason=options.reason)


def settled_value(word: str, item: SheetItem) -> Entered:
    """Return the value that settles an item, like `value_of`; but a sign belongs to the number and a rating is one.

    Raises `BadWord`, or `Refused` as the core itself does.
    """
    sign = "" if item.type == "choice" or word.startswith("=") else "="
    return value_of(f"{sign}{word}", item._replace(type="decimal") if item.type == "rating" else item)


def _act(link: Link, which: JudgedRun, options: Any, output: Output, action: str, **given: Any) -> Exit:
    """Do an action of the table, and show what became of the run."""
    link.act(action, which.judging.zone, given, which.judging.identity, options.referee)
    return _show(link, which.judging, options, output)


def _of_judge(action: str) -> Callable[[Link, Any, Output], Exit]:
    return lambda link, options, output: _act(
        link, _which(link, options), options, output, action, judge=options.judge, reason=options.reason)


def _waive(link: Link, options: Any, output: Output) -> Exit:
    return _act(link, _which(link, options), options, output, "waive", reason=options.reason)


def _publish(link: Link, options: Any, output: Output) -> Exit:
    seconds = judging.BY_THE_FILE_S if options.minutes is None else round(60.0 * options.minutes)
    return _act(link, _which(link, options), options, output, "publish", seconds=seconds)


def _object(link: Link, options: Any, output: Output) -> Exit:
    return _act(link, _which(link, options), options, output, "object", by=options.objector, text=options.text)


def _answer(link: Link, options: Any, output: Output) -> Exit:
    return _act(link, _which(link, options), options, output, "answer", number=options.number,
                upheld=options.verdict == "uphold", text=options.text)


_ACTIONS: Dict[str, Callable[[Link, Any, Output], Exit]] = {
    "list": _list, "settle": _settle, "hand-back": _of_judge("hand_back"),
    "withdraw": _of_judge("withdraw_sheet"), "end-waiting": _waive,
    "publish": _publish, "object": _object, "answer": _answer,
}


def judges(link: Link, options: Any, output: Output) -> Exit:
    """Carry out `referee judges ACTION`."""
    return _ACTIONS[options.action](link, options, output)


# -- lines ------------------------------------------------------------------------------------------


def lines_of(run: Optional[RunLine], shown: JudgedRun, utc_s: float, style: Style) -> List[str]:
    """Return the lines of a run: the progress of its judges, their values side by side, and objections. `run`: None if
    the box no longer lists it."""
    lines = [_title(run, shown.judging), *_progress(shown.judging, utc_s, style)]
    group = None
    for item in judging.judged_of(shown):
        if item.group != group:
            group = item.group
            lines.append(f"{_IN}{escaped(group)}")
        lines += _item(item, style)
    if shown.objections:
        lines.append("Objections")
    return lines + [line for one in judging.objections_of(shown) for line in _objection(one, style)]


def _title(run: Optional[RunLine], one: Judging) -> str:
    if run is None:
        return escaped(one.identity)
    return f"{sheets.run_name(escaped(run.code), escaped(run.team), run.round, run.run)}  {escaped(run.identity)}"


def _progress(one: Judging, utc_s: float, style: Style) -> List[str]:
    def when(moment_utc_s: float) -> str:
        return style.moments.scheduled(moment_utc_s, utc_s) + ("Z" if style.moments.in_utc else "")

    known = [judging.missing_text(one), judging.publication_text(one, utc_s, when)]
    differences = judging.differences_text(one)
    return [f"{_IN}{escaped(line)}" for line in [*map(judging.judge_line, one.judges), *filter(None, known)]] + (
        [f"{_IN}{style(YELLOW, differences)}"] if differences else [])


def _item(item: Judged, style: Style) -> List[str]:
    given = ", ".join(f"{escaped(each.judge)} {escaped(each.shown)}" for each in item.given)
    shown = escaped(judging.outcome_text(item))
    value = style(YELLOW if item.outcome == judging.DIFFER else BOLD, shown)
    settled = judging.settled_text(item)
    return [f"{_IN}{item.number:4}  {escaped(item.item)}: {value}" + (f"  ({given})" if given else ""),
            *([f"{_IN}      {escaped(settled)}"] if settled else [])]


def _objection(one: ObjectionLine, style: Style) -> List[str]:
    answer = judging.answer_text(one)
    who = f" ({escaped(one.who)})" if one.who else ""
    return [f"{_IN}{one.number:4}  {style.moments.stamp(one.utc_s)} {escaped(one.by)}: {escaped(one.text)}{who}",
            f"{_IN}      {escaped(answer) if answer else style(YELLOW, 'not answered')}"]
