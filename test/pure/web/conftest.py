"""Support for tests on real loopback sockets."""

import pytest

from helpers.running_loop import running

__all__ = ["running"]


@pytest.fixture
def served(request, running):
    """The test file's own `Served`: a server on the loop, and its clients."""
    made = request.module.Served(running)
    yield made
    made.server.close()
    running.turn()
