"""The commands of the terminal referee for zones and their runs, and the table of all commands."""

import argparse
import contextlib
import time
from typing import Any, Dict

from roah_rsbb.ground.arguments import number, read_by
from roah_rsbb.model.actions import ACTIONS, AGAIN, confirmed_by
from roah_rsbb.model.reason import Refused
from roah_rsbb.model.scoring import Entered
from roah_rsbb.model.zone import CONNECTED, IDLE, RUNNING, SheetItem
from roah_rsbb.referee import day, organiser, sheets, terminal, view
from roah_rsbb.referee.at_once import ALL_OPTION, Exit, NoCore
from roah_rsbb.referee.run import Operations, RunScript, ScriptOutcome, ScriptPlan
from roah_rsbb.referee.state import (
    BoxFollower,
    asked_in,
    box_json,
    event_json,
    item_json,
    items_json,
    score_json,
    zone_json,
)
from roah_rsbb.referee.stopping import Stopping
from roah_rsbb.referee.terminal import (
    BY,
    OF_RUN,
    STEPS,
    ZONE,
    Call,
    Commands,
    Output,
    TypedCommand,
    argument,
    switch,
)
from roah_rsbb.referee.words import (
    GIVE_AGAIN,
    NOT_ATTEMPTED,
    PLACED,
    BadWord,
    EventWanted,
    event_wanted,
    given_of,
    pick_item,
    score_wanted,
    value_of,
)
from roah_rsbb.wording import schedule
from roah_rsbb.wording.texts import escaped

WATCH_STEP_S = 1.0
WAIT_S, MAX_WAIT_S = 60.0, 86400.0

_OF_BOX, _OF_ZONE = Commands(), Commands()


@_OF_BOX.add(
    "status", "show all zones at a glance, active robots and warnings",
    ["", "'Home A'    (in full: reasons, score sheet, online data)", "--json | jq '.zones[].phase'"],
    terminal.zone("show only this zone, in full; ", "?"),
)
def _status(call: Call) -> Exit:
    box, now, style = call.link.box, call.link.now(), call.output.style
    if call.one_zone is None:
        return call.output.show(box_json(box, now), view.status(box, now, style))
    return call.output.show({**zone_json(call.zone, now), "box_warnings": box.box.warnings},
                            [*view.warning_lines(box, style), *view.zone_report(call.zone, now, style)])


@_OF_BOX.add(
    "watch", "print what happens, one line each with its time, until Ctrl-C",
    ["", "--zone 'Home A'", "--json >> competition.jsonl"],
    terminal.zone("only this zone, the robots of its team, and the whole box; ", name="--zone"), has_keyboard=True,
)
def _watch(call: Call) -> Exit:
    link, output, zone = call.link, call.output, call.one_zone
    follower, now = BoxFollower(link, zone), link.now()
    output.show({"utc_s": now.utc, "kind": "start", "zone": zone or "", "box": box_json(follower.box, now)},
                [*view.status(follower.box, now, output.style, zone), ""])
    with call.keyboard(zone or "") as keyboard:
        if keyboard is not None:
            keyboard.show_hint()
        while not output.closed:
            for change in follower.step(WATCH_STEP_S):
                output.change(change)
    return Exit.OK


def _act(call: Call) -> Exit:
    """Do an action of the table."""
    action = ACTIONS[call.options.command.replace("-", "_")]
    if action.leaves:
        if action.name in terminal.ALWAYS and call.zone.phase == RUNNING:  # the box sends its robot nothing more then
            with contextlib.suppress(Refused):  # it has just ended
                call.link.stop_run(call.zone_name, call.zone.identity)
            call.link.settle()
        call.check_stopped()
    with contextlib.ExitStack() as asked:
        left = schedule.left_unsigned(call.link.box.schedule.values(), call.zone_name) if action.name in STEPS else None
        if left is not None:
            asked.enter_context(call.confirmed(
                call.zone_name, lambda: view.schedule_lines([left], call.output.style),
                "Its run is not signed off. Leave it? [y/N]",
                "the run is not signed off: sign it off first ('sign-off'), give --yes, or use a terminal, where you "
                "are asked", "the zone stays"))
        call.act(action.name, terminal.given_in(call.options, action))
        return call.say_done()


