"""A client that was written from docs/protocol.md alone completes runs."""

import asyncio
import threading

import pytest

from helpers.page_client import PageClient
from helpers.small_box import BROADCAST, NAME, PASSWORD, ROBOT, TEAM, SmallBox
from roah_rsbb.protocol import RobotState


def with_client(box, body):
    """Run `body()` with a box and a client in a thread on its network."""
    async def together():
        client = PageClient(TEAM, NAME, PASSWORD, ROBOT, BROADCAST, box.port)
        thread = threading.Thread(target=client.run)
        thread.start()
        try:
            async with box:
                await body()
        finally:
            client.end()
            thread.join()
        return client
    return asyncio.run(together())


@pytest.mark.parametrize("code, goals, heard", [
    ("HGTKMH", [{}], [None]),
    ("STB", [{"generic_goal": "one"}, {"generic_goal": "two"}, {"generic_goal": "three"}], ["one", "two", "three"]),
])
def test_it_completes_a_run(code, goals, heard):
    box = SmallBox(code, goals)

    async def body():
        box.listed = False
        await box.until(lambda: box.beacons)
        box.listed = True
        await box.run_through()

    client = with_client(box, body)
    assert client.goals == heard
    assert [message.generic_result for message in box.finished] == [f"result of {goal}" for goal in heard]
    assert box.logged["notifications"] == [f"goal {number + 1}" for number in range(len(heard))]


class _HeldBox(SmallBox):
    """Does not continue by itself while it is held."""

    held = True

    def _step(self, *arguments):
        if not self.held:
            super()._step(*arguments)


def test_it_is_stopped_started_again_and_dismissed():
    box = _HeldBox()

    async def body():
        await box.until(lambda: box.received)
        box.start()
        await box.until(lambda: box.robot_state is RobotState.WAITING_GOAL)
        box.stop()
        await box.until(lambda: box.robot_state is RobotState.STOP)
        box.held = False
        await box.run_through()
        box.listed = False
        count = len(box.beacons)
        await box.until(lambda: len(box.beacons) > count)

    with_client(box, body)
    assert len(box.finished) == 1
