"""Addresses on this machine's loopback network. No datagram leaves the machine."""

BROADCAST, BOX_HOST = "127.255.255.255", "127.0.0.1"
PUBLIC_HOST = "127.0.1.1"  # of all robots' beacons


def host_of(index: int) -> str:
    """The address of a robot's private channel."""
    return f"127.0.{2 + index // 200}.{1 + index % 200}"
