"""What must hold at any moment, whatever goes wrong. The first violation ends a simulation."""

import json
import sys
from decimal import Decimal

from roah_rsbb.box.journal import ZONE_STATE
from roah_rsbb.core.runs.run import Run
from roah_rsbb.model.records import Phase
from roah_rsbb.model.referee import Refused
from roah_rsbb.model.saved import freeze
from roah_rsbb.protocol import RobotState, wire_ns
from roah_rsbb.rulebook.benchmarks import Durable

# Within this time on a good network, a robot obeys a STOP, or the box says that it does not.
STOP_S = 3.0
LOOK_S = 0.25
STANDBY_PORT = 8083
# Two boxes that send to one robot.
BOTH_S = 1.0
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
        self._moving = {}  # since when a robot moves in a run that is over, by robot
        self.corrected = set()  # identities of runs of which entries were withdrawn
        self._ports = {}  # identity of the run, by port
        self._clocks = {}  # (true time, elapsed seconds, whether they count), by identity and start of a run
        self.clock_was_set = False  # the box's

        self._sent = {}  # when a box sent last to robots, by its host
        self._both_since = None
        self._is_other = False  # whether another box took over

    def begin(self):
        """Begin to look."""
        self._world.air.watchers.append(self._on_datagram)
        self._look()

    # -- two boxes ----------------------------------------------------------------------------------

    def taken_over(self):
        """A standby takes over."""
        self._is_other = True
        self._clocks.clear()
        self._ports.clear()
        world = self._world
        if world.config.durable is not Durable.TWO:  # then a confirmed entry may be on one computer only
            world.referee.confirmed.clear()
            world.referee.signed.clear()
            self.corrected.update(name.identity for name, _ in world.referee.marks.values())

    def _on_datagram(self, source, port, _datagram, _host):
        if self._is_other and port != STANDBY_PORT and source in self._hosts():
            self._sent[source] = self._world.scheduler.now

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

    def refused(self, what, refused):
        """A command was refused."""
        if not refused.reasons or not all(refused.reasons):
            self.fail("refusal without a reason", what)

    def after_call(self, box, core):
        """A referee's call was carried out."""
        if box.core is core:  # the power did not fail meanwhile
            self._check_runs(box, core)

    # -- marks --------------------------------------------------------------------------------------

    def confirmed(self, number):
        """A referee got the answer that a mark is saved."""
        box = self._world.box
        if box.core is not None:
            self._check_mark(box.core, number)

    def _check_marks(self, core):
        for number in self._world.referee.confirmed:
            self._check_mark(core, number)
        signed = {record.identity for record in core.box.scores.records(core.now()) if record.sign_off is not None}
        for identity in self._world.referee.signed - signed:
            self.fail("confirmed entry is missing", f"the sign-off of {identity}")

    def _check_mark(self, core, number):
        name = self._world.referee.confirmed[number]
        try:
            record = core.box.scores.record_of(core.now(), name)
        except Refused as refused:
            self.fail("confirmed entry is missing", f"mark {number}: {refused}")
            return
        count = sum(line.endswith(f" {number}") for line in record.marks.splitlines())
        if count != 1:
            self.fail("confirmed entry is missing" if not count else "entry is doubled", f"mark {number} of {name}")

    def _check_sums(self, core, record):
        """Items that are only added to: the sum of what was confirmed, and of what may have arrived."""
        referee = self._world.referee
        if record.identity in self.corrected:
            return
        for item in record.items:
            sure = possible = 0
            for number, (name, mark) in referee.marks.items():
                if name.identity != record.identity or (mark.group, mark.desc) != (item.group, item.desc):
                    continue
                if not mark.added:
                    break
                possible += int(mark.added)
                sure += int(mark.added) if number in referee.confirmed else 0
            else:
                if not sure <= item.value <= possible:
                    self.fail("sum of marks", f"{item.desc} of {record.identity} is {item.value}, and {sure} to "
                                              f"{possible} were added")

    # -- restarts -----------------------------------------------------------------------------------

    def killed(self, box, power):
        """A core was killed."""
        core = box.core
        self._before.pop(box, None)
        if core is not None and box.storage.is_in_trouble:
            kept = core.store.saved if power else core.store.committed
            if kept < core.journal._ticket:
                self._clocks.clear()  # a pause may be lost, however long it was
        if core is None or power or core.store.committed < core.journal._ticket or core.box.is_superseded:
            return
        self._before[box] = {zone.name: _lasting(freeze(zone.saved())) for zone in core.box.zones.values()}

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
        if box is not self._world.box:
            return
        for kind in [key for key in self._acknowledged if key[0] is box]:
            del self._acknowledged[kind]
        self._check_marks(core)
        self._check_runs(box, core)

    # -- the truth about robots ---------------------------------------------------------------------

    def _look(self):
        world = self._world
        world.scheduler.after(LOOK_S, self._look)
        core = world.box.core
        if core is None:
            self._both_since = None
            return
        self._check_runs(world.box, core)
        self._check_two_boxes()
        for robot in world.robots:
            self._check_stopped(robot, core)

    def _check_stopped(self, robot, core):
        """A robot that moves in a run that is over is not shown as stopped, or as silent. One that still follows a
        box from which another took over is silent."""
        link, now = robot.link, self._world.scheduler.now
        run = None if link is None else core.box.zones.run_at(link.port)
        is_wrong = (
            run is not None and run.phase is not Phase.RUNNING and robot.state is not RobotState.STOP
            and robot.is_running and run.robot_state is RobotState.STOP and not run.link.is_silent(core.now())
            and not world_is_bad(self._world, robot))
        if not is_wrong:
            self._moving.pop(robot, None)
        elif now - self._moving.setdefault(robot, now) > STOP_S:
            self.fail("STOP", f"{robot.name} is in {robot.state.name} since {self._moving[robot]:.2f}, its run is "
                              "over, and the box shows STOP")

    # -- runs ---------------------------------------------------------------------------------------

    def _check_runs(self, box, core):
        now = core.now()
        if box is not self._world.box:
            return  # another one took over
        for zone in core.box.zones.values():
            run = zone.run
            if run is None:
                continue
            record = run.record(now)
            self._check_points(record)
            self._check_sums(core, record)
            self._check_clock(run, record)
            for member in run.members():
                if self._ports.setdefault(member.port, record.identity) != record.identity:
                    self.fail("port", f"{member.port} was used by {self._ports[member.port]} and {record.identity}")
                if isinstance(member, Run):
                    self._check_acknowledgement(box, member)

    def _check_clock(self, run, record):
        """The time of a running run passes as the true time, also during a restart, and does not pass its limit."""
        key, now = (record.identity, record.started_utc), self._world.scheduler.now
        counts = run.phase is Phase.RUNNING and not run.times.state.paused
        before = self._clocks.get(key)
        self._clocks[key] = now, record.elapsed_s, counts
        if before is None or not counts or not before[2]:
            return
        passed, counted = now - before[0], record.elapsed_s - before[1]
        if abs(passed - counted) > CLOCK_S and not self.clock_was_set:
            self.fail("clock", f"in {record.identity}, {counted:.3f} s were counted of {passed:.3f} s")
        if record.elapsed_s > run.event.benchmark.total_timeout + CLOCK_S:
            self.fail("timeout", f"{record.identity} runs since {record.elapsed_s:.1f} s")

    def _check_points(self, record):
        if record.points is None:
            return
        total = sum((Decimal(item.points) for item in record.items if item.points), Decimal(0))
        if total != Decimal(record.points.total):
            self.fail("points", f"{record.identity}: the items give {total}, the sheet {record.points.total}")
        for item in record.items:
            value = 0
            for entry in record.history:
                if (entry.group, entry.desc) == (item.group, item.desc) and not entry.withdrawn_utc:
                    value = value + int(entry.added) if entry.added else entry.value
            if value != item.value:
                self.fail("points", f"{record.identity}: {item.desc} is {item.value}, its history gives {value}")

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
        self._check_marks(core)
        for record in core.box.scores.records(core.now()):
            self._check_points(record)
            self._check_sums(core, record)
        for robot in world.robots:
            link = robot.link
            run = None if link is None else core.box.zones.run_at(link.port)
            if run is not None and run.phase is Phase.ENDED and robot.state is not RobotState.STOP:
                self.fail("STOP", f"{robot.name} is in {robot.state.name} at the end, and its run is over")
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
