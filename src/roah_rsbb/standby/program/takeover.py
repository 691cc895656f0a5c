"""The folder of a standby: the copy in it, who uses it, and the box that starts with it at a takeover."""

import contextlib
import json
import os
import shlex
import signal
import socket
import time
from typing import Dict, Iterator, List, Optional, Sequence, TextIO, Tuple

from roah_rsbb.ground import durable, linux
from roah_rsbb.ground.arguments import is_without_ros, typed, without_ros
from roah_rsbb.journal import epochs
from roah_rsbb.journal import log_dir as log_dirs
from roah_rsbb.journal.contents import BoxEpoch, open_journal
from roah_rsbb.journal.copy_folder import drop_drafts
from roah_rsbb.journal.log import names_in
from roah_rsbb.journal.log_dir import JOURNAL
from roah_rsbb.rulebook.benchmarks import Durable
from roah_rsbb.rulebook.config import ScheduleSettings, settings_in
from roah_rsbb.rulebook.errors import known
from roah_rsbb.standby.beside_copy import unpack
from roah_rsbb.standby.channel import MODULES, NETWORK, PASSWORDS
from roah_rsbb.standby.pair import hashed, rejoin_key
from roah_rsbb.standby.pairing import (
    PairedBox,
    PairedStandby,
    read_box,
    read_standby,
    set_aside_damaged_box,
    write_standby,
)
from roah_rsbb.standby.program.ears import NoAddress, give_back_address, is_own, take_address
from roah_rsbb.standby.standby_end import is_alive
from roah_rsbb.tools.preflight_checks import Severity, check_other_box
from roah_rsbb.wording import times

PROGRAM = "standby"
# Arguments of roah_rsbb.launch, in the order of the files in configuration.json.
CONFIGURATION = "configuration"
# Locked by the program that keeps the copy, and by whoever has the journal.
LOCK, JOURNAL_LOCK = "standby_follow.lock", f"{JOURNAL}.lock"
ALIVE_S = 2.0
# Seconds to wait until the program that keeps the copy has ended, with the box that is prepared.
END_S = 40.0


class Denied(Exception):
    """The takeover is refused, or is not possible. The text has a reason in each line."""


