"""Kinds of journal entries that are not topics of a run log (those are in `core/run_log.py`)."""

COMMAND = "command"  # a referee's command, also a refused one
NOTICE = "notice"  # a warning or an error that the referee saw
ADDRESS = "address"  # the address that a robot sends from
TIMEOUT = "timeout"  # the time of a run is up
