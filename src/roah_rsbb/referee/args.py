"""The command line of the terminal referee."""

import argparse
import math
import re
from typing import Any, Callable, Dict, Optional, Sequence, TypeVar

from roah_rsbb.ground.arguments import Parser, called, number, read_by
from roah_rsbb.model.actions import ACTIONS, AGAIN, Action
from roah_rsbb.model.fields import Field, Number, Team, Toggle
from roah_rsbb.referee.answers import Operations
from roah_rsbb.referee.words import PLACED, event_wanted, expected, score_wanted
from roah_rsbb.scoring.publication import MAX_OBJECTION_TIME_S
from roah_rsbb.wording.schedule import Show

T = TypeVar("T")

PROG = called("referee")
WAIT_S = 60.0
MAX_OBJECTION_MINUTES = MAX_OBJECTION_TIME_S / 60

_EXITS = """exit status:
  0    done; for 'run': the robot completed the run
  1    the core refused, with every reason; for 'run': connect or start was not possible
       within --wait, or a score could not be set
  2    wrong usage: an unknown command, zone, scoring item, value or event
  3    no ROS master, no core, or the core did not come back; for 'run' also:
       the run could not be disconnected; for 'stop': interrupted, NOT DELIVERED
  4    the run did not complete: timeout, stop, no messages saved, disconnected, lost;
       for 'stop': interrupted, and a robot does not report that it has stopped
  130  interrupted (Ctrl-C); 'run' stops its run first. A terminal that is closed
       (SIGHUP) leaves the run as it is
"""
_ZONE = "name of the zone, or the beginning of one name only; case does not matter"

_RUN = "a run that is over: 'last', or a part of its name ('runs' lists them)"

# A word that is a value, and no option: argparse knows no decimal comma.
NEGATIVE = re.compile(r"-[0-9.,]+$")


def _formatter(prog: str) -> argparse.HelpFormatter:
    return argparse.RawDescriptionHelpFormatter(prog, max_help_position=20, width=100)


def parser() -> argparse.ArgumentParser:
    """Return the parser with all commands and their help."""
    top = Parser(
        prog=PROG, formatter_class=_formatter,
        description="The referee in a terminal: for ssh, for scripts, and beside the panels.\n"
                    "'referee COMMAND --help' shows a command's options and examples.",
        epilog=_EXITS + "\nWith --json, every command prints JSON. docs/referee.md explains the fields.\n"
                        "Colour is used on a terminal only, and never where NO_COLOR is set.",
    )
    top.add_argument("--json", action="store_true", help="print JSON; watch and run: one object a line")
    top.add_argument("--utc", action="store_true", help="show times in UTC (default: the venue's time)")
    commands = top.add_subparsers(dest="command", metavar="COMMAND")
    _status(commands)
    _watch(commands)
    for action in ACTIONS.values():
        if action.name not in PLACED:
            _action(commands, action)
    _stop(commands)
    _score(commands)
    _sheets(commands)
    _judges(commands)
    _schedule(commands)
    _done(commands)
    _run(commands)
    _reload(commands)
    _pairing(commands)
    return top


def _action(commands, action: Action) -> None:
    """Add an action of the table: what must be entered is a word, what may be is an option."""
    words = " ".join(_example(field) for field in action.fields if _is_word(field))
    text = str(action.explanation)
    one = _add(commands, action.words, text[0].lower() + text[1:], [f"{PROG} {action.words} 'Home A' {words}".rstrip()])
    one.add_argument("zone", metavar="ZONE", help=_ZONE)
    for field in action.fields:
        label, read = str(field.label), read_by(field.parse)
        if field.name in ALWAYS.get(action.name, {}):
            continue
        if _is_word(field):
            optional: Dict[str, Any] = {} if field.required else {"nargs": "?", "default": ""}
            one.add_argument(field.name, metavar=field.name.upper(), type=read, help=_word_help(field), **optional)
        elif isinstance(field, Toggle):
            one.add_argument(f"--{_dashed(field.name)}", dest=field.name, action="store_true", help=label)
        else:
            one.add_argument(f"--{_dashed(field.name)}", dest=field.name, metavar=field.name.upper(), type=read,
                             help=_word_help(field))
    if action.leaves:
        _leaving(one)
    _by(one)


