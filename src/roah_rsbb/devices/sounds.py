"""Plays sounds by running a command: without a shell, without waiting for it, one at a time."""

import contextlib
import os
import shlex
import signal
import subprocess
import threading
from typing import Callable, Optional, Set

# Longer than any ring should be: a player that hangs must not keep the next ring from being heard.
LIMIT_S = 20.0
END_S = 2.0


class Sound:
    """One sound. A ring during a ring follows it; more than one do not wait, or the last one would be heard when
    nobody knows any more what it was for."""

    def __init__(
        self, name: str, command: str, on_trouble: Callable[[str], None], limit_s: float = LIMIT_S
    ) -> None:
        """`command`: as in a shell, but only words and quotes. `on_trouble(text)` is called once for each kind of
        trouble. ValueError: the command has no end of a quotation, or is empty."""
        self._name = name
        self._words = shlex.split(command)
        if not self._words:
            raise ValueError("the command is empty")
        self._on_trouble = on_trouble
        self._limit_s = limit_s
        self._told: Set[str] = set()
        self._wanted = threading.Event()
        self._closed = False
        self._running: Optional[subprocess.Popen] = None
        self._thread = threading.Thread(target=self._run, name=f"sound {name}", daemon=True)
        self._thread.start()

    def ring(self) -> None:
        """Let it be heard; returns at once."""
        self._wanted.set()

    def close(self) -> None:
        """Be silent, at once."""
        self._closed = True
        self._wanted.set()
        running = self._running
        if running is not None:
            _kill(running)
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
                self._trouble(f"{self._words[0]} cannot be run: {error.strerror}. Install it, or set another command")

    def _play(self) -> None:
        self._running = player = subprocess.Popen(
            self._words, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
            start_new_session=True,
        )
        if self._closed:
            _kill(player)
        try:
            status = player.wait(self._limit_s)
        except subprocess.TimeoutExpired:
            _kill(player)
            player.wait()
            self._trouble(f"{self._words[0]} played for more than {self._limit_s:g} s and was ended")
            return
        finally:
            self._running = None
        if status != 0 and not self._closed:
            self._trouble(f"{shlex.join(self._words)} failed with status {status}: try it in a terminal")

    def _trouble(self, text: str) -> None:
        if text not in self._told:
            self._told.add(text)
            self._on_trouble(f"{self._name} is not heard: {text}")


def _kill(player: subprocess.Popen) -> None:
    with contextlib.suppress(ProcessLookupError):
        os.killpg(player.pid, signal.SIGKILL)
