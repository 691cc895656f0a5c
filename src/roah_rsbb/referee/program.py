"""The referee in a terminal: `rosrun roah_rsbb referee` (over ssh, and for scripts).

It shows what the core publishes and gives the core's commands, as the panels do. What may be done, and why
not, is the core's to say; this only waits, writes and ends with a status that says how it went.
"""

import json
import os
import signal
import sys
from typing import Any, Callable, Dict, List

import rospy

from roah_rsbb.core.referee import Refused
from roah_rsbb.referee import sheet_commands
from roah_rsbb.referee import view as view
from roah_rsbb.referee.args import PROG, parser
from roah_rsbb.referee.changes import Change
from roah_rsbb.referee.exits import Exit, NoCore
from roah_rsbb.referee.follow import Follower
from roah_rsbb.referee.link import Link
from roah_rsbb.referee.run import Operations, Plan, RunOutcome, RunScript
from roah_rsbb.referee.state import CONNECTED, IDLE, as_json
from roah_rsbb.referee.words import BadWord, answer_of, pick_item, pick_zone, value_of

WATCH_STEP_S = 1.0


class Output:
    """Standard output, as text or JSON. A reader that goes away is noticed, and is no error."""

    def __init__(self, as_json_lines: bool) -> None:
        self.json = as_json_lines
        self.closed = False
        sys.stdout.reconfigure(errors="backslashreplace")  # a terminal without UTF-8 still shows the rest
        fancy = sys.stdout.isatty() and not os.environ.get("NO_COLOR") and os.environ.get("TERM") != "dumb"
        self.paint = view.colour if fancy else view.no_colour

    def lines(self, lines: List[str]) -> None:
        """Write lines of text."""
        try:
            for line in lines:
                print(line)
            sys.stdout.flush()
        except BrokenPipeError:
            self.closed = True
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())

    def object(self, value: Any) -> None:
        """Write one JSON object on a line."""
        self.lines([json.dumps(as_json(value))])

    def change(self, change: Change) -> None:
        """Write what happened."""
        if self.json:
            self.object({"utc_s": change.utc_s, "kind": change.kind, "zone": change.zone, **change.facts})
        else:
            line = view.change_line(change, self.paint)
            self.lines([line] if line else [])

    def failure(self, status: Exit, text: str, reasons: List[str]) -> Exit:
        """Write why nothing was done: on standard error, or as JSON."""
        if self.json:
            self.object({"ok": False, "exit": int(status), "error": text, "reasons": reasons})
        else:
            lines = [f"{PROG}: {text}:", *(f"  {reason}" for reason in reasons)] if reasons else [f"{PROG}: {text}"]
            print("\n".join(view.plain(line) for line in "\n".join(lines).split("\n")), file=sys.stderr)
        return status


# -- commands -------------------------------------------------------------------------------------


def _status(link: Link, options, output: Output) -> Exit:
    box = link.box
    if options.zone is None:
        output.object(box) if output.json else output.lines(view.status(box, output.paint))
        return Exit.OK
    zone = box.zone(_zone_name(link, options.zone))
    output.object(zone) if output.json else output.lines(view.zone_report(zone, box.clock_utc_s, output.paint))
    return Exit.OK


def _watch(link: Link, options, output: Output) -> Exit:
    zone = None if options.zone is None else _zone_name(link, options.zone)
    if output.json:
        output.object({"utc_s": link.box.clock_utc_s, "kind": "start", "zone": zone or "", "box": link.box})
    else:
        box = link.box if zone is None else link.box._replace(zones=(link.box.zone(zone),))
        output.lines([*view.status(box, output.paint), ""])
    follower = Follower(link, zone)
    while not output.closed:
        for change in follower.step(WATCH_STEP_S):
            output.change(change)
    return Exit.OK


def _command(link: Link, options, output: Output) -> Exit:
    name = _zone_name(link, options.zone)
    link.command(options.command, name)
    return _say_done(link, name, output, options.command)


def _say_done(link: Link, name: str, output: Output, command: str) -> Exit:
    """Write how the zone is after a command."""
    box = link.settle()
    zone = box.zone(name)
    if output.json:
        output.object({"ok": True, "command": command, "zone": name, "state": zone})
    else:
        output.lines([f"{command}: done", *view.zone_lines(zone, box.clock_utc_s, output.paint)])
    return Exit.OK


