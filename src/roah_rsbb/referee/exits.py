"""How the terminal's referee ends."""

import enum


class Exit(enum.IntEnum):
    """Exit statuses; `referee --help` tells them to the user, scripts rely on them."""

    OK = 0
    REFUSED = 1
    USAGE = 2
    NO_CORE = 3
    NOT_COMPLETED = 4
    INTERRUPTED = 130


class NoCore(Exception):
    """There is no ROS master, or no core, or it does not answer; the text names the remedy."""
