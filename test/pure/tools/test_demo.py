"""The demonstration's ports: several demonstrations that start at the same moment."""

import socket

import pytest

from helpers import slots
from roah_rsbb.tools import demo


@pytest.mark.parametrize("kind, host", [
    (socket.SOCK_STREAM, demo.BOX_HOST), (socket.SOCK_DGRAM, demo.BROADCAST_HOST),
])
def test_a_port_that_was_chosen_is_not_chosen_again_before_it_is_used(kind, host, monkeypatch):
    marks = []
    monkeypatch.setattr(demo, "_MARKS", marks)
    with slots.free_slot() as slot:
        try:
            chosen = demo._free_port(kind, host, slots.first_port(slot), 1)
            assert demo._free_port(kind, host, chosen, 1) > chosen
        finally:
            for mark in marks:
                mark.close()
