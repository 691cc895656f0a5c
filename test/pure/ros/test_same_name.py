"""A node that was replaced by one of the same name, and is still ending, does not end the new one."""

import os
import subprocess
import sys
import xmlrpc.client

import pytest

master_of_ros = pytest.importorskip("rosmaster.master")

NAME, NEW = "/twin", "http://127.0.0.1:1/"
# Shutting down takes as long as the test wants.
NODE = """
import rospy
from rospy.impl import masterslave
masterslave.ROSHandler._shutdown = lambda *_: None
from roah_rsbb.ros import connections
connections.init_node("twin")
print("is there", flush=True)
input()
rospy.logerr("a line while it ends")
print("has said it", flush=True)
input()
"""


@pytest.fixture
def master():
    """A master of ROS."""
    found = master_of_ros.Master(0)
    found.start()
    yield found
    found.stop()


@pytest.fixture
def node(master, tmp_path):
    """A node with this name."""
    environment = {**os.environ, "ROS_MASTER_URI": master.uri, "ROS_IP": "127.0.0.1", "ROS_LOG_DIR": str(tmp_path)}
    with subprocess.Popen([sys.executable, "-c", NODE], env=environment, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                          universal_newlines=True, bufsize=1) as process:
        yield process
        process.kill()


def registered(master):
    """Return the address of the node that the master knows by the name."""
    return xmlrpc.client.ServerProxy(master.uri).lookupNode("/test", NAME)[2]


def test_a_line_of_a_replaced_node_does_not_replace_its_successor(master, node):
    assert node.stdout.readline() == "is there\n"
    assert registered(master) != NEW
    xmlrpc.client.ServerProxy(master.uri).registerPublisher(NAME, "/rosout", "rosgraph_msgs/Log", NEW)
    node.stdin.write("\n")
    assert "has said it\n" in iter(node.stdout.readline, "")
    assert registered(master) == NEW