@_OF_ZONE.add(
    "stop", "stop the run of a zone, or of all zones; it stays connected", ["'Home A'", "all"],
    terminal.zone("'all' stops the runs of all zones. Otherwise the ", "?"),
    switch("--all", "stop the runs of all zones, also where a zone is named 'all'"), has_keyboard=True,
)
def _stop(call: Call) -> Exit:
    """Stop. The link need not be open."""
    link, options, output = call
    if (options.zone is None) != options.all:
        raise BadWord("give the name of a zone, or 'all'")
    stopping = Stopping(link, ALL_OPTION if options.all else options.zone, output.stop, sent=options.sent)
    with contextlib.suppress(KeyboardInterrupt):
        stopping.run()
    status, found = stopping.status(), stopping.result()
    reasons = [reason for one in found for reason in one.refused]
    if status is Exit.REFUSED and reasons:
        return output.failure(status, "stop was refused", reasons)
    zones = [{"zone": one.zone, "way": one.line(time.monotonic()).way,
              "state": None if one.after is None else zone_json(one.after, link.now())} for one in found]
    which = {"zones": zones} if stopping.is_all or not zones else zones[0]
    output.show({"kind": "result", "ok": status is Exit.OK, "exit": int(status), "command": "stop", **which},
                [] if found or status is not Exit.OK else ["no run is in progress"])
    return status


@_OF_ZONE.add(
    "score", "show the score sheet of the run in a zone, or set an item",
    ["'Home A'", "'Home A' 3 +1", "'Home A' 'door' yes", "'Home A' 4 not-attempted",
     "'Home A' 3 2 --note 'the vase, twice' --by Anna", "'Home A' 3 1 --run last    (a correction)"],
    ZONE, argument("item", nargs="?", help=terminal.ITEM),
    argument("value", nargs="?", help="a number, yes or no, +N or -N to count, '=N' to set also below 0, a choice, "
                                      "JUDGE:NUMBER, or not-attempted"),
    terminal.note("beside the value"), BY, OF_RUN,
)
def _score(call: Call) -> Exit:
    options, output = call.options, call.output
    if options.item is None:
        if options.run is not None:
            return sheets.show_sheet(call)
        zone = call.zone
        if zone.phase == IDLE:
            raise Refused(["No run is connected: the score sheet starts with connect"])
        return output.show({"zone": zone.zone, "event": event_json(zone), "score": items_json(zone.items)},
                           view.score_sheet(zone, output.style))
    if options.value is None:
        raise BadWord(f"the value of '{options.item}' is missing: give it after the item")
    zone_name, run = sheets.which(call)
    identity, items = run or call.zone.identity, call.link.run_sheet(zone_name, run).items
    number = pick_item(options.item, items)
    entered = _entered(call, identity, items[number - 1])._replace(note=options.note)
    call.link.mark(zone_name, identity, items[number - 1], entered, options.referee)
    item = call.link.run_sheet(zone_name, run).items[number - 1]
    return call.done([view.item_line(item)], zone=zone_name, **item_json(number, item))


def _entered(call: Call, identity: str, item: SheetItem) -> Entered:
    """Return the value that was typed for an item. If judges have sheets of their own, a rating alone is one, too: the
    box refuses it with the reason."""
    judged, typed = call.link.box.judging.get(identity), call.options.value
    if typed.lower() in NOT_ATTEMPTED:
        return Entered(not_attempted=True)
    return (sheets.settled_value if judged is not None and judged.count else value_of)(typed, item)


@_OF_ZONE.add(
    "done", "complete a manual operation, with an answer if it asks for one",
    ["'Home A'", "'Home A' skip", "--operation 3 'Home A' skip", "'Home A' grasped=yes drops=2 'place=1.25 0.40 90'"],
    ZONE,
    argument("answer", nargs="*",
             help="what the operation asks for ('status' shows it), in its order or as NAME=VALUE. The "
                  "beginning of a choice is enough (default: the first choice)"),
    argument("--operation", metavar="N", type=int,
             help="only if this is still the number of the operation ('status --json' shows it); before ZONE"), BY,
)
def _done(call: Call) -> Exit:
    zone, wanted = call.zone, call.options.operation
    if not zone.operation:
        raise Refused(["no manual operation is requested now"])
    if wanted not in (None, zone.operation):
        raise Refused([f"operation {wanted} is over; the current one is: {zone.manual_operation}"])
    call.act("operation", {"operation": zone.operation, **given_of(call.options.answer, asked_in(zone))})
    return call.say_done()


