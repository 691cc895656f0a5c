"""What the tests on real loopback sockets share: a loop, and ways to run it until something is so."""

import asyncio

import pytest

TIMEOUT_S = 10


class Running:
    """The loop, run by the test."""

    def __init__(self):
        self.loop = asyncio.new_event_loop()
        asyncio.set_event_loop(self.loop)  # tornado serves on the thread's loop

    def do(self, awaitable):
        """Run until it is done; what it gives."""
        return self.loop.run_until_complete(asyncio.wait_for(awaitable, TIMEOUT_S))

    def until(self, condition):
        """Run until `condition()` holds."""
        async def hold():
            while not condition():
                await asyncio.sleep(0.002)
        self.do(hold())

    def turn(self):
        """Let everything that waits have its turn."""
        self.do(asyncio.sleep(0.02))


@pytest.fixture
def running():
    made = Running()
    yield made
    made.turn()
    left = asyncio.all_tasks(made.loop)  # of clients whose server has gone
    for task in left:
        task.cancel()
    if left:
        made.loop.run_until_complete(asyncio.wait(left, timeout=TIMEOUT_S))
    asyncio.set_event_loop(None)
    made.loop.close()
