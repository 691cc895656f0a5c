"""What goes wrong: a list of troubles, each with its moment, which can be shortened."""

import functools
from typing import NamedTuple, Tuple

from helpers.box_beacon import box_beacon
from roah_rsbb.comm.ciphers import Cipher
from roah_rsbb.comm.frame import encode
from roah_rsbb.model.records import Phase
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.protocol import RobotState

from .air import PUBLIC_PORT
from .ledger import DURABLE, members

STRANGER = "10.0.0.99"
# The shortest limit of a run.
SHORT_S = 10.0


class Trouble(NamedTuple):
    """Something that goes wrong."""

    at: float  # true time (s)
    kind: str
    values: Tuple = ()

    def __str__(self):
        return f"{self.at:.3f} {self.kind} {' '.join(map(str, self.values))}"


def plan_of(world, random):
    """Return the troubles of a seed."""
    count = random.choice((0, 2, 5, 8, 12)) * max(1, round(world.length_s / 60.0))
    known = random.choice((sorted(KINDS), DISK, DISK, NETWORK))
    if world.standby is None:
        known = [kind for kind in known if kind not in OF_STANDBY]
    elif random.random() < 0.7:
        known = sorted({*OF_STANDBY, LOST, *random.sample(sorted(KINDS), 4)})
    kinds = random.sample(known, random.randint(2, 5))
    plan = [Trouble(random.uniform(1.0, world.length_s), kind, KINDS[kind](world, random))
            for kind in random.choices(kinds, k=count)]
    if world.standby is not None and random.random() < 0.6:
        plan.append(Trouble(random.uniform(6.0, world.length_s), "take over", KINDS["take over"](world, random)))
    if random.random() < 0.53:
        kind = random.choice(AWAITED)
        plan.append(Trouble(random.uniform(1.0, 10.0), kind, KINDS[kind](world, random)))
    return sorted(plan)


def _host(world, random):
    others = [world.box.computer, *([world.standby.computer] if world.standby is not None else [])]
    return random.choice([each.host for each in (*(robot.computer for robot in world.robots), *others)])


def _robot(world, random):
    return random.randrange(len(world.robots))


