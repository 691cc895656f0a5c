"""The state that the previous session of the core left in the journal."""

from typing import Any, Dict, List, NamedTuple, Optional, Tuple

from roah_rsbb.journal.contents import DAMAGED, Opened
from roah_rsbb.journal.file import CoreSession


class PreviousSession(NamedTuple):
    """Everything that a core needs to resume. Values are those of JSON."""

    states: Dict[str, Any]  # by name
    outcomes: Tuple[Any, ...]  # the records of all runs, including active ones; oldest first
    log_files: Dict[int, str]  # path of the run log by port
    ended_logs: Tuple[str, ...]  # those of the runs that are over
    last_port: Optional[int]  # the highest used private port
    last: Optional[CoreSession]  # the session that wrote the states, with the times of its last record


NOTHING = PreviousSession({}, (), {}, (), None, None)


def read_previous_session(opened: Opened) -> Tuple[PreviousSession, List[str]]:
    """Return the state before the new session, and what is damaged in it, in words. Raises OSError."""
    contents, found, problems = opened.contents, {}, []
    for run, outcome in opened.outcomes(contents.runs.values()):
        identity = run.row[0]
        found[identity] = outcome
        if outcome is DAMAGED:
            earlier = found[identity] = opened.earlier_outcome(identity)
            problems.append(f"the newest record of the run {identity} is damaged; "
                            f"{'there is no other' if earlier is None else 'an earlier one counts'}")
    ordered = sorted(contents.runs.values(), key=lambda run: run.row[-1])
    outcomes = [found[run.row[0]] for run in ordered if found[run.row[0]] is not None]
    members = [member for run in contents.runs.values() for member in run.members]
    last = None
    if contents.sessions:
        mono, utc = contents.last
        last = CoreSession(*contents.sessions[contents.stated - 1])._replace(mono=mono, utc=utc)
    previous = PreviousSession(
        states={name: state.state for name, state in contents.states.items() if state.state is not None},
        outcomes=tuple(outcomes), log_files={member[0]: member[4] for member in members if member[4]},
        ended_logs=tuple([member[4] for run in contents.runs.values() if run.closed is not None
                          for member in run.members if member[4]]),
        last_port=max(contents.run_of, default=None), last=last,
    )
    problems += [f"the state of {name} is damaged" for name, state in contents.states.items() if state.state is None]
    return previous, problems
