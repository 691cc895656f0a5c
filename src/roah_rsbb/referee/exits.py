"""How the terminal referee ends."""

import enum


class Exit(enum.IntEnum):
    """Exit statuses. `referee --help` lists them, and scripts rely on them."""

    OK = 0
    REFUSED = 1
    USAGE = 2
    NO_CORE = 3
    NOT_COMPLETED = 4
    INTERRUPTED = 130


class NoCore(Exception):
    """The ROS master or the core is missing or does not answer. The text names the remedy."""
