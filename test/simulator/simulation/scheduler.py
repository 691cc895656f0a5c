"""Simulated time: computers with their clocks, and processes whose asyncio loops share one list of what is due.

There are no threads. A step is one callback of one process, and takes no time. A process may hang, end, or wait without
its loop (`Process.wait`), as a program does in a system call; the others continue meanwhile.
"""

import asyncio
import contextlib
import heapq
import itertools
from typing import NamedTuple

UTC0 = 1_800_000_000.0
# Steps without any passing of time.
MOST_STEPS_AT_ONCE = 100_000


# A process that hung takes so long to do what waited.
JUST_S = 0.1
# More than there are steps: what has less by this is done first.
FIRST = 2**40


class Ended(BaseException):
    """The process was ended while it waited."""


class EndlessLoop(Exception):
    """The processes are busy, and no time passes."""


class Scheduler:
    """The true time, and what is due."""

    def __init__(self):
        self.now = 0.0
        self.current = None  # the process of the present step
        self.steps = 0
        self.bugs = []  # exceptions that nobody handled
        self.processes = []  # all that ever were
        self._due = []  # heap of (time, number, process, handle)
        self._numbers = itertools.count()
        self._at_once = 0

    def at(self, when, process, handle):
        """Plan a step, of a process or of nature (None). `handle`: a `Handle` or a function."""
        heapq.heappush(self._due, (when if when > self.now else self.now, next(self._numbers), process, handle))

    def after(self, seconds, function):
        """Plan a step of nature."""
        self.at(self.now + seconds, None, function)

    def run(self, end, is_over=lambda: False):
        """Let time pass until `end`, or until a condition holds. Returns whether it holds."""
        due = self._due
        while due and due[0][0] <= end:
            when, number, process, handle = heapq.heappop(due)
            if process is not None:
                if process.is_ended or handle.is_cancelled:
                    continue
                if process.is_busy(when):
                    process.defer(number, handle)
                    continue
            if when > self.now:
                self.now, self._at_once = when, 0
            self.steps += 1
            self._at_once += 1
            if self._at_once > MOST_STEPS_AT_ONCE:
                raise EndlessLoop(f"{process and process.name}: {handle}")
            if process is None:
                handle()
            else:
                process.do(handle)
            if is_over():
                return True
        self.now = max(self.now, end)
        return False

    def put_back(self, when, number, process, handle):
        """Plan a step again that could not be done, in its old order."""
        heapq.heappush(self._due, (when, number, process, handle))


class Computer:
    """A computer's clocks. `drift`: by how much they are fast, as a share. `up_s`: since when it runs."""

    def __init__(self, scheduler, name, host, drift=0.0, utc_ahead=0.0, up_s=1000.0):
        self.scheduler = scheduler
        self.name = name
        self.host = host
        self._rate = 1.0 + drift
        self._booted = scheduler.now - up_s  # true time
        self._utc_ahead = UTC0 + utc_ahead - self.mono() - scheduler.now
        self.boots = 1

    @property
    def boot_id(self):
        return f"{self.name} boot {self.boots}"

    def mono(self):
        """Monotonic seconds since the start of the computer."""
        return (self.scheduler.now - self._booted) * self._rate

    def true_time(self, mono):
        """The true time at which the monotonic clock shows this, and a little more: less would be too early."""
        return self._booted + mono / self._rate + 1e-9

    def utc(self):
        """Seconds since 1970, as the computer believes."""
        return self.mono() + self._utc_ahead + 0.0

    def set_clock(self, seconds):
        """Somebody sets the clock by so many seconds."""
        self._utc_ahead += seconds

    def boot(self):
        """The computer starts again. Its clock of UTC continues."""
        utc = self.utc()
        self.boots += 1
        self._booted = self.scheduler.now - 20.0
        self._utc_ahead = utc - self.mono()


class Woke(NamedTuple):
    """The end of the last time that a process hung."""

    at: float  # true time
    hung_s: float


class Handle:
    """What a loop does later: `asyncio.TimerHandle`, without contexts, which no simulated program uses."""

    def __init__(self, callback, args, when=0.0):
        self.callback, self.args, self._when = callback, args, when
        self.is_cancelled = False

    def cancel(self):
        self.is_cancelled, self.callback, self.args = True, None, ()

    def cancelled(self):
        return self.is_cancelled

    def when(self):
        return self._when


