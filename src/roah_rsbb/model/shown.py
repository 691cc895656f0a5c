"""What faces show of the actions in a zone: why a button is off, whether it is shown, its fields as they are now."""

from typing import NamedTuple, Optional, Tuple

from roah_rsbb.model.fields import Field
from roah_rsbb.model.reason import Said


class Shown(NamedTuple):
    """An action in a zone."""

    off: Tuple[Said, ...] = ()  # the reasons why its button is off; empty: it is on
    shown: bool = True  # whether faces show it beside what they lay out themselves
    fields: Optional[Tuple[Field, ...]] = None  # as they are now; None: as in `ACTIONS`
    text: str = ""  # what the referee should do, in the words of a module; empty: the action's explanation says it
    question: Said = ""  # asked before it is done, which then gives `Confirmed`; empty: nothing but the action's own
