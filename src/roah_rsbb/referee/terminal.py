"""What every command of the terminal referee has: its name, help and arguments, its output, and the keyboard."""

import argparse
import contextlib
import functools
import json
import os
import re
import shutil
import sys
import textwrap
import threading
import time
from typing import (
    TYPE_CHECKING,
    Any,
    Callable,
    ContextManager,
    Dict,
    List,
    Mapping,
    NamedTuple,
    Optional,
    Sequence,
    Tuple,
)

from roah_rsbb.ground.arguments import Parser, called, read_by
from roah_rsbb.model.actions import Action
from roah_rsbb.model.fields import Field, Number, Team, Toggle
from roah_rsbb.model.reason import Refused
from roah_rsbb.model.zone import ZoneSeen
from roah_rsbb.referee import view
from roah_rsbb.referee.at_once import Exit
from roah_rsbb.referee.state import Change, as_json, zone_json
from roah_rsbb.referee.stopping import Keyboard, StopLine
from roah_rsbb.referee.words import BadWord, expected, pick_zone
from roah_rsbb.wording.stop import NOT_DELIVERED_S, leaving
from roah_rsbb.wording.texts import escaped
from roah_rsbb.wording.times import Moments

if TYPE_CHECKING:
    from roah_rsbb.referee.link import Link

PROG = called("referee")

_EXITS = """exit status:
  0    done; for 'run': the robot completed the run
  1    the box refused, with every reason; for 'run': connect or start was not possible
       within --wait, or a score could not be set
  2    wrong usage: an unknown command, zone, scoring item, value or event
  3    no ROS master, no box, or the box did not come back; for 'run' also:
       the run could not be disconnected; for 'stop': interrupted, NOT DELIVERED
  4    the run did not complete: timeout, stop, no messages saved, disconnected, lost;
       for 'stop': interrupted, and a robot does not report that it has stopped
  130  interrupted (Ctrl-C); 'run' stops its run first. A terminal that is closed
       (SIGHUP) leaves the run as it is
"""
# A word that is a value, and no option: argparse knows no decimal comma.
NEGATIVE = re.compile(r"-[0-9.,]+$")
# A command that takes longer reads STOP from the keyboard while it waits.
SLOW_S = 1.0


class Output:
    """Standard output, as text or JSON. If its reader goes away or its disk is full, `closed` is set. This is no error:
    a STOP continues."""

    def __init__(self, as_json_lines: bool, in_utc: bool) -> None:
        self.json = as_json_lines
        self.closed = False
        sys.stdout.reconfigure(errors="backslashreplace")  # a terminal without UTF-8 still shows the rest
        fancy = sys.stdout.isatty() and not os.environ.get("NO_COLOR") and os.environ.get("TERM") != "dumb"
        self.style = view.Style(fancy, Moments(in_utc))
        self._writing = threading.Lock()  # a STOP reports from a thread of its own
        self._stops: Dict[str, Tuple[str, str]] = {}  # by zone, what was said last of its STOP

    def show(self, value: Any, lines: List[str]) -> Exit:
        """Write the result of a command that was done, as JSON or as lines."""
        if self.json:
            self.object(value)
        else:
            self.lines(lines)
        return Exit.OK

    def lines(self, lines: List[str], end: str = "\n") -> None:
        """Write lines of text; `end`: after the last one."""
        try:
            with self._writing:
                if lines:
                    print("\n".join(lines) + end, end="")
                sys.stdout.flush()
        except OSError:
            self.closed = True
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())

    def object(self, value: Any) -> None:
        """Write one JSON object on a line."""
        self.lines([json.dumps(as_json(value))])

    def change(self, change: Change) -> None:
        """Write a change."""
        if self.json:
            self.object({"utc_s": change.utc_s, "kind": change.kind, "zone": change.zone, **change.facts})
        else:
            line = view.change_line(change, self.style)
            self.lines([line] if line else [])

    def note(self, zone: str, text: str) -> None:
        """Write what the program does or waits for."""
        self.change(Change(time.time(), "note", zone, {"text": text}))

    def stop(self, line: StopLine) -> None:
        """Write how far a STOP came. On a terminal, long lines are broken between words."""
        if self.json:
            self.object({"utc_s": time.time(), "kind": "stop", **line._asdict()})
            return
        width, (text, trouble) = self._width(), self._stops.get(line.zone, ("", ""))
        more = [*line.not_stopped, *([line.trouble] if line.trouble not in ("", trouble) else [])]
        is_news = text != line.text
        self._stops[line.zone] = line.text, line.trouble
        found = _wrapped(escaped(line.text), width, "") if is_news else []
        found += [part for text in more for part in _wrapped(escaped(text), width, "    ")]
        self.lines([self.style(view.RED, part) if line.is_lost else part for part in found])

    def question(self, text: str) -> None:
        """Write a question; the answer is typed behind it."""
        self.lines(_wrapped(text, self._width(), ""), end=" ")

    @staticmethod
    def _width() -> Optional[int]:
        """Characters in a line of the terminal; None: it is none."""
        return shutil.get_terminal_size().columns if sys.stdout.isatty() else None

    def failure(self, status: Exit, text: str, reasons: List[str]) -> Exit:
        """Write why the command failed, on standard error or as JSON."""
        if self.json:
            self.object({"ok": False, "exit": int(status), "error": text, "reasons": reasons})
        else:
            lines = [f"{PROG}: {text}:", *(f"  {reason}" for reason in reasons)] if reasons else [f"{PROG}: {text}"]
            with contextlib.suppress(OSError):
                print("\n".join(escaped(line) for line in "\n".join(lines).split("\n")), file=sys.stderr)
        return status


