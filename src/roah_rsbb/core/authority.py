"""Whether this box is in force. In a replay, and when another box has taken over, every command is refused."""

from roah_rsbb.core import effects
from roah_rsbb.core.copies import Copies
from roah_rsbb.core.effects import Level, Outbox
from roah_rsbb.core.watches import Watches
from roah_rsbb.model.reason import say

SUPERSEDED = say("This box is superseded: the box at {address} has taken over. Nothing is sent to robots, and commands "
                 "are refused. Use the panels of the other box")


class Authority:
    """Why the box takes no commands, if so."""

    def __init__(self, watches: Watches, copies: Copies, outbox: Outbox) -> None:
        self._watches = watches
        self._copies = copies
        self._outbox = outbox
        self.closed = ""
        """Why every command is refused, which is then the only warning; empty: none is."""
        self.is_superseded = False
        self.superseded_by = ""
        """Address of the box that took over."""

    def supersede(self, epoch: int, cut: int, by: str) -> None:
        """A standby took over, with this epoch: stop at once. `cut`: see `effects.Superseded`; `by`: its address."""
        if not self.is_superseded:
            self._outbox.emit(effects.Superseded(epoch, cut, by))
            self.stay_superseded(by)
            self._outbox.notice(Level.ERROR, self.closed)

    def stay_superseded(self, by: str) -> None:
        """A standby took over before the restart. Nothing is sent, and the runs stay as they were."""
        self.is_superseded, self.superseded_by = True, by
        self.closed = SUPERSEDED(address=by)
        self._watches.end_listening()
        self._copies.is_quiet = True
