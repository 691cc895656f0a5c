"""The record of what persons do, refusals included, for the journal."""

import contextlib
from typing import Dict, Iterator, List, Optional

from roah_rsbb.core import effects
from roah_rsbb.core.effects import Outbox
from roah_rsbb.core.runs.run import ZoneRun
from roah_rsbb.core.zones import Zones
from roah_rsbb.model.reason import MAX_NOTE, Refused, RunName, checked_who


class CommandRecord:
    """Records every command of a referee, including refused ones."""

    def __init__(self, zones: Zones, outbox: Outbox, kind: str = "command") -> None:
        """`kind`: of the journal's entries."""
        self._zones = zones
        self._outbox = outbox
        self._kind = kind
        self._closed: List[str] = []  # see `close`; shared by all kinds

    def of_kind(self, kind: str) -> "CommandRecord":
        """Return a record for another kind of entries, which is closed when this one is."""
        made = CommandRecord(self._zones, self._outbox, kind)
        made._closed = self._closed
        return made

    @property
    def closed(self) -> str:
        """Why every command is refused; empty: it is not."""
        return self._closed[0] if self._closed else ""

    def close(self, reason: str) -> None:
        """Refuse every command from now on, for this reason."""
        self._closed[:] = [reason]

    @contextlib.contextmanager
    def of(self, name: RunName, who: str, command: str, /, **arguments: object) -> Iterator[None]:
        """Record a command before its effects, or with the reasons why it is refused."""
        value: Dict[str, object] = {
            **{k: _short(v) for k, v in arguments.items() if v != ""}, "command": command}
        zone = self._zones.get(name.zone)
        run = None if zone is None else zone.run
        place = self._outbox.place()
        try:
            if self.closed:
                raise Refused([self.closed])
            yield
        except Refused as refused:
            value["refused"] = [_short(reason) for reason in refused.reasons]
            raise
        finally:
            if run is None and zone is not None:
                run = zone.run  # connected just now
            identity = name.identity or ("" if run is None else run.identity)
            port = _only_port(run, identity)
            self._outbox.insert(place, effects.Recorded(
                name.zone[:MAX_NOTE], identity[:MAX_NOTE], port, self._kind, value, checked_who(who)
            ))


def _short(value: object) -> object:
    """Shorten a text that is recorded: a wrong name must not fill the disk."""
    return value[:MAX_NOTE] if isinstance(value, str) else value


def _only_port(run: Optional[ZoneRun], identity: str) -> Optional[int]:
    if run is None or run.identity != identity or len(run.members()) != 1:
        return None
    return run.members()[0].port
