"""What a command of the terminal referee is: its name, its help, its arguments, and what it does."""

import argparse
import math
import re
from typing import Any, Callable, Dict, Mapping, NamedTuple, Optional, Sequence, Tuple, TypeVar

from roah_rsbb.ground.arguments import Parser, called, read_by
from roah_rsbb.model.actions import Action
from roah_rsbb.model.fields import Field, Number, Team, Toggle
from roah_rsbb.referee.at_once import Exit
from roah_rsbb.referee.words import expected

T = TypeVar("T")

PROG = called("referee")

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
# A word that is a value, and no option: argparse knows no decimal comma.
NEGATIVE = re.compile(r"-[0-9.,]+$")

# The names of an argument and the rest of what argparse knows of it.
Argument = Tuple[Tuple[str, ...], Dict[str, Any]]
# Carries a command out: gets the link to the core, the options and the output.
Do = Callable[[Any, argparse.Namespace, Any], Exit]


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
                        [ZONE, *map(_of_field, shown), *([LEAVING] if action.leaves else []), BY], do)


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


def of_form(form: str, read: Callable[[str], T]) -> Callable[[str], T]:
    """A type for argparse whose error names the expected form."""
    def convert(word: str) -> T:
        try:
            return read(word)
        except ValueError:
            raise argparse.ArgumentTypeError(f"'{word}' does not have the form {form}") from None
    return convert


def seconds(word: str) -> float:
    """A type for argparse: a number of seconds."""
    found = float(word)
    if not math.isfinite(found) or found < 0:
        raise argparse.ArgumentTypeError(f"'{word}' is not a number of seconds")
    return found
