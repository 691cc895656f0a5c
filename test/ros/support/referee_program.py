"""The terminal's referee, for tests: as a program, or in the test's own process."""

import contextlib
import io
import json
import os
import subprocess
import sys
from typing import Callable
from unittest import mock

from roah_rsbb.referee import program
from support.programs import Program, own, run
from support.waiting import wait_until


def referee(*words: str, **environment: str) -> "subprocess.CompletedProcess[str]":
    """A referee, from its start to its end."""
    return run(own("referee"), *words, **environment)


class _Terminal(io.TextIOWrapper):
    """An output that says it is a terminal."""

    def isatty(self) -> bool:
        return True


def called(*words: str, on_terminal: bool = False, **environment: str) -> "subprocess.CompletedProcess[str]":
    """The referee's program, called in this process: a process of its own takes longer."""
    printed = (_Terminal if on_terminal else io.TextIOWrapper)(io.BytesIO(), encoding="utf-8")
    errors = io.StringIO()
    with open(os.devnull) as nothing, mock.patch.object(sys, "stdin", nothing), \
            mock.patch.dict(os.environ, environment), \
            contextlib.redirect_stdout(printed), contextlib.redirect_stderr(errors):
        try:
            status = program.carry_out(program.options_of(list(words)))
        except SystemExit as refused:
            status = refused.code
    printed.flush()
    if status:
        print(f"referee {' '.join(words)}: exit {status}: {errors.getvalue()}")  # for whoever looks for a cause
    return subprocess.CompletedProcess(words, status, printed.buffer.getvalue().decode("utf-8"), errors.getvalue())


class Referee(Program):
    """A referee that runs. Its lines are asked for in their order."""

    def __init__(self, *words: str, typed: str = "") -> None:
        self._next = 0
        super().__init__(own("referee"), *words, typed=typed)

    def line(self, fits: Callable[[str], bool], what: str) -> str:
        """Wait for the next line that fits."""
        def found() -> str:
            while self._next < len(self.lines):
                self._next += 1
                if fits(self.lines[self._next - 1]):
                    return self.lines[self._next - 1]
            return ""
        return wait_until(found, lambda: f"{what} is printed; it printed\n{self.text}")

    def event(self, kind: str, **facts: object) -> dict:
        """Wait for the next JSON line of a kind with these facts."""
        def fits(line: str) -> bool:
            made = json.loads(line)
            return made["kind"] == kind and all(made.get(name) == value for name, value in facts.items())
        return json.loads(self.line(fits, f"{kind} {facts}"))
