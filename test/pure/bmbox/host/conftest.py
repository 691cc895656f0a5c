"""Fixtures of the tests of hosts of modules."""

from helpers.running_loop import running

__all__ = ["running"]
