"""The commands of the terminal referee. Each takes the open link to the core, its options and the output."""

import contextlib
import functools
import sys
import time
from typing import Any, Callable, ContextManager, Dict, List, Optional, Tuple

from roah_rsbb.core.actions.runs import UNSIGNED
from roah_rsbb.core.actions.table import confirmed_by
from roah_rsbb.model.actions import ACTIONS
from roah_rsbb.model.reason import Refused
from roah_rsbb.model.results import RunLine
from roah_rsbb.model.scoring import Entered
from roah_rsbb.model.zone import CONNECTED, IDLE, RUNNING, SheetItem, ZoneSeen
from roah_rsbb.referee import judges, sheets, view
from roah_rsbb.referee.answers import Keyboard, Operations
from roah_rsbb.referee.args import ALWAYS, given_in
from roah_rsbb.referee.at_once import ALL_OPTION
from roah_rsbb.referee.changes import BoxFollower, Change
from roah_rsbb.referee.exits import Exit, NoCore
from roah_rsbb.referee.link import Link, NotConfirmed
from roah_rsbb.referee.output import Output
from roah_rsbb.referee.run import RunScript, ScriptOutcome, ScriptPlan
from roah_rsbb.referee.sheets import LAST, pick_run
from roah_rsbb.referee.state import (
    asked_in,
    box_json,
    event_json,
    item_json,
    items_json,
    run_json,
    scheduled_json,
    score_json,
    sheet_json,
    zone_json,
)
from roah_rsbb.referee.stopping import STOP_HINT, STOP_HINT_ALL, Stopping, TypedStops
from roah_rsbb.referee.words import (
    GIVE_AGAIN,
    NOT_ATTEMPTED,
    BadWord,
    EventWanted,
    given_of,
    pick,
    pick_item,
    pick_zone,
    value_of,
)
from roah_rsbb.wording import schedule
from roah_rsbb.wording.stop import NOT_DELIVERED_S, leaving
from roah_rsbb.wording.texts import escaped

WATCH_STEP_S = 1.0
# How the terminal confirms what `choose` asks for.
GIVE_UNSIGNED = "Give --unsigned to leave it, or sign it off first ('sign-off')"
# A command that takes longer reads STOP from the keyboard while it waits.
SLOW_S = 1.0


def _status(link: Link, options, output: Output) -> Exit:
    now = link.now()
    if options.zone is None:
        output.object(box_json(link.box, now)) if output.json else output.lines(
            view.status(link.box, now, output.style))
        return Exit.OK
    zone = _zone(link, options)
    output.object({**zone_json(zone, now), "box_warnings": link.box.box.warnings}) if output.json else output.lines(
        [*view.warning_lines(link.box, output.style), *view.zone_report(zone, now, output.style)])
    return Exit.OK


def _watch(link: Link, options, output: Output) -> Exit:
    zone = None if options.zone is None else _zone_name(link, options.zone)
    follower, now = BoxFollower(link, zone), link.now()
    if output.json:
        output.object({"utc_s": now.utc, "kind": "start", "zone": zone or "", "box": box_json(follower.box, now)})
    else:
        output.lines([*view.status(follower.box, now, output.style, zone), ""])
    with _keyboard(link, output, zone or "") as keyboard:
        if keyboard is not None:
            _note(output, zone or "", STOP_HINT if zone else STOP_HINT_ALL)
        while not output.closed:
            for change in follower.step(WATCH_STEP_S):
                output.change(change)
    return Exit.OK


def _keyboard(
    link: Link, output: Output, zone: str, always: bool = False, at_end: str = "",
) -> ContextManager[Optional[Keyboard]]:
    """Return what reads the lines that are typed; None: there is no terminal, and not `always` a reader."""
    if not always and not sys.stdin.isatty():
        return contextlib.nullcontext()
    return Keyboard(_typed_stops(link, output, zone, always),
                    functools.partial(_note, output, zone, at_end) if at_end else lambda: None)


