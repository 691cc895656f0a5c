#!/usr/bin/python3
"""A loop that does the least that a box must do for robots in runs: what the core's load is compared with.

bare.py PUBLIC_PORT ROBOTS: it receives, decrypts and parses each datagram, and answers each robot once a second. It
checks nothing, keeps nothing, and always wants robots to execute.
"""

import asyncio
import socket
import sys
from typing import List

from addresses import BOX_HOST, BROADCAST

from roah_rsbb.comm import frame
from roah_rsbb.comm.ciphers import Cipher, Key
from roah_rsbb.comm.sockets import listen
from roah_rsbb.model.messages import Beacon, BenchmarkingRobot, DevicesState, TabletState
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.protocol import BoxState
from roah_rsbb.radio import wire_convert

PERIOD_S = 1.0


class Channel:
    """A robot's private channel."""

    def __init__(self, loop: asyncio.AbstractEventLoop, port: int, index: int) -> None:
        self.listed = BenchmarkingRobot(f"Team{index}", "Robot", port)
        self._key = Key(f"password {index}")
        self._socket = listen(BOX_HOST, port, shared=False)
        self._port = port
        self._host = ""
        self._answer = pb.BenchmarkState(benchmark_type="HWV", benchmark_state=int(BoxState.WAITING_RESULT))
        loop.add_reader(self._socket.fileno(), self._read)

    def _read(self) -> None:
        datagram, (self._host, _) = self._socket.recvfrom(65535)
        self._answer.acknowledgement.CopyFrom(frame.decode_private(datagram, self._key).time)

    def answer(self) -> None:
        """Acknowledge the last datagram."""
        if self._host:
            self._socket.sendto(frame.encode(self._answer, Cipher.AES_128_CBC, self._key), (self._host, self._port))


def main() -> None:
    """Run until the process is ended."""
    public_port, count = map(int, sys.argv[1:])
    loop = asyncio.new_event_loop()
    channels: List[Channel] = [Channel(loop, public_port + 1 + index, index) for index in range(count)]
    beacon = wire_convert.beacon_message(Beacon(
        tuple(channel.listed for channel in channels), DevicesState(), TabletState()))
    public = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    public.setsockopt(socket.SOL_SOCKET, socket.SO_BROADCAST, 1)

    def each_second() -> None:
        loop.call_later(PERIOD_S, each_second)
        public.sendto(frame.encode(beacon), (BROADCAST, public_port))

    def answer(channel: Channel) -> None:
        loop.call_later(PERIOD_S, answer, channel)
        channel.answer()

    loop.call_soon(each_second)
    for number, channel in enumerate(channels):
        loop.call_later(PERIOD_S * number / count, answer, channel)
    loop.run_forever()


if __name__ == "__main__":
    main()