def _score(link: Link, options, output: Output) -> Exit:
    if options.item is not None and options.value is None:
        raise BadWord(f"which value should '{options.item}' have? Give it behind the item")
    with_words = options.note or options.referee or options.run is not None
    if options.item is not None and (with_words or options.value.lower() in sheet_commands.NOT_ATTEMPTED):
        return sheet_commands.score(link, options, output)
    if options.run is not None:
        return sheet_commands.sheet(link, options, output)
    name = _zone_name(link, options.zone)
    zone = link.box.zone(name)
    if zone.phase == IDLE:
        raise Refused(["No run is connected: the score sheet begins with connect"])
    if options.item is None:
        output.object({"zone": name, "event": zone.event, "score": zone.score}) if output.json else output.lines(
            view.score_sheet(zone, output.paint))
        return Exit.OK
    item = pick_item(options.item, zone.score)
    link.set_score(name, item.group, item.item, value_of(options.value, item))
    zone = link.settle().zone(name)
    item = zone.score[item.number - 1]
    output.object({"ok": True, "command": "score", "zone": name, **item._asdict()}) if output.json else output.lines(
        [view.item_line(item)])
    return Exit.OK


def _done(link: Link, options, output: Output) -> Exit:
    name = _zone_name(link, options.zone)
    operation = link.box.zone(name).operation
    if operation is None:
        raise Refused(["nothing is asked of the referee now"])
    if options.operation not in (None, operation.number):
        raise Refused([f"operation {options.operation} is over; now the referee is asked to: {operation.text}"])
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
    plan = Plan(
        _zone_name(link, options.zone), options.wait, options.event, tuple(options.score), options.keep,
        Operations(options.operations),
    )
    outcome = RunScript(link, plan, output.change).run()
    _show_outcome(plan.zone, outcome, output)
    return outcome.status


def _show_outcome(name: str, outcome: RunOutcome, output: Output) -> None:
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
        log = [f"Log: {view.plain(zone.log_file)}"] if zone.log_file else []
        output.lines(["", *view.score_sheet(zone, output.paint), *log])
    colour = view.GREEN if outcome.status is Exit.OK else view.RED
    lines = [view.plain(line) for line in f"{name}: {outcome.text}".split("\n")]
    output.lines([output.paint(colour, lines[0]), *lines[1:]])


def _zone_name(link: Link, word: str) -> str:
    return pick_zone(word, [zone.zone for zone in link.box.zones])


_DO: Dict[str, Callable[[Link, Any, Output], Exit]] = {
    "status": _status, "watch": _watch, "score": _score, "done": _done, "switches": _switches, "run": _run,
    **sheet_commands.DO,
}


# -- the program ----------------------------------------------------------------------------------


def _do(link: Link, options, output: Output) -> Exit:
    try:
        link.open(options.wait if options.command == "run" else 0.0)
        return _DO.get(options.command, _command)(link, options, output)
    except Refused as refused:
        return output.failure(Exit.REFUSED, f"{options.command} was refused", refused.reasons)
    except BadWord as bad:
        return output.failure(Exit.USAGE, str(bad), [])
    except NoCore as gone:
        return output.failure(Exit.NO_CORE, str(gone), [])
    except KeyboardInterrupt:
        return Exit.OK if options.command == "watch" else Exit.INTERRUPTED


def _interrupt(_number: int, _frame: object) -> None:
    raise KeyboardInterrupt


def _hang_up(_number: int, _frame: object) -> None:
    """The terminal is gone: a run goes on, and another referee can take it over."""
    raise SystemExit(128 + signal.SIGHUP)


def main() -> None:
    """Entry point of `rosrun roah_rsbb referee`."""
    top = parser()
    options = top.parse_args(rospy.myargv(sys.argv)[1:])
    if options.command is None:
        top.print_help(sys.stderr)
        sys.exit(int(Exit.USAGE))
    signal.signal(signal.SIGTERM, _interrupt)
    if signal.getsignal(signal.SIGHUP) is signal.SIG_DFL:  # not under nohup
        signal.signal(signal.SIGHUP, _hang_up)
    link = Link()
    try:
        status = int(_do(link, options, Output(options.json)))
    except SystemExit as hung_up:
        status = hung_up.code
    link.close()
    sys.stdout.flush()
    # Threads that still wait for a master or a core that does not answer would hold the end up.
    os._exit(status)