class StandbyFolder:
    """The folder of a standby, or the log_dir of a box. All methods may raise `Denied` or OSError."""

    def __init__(self, path: str, arguments: Sequence[str] = ()) -> None:
        """`arguments`: NAME:=VALUE, which are passed to the box that starts with the copy."""
        self.path, self.arguments = path, list(arguments)

    @property
    def has_journal(self) -> bool:
        """Whether there is a journal or a copy of one."""
        return bool(names_in(self._in(JOURNAL)))

    @property
    def is_in_use(self) -> bool:
        """Whether a box runs with this folder, or the copy is being written."""
        return linux.is_locked(self._in(JOURNAL_LOCK))

    @property
    def is_kept(self) -> bool:
        """Whether a program keeps the copy."""
        return linux.is_locked(self._in(LOCK))

    @property
    def standing(self) -> BoxEpoch:
        """The epoch of its journal, and whether it was superseded."""
        return epochs.standing_in(self._in(JOURNAL))

    def raise_epoch(self, *above: int) -> BoxEpoch:
        """Raise the epoch of the journal, above the present one or the given one."""
        return epochs.raise_epoch(self._in(JOURNAL), time.time(), socket.gethostname(), *above)

    def settings(self) -> Optional[ScheduleSettings]:
        """Return the settings in the schedule in force; None: they are not known here."""
        kept = log_dirs.read_in_force(self.path)
        text = None if kept is None else kept.versions[kept.present].texts[1]
        if text is None:
            return None
        with known({"schedule.yaml": text}):
            return settings_in("schedule.yaml")

    def use_zone(self) -> None:
        """Show times in the time zone of the competition, or of this computer if that is not known here."""
        settings = self.settings()
        times.use_zone("" if settings is None else settings.time_zone)

    def last_moment(self) -> str:
        """Return what the newest entry of the copy is, as a sentence. A box without runs adds none."""
        utc = open_journal(self._in(JOURNAL)).contents.utc
        if not utc:
            return "The copy is empty"
        self.use_zone()
        ago_s = max(0.0, time.time() - utc)
        return f"The newest entry of the copy is from {times.at_venue(utc)}, {ago_s:.0f} s ago"

    def _in(self, name: str) -> str:
        return os.path.join(self.path, name)

    # -- who uses it ----------------------------------------------------------------------------------

    def check_unused(self) -> None:
        """Refuse a folder that another program uses."""
        for name in (LOCK, JOURNAL_LOCK):
            lock = self._in(name)
            if linux.is_locked(lock):
                raise Denied(f"another program uses {self.path} (process {noted_pid(lock) or 'unknown'}): end it "
                             "first. If it is the box, end that")

    @contextlib.contextmanager
    def locked(self) -> Iterator[TextIO]:
        """Note that this program keeps the copy, also while the box is not connected."""
        with open(self._in(LOCK), "a", encoding="ascii") as file:
            try:
                linux.lock(file.fileno())
            except BlockingIOError:
                raise Denied(f"another program keeps the copy in {self.path}: end it first") from None
            with contextlib.suppress(OSError):  # a standby whose disk is full is one, too
                os.truncate(file.fileno(), 0)
                os.write(file.fileno(), f"{os.getpid()}\n".encode("ascii"))
            yield file

    def end_follower(self) -> None:
        """End the program that keeps the copy."""
        deadline, asked = time.monotonic() + END_S, 0
        while self.is_kept or self.is_in_use:
            pid = next(filter(None, (_holder(self._in(name)) for name in (LOCK, JOURNAL_LOCK))), 0)
            if not pid or time.monotonic() > deadline:
                raise Denied(f"another program uses the copy in {self.path} (process {pid}): end it first")
            if pid != asked:
                asked = pid
                os.kill(pid, signal.SIGTERM)
            time.sleep(0.05)

    # -- the network ----------------------------------------------------------------------------------

    def network_of_box(self) -> Dict[str, str]:
        """Return the network of the box, as far as it is known here."""
        try:
            with open(self._in(NETWORK), encoding="utf-8") as file:
                return {name: str(value) for name, value in json.load(file).items()}
        except (OSError, ValueError, AttributeError):
            return {}

    def network(self) -> Dict[str, str]:
        """Return where to listen for a box."""
        given = {name: value for name, _, value in (argument.partition(":=") for argument in self.arguments)}
        return {"rsbb_host": "10.255.255.255", "rsbb_port": "6666", "bind_host": "0.0.0.0",
                **self.network_of_box(), **given}

    def why_not(self, listen_s: float) -> List[str]:
        """Return why there must be no takeover: each way in which the box is heard."""
        reasons, box, network = [], read_box(self.path), self.network()
        if box is not None and is_alive(box, ALIVE_S):
            reasons.append(f"The box at {box.host} answers.")
        if listen_s:
            found = check_other_box(network["rsbb_host"], int(network["rsbb_port"]), network["bind_host"], listen_s)
            if found.level is not Severity.OK:
                reasons.append(found.text)
        return reasons

    def take_address(self, box: PairedBox) -> None:
        """Take the box's address. Raises `NoAddress`."""
        print(f"This computer has the address {box.host} now, on {take_address(box.host, self.path)}", flush=True)

    def give_back_address(self) -> None:
        """Remove the address that this computer took over, because it is not the box any more."""
        try:
            address = give_back_address(self.path)
        except NoAddress as error:
            raise Denied(f"this computer still has the address that it took over: {error}") from None
        if address:
            print(f"This computer no longer has the address {address}, which it took over", flush=True)

    # -- the box that starts with the copy ------------------------------------------------------------

    def launch_command(self) -> List[str]:
        """Return the command that starts the box with the copy; writes its files."""
        if not self.has_journal:
            raise Denied(f"there is no copy in {self.path}: 'standby follow' has not been connected to the box yet")
        given = {argument.partition(":=")[0] for argument in self.arguments}
        # A box that hears the one before must not give up: that one stops.
        own = {"log_dir": self.path, "resume": "always", "take_over": "true", **self.network_of_box(),
               **self._write_files()}
        start = without_ros("run", "--no-browser") if is_without_ros() else [
            "roslaunch", "roah_rsbb", "roah_rsbb.launch"]
        return [*start, *(f"{name}:={value}" for name, value in own.items() if name not in given), *self.arguments]

    def _write_files(self) -> Dict[str, str]:
        """Write the configuration files of the box; returns the arguments with their paths."""
        kept = log_dirs.kept_files(self.path)
        if not kept:
            raise Denied(f"the copy in {self.path} has no configuration: it is not complete. Use resume and the files "
                         "of the competition, see docs/standby.md")
        os.makedirs(self._in(CONFIGURATION), exist_ok=True)
        found = {"standings_file": "none"}
        for name, text in kept.items():
            path = os.path.join(self.path, CONFIGURATION, f"{name}.yaml")
            if name != "decisions":  # the box finds it beside the benchmarks
                found[f"{name}_file"] = path
            with open(path, "w", encoding="utf-8", newline="") as file:
                file.write(text)
        found["passwords_file"] = self._in(PASSWORDS)
        modules = os.path.join(self.path, CONFIGURATION, "modules")
        with contextlib.suppress(OSError):  # it must not prevent a takeover: only functionality benchmarks need them
            if unpack(self._in(MODULES), modules):
                found["modules_dir"] = modules
        return found

    def become_box(self, box: Optional[PairedBox]) -> Tuple[List[str], List[str]]:
        """Make this computer the box, with a higher epoch than the box before, which is `box`. Returns the command that
        starts the box, and what was printed. A box that is prepared begins when this returns."""
        if not durable.has_space(self.path):
            raise Denied(f"the disk is full: free space for {self.path}, and take over again")
        command = self.launch_command()
        lines = [self.last_moment()]
        if drop_drafts(self.path):
            lines.append("The disk of this computer failed to save a part of the copy, which was not written again "
                         "yet: compare the results with the referees' notes")
        standing = self.standing
        is_box = read_standby(self.path) is not None  # this computer took over before, and starts again
        if not is_box or standing.is_superseded:
            standing = self.raise_epoch()
        if box is not None and not is_box:
            # The box before can become the standby of this one.
            write_standby(self.path, PairedStandby("the box before", hashed(rejoin_key(hashed(box.key))), box.host,
                                                   box.port, is_awaited=True))
        if set_aside_damaged_box(self.path):
            lines.append("The key of the box before is damaged, so that box does not stop when it hears this one. Make "
                         "sure that it is off")
        stops = "" if box is None else ": the box before stops when it hears this one"
        lines += [f"Epoch {standing.epoch}{stops}", shlex.join(command)]
        if box is not None and not is_own(box.host):
            lines.append(f"Robots that send to the box's address {box.host} instead of the broadcast address are not "
                         "heard here: panels show them as silent. If there are such robots, take this address over. "
                         f"Enter as root:\n{typed(PROGRAM)} takeover --take-address --log-dir {self.path}")
        print("\n".join(lines), flush=True)
        return command, lines

    # -- its status -----------------------------------------------------------------------------------

    def status(self) -> Iterator[str]:
        """Show what this computer is; yields sentences."""
        box, standby, standing = read_box(self.path), read_standby(self.path), self.standing
        if not self.has_journal and box is None:
            raise Denied(f"{self.path} is neither the log_dir of a box nor the folder of a copy: give another "
                         "--log-dir")
        self.use_zone()
        if standby is not None or box is None:
            yield from _status_of_box(standby, standing)
        else:
            yield f"This computer is the standby of the box at {box.host}, which " + (
                "answers" if is_alive(box, ALIVE_S) else "does not answer")
            yield "The copy is kept" if self.is_kept else "The copy is not kept: start 'standby follow'"
            if self.has_journal:
                yield self.last_moment()
        yield f"Epoch {standing.epoch}"
        settings = self.settings()
        if settings is None:
            yield "What 'durable' is set to is not known here"
        elif settings.durable is Durable.TWO:
            yield "Scores and sign-offs are confirmed when the standby has them, too (durable: two)"
        else:
            yield "Scores and sign-offs are confirmed without waiting for the standby (durable: one)"


def _status_of_box(standby: Optional[PairedStandby], standing: BoxEpoch) -> Iterator[str]:
    if standing.is_superseded:
        yield f"This computer was the box. The one at {standing.by} took over"
    if standby is None:
        yield "No standby is paired with this box"
        return
    yield f"The standby of this box is {standby.name}" + (
        f", last connected from {standby.host}" if standby.host else ", which was never connected")
    if standby.replaced:
        paired = f"{times.day_of(standby.paired_utc)} at {times.at_venue(standby.paired_utc)}"
        yield f"It was paired on {paired}, and replaced {standby.replaced}"


def noted_pid(path: str) -> int:
    """Return the process that noted itself in a lock; 0 if there is none."""
    with contextlib.suppress(OSError, ValueError), open(path, encoding="ascii") as file:
        return int(file.read())
    return 0


def _holder(path: str) -> int:
    """Return the process that keeps the copy; 0 if it is another program."""
    with contextlib.suppress(OSError):
        pid = noted_pid(path)
        with open(f"/proc/{pid}/cmdline", "rb") as file:
            words = file.read().split(b"\0")
        if any(os.path.basename(word) == PROGRAM.encode("ascii") for word in words) and {b"follow", b"rejoin"} & {
                *words}:
            return pid
    return 0
