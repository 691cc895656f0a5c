"""Whether a node publishes to a subscriber. The publishing node knows.

A message that a node publishes before it has a subscriber's connection is lost, unless its topic is latched. On the
subscriber's side, rospy counts a connection before it is made.
"""

import contextlib
import xmlrpc.client
from typing import List, Set

import rosgraph
import rospy

_TO, _DIRECTION, _TOPIC, _INFO = 1, 2, 4, 6  # of an entry of getBusInfo


def publishes_to(node: str, topic: str, subscriber: str) -> bool:
    """Whether `node` has a connection of the node `subscriber` to a topic."""
    return any(entry[_TO] == subscriber for entry in _outgoing(node, topic))


def is_connected(subscriber: rospy.Subscriber, node: str) -> bool:
    """Whether `node` has the connection of this subscriber, and not one from before."""
    ports = _ports(subscriber)
    return any(f":{port} on socket" in entry[_INFO] for entry in _outgoing(node, subscriber.name) for port in ports)


def _ports(subscriber: rospy.Subscriber) -> Set[int]:
    found = set()
    for connection in subscriber.impl.connections:
        with contextlib.suppress(AttributeError, OSError):  # it is not made yet, or has ended
            found.add(connection.socket.getsockname()[1])
    return found


def _outgoing(node: str, topic: str) -> List[list]:
    name = rospy.get_name()
    address = rosgraph.Master(name).lookupNode(node)
    try:
        entries = xmlrpc.client.ServerProxy(address).getBusInfo(name)[2]
    except xmlrpc.client.Fault:  # rospy cannot describe a connection that is being made
        return []
    return [entry for entry in entries if (entry[_DIRECTION], entry[_TOPIC]) == ("o", topic)]
