"""What the terminal referee prints: text or JSON."""

import json
import os
import sys
from typing import Any, List

from roah_rsbb.referee import view
from roah_rsbb.referee.args import PROG
from roah_rsbb.referee.changes import Change
from roah_rsbb.referee.exits import Exit
from roah_rsbb.referee.state import as_json
from roah_rsbb.wording.texts import escaped
from roah_rsbb.wording.times import Moments


class Output:
    """Standard output, as text or JSON. If its reader goes away, `closed` is set; this is not an error."""

    def __init__(self, as_json_lines: bool, in_utc: bool) -> None:
        self.json = as_json_lines
        self.closed = False
        sys.stdout.reconfigure(errors="backslashreplace")  # a terminal without UTF-8 still shows the rest
        fancy = sys.stdout.isatty() and not os.environ.get("NO_COLOR") and os.environ.get("TERM") != "dumb"
        self.style = view.Style(fancy, Moments(in_utc))

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
        """Write a change."""
        if self.json:
            self.object({"utc_s": change.utc_s, "kind": change.kind, "zone": change.zone, **change.facts})
        else:
            line = view.change_line(change, self.style)
            self.lines([line] if line else [])

    def failure(self, status: Exit, text: str, reasons: List[str]) -> Exit:
        """Write why the command failed, on standard error or as JSON."""
        if self.json:
            self.object({"ok": False, "exit": int(status), "error": text, "reasons": reasons})
        else:
            lines = [f"{PROG}: {text}:", *(f"  {reason}" for reason in reasons)] if reasons else [f"{PROG}: {text}"]
            print("\n".join(escaped(line) for line in "\n".join(lines).split("\n")), file=sys.stderr)
        return status
