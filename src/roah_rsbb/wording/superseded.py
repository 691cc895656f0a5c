"""How panels mark a box from which another one took over (docs/standby.md, "The old box")."""

from typing import Iterable

from roah_rsbb.wording.language import tr_later

PREFIX = "This box is superseded"  # of the core's warning
NOT_LIVE = tr_later("superseded: not live")
NO_COMMANDS = tr_later("Another box has taken over: commands have no effect here")


def is_superseded(warnings: Iterable[str]) -> bool:
    """Whether the box with these warnings is superseded."""
    return any(warning.startswith(PREFIX) for warning in warnings)
