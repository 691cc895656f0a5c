"""The UDP channels of the box: the public channel, and a private one for each run.

It makes no decisions. It turns datagrams into events of the box, and the box's messages into datagrams at the times of
`StateSender`.
"""

import asyncio
import functools
import os
from typing import Callable, Dict, Mapping, Optional, Set, Tuple

from roah_rsbb.comm import sockets
from roah_rsbb.comm.channels import MakePeer, Network, PrivateChannel, PublicChannel, Seen
from roah_rsbb.comm.ciphers import Cipher, Key
from roah_rsbb.comm.frame import encoded_size
from roah_rsbb.comm.sender import StateSender
from roah_rsbb.core.box import Box
from roah_rsbb.core.effects import How
from roah_rsbb.core.settings import Budget
from roah_rsbb.model.clock import Now
from roah_rsbb.model.messages import Beacon, BoxMessage, RobotReport
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.radio import wire_convert
from roah_rsbb.radio.short_way import ShortWay, Turns
from roah_rsbb.radio.wire_convert import ReportReader, Unread

Address = Tuple[str, int]
BEACON_PERIOD_S = 1.0
# Shortest interval of beacons, because devices and tablet may change at any rate.
BEACON_GAP_S = 0.05
# Limit of events per second for copies of datagrams; a real network causes fewer.
COPY_EVENTS = 100
# The system is asked again for the route to a host after this time (s). Most hosts that are remembered.
ROUTE_S, MAX_HOSTS = 2.0, 250


OnEvent = Callable[..., None]
OnReport = Callable[[Now, int, str, RobotReport, Optional[float]], Optional[BoxMessage]]


def beacon_size(beacon: Beacon) -> int:
    """The size of a beacon's datagram (bytes)."""
    return encoded_size(wire_convert.beacon_message(beacon), Cipher.NONE)


class _Private:
    """A private channel and the message that it repeats."""

    def __init__(self, channel: PrivateChannel, short_way: ShortWay, password: str) -> None:
        self.channel, self.password = channel, password
        self.short_way = short_way
        self.sender = StateSender(is_on_grid=True)
        self.message: Optional[BoxMessage] = None
        self.made: Optional[pb.BenchmarkState] = None  # of the message, once it was sent
        self.timer: Optional[asyncio.TimerHandle] = None
        self.settled_s = 0  # of the robot's time: a promise is renewed once a second, if nothing happens
        self.copies = 0  # of accepted datagrams; not passed to the box yet
        self.copy_events = Budget(COPY_EVENTS, COPY_EVENTS)


