"""What a command of the terminal referee works with: the link to the core, its options, its output and the keyboard."""

import contextlib
import functools
import json
import os
import shutil
import sys
import textwrap
import threading
import time
from typing import TYPE_CHECKING, Any, Callable, ContextManager, Dict, List, NamedTuple, Optional, Tuple

from roah_rsbb.model.reason import Refused
from roah_rsbb.model.zone import ZoneSeen
from roah_rsbb.referee import view
from roah_rsbb.referee.args import PROG
from roah_rsbb.referee.at_once import Exit
from roah_rsbb.referee.state import Change, as_json, zone_json
from roah_rsbb.referee.stopping import Keyboard, StopLine
from roah_rsbb.referee.words import BadWord, pick_zone
from roah_rsbb.wording.stop import NOT_DELIVERED_S, leaving
from roah_rsbb.wording.texts import escaped
from roah_rsbb.wording.times import Moments

if TYPE_CHECKING:
    from roah_rsbb.referee.link import Link

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