def _slow_keyboard(link: Link, options: Any, output: Output) -> ContextManager[Any]:
    """Return what reads STOP from the terminal while a command waits that reads nothing else."""
    if options.command in READS or output.json or not sys.stdin.isatty():
        return contextlib.nullcontext()
    zone = getattr(options, "zone", None) or ""
    hint = STOP_HINT if zone else STOP_HINT_ALL
    return Keyboard(_typed_stops(link, output, zone, False), begin_s=SLOW_S,
                    at_begin=functools.partial(_note, output, zone, hint))


def _typed_stops(link: Link, output: Output, zone: str, has_answers: bool) -> TypedStops:
    return TypedStops(link, output.stop, functools.partial(_note, output, zone), zone, has_answers)


def _note(output: Output, zone: str, text: str) -> None:
    output.change(Change(time.time(), "note", zone, {"text": text}))


def _stop(link: Link, options: Any, output: Output) -> Exit:
    """Stop. The link need not be open."""
    if (options.zone is None) != options.all:
        raise BadWord("give the name of a zone, or 'all'")
    stopping = Stopping(link, ALL_OPTION if options.all else options.zone, output.stop,
                        sent=options.sent)
    with contextlib.suppress(KeyboardInterrupt):
        stopping.run()
    status, found = stopping.status(), stopping.result()
    reasons = [reason for one in found for reason in one.refused]
    if status is Exit.REFUSED and reasons:
        return output.failure(status, "stop was refused", reasons)
    if output.json:
        zones = [{"zone": one.zone, "way": one.line(time.monotonic()).way,
                  "state": None if one.after is None else zone_json(one.after, link.now())} for one in found]
        which = {"zones": zones} if stopping.is_all or not zones else zones[0]
        output.object({"kind": "result", "ok": status is Exit.OK, "exit": int(status), "command": "stop", **which})
    elif not found and status is Exit.OK:
        output.lines(["no run is in progress"])
    return status


def _act(link: Link, options: Any, output: Output) -> Exit:
    """Do an action of the table."""
    action = ACTIONS[options.command.replace("-", "_")]
    if action.leaves:
        if action.name in ALWAYS:
            _stop_first(link, options)
        _check_stopped(link, options)
    name = _zone_name(link, options.zone)
    link.act(action.name, name, given_in(options, action), referee=options.referee)
    return _say_done(link, name, output, options.command)


def _stop_first(link: Link, options: Any) -> None:
    """Stop a run in progress that is left: the box sends its robot nothing more then."""
    zone = _zone(link, options)
    if zone.phase == RUNNING:
        with contextlib.suppress(Refused):  # it has just ended
            link.stop_run(zone.zone, zone.identity)
        link.settle()


def _check_stopped(link: Link, options: Any) -> None:
    """Refuse to leave a run whose robots do not report STOP, unless the referee says that they know it."""
    if options.yes:
        return
    zone, deadline = _zone(link, options), link.here_s() + NOT_DELIVERED_S
    while leaving(zone) and link.here_s() < deadline:
        link.next(deadline - link.here_s())
        zone = _zone(link, options)
    if leaving(zone):
        raise Refused([f"{leaving(zone)}. Then give --yes"])


def _say_done(link: Link, name: str, output: Output, command: str) -> Exit:
    """Print the zone after a command."""
    link.settle()
    zone, now = link.box.zones[name], link.now()
    if output.json:
        output.object({"ok": True, "command": command, "zone": name, "state": zone_json(zone, now)})
    else:
        output.lines([f"{command}: done", *view.zone_lines(zone, now, output.style)])
    return Exit.OK


def _score(link: Link, options, output: Output) -> Exit:
    if options.item is not None and options.value is None:
        raise BadWord(f"the value of '{options.item}' is missing: give it after the item")
    with_words = options.note or options.referee or options.run is not None
    if options.item is not None and (with_words or options.value.lower() in NOT_ATTEMPTED):
        return _score_with_words(link, options, output)
    if options.run is not None:
        return _sheet(link, options, output)
    zone = _zone(link, options)
    if zone.phase == IDLE:
        raise Refused(["No run is connected: the score sheet starts with connect"])
    if options.item is None:
        output.object({"zone": zone.zone, "event": event_json(zone), "score": items_json(zone.items)}) \
            if output.json else output.lines(view.score_sheet(zone, output.style))
        return Exit.OK
    number = pick_item(options.item, zone.items)
    item = zone.items[number - 1]
    link.mark(zone.zone, zone.identity, item, _entered(link, zone.identity, options.value, item))
    link.settle()
    return _show_item(zone.zone, number, link.box.zones[zone.zone].items[number - 1], output)


