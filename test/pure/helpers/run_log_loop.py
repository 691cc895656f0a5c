"""The writer of run logs with a loop and a journal of the test's own."""

import collections
import pathlib
import queue
import threading
import time

from helpers.bags import UTC, UUID, read, rosbag
from roah_rsbb.core import effects
from roah_rsbb.run_logs.writer import RunLogWriter

PORT, OTHER = 6670, 6671
LIMIT_S = 20.0


class Loop:
    """The core's loop, and a journal. The test decides when posted functions run."""

    def __init__(self, log_dir):
        self.posted = queue.Queue()
        self.journal = collections.defaultdict(list)
        self.troubles, self.repaired = [], []
        self.news = threading.Condition()
        self.writer = RunLogWriter(
            str(log_dir), UUID, lambda text: self.put(self.troubles, text),
            lambda trouble, text: self.put(self.repaired, (trouble, text)), self.entries_of, self.posted.put,
        )

    def put(self, where, what):
        with self.news:
            where.append(what)
            self.news.notify_all()

    def entries_of(self, port):
        return tuple(self.journal[port])

    def open(self, port=PORT, robot=""):
        self.writer.opened(effects.RunOpened(port, "Alpha", 1, 1, robot), UTC)
        return pathlib.Path(self.writer.files[port])

    def log(self, logged, port=PORT):
        """As the core: first the journal, then the log."""
        for topic, value, utc in logged:
            self.journal[port].append((topic, value, utc))
            self.writer.logged(effects.RunLogged(port, topic, value), utc)

    def close(self, port=PORT):
        self.writer.closed(effects.RunClosed(port))

    def answer(self):
        """Do the next thing that is posted; fails if there is none."""
        self.posted.get(timeout=LIMIT_S)()

    def settle(self, port=PORT):
        """Wait until the writer has processed its queue."""
        done = threading.Event()
        self.writer._jobs.put(done.set)
        assert done.wait(LIMIT_S)

    def wait(self, where, count=1):
        with self.news:
            assert self.news.wait_for(lambda: len(where) >= count, LIMIT_S)


def complete(path, limit_s=LIMIT_S):
    """Return the contents of a complete log."""
    deadline = time.monotonic() + limit_s
    while True:
        try:
            return read(path)
        except (OSError, rosbag.ROSBagException):
            assert time.monotonic() < deadline
            time.sleep(0.01)
