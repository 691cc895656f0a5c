"""A computer of the box: the core, which is built as its node builds it, and what starts it again."""

import math

from roah_rsbb.box.game import BoxPlace, Game, Machine, Outputs
from roah_rsbb.comm.channels import Network, Seen
from roah_rsbb.comm.ciphers import Cipher
from roah_rsbb.core.copies import STANDBY
from roah_rsbb.core.effects import Level
from roah_rsbb.core.settings import Settings
from roah_rsbb.core.views.document import Documents
from roah_rsbb.journal.log_dir import PortRecord

from .air import BROADCAST
from .backup import Backup
from .scheduler import Ended, Process

TICK_S = 0.1
# Much less than a competition needs, and much more than a simulation.
SEEN_BITS = 2**19
TICKS_A_SECOND = 10


class RunLogs:
    """The run logs of a core, which are never made: the journal has them."""

    def __init__(self, uuid, on_problem, on_repaired):
        self.files = {}

    def check(self):
        return ""

    def opened(self, effect, utc):
        self.files[effect.port] = f"run log of port {effect.port}"

    def resumed(self, port, path):
        self.files[port] = path or f"run log of port {port}"

    def closed(self, effect):
        self.files.pop(effect.port, None)

    def make(self, paths):
        """None is made."""

    def stop(self):
        """Nothing waits."""


class Memory:
    """What a supervisor keeps for its cores: see `roah_rsbb.box.journal.Memory`."""

    def __init__(self, trace):
        self.texts, self.kept, self._trace = {}, {}, trace

    def begin(self):
        """The next core starts."""
        self.kept = dict(self.texts)

    def keep(self, name, value):
        self.texts[name] = value

    def drop(self, name):
        self.texts.pop(name, None)

    def send(self):
        """A core that did not run for a while asks its standby, and says that it lives."""
        self._trace.end_comparison()


class Box:
    """A computer on which a core runs, and is started again when it ends."""

    def __init__(self, world, computer, storage, config, standby_port=0):
        self.world, self.computer, self.storage, self.config = world, computer, storage, config
        self.settings = Settings(listen_duration=1.0)
        self.standby_port = standby_port
        self.backup = None  # copies the journal to a standby; None: there is none
        self.oracles = world.oracles
        self.memory = Memory(world.trace)
        self.starts = 0
        self.is_lost = False  # it is never started again
        self.process = None  # of the present core
        self.core = None  # None until it has resumed

    def start(self):
        """Start a core, unless one runs."""
        if self.is_lost or (self.process is not None and not self.process.is_ended):
            return
        self.starts += 1
        self.process = Process(self.computer, f"core {self.starts}")
        self.process.loop.create_task(self._run(self.process))
        self.world.trace.note(f"core {self.starts} starts on {self.computer.name}")

    async def _run(self, process):
        world, computer = self.world, self.computer
        machine = Machine(
            computer.boot_id, self.starts, f"uuid {computer.name} {self.starts}", computer.mono, computer.utc,
            computer.mono, world.random_bytes, Seen(SEEN_BITS), world.can_wait, lambda work: work(),
            world.air.peer_maker(process), self.memory, self._end_superseded)
        network = Network(BROADCAST, 6666, computer.host, Cipher.AES_128_CBC, False, 1024)
        outputs = Outputs(lambda: None, lambda: None, lambda wish: None, self._log, self._bug, self._ask_standby,
                          self._inform_standby)
        ports = PortRecord(self.storage.folder, lambda work: process.loop.call_later(self.storage.sync_s(), work))
        self.memory.begin()
        place = BoxPlace(self.storage.folder, network, self.standby_port)
        core = Game(
            process.loop, machine, place, self.config, 0, self.settings, "", self.storage.open_journal(process), ports,
            RunLogs, outputs)
        core.on_changed = lambda: self.oracles.happened(self)
        if self.standby_port:
            core.expect_copies([STANDBY])
        self.oracles.opened(self, core)
        await core.ask()
        try:
            core.resume(lambda versions: {})
            core.open()
            self.core = core
            self.oracles.resumed(self, core)
        except Exception as error:  # nobody asks the task for it
            world.scheduler.bugs.append(error)
        self._documents = Documents(core.box, "", "")
        self._tick(process, core, 0)

    def copy(self):
        """Start the node that copies the journal to the standby, in place of an earlier one."""
        if self.is_lost:
            return
        if self.backup is not None:
            self.backup.end()
        self.backup = Backup(self.world.standby, self)

    def _tick(self, process, core, number):
        process.loop.call_later(TICK_S, self._tick, process, core, number + 1)
        core.event(core.box.timers.tick_if_due)
        core.unsaved()
        if number % TICKS_A_SECOND == 0:
            core.each_second()
            if process.is_ended:  # while it waited for the disk
                return
            document = self._documents.look(core.now(), unsaved=core.unsaved())
            self.oracles.document(self, core, document)

    def kill(self, restart_s, power=False):
        """The process is killed, or the computer loses its power; it is started again after so many seconds."""
        self.world.trace.note(f"{self.computer.name}: {'power cut' if power else 'core killed'}")
        if self.process is not None:
            self.process.end()
        self.oracles.killed(self, power)
        self.core = None
        self.is_lost = self.is_lost or math.isinf(restart_s)
        (self.storage.cut if power else self.storage.killed)()
        if power:
            self.memory = Memory(self.world.trace)
            self.computer.boot()
            if self.backup is not None:
                self.backup.end()
                self.world.scheduler.after(restart_s, self.copy)
        self.world.scheduler.after(restart_s, self.start)

    def _ask_standby(self, ticket):
        if self.backup is not None and self.core is not None:
            self.backup.ask(self.core, ticket)

    def _inform_standby(self, stops):
        if self.backup is not None:
            self.backup.pass_stops(stops)

    def _end_superseded(self, away_s, host):
        self.world.trace.note(f"{self.computer.name}: ends, superseded by {host}")
        self.process.end()
        self.core = None
        self.world.scheduler.after(1.0, self.start)
        raise Ended

    def _log(self, level, text):
        if level >= Level.WARNING:
            self.world.trace.note(f"{self.computer.name}: {level.name} {text}")

    def _bug(self, text):
        self.oracles.bug(text)