def _wrapped(text: str, width: Optional[int], begin: str) -> List[str]:
    """Break a line between words; `begin` is before each part."""
    if width is None:
        return [begin + text]
    return textwrap.wrap(text, max(width - 1, 10), initial_indent=begin, subsequent_indent=begin or "  ")


class Call(NamedTuple):
    """A command that was typed."""

    link: "Link"
    options: Any
    output: Output

    @property
    def zone_name(self) -> str:
        """The zone that the options name. Raises `BadWord`."""
        return pick_zone(self.options.zone, self.link.box.box.zones)

    @property
    def one_zone(self) -> Optional[str]:
        """As `zone_name`; None: all zones are meant."""
        return None if self.options.zone is None else self.zone_name

    @property
    def zone(self) -> ZoneSeen:
        """The zone that the options name, as it is now."""
        return self.link.box.zones[self.zone_name]

    def act(self, action: str, given: Dict[str, Any], run: str = "", zone: str = "") -> None:
        """Do an action of the table; see `Link.act`."""
        self.link.act(action, zone or self.zone_name, given, run, self.options.referee)

    def done(self, lines: List[str], command: str = "", **values: Any) -> Exit:
        """Print what a command did."""
        return self.output.show({"ok": True, "command": command or self.options.command, **values}, lines)

    def say_done(self) -> Exit:
        """Print the zone after a command."""
        self.link.settle()
        zone, now = self.zone, self.link.now()
        lines = [f"{self.options.command}: done", *view.zone_lines(zone, now, self.output.style)]
        return self.done(lines, zone=zone.zone, state=zone_json(zone, now))

    def check_stopped(self) -> None:
        """Refuse to leave a run whose robots do not report STOP, unless the referee says that they know it."""
        if self.options.yes:
            return
        deadline = self.link.here_s() + NOT_DELIVERED_S
        while leaving(self.zone):
            left = deadline - self.link.here_s()
            if left <= 0.0:
                raise Refused([f"{leaving(self.zone)}. Then give --yes"])
            self.link.next(left)

    # -- the keyboard -------------------------------------------------------------------------------

    def keyboard(self, zone: str, always: bool = False, at_end: str = "", begin_s: float = 0.0,
                 ) -> ContextManager[Optional[Keyboard]]:
        """Return what reads the lines that are typed; None: there is no terminal, and not `always` a reader."""
        if not always and not sys.stdin.isatty():
            return contextlib.nullcontext()
        note = functools.partial(self.output.note, zone)
        return Keyboard(self.link, self.output.stop, note, zone, always, at_end, begin_s)

    def slow_keyboard(self) -> ContextManager[Optional[Keyboard]]:
        """Return what reads STOP from the terminal while a command waits that reads nothing else."""
        if self.output.json:
            return contextlib.nullcontext()
        return self.keyboard(getattr(self.options, "zone", None) or "", begin_s=SLOW_S)

    @contextlib.contextmanager
    def confirmed(self, zone: str, lines: Callable[[], List[str]], question: str, how: str, refusal: str):
        """Ask before the `with` block, unless that was answered with --yes, and let STOP be typed within it. Raises
        `BadWord` where nobody can be asked; `how`: what can be done there."""
        with contextlib.ExitStack() as at_end:
            if not self.options.yes:
                if self.output.json or not sys.stdin.isatty():
                    raise BadWord(how)
                keyboard = at_end.enter_context(self.keyboard(zone, always=True))
                self.output.lines(lines())
                if keyboard.answer(lambda: self.output.question(question)).lower() not in ("y", "yes"):
                    raise Refused([f"{refusal}: the question was not answered with yes"])
            yield


