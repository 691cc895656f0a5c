"""Keyboard shortcuts of commands, which must be pressed twice."""

import time
from typing import Callable, Hashable, Tuple

from roah_rsbb.rqt.model import presses
from roah_rsbb.rqt.panels.panel import AnswerLine, Panel
from roah_rsbb.rqt.qt import QKeySequence, QShortcut, Qt
from roah_rsbb.rqt.widgets.basic import CommandButton
from roah_rsbb.wording.language import tr


class TwiceKey:
    """A key that gives a button's command when it is pressed twice, wherever the focus is."""

    def __init__(
        self, panel: Panel, key: str, button: CommandButton, answer: AnswerLine,
        what: Callable[[], Tuple[Hashable, str]], act: Callable[[], None],
    ) -> None:
        """`what()` returns the key's current command, on which both presses must agree, and its name."""
        self._key = key
        self._button = button
        self._answer = answer
        self._what = what
        self._act = act
        self._presses = panel.client.presses
        self._asked = False
        shortcut = QShortcut(QKeySequence(key), panel)
        shortcut.setContext(Qt.ApplicationShortcut)
        shortcut.setAutoRepeat(False)
        shortcut.activated.connect(self._press)
        # If a process has two of these panels, either may take the key: they share the count of presses.
        shortcut.activatedAmbiguously.connect(self._press)

    def forget(self) -> None:
        """Clear the prompt when the time for the second press is over. Call it regularly."""
        if self._asked and self._presses.armed(time.monotonic()) is None:
            self._asked = False
            self._answer.clear_answer()

    def _press(self) -> None:
        now, (what, label) = time.monotonic(), self._what()
        if not self._button.is_on():
            self._answer.warn(f"{label}: {self._button.why_off or tr('just pressed')}")
        elif self._presses.press(now, what):
            self._act()
        elif self._presses.armed(now) == what:
            self._answer.warn(tr("{command}?  Press {key} again within {time:.0f} s",
                                 command=label, key=self._key, time=presses.WITHIN_S))
            self._asked = True
