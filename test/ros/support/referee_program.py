"""The terminal's referee as a program, for tests."""

import json
import subprocess
from typing import Callable

from support.programs import Program, own, run
from support.waiting import wait_until


def referee(*words: str, **environment: str) -> "subprocess.CompletedProcess[str]":
    """A referee, from its start to its end."""
    return run(own("referee"), *words, **environment)


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
