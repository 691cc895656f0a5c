"""Connections between nodes. rospy drops a message that is published before its subscriber is connected."""

import os
import signal
import xmlrpc.client

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

    def follows() -> bool:
        try:
            info = xmlrpc.client.ServerProxy(master().lookupNode(publisher)).getBusInfo(rospy.get_name())[2]
        except (OSError, rosgraph.MasterException, xmlrpc.client.Error):
            return False
        return any(entry[1] == follower and entry[2] == "o" and entry[4] == topic for entry in info)

    wait_until(follows, f"{publisher} sends {topic} to {follower}")
