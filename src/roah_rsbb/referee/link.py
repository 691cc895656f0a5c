"""The terminal referee's link to the box: a client of its door (docs/door.md), whose answers are waited for.

A box or a master that does not answer must not stop the referee: all has a time limit, and errors name the remedy.
"""

import time
import uuid
from concurrent.futures import Future
from typing import Any, Dict, Optional, cast

from roah_rsbb.client.client import OLD_S, Answer, Client
from roah_rsbb.client.places import START, DoorPlaces
from roah_rsbb.ground.arguments import is_without_ros
from roah_rsbb.model.actions import MARK
from roah_rsbb.model.as_json import from_json
from roah_rsbb.model.document import Document
from roah_rsbb.model.reason import Refused
from roah_rsbb.model.results import JudgedRun, RunSheet
from roah_rsbb.model.scoring import Entered
from roah_rsbb.model.zone import SheetItem
from roah_rsbb.referee.at_once import ANSWER_S, ROLE, NoCore, caller_name
from roah_rsbb.wording.times import use_zone

# The limit for the document. A busy computer may take seconds.
CORE_S = 6.0
AGAIN_S = 0.2  # how often an attempt to connect is looked at
SILENT = "the box is silent: it hangs or has died (restart it), or its computer cannot be reached"


class NotConfirmed(Refused):
    """The command was carried out and counts, but is not on all disks. `reasons` say why."""


class Link(Client[Document]):
    """A box from afar. Call `start` and `open` first, and `close` at the end."""

    def __init__(self) -> None:
        super().__init__(Document, DoorPlaces(without_ros=is_without_ros()).find, face=ROLE)
        self.node = caller_name(ROLE)  # of this program, for the box's records
        self.referee = ""  # who acts, where a call names nobody
        self._seen = 0  # the news at the end of the last `next`
        self._last: Optional[Future[Answer]] = None  # the last call, which may have been interrupted

    def open(self, wait_s: float = 0.0) -> None:
        """Wait for the document. Raises `NoCore` when two attempts to connect have failed, because there may be two
        places; but after `wait_s` if master and core may still be starting."""
        deadline = self.here_s() + wait_s
        last = max(deadline, self.here_s() + CORE_S)
        while self.document is None or self.is_old:
            if self.here_s() >= (deadline if self.news > 1 and self.why else last):
                raise NoCore(self.trouble)
            self.next(AGAIN_S)
        use_zone(self.document.public.time_zone)

    @property
    def box(self) -> Document:
        """The newest document. The link must be open."""
        assert self.document is not None, "the link is open"
        use_zone(self.document.public.time_zone)
        return self.document

    @property
    def trouble(self) -> str:
        """Why the box does not answer, with the remedy."""
        why = (self.why if self.news else "") or SILENT
        return f"{why}; if it does not run, {START}" if "check that it runs" in why else why

    @staticmethod
    def here_s() -> float:
        """Monotonic seconds of this computer."""
        return time.monotonic()

    def next(self, limit_s: float) -> None:
        """Wait until something is new since the last time, or the document becomes old, but at most `limit_s`."""
        until_old_s = OLD_S - self.silence_s
        self._seen = self.wait_news(self._seen, limit_s if until_old_s < 0.0 else min(limit_s, until_old_s + 0.01))

    def settle(self) -> None:
        """Wait until the document shows the effect of every call so far; raises `NoCore`."""
        number = 0 if self._last is None else self._last.result().number
        try:
            self.wait(lambda _: self.is_confirmed(number), CORE_S)
        except TimeoutError:
            raise NoCore(self.trouble) from None

    def act(self, action: str, zone: str, given: Optional[Dict[str, Any]] = None, run: str = "",
            referee: str = "") -> None:
        """Do one of `model.actions.EVERY`; raises `Refused` with the core's reasons, or `NoCore`. `given`: the values
        of its fields; `run`: identity of the run that is meant, empty: whichever is there; `referee`: who does it."""
        self.request("act", action=action, zone=zone, run=run, given=given or {}, by=referee or self.referee)

    def stop_run(self, zone: str, identity: str) -> None:
        """Stop the run of that identity; raises as `act` does."""
        self._answered(self.stop(zone, identity, None, ANSWER_S, node=self.node, by=self.referee))

    def mark(self, zone: str, identity: str, item: SheetItem, entered: Entered, referee: str = "") -> None:
        """Mark an item in the run of that identity. The core applies the mark once, so it is sent again while the core
        does not answer, as while it restarts. Raises as `act` does."""
        mark = {"group": item.group, "desc": item.desc, **entered._asdict(), "role": ROLE, "id": str(uuid.uuid4())}
        self.request("act", again=True, action=MARK, zone=zone, run=identity, given=mark,
                      by=referee or self.referee)

    def reload(self, digest: str, referee: str, for_all: bool) -> Dict[str, Any]:
        """Check the configuration files, or apply what was listed with this digest; `for_all`: to the runs that are
        over, too. Raises as `act` does."""
        return cast(Dict[str, Any], self.request("reload", digest=digest, by=referee, for_all=for_all))

    def run_sheet(self, zone: str, identity: str, event: str = "") -> RunSheet:
        """Return a run's score sheet; an empty identity: of the connected run, or the empty one of the zone's event.
        `event`: id of one whose empty sheet is meant. Raises as `act` does."""
        return from_json(RunSheet, self.request("sheet", zone=zone, run=identity, event=event))

    def judging(self, zone: str, identity: str) -> JudgedRun:
        """Return what the head referee may see of a run; raises as `act` does."""
        return from_json(JudgedRun, self.request("judges", zone=zone, run=identity))

    def request(self, name: str, **arguments: Any) -> Any:
        """Make a call of the box (docs/door.md, "Calls") and return its answer; raises as `act` does."""
        return self._answered(self.call(name, None, ANSWER_S, node=self.node, **arguments))

    def _answered(self, call: "Future[Answer]") -> Any:
        self._last = call
        answer = call.result()
        if answer.reasons:
            raise (Refused if answer.is_known else NotConfirmed)(list(answer.reasons))
        if not answer.is_answered:
            raise NoCore(self.why or f"the box did not answer within {ANSWER_S:.0f} s: it hangs, restart it")
        return answer.answer