@_OF_ZONE.add(
    "run", "take a robot through a whole run: connect, start, score sheet, disconnect",
    ["'Home A'", "'Home A' --event HWV/1/2 --wait 300",
     "'Home A' --score door=yes --score 'moved furniture=2' --keep",
     "'Home A' --event HNF --operations typed", "'Home A' --team Beta --robot b2"],
    ZONE,
    argument("--wait", metavar="SECONDS", type=number(0.0, MAX_WAIT_S), default=WAIT_S,
             help="how long to wait for the box, then for connect and for start to be possible (default %(default)g)"),
    argument("--event", "--benchmark", metavar="CODE[/ROUND[/RUN]]", type=read_by(event_wanted),
             help="move the zone to this event first: the next matching one, else the last matching one before"),
    terminal.text("--team", "as --event: move the zone to an event of this team", metavar="TEAM"),
    terminal.text("--robot", "connect this robot of the team; default: the box chooses one", metavar="NAME"),
    argument("--score", metavar="ITEM=VALUE", action="append", default=[], type=read_by(score_wanted),
             help="set a scoring item after the start; may be repeated"),
    BY, switch("--again", str(AGAIN.label)), switch("--keep", "stay connected at the end"),
    argument("--operations", choices=[who.value for who in Operations], default=Operations.OTHERS.value,
             help="who does manual operations: others, at a panel or with 'done' (default); automatic: each is "
                  "completed at once with its first answer; typed: the answers come from standard input"),
    has_keyboard=True,
)
def _run(call: Call) -> Exit:
    link, options, output = call
    event = options.event
    if options.team:
        event = (event or EventWanted())._replace(team=options.team)
    link.referee = options.referee
    plan = ScriptPlan(call.zone_name, options.wait, event, tuple(options.score), options.keep,
                      Operations(options.operations), options.robot, options.again)
    is_typed = plan.operations is Operations.TYPED
    end = "end of input: other referees must complete manual operations" if is_typed else ""
    with call.keyboard(plan.zone, is_typed, end) as keyboard:
        if keyboard is not None and keyboard.is_terminal:
            keyboard.show_hint()
        outcome = RunScript(link, plan, output.change, keyboard).run()
        _show_outcome(plan.zone, outcome, output)
    return outcome.status


def _show_outcome(name: str, outcome: ScriptOutcome, output: Output) -> None:
    zone, status = outcome.zone, outcome.status
    run: Dict[str, Any] = {} if zone is None else {
        "event": event_json(zone), "end_reason": zone.end_reason, "robot": zone.robot_name,
        "score": items_json(zone.items), "module_score": [score_json(score) for score in zone.module_scores],
        "log_file": zone.log_file,
    }
    first, *rest = (escaped(line) for line in f"{name}: {outcome.text}".split("\n"))
    lines = [output.style(view.GREEN if status is Exit.OK else view.RED, first), *rest]
    if zone is not None and zone.phase != CONNECTED:
        log = [f"Log: {escaped(zone.log_file)}"] if zone.log_file else []
        lines = ["", *view.score_sheet(zone, output.style), *log, *lines]
    output.show({"kind": "result", "ok": status is Exit.OK, "exit": int(status), "zone": name, "text": outcome.text,
                 **run}, lines)


# -- all commands ---------------------------------------------------------------------------------

COMMANDS: Dict[str, TypedCommand] = {
    **_OF_BOX,
    **{action.words: terminal.of_action(action, _act)._replace(has_keyboard=action.name in STEPS)
       for action in ACTIONS.values() if action.name not in PLACED},
    **_OF_ZONE, **sheets.COMMANDS, **organiser.COMMANDS, **day.COMMANDS,
}


def parser() -> argparse.ArgumentParser:
    """Return the parser with all commands and their help."""
    return terminal.parser_of(COMMANDS)


def carry_out(options: Any, output: Output) -> Exit:
    """Connect to the core and carry out the command."""
    from roah_rsbb.referee.link import Link, NotConfirmed  # late: help, and completion in bash, need no connection

    link, command = Link(), COMMANDS[options.command]
    call = Call(link, options, output)
    link.start()
    try:
        with contextlib.nullcontext() if command.has_keyboard else call.slow_keyboard():
            if command.do is not _stop:
                link.open(options.wait if command.do is _run else 0.0)
            return command.do(call)
    except Refused as refused:
        how = "counts, but" if isinstance(refused, NotConfirmed) else "was refused"
        return output.failure(Exit.REFUSED, f"{options.command} {how}", confirmed_by(refused.reasons, GIVE_AGAIN))
    except BadWord as bad:
        return output.failure(Exit.USAGE, str(bad), [])
    except NoCore as gone:
        return output.failure(Exit.NO_CORE, str(gone), [])
    except KeyboardInterrupt:
        return Exit.OK if command.do is _watch else Exit.INTERRUPTED
    finally:
        link.close()
