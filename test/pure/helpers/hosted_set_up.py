"""The dummy set-up without ROS, in simulated time: the box, a host of modules with simulated frames, and a robot."""

from helpers.config_files import SHIPPED
from helpers.dummy_set_up import DummySetUp
from roah_rsbb.bmbox.host.dummy_world import DummyFrames
from roah_rsbb.bmbox.host.ground_truth_of_frames import ZonesGroundTruth
from roah_rsbb.bmbox.host.host import ModulesHost


class Timers:
    """The timers of an asyncio loop, at the test's time."""

    class Timer:
        """A call at a time."""

        def __init__(self, at, function):
            self.at, self.function, self.is_cancelled = at, function, False

        def cancel(self):
            self.is_cancelled = True

    def __init__(self, mono):
        self.mono = mono  # returns the time
        self.waiting = []

    def call_later(self, seconds, function):
        self.waiting.append(self.Timer(self.mono() + seconds, function))
        return self.waiting[-1]

    def turn(self):
        """Call what is due."""
        due = [timer for timer in self.waiting if timer.at <= self.mono() + 1e-9 or timer.is_cancelled]
        self.waiting = [timer for timer in self.waiting if timer not in due]
        for timer in due:
            if not timer.is_cancelled:
                timer.function()


class HostedSetUp(DummySetUp):
    """A benchmark with the shipped parameters and ground truth, from its start to its end."""

    def restart(self):
        """The process of the modules crashes and restarts."""
        folder, driver = str(SHIPPED / "modules"), self.driver
        self.timers, self.taken = Timers(lambda: driver.now.mono), None
        self.host = ModulesHost(
            self.timers, folder, [self.kind.CODE], ZonesGroundTruth(folder, lambda: DummyFrames(3, self._utc)),
            lambda state: driver.event(driver.box.modules.on_modules, state), self._utc)
        self.host.start()
        self.restarts += 1

    def _utc(self):
        return self.driver.now.utc

    def _module(self):
        """Exchange messages until neither side has news."""
        self.timers.turn()
        while self.taken != self.driver.box.modules.runs():
            self.taken = self.driver.box.modules.runs()
            self.host.take(self.taken)
