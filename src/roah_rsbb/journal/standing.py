"""What a journal says about its box: its epoch, and whether another box took over (docs/standby.md, "How it works")."""

from typing import Any, NamedTuple

FIRST = 1

# Keys of an entry's value: a takeover has "epoch", the end of a superseded box "superseded_by".
_EPOCH, _SUPERSEDED_BY, _CUT, _BY = "epoch", "superseded_by", "cut", "by"


class BoxEpoch(NamedTuple):
    """What a journal says about its box."""

    epoch: int = FIRST
    superseded_by: int = 0  # the epoch of the box that took over from this one; 0: none
    cut: int = 0  # number of the last record that both journals have
    by: str = ""  # address of the box that took over

    @property
    def is_superseded(self) -> bool:
        """Whether another box took over from this one."""
        return self.superseded_by > 0

    @property
    def next_epoch(self) -> int:
        """The epoch of a box that takes over now."""
        return max(self.epoch, self.superseded_by) + 1


def takeover_value(epoch: int, cut: int) -> dict:
    """Return the value of the entry of a box that takes over."""
    return {_EPOCH: epoch, _CUT: cut}


def superseded_value(epoch: int, cut: int, by: str) -> dict:
    """Return the value of the entry of a box that was superseded."""
    return {_SUPERSEDED_BY: epoch, _CUT: cut, _BY: by}


def after(standing: BoxEpoch, value: Any) -> BoxEpoch:
    """Return what a journal says after the next entry of kind `epoch`."""
    try:
        epoch, superseded_by = int(value.get(_EPOCH, 0)), int(value.get(_SUPERSEDED_BY, 0))
        if epoch > max(standing.epoch, standing.superseded_by):
            return BoxEpoch(epoch, cut=int(value.get(_CUT, 0)))
        if superseded_by >= standing.epoch and superseded_by > standing.superseded_by:
            return standing._replace(superseded_by=superseded_by, cut=int(value.get(_CUT, 0)),
                                     by=str(value.get(_BY, "")))
    except (ValueError, TypeError, AttributeError):  # nobody writes this
        pass
    return standing
