"""Support for tests on real loopback sockets: a loop, free ports, and inboxes."""

import asyncio

import pytest

from helpers.small_box import free_ports

TIMEOUT_S = 60


class Inbox(list):
    """Collects the arguments of a handler's calls, and lets a test wait for them."""

    def __init__(self, loop):
        super().__init__()
        self._loop = loop

    def __call__(self, *arguments):
        self.append(arguments if len(arguments) > 1 else arguments[0])

    def wait(self, count=1):
        """Run the loop until there are `count` items. Returns all of them."""
        self._loop.run_until_complete(asyncio.wait_for(self._until(count), TIMEOUT_S))
        return list(self)

    async def _until(self, count):
        while len(self) < count:
            await asyncio.sleep(0.001)


@pytest.fixture
def loop():
    loop = asyncio.new_event_loop()
    yield loop
    loop.close()


@pytest.fixture
def inbox(loop):
    """Make inboxes."""
    return lambda: Inbox(loop)


@pytest.fixture
def port():
    """A UDP port that nobody else uses."""
    return free_ports()


@pytest.fixture
def opened():
    """Open channels or peers, and close them after the test."""
    to_close = []

    def open_(endpoint):
        endpoint.open()
        to_close.append(endpoint)
        return endpoint

    yield open_
    for endpoint in to_close:
        endpoint.close()
