"""A writer of run logs in its own thread, which looks and tries again quickly."""

import pytest

from helpers.run_log_loop import Loop
from roah_rsbb.nodes import run_log_writer


@pytest.fixture
def quick_writer(monkeypatch):
    monkeypatch.setattr(run_log_writer, "LOOK_S", 0.02)
    monkeypatch.setattr(run_log_writer, "RETRY_S", 0.05)


@pytest.fixture
def log_dir(tmp_path):
    return tmp_path / "logs"


@pytest.fixture
def loop(log_dir, quick_writer):
    made = Loop(log_dir)
    yield made
    made.writer.stop()
    assert not made.writer._thread.is_alive()
