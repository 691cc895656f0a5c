"""What must hold at any moment, whatever goes wrong. The first violation ends a simulation."""

import json
import os
import sys

from roah_rsbb.box.journal import ZONE_STATE
from roah_rsbb.core.runs.run import Run
from roah_rsbb.journal import epochs
from roah_rsbb.journal.log_dir import JOURNAL
from roah_rsbb.model.as_json import to_json
from roah_rsbb.protocol import wire_ns
from roah_rsbb.rulebook.benchmarks import Durable

from .witness import LOOK_S

# Within this time on a good network, a robot obeys a STOP, or the box says that it does not.
STOP_S = 3.0
STANDBY_PORT = 8083
# Two boxes that send to one robot.
BOTH_S = 1.0
# Of so many looks, one is close.
CLOSELY = 4
# A box that did not run for so long asks the one that took over, for so long, before it sends anything.
AWAY_S, ASKS_S = 1.6, 1.9
STARTS_S = 0.45  # so does one that starts
# What the loss of the newest records may cost.
CLOCK_S = 0.3


class Violation(Exception):
    """Something happened that must not happen. `name` is the oracle's."""

    def __init__(self, name, text):
        super().__init__(f"{name}: {text}")
        self.name = name


class Oracles:
    """Watches one world."""

    def __init__(self, world):
        self._world = world
        self._before = {}  # what a killed core had written, by computer
        self._acknowledged = {}  # newest time, by computer and port
        self._ports = {}  # identity of the run, by port
        self.clock_was_set = False  # the box's
        self._killed_at = None  # the core, and the next one has not resumed yet
        self._is_other_clock = False  # the clock of another computer, or start of it, counts from now on

        self._looks = 0
        self._superseded = set()  # boxes that know it
        self._resumed_at = {}  # when the present core of a box has resumed
        self._sent = {}  # when a box sent last to robots, by its host
        self._both_since = None
        self._is_other, self._taken_at = False, 0.0  # whether another box took over, and when

    def begin(self):
        """Begin to look."""
        self._world.air.watchers.append(self._on_datagram)
        self._look()

    # -- two boxes ----------------------------------------------------------------------------------

    def taken_over(self):
        """A standby takes over."""
        self._is_other, self._taken_at = True, self._world.scheduler.now
        self._world.witness.lost()
        self._ports.clear()
        self._is_other_clock = True
        self._world.ledger.lost(self._world.standby.copied_until, self._world.config.durable is Durable.TWO,
                                self._world.standby.has_heard, is_taken_over=True)

    def _on_datagram(self, source, port, _datagram, _host):
        if self._is_other and port != STANDBY_PORT and source in self._hosts():
            now = self._sent[source] = self._world.scheduler.now
            process = self._world.boxes[0].process
            # One that has slept before it resumed only starts.
            box = self._world.boxes[0]
            has_run = box.core is not None and self._resumed_at.get(box, now) < process.woke.at
            if source == self._hosts()[0] and process.woke.hung_s > AWAY_S and self._taken_at < process.woke.at and (
                    now < process.woke.at + (ASKS_S if has_run else STARTS_S)):
                self.fail("woken box", f"sends to port {port}, {now - process.woke.at:.2f} s after it woke, and did "
                                       f"not run for {process.woke.hung_s:.1f} s")

    def _hosts(self):
        return [box.computer.host for box in self._world.boxes]

    def _check_two_boxes(self):
        """Two boxes that hear each other do not both send to robots."""
        world, now = self._world, self._world.scheduler.now
        hosts = self._hosts()
        if len(hosts) < 2:
            return
        is_bad = not all(world.air.weather[host].is_good and not world.air.weather[host].late for host in hosts)
        is_bad = is_bad or any(box.process is not None and box.process.is_hanging() for box in world.boxes)
        both = all(now - self._sent.get(host, float("-inf")) < BOTH_S for host in hosts)
        if is_bad or not both:
            self._both_since = None
        elif self._both_since is None:
            self._both_since = now
        elif now - self._both_since > BOTH_S:
            self.fail("two boxes", f"both send to robots since {self._both_since:.2f}")

    def fail(self, name, text):
        """Something must not happen."""
        self._world.trace.note(f"VIOLATION {name}: {text}")
        self._world.scheduler.bugs.append(Violation(name, text))

    # -- steps of a core ----------------------------------------------------------------------------

    def bug(self, text):
        """The core reports an internal error."""
        self.fail("internal error", f"{text}: {sys.exc_info()[1]!r}")

    def happened(self, box):
        """Something happened in a box."""
        if box is self._world.box and box.core is not None:
            self._world.ledger.look(box.core)

    def document(self, box, core, document):
        """A box shows its document."""
        if box is self._world.box:
            self._world.shown.look(core, document)
        if self._world.is_compared and self._world.trace.compared is None:
            self._world.documents.append(repr(document).replace(self._world.folder, ""))

    # -- the disks ----------------------------------------------------------------------------------

    def answers(self, box, act):
        """A referee is answered that an entry is saved: then it is on the disk, and with `durable: two` on both."""
        if not box.storage.has(act.who):
            self.fail("answer before the disk", f"{act.name} of {act.who}")
        standby = self._world.standby
        if self._world.config.durable is Durable.TWO and not self._is_other and not standby.has(act.who):
            self.fail("answer before the standby's disk", f"{act.name} of {act.who}")

    # -- restarts -----------------------------------------------------------------------------------

    def killed(self, box, power):
        """A core was killed."""
        core, now = box.core, self._world.scheduler.now
        self._before.pop(box, None)
        if box is self._world.box:
            self._world.witness.lost()
        if box is self._world.box:
            if core is not None or self._killed_at is None:
                self._killed_at = now
            self._is_other_clock = self._is_other_clock or power
            self._world.ledger.lost(box.storage.kept_until(self._killed_at, power), keeps_stop=lambda at: not power)
        if core is None or power or core.store.committed < core.journal._ticket or core.box.authority.is_superseded:
            return
        self._before[box] = {zone.name: _lasting(to_json(zone.saved())) for zone in core.box.zones.values()}

    def opened(self, box, core):
        """A core has opened the journal that another one left."""
        before = self._before.pop(box, None)
        if before is None:
            return
        found = {name[len(ZONE_STATE):]: _lasting(state)
                 for name, state in core.store.previous.states.items() if name.startswith(ZONE_STATE)}
        for name, state in before.items():
            if name in found and found[name] != json.loads(json.dumps(state)):
                self.fail("state after a restart", f"zone {name}: {_difference(state, found[name])}")

    def resumed(self, box, core):
        """A core continues."""
        self._resumed_at[box] = self._world.scheduler.now
        if box in self._superseded and not core.box.authority.is_superseded:
            self.fail("superseded", f"{box.computer.name} is not any more after its restart")
        if box is not self._world.box:
            return
        for kind in [key for key in self._acknowledged if key[0] is box]:
            del self._acknowledged[kind]
        self._world.ledger.continues(core, self._is_other_clock, self.clock_was_set, self._killed_at)
        self._killed_at, self._is_other_clock = None, False
        # A run that a power failure may take has its port no more.
        self._ports = {port: run for port, run in self._ports.items() if run in self._world.ledger.runs}
        self._world.ledger.check_all(core)
        self._looks = -1  # this one is close
        self._check_runs(box, core)
        self._world.witness.resumed()

    # -- the truth about robots ---------------------------------------------------------------------

    def _look(self):
        world = self._world
        world.scheduler.after(LOOK_S, self._look)
        core = world.box.core
        if world.standby is not None:
            world.standby.look()
        for box in world.boxes:
            if box.core is not None and box.core.box.authority.is_superseded and not box.storage.is_in_trouble and (
                    not box.process.is_busy(world.scheduler.now)):
                self._superseded.add(box)
        if core is None:
            self._both_since = None
            return
        if world.ledger.is_acting:
            return  # what it does is not known yet
        self._check_runs(world.box, core)
        self._check_two_boxes()
        world.witness.look(core)

    # -- runs ---------------------------------------------------------------------------------------

    def _check_runs(self, box, core):
        if box is not self._world.box or box.process.is_busy(self._world.scheduler.now):
            return  # another one took over; or nobody can look at it now, which would take the datagrams that wait
        self._looks += 1
        (self._world.ledger.look if self._looks % CLOSELY else self._world.ledger.look_closely)(core)
        for zone in core.box.zones.values():
            run = zone.run
            for member in () if run is None else run.members():
                if not self._world.witness.was_sent(member.port, run.identity):
                    continue  # nothing has left
                if self._ports.setdefault(member.port, run.identity) != run.identity:
                    self.fail("port", f"{member.port} was used by {self._ports[member.port]} and {run.identity}")
                if isinstance(member, Run):
                    self._check_acknowledgement(box, member)

    def _check_acknowledgement(self, box, run):
        key, time = (box, run.port), wire_ns(run.message.acknowledgement)
        if time < self._acknowledged.get(key, 0) and run.robot.robot not in self._world.clocks_were_set:
            self.fail("acknowledgement", f"that of port {run.port} goes back")
        self._acknowledged[key] = time

    def end(self):
        """At the end, after all troubles are over for a while."""
        world = self._world
        core = world.box.core
        if core is None:
            self.fail("no box", "none runs at the end")
            return
        world.ledger.check_all(core)
        for box in self._superseded:  # it stays so after each restart
            if not epochs.standing_in(os.path.join(box.storage.folder, JOURNAL)).is_superseded:
                self.fail("superseded", f"{box.computer.name} is, and its journal does not say so")
        numbers, holes = world.box.storage.records()
        if holes or numbers != list(range(1, len(numbers) + 1)):
            self.fail("numbers", f"the journal has holes: {holes}")


def world_is_bad(world, robot):
    """Whether datagrams between a robot and the box may not arrive, or nobody runs who reads them."""
    weathers = [world.air.weather[host] for host in (robot.computer.host, world.box.computer.host)]
    return not all(weather.is_good for weather in weathers) or world.box.process.is_hanging()


def _lasting(state):
    """A zone's state without what each datagram changes, which is written with the next change."""
    if isinstance(state, dict):
        return {key: _lasting(value) for key, value in state.items()
                if key not in ("link", "acknowledgement", "message", "robot_state")}
    return [_lasting(value) for value in state] if isinstance(state, (list, tuple)) else state


def _difference(one, other):
    if isinstance(one, dict) and isinstance(other, dict):
        return {key: _difference(one.get(key), other.get(key)) for key in sorted({*one, *other})
                if one.get(key) != other.get(key)}
    return f"{one!r:.200} was written as {other!r:.200}"
