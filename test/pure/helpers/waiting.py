"""For tests that wait until something happens elsewhere: in another thread or process, or in the loop."""

import asyncio
import time

LIMIT_S = 60.0


def wait_until(condition, what=""):
    """Wait for another thread or process. `what`: in words."""
    limit = time.monotonic() + LIMIT_S
    while not condition():
        assert time.monotonic() < limit, what or condition
        time.sleep(0.01)


class News(asyncio.Event):
    """Is set when something has happened."""

    async def until(self, condition, what=lambda: ""):
        """Wait in the loop until `condition()` holds. It is checked with each news. `what`: returns it in words."""
        async def hold():
            while not condition():
                self.clear()
                await self.wait()
        try:
            await asyncio.wait_for(hold(), LIMIT_S)
        except asyncio.TimeoutError:
            raise AssertionError(f"not: {what()}") from None
