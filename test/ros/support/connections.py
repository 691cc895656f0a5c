"""Connections between nodes. rospy drops a message that is published before its subscriber is connected."""

import contextlib
import os
import signal
import xmlrpc.client
from typing import List, Set

import rosgraph
import rospy

from support.waiting import wait_until


def master() -> rosgraph.Master:
    """The master, called by this node."""
    return rosgraph.Master(rospy.get_name())


def process_of(node: str) -> int:
    """The process of a node; 0: there is none that answers."""
    try:
        return xmlrpc.client.ServerProxy(master().lookupNode(node)).getPid(rospy.get_name())[2]
    except (OSError, rosgraph.MasterException, xmlrpc.client.Error):
        return 0


def kill(node: str, number: signal.Signals = signal.SIGKILL) -> None:
    """Send a signal to the process of a node."""
    os.kill(wait_until(lambda: process_of(node), f"{node} answers"), number)


def wait_follows(publisher: str, topic: str, subscriber: str = "") -> None:
    """Wait until the node `publisher` sends its messages on a topic to the node `subscriber`, or to this one."""
    follower = subscriber or rospy.get_name()
    wait_until(lambda: any(entry[_TO] == follower for entry in _followers(publisher, topic)),
               f"{publisher} sends {topic} to {follower}")


def wait_sends(publisher: str, subscriber: rospy.Subscriber) -> None:
    """Wait until the node `publisher` sends its messages to this subscriber of this node.

    It may still have the connection of an earlier subscriber, and rospy counts one that is not made yet.
    """
    wait_until(lambda: any(f":{port} on socket" in entry[_HOW] for port in _ports(subscriber)
                           for entry in _followers(publisher, subscriber.name)),
               f"{publisher} sends {subscriber.name} to this subscriber")


# The parts of an entry of getBusInfo.
_TO, _DIRECTION, _TOPIC, _HOW = 1, 2, 4, 6


def _followers(publisher: str, topic: str) -> List[list]:
    """The connections over which a node sends its messages on a topic; none if it does not answer."""
    try:
        info = xmlrpc.client.ServerProxy(master().lookupNode(publisher)).getBusInfo(rospy.get_name())[2]
    except (OSError, rosgraph.MasterException, xmlrpc.client.Error):
        return []
    return [entry for entry in info if (entry[_DIRECTION], entry[_TOPIC]) == ("o", topic)]


def _ports(subscriber: rospy.Subscriber) -> Set[int]:
    found = set()
    for connection in subscriber.impl.connections:
        with contextlib.suppress(AttributeError, OSError):  # it is not made yet, or has ended
            found.add(connection.socket.getsockname()[1])
    return found
