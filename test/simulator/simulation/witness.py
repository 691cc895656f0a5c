"""What robots truly do, and what boxes send them, by what docs/referee.md, protocol.md, standby.md and security.md say.

Robots are seen directly, datagrams of the boxes on the air. Nothing that a box believes is used, but to hold it against
these.
"""

import collections
import contextlib

from roah_rsbb.comm.ciphers import Key
from roah_rsbb.comm.frame import BadDatagram, decode_private
from roah_rsbb.model.records import EndReason, Phase
from roah_rsbb.protocol import BoxState, RobotState

from .air import BROADCAST, PUBLIC_PORT
from .ledger import members

# STOP leaves within this time (s), whatever the disk does.
AT_ONCE_S = 0.01
# A box repeats its state each second, its first one to a tenth of a second early. After a restart it is sent at once.
PERIOD_S, RESUMED_S, UNSURE_S = 1.4, 0.5, 3.0
# Within this time, a robot that hears its box does as it is asked; a client first waits for an old box.
OBEYS_S = 4.0
FOLLOWS_S = 9.0
LOOK_S = 0.25
LATE_S = 3.1  # a datagram comes so late, at most
# A robot moves because of what a box said lately. In the first seconds after a restart, none is asked to prepare.
MOVES_S, HEARS_S = 12.0, 2.0
SAVED_S, SAVES_S = 4.9, 7.0  # how long a robot executes without offline data, before its run is ended
WELL_S = 6.0  # after so long, a box hears a robot where it is
HEARD_S = 0.05
# A robot that says nothing for so long is shown as silent, even if its last datagram was late.
SILENT_S = 4.5 + LATE_S


class Sent:
    """What a robot was sent in a run."""

    def __init__(self):
        self.at = float("-inf")
        self.state = None