def _entered(link: Link, identity: str, text: str, item: SheetItem) -> Entered:
    """Return the value that `text` gives an item. If judges have sheets of their own, a rating alone is one, too: the
    box refuses it with the reason."""
    judged = link.box.judging.get(identity)
    return (judges.settled_value if judged is not None and judged.count else value_of)(text, item)


def _show_item(zone: str, number: int, item: SheetItem, output: Output) -> Exit:
    if output.json:
        output.object({"ok": True, "command": "score", "zone": zone, **item_json(number, item)})
    else:
        output.lines([view.item_line(item)])
    return Exit.OK


def _done(link: Link, options, output: Output) -> Exit:
    zone = _zone(link, options)
    if not zone.operation:
        raise Refused(["no manual operation is requested now"])
    if options.operation not in (None, zone.operation):
        raise Refused([f"operation {options.operation} is over; the current one is: {zone.manual_operation}"])
    link.act("operation", zone.zone, {"operation": zone.operation, **given_of(options.answer, asked_in(zone))},
             referee=options.referee)
    return _say_done(link, zone.zone, output, "done")


def _run(link: Link, options, output: Output) -> Exit:
    event = options.event
    if options.team:
        event = (event or EventWanted())._replace(team=options.team)
    link.referee = options.referee
    plan = ScriptPlan(
        _zone_name(link, options.zone), options.wait, event, tuple(options.score), options.keep,
        Operations(options.operations), options.robot, options.again,
    )
    is_typed = plan.operations is Operations.TYPED
    end = "end of input: other referees must complete manual operations" if is_typed else ""
    with _keyboard(link, output, plan.zone, is_typed, end) as keyboard:
        if keyboard is not None and keyboard.is_terminal:
            _note(output, plan.zone, STOP_HINT)
        outcome = RunScript(link, plan, output.change, keyboard).run()
        _show_outcome(plan.zone, outcome, output)
    return outcome.status


