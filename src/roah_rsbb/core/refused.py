"""A command that makes no sense now: it changes nothing and says why, with every reason."""

from typing import List


class Refused(Exception):
    """A referee's command was refused. `reasons` holds every reason, each with its remedy."""

    def __init__(self, reasons: List[str]) -> None:
        super().__init__("; ".join(reasons))
        self.reasons = reasons
