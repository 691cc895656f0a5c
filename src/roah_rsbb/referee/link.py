"""The terminal referee's connection to the core: receives what the core publishes, and sends commands.

A master, a core or a service that does not answer must not stop the referee. Every connection has a time limit, and
the error names what does not answer, with the remedy.
"""

import os
import time
import uuid
from typing import Any, Dict, List, Optional, Sequence

from roah_rsbb.model.actions import MARK
from roah_rsbb.model.fields import given_text
from roah_rsbb.model.referee import Refused
from roah_rsbb.msg import (
    CoreDetails,
    CoreToGui,
    Judgings,
    PairedDevice,
    Results,
    RunClocks,
    RunSheet,
    Schedule,
)
from roah_rsbb.referee import ros_client
from roah_rsbb.referee.exits import NoCore
from roah_rsbb.referee.ros_client import Client, Late, RosError, ServiceError, Subscription
from roah_rsbb.referee.sheets import RunLine, run_of
from roah_rsbb.referee.state import BoxSnapshot, SheetItem, box_of
from roah_rsbb.referee.words import Entered
from roah_rsbb.ros import refusals
from roah_rsbb.srv import (
    Act,
    GetClock,
    GetJudging,
    GetJudgingResponse,
    GetRunSheet,
    PairDevice,
    PairDeviceResponse,
    PairedDevices,
    Reload,
    ReloadResponse,
    RevokeDevice,
    StopRun,
    TeamCodes,
    TeamCodesResponse,
)
from roah_rsbb.wording.device import NO_WEB
from roah_rsbb.wording.judging import Judging, judging_of

GUI_TOPIC, DETAILS_TOPIC, RESULTS_TOPIC = "/core/to_gui", "/core/details", "/core/results"
CLOCKS_TOPIC, SCHEDULE_TOPIC, JUDGING_TOPIC = "/core/clocks", "/core/schedule", "/core/judging"
_FOLLOWED = {GUI_TOPIC: CoreToGui, DETAILS_TOPIC: CoreDetails, CLOCKS_TOPIC: RunClocks}

# Time limits: for the master, for the core's first messages, for a service. A busy computer may take seconds, and a
# command such as stop must not fail because of that.
MASTER_S, CORE_S, ANSWER_S = 6.0, 6.0, 6.0
# For one attempt to stop. It is repeated, and a core that was busy may obey each of them.
TRY_S = 2.0
# For one attempt to connect to a topic.
CONNECT_S = 2.0
# A missing master or core is tried again after this time.
AGAIN_S = 0.2
# An older first message may be the latched one of a core that hangs: wait for a second one.
FRESH_S = 1.0
# Of the person at the terminal.
ROLE = "referee"
# Connect again to a silent core at this interval. After a power failure of its computer, nothing else finds it.
RENEW_S = 5.0
# The core publishes details at least every second. After this long without newer ones, something is wrong.
DETAILS_S = 10.0

NO_DETAILS = f"the core publishes {GUI_TOPIC}, but {DETAILS_TOPIC} or {CLOCKS_TOPIC} does not arrive: check the network"
# ROS's default, for a shell in which no setup file is sourced: the Debian package needs none.
MASTER_URI = "http://localhost:11311"
START = "start the box with 'roslaunch roah_rsbb roah_rsbb.launch'"