# What whoever types an action means, without saying it: a run in progress is stopped and disconnected, too.
ALWAYS: Dict[str, Dict[str, Any]] = {"disconnect": {"running": True}}
# A word for each kind of field, in examples.
_EXAMPLES = {"name": "r1", "text": "'the reason'", "number": "60", "choice": "yes", "toggle": "yes", "robot": "r1",
             "team": "Beta", "event": "e1"}


def _example(field: Field) -> str:
    return "2" if isinstance(field, Number) and not field.unit else _EXAMPLES[field.kind]


def _is_word(field: Field) -> bool:
    return field.required or isinstance(field, Team)


def _word_help(field: Field) -> str:
    if isinstance(field, Team):
        return "whom it hits: it is refused if the zone is at the event of another team"
    of_kind = expected(field)
    return str(field.label) if of_kind == "text" else f"{field.label}: {of_kind}"


def _dashed(name: str) -> str:
    return name.replace("_", "-")


def given_in(options: argparse.Namespace, action: Action) -> Dict[str, Any]:
    """Return the values of an action's fields that were typed."""
    typed = {field.name: getattr(options, field.name, None) for field in action.fields}
    entered = {name: value for name, value in typed.items() if value not in ("", None) and value is not False}
    return {**entered, **ALWAYS.get(action.name, {})}


def _add(commands, name: str, text: str, examples: Sequence[str]) -> argparse.ArgumentParser:
    one = commands.add_parser(
        name, help=text, description=text[0].upper() + text[1:] + ".",
        formatter_class=_formatter,
        epilog="examples:\n" + "\n".join(f"  {example}" for example in examples) + "\n\n" + _EXITS,
    )
    # SUPPRESS: without the option here, an option before the command stays in force.
    one.add_argument("--json", action="store_true", default=argparse.SUPPRESS, help="print JSON")
    one.add_argument("--utc", action="store_true", default=argparse.SUPPRESS, help="show times in UTC")
    return one


def _status(commands) -> None:
    one = _add(
        commands, "status", "show all zones at a glance, active robots and warnings",
        [f"{PROG} status", f"{PROG} status 'Home A'    (in full: reasons, score sheet, online data)",
         f"{PROG} status --json | jq '.zones[].phase'"],
    )
    one.add_argument("zone", metavar="ZONE", nargs="?", help="show only this zone, in full; " + _ZONE)


def _watch(commands) -> None:
    one = _add(
        commands, "watch", "print what happens, one line each with its time, until Ctrl-C",
        [f"{PROG} watch", f"{PROG} watch --zone 'Home A'", f"{PROG} watch --json >> competition.jsonl"],
    )
    one.add_argument("--zone", metavar="ZONE",
                     help="only this zone, the robots of its team, and the whole box; " + _ZONE)


def _stop(commands) -> None:
    one = _add(
        commands, "stop", "stop the run of a zone, or of all zones; it stays connected",
        [f"{PROG} stop 'Home A'", f"{PROG} stop all"],
    )
    one.add_argument("zone", metavar="ZONE", nargs="?",
                     help="'all' stops the runs of all zones. Otherwise the " + _ZONE)
    one.add_argument("--all", action="store_true", help="stop the runs of all zones, also where a zone is named 'all'")


def _score(commands) -> None:
    one = _add(
        commands, "score", "show the score sheet of the run in a zone, or set an item",
        [f"{PROG} score 'Home A'", f"{PROG} score 'Home A' 3 +1", f"{PROG} score 'Home A' 'door' yes",
         f"{PROG} score 'Home A' 4 not-attempted", f"{PROG} score 'Home A' 3 2 --note 'the vase, twice' --by Anna",
         f"{PROG} score 'Home A' 3 1 --run last    (a correction)"],
    )
    one.add_argument("zone", metavar="ZONE", help=_ZONE)
    one.add_argument("item", metavar="ITEM", nargs="?", help="an item's number, or a part of one item's text only")
    one.add_argument("value", metavar="VALUE", nargs="?",
                     help="a number, yes or no, +N or -N to count, '=N' to set also below 0, a choice, JUDGE:NUMBER, "
                          "or not-attempted")
    one._negative_number_matcher = NEGATIVE
    _say(one, "beside the value")
    _of_run(one)


