"""The ROS master that web pages cannot call."""

import http.client
import os
import pathlib
import socket
import subprocess
import sys
import xmlrpc.client

import pytest

from helpers.small_box import free_ports

pytest.importorskip("rosmaster")

PROGRAM = pathlib.Path(__file__).resolve().parents[3] / "scripts" / "protected_master"
# A node of the same name as a running one: an ordinary master ends that one then.
REGISTER = xmlrpc.client.dumps(("/roah_rsbb_core", "/core/stop", "rosrpc://10.0.0.66:1", "http://10.0.0.66:2/"),
                               "registerService").encode()


@pytest.fixture
def port(tmp_path):
    """The port of a protected master."""
    port = free_ports()
    environment = {
        **os.environ, "ROS_MASTER_URI": f"http://127.0.0.1:{port}", "ROS_IP": "127.0.0.1", "ROS_LOG_DIR": str(tmp_path),
        "PYTHONPATH": os.pathsep.join([str(PROGRAM.parents[1] / "src"), *sys.path]),
    }
    with subprocess.Popen([sys.executable, str(PROGRAM)], env=environment) as process:
        while process.poll() is None:
            try:
                socket.create_connection(("127.0.0.1", port)).close()
                break
            except ConnectionRefusedError:
                continue
        yield port
        process.terminate()


def status(port, **headers):
    """The status of a call that redirects /core/stop."""
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=30)
    connection.request("POST", "/", REGISTER, {name.replace("_", "-"): value for name, value in headers.items()})
    answer = connection.getresponse().status
    connection.close()
    return answer


def test_programs_are_served_and_web_pages_are_not(port):
    master = xmlrpc.client.ServerProxy(f"http://127.0.0.1:{port}/")
    assert status(port, Content_Type="text/plain", Origin="http://example.org") == 403
    assert status(port, Content_Type="text/plain") == 403
    assert master.lookupService("/me", "/core/stop")[0] != 1
    assert status(port, Content_Type="text/xml") == 200
    assert master.lookupService("/me", "/core/stop") == [1, "rosrpc URI: [rosrpc://10.0.0.66:1]", "rosrpc://10.0.0.66:1"]
