"""Log lines are handled in another thread, in their order, and none is lost."""

import logging
import threading

import pytest

from roah_rsbb.ground.loop import LogLines


class Slow(logging.Handler):
    """As the handler of a terminal that takes no lines."""

    def __init__(self):
        super().__init__()
        self.takes = threading.Event()
        self.lines = []

    def emit(self, record):
        assert self.takes.wait(10.0)
        self.lines.append((threading.current_thread(), record.levelname, record.getMessage()))


@pytest.fixture
def slow():
    handler = Slow()
    logger = logging.getLogger("slow")
    logger.addHandler(handler)
    yield handler
    assert logger.handlers == [handler]
    logger.removeHandler(handler)


def test_lines_wait_for_the_terminal_and_their_thread_does_not(slow):
    lines = LogLines("slow")
    for number in range(3):
        logging.getLogger("slow").warning("line %d", number)
    assert slow.lines == []
    slow.takes.set()
    lines.close()
    logging.getLogger("slow").error("the last one")
    threads, *rest = zip(*slow.lines)
    assert threads[0] is threads[2] is not threading.current_thread() is threads[3]
    assert list(zip(*rest)) == [*(("WARNING", f"line {n}") for n in range(3)), ("ERROR", "the last one")]


def test_lines_before_a_crash_are_shown(slow):
    LogLines("slow")
    logging.getLogger("slow").error("crashing")
    slow.takes.set()
    for handler in logging.getLogger("slow").handlers:  # as `logging.shutdown`
        handler.flush()
    assert [text for _, _, text in slow.lines] == ["crashing"]