# How a box is lost. While its computer sleeps, it receives nothing.
WAYS = "box burns", "box is cut off", "box sleeps", "box's computer sleeps", ""
LOST = "stopped while frozen, then lost"
# What is drawn for each kind.
KINDS = {
    "loss": lambda w, r: (_host(w, r), r.choice((0.1, 0.3, 0.6)), r.uniform(1.0, 15.0)),
    "late": lambda w, r: (_host(w, r), r.choice((0.05, 0.3)), r.choice((0.05, 0.5, 3.0)), r.uniform(1.0, 15.0)),
    "double": lambda w, r: (_host(w, r), r.choice((0.1, 0.5)), r.uniform(1.0, 15.0)),
    "cut off": lambda w, r: (_host(w, r), r.choice((0.5, 2.0, 6.0, 12.0))),
    "take over": lambda w, r: (r.choice(WAYS), r.uniform(0.0, 6.0)),
    "standby restarts": lambda w, r: (),
    "standby hangs": lambda w, r: (r.choice((0.3, 1.0, 4.0)),),
    "kill": lambda w, r: (r.uniform(0.3, 3.0),),
    "kill, then kill": lambda w, r: (r.uniform(0.3, 1.0), r.uniform(0.3, 2.5)),
    "hang": lambda w, r: (r.choice((0.2, 1.0, 3.0)),),
    "power": lambda w, r: (r.uniform(2.0, 6.0),),
    "kill, then power": lambda w, r: (r.uniform(0.05, 1.0), r.uniform(2.0, 5.0)),
    "kill at an entry": lambda w, r: (r.uniform(0.3, 2.0),),
    "power at an entry": lambda w, r: (r.uniform(2.0, 4.0),),
    "slow disk": lambda w, r: (r.choice((0.5, 1.5, 4.0)), r.uniform(1.0, 10.0)),
    "slow disk, then power": lambda w, r: (r.choice((0.3, 1.0)), r.uniform(0.3, 2.5), r.uniform(2.0, 4.0)),
    "broken disk": lambda w, r: (r.uniform(0.5, 8.0),),
    "frozen disk": lambda w, r: (r.choice((0.3, 1.0, 4.0)),),
    LOST: lambda w, r: (r.random() < 0.5, r.random() < 0.7, r.uniform(0.1, 3.0)),
    "full disk": lambda w, r: (r.uniform(0.5, 8.0),),
    "box's clock": lambda w, r: (r.choice((-3600.0, -1.0, -0.2, 0.2, 1.0, 3600.0)),),
    "hang at a limit": lambda w, r: (_robot(w, r), r.uniform(0.3, 2.0)),
    "left out": lambda w, r: (_robot(w, r), r.uniform(0.5, 3.0)),
    "robot's clock": lambda w, r: (_robot(w, r), r.choice((-10.0, -0.5, 0.05, 10.0))),
    "robot crashes": lambda w, r: (_robot(w, r), r.uniform(0.5, 5.0)),
    "robot hangs": lambda w, r: (_robot(w, r), r.choice((0.5, 3.0, 8.0))),
    "replay": lambda w, r: (r.random(), r.choice((1, 1, 20)), r.choice(("same", STRANGER))),
    "garbage": lambda w, r: (_host(w, r), r.randrange(1 << 32)),
    "forged beacon": lambda w, r: (_robot(w, r), r.choice(("same", STRANGER)), r.choice((-5.0, 0.0, 5.0))),
    "forged box": lambda w, r: (),
    "old box restarts": lambda w, r: (r.uniform(0.3, 3.0), r.random() < 0.5),
    "relay": lambda w, r: (_robot(w, r), r.uniform(3.0, 12.0)),
    "attack": lambda w, r: (_robot(w, r), r.choice((0.0, 3.0, 6.0)), r.choice(("same", STRANGER))),
    "attack after a loss": lambda w, r: (_robot(w, r), r.choice(("same", STRANGER))),
}


DISK = ("kill", "kill at an entry", "kill, then kill", "kill, then power", "power", "power at an entry", "slow disk",
        "slow disk, then power", "broken disk", "frozen disk", LOST, "full disk", "hang")
# These wait for a moment at which they make a difference, to which the referee leads a zone for most of them.
AWAITED = "hang at a limit", "left out", LOST, "attack after a loss"
OF_STANDBY = ("standby hangs", "standby restarts", "take over", "cut off", "old box restarts")
NETWORK = ("loss", "late", "double", "cut off", "kill", "attack", "attack after a loss", "replay", "relay", "garbage",
           "forged beacon", "robot crashes", "robot hangs", "robot's clock", "hang at a limit", "left out")
# How often a referee leads a zone for a trouble.
MOST_LED = 40