def _show_outcome(name: str, outcome: ScriptOutcome, output: Output) -> None:
    zone = outcome.zone
    if output.json:
        run: Dict[str, Any] = {} if zone is None else {
            "event": event_json(zone), "end_reason": zone.end_reason, "robot": zone.robot_name,
            "score": items_json(zone.items), "module_score": [score_json(score) for score in zone.module_scores],
            "log_file": zone.log_file,
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
    return pick_zone(word, link.box.box.zones)


def _zone(link: Link, options: Any) -> ZoneSeen:
    return link.box.zones[_zone_name(link, options.zone)]


# -- runs and score sheets ------------------------------------------------------------------------


def _runs(link: Link, options: Any, output: Any) -> Exit:
    """Print the runs of a zone, or of all zones."""
    zone = None if options.zone is None else _zone_name(link, options.zone)
    found = [run for run in link.box.runs() if zone in (None, run.zone)]
    if output.json:
        output.object({"runs": [run_json(run) for run in found]})
        return Exit.OK
    for name in [name for name in link.box.box.zones if zone in (None, name)]:
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
    items = link.run_sheet(zone, _identity(run)).items
    number = pick_item(options.item, items)
    item = items[number - 1]
    is_not = options.value.lower() in NOT_ATTEMPTED
    identity = _identity(run) or link.box.zones[zone].identity
    entered = Entered(not_attempted=True) if is_not else _entered(link, identity, options.value, item)
    link.mark(zone, identity, item, entered._replace(note=options.note), options.referee)
    return _show_item(zone, number, link.run_sheet(zone, _identity(run)).items[number - 1], output)


def _withdraw(link: Link, options: Any, output: Any) -> Exit:
    """Withdraw an entry of the history."""
    zone, run = _which(link, options)
    link.act("withdraw", zone, {"entry": options.entry, "note": options.note}, _identity(run), options.referee)
    return _show(link, zone, run, "withdraw", output)


def _reason(link: Link, options: Any, output: Any) -> Exit:
    """Record why a run was stopped."""
    zone, run = _which(link, options)
    link.act("stop_reason", zone, {"reason": options.text, "stop": options.end}, _identity(run), options.referee)
    return _show(link, zone, run, "reason", output)


def _sign_off(link: Link, options: Any, output: Any) -> Exit:
    """Sign off the score sheet of a finished run. Where a run is connected and nobody is shown the sheet, another one
    is meant only by its name."""
    connected = _zone(link, options).identity
    if connected and (options.run is None or (options.run == LAST and options.yes)):
        raise Refused([f"run {connected} is still connected: disconnect it first. To sign off an earlier run, give its "
                       "name ('runs' lists them)"])
    zone, run = _which(link, options)
    with contextlib.ExitStack() as at_end:
        if not options.yes:
            if output.json or not sys.stdin.isatty():
                raise BadWord("the sheet becomes final: give --yes, or use a terminal, where you are asked")
            keyboard = at_end.enter_context(_keyboard(link, output, zone, always=True))
            output.lines(sheets.sheet_lines(link.run_sheet(zone, _identity(run)), output.style))
            if not _is_yes(keyboard, output, f"Sign off as {escaped(options.referee)}? The sheet becomes final. [y/N]"):
                raise Refused(["not signed off: the question was not answered with yes"])
        link.act("sign_off", zone, {}, _identity(run), options.referee)
        return _show(link, zone, run, "sign-off", output)


def _is_yes(keyboard: Keyboard, output: Output, question: str) -> bool:
    return keyboard.answer(lambda: output.question(question)).lower() in ("y", "yes")


def _show(link: Link, zone: str, run: Optional[RunLine], command: str, output: Any) -> Exit:
    shown = link.run_sheet(zone, _identity(run))
    if output.json:
        output.object({"ok": True, "command": command, "zone": zone, "sheet": sheet_json(shown)})
    else:
        output.lines(sheets.sheet_lines(shown, output.style))
    return Exit.OK


def _which(link: Link, options: Any) -> Tuple[str, Optional[RunLine]]:
    """Return the zone and the run; None: the connected run. Raises `Refused`, `BadWord`."""
    zone = _zone_name(link, options.zone)
    if options.run is not None:
        known: List[RunLine] = [run for run in link.box.runs() if run.zone == zone]
        return zone, pick_run(options.run, known)
    if link.box.zones[zone].phase == IDLE:
        raise Refused(["No run is connected. For a finished run give its name, such as '--run last' (see 'runs')"])
    return zone, None


def _identity(run: Optional[RunLine]) -> str:
    return "" if run is None else run.identity


# -- the schedule ---------------------------------------------------------------------------------


def _schedule(link: Link, options: Any, output: Any) -> Exit:
    """Print the events that the options choose."""
    zone = "" if options.zone is None else _zone_name(link, options.zone)
    events = link.box.events()
    team = options.team and pick("team", options.team, sorted({event.team for event in events}))
    day = options.day and pick("day", options.day, sorted({schedule.day_of(event, options.utc) for event in events}))
    shown = schedule.EventFilter(zone, team, day, schedule.Show[options.show.upper().replace("-", "_")])
    found = [event for event in events if shown.shows(event, options.utc)]
    if output.json:
        output.object({"events": [scheduled_json(event) for event in found]})
    else:
        output.lines([*view.schedule_lines(found, output.style), "", schedule.summary(found)])
    return Exit.OK


def _choose(link: Link, options: Any, output: Any) -> Exit:
    """Choose an event for its zone."""
    name = _zone_name(link, options.zone)
    own = sorted((event for event in link.box.schedule.values() if event.zone == name), key=lambda one: one.number)
    if options.event > len(own):
        raise BadWord(f"zone '{name}' has no event {options.event}: there are 1 to {len(own)} ('schedule' lists them)")
    _check_stopped(link, options)
    event = own[options.event - 1]
    try:
        link.act("choose_event", name, {"event": event.id, "team": event.team, "unsigned": options.unsigned},
                 referee=options.referee)
    except Refused as refused:
        templates = [getattr(reason, "template", "") for reason in refused.reasons]
        how = [GIVE_UNSIGNED] if UNSIGNED.template in templates else []
        raise Refused([*refused.reasons, *how]) from None
    return _say_done(link, name, output, "choose")


# -- the configuration ----------------------------------------------------------------------------


def _reload(link: Link, options: Any, output: Output) -> Exit:
    """Check the configuration files, list what they change, and apply it."""
    found = link.reload("", options.referee)
    _check_reload(found)
    if not found["changes"] or options.check:
        return _show_reload(found, output)
    with contextlib.ExitStack() as at_end:
        if not options.yes:
            if output.json or not sys.stdin.isatty():
                raise BadWord("give --yes to apply the changes, --check to list them, or use a terminal, where you are "
                              "asked")
            keyboard = at_end.enter_context(_keyboard(link, output, "", always=True))
            output.lines(_reload_lines(found))
            if not _is_yes(keyboard, output, "Apply these changes? [y/N]"):
                raise Refused(["nothing was changed: the question was not answered with yes"])
        done = link.reload(found["digest"], options.referee)
        _check_reload(done)
        return _show_reload(done, output)


def _check_reload(answer: Any) -> None:
    if answer["errors"]:
        raise Refused([*answer["errors"], "Nothing was changed"])


def _show_reload(answer: Any, output: Output) -> Exit:
    if output.json:
        output.object({"ok": True, "command": "reload", "applied": answer["applied"], "changes": answer["changes"],
                       "warnings": answer["warnings"]})
    else:
        end = ["The changes are in force"] if answer["applied"] and answer["changes"] else []
        output.lines(_reload_lines(answer) + end)
    return Exit.OK


def _reload_lines(answer: Any) -> List[str]:
    warnings = [f"warning: {escaped(text)}" for text in answer["warnings"]]
    return warnings + ([escaped(text) for text in answer["changes"]] or ["The files contain what is in force"])


# -- the web pages' node --------------------------------------------------------------------------


def _of_gateway(link: Link, options: Any, output: Output) -> Exit:
    from roah_rsbb.referee import pairing  # late: no other command needs messages of ROS

    return pairing.COMMANDS[options.command](link, options, output)


# -- all commands ---------------------------------------------------------------------------------

COMMANDS: Dict[str, Callable[[Link, Any, Output], Exit]] = {
    **{action.words: _act for action in ACTIONS.values()},
    "status": _status, "watch": _watch, "stop": _stop, "score": _score, "runs": _runs, "sheet": _sheet,
    "withdraw": _withdraw, "reason": _reason, "sign-off": _sign_off, "schedule": _schedule, "choose": _choose,
    "done": _done, "run": _run, "reload": _reload,
    "judges": judges.judges, "pair": _of_gateway, "devices": _of_gateway, "team-codes": _of_gateway,
}
# Those that read the keyboard themselves, and the STOP.
READS = ("watch", "run", "sign-off", "reload", "stop")


def carry_out(options: Any, output: Output) -> Exit:
    """Connect to the core and carry out the command."""
    link = Link()
    link.start()
    try:
        with _slow_keyboard(link, options, output):
            if options.command != "stop":
                link.open(options.wait if options.command == "run" else 0.0)
            return COMMANDS[options.command](link, options, output)
    except Refused as refused:
        how = "counts, but" if isinstance(refused, NotConfirmed) else "was refused"
        return output.failure(Exit.REFUSED, f"{options.command} {how}", confirmed_by(refused.reasons, GIVE_AGAIN))
    except BadWord as bad:
        return output.failure(Exit.USAGE, str(bad), [])
    except NoCore as gone:
        return output.failure(Exit.NO_CORE, str(gone), [])
    except KeyboardInterrupt:
        return Exit.OK if options.command == "watch" else Exit.INTERRUPTED
    finally:
        link.close()
