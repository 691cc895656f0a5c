"""Ranges of UDP ports for tests, so that several runs on one machine do not disturb each other.

A slot is a hundred ports, and an address for ROS. Whoever uses a slot holds its last port.
"""

import contextlib
import errno
import socket
from typing import Iterator

# The ports end at 32099. Linux assigns ports from 32768 on by itself.
SLOTS = range(1, 121)
FIRST_PORT, PORTS_OF_A_SLOT = 20000, 100


def first_port(slot: int) -> int:
    """The first port of a slot."""
    return FIRST_PORT + PORTS_OF_A_SLOT * slot


def ros_address(slot: int) -> str:
    """The address of a slot's ROS master and nodes.

    A master still calls nodes that were killed: it asks the programs that have their ports now to shut down, or to
    follow its own nodes. With an address for each slot, these are no programs of other tests.
    """
    return f"127.77.0.{slot}"


def is_free(port: int) -> bool:
    """Whether no program on this machine uses a UDP port, at whatever address."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        return _is_bound(probe, "", port)


def _is_bound(endpoint: socket.socket, host: str, port: int) -> bool:
    try:
        endpoint.bind((host, port))
    except OSError as error:
        if error.errno != errno.EADDRINUSE:
            raise
        return False
    return True


@contextlib.contextmanager
def free_slot() -> Iterator[int]:
    """Reserve a slot that no other test run on this machine uses, and whose first port no other program has."""
    for slot in SLOTS:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as holder:
            if _is_bound(holder, "127.0.0.1", first_port(slot + 1) - 1) and is_free(first_port(slot)):
                yield slot
                return
    raise RuntimeError("no slot is free: are other tests still running?")
