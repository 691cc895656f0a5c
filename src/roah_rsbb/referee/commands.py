"""The commands of the terminal referee. Each takes the open link to the core, its options and the output."""

import sys
from typing import Any, Callable, Dict, List, Optional, Tuple

from roah_rsbb.core.referee import Refused
from roah_rsbb.referee import judges, pairing, sheets, view
from roah_rsbb.referee.answers import Operations
from roah_rsbb.referee.changes import Follower
from roah_rsbb.referee.exits import Exit, NoCore
from roah_rsbb.referee.link import Link
from roah_rsbb.referee.output import Output
from roah_rsbb.referee.run import RunScript, ScriptOutcome, ScriptPlan
from roah_rsbb.referee.sheets import RunLine, Sheet, pick_run, sheet_of
from roah_rsbb.referee.state import CONNECTED, IDLE, SheetItem
from roah_rsbb.referee.words import NOT_ATTEMPTED, BadWord, EventWanted, answer_of, pick_item, pick_zone, value_of
from roah_rsbb.wording import schedule
from roah_rsbb.wording.texts import escaped

WATCH_STEP_S = 1.0


def _status(link: Link, options, output: Output) -> Exit:
    box = link.box
    if options.zone is None:
        output.object(box) if output.json else output.lines(view.status(box, output.style))
        return Exit.OK
    zone = box.zone(_zone_name(link, options.zone))
    output.object(zone) if output.json else output.lines(view.zone_report(zone, box.clock_utc_s, output.style))
    return Exit.OK


def _watch(link: Link, options, output: Output) -> Exit:
    zone = None if options.zone is None else _zone_name(link, options.zone)
    if output.json:
        output.object({"utc_s": link.box.clock_utc_s, "kind": "start", "zone": zone or "", "box": link.box})
    else:
        box = link.box if zone is None else link.box._replace(zones=(link.box.zone(zone),))
        output.lines([*view.status(box, output.style), ""])
    follower = Follower(link, zone)
    while not output.closed:
        for change in follower.step(WATCH_STEP_S):
            output.change(change)
    return Exit.OK


def _command(link: Link, options, output: Output) -> Exit:
    name = _zone_name(link, options.zone)
    link.command(options.command.replace("-", "_"), name)
    return _say_done(link, name, output, options.command)


def _connect(link: Link, options, output: Output) -> Exit:
    if not options.robot:
        return _command(link, options, output)
    name = _zone_name(link, options.zone)
    link.connect_robot(name, options.robot)
    return _say_done(link, name, output, "connect")


def _say_done(link: Link, name: str, output: Output, command: str) -> Exit:
    """Print the zone after a command."""
    box = link.settle()
    zone = box.zone(name)
    if output.json:
        output.object({"ok": True, "command": command, "zone": name, "state": zone})
    else:
        output.lines([f"{command}: done", *view.zone_lines(zone, box.clock_utc_s, output.style)])
    return Exit.OK


def _score(link: Link, options, output: Output) -> Exit:
    if options.item is not None and options.value is None:
        raise BadWord(f"the value of '{options.item}' is missing: give it after the item")
    with_words = options.note or options.referee or options.run is not None
    if options.item is not None and (with_words or options.value.lower() in NOT_ATTEMPTED):
        return _score_with_words(link, options, output)
    if options.run is not None:
        return _sheet(link, options, output)
    name = _zone_name(link, options.zone)
    zone = link.box.zone(name)
    if zone.phase == IDLE:
        raise Refused(["No run is connected: the score sheet starts with connect"])
    if options.item is None:
        output.object({"zone": name, "event": zone.event, "score": zone.score}) if output.json else output.lines(
            view.score_sheet(zone, output.style))
        return Exit.OK
    item = pick_item(options.item, zone.score)
    link.mark(name, zone.identity, item, value_of(options.value, item))
    zone = link.settle().zone(name)
    item = zone.score[item.number - 1]
    output.object({"ok": True, "command": "score", "zone": name, **item._asdict()}) if output.json else output.lines(
        [view.item_line(item)])
    return Exit.OK


def _done(link: Link, options, output: Output) -> Exit:
    name = _zone_name(link, options.zone)
    operation = link.box.zone(name).operation
    if operation is None:
        raise Refused(["no manual operation is requested now"])
    if options.operation not in (None, operation.number):
        raise Refused([f"operation {options.operation} is over; the current one is: {operation.text}"])
    link.complete_operation(name, operation.number, answer_of(options.answer, operation))
    return _say_done(link, name, output, "done")


def _switches(link: Link, options, output: Output) -> Exit:
    name = _zone_name(link, options.zone)
    for switch in options.press:
        link.press_switch(name, switch)
    if options.damaged is not None:
        link.set_damaged(name, options.damaged)
    if options.confirm:
        link.confirm_switches(name)
    return _say_done(link, name, output, "switches")


