"""Support for tests on real loopback sockets."""

from helpers.running_loop import running

__all__ = ["running"]
