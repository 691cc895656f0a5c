"""The referee's program: its signals."""

import signal

import pytest

from roah_rsbb.referee import program


def test_signals_that_come_together_are_one_wish(monkeypatch):
    """`timeout 10 rosrun … referee run` sends SIGTERM to the process and to its group. A second wish would leave a run
    whose robot moves."""
    mono = [100.0]
    monkeypatch.setattr(program.time, "monotonic", lambda: mono[0])
    interrupts = program.Interrupts()
    with pytest.raises(KeyboardInterrupt):
        interrupts(signal.SIGTERM, None)
    interrupts(signal.SIGTERM, None)
    mono[0] += 0.4
    interrupts(signal.SIGINT, None)
    mono[0] += 0.6
    with pytest.raises(KeyboardInterrupt):
        interrupts(signal.SIGINT, None)
