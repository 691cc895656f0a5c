"""What happened in a simulation: lines for people, and a number that is equal for equal courses."""

import hashlib


class Trace:
    """Collects what happens."""

    def __init__(self, scheduler, folder):
        """`folder`: is left out of the lines."""
        self._scheduler, self._folder = scheduler, folder
        self._digest = hashlib.sha256()
        self.lines = []
        self.compared = None  # the number of lines and the digest until which courses are compared; None: all

    def note(self, text):
        """Something that a person wants to read."""
        line = f"{self._scheduler.now:10.4f} {text}".replace(self._folder, "")
        self.lines.append(line)
        self._digest.update(line.encode("utf-8", "replace"))

    def datagram(self, source, port, datagram, host):
        """A datagram was sent."""
        self._digest.update(f"{self._scheduler.now!r} {source} {port} {host}".encode() + datagram)

    def end_comparison(self):
        """What follows depends on when a core has read its last datagram before it hung."""
        if self.compared is None:
            self.compared = len(self.lines), self.digest

    @property
    def digest(self):
        """A number of all bytes and times."""
        return self._digest.hexdigest()
