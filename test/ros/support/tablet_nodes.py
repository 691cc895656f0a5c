"""Support for the tests of the tablet: the address of its page, and a page whose box the test chooses."""

import asyncio
import concurrent.futures
import threading
from typing import Callable, Tuple

import rospy

from roah_rsbb.ground.installed import shipped_folder
from roah_rsbb.ground.params import KnownParams
from roah_rsbb.tablet.server import TabletPage
from support.robots import BROADCAST
from support.waiting import LIMIT_S, wait_until


def launched_url() -> str:
    """The address of the page that the launched core serves."""
    return wait_until(
        lambda: rospy.get_param("/roah_rsbb_web/tablet_url", None), "the core says where the tablet's page is"
    )


def served(rsbb_port: int) -> Tuple[str, Callable[[], object]]:
    """Serve the page for a box with this public port; returns its address, and what ends it."""
    loop, url = asyncio.new_event_loop(), concurrent.futures.Future()

    def serve() -> None:
        asyncio.set_event_loop(loop)  # tornado uses the thread's loop
        page = TabletPage(loop, KnownParams({"rsbb_host": BROADCAST, "rsbb_port": rsbb_port, "tablet_port": 0}),
                          str(shipped_folder().parent / "resource"), [], url.set_result)
        loop.call_soon(page.start)
        loop.run_forever()
        page.stop()

    thread = threading.Thread(target=serve, daemon=True)
    thread.start()
    return url.result(LIMIT_S), lambda: (loop.call_soon_threadsafe(loop.stop), thread.join(LIMIT_S))