# -- commands ---------------------------------------------------------------------------------------

# The names of an argument and the rest of what argparse knows of it.
Argument = Tuple[Tuple[str, ...], Dict[str, Any]]
# Carries a command out.
Do = Callable[[Call], Exit]


class TypedCommand(NamedTuple):
    """A command. `text` is its help, and `examples` are what may follow its name. `has_keyboard`: it reads what is
    typed. `is_exclusive`: only one of the arguments can be given. `actions`: the commands below it, one of which is
    given."""

    name: str
    text: str
    examples: Sequence[str]
    arguments: Sequence[Argument]
    do: Do
    has_keyboard: bool = False
    is_exclusive: bool = False
    actions: Mapping[str, "TypedCommand"] = {}


class Commands(Dict[str, TypedCommand]):
    """Commands by their names."""

    def add(
        self, name: str, text: str, examples: Sequence[str], *arguments: Argument, **more: Any,
    ) -> Callable[[Do], Do]:
        """Make a command of the decorated function."""
        def added(do: Do) -> Do:
            self[name] = TypedCommand(name, text, examples, arguments, do, **more)
            return do
        return added


# -- arguments --------------------------------------------------------------------------------------


def argument(*names: str, **options: Any) -> Argument:
    """Return an argument of a command. A word is named in capitals."""
    if not names[0].startswith("-") and "choices" not in options:
        options.setdefault("metavar", names[0].upper())
    return names, options


def zone(before: str = "", nargs: Optional[str] = None, name: str = "zone") -> Argument:
    """Return the argument that names a zone; `before`: what it is for."""
    return argument(name, metavar="ZONE", nargs=nargs,
                    help=f"{before}name of the zone, or the beginning of one name only; case does not matter")


def text(name: str, explanation: str, **options: Any) -> Argument:
    """Return an option whose value is a text."""
    return argument(name, **{"metavar": "TEXT", "default": "", "help": explanation, **options})


def switch(name: str, explanation: str, **options: Any) -> Argument:
    """Return an option without a value."""
    return argument(name, action="store_true", help=explanation, **options)


def by(required: bool = False) -> Argument:
    """Return the option that names who acts."""
    return text("--by", "name of the referee" + ("" if required else " (default: no name)"), metavar="NAME",
                dest="referee", required=required)


def note(where: str) -> Argument:
    """Return the option for a note."""
    return text("--note", f"stands {where} in the history")


def run(default: str = " (default: the connected run)") -> Argument:
    """Return the option that names a run."""
    return argument("--run", metavar="RUN",
                    help=f"a run that is over: 'last', or a part of its name ('runs' lists them){default}")


ZONE, BY, MUST_BY, OF_RUN = zone(), by(), by(required=True), run()
ITEM = "an item's number, or a part of one item's text only"
LEAVING = switch("--yes", "leave the run also if its robot did not answer STOP. The box no longer repeats it then")


# -- arguments from the table of actions ------------------------------------------------------------

# They leave the zone's event.
STEPS = ("previous", "next")
UNSIGNED = switch("--yes", "also leave an event whose run is not signed off")
# What whoever types an action means, without saying it: a run in progress is stopped and disconnected, too.
ALWAYS: Dict[str, Dict[str, Any]] = {"disconnect": {"running": True}}
# A word for each kind of field, in examples.
_EXAMPLES = {"name": "r1", "text": "'the reason'", "number": "60", "choice": "yes", "toggle": "yes", "robot": "r1",
             "team": "Beta", "event": "e1"}


