"""A writer of run logs in its own thread, which looks and tries again quickly."""

import pytest


@pytest.fixture
def quick_writer(monkeypatch):
    monkeypatch.setattr("roah_rsbb.run_logs.writer.CHECK_S", 0.02)
    monkeypatch.setattr("roah_rsbb.run_logs.writer.RETRY_S", 0.05)


@pytest.fixture
def log_dir(tmp_path):
    return tmp_path / "logs"


@pytest.fixture
def loop(log_dir, quick_writer):
    # Not above: where there is no rosbag (Python 3.8), only its tests are skipped, not all of this directory.
    from helpers.run_log_loop import Loop

    made = Loop(log_dir)
    yield made
    made.writer.stop()
    assert not made.writer._thread.is_alive()
