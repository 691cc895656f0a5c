"""A standby: its copy of the journal, the pair that both computers belong to, and the takeover.

The programs that copy the journal and keep the copy are threads and sockets around the parts that run here: `Follower`
and `RemoteCopy` on the box, `Receiver` on the standby. The files of both ends of the pair are written as the pairing
writes them. A takeover does what `standby takeover` does.
"""

import contextlib
import os
import stat

from roah_rsbb.journal import epochs
from roah_rsbb.journal.copy_folder import drop_drafts
from roah_rsbb.journal.log_dir import JOURNAL
from roah_rsbb.standby import beside_copy
from roah_rsbb.standby.channel import decode, encode
from roah_rsbb.standby.pair import hashed, rejoin_key
from roah_rsbb.standby.pairing import PairedBox, PairedStandby, write_box, write_standby
from roah_rsbb.standby.remote import Receiver

from .box import Box
from .disk import Storage
from .scheduler import Process

PORT = 8083
KEY = "5f"
# Without a sign of the box for so long, a takeover is possible (`SILENT_S` of standby/program/keeping.py).
SILENT_S = 3.0
SHORTEST_S, LONGEST_S = 0.0005, 0.01
# How long the disk of the standby takes.
DISK_S = (0.002, 0.01, 0.05, 0.2)


# A copy that nothing disturbs for so long lacks less than the second time.
UNDISTURBED_S, BEHIND_S = 8.0, 1.0


class StandbyDisk:
    """What a power failure of the standby would leave: what was synced, of files whose names were."""

    def __init__(self, path, computer):
        self._path, self._computer = path, computer
        self._sizes, self._named = {}, set()  # by number of the file

    @contextlib.contextmanager
    def watched(self):
        """Note what is synced in this block, which runs on the computer."""
        before = os.fsync, beside_copy.boot_id
        os.fsync, beside_copy.boot_id = self._sync, lambda: self._computer.boot_id
        try:
            yield
        finally:
            os.fsync, beside_copy.boot_id = before

    def _sync(self, fd):
        found = os.fstat(fd)
        if stat.S_ISDIR(found.st_mode):
            self._named.update(entry.inode() for entry in os.scandir(fd))
        else:
            self._sizes[found.st_ino] = found.st_size

    def has(self, text):
        """Whether a text is in a segment, and on the disk."""
        with contextlib.suppress(FileNotFoundError):
            for name in sorted(os.listdir(self._path), reverse=True):
                with open(os.path.join(self._path, name), "rb") as file:
                    number = os.fstat(file.fileno()).st_ino
                    if number in self._named and text.encode() in file.read(self._sizes.get(number, 0)):
                        return True
        return False


class Standby:
    """The second computer."""

    def __init__(self, world, computer, folder, box):
        self.world, self.computer, self.folder, self._box = world, computer, folder, box
        self.has_taken_over = False
        self.copied_until = 0.0  # what was before is in the copy
        self._disturbed = self._heard = world.scheduler.now
        self._apart = [world.scheduler.now]  # moments at which the two computers did not work together
        os.makedirs(folder)
        self._disk = StandbyDisk(os.path.join(folder, JOURNAL), computer)
        self.has = self._disk.has
        os.makedirs(box.storage.folder, exist_ok=True)
        write_standby(box.storage.folder, PairedStandby("standby", hashed(KEY), computer.host, PORT))
        write_box(folder, PairedBox(box.computer.host, PORT, "00", KEY))
        self._start()
        world.air.watchers.append(self._hear)

    def _start(self):
        self._process = Process(self.computer, "standby")
        self._receiver = Receiver(self.folder, self.computer.utc, self.computer.mono)
        self._process.on_end.append(self._receiver.close)

    def restart(self):
        """The program that keeps the copy is killed, and started again."""
        if not self.has_taken_over:
            self._process.end()
            self._start()

    def hang(self, seconds):
        """The program that keeps the copy does nothing for a while."""
        self._process.hang(seconds)

    def request(self, data, host, on_answer):
        """A request of the box, by TCP; `on_answer` gets the answer, or None if there is no connection."""
        process, world = self._process, self.world

        def arrive():
            if process.is_ended or self.has_taken_over:
                world.scheduler.after(self._way_s(), lambda: on_answer(None))
            else:
                process.soon(act)

        def act():
            self._heard = world.scheduler.now
            with self._disk.watched():
                answer = encode(self._receiver.answer(decode(data)))
            seconds = world.air.random.choice(DISK_S)
            world.scheduler.after(seconds, lambda: self._if_connected(host, lambda: on_answer(answer)))
        self._if_connected(host, arrive)

    def _if_connected(self, host, function):
        weathers = [self.world.air.weather[each] for each in (host, self.computer.host)]
        if any(weather.is_cut for weather in weathers):
            return  # the other end waits for its timeout
        seconds = self._way_s()
        for weather in weathers:
            seconds += 0.2 if self.world.air.random.random() < weather.loss else 0.0  # sent again
        self.world.scheduler.after(seconds, function)

    def look(self):
        """Look whether anything disturbs the copy."""
        world, now = self.world, self.world.scheduler.now
        box, weathers = self._box, [world.air.weather[each] for each in (self._box.computer.host, self.computer.host)]
        is_quiet = all(not weather.is_cut and not weather.loss and not weather.late for weather in weathers)
        is_apart = not is_quiet or box.core is None or any(
            process.is_ended or process.is_hanging() for process in (box.process, self._process))
        if is_apart:
            self._apart.append(now)
        if is_apart or box.storage.is_in_trouble or any(
                process.is_busy(now) for process in (box.process, self._process)):
            self._disturbed = now
        elif now - self._disturbed > UNDISTURBED_S:
            self.copied_until = now - BEHIND_S

    def has_heard(self, at):
        """Whether the box's STOP of a moment has come: it is sent at once, also before it is in the journal."""
        return not any(at - BEHIND_S < moment < at + BEHIND_S for moment in self._apart)

    def _hear(self, source, _port, _datagram, host):
        weathers = [self.world.air.weather[each] for each in (source, self.computer.host)]
        if source == self._box.computer.host and host != source and all(weather.is_good for weather in weathers):
            self._heard = self.world.scheduler.now

    def take_over(self):
        """Somebody asks for a takeover, which is refused while the box is heard."""
        world = self.world
        if self.has_taken_over or world.scheduler.now - self._heard < SILENT_S:
            world.trace.note("takeover refused: the box is heard")
            return
        if not os.path.isdir(os.path.join(self.folder, JOURNAL)):
            world.trace.note("takeover refused: there is no copy")
            return
        self.has_taken_over = True
        self._process.end()
        drop_drafts(self.folder)
        standing = epochs.raise_epoch(os.path.join(self.folder, JOURNAL), self.computer.utc(), "standby")
        before = self._box.computer
        write_standby(self.folder, PairedStandby("the box before", hashed(rejoin_key(hashed(KEY))), before.host, PORT))
        world.trace.note(f"takeover, epoch {standing.epoch}")
        storage = Storage(self.folder, world.scheduler, world.storage.random, world.random_bytes)
        storage.adopt(os.path.join(self.folder, JOURNAL))
        world.taken_over(Box(world, self.computer, storage, world.config, standby_port=PORT))

    def _way_s(self):
        return self.world.air.random.uniform(SHORTEST_S, LONGEST_S)
