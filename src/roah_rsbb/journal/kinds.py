"""Kinds of journal entries that are not topics of a run log (those are in `model/run_log.py`)."""

COMMAND = "command"  # a referee's command, even if refused
JUDGE_MARK = "judge_mark"  # a judge's mark on the judge's own sheet, which others must not see
JUDGING = "judging"  # a judge submits, or the head referee decides, even if refused
PUBLICATION = "publication"  # a provisional result, an objection or its answer, even if refused
RELOAD = "reload"  # an organiser changed the configuration
NOTICE = "notice"  # a warning or an error that the referee saw
ADDRESS = "address"  # a robot's address
TIMEOUT = "timeout"  # a run timed out
STATE = "state"  # of a zone with a run, with the times of the run: how it changed (`journal/changes.py`)
EPOCH = "epoch"  # a standby took over: here, or from the box of this journal (`journal/epochs.py`)
