"""Plays sounds by running a command: without a shell, in the background, one at a time."""

import shlex
import shutil
import subprocess
import threading
from typing import Callable, List, Optional, Sequence, Set

from roah_rsbb.ground import linux
from roah_rsbb.ground.installed import shipped_folder
from roah_rsbb.ground.params import BadParams, Params

BELL, TIMEOUT = "bell.wav", "timeout.wav"
# With which a player is tried.
SILENCE = "silence.wav"
# The first one that is installed plays the included sounds. aplay is in package alsa-utils of Debian and Ubuntu.
_PLAYERS = (("aplay", "-q"), ("paplay",), ("pw-play",), ("ffplay", "-nodisp", "-autoexit"))
# Time limit for playing, so that a hanging player does not block the next ring.
LIMIT_S = 20.0
END_S = 2.0


class Sound:
    """One sound. While it plays, at most one further ring waits, so that no ring is much too late."""

    def __init__(
        self, name: str, words: Sequence[str], on_problem: Callable[[str], None], limit_s: float = LIMIT_S
    ) -> None:
        """`words`: the command, see `words_of`. `on_problem(text)` is called once per kind of problem."""
        self._name = name
        self._words = words
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
            linux.end_with_children(running)
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
            linux.end_with_children(player)
        try:
            status = player.wait(self._limit_s)
        except subprocess.TimeoutExpired:
            linux.end_with_children(player)
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


def words_of(command: str) -> List[str]:
    """Split a command into words, with quotes as in a shell. Raises ValueError for an unclosed quote or no words."""
    words = shlex.split(command)
    if not words:
        raise ValueError("the command is empty")
    return words


def command_of(params: Params, name: str, file: str) -> List[str]:
    """The words of the command that a parameter gives; an empty one, which means the default in launch files: of that
    which plays an included sound. Raises `BadParams` and `NotShipped`."""
    command = params.text(name, "")
    try:
        return words_of(command) if command else default_command(file)
    except ValueError as error:
        where = params.full_name(name)
        raise BadParams(f"parameter {where}: found {command!r}, expected a command ({error})") from None


def default_command(file: str) -> List[str]:
    """The command that plays an included sound, such as `BELL`. Raises `NotShipped`."""
    path = str(shipped_folder().parent / "resource" / "sounds" / file)
    return [*next((player for player in _PLAYERS if shutil.which(player[0])), _PLAYERS[0]), path]
