"""A connection to a topic that is not shared with other listeners of the process, as those of rospy are."""

import struct
import time
from typing import Any, Optional

import rosgraph

from roah_rsbb.referee.ros_client import Connection, RosError, xml_rpc
from support.waiting import LIMIT_S

_CALLER = "/late_listener"
_SIZE = struct.Struct("<I")


class Listener:
    """A connection to the first publisher of a topic."""

    def __init__(self, topic: str, kind: Any) -> None:
        until = time.monotonic() + LIMIT_S
        master = rosgraph.get_master_uri()
        publishers = dict(xml_rpc(master, "getSystemState", [_CALLER], until)[0])[topic]
        node = xml_rpc(master, "lookupNode", [_CALLER, publishers[0]], until)
        _, host, port = xml_rpc(node, "requestTopic", [_CALLER, topic, [["TCPROS"]]], until)
        connection = Connection(host, port, until)
        connection.handshake({"callerid": _CALLER, "topic": topic, "md5sum": kind._md5sum, "type": kind._type,
                              "tcp_nodelay": "1"}, until)
        self._socket = connection.socket
        self._socket.setblocking(False)
        self._kind = kind
        self._buffer = bytearray()

    def fileno(self) -> int:
        """For `select`."""
        return self._socket.fileno()

    def close(self) -> None:
        """End the connection."""
        self._socket.close()

    def take(self) -> Any:
        """Return the newest message that has arrived, or None. Raises `RosError` when the publisher is gone."""
        is_gone = False
        while not is_gone:
            try:
                data = self._socket.recv(1 << 18)
            except BlockingIOError:
                break
            self._buffer += data
            is_gone = not data
        newest = self._newest()
        if newest is None and is_gone:
            raise RosError("the publisher has closed the connection")
        return None if newest is None else self._kind().deserialize(newest)

    def _newest(self) -> Optional[bytes]:
        found = None
        while len(self._buffer) >= _SIZE.size:
            end = _SIZE.size + _SIZE.unpack(self._buffer[:_SIZE.size])[0]
            if end > len(self._buffer):
                break
            found = bytes(self._buffer[_SIZE.size:end])
            del self._buffer[:end]
        return found
