"""The core's end of the pair, in its loop, which must never wait."""

import asyncio
import contextlib
import socket

from roah_rsbb.comm.peer import Peer
from roah_rsbb.nodes.core.fence import Fence
from roah_rsbb.standby.partners import PairedStandby, write_standby

OWN, STANDBY = "127.0.0.1", "127.0.0.3"


def test_no_name_is_looked_up_for_a_word(tmp_path, monkeypatch):
    """rsbb_host may be a name, which is looked up once."""
    sent = []
    monkeypatch.setattr(Peer, "send", lambda _self, _datagram, host: sent.append(host))
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
        free.bind((OWN, 0))
        port = free.getsockname()[1]
    write_standby(str(tmp_path), PairedStandby("laptop", "00", STANDBY, port))
    with contextlib.closing(asyncio.new_event_loop()) as loop:
        fence = Fence(loop, str(tmp_path), str(tmp_path / "journal"), "localhost", OWN, port, lambda *_: None, None)
        fence.open()
        loop.run_until_complete(fence.ask())
        fence.close()
    assert set(sent) == {OWN, STANDBY}
