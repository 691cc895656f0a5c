"""Who did what: every command of a referee goes on record, also one that is refused."""

import abc
import contextlib
from typing import Dict, Iterator, List, NamedTuple, Optional

from roah_rsbb.core import effects
from roah_rsbb.core.effects import Effect
from roah_rsbb.core.refused import Refused
from roah_rsbb.core.runs.zone_run import ZoneRun
from roah_rsbb.core.zone import Zone

# Characters of a note or a reason; of a name.
MAX_NOTE = 500
MAX_WHO = 120


class RunName(NamedTuple):
    """Which run of a zone is meant."""

    zone: str
    identity: str = ""  # empty: the run that is connected in the zone


def one_line(text: str) -> str:
    """What somebody typed as one line of text that can be shown anywhere."""
    return " ".join("".join(c if c.isprintable() else " " for c in text).split())


def _short(value: object) -> object:
    """What of a command's argument goes on record: nobody fills the disk with a wrong name."""
    return value[:MAX_NOTE] if isinstance(value, str) else value


def checked_note(text: str) -> str:
    """A note or reason as one line; raises `Refused` if it is too long."""
    note = one_line(text)
    if len(note) > MAX_NOTE:
        raise Refused([f"the note has {len(note)} characters: at most {MAX_NOTE} are kept, shorten it"])
    return note


def cut_note(text: str) -> str:
    """A note or reason as one line, cut to what is kept."""
    return one_line(text)[:MAX_NOTE]


def checked_who(who: str) -> str:
    """A name as one line, cut to what is shown."""
    return one_line(who)[:MAX_WHO]


class RefereeRecord(abc.ABC):
    """A part of `roah_rsbb.core.box.Box`, which has the zones and the effects."""

    zones: Dict[str, Zone]
    _effects: List[Effect]

    @contextlib.contextmanager
    def _recording(self, name: RunName, who: str, command: str, **arguments: object) -> Iterator[None]:
        """Put a command on record before whatever it leads to, or with the reasons why it is refused."""
        value: Dict[str, object] = {"command": command, **{k: _short(v) for k, v in arguments.items() if v != ""}}
        zone = self.zones.get(name.zone)
        run = None if zone is None else zone.run
        place = len(self._effects)
        try:
            yield
        except Refused as refused:
            value["refused"] = [_short(reason) for reason in refused.reasons]
            raise
        finally:
            if run is None and zone is not None:
                run = zone.run  # connected just now
            identity = name.identity or ("" if run is None else run.identity)
            port = self._only_port(run, identity)
            self._effects.insert(place, effects.Recorded(
                _short(name.zone), _short(identity), port, "command", value, checked_who(who)
            ))

    @staticmethod
    def _only_port(run: Optional[ZoneRun], identity: str) -> Optional[int]:
        if run is None or run.identity != identity or len(run.members()) != 1:
            return None
        return run.members()[0].port