class Troubles:
    """Lets troubles happen to a world."""

    def __init__(self, world, random):
        self._world, self._random = world, random
        self._are_allowed, self._led = True, 0

    def begin(self, trouble):
        """A trouble begins, and ends by itself."""
        self._world.trace.note(f"trouble: {str(trouble).split(' ', 1)[1]}")
        getattr(self, "_" + "".join(c if c.isalpha() else "_" for c in trouble.kind))(*trouble.values)

    def end_all(self):
        """Everything works from now on."""
        world, self._are_allowed = self._world, False
        for weather in world.air.weather.values():
            weather.loss = weather.late = weather.double = 0.0
            weather.is_cut = False
        world.storage.end_troubles()
        world.referee.then.clear()
        world.air.relays.clear()

    def _for(self, seconds, host, **changes):
        weather = self._world.air.weather[host]
        usual = {"loss": 0.0, "late": 0.0, "double": 0.0, "longest_s": 0.5, "is_cut": False}
        for name, value in changes.items():
            setattr(weather, name, value)
        self._world.scheduler.after(seconds, lambda: [setattr(weather, name, usual[name]) for name in changes])

    def _loss(self, host, share, seconds):
        self._for(seconds, host, loss=share)

    def _late(self, host, share, longest_s, seconds):
        self._for(seconds, host, late=share, longest_s=longest_s)

    def _double(self, host, share, seconds):
        self._for(seconds, host, double=share)

    def _cut_off(self, host, seconds):
        self._for(seconds, host, is_cut=True)

    def _kill(self, restart_s):
        self._world.box.kill(restart_s)

    def _kill__then_kill(self, restart_s, again_s):
        self._world.box.kill(restart_s)
        self._world.scheduler.after(again_s, lambda: self._world.box.kill(restart_s))

    def _hang(self, seconds):
        if self._world.box.process is not None:
            self._world.box.process.hang(seconds)

    def _power(self, restart_s):
        self._world.box.kill(restart_s, power=True)

    def _kill__then_power(self, after_s, restart_s):
        self._world.box.kill(60.0)
        self._world.scheduler.after(after_s, lambda: self._world.box.kill(restart_s, power=True))

    def _kill_at_an_entry(self, restart_s):
        self._after(DURABLE, lambda: self._world.box.kill(restart_s))

    def _power_at_an_entry(self, restart_s):
        self._after(DURABLE, lambda: self._world.box.kill(restart_s, power=True))

    def _after(self, commands, function, longest_s=0.1):
        """Let something happen soon after the next one of these commands."""
        self._world.referee.then.append((commands, function, longest_s))

    def _hang_at_a_limit(self, number, before_s):
        """A robot completes its task just in time, and the box does nothing from then on, until the time is over."""
        robot = self._world.robots[number]
        robot.complete_after(SHORT_S - before_s)
        robot.crash(0.1)
        self._hang_when_completed(number)

    def _hang_when_completed(self, number):
        world, now, robot = self._world, self._world.scheduler.now, self._world.robots[number]
        believed = None if robot.link is None else world.witness.runs_at.get(robot.link.port)
        if believed is None or believed.phase is not Phase.RUNNING or robot.state is not RobotState.EXECUTING:
            completes = limit = now
        else:
            completes = world.witness.reports[robot.link.port][-1][0] + robot.executes_s
            limit = now + believed.event.benchmark.total_timeout - believed.watch.read(now)
        if now < completes and 0.15 < limit - completes < 2.5:
            world.referee.rests_until = limit + 0.5
            world.scheduler.after(completes - now, functools.partial(self._hang, limit - completes + 0.2))
        else:
            self._later(self._hang_when_completed, number, suits=lambda event: (
                event.team == robot.team and event.benchmark.total_timeout == SHORT_S))

    def _left_out(self, number, seconds):
        """A run of all robots starts without one, is stopped, and then that robot is there again."""
        world, robot = self._world, self._world.robots[number]
        core, believed = world.box.core, None if robot.link is None else world.witness.runs_at.get(robot.link.port)
        if core is None or believed is None or believed.phase is not Phase.CONNECTED or believed.event.team != "ALL":
            self._later(self._left_out, number, seconds, suits=lambda event: event.team == "ALL")
            return
        world.referee.rests_until = world.scheduler.now + 7.0 + seconds
        robot.hang(5.0 + seconds)
        for at, command in ((3.6, "start"), (4.5, "stop")):
            world.scheduler.after(at, functools.partial(self._press, core, believed.zone, command))

    def _press(self, core, zone, command):
        """A referee presses a button."""
        if self._world.box.core is core and self._are_allowed:
            self._world.referee._command(zone, command)

    def _stopped_while_frozen__then_lost(self, is_again, is_burnt, seconds):
        """A run is stopped while the disk takes nothing, perhaps once more, and the box is lost after that."""
        world, box = self._world, self._world.box
        core = None if box.process.is_ended else box.core
        runs = [] if core is None else core.box.zones.runs()
        running = [run for run in runs if run.phase is Phase.RUNNING and members(run)]
        if not running:
            self._later(self._stopped_while_frozen__then_lost, is_again, is_burnt, seconds)
            return
        press = functools.partial(self._press, core, running[0].zone)

        def lose():
            if is_burnt and world.standby is not None and not world.standby.has_taken_over:
                self._burn(box)
            elif box is world.box:
                box.kill(0.5)
            box.storage.end_troubles()
        begin = 2.0 if is_again else 0.0
        world.referee.rests_until = world.scheduler.now + begin + 0.3 + seconds
        for at, act in ((0.0, lambda: is_again and press("stop")), (1.0, lambda: is_again and press("start")),
                        (begin, lambda: self._frozen_disk(seconds + 0.4)), (begin + 0.2, lambda: press("stop")),
                        (begin + 0.3 + seconds, lose)):
            world.scheduler.after(at, act)

    def _later(self, method, *values, suits=lambda event: event.team != "ALL"):
        """Begin a trouble again soon: now it makes no difference. The referee leads a zone to an event that suits it;
        None: to none."""
        world, core = self._world, self._world.box.core
        if not self._are_allowed:
            return
        world.scheduler.after(0.5, lambda: method(*values))
        if core is None or suits is None:
            return
        zones = [zone for zone in core.box.zones.values() if any(map(suits, zone.planned))]
        self._led += 1
        if not zones or self._led > MOST_LED:
            return
        zone, run = zones[0], zones[0].run
        world.referee.rests_until = max(world.referee.rests_until, world.scheduler.now + 0.6)
        if run is None:
            self._press(core, zone.name, "connect" if suits(zone.event) else self._random.choice(("next", "previous")))
        elif run.phase is Phase.CONNECTED and not (suits(run.event) and method == self._left_out):
            self._press(core, zone.name, "start" if suits(run.event) else "disconnect")
        elif run.phase is Phase.ENDED:
            self._press(core, zone.name, "disconnect")

    def _take_over(self, how, seconds):
        """The box is lost, and its standby takes over as soon as that is possible."""
        world, box = self._world, self._world.boxes[0]
        if world.standby is None or world.standby.has_taken_over:
            return
        if how == "box burns":
            self._after(DURABLE, lambda: self._burn(box))
        elif how in ("box is cut off", "box's computer sleeps"):
            self._cut_off(box.computer.host, 4.0 + seconds)
        if "sleeps" in how:
            for process in (box.process, box.backup.process):
                if process is not None:
                    process.hang(4.0 + seconds)
        self._try_to_take_over()

    def _burn(self, box):
        if box is self._world.box:
            box.kill(float("inf"), power=True)
            self._try_to_take_over()

    def _try_to_take_over(self):
        for again in range(8):
            self._world.scheduler.after(3.0 + again * 0.5, self._if_lost)

    def _if_lost(self):
        if not self._world.standby.has_taken_over:
            self._world.standby.take_over()

    def _standby_restarts(self):
        if self._world.standby is not None:
            self._world.standby.restart()

    def _standby_hangs(self, seconds):
        if self._world.standby is not None and not self._world.standby.has_taken_over:
            self._world.standby.hang(seconds)

    def _slow_disk(self, slow_s, seconds):
        self._world.storage.fail(seconds, slow_until=True)
        self._world.storage.slow_s = slow_s

    def _slow_disk__then_power(self, slow_s, after_s, restart_s):
        self._slow_disk(slow_s, after_s)
        self._world.scheduler.after(after_s, lambda: self._world.box.kill(restart_s, power=True))

    def _broken_disk(self, seconds):
        self._world.storage.fail(seconds, broken_until=True)

    def _frozen_disk(self, seconds):
        self._world.storage.fail(seconds, frozen_until=True)

    def _full_disk(self, seconds):
        self._world.storage.fail(seconds, full_until=True)

    def _box_s_clock(self, seconds):
        self._world.oracles.clock_was_set = True
        self._world.box.computer.set_clock(seconds)

    def _robot_s_clock(self, number, seconds):
        robot = self._world.robots[number]
        self._world.clocks_were_set.add(robot.name)
        robot.computer.set_clock(seconds)

    def _robot_crashes(self, number, restart_s):
        self._world.robots[number].crash(restart_s)

    def _robot_hangs(self, number, seconds):
        self._world.robots[number].hang(seconds)

    def _replay(self, share, count, host):
        """Somebody sends again, one after the other, what was sent at some time since the beginning."""
        air = self._world.air
        begin = int(share * len(air.sent))
        for number, (source, port, datagram, receiver) in enumerate(list(air.sent)[begin:begin + count]):
            self._world.scheduler.after(0.1 * number, functools.partial(
                air.send, source if host == "same" else host, port, datagram, receiver))

    def _relay(self, number, seconds):
        """Somebody sends what a robot sends in a run again, from elsewhere, and is faster."""
        world, robot = self._world, self._world.robots[number]
        if self._is_heard(number):
            key = robot.computer.host, robot.link.port
            world.air.relays[key] = STRANGER
            world.scheduler.after(seconds, lambda: world.air.relays.pop(key, None))
        else:
            self._later(self._relay, number, seconds, suits=None)

    def _is_heard(self, number):
        """Whether a robot is in a run, and the box hears it for some time."""
        link = self._world.robots[number].link
        return link is not None and self._world.witness.is_heard(link.port)

    def _attack(self, number, silent_s, host):
        """Somebody sends again what the box has taken from a robot in all its runs, at its present channel, perhaps
        while the robot is silent."""
        robot, world = self._world.robots[number], self._world
        link = robot.link
        if link is None:
            return
        robot.hang(silent_s + 6.0 if silent_s else 0.0)
        recorded = world.witness.recorded[robot.computer.host]
        recorded = recorded[:20] + recorded[-20:]
        for at, datagram in enumerate(recorded):
            world.scheduler.after(silent_s + 0.1 * at, functools.partial(
                world.air.send, robot.computer.host if host == "same" else host, link.port, datagram,
                world.box.computer.host))

    def _attack_after_a_loss(self, number, host):
        """The same after a restart of the box, as soon as the robot is heard in a run."""
        if self._is_heard(number):
            self._world.box.kill(0.5)
            self._attack(number, 3.5, host)
        else:
            self._later(self._attack_after_a_loss, number, host, suits=None)

    def _old_box_restarts(self, restart_s, is_alone):
        """The box from which a standby took over starts again, perhaps where it hears nobody."""
        box, world = self._world.boxes[0], self._world
        if box is not world.box and not box.is_lost:
            if is_alone:
                self._cut_off(box.computer.host, restart_s + 3.0)
            box.kill(restart_s)

    def _garbage(self, host, number):
        sent = self._world.air.sent
        if sent:
            _, port, datagram, _ = sent[number % len(sent)]
            broken = bytearray(datagram)
            broken[number % len(broken)] ^= 1 + number % 255
            self._world.air.send(STRANGER, port, bytes(broken), host)

    def _forged_beacon(self, number, host, skew):
        robot, world = self._world.robots[number], self._world
        utc = robot.computer.utc() + skew
        message = pb.RobotBeacon(team_name=robot.team, robot_name=robot.name,
                                 time=pb.Time(sec=int(utc), nsec=int(utc % 1 * 1e9)))
        world.air.send(robot.computer.host if host == "same" else host, PUBLIC_PORT, encode(message, Cipher.NONE),
                       world.box.computer.host)

    def _forged_box(self):
        self._world.air.send(STRANGER, PUBLIC_PORT, encode(box_beacon()), "10.255.255.255")