class Witness:
    """Watches all robots of a world, and what its boxes send."""

    def __init__(self, world):
        self._world = world
        self._fail = world.oracles.fail
        self._keys = [Key(password) for password in world.config.passwords.values()]
        self._key_of = {}  # by port
        self.reports = collections.defaultdict(list)  # by port: (time, state) of each change that its robot reported
        self.sent = collections.defaultdict(Sent)  # by port
        self.beacon_at = float("-inf")
        self._robots = {}  # by address
        self._heard = collections.defaultdict(float)  # when the robot of a port said something last
        self._early = []  # what a box sent before it has resumed
        self._due = []  # (time, port): a STOP must have left since
        self._well = {}  # since when box and robot hear each other, by robot
        self._seen = {}  # the robot's state that the box shows, by port
        self.runs_at = {}  # the runs by the ports of their robots
        self._did = {}  # what the robot of a port did when the present box heard it first
        self._read = {}  # when the present box has first read something of the robot of a port
        self._go_at = collections.defaultdict(lambda: float("-inf"))  # when a box let the robot of a port move, last
        self.recorded = collections.defaultdict(list)  # what the box has read of a robot in runs, by address
        self._genuine = {}  # by port: when the last datagram of its robot came to the present box's computer
        # By port, of its run since this start: when the robot's result came there, the time counted until then, and
        # whether the box waited for it; the first one, and the first one for which it did.
        self._results = {}
        self._taken = set()  # datagrams that a box has read
        self._unheard = set()  # ports with a recording that no box had read before: it may be new
        self.busy_until = 0.0  # the present box was not running until then
        world.air.watchers.append(self._on_datagram)
        world.air.readers.append(self._on_read)
        world.air.arrived.append(self._on_arrival)

    def lost(self):
        """The box is lost."""
        self._world.air.relays.clear()  # the next one hears first who is faster
        self._read.clear()
        self._did.clear()

    def _on_read(self, host, port, datagram, source, is_forged):
        if host == self._world.box.computer.host and source in self._robots and port in self.runs_at:
            self._read.setdefault(port, self._world.scheduler.now)
            if not is_forged and port not in self._did:
                self._did[port] = RobotState(self._decoded(port, datagram).robot_state)
            self.recorded[source].append(datagram)
            self._taken.add(datagram)

    def _on_arrival(self, host, port, datagram, source, is_forged):
        now = self._world.scheduler.now
        if is_forged and port == PUBLIC_PORT and host in self._robots:
            self._well[self._robots[host]] = now  # somebody pretends to be its box
        if host != self._world.box.computer.host or port not in self.runs_at:
            return
        believed = self.runs_at[port]
        if is_forged and datagram not in self._taken:
            self._unheard.add(port)
        elif not is_forged and source in self._robots:
            self._genuine[port] = now
            is_done = self._robots[source].state is RobotState.RESULT_TX and believed.phase is Phase.RUNNING
            went, found = self._results.get(port, (None, []))
            found = found if went == believed.went else []
            is_awaited = self.sent[port].state is BoxState.WAITING_RESULT
            if is_done and (not found or (is_awaited and not found[-1][2])) and (
                    self._decoded(port, datagram).robot_state == RobotState.RESULT_TX):
                self._results[port] = believed.went, [*found, (now, believed.watch.read(now), is_awaited)]

    def add(self, robot):
        """Watch a robot, too."""
        self._robots[robot.computer.host] = robot
        self._well[robot] = 0.0

    # -- on the air ---------------------------------------------------------------------------------

    def _on_datagram(self, source, port, datagram, host):
        world, now = self._world, self._world.scheduler.now
        if source == world.box.computer.host:
            if port == PUBLIC_PORT:
                self.beacon_at = now
            elif port in self.runs_at:
                self._box_says(port, datagram)
                self._check_address(port, host)
            else:
                self.sent[port].at = now
        elif source in self._robots and port != PUBLIC_PORT:
            state, reports = self._robots[source].state, self.reports[port]
            self._heard[port] = now
            if not reports or reports[-1][1] is not state:
                reports.append((now, state))
                # One that hung reads what waited for it.
                moved = max(self._go_at[port], self._well[self._robots[source]])
                if reports[-2:-1] == [(reports[-2:][0][0], RobotState.STOP)] and now - moved > MOVES_S:
                    self._fail("robot moves", f"that of port {port} leaves STOP, and nothing asked it to")

    def _box_says(self, port, datagram):
        believed, now = self.runs_at[port], self._world.scheduler.now
        message = self._decoded(port, datagram)
        state, sent = BoxState(message.benchmark_state), self.sent[port]
        self._go_at[port] = self._go_at[port] if state is BoxState.STOP else now
        if state is BoxState.STOP:
            self._due = [due for due in self._due if due[1] != port]
        else:
            self._check_go(port, believed, state)
        sent.at, sent.state = now, state

    def _check_address(self, port, host):
        """Another sender does not count while the robot is heard where it is."""
        robot = self._robot_at(port)
        if robot is not None and host not in (robot.computer.host, BROADCAST) and self.is_heard(port):
            self._fail("address", f"port {port} of {robot.name} is sent to {host}, and it is heard where it is")

    def _decoded(self, port, datagram):
        for key in sorted(self._keys, key=lambda key: key is not self._key_of.get(port)):
            with contextlib.suppress(BadDatagram):
                message, self._key_of[port] = decode_private(datagram, key), key
                return message
        raise AssertionError("a box sends with the key of a team")

    def _check_go(self, port, believed, state):
        """A robot is only asked to move in a run in progress. After a restart of the box, one that reports STOP is not
        asked to before a referee says so."""
        world, now = self._world, self._world.scheduler.now
        if world.ledger.lets_go(believed):
            return
        if world.box.core is None:  # what it has resumed is not known yet
            self._early.append((port, believed, state, self._is_stopped(port)))
            return
        reports = self.reports[port]
        if believed.reason is EndReason.COMPLETED and reports and reports[-1][1] is RobotState.RESULT_TX:
            return  # it does not move, and the STOP that takes its result waits for the disk
        if believed.phase is not Phase.RUNNING or believed.is_left:
            self._fail("robot asked to move", f"{state.name} on port {port}, and {believed.identity} is over")
        resumed = world.ledger.resumed
        if believed.went >= resumed:
            return
        is_stopped = self._is_stopped(port)
        why = "the box has not heard it" if port not in self._read else "it reports STOP" if is_stopped else (
            "the box has just begun" if state is BoxState.PREPARE and now - resumed < HEARS_S else "")
        if why:
            self._fail("robot asked to move", f"{state.name} on port {port}: nobody let it go since, and {why}")

    def _is_well(self, port, seconds):
        """Whether a robot and the box hear each other for so long."""
        robot = self._robot_at(port)
        return robot is not None and self._world.scheduler.now - self._well[robot] > seconds

    def _is_stopped(self, port):
        """Whether a robot is in STOP, and its box must know that, or cannot know what it does after a restart."""
        now, reports, robot = self._world.scheduler.now, self.reports[port], self._robot_at(port)
        if robot is None or robot.state is not RobotState.STOP or not reports:
            return False
        since, resumed = reports[-1][0], self._world.ledger.resumed
        return since < resumed - LATE_S or now - max(since, self._well[robot]) > 1.5

    def resumed(self):
        """The next box has resumed."""
        early, self._early = self._early, []
        for port, believed, state, is_stopped in early:
            if is_stopped:
                self._fail("robot asked to move", f"that of port {port} reports STOP, and after a restart it is sent "
                                                 f"{state.name}")
            self._check_go(port, believed, state)

    def says(self, port, since):
        """The states that the robot of a port reported since a time, or shortly before, and its last one."""
        reports = self.reports[port]
        ends = [at for at, _ in reports[1:]] + [float("inf")]
        return [state for (_, state), end in zip(reports, ends) if end > since - LATE_S]

    def silent_s(self, port):
        """For how long the robot of a port has said nothing to the present box."""
        return self._world.scheduler.now - max(self._heard[port], self._world.ledger.resumed)

    def was_sent(self, port, identity):
        """Whether a box has said something to the robot of this run."""
        return self.sent[port].at >= self._world.ledger.runs[identity].now

    def _robot_at(self, port):
        return next((robot for robot in self._world.robots if robot.link is not None and robot.link.port == port), None)

    # -- events of runs -----------------------------------------------------------------------------

    def stops(self, run):
        """A run in progress was ended just now: STOP leaves at once."""
        now = self._world.scheduler.now
        for member in members(run):
            if member.robot_state is not None and self.sent[member.port].state is not BoxState.STOP:
                self._due.append((now, member.port))

    def is_unseen(self, run, went):
        """Whether a robot that a referee let go then may have completed its task while the box was away."""
        return went < self._world.ledger.resumed and any(
            self._did.get(member.port) is not RobotState.EXECUTING for member in members(run))

    def is_counted(self, run):
        """Whether a robot had completed its task before the box heard it again: then this time is not counted."""
        return [self._did.get(member.port) for member in members(run)] == [RobotState.RESULT_TX]

    def results(self, run, believed):
        """For each result of a robot that has come to the present box: the time that was counted then, and whether the
        box waited for it."""
        found = [self._results.get(member.port, (None, [])) for member in members(run)]
        return [(counted, is_awaited) for went, came in found for at, counted, is_awaited in came
                if went == believed.went and at > self._world.ledger.resumed]

    def has_saved_nothing(self, run, went):
        """Whether a robot of a run has executed for so long that it must have saved offline data, since a referee let
        it go."""
        now = self._world.scheduler.now
        return any(state is RobotState.EXECUTING and went < at < now - SAVED_S
                   for member in members(run) for at, state in self.reports[member.port])

    def is_heard(self, port):
        """Whether the present box hears a robot for some time, whatever others send."""
        now, robot, resumed = self._world.scheduler.now, self._robot_at(port), self._world.ledger.resumed
        return (self._is_well(port, WELL_S) and now - max(resumed, self.busy_until) > WELL_S and robot.is_running
                and now - self._genuine.get(port, 0.0) < PERIOD_S and robot.name not in self._world.clocks_were_set)

    def completed(self, run, went):
        """Whether the robots of a run have done what a completed run needs, since a referee let them go."""
        done = [any(state is RobotState.RESULT_TX and at > went for at, state in self.reports[member.port])
                for member in members(run) if member.robot_state is not None]
        return any(done) if run.event.team == "ALL" else all(done)

    # -- now and then -------------------------------------------------------------------------------

    def look(self, core):
        """Look at all robots."""
        world, now = self._world, self._world.scheduler.now
        box, ledger = world.box, world.ledger
        is_busy = box.process.is_busy(now)
        if is_busy:
            self.busy_until = now
        for at, port in self._due:
            if now > at + AT_ONCE_S and not is_busy:
                self._fail("STOP", f"none was sent to port {port} when its run ended")
        has_runs = False
        for zone in core.box.zones.values():
            if zone.run is not None:
                believed = ledger.runs[zone.run.identity]
                for member in members(zone.run):
                    self.runs_at[member.port], has_runs = believed, True
                    if not is_busy:
                        self._check_member(core, zone, member, believed, now)
        for robot in world.robots:
            if not robot.is_running or not self._hear_each_other(robot):
                # When it is silent, the box may follow somebody who relays it.
                lasts_s = FOLLOWS_S if self._is_relayed(robot) else 0.0
                self._well[robot] = max(now + lasts_s, self._well[robot])
            if not is_busy:
                self._check_robot(robot, now)
        is_due = has_runs and not is_busy and now > self.busy_until + PERIOD_S and now - ledger.resumed > PERIOD_S
        if is_due and now - self.beacon_at > PERIOD_S and not core.box.authority.is_superseded:
            self._fail("beacon", f"there is none since {self.beacon_at:.2f}")

    def _is_relayed(self, robot):
        return robot.computer.host in [host for host, _ in self._world.air.relays]

    def _hear_each_other(self, robot):
        world = self._world
        weathers = [world.air.weather[host] for host in (robot.computer.host, world.box.computer.host)]
        loses = self._is_relayed(robot) and any(weather.loss for weather in weathers)
        is_good = all(weather.is_good and not weather.late for weather in weathers) and not loses
        return is_good and not world.box.process.is_busy(world.scheduler.now)

    def _check_member(self, core, zone, member, believed, now):
        world, port, sent = self._world, member.port, self.sent[member.port]
        self._check_heard(member)
        seen = member.robot_state
        is_new = seen is not None and seen is not self._seen.get(port) and not core.box.authority.is_superseded
        if is_new and now - self._world.ledger.resumed > 2 * LOOK_S:
            self._check_seen(port, seen, now)
        self._seen[port] = seen
        if core.box.authority.is_superseded or seen is None:
            return
        resumed, most = self._world.ledger.resumed, RESUMED_S
        if believed.phase is Phase.RUNNING and believed.went < resumed:  # the box first hears what the robot does
            robot = self._robot_at(port)
            is_heard = now - self._read.get(port, now) > UNSURE_S and self._is_well(port, UNSURE_S)
            most = UNSURE_S if is_heard and robot.name not in world.clocks_were_set else float("inf")
        if now - sent.at > PERIOD_S and now - max(resumed, self.busy_until, world.storage.frozen_until) > most:
            self._fail("nothing is sent", f"nothing was sent to port {port} since {sent.at:.2f}")

    def _check_heard(self, member):
        """A recording that is sent again changes nothing."""
        heard, port, world = member.link.last_heard, member.port, self._world
        if heard is None or port in self._unheard or world.oracles.clock_was_set:
            return
        at, came = world.box.computer.true_time(heard.mono), self._genuine.get(port, 0.0)
        if at > max(came, world.ledger.resumed) + HEARD_S and member.robot.robot not in world.clocks_were_set:
            self._fail("recording", f"the box heard that of port {port} at {at:.2f}, and its last datagram came at "
                                    f"{came:.2f}")

    def _check_seen(self, port, seen, now):
        """What the box shows of a robot was said by it, in this run, not long ago."""
        resumed_s = now - self._world.ledger.resumed
        latest = LATE_S + (resumed_s if resumed_s < 2.0 else 0.0)
        latest += max(0.0, self.busy_until + 0.5 - now) and 12.0
        reports, until = self.reports[port], None
        for at, state in reversed(reports):
            if state is seen and (until is None or until > now - latest):
                return
            until = at
        self._fail("robot's state", f"the box shows {seen.name} on port {port}, and the robot said {reports[-3:]}")

    def _check_robot(self, robot, now):
        """A robot that hears its box does as its referee was answered."""
        link = robot.link
        believed = None if link is None else self.runs_at.get(link.port)
        if believed is None or not robot.is_running:
            return
        finds_s = FOLLOWS_S if len(self._world.boxes) > 1 else 0.0  # the other box, when it has lost the old one
        since = max(believed.changed, self._well[robot] + finds_s, self._world.ledger.resumed + FOLLOWS_S,
                    self.busy_until)
        # Only STOP never waits for the disk.
        if believed.phase is Phase.RUNNING or believed.reason is EndReason.COMPLETED:
            since = max(since, self._world.storage.frozen_until)
        if now - since < OBEYS_S:
            return
        is_moving = robot.state is not RobotState.STOP
        if is_moving and believed.phase is not Phase.RUNNING:
            self._fail("robot moves", f"{robot.name} is in {robot.state.name}, and {believed.identity} is over since "
                                      f"{believed.changed:.2f}")
        is_alone = believed.event.team != "ALL" and believed.phase is Phase.RUNNING
        reports = self.reports[link.port]
        has_said = bool(reports) and reports[-1][1] is robot.state and now - reports[-1][0] > OBEYS_S
        is_heard = robot.name not in self._world.clocks_were_set  # a clock that was set back is heard later
        if robot.state is RobotState.RESULT_TX and has_said and is_heard and is_alone:
            self._fail("completed", f"{robot.name} has completed {believed.identity}, which continues")
        must_save = believed.event.benchmark.profile.offline_data
        is_executing = robot.state is RobotState.EXECUTING and bool(reports) and reports[-1][1] is robot.state
        if must_save and not robot.client.messages_saved and is_executing and is_alone and (
                now - max(since, reports[-1][0]) > SAVES_S):
            self._fail("offline data", f"{robot.name} saves none, and {believed.identity} continues")
        if not is_moving and is_alone and not believed.is_doubted:
            self._fail("robot does not start", f"{robot.name} is in STOP, and {believed.identity} runs since "
                                               f"{believed.changed:.2f}")
