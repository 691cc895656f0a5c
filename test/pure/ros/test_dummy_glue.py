"""The dummy robot's calls of the comm node's services."""

import asyncio
import threading

import pytest

rospy = pytest.importorskip("rospy")
dummy_glue = pytest.importorskip("roah_rsbb.ros.team.dummy_glue")

TIMEOUT_S = 60.0


class CommNode:
    """Its services; those in `missing` are not there."""

    def __init__(self):
        self.missing = set()
        self.waiting = threading.Event()  # for a service that is missing
        self.called = []

    def wait_for_service(self, name, timeout):
        if name in self.missing:
            self.waiting.set()
            raise rospy.ROSException(f"{name} is not available")

    def proxy(self, name, kind):
        return lambda *arguments: self.called.append(name)


@pytest.fixture
def comm_node(monkeypatch):
    comm_node = CommNode()
    monkeypatch.setattr(rospy, "Publisher", lambda *_, **__: None)
    monkeypatch.setattr(rospy, "wait_for_service", comm_node.wait_for_service)
    monkeypatch.setattr(rospy, "ServiceProxy", comm_node.proxy)
    return comm_node


def test_a_cancelled_call_does_not_delay_the_next_one(comm_node, monkeypatch):
    """The comm node was killed while the robot executed: it comes back and wants the robot to prepare."""
    monkeypatch.setattr(dummy_glue, "SERVICE_S", 10 * TIMEOUT_S)
    comm_node.missing.add("/roah_rsbb/end_execute")

    async def killed_and_back():
        loop = asyncio.get_event_loop()
        services = dummy_glue.Services(loop)
        call = loop.create_task(services.call("end_execute", None))
        await loop.run_in_executor(None, comm_node.waiting.wait, TIMEOUT_S)
        call.cancel()
        await asyncio.wait_for(services.call("end_prepare", None), TIMEOUT_S)

    asyncio.new_event_loop().run_until_complete(killed_and_back())
    assert comm_node.called == ["/roah_rsbb/end_prepare"]


def test_a_service_that_stays_away_is_an_error(comm_node, monkeypatch):
    monkeypatch.setattr(dummy_glue, "SERVICE_S", 0.0)
    comm_node.missing.add("/roah_rsbb/end_execute")
    loop = asyncio.new_event_loop()
    with pytest.raises(rospy.ROSException, match="not available"):
        loop.run_until_complete(dummy_glue.Services(loop).call("end_execute", None))
