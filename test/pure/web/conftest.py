"""Support for tests on real loopback sockets."""

import pytest

from helpers.running_loop import running
from roah_rsbb.web import limits

__all__ = ["running"]


@pytest.fixture
def few_connections(monkeypatch):
    """Before `served`: its server has places for ten."""
    monkeypatch.setattr(limits, "MAX_CONNECTIONS", 10)


@pytest.fixture
def served(request, running):
    """The test file's own `Served`: a server on the loop, and its clients."""
    made = request.module.Served(running)
    yield made
    made.server.close()
    running.turn()