def _run(link: Link, options, output: Output) -> Exit:
    event = options.event
    if options.team:
        event = (event or EventWanted())._replace(team=options.team)
    plan = ScriptPlan(
        _zone_name(link, options.zone), options.wait, event, tuple(options.score), options.keep,
        Operations(options.operations), options.robot,
    )
    outcome = RunScript(link, plan, output.change).run()
    _show_outcome(plan.zone, outcome, output)
    return outcome.status


def _show_outcome(name: str, outcome: ScriptOutcome, output: Output) -> None:
    zone = outcome.zone
    if output.json:
        run: Dict[str, Any] = {} if zone is None else {
            "event": zone.event, "end_reason": zone.end_reason, "robot": zone.robot, "score": zone.score,
            "module_score": zone.module_score, "log_file": zone.log_file,
        }
        output.object({"kind": "result", "ok": outcome.status is Exit.OK, "exit": int(outcome.status), "zone": name,
                       "text": outcome.text, **run})
        return
    if zone is not None and zone.phase != CONNECTED:
        log = [f"Log: {escaped(zone.log_file)}"] if zone.log_file else []
        output.lines(["", *view.score_sheet(zone, output.style), *log])
    colour = view.GREEN if outcome.status is Exit.OK else view.RED
    lines = [escaped(line) for line in f"{name}: {outcome.text}".split("\n")]
    output.lines([output.style(colour, lines[0]), *lines[1:]])


def _zone_name(link: Link, word: str) -> str:
    return pick_zone(word, [zone.zone for zone in link.box.zones])


# -- runs and score sheets ------------------------------------------------------------------------


def _runs(link: Link, options: Any, output: Any) -> Exit:
    """Print the runs of a zone, or of all zones."""
    zone = None if options.zone is None else _zone_name(link, options.zone)
    found = [run for run in link.runs() if zone in (None, run.zone)]
    if output.json:
        output.object({"runs": found})
        return Exit.OK
    for name in [z.zone for z in link.box.zones if zone in (None, z.zone)]:
        lines = sheets.run_lines([run for run in found if run.zone == name], output.style)
        output.lines(lines if zone else [f"{name}:", *(f"    {line}" for line in lines)])
    return Exit.OK


def _sheet(link: Link, options: Any, output: Any) -> Exit:
    """Print a score sheet with its history."""
    zone, run = _which(link, options)
    return _show(link, zone, run, "sheet", output)


def _score_with_words(link: Link, options: Any, output: Any) -> Exit:
    """Set an item: with a note, as not attempted, or of a run that is over."""
    zone, run = _which(link, options)
    item = pick_item(options.item, _fetched(link, zone, run).items)
    entered = None if options.value.lower() in NOT_ATTEMPTED else value_of(options.value, item)
    identity = _identity(run) or link.box.zone(zone).identity
    link.mark(zone, identity, item, entered, options.note, options.referee)
    new: SheetItem = _fetched(link, zone, run).items[item.number - 1]
    if output.json:
        output.object({"ok": True, "command": "score", "zone": zone, **new._asdict()})
    else:
        output.lines([view.item_line(new)])
    return Exit.OK


def _withdraw(link: Link, options: Any, output: Any) -> Exit:
    """Withdraw an entry of the history."""
    zone, run = _which(link, options)
    link.withdraw(zone, _identity(run), options.entry, options.note, options.referee)
    return _show(link, zone, run, "withdraw", output)


def _reason(link: Link, options: Any, output: Any) -> Exit:
    """Record why a run was stopped."""
    zone, run = _which(link, options)
    link.give_reason(zone, _identity(run), options.end, options.text, options.referee)
    return _show(link, zone, run, "reason", output)


def _sign_off(link: Link, options: Any, output: Any) -> Exit:
    """Sign off the score sheet of a finished run."""
    zone, run = _which(link, options)
    if not options.yes:
        if output.json or not sys.stdin.isatty():
            raise BadWord("the sheet becomes final: give --yes, or use a terminal, where you are asked")
        output.lines(sheets.sheet_lines(_fetched(link, zone, run), output.style))
        answered = input(f"Sign off as {options.referee}? The sheet becomes final. [y/N] ")
        if answered.strip().lower() not in ("y", "yes"):
            raise Refused(["not signed off: the question was not answered with yes"])
    link.sign_off(zone, _identity(run), options.referee)
    return _show(link, zone, run, "sign-off", output)


def _show(link: Link, zone: str, run: Optional[RunLine], command: str, output: Any) -> Exit:
    shown = _fetched(link, zone, run)
    if output.json:
        output.object({"ok": True, "command": command, "zone": zone, "sheet": shown})
    else:
        output.lines(sheets.sheet_lines(shown, output.style))
    return Exit.OK


