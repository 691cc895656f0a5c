"""For tests on real loopback sockets: a loop, and functions that run it until a condition holds."""

import asyncio

import pytest

TIMEOUT_S = 60


class Running:
    """The loop, run by the test."""

    def __init__(self):
        self.loop = asyncio.new_event_loop()
        asyncio.set_event_loop(self.loop)  # tornado serves on the thread's loop

    def do(self, awaitable):
        """Run it to its end. Returns its result."""
        return self.loop.run_until_complete(asyncio.wait_for(awaitable, TIMEOUT_S))

    def until(self, condition):
        """Run until `condition()` holds."""
        async def hold():
            while not condition():
                await asyncio.sleep(0.002)
        self.do(hold())

    def turn(self):
        """Run everything that is waiting."""
        self.do(asyncio.sleep(0.02))

    def turn_once(self):
        """Run what is ready now."""
        self.do(asyncio.sleep(0))


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
