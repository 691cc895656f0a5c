"""The node on the box's computer that copies the journal to the standby."""

from roah_rsbb.core.copies import STANDBY, CopyReport
from roah_rsbb.journal.copy_folder import CannotWriteCopy
from roah_rsbb.journal.copy_follower import PERIOD_S, RETRY_S, Follower
from roah_rsbb.standby.beside_copy import newest
from roah_rsbb.standby.channel import TIMEOUT_S, decode, encode
from roah_rsbb.standby.remote import CoreState, RemoteCopy

from .scheduler import Process

REPORT_S = 1.0
SHORTEST_S, LONGEST_S = 0.0005, 0.01


class Backup:
    """The node on the box's computer that copies the journal to the standby."""

    def __init__(self, standby, box):
        self._standby, self._box, self._world = standby, box, box.world
        self.process = Process(box.computer, f"backup of {box.computer.name}")
        self._follower = Follower(box.storage.folder, self._open, now=box.computer.mono, on_answer=self._answer)
        self._is_stepping = self._is_asked = False
        self._stops = {}  # that the box has sent
        self._began = box.computer.mono()
        self._planned = None
        self.process.soon(self._step)
        self.process.soon(self._report)

    def end(self):
        """The computer loses its power."""
        self.process.end()

    def ask(self, core, ticket):
        """The core asks whether the standby has everything up to a ticket."""
        question = core, core.store.identity, ticket

        self._arrive(lambda: self._follower.ask(question))

    def pass_stops(self, stops):
        """The core has sent STOP, and may not have recorded it."""
        def take():
            self._stops = newest(self._stops, stops)
        self._arrive(take)

    def _arrive(self, take):
        def arrive():
            take()
            self._is_asked = True
            if not self._is_stepping and not self._follower.progress.trouble:
                self._plan(0.0)
        self._world.scheduler.after(self._way_s(), lambda: self.process.soon(arrive))

    def _answer(self, question):
        core, journal, ticket = question
        if journal == self._follower.progress.journal:
            self._at_core(core, lambda: core.standby.on_answer(ticket))

    def _at_core(self, core, function):
        process = self._box.process

        def act():
            if self._box.core is core and self._box.process is process:
                function()
        self._world.scheduler.after(self._way_s(), lambda: process.soon(act))

    def _report(self):
        self.process.loop.call_later(REPORT_S, self._report)
        core, progress = self._box.core, self._follower.progress
        if core is None:
            return
        complete = self._began if progress.complete_mono is None else progress.complete_mono
        report = CopyReport(STANDBY, progress.journal == core.store.identity, self._box.computer.mono() - complete,
                            progress.missing_bytes, progress.trouble)

        def take():
            core.event(core.box.copies.report, report)
            core.standby.look()
        self._at_core(core, take)

    def _plan(self, seconds):
        if self._planned is not None:
            self._planned.cancel()
        self._planned = self.process.loop.call_later(seconds, self._step)

    def _step(self):
        """What the thread of the follower does."""
        self._is_stepping, self._is_asked = True, False
        self._follower.step()
        self._is_stepping = False
        self._plan(RETRY_S if self._follower.progress.trouble else 0.0 if self._is_asked else PERIOD_S)

    def _open(self):
        return RemoteCopy(self._exchange, self._box.computer.mono, self._box.computer.utc,
                          lambda: CoreState(stops=self._stops))

    def _exchange(self, message):
        """Send a request to the standby, and wait for the answer."""
        answers, boot = [], {"boot": self._box.computer.boot_id} if "boot" in message else {}
        self._standby.request(encode({**message, **boot}), self._box.computer.host, answers.append)
        self.process.wait(TIMEOUT_S, lambda: bool(answers))
        if not answers or answers[0] is None:
            raise CannotWriteCopy("the standby is not connected")
        return decode(answers[0])

    def _way_s(self):
        return self._world.air.random.uniform(SHORTEST_S, LONGEST_S)