def _which(link: Link, options: Any) -> Tuple[str, Optional[RunLine]]:
    """Return the zone and the run; None: the connected run. Raises `Refused`, `BadWord`."""
    zone = _zone_name(link, options.zone)
    if options.run is not None:
        known: List[RunLine] = [run for run in link.runs() if run.zone == zone]
        return zone, pick_run(options.run, known)
    if link.box.zone(zone).phase == IDLE:
        raise Refused(["No run is connected. For a finished run give its name, such as '--run last' (see 'runs')"])
    return zone, None


def _identity(run: Optional[RunLine]) -> str:
    return "" if run is None else run.identity


def _fetched(link: Link, zone: str, run: Optional[RunLine]) -> Sheet:
    return sheet_of(link.run_sheet(zone, _identity(run)))


# -- the schedule ---------------------------------------------------------------------------------


def _schedule(link: Link, options: Any, output: Any) -> Exit:
    """Print the events that the options choose."""
    events = schedule.events_of(link.schedule())
    zone = "" if options.zone is None else _zone_name(link, options.zone)
    shown = schedule.EventFilter(zone, options.team, options.day, schedule.Show[options.show.upper().replace("-", "_")])
    found = [event for event in events if shown.shows(event, options.utc)]
    if output.json:
        output.object({"events": [{**event._asdict(), "late_s": event.late_s} for event in found]})
    else:
        output.lines([*view.schedule_lines(found, output.style), "", schedule.summary(found)])
    return Exit.OK


def _choose(link: Link, options: Any, output: Any) -> Exit:
    """Choose an event for its zone."""
    name = _zone_name(link, options.zone)
    message = link.schedule()
    own = [line for line in message.events if line.zone == name]
    if options.event > len(own):
        raise BadWord(f"zone '{name}' has no event {options.event}: there are 1 to {len(own)} ('schedule' lists them)")
    link.choose_event(own[options.event - 1], options.unsigned)
    return _say_done(link, name, output, "choose")


# -- the configuration ----------------------------------------------------------------------------


def _reload(link: Link, options: Any, output: Output) -> Exit:
    """Check the configuration files, list what they change, and apply it."""
    found = link.reload("", options.referee)
    _check_reload(found)
    if not found.changes or options.check:
        return _show_reload(found, output)
    if not options.yes:
        if output.json or not sys.stdin.isatty():
            raise BadWord("give --yes to apply the changes, --check to list them, or use a terminal, where you are "
                          "asked")
        output.lines(_reload_lines(found))
        answered = input("Apply these changes? [y/N] ")
        if answered.strip().lower() not in ("y", "yes"):
            raise Refused(["nothing was changed: the question was not answered with yes"])
    done = link.reload(found.digest, options.referee)
    _check_reload(done)
    return _show_reload(done, output)


def _check_reload(answer: Any) -> None:
    if answer.errors:
        raise Refused([*answer.errors, "Nothing was changed"])


def _show_reload(answer: Any, output: Output) -> Exit:
    if output.json:
        output.object({"ok": True, "command": "reload", "applied": answer.applied, "changes": list(answer.changes),
                       "warnings": list(answer.warnings)})
    else:
        end = ["The changes are in force"] if answer.applied and answer.changes else []
        output.lines(_reload_lines(answer) + end)
    return Exit.OK


def _reload_lines(answer: Any) -> List[str]:
    warnings = [f"warning: {escaped(text)}" for text in answer.warnings]
    return warnings + ([escaped(text) for text in answer.changes] or ["The files contain what is in force"])


# -- all commands ---------------------------------------------------------------------------------

COMMANDS: Dict[str, Callable[[Link, Any, Output], Exit]] = {
    "status": _status, "watch": _watch, "connect": _connect, "start": _command, "stop": _command,
    "disconnect": _command, "previous": _command, "next": _command, "pause": _command, "resume": _command,
    "next-phase": _command, "previous-phase": _command, "open-sheet": _command, "no-show": _command,
    "withdrawn": _command, "score": _score, "runs": _runs, "sheet": _sheet,
    "withdraw": _withdraw, "reason": _reason, "sign-off": _sign_off, "schedule": _schedule, "choose": _choose,
    "done": _done, "switches": _switches, "run": _run, "reload": _reload,
    "judges": judges.judges, "pair": pairing.pair, "devices": pairing.devices,
    "team-codes": pairing.team_codes,
}


def carry_out(options: Any, output: Output) -> Exit:
    """Connect to the core and carry out the command."""
    link = Link(options.ros_arguments)
    try:
        link.open(options.wait if options.command == "run" else 0.0)
        return COMMANDS[options.command](link, options, output)
    except Refused as refused:
        return output.failure(Exit.REFUSED, f"{options.command} was refused", refused.reasons)
    except BadWord as bad:
        return output.failure(Exit.USAGE, str(bad), [])
    except NoCore as gone:
        return output.failure(Exit.NO_CORE, str(gone), [])
    except KeyboardInterrupt:
        return Exit.OK if options.command == "watch" else Exit.INTERRUPTED
    finally:
        link.close()
