"""A connection to a topic that is not shared with other listeners of the process, as those of rospy are."""

import io
import socket
import struct
import xmlrpc.client
from typing import Any, Optional

import rosgraph
import rosgraph.network

from support.waiting import LIMIT_S

_CALLER = "/late_listener"
_SIZE = struct.Struct("<I")


class Listener:
    """A connection to the first publisher of a topic."""

    def __init__(self, topic: str, kind: Any) -> None:
        master = rosgraph.Master(_CALLER)
        publisher = dict(master.getSystemState()[0])[topic][0]
        _, _, (_, host, port) = xmlrpc.client.ServerProxy(master.lookupNode(publisher)).requestTopic(
            _CALLER, topic, [["TCPROS"]])
        self._socket = socket.create_connection((host, port), LIMIT_S)
        rosgraph.network.write_ros_handshake_header(self._socket, {
            "callerid": _CALLER, "topic": topic, "md5sum": kind._md5sum, "type": kind._type, "tcp_nodelay": "1"})
        rest = io.BytesIO()  # what comes with the header
        rosgraph.network.read_ros_handshake_header(self._socket, rest, 1 << 16)
        self._socket.setblocking(False)
        self._kind = kind
        self._buffer = bytearray(rest.getvalue())

    def fileno(self) -> int:
        """For `select`."""
        return self._socket.fileno()

    def close(self) -> None:
        """End the connection."""
        self._socket.close()

    def take(self) -> Any:
        """Return the newest message that has arrived, or None. Raises ConnectionError when the publisher is gone."""
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
            raise ConnectionError("the publisher has closed the connection")
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