def of_action(action: Action, do: Do) -> TypedCommand:
    """Return the command of an action: what must be entered is a word, what may be is an option."""
    words = " ".join(_example(field) for field in action.fields if _is_word(field))
    said = str(action.explanation)
    shown = [field for field in action.fields if field.name not in ALWAYS.get(action.name, {})]
    return TypedCommand(action.words, said[0].lower() + said[1:], [f"'Home A' {words}".rstrip()],
                        [ZONE, *map(_of_field, shown), *([LEAVING] if action.leaves else []),
                         *([UNSIGNED] if action.name in STEPS else []), BY], do)


def _of_field(field: Field) -> Argument:
    option, read = f"--{field.name.replace('_', '-')}", read_by(field.parse)
    if _is_word(field):
        optional = {} if field.required else {"nargs": "?", "default": ""}
        return argument(field.name, type=read, help=_word_help(field), **optional)
    if isinstance(field, Toggle):
        return switch(option, str(field.label), dest=field.name)
    return argument(option, dest=field.name, metavar=field.name.upper(), type=read, help=_word_help(field))


def _example(field: Field) -> str:
    return "2" if isinstance(field, Number) and not field.unit else _EXAMPLES[field.kind]


def _is_word(field: Field) -> bool:
    return field.required or isinstance(field, Team)


def _word_help(field: Field) -> str:
    if isinstance(field, Team):
        return "whom it hits: it is refused if the zone is at the event of another team"
    of_kind = expected(field)
    return str(field.label) if of_kind == "text" else f"{field.label}: {of_kind}"


def given_in(options: argparse.Namespace, action: Action) -> Dict[str, Any]:
    """Return the values of an action's fields that were typed."""
    typed = {field.name: getattr(options, field.name, None) for field in action.fields}
    entered = {name: value for name, value in typed.items() if value not in ("", None) and value is not False}
    return {**entered, **ALWAYS.get(action.name, {})}


# -- the parser -------------------------------------------------------------------------------------


def parser_of(commands: Mapping[str, TypedCommand]) -> argparse.ArgumentParser:
    """Return the parser with these commands and their help."""
    top = Parser(
        prog=PROG, formatter_class=_formatter,
        description="The referee in a terminal: for ssh, for scripts, and beside the panels.\n"
                    "'referee COMMAND --help' shows a command's options and examples.",
        epilog=_EXITS + "\nWith --json, every command prints JSON. docs/referee.md explains the fields.\n"
                        "Colour is used on a terminal only, and never where NO_COLOR is set.",
    )
    top.add_argument("--json", action="store_true", help="print JSON; watch and run: one object a line")
    top.add_argument("--utc", action="store_true", help="show times in UTC (default: the venue's time)")
    add_to(top.add_subparsers(dest="command", metavar="COMMAND"), commands, PROG)
    return top


def add_to(subparsers: Any, commands: Mapping[str, TypedCommand], before: str) -> None:
    """Add commands to a parser; `before`: what is typed before their names."""
    for command in commands.values():
        typed = f"{before} {command.name}"
        one = subparsers.add_parser(
            command.name, help=command.text, description=command.text[0].upper() + command.text[1:] + ".",
            formatter_class=_formatter,
            epilog="examples:\n" + "\n".join(f"  {typed} {example}".rstrip() for example in command.examples)
                   + "\n\n" + _EXITS,
        )
        one._negative_number_matcher = NEGATIVE
        # SUPPRESS: without the option here, an option before the command stays in force.
        one.add_argument("--json", action="store_true", default=argparse.SUPPRESS, help="print JSON")
        one.add_argument("--utc", action="store_true", default=argparse.SUPPRESS, help="show times in UTC")
        to = one.add_mutually_exclusive_group() if command.is_exclusive else one
        for names, options in command.arguments:
            to.add_argument(*names, **options)
        if command.actions:
            add_to(one.add_subparsers(dest="action", metavar="ACTION", required=True), command.actions, typed)


def _formatter(prog: str) -> argparse.HelpFormatter:
    return argparse.RawDescriptionHelpFormatter(prog, max_help_position=20, width=100)


# -- types of values --------------------------------------------------------------------------------


def counted(word: str) -> int:
    """A type for argparse: a number of 1 or more."""
    if not word.isdecimal() or not 1 <= int(word) < 2**32:
        raise argparse.ArgumentTypeError(f"'{word}' is not a number of 1 or more")
    return int(word)