def _say(one: argparse.ArgumentParser, where: str) -> None:
    one.add_argument("--note", metavar="TEXT", default="", help=f"stands {where} in the history")
    _by(one)


def _by(one: argparse.ArgumentParser, required: bool = False) -> None:
    one.add_argument("--by", metavar="NAME", dest="referee", default="", required=required,
                     help="name of the referee" + ("" if required else " (default: no name)"))


def _leaving(one: argparse.ArgumentParser) -> None:
    one.add_argument("--yes", action="store_true",
                     help="leave the run also if its robot did not answer STOP. The box no longer repeats it then")


def _robot(one: argparse.ArgumentParser) -> None:
    one.add_argument("--robot", metavar="NAME", default="",
                     help="connect this robot of the team; default: the core chooses one")


def _of_run(one: argparse.ArgumentParser) -> None:
    one.add_argument("--run", metavar="RUN", help=_RUN + " (default: the connected run)")


def _sheets(commands) -> None:
    one = _add(commands, "runs", "list connected and finished runs with their scores",
               [f"{PROG} runs", f"{PROG} runs 'Home A'"])
    one.add_argument("zone", metavar="ZONE", nargs="?", help="only the runs of this zone; " + _ZONE)
    one = _add(commands, "sheet", "show a score sheet with its history, and why the run ended",
               [f"{PROG} sheet 'Home A'", f"{PROG} sheet 'Home A' --run last"])
    one.add_argument("zone", metavar="ZONE", help=_ZONE)
    _of_run(one)
    one = _add(commands, "withdraw", "withdraw an entry of the history",
               [f"{PROG} withdraw 'Home A' 3 --note 'another robot'"])
    one.add_argument("zone", metavar="ZONE", help=_ZONE)
    one.add_argument("entry", metavar="ENTRY", type=_counted, help="number of the entry ('sheet' shows it)")
    _say(one, "beside the withdrawal")
    _of_run(one)
    one = _add(commands, "reason", "record why a run was stopped, until it is signed off",
               [f"{PROG} reason 'Home A' 'fire alarm'", f"{PROG} reason 'Home A' 'hit the vase' --run last --end 1"])
    one.add_argument("zone", metavar="ZONE", help=_ZONE)
    one.add_argument("text", metavar="TEXT", help="the reason; it replaces an earlier one")
    one.add_argument("--end", metavar="N", type=_counted, default=0,
                     help="number of the end ('sheet' shows it; default: the last)")
    _by(one)
    _of_run(one)
    one = _add(commands, "sign-off", "sign off the score sheet of a finished run, which makes it final",
               [f"{PROG} sign-off 'Home A' --run last --by Anna"])
    one.add_argument("zone", metavar="ZONE", help=_ZONE)
    one.add_argument("--run", metavar="RUN", help=_RUN)
    _by(one, required=True)
    one.add_argument("--yes", action="store_true", help="sign off without asking")


def _judges(commands) -> None:
    hall = "Hall"
    top = _add(commands, "judges", "several judges and objections: list them, settle, hand back, publish, answer",
               [f"{PROG} judges list", f"{PROG} judges settle {hall} 1 3 --reason 'the video shows it' --by Hugo",
                f"{PROG} judges settle --help",
                f"{PROG} sign-off {hall} --run last --by Hugo    (makes the result final)"])
    actions = top.add_subparsers(dest="action", metavar="ACTION", required=True)
    _judging(actions, "list", "show who has submitted, the values side by side, and objections",
                   ["", f"{hall}", f"{hall} --run last"], zone="?")
    one = _judging(actions, "settle", "settle the value of an item where the judges differ",
                   [f"{hall} 1 3 --reason 'the video shows it' --by Hugo",
                    f"{hall} presentation 7.5 --reason 'mean of both' --by Hugo"])
    one.add_argument("item", metavar="ITEM", help="an item's number, or a part of one item's text only")
    one.add_argument("value", metavar="VALUE",
                     help="a number, yes or no, a choice, or not-attempted; a rating is one number")
    one._negative_number_matcher = NEGATIVE
    _reasoned(one)
    for name, text in (("hand-back", "hand a sheet back: the judge looks again, and submits again"),
                       ("withdraw", "withdraw a sheet: it no longer counts, and another judge can take the place")):
        one = _judging(actions, name, text, [f"{hall} Ben --reason 'item 2 is empty' --by Hugo"])
        one.add_argument("judge", metavar="JUDGE", help="name of the judge")
        _reasoned(one)
    _reasoned(_judging(actions, "end-waiting", "do not wait for missing judges",
                       [f"{hall} --reason 'Ben is ill' --by Hugo"]))
    one = _judging(actions, "publish", "publish the result of a finished run as provisional",
                   [f"{hall} --by Hugo", f"{hall} --minutes 15 --by Hugo"])
    one.add_argument("--minutes", metavar="N", type=number(0, MAX_OBJECTION_MINUTES),
                     help="the time for objections (default: that of the benchmarks file)")
    _by(one)
    one = _judging(actions, "object", "enter an objection to a provisional result",
                   [f"{hall} Epsilon 'the cup was on the table' --by Hugo"])
    one.add_argument("objector", metavar="WHO", help="who objects, such as a team")
    one.add_argument("text", metavar="TEXT", help="the objection")
    _by(one)
    one = _judging(actions, "answer", "answer an objection",
                   [f"{hall} 1 uphold 'the video shows it' --by Hugo", f"{hall} 1 reject 'it fell' --by Hugo"])
    one.add_argument("number", metavar="N", type=_counted, help="number of the objection ('judges list' shows it)")
    one.add_argument("verdict", choices=("uphold", "reject"), help="uphold or reject it; the sheet is corrected "
                                                                   "separately")
    one.add_argument("text", metavar="TEXT", help="the answer")
    _by(one)