class CoreRadio:
    """The core's channels."""

    def __init__(
        self,
        loop: asyncio.AbstractEventLoop,
        network: Network,
        box: Box,
        turns: Turns,
        warn: Callable[[str], None],
        make_peer: Optional[MakePeer] = None,
        check: Callable[[], None] = lambda: None,
        random_bytes: Callable[[int], bytes] = os.urandom,
        seen: Optional[Seen] = None,
    ) -> None:
        """`turns` has the box's clocks. `warn` logs a text about a private channel.

        `make_peer` replaces `Peer`, for another network. `check` is called before each datagram: see `Fence.check`.
        `random_bytes`: see `Key`. `seen` remembers the datagrams of all channels (default: of a whole competition).
        """
        self._loop = loop
        self._turns = turns
        self._warn = warn
        self._make_peer = make_peer
        self._check = check
        self._random_bytes = random_bytes
        self._network = network
        self._keys: Dict[int, Dict[str, Key]] = {}  # by version of the configuration, then by team
        self._passwords: Dict[int, Mapping[str, str]] = {}  # in the same way
        self._box = box
        self._listening = True
        self._is_closed = False
        self._privates: Dict[int, _Private] = {}
        self.on_channels: Callable[[], object] = lambda: None
        """Called soon after channels were opened, aimed or closed."""
        self._are_noted = True
        self.awaited: Set[int] = set()
        """Ports of channels that are not open yet, because a record waits for the disk. No beacon names them."""
        self._routes: Dict[str, Tuple[float, bool]] = {}  # by host: until when it holds, and whether there is one
        self._seen = Seen() if seen is None else seen  # of all channels, for as long as the box runs
        self._beacon_timer: Optional[asyncio.TimerHandle] = None
        self._beacon_soon: Optional[asyncio.TimerHandle] = None
        self._last_beacon = float("-inf")
        self.public = PublicChannel(loop, network, self._on_public, self._on_complaint, make_peer=make_peer)

    def connect(self, event: OnEvent, report: OnReport) -> None:
        """Take the ways to the box, before anything is opened: see `Game.event` and `Game.report`."""
        self._event, self._report = event, report

    def use_passwords(self, version: int, passwords: Mapping[str, str]) -> None:
        """Set the teams' passwords of a version of the configuration."""
        self._passwords[version] = passwords
        self._keys[version] = {team: Key(password, self._random_bytes) for team, password in passwords.items()}

    def open(self, listen_duration: float) -> None:
        """Open the public channel; send beacons after `listen_duration` seconds of only listening.

        Raises OSError whose text names the remedy.
        """
        self.public.open()
        self._beacon_timer = self._loop.call_later(listen_duration, self._begin_to_send)

    def close(self) -> None:
        """Close all channels, for good."""
        self._is_closed = True
        for timer in (self._beacon_timer, self._beacon_soon):
            if timer is not None:
                timer.cancel()
        for port in list(self._privates):
            self.close_channel(port)
        self.public.close()
        self._turns.close()

    def unreadable(self) -> Dict[int, int]:
        """The number of unreadable datagrams so far by private port."""
        return {port: sum(private.channel.complaints.totals().values()) for port, private in self._privates.items()}

    def open_channels(self) -> Dict[int, Tuple[object, ...]]:
        """What is needed to stop the robots in runs, by private port: see `StoppedRobot`."""
        found: Dict[int, Tuple[object, ...]] = {}
        network = self._network
        for port, private in self._privates.items():
            run = self._box.zones.run_at(port)
            if run is not None:
                found[port] = (str(run.robot), private.password, private.channel.remote or "", run.message.benchmark,
                               network.rsbb_host, network.bind_host, int(network.cipher), network.broadcast,
                               network.max_datagram)
        return found

    # -- sending -------------------------------------------------------------------------------------

    def send_beacon(self) -> None:
        """Send a beacon immediately, in addition to regular ones, unless the box only listens, or is held.

        Shortly after another beacon, it is delayed until `BEACON_GAP_S` has passed, and then has the present state.
        """
        if self._listening or self._is_closed or self._box.watches.held_by or self._beacon_soon is not None:
            return
        gap_left = self._last_beacon + BEACON_GAP_S - self._loop.time()
        if gap_left > 0:
            self._beacon_soon = self._loop.call_later(gap_left, self._send_beacon_now)
        else:
            self._send_beacon_now()

    def _send_beacon_now(self) -> None:
        self._beacon_soon = None
        self._last_beacon = self._loop.time()
        beacon = self._box.beacon()
        if self.awaited:
            beacon = beacon._replace(robots=tuple(one for one in beacon.robots if one.port not in self.awaited))
        message = wire_convert.beacon_message(beacon)
        self._check()
        self.public.send(message)

    def open_channel(self, port: int, team: str, host: Optional[str], version: int) -> None:
        """Open a private channel with the team's key of a version; raises OSError whose text names the remedy."""
        self.awaited.discard(port)
        if self._is_closed:
            return
        key, reader = self._keys[version][team], ReportReader(self._turns.now_mono)
        short_way = ShortWay(self._turns, key, reader, self._box)
        channel = PrivateChannel(
            self._loop, self._network, port, key, functools.partial(self._on_private, port),
            lambda text: self._on_private_complaint(port, text), read=reader, seen=self._seen,
            on_copy=lambda address: self._on_copy(port, address[0]), make_peer=self._make_peer,
            on_datagram=short_way.take,
        )
        short_way.begin(channel)
        channel.open()
        channel.remote = host
        self._privates[port] = _Private(channel, short_way, self._passwords[version][team])
        self._changed()

    def aim(self, port: int, host: str) -> None:
        """Send to this host from now on."""
        private = self._privates.get(port)
        if private is not None:
            private.channel.remote = host
            self._changed()

    def _changed(self) -> None:
        """Have the channels noted, once for many at a time."""
        if self._are_noted:
            self._are_noted = False
            self._loop.call_soon(self._have_noted)

    def _have_noted(self) -> None:
        self._are_noted = True
        if not self._is_closed:  # a core that ends leaves its channels to the next one
            self.on_channels()

    def is_open(self, port: int) -> bool:
        """Whether there is a channel on this port."""
        return port in self._privates

    def sent(self, port: int) -> Optional[BoxMessage]:
        """Return the message that a channel sends; None: none."""
        private = self._privates.get(port)
        return None if private is None else private.message

    def send_state(self, port: int, message: BoxMessage, how: How) -> None:
        """Repeat this message from now on; `how` applies to the first time."""
        private = self._privates.get(port)
        if private is None:
            return  # its channel could not be opened: the box uses another port
        if how is How.CHANGE and message.repeats(private.message):
            # A repeated state needs no burst. A module begins with STOP again and then requests PREPARE at once: on the
            # network, that STOP could overtake PREPARE.
            how = How.QUIET
        if not message.repeats(private.message):
            private.made = None
        private.message = message
        if how is How.QUIET and private.timer is not None:
            return
        now = self._loop.time()
        if how is How.CHANGE:
            private.sender.changed(now)
        elif how is How.REPLY:
            private.sender.reply(now)
        self._send_due(private)

    def close_channel(self, port: int) -> None:
        """Close a private channel without a last message."""
        private = self._privates.pop(port, None)
        if private is None:
            return
        if private.timer is not None:
            private.timer.cancel()
        private.channel.close()
        self._changed()

    # -- time ---------------------------------------------------------------------------------------

    def _begin_to_send(self) -> None:
        self._listening = False
        self._beacon_tick()

    def _beacon_tick(self) -> None:
        self._beacon_timer = self._loop.call_later(BEACON_PERIOD_S, self._beacon_tick)
        self.send_beacon()

    def _send_due(self, private: _Private) -> None:
        self._turns.take()  # what is sent acknowledges all that came
        if private.timer is not None:
            private.timer.cancel()
        if private.sender.due(self._loop.time()) and private.message is not None:
            if private.made is None:
                private.made = wire_convert.state_message(private.message)
            wire_convert.acknowledge(private.made, private.message.acknowledgement)
            self._check()
            private.channel.send(private.made)
        private.timer = self._loop.call_at(private.sender.deadline, self._send_due, private)

    # -- receiving ----------------------------------------------------------------------------------

    def _on_public(self, message: object, address: Address) -> None:
        host = address[0]
        if isinstance(message, pb.RobotBeacon):
            time = wire_convert.time_of(message.time)
            self._event(self._box.arrivals.on_robot_beacon, host, message.team_name, message.robot_name, time,
                        self.public.received_utc, self._has_route(host))
        elif isinstance(message, pb.TabletBeacon):
            self._event(self._box.arrivals.on_tablet, host, wire_convert.tablet_of(message))
        elif isinstance(message, pb.RoahRsbbBeacon):
            self._event(self._box.arrivals.on_foreign_box, host)

    def _has_route(self, host: str) -> bool:
        """Whether this computer can send to a robot. What was found holds for a while."""
        now = self._loop.time()
        until, found = self._routes.get(host, (now, True))
        if now < until or self._network.broadcast or self._make_peer is not None:
            return found
        if len(self._routes) >= MAX_HOSTS:
            self._routes.clear()
        found = sockets.source_host(host) is not None
        self._routes[host] = now + ROUTE_S, found
        return found

    def _on_private(self, port: int, message: object, address: Address) -> None:
        if isinstance(message, RobotReport):
            private = self._privates.get(port)
            if private is None:
                return
            repeated = self._report(self._turns.now(), port, address[0], message, private.channel.received_utc)
            if repeated is not None:
                private.message = repeated
            run = self._box.zones.run_at(port)
            # Messages from another host do not count. If they counted here, a copy that overtakes the robot's own
            # datagram would exclude that datagram.
            if run is not None and run.link.host == address[0]:
                private.channel.remember()
                if repeated is None or message.time[0] != private.settled_s:
                    private.settled_s = message.time[0]
                    private.short_way.settle(run, message)
        elif isinstance(message, Unread):
            if message.count:
                self._event(self._box.arrivals.on_robot_overload, port, message.count)
        else:
            self._event(self._box.arrivals.on_foreign_box, address[0])

    def _on_copy(self, port: int, host: str) -> None:
        """Count each copy, but pass a flood of them to the box in few events."""
        private = self._privates.get(port)
        if private is None:
            return
        private.copies += 1
        if private.copy_events.take(self._loop.time(), 1):
            count, private.copies = private.copies, 0
            self._event(self._box.arrivals.on_robot_copy, port, host, count)

    def _on_complaint(self, text: str) -> None:
        self._event(self._box.arrivals.on_complaint, text)

    def _on_private_complaint(self, port: int, text: str) -> None:
        self._warn(text)
        self._event(self._box.arrivals.on_unreadable, port, text)
