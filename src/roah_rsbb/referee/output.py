"""What the terminal referee prints: text or JSON."""

import contextlib
import json
import os
import shutil
import sys
import textwrap
import threading
import time
from typing import Any, Dict, List, Optional, Tuple

from roah_rsbb.referee import view
from roah_rsbb.referee.args import PROG
from roah_rsbb.referee.changes import Change
from roah_rsbb.referee.exits import Exit
from roah_rsbb.referee.state import as_json
from roah_rsbb.referee.stopping import StopLine
from roah_rsbb.wording.texts import escaped
from roah_rsbb.wording.times import Moments


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