def _judging(actions, name: str, text: str, examples: Sequence[str], zone: Optional[str] = None) -> (
        argparse.ArgumentParser):
    one = _add(actions, name, text, [f"{PROG} judges {name} {example}".rstrip() for example in examples])
    one.add_argument("zone", metavar="ZONE", nargs=zone, help=_ZONE)
    one.add_argument("--run", metavar="RUN", help="a run of the zone: 'last', or a part of its name (default: the one "
                                                  "that is not signed off)")
    return one


def _reasoned(one: argparse.ArgumentParser) -> None:
    one.add_argument("--reason", metavar="TEXT", required=True, help="why; it is kept with the score sheet")
    _by(one, required=True)


def _schedule(commands) -> None:
    one = _add(commands, "schedule", "list all events with results, sign-offs and estimated times",
               [f"{PROG} schedule", f"{PROG} schedule 'Home A' --day 2026-11-28", f"{PROG} schedule --team Beta",
                f"{PROG} schedule --show missing    (what is not run or not signed off)"])
    one.add_argument("zone", metavar="ZONE", nargs="?", help="only the events of this zone; " + _ZONE)
    one.add_argument("--team", metavar="TEAM", default="", help="only the events of this team")
    one.add_argument("--day", metavar="YYYY-MM-DD", default="", help="only the events of this day")
    one.add_argument("--show", choices=[show.name.lower().replace("_", "-") for show in Show], default="all",
                     help="all events (default), to-come, unsigned (not signed off), or missing (without a result that "
                          "is signed off)")
    one = _add(commands, "choose", "make an event of the schedule the current one of its zone",
               [f"{PROG} choose 'Home A' 3", f"{PROG} choose 'Home A' 3 --unsigned"])
    one.add_argument("zone", metavar="ZONE", help=_ZONE)
    one.add_argument("event", metavar="EVENT", type=_counted,
                     help="number of the event in its zone ('schedule' shows it)")
    one.add_argument("--unsigned", action="store_true",
                     help="leave the zone's run although its score sheet is not signed off")
    _leaving(one)
    _by(one)


def _counted(word: str) -> int:
    if not word.isdecimal() or not 1 <= int(word) < 2**32:
        raise argparse.ArgumentTypeError(f"'{word}' is not a number of 1 or more")
    return int(word)


def _done(commands) -> None:
    one = _add(
        commands, "done", "complete a manual operation, with an answer if it asks for one",
        [f"{PROG} done 'Home A'", f"{PROG} done 'Home A' skip", f"{PROG} done --operation 3 'Home A' skip",
         f"{PROG} done 'Home A' grasped=yes drops=2 'place=1.25 0.40 90'"],
    )
    one.add_argument("zone", metavar="ZONE", help=_ZONE)
    one.add_argument("answer", metavar="ANSWER", nargs="*",
                     help="what the operation asks for ('status' shows it), in its order or as NAME=VALUE. The "
                          "beginning of a choice is enough (default: the first choice)")
    one.add_argument("--operation", metavar="N", type=int,
                     help="only if this is still the number of the operation ('status --json' shows it); before ZONE")
    _by(one)