class Link:
    """One connection. Use it from one thread. Call `open` first and `close` at the end."""

    def __init__(self, ros_arguments: Sequence[str] = ()) -> None:
        """`ros_arguments`: words such as /from:=/to."""
        self._ros = Client(os.environ.get("ROS_MASTER_URI", MASTER_URI), ros_client.caller_name("referee"),
                           ros_client.remapped(ros_arguments))
        self._feeds: Dict[str, Subscription] = {}
        self._gui: Optional[CoreToGui] = None
        self._details: Optional[CoreDetails] = None
        self._clocks: Optional[RunClocks] = None
        self._heard = time.monotonic()
        self._tried = float("-inf")  # when connecting was last tried
        self._count = 0  # CoreToGui messages so far
        self.box: Optional[BoxSnapshot] = None

    def open(self, wait_s: float = 0.0) -> BoxSnapshot:
        """Connect; raises `NoCore` at once or after the time limits, or after `wait_s` if master and core may still be
        starting."""
        deadline = self.now() + wait_s
        while True:
            problem = self._problem()
            if not problem:
                break
            if self.now() + AGAIN_S > deadline:
                raise NoCore(problem)
            time.sleep(AGAIN_S)  # there is no event for the start of a master
        deadline = max(deadline, self.now() + CORE_S)
        while not self._is_current():
            left = deadline - self.now()
            if left <= 0:
                raise NoCore(self._why_silent())
            self.next(left)
        assert self.box is not None, "it is current"
        return self.box

    def close(self) -> None:
        """End all connections."""
        for feed in self._feeds.values():
            feed.close()
        self._feeds = {}

    # -- listening ----------------------------------------------------------------------------------

    @staticmethod
    def now() -> float:
        """Monotonic seconds."""
        return time.monotonic()

    @property
    def silence_s(self) -> float:
        """Seconds since the core's last message."""
        return self.now() - self._heard

    def next(self, limit_s: float) -> Optional[BoxSnapshot]:
        """Return the next snapshot; None if nothing came for `limit_s`."""
        deadline = self.now() + limit_s
        while True:
            self._connect()
            if self._take():
                return self.box
            left = deadline - self.now()
            if left <= 0:
                return None
            is_whole = len(self._feeds) == len(_FOLLOWED)
            ros_client.wait(list(self._feeds.values()), left if is_whole else min(left, AGAIN_S))

    def _connect(self) -> None:
        """Connect to the topics that are not connected. If the core is silent, connect to all of them again."""
        is_silent = self.silence_s > RENEW_S
        if ((len(self._feeds) == len(_FOLLOWED) and not is_silent)
                or self.now() - self._tried < (RENEW_S if is_silent else AGAIN_S)):
            return
        for topic, kind in _FOLLOWED.items():
            if topic in self._feeds and not is_silent:
                continue
            try:
                feed = self._ros.follow(topic, kind, CONNECT_S)
            except RosError:
                break  # the silence is reported; it is tried again
            self._drop(topic)
            self._feeds[topic] = feed
        self._tried = self.now()

    def _drop(self, topic: str) -> None:
        if topic in self._feeds:
            self._feeds.pop(topic).close()

    def _newest(self, topic: str) -> Any:
        """Return the newest message of a topic, or None."""
        if topic not in self._feeds:
            return None
        try:
            return self._feeds[topic].take()
        except RosError:
            self._drop(topic)
            return None

    def settle(self) -> BoxSnapshot:
        """A snapshot that shows the effect of every command so far; raises `NoCore` if none comes.

        Both topics of the snapshot must have been published after the last command. A message that was published
        before may arrive later than the command's answer, so the core's clock decides, not the order of arrival.
        """
        clock = self._call("/core/clock", GetClock).clock
        deadline = self.now() + DETAILS_S
        while not self.shows_after(clock):
            if self.next(min(CORE_S, max(0.0, deadline - self.now()))) is None:
                raise NoCore(NO_DETAILS if self.silence_s < CORE_S else self._why_silent())
        assert self.box is not None, "both topics were heard"
        return self.box

    def shows_after(self, clock: Any) -> bool:
        """Whether all of the snapshot was published after this time of the core's clock (see `try_clock`)."""
        return self._gui is not None and min(self._gui.clock, self._details.clock, self._clocks.clock) > clock

    def _take(self) -> bool:
        """Take new messages. Returns whether they gave a new snapshot."""
        gui, details, clocks = (self._newest(topic) for topic in (GUI_TOPIC, DETAILS_TOPIC, CLOCKS_TOPIC))
        # The same clock again is the latched message, which a core that may hang sends to each new connection.
        is_news = gui is not None and (self._gui is None or gui.clock != self._gui.clock)
        if is_news:
            self._gui, self._heard, self._count = gui, self.now(), self._count + 1
        if details is not None:
            self._details = details
        if clocks is not None:
            self._clocks = clocks
        if None in (self._gui, self._details, self._clocks) or not (is_news or details or clocks):
            return False
        if self._gui.clock < self._details.clock:
            return False  # the other topic's message of the same moment has not arrived yet
        box = box_of(self._gui, self._details, self._clocks)
        self.box = box or self.box
        return box is not None

    def _is_current(self) -> bool:
        if self.box is None:
            return False
        return self._count > 1 or abs(time.time() - self.box.clock_utc_s) < FRESH_S

    def _why_silent(self) -> str:
        problem = self._problem()
        if problem:
            return problem
        if self._gui is not None and None in (self._details, self._clocks):
            return NO_DETAILS
        return ("the core is known to the ROS master, but silent: it hangs or has died (restart it), or its "
                "computer cannot be reached by its name (set ROS_IP on both computers)")

    # -- commands -----------------------------------------------------------------------------------

    def act(
        self, action: str, zone: str, given: Optional[Dict[str, Any]] = None, run: str = "", referee: str = "",
    ) -> None:
        """Do one of `model.actions.EVERY`; raises `Refused` with the core's reasons, or `NoCore`.

        `given`: the values of its fields; `run`: the identity of the run that is meant, empty: whichever is there;
        `referee`: who does it.
        """
        self._call("/core/act", Act, action, zone, run, "", given_text(given or {}), referee)

    def stop_run(self, zone: str, identity: str) -> None:
        """Stop the run of that identity; raises as `act` does."""
        self._call("/core/stop_run", StopRun, zone, identity)

    def try_to_stop(self, zone: str) -> None:
        """Try once to stop the run in a zone, soon; raises as `act` does. The link need not be open."""
        self._call("/core/stop_run", StopRun, zone, "", soon=True)

    def try_clock(self) -> Any:
        """Return the core's clock, soon, for `shows_after`; raises as `act` does."""
        return self._call("/core/clock", GetClock, soon=True).clock

    def mark(
        self, zone: str, identity: str, item: SheetItem, entered: Optional[Entered], note: str = "", referee: str = ""
    ) -> None:
        """Mark an item in the run of that identity. Raises as `act` does.

        `entered`: None if the robot did not try. The core applies the mark once, so it is sent again while the core
        does not answer, for example while it restarts.
        """
        value = {"not_attempted": True} if entered is None else entered._asdict()
        mark = {"group": item.group, "desc": item.item, **value, "note": note, "role": ROLE, "id": str(uuid.uuid4())}
        deadline = self.now() + ANSWER_S
        while True:
            try:
                self.act(MARK, zone, mark, identity, referee)
                return
            except NoCore:
                if self.now() + AGAIN_S > deadline:
                    raise
                time.sleep(AGAIN_S)  # there is no event for the start of a core

    def reload(self, digest: str, referee: str) -> ReloadResponse:
        """Check the configuration files, or apply what was listed with this digest. Raises as `act` does."""
        return self._call("/core/reload", Reload, digest, referee)

    def run_sheet(self, zone: str, identity: str) -> RunSheet:
        """Return a run's score sheet; see `withdraw`."""
        return self._call("/core/run_sheet", GetRunSheet, zone, identity).sheet

    def runs(self) -> List[RunLine]:
        """Return all runs that the core knows; raises `NoCore`."""
        return [run_of(summary) for summary in self._latched(RESULTS_TOPIC, Results).runs]

    # -- several judges -----------------------------------------------------------------------------

    def judgings(self) -> List[Judging]:
        """Return the progress of the judges and results of all runs that are not signed off; raises `NoCore`."""
        return [judging_of(one) for one in self._latched(JUDGING_TOPIC, Judgings).runs]

    def judging(self, zone: str, identity: str) -> GetJudgingResponse:
        """Return what the head referee may see of a run; raises as `act` does."""
        return self._call("/core/judges", GetJudging, zone, identity, "")

    # -- the schedule -------------------------------------------------------------------------------

    def schedule(self) -> Schedule:
        """Return the schedule; raises `NoCore`."""
        return self._latched(SCHEDULE_TOPIC, Schedule)

    def _latched(self, topic: str, kind: type) -> Any:
        """Return the latched message of a topic; raises `NoCore`."""
        deadline = self.now() + CORE_S
        try:
            feed = self._ros.follow(topic, kind, CORE_S)
            try:
                while True:
                    message = feed.take()
                    if message is not None:
                        return message
                    if self.now() >= deadline:
                        raise Late("nothing is published")
                    ros_client.wait([feed], deadline - self.now())
            finally:
                feed.close()
        except RosError as error:
            raise NoCore(f"{topic} was not heard ({error}): {self._why_silent()}") from None

    # -- phones and tablets ---------------------------------------------------------------------------

    def pair(self, role: str, zone: str) -> PairDeviceResponse:
        """Return a code for a device; raises as `act` does."""
        return self._call("/web/pair", PairDevice, role, zone, why=NO_WEB)

    def devices(self) -> List[PairedDevice]:
        """Return the paired devices; raises as `act` does."""
        return self._call("/web/sessions", PairedDevices, why=NO_WEB).devices

    def revoke(self, device: str) -> int:
        """End the pairing of a device (empty: of all); returns how many. Raises as `act` does."""
        return self._call("/web/revoke", RevokeDevice, device, why=NO_WEB).revoked

    def team_codes(self, renew: bool) -> TeamCodesResponse:
        """Return the codes of the teams, after giving them new ones if `renew`; raises as `act` does."""
        return self._call("/web/team_codes", TeamCodes, renew, why=NO_WEB)

    def _call(self, name: str, kind: type, *request: object, why: str = "", soon: bool = False) -> Any:
        limit_s = TRY_S if soon else ANSWER_S
        try:
            return self._ros.call(name, kind, *request, limit_s=limit_s)
        except Late:
            remedy = why or "the core hangs, restart it"
            raise NoCore(f"{name} did not answer within {limit_s:.0f} s: {remedy}") from None
        except ServiceError as error:
            raise Refused(refusals.answered_reasons(str(error))) from None
        except RosError as error:
            why = why or (START if soon else self._why_silent())  # to find out why takes seconds
            raise NoCore(f"{name} could not be called ({error}): {why}") from None

    def _problem(self) -> str:
        """Return why there is no core; empty: the master knows one."""
        uri = self._ros.master_uri
        try:
            is_there = GUI_TOPIC in self._ros.published(MASTER_S)
        except RosError as error:
            why = str(error) if isinstance(error, Late) else f"cannot be reached ({error})"
            return f"ROS master at {uri} {why}: {START}, or set ROS_MASTER_URI to the box's computer"
        return "" if is_there else f"no core at the ROS master {uri}: {START}"
