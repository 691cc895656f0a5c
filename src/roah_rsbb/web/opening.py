"""What all parts of the gateway do to open their ports: retry, and name their addresses."""

import asyncio
import logging
from typing import Callable, List

from roah_rsbb.comm import sockets

RETRY_S = 3.0
LOOPBACK = "127.0.0.1"

_log = logging.getLogger(__name__)


def retry_until_open(loop: asyncio.AbstractEventLoop, open_it: Callable[[], None], reported: str = "") -> None:
    """Call `open_it` until it raises no OSError. Each problem is logged once, with its remedy."""
    try:
        open_it()
    except OSError as error:
        if str(error) != reported:
            _log.error("%s. Retrying every %.0f s", error, RETRY_S)
        loop.call_later(RETRY_S, retry_until_open, loop, open_it, str(error))


def hosts_of(host: str, rsbb_host: str) -> List[str]:
    """Return the addresses at which a port of `host` is reached: that in the robots' network first."""
    if host != sockets.ANY_HOST:
        return [host]
    network = sockets.source_host(rsbb_host)
    return [network, LOOPBACK] if network not in (None, LOOPBACK) else [LOOPBACK]
