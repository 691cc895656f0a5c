"""Plays sounds by running a command: without a shell, in the background, one at a time."""

import shlex
import subprocess
import threading
from typing import Callable, Optional, Set

from roah_rsbb import platform

# Time limit for playing, so that a hanging player does not block the next ring.
LIMIT_S = 20.0
END_S = 2.0


class Sound:
    """One sound. While it plays, at most one further ring waits, so that no ring is much too late."""

    def __init__(
        self, name: str, command: str, on_problem: Callable[[str], None], limit_s: float = LIMIT_S
    ) -> None:
        """`command` consists of words and quotes, as in a shell. `on_problem(text)` is called once per kind of problem.

        Raises ValueError for an unclosed quote or an empty command.
        """
        self._name = name
        self._words = shlex.split(command)
        if not self._words:
            raise ValueError("the command is empty")
        self._on_problem = on_problem
        self._limit_s = limit_s
        self._reported: Set[str] = set()
        self._wanted = threading.Event()
        self._closed = False
        self._running: Optional[subprocess.Popen] = None
        self._thread = threading.Thread(target=self._run, name=f"sound {name}", daemon=True)
        self._thread.start()

    def ring(self) -> None:
        """Play the sound soon; returns immediately."""
        self._wanted.set()

    def close(self) -> None:
        """Stop immediately."""
        self._closed = True
        self._wanted.set()
        running = self._running
        if running is not None:
            platform.end_with_children(running)
        self._thread.join(END_S)

    def _run(self) -> None:
        while True:
            self._wanted.wait()
            self._wanted.clear()
            if self._closed:
                return
            try:
                self._play()
            except OSError as error:
                self._report(f"{self._words[0]} cannot be run: {error.strerror}. Install it, or choose another command")

    def _play(self) -> None:
        self._running = player = subprocess.Popen(
            self._words, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
            start_new_session=True,
        )
        if self._closed:
            platform.end_with_children(player)
        try:
            status = player.wait(self._limit_s)
        except subprocess.TimeoutExpired:
            platform.end_with_children(player)
            player.wait()
            self._report(f"{self._words[0]} played for more than {self._limit_s:g} s and was ended")
            return
        finally:
            self._running = None
        if status != 0 and not self._closed:
            self._report(f"{shlex.join(self._words)} failed with status {status}: try it in a terminal")

    def _report(self, text: str) -> None:
        if text not in self._reported:
            self._reported.add(text)
            self._on_problem(f"{self._name} cannot be heard: {text}")
