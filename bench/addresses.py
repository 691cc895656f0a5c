"""Addresses on this machine's loopback network. No datagram leaves the machine."""

BROADCAST, BOX_HOST = "127.255.255.255", "127.0.0.1"
PUBLIC_HOST = "127.0.1.1"  # where all robots hear the box


def host_of(index: int) -> str:
    """A robot's address."""
    return f"127.0.{2 + index // 200}.{1 + index % 200}"
