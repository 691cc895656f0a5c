"""The tablet's side of the public channel: TabletBeacons out, the box's beacons in."""

import asyncio
from typing import Callable, NamedTuple, Optional, Tuple

from roah_rsbb.comm.channels import MakePeer, Network, PublicChannel
from roah_rsbb.comm.sender import StateSender
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb

# -- the touches on the tablet ------------------------------------------------------------------------

# The box acknowledges a touch by repeating its time in the beacon. While the box is silent, touches are refused: a call
# must not reach a robot minutes later.

# Seconds and nanoseconds since 1970, UTC, as in the message `Time`.
WireTime = Tuple[int, int]
NEVER: WireTime = (0, 0)

# The box sends a beacon each second; after this time without one, it counts as silent.
BOX_SILENT_S = 3.5


class BoxPart(NamedTuple):
    """The tablet's part of the box's beacon."""

    display_map: bool
    call_time: WireTime
    position_time: WireTime


class ShownTablet:
    """The state of one tablet, which all its pages show."""

    def __init__(self) -> None:
        self.call_time = NEVER
        self.position_time = NEVER
        self.x = 0.0  # metres
        self.y = 0.0  # metres
        self._box: Optional[BoxPart] = None
        self._box_heard_mono = float("-inf")

    def call(self, time_ns: int) -> None:
        """The call button was touched; `time_ns`: UTC, nanoseconds since 1970."""
        self.call_time = divmod(time_ns, 1_000_000_000)

    def place(self, time_ns: int, x: float, y: float) -> None:
        """A position on the map was touched, in metres."""
        self.position_time = divmod(time_ns, 1_000_000_000)
        self.x, self.y = x, y

    def on_box(self, now_mono: float, said: BoxPart) -> bool:
        """A beacon of the box arrived; returns whether that changed the state."""
        changed = said != self._box or not self.hears_box(now_mono)
        self._box, self._box_heard_mono = said, now_mono
        return changed

    def hears_box(self, now_mono: float) -> bool:
        """Whether the box's beacons arrive."""
        return now_mono - self._box_heard_mono <= BOX_SILENT_S

    @property
    def display_map(self) -> bool:
        """The requested view: map (True) or call button (False)."""
        return self._box is not None and self._box.display_map

    @property
    def call_is_acknowledged(self) -> bool:
        """Whether the box has acknowledged the latest call."""
        return self._box is not None and self.call_time != NEVER and self._box.call_time == self.call_time

    @property
    def position_is_acknowledged(self) -> bool:
        """Whether the box has acknowledged the latest position."""
        return (self._box is not None and self.position_time != NEVER
                and self._box.position_time == self.position_time)


# -- the public channel -------------------------------------------------------------------------------

class TabletRadio:
    """Sends the state of a tablet while it is `present`: every second, and immediately after changes.

    It uses the mode `apart` of `comm.peer.Peer`: the box may run on this machine, and would ignore datagrams from its
    own address and port.
    """

    def __init__(
        self,
        loop: asyncio.AbstractEventLoop,
        state: ShownTablet,
        on_box: Callable[[bool], None],
        on_complaint: Callable[[str], None],
        network: Network,
        make_peer: Optional[MakePeer] = None,
    ) -> None:
        """Opens nothing yet. `on_box(changed)` is called for each beacon of the box. `make_peer`: see
        `PublicChannel`."""
        self._loop = loop
        self._state = state
        self._on_box = on_box
        self._sender = StateSender()
        self._present = False
        self._timer: Optional[asyncio.TimerHandle] = None
        self._channel = PublicChannel(loop, network, self._on_message, on_complaint, apart=True, make_peer=make_peer)

    def open(self) -> None:
        """Start to listen, and to send if present. Raises OSError whose text names the remedy."""
        self._channel.open()
        self.changed()

    def close(self) -> None:
        """Stop listening and sending."""
        if self._timer is not None:
            self._timer.cancel()
        self._channel.close()

    @property
    def present(self) -> bool:
        """Whether there is a tablet. Without one, nothing is sent, and the referee sees that it is silent."""
        return self._present

    @present.setter
    def present(self, present: bool) -> None:
        if present and not self._present:
            self._present = True
            self.changed()
        self._present = present

    def changed(self) -> None:
        """Something was touched: send it immediately, and repeat it a few times in case of loss."""
        self._sender.changed(self._loop.time())
        self._send_due()

    def _send_due(self) -> None:
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None
        if not self._channel.is_open:
            return
        if self._sender.due(self._loop.time()) and self._present:
            self._channel.send(_beacon(self._state))
        self._timer = self._loop.call_at(self._sender.deadline, self._send_due)

    def _on_message(self, message: object, _address: Tuple[str, int]) -> None:
        if isinstance(message, pb.RoahRsbbBeacon):
            said = BoxPart(
                message.tablet_display_map,
                (message.tablet_call_time.sec, message.tablet_call_time.nsec),
                (message.tablet_position_time.sec, message.tablet_position_time.nsec),
            )
            self._on_box(self._state.on_box(self._loop.time(), said))


def _beacon(state: ShownTablet) -> pb.TabletBeacon:
    call, place = state.call_time, state.position_time
    return pb.TabletBeacon(
        last_call=pb.Time(sec=call[0], nsec=call[1]), last_pos=pb.Time(sec=place[0], nsec=place[1]),
        x=state.x, y=state.y,
    )