class Loop(asyncio.AbstractEventLoop):
    """The asyncio loop of one process."""

    def __init__(self, process):
        self._process = process
        self._scheduler = process.scheduler
        self._computer = process.computer
        self.time = process.computer.mono

    def call_soon(self, callback, *args, context=None):
        handle = Handle(callback, args)
        self._scheduler.at(self._scheduler.now, self._process, handle)
        return handle

    call_soon_threadsafe = call_soon

    def call_later(self, delay, callback, *args, context=None):
        return self.call_at(self.time() + delay, callback, *args, context=context)

    def call_at(self, when, callback, *args, context=None):
        handle = Handle(callback, args, when)
        self._scheduler.at(self._computer.true_time(when), self._process, handle)
        return handle

    def create_future(self):
        return asyncio.Future(loop=self)

    def create_task(self, coro, **_options):
        task = asyncio.Task(coro, loop=self)
        self._process.tasks.append((task, coro))
        return task

    def call_exception_handler(self, context):
        error = context.get("exception")
        if not isinstance(error, Ended):
            self._scheduler.bugs.append(error if error is not None else RuntimeError(context["message"]))

    def get_debug(self):
        return False

    def is_running(self):
        return True

    def is_closed(self):
        return False


class _Input(Handle):
    """What a loop does before what is due by its clock, as asyncio does after `select`."""


class Process:
    """A program that runs on a computer."""

    def __init__(self, computer, name):
        self.scheduler = computer.scheduler
        self.computer = computer
        self.name = name
        self.is_ended = False
        self.on_end = []  # called when it ends, however it ends
        self.tasks = []  # each with its coroutine
        self.woke = self._waited = Woke(0.0, 0.0)
        self._hangs_until = 0.0  # true time
        self._waits = 0  # how many calls of `wait` are in progress
        self._deferred = []  # steps that became due during `wait`
        self.loop = Loop(self)
        self.scheduler.processes.append(self)

    def is_busy(self, when):
        """Whether its loop does nothing at a time."""
        return self._waits > 0 or when < self._hangs_until

    def is_hanging(self):
        """Whether it does nothing at all now."""
        return self.scheduler.now < self._hangs_until

    def hung_s(self):
        """For how long it hung or waited just before; 0: it ran."""
        ends = [each for each in (self.woke, self._waited) if self.scheduler.now - each.at < JUST_S]
        return max((each.hung_s for each in ends), default=0.0)

    def defer(self, number, handle):
        """Do a step when the process is no longer busy."""
        number -= FIRST if isinstance(handle, _Input) and number > 0 else 0
        if self._waits:
            self._deferred.append((number, handle))
        else:
            self.scheduler.put_back(self._hangs_until, number, self, handle)

    def soon(self, function):
        """Do something in the process as soon as it is not busy."""
        self.scheduler.at(self.scheduler.now, self, _Input(function, ()))

    def do(self, handle):
        """Do a step of this process now."""
        scheduler = self.scheduler
        before, scheduler.current = scheduler.current, self
        asyncio._set_running_loop(self.loop)
        try:
            handle.callback(*handle.args)
        except Ended:
            pass
        except Exception as error:
            scheduler.bugs.append(error)
        finally:
            scheduler.current = before
            asyncio._set_running_loop(None if before is None else before.loop)

    def hang(self, seconds):
        """It does nothing for a while."""
        now, until = self.scheduler.now, max(self._hangs_until, self.scheduler.now + seconds)
        self.woke = Woke(until, until - (now if now > self._hangs_until else self.woke.at - self.woke.hung_s))
        self._hangs_until = until

    def end(self):
        """It is killed."""
        if not self.is_ended:
            self.is_ended = True
            for act in self.on_end:
                act()

    def bury(self):
        """Free what an ended process has in memory."""
        for task, coro in self.tasks:
            task._log_destroy_pending = False
            with contextlib.suppress(BaseException):
                coro.throw(asyncio.CancelledError())
            with contextlib.suppress(BaseException):
                coro.close()

    def wait(self, seconds, is_over=lambda: False):
        """Within a step: let time pass for all others, as in a system call. Raises `Ended`."""
        scheduler = self.scheduler
        began = scheduler.now - (self._waited.hung_s if scheduler.now == self._waited.at else 0.0)
        self._waits += 1
        try:
            scheduler.run(scheduler.now + seconds, lambda: self.is_ended or is_over())
            while not self.is_ended and scheduler.now < self._hangs_until:
                scheduler.run(self._hangs_until, lambda: self.is_ended)
        finally:
            self._waits -= 1
            if scheduler.now - began > self.hung_s():
                self._waited = Woke(scheduler.now, scheduler.now - began)
            if not self._waits:
                deferred, self._deferred = self._deferred, []
                for number, handle in deferred:
                    scheduler.put_back(scheduler.now, number, self, handle)
            scheduler.current = self
            asyncio._set_running_loop(self.loop)
        if self.is_ended:
            raise Ended
