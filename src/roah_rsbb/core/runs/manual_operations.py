"""What the referee does in a functionality benchmark: manual operations, and HOMF's switches.

Both are plain records of what was asked for and what was said; the run decides what follows.
"""

from typing import List, NamedTuple, Tuple

from roah_rsbb.core.modules.messages import Request
from roah_rsbb.core.referee import Refused

# An answer is shown, logged and sent to the module.
MAX_ANSWER = 1000
# `uint8` on the ROS interface.
MAX_DAMAGED = 255
# A referee who presses more often than that has something on the keyboard.
MAX_CHANGES = 1000


def check_answer(request: Request, operation: int, answer: str) -> str:
    """The answer to a manual operation that counts; raises `Refused`.

    `operation`: number of the request that was answered, 0: whatever is asked. No answer means the first
    choice, the usual one.
    """
    if operation not in (0, request.number):
        raise Refused([f"that manual operation is over; now the referee is asked to: {request.text}"])
    if not answer:
        return request.choices[0] if request.choices else ""
    if len(answer) > MAX_ANSWER:
        raise Refused([f"an answer has at most {MAX_ANSWER} characters, not {len(answer)}"])
    if answer in request.choices or request.asks_text:
        return answer
    if request.choices:
        raise Refused([f"'{answer}' is no answer to '{request.text}': there are {', '.join(request.choices)}"])
    raise Refused([f"'{request.text}' takes no answer: complete it without one"])


class SwitchesState(NamedTuple):
    """The saved state of `Switches`; see its attributes."""

    initial_state: Tuple[bool, ...]
    changed: Tuple[int, ...] = ()
    damaged: int = 0


class Switches:
    """HOMF: the switches as the referee sees them; they are numbered from 1."""

    def __init__(self, initial_state: Tuple[bool, ...]) -> None:
        self._initial_state = initial_state
        self._count = len(initial_state)
        self._on = {number for number, on in enumerate(initial_state, 1) if on}
        self.changed: List[int] = []
        self.damaged = 0

    def saved(self) -> SwitchesState:
        """The state for the journal."""
        return SwitchesState(self._initial_state, tuple(self.changed), self.damaged)

    @classmethod
    def restored(cls, state: SwitchesState) -> "Switches":
        """The switches that were saved."""
        switches = cls(state.initial_state)
        for switch in state.changed:
            switches.press(switch)
        switches.damaged = state.damaged
        return switches

    def press(self, switch: int) -> None:
        """The referee saw a switch change; raises `Refused`."""
        if not 1 <= switch <= self._count:
            raise Refused([f"there is no switch {switch}: they are numbered 1 to {self._count}"])
        if len(self.changed) >= MAX_CHANGES:
            raise Refused([f"more than {MAX_CHANGES} changes of switches are not counted"])
        self.changed.append(switch)
        self._on ^= {switch}

    def damage(self, damaged: int) -> None:
        """The referee says how many switches were damaged; raises `Refused`."""
        if not 0 <= damaged <= MAX_DAMAGED:
            raise Refused([f"the number of damaged switches is 0 to {MAX_DAMAGED}, not {damaged}"])
        self.damaged = damaged

    @property
    def on(self) -> Tuple[int, ...]:
        """The switches that are on now."""
        return tuple(sorted(self._on))
