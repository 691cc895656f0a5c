"""Calls of services at the address that an earlier call found, which end in any case.

rospy asks the ROS master for the address of a service at each call. This takes 2 ms, and often 10 ms on a busy machine,
while a robot waits for the referee's command. If the master or the node hangs, it waits for ever.
"""

import socket
import xmlrpc.client
from typing import Any, Dict

import rosgraph
import rospy
from rospy.exceptions import TransportInitError
from rospy.impl.tcpros_base import TCPROSTransport

# Limit (s) of each step of a call: the question to the master, the connection, the answer.
STEP_S = 5.0


class _TimedSocket(socket.socket):
    """A socket on which rospy cannot wait for ever: rospy removes other limits of time."""

    def setblocking(self, _flag: bool) -> None:
        self.settimeout(STEP_S)


class _TimedTransport(TCPROSTransport):
    """A connection to a service."""

    def write_header(self) -> None:
        self.socket = _TimedSocket(fileno=self.socket.detach())
        super().write_header()


class _TimedQuestion(xmlrpc.client.Transport):
    """A connection to the master."""

    def make_connection(self, host: Any) -> Any:
        connection = super().make_connection(host)
        connection.timeout = STEP_S
        return connection


class KnownService(rospy.ServiceProxy):
    """A `rospy.ServiceProxy` that asks the master only if the service does not answer at its known address."""

    # By the service's name: the address at which it answered last. While a call waits there, it is not known: a node
    # that hangs may have been replaced by another one, and the next call must find that.
    _addresses: Dict[str, str] = {}
    # The same, also while a call waits there: for a master that is gone.
    _last: Dict[str, str] = {}

    def learn(self) -> None:
        """Ask the master now, so that a later call does not depend on it; raises rospy.ServiceException."""
        address = self._ask_master()
        self._addresses[self.resolved_name] = self._last[self.resolved_name] = address

    def call(self, *args: Any, **fields: Any) -> Any:
        """Call the service; raises rospy.ServiceException."""
        known = self._addresses.pop(self.resolved_name, None)
        try:
            address = known or self._find()
            try:
                self.transport = self._connect(address)
            except TransportInitError:  # nothing was sent. The service's node was probably restarted
                address = self._find()
                if known in (None, address):
                    raise
                self.transport = self._connect(address)
        except TransportInitError as error:
            raise rospy.ServiceException(f"unable to connect to service: {error}") from error
        answer = super().call(*args, **fields)
        self._addresses[self.resolved_name] = self._last[self.resolved_name] = address
        return answer

    def _find(self) -> str:
        """Return the address that the master knows. If it knows none, or is gone, the node may still be there."""
        try:
            return self._ask_master()
        except rospy.ServiceException:
            if self.resolved_name not in self._last:
                raise
            return self._last[self.resolved_name]

    def _ask_master(self) -> str:
        master = xmlrpc.client.ServerProxy(rosgraph.get_master_uri(), transport=_TimedQuestion())
        try:
            code, _, address = master.lookupService(rospy.get_name(), self.resolved_name)
        except (OSError, xmlrpc.client.Error) as error:
            raise rospy.ServiceException(f"unable to contact master: {error}") from error
        if code != 1:
            raise rospy.ServiceException(f"service [{self.resolved_name}] unavailable")
        return address

    def _connect(self, address: str) -> TCPROSTransport:
        """Connect; raises TransportInitError."""
        transport = _TimedTransport(self.protocol, self.resolved_name)
        transport.buff_size = self.buff_size
        host, port = rospy.core.parse_rosrpc_uri(address)
        try:
            transport.connect(host, port, address, timeout=STEP_S)
        except TransportInitError:
            transport.close()
            raise
        return transport