def _run(commands) -> None:
    one = _add(
        commands, "run", "take a robot through a whole run: connect, start, score sheet, disconnect",
        [f"{PROG} run 'Home A'", f"{PROG} run 'Home A' --event HWV/1/2 --wait 300",
         f"{PROG} run 'Home A' --score door=yes --score 'moved furniture=2' --keep",
         f"{PROG} run 'Home A' --event HNF --operations typed", f"{PROG} run 'Home A' --team Beta --robot b2"],
    )
    one.add_argument("zone", metavar="ZONE", help=_ZONE)
    one.add_argument(
        "--wait", metavar="SECONDS", type=_seconds, default=WAIT_S,
        help="how long to wait for the core, then for connect and for start to be possible (default %(default)g)",
    )
    one.add_argument(
        "--event", "--benchmark", metavar="CODE[/ROUND[/RUN]]",
        type=_type("CODE, CODE/ROUND or CODE/ROUND/RUN", event_wanted),
        help="move the zone to this event first: the next matching one, else the last matching one before",
    )
    one.add_argument("--team", metavar="TEAM", default="", help="as --event: move the zone to an event of this team")
    _robot(one)
    one.add_argument(
        "--score", metavar="ITEM=VALUE", action="append", default=[], type=_type("ITEM=VALUE", score_wanted),
        help="set a scoring item after the start; may be repeated",
    )
    _by(one)
    one.add_argument("--again", action="store_true", help=str(AGAIN.label))
    one.add_argument("--keep", action="store_true", help="stay connected at the end")
    one.add_argument(
        "--operations", choices=[who.value for who in Operations], default=Operations.OTHERS.value,
        help="who does manual operations: others, at a panel or with 'done' (default); automatic: each is completed "
             "at once with its first answer; typed: the answers come from standard input",
    )


def _reload(commands) -> None:
    one = _add(
        commands, "reload", "take changed configuration files into use, without a restart",
        [f"{PROG} reload", f"{PROG} reload --check    (only list what would change)", f"{PROG} reload --yes --by Olga"],
    )
    one.add_argument("--check", action="store_true", help="change nothing: only list errors and changes")
    one.add_argument("--yes", action="store_true", help="apply the changes without asking")
    _by(one)


def _pairing(commands) -> None:
    one = _add(commands, "pair", "show a code that pairs a phone or tablet: it can then act as a referee",
               [f"{PROG} pair 'Home A'", f"{PROG} pair 'Home A' --role judge", f"{PROG} pair --role organiser"])
    one.add_argument("zone", metavar="ZONE", nargs="?", help="where it may act; " + _ZONE)
    one.add_argument("--role", choices=("referee", "judge", "organiser"), default="referee",
                     help="referee (default): everything in the zone; judge: ratings only; organiser: all zones")
    one = _add(commands, "devices", "list the paired phones and tablets, or end pairings",
               [f"{PROG} devices", f"{PROG} devices --revoke 1f3c9a02", f"{PROG} devices --revoke-all"])
    which = one.add_mutually_exclusive_group()
    which.add_argument("--revoke", metavar="ID", help="end the pairing of this device at once")
    which.add_argument("--revoke-all", action="store_true", help="end all pairings at once")
    one = _add(commands, "team-codes", "list the codes with which teams see how the box hears their robot",
               [f"{PROG} team-codes", f"{PROG} team-codes --renew    (the codes before become invalid)"])
    one.add_argument("--renew", action="store_true", help="give all teams new codes first")


def _type(form: str, read: Callable[[str], T]) -> Callable[[str], T]:
    """Return a converter for argparse whose error names the expected form."""

    def convert(text: str) -> T:
        try:
            return read(text)
        except ValueError:
            raise argparse.ArgumentTypeError(f"'{text}' does not have the form {form}") from None

    return convert


def _seconds(text: str) -> float:
    seconds = float(text)
    if not math.isfinite(seconds) or seconds < 0:
        raise argparse.ArgumentTypeError(f"'{text}' is not a number of seconds")
    return seconds
