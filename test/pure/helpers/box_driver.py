"""A Box in simulated time, which jumps from deadline to deadline, and robots that report what a test wants."""

from helpers.commands import given_with, mark_with
from helpers.competition import UTC0, competition, id_of
from roah_rsbb.core import effects
from roah_rsbb.core.actions.table import Target
from roah_rsbb.core.box import Box
from roah_rsbb.core.effects import How
from roah_rsbb.core.settings import Settings
from roah_rsbb.core.views import document
from roah_rsbb.core.views.document import Documents
from roah_rsbb.core.views.public import Publicity, PublicResults
from roah_rsbb.model import run_log
from roah_rsbb.model.clock import Now
from roah_rsbb.model.messages import BoxMessage, RobotReport
from roah_rsbb.model.reason import RunName
from roah_rsbb.model.records import Phase
from roah_rsbb.model.run_log import KINDS, LogKind
from roah_rsbb.protocol import BoxState, RobotState
from roah_rsbb.scoring.sheet import Mark

MONO0 = 1000.0


def wire(utc):
    """A UTC time in seconds as a wire time; exact for whole microseconds."""
    return divmod(round(utc * 1_000_000) * 1000, 1_000_000_000)


def beacon_bytes(beacon):
    """About the size of a beacon, for tests that need no protobuf."""
    return 100 + 32 * len(beacon.robots)


class SeenClock:
    """The times of a run at a moment, in seconds."""

    def __init__(self, clock, now):
        self._clock = clock
        self.elapsed, self.counting = clock.spent(now.mono), clock.elapsed.counting
        self.goal_elapsed, self.goal_counting = clock.goal_spent(now.mono), clock.goal_elapsed.counting
        self.setup_elapsed, self.setup_counting = clock.setup_elapsed.at(now.mono), clock.setup_elapsed.counting
        self.phase_elapsed, self.after_stop = clock.phase_elapsed.at(now.mono), clock.after_stop(now.mono)

    def __getattr__(self, name):
        return getattr(self._clock, name)


class SeenZone:
    """A zone (`model.zone.Zone`) as it is seen at a moment: with its texts, and with the times in seconds."""

    def __init__(self, shown, now):
        self.shown = shown
        self.clock, self.timer = SeenClock(shown.clock, now), shown.clock.timer(now.mono)
        self.state = "\n".join(shown.lines)

    def __getattr__(self, name):
        return getattr(self.shown, name)


class BoxDriver:
    """Holds a box, the time, and what came of its effects.

    It begins when the box has listened long enough to connect robots, unless `listening`. All effects are held
    against `EffectRules`.
    """

    def __init__(self, config=None, settings=None, last_port=None, beacon_size=beacon_bytes, listening=False):
        self.settings = settings or Settings()
        self.now = Now(MONO0, UTC0)
        self.box = Box(config or competition(tbm=["HGTKMH"]), self.settings, beacon_size, last_port)
        self.unusable_ports = set()
        self._rules = EffectRules()
        self.effects = []  # all of them, in the order in which they were carried out
        self.channels = {}  # port -> host that is sent to, of channels that are open
        self.states = {}  # port -> messages sent, each as often as it was handed over
        self.bags = {}  # port -> entries (topic, value) of the run's log
        self._begin(listening)

    def _begin(self, listening):
        self.event(self.box.timers.tick)
        if not listening:
            self.run(self.settings.listen_duration)

    # -- time -----------------------------------------------------------------------------------------

    def run(self, seconds):
        """Advance the time, and let the box do what is due."""
        end = self.now.later(seconds)
        for _ in range(10_000):
            deadline = self.box.timers.deadline()
            if deadline is None or deadline > end.mono:
                break
            passed = max(0.0, deadline - self.now.mono)
            self.now = Now(self.now.mono if passed == 0.0 else deadline, self.now.utc + passed)
            self.event(self.box.timers.tick)
        else:
            raise AssertionError("the box wants to be ticked all the time")
        self.now = end
        self.event(self.box.timers.tick)

    def jump(self, seconds):
        """Advance the time without ticks, as on a busy computer."""
        self.now = self.now.later(seconds)

    def set_clock(self, seconds):
        """Somebody sets the box's clock by so many seconds."""
        self.now = self.now._replace(utc=self.now.utc + seconds)

    # -- events ---------------------------------------------------------------------------------------

    def event(self, method, *arguments):
        """Put an event into the box, and carry out its effects."""
        try:
            found = method(self.now, *arguments)
            if isinstance(found, BoxMessage):  # of a report that only repeats the one before, and has no effects
                self._carry_out(effects.SendState(arguments[0], found, How.QUIET))
            return found
        finally:
            todo = self._take_effects()
            while todo:
                for effect in todo:
                    self._carry_out(effect)
                todo = self._take_effects()

    def command(self, command, zone="tbm", **given):
        """The referee presses a button; raises `Refused`. Those that hit a team name the one that is shown."""
        team = self.box.zones[zone].event.team if zone in self.box.zones else ""
        self.event(self.box.act, Target(zone), command, "", {**given_with(command, team), **given})

    def enter(self, entry, run, who="", /, **given):
        """Somebody enters something for a run, as all faces do; raises `Refused`."""
        self.event(self.box.act, Target(run.zone, run.identity), entry, who, given)

    def mark(self, run, mark, who=""):
        """Somebody marks an item; raises `Refused`."""
        self.enter("mark", run, who, **mark_with(mark))

    def choose(self, place, zone="tbm", unsigned=False, who=""):
        """The referee chooses an event of the schedule, by its place in it; raises `Refused`."""
        self.choose_id(id_of(self.box.zones[zone].events[place]), zone, unsigned, who)

    def choose_id(self, event_id, zone="tbm", unsigned=False, who="", team=""):
        """The referee chooses an event of the schedule, by its id; raises `Refused`."""
        given = {"event": event_id, "unsigned": unsigned, "team": team}
        self.event(self.box.act, Target(zone), "choose_event", who, given)

    def score(self, group, desc, value, zone="tbm"):
        """The referee marks a scoring item; raises `Refused`."""
        self.mark(RunName(zone), Mark(group, desc, value))

    def robot(self, team="Alpha", name="r1", host="10.0.0.2", skew=0.0):
        """A robot that was just switched on, and has not said anything yet."""
        return FakeRobot(self, team, name, host, skew)

    def connected(self, zone="tbm", **of_robot):
        """A robot whose beacon was heard, which was connected, and has said STOP."""
        robot = self.robot(**of_robot)
        robot.beacon()
        self.command("connect", zone)
        robot.port = self.run_in(zone).port
        robot.says(RobotState.STOP)
        return robot

    def executing(self, zone="tbm", **of_robot):
        """A robot that was connected and started and now executes its task."""
        robot = self.connected(zone, **of_robot)
        self.command("start", zone)
        robot.executes()
        return robot

    # -- looking --------------------------------------------------------------------------------------

    def run_in(self, zone="tbm"):
        """The run in a zone; None: there is none."""
        return self.box.zones[zone].run

    def view(self, zone="tbm"):
        """The zone as the referee's panels show it."""
        return SeenZone(document.ZoneViews(self.box).look(self.now)[zone], self.now)

    def off(self, command, zone="tbm"):
        """Every reason why a button is off."""
        return self.box.actions.off(self.now, self.box.zones[zone], command)

    def box_state(self, zone="tbm"):
        """The state that the box sends."""
        return self.run_in(zone).message.state

    def taken(self, *kinds):
        """The effects since the last call; of these kinds, if any are named."""
        taken, self.effects = self.effects, []
        return [effect for effect in taken if not kinds or isinstance(effect, kinds)]

    def notices(self, *levels):
        """The texts of the notices since the last call, which forgets all other effects."""
        return [n.text for n in self.taken(effects.Notice) if not levels or n.level in levels]

    def logged(self, port, *topics):
        """Values in a run's log, of these topics."""
        return [value for topic, value in self.bags[port] if topic in topics]

    def _take_effects(self):
        return self.box.outbox.take()

    # -- hands ----------------------------------------------------------------------------------------

    def _carry_out(self, effect):
        self.effects.append(effect)
        self._rules.see(effect)
        if isinstance(effect, effects.OpenChannel):
            if effect.port in self.unusable_ports:
                self.box.arrivals.on_channel_failed(self.now, effect.port, "Address already in use")
            else:
                self.channels[effect.port] = effect.host
        elif isinstance(effect, effects.AimChannel):
            self.channels[effect.port] = effect.host
        elif isinstance(effect, effects.CloseChannel):
            self.channels.pop(effect.port, None)
        elif isinstance(effect, effects.SendState) and effect.port in self.channels:
            self.states.setdefault(effect.port, []).append(effect.message)
        elif isinstance(effect, effects.RunOpened):
            self.bags[effect.port] = []
        elif isinstance(effect, effects.RunResumed):
            self.bags.setdefault(effect.port, [])
        elif isinstance(effect, effects.RunLogged):
            self.bags[effect.port].append((effect.topic, effect.value))


def _fits(kind, value):
    if kind is LogKind.UINT8:
        return type(value) is int and 0 <= value <= 255
    if kind is LogKind.STRING:
        return isinstance(value, str)
    if kind is LogKind.SCORE:
        return [type(part) for part in value] == [str, str, int] and -2**31 <= value[2] < 2**31
    return value is None


class EffectRules:
    """Rules that the effects of a box obey in every test: their order, and what run logs may contain.

    It sees all effects of one box, in their order, and raises AssertionError at the first that breaks a rule. What must
    be on record comes before what leaves the box because of it (docs/architecture.md, "Write first, then act").
    """

    def __init__(self):
        self._taken = set()  # ports on record
        self._opened = set()  # ports of channels
        self._bags = set()  # ports of run logs that are open
        self._resumed = set()  # ports of runs that continue after a restart
        self._ends = set()  # (zone, end reason) on record
        self._last = {}  # (port, topic) -> last value logged

    def see(self, effect):
        name = "_" + type(effect).__name__
        if hasattr(self, name):
            getattr(self, name)(effect)

    def _PortTaken(self, effect):
        assert effect.port not in self._taken, f"port {effect.port} is used twice"
        self._taken.add(effect.port)

    def _OpenChannel(self, effect):
        assert effect.port in self._taken, "a channel is opened before its port is on record"
        self._opened.add(effect.port)

    def _AimChannel(self, effect):
        assert effect.port in self._opened

    def _CloseChannel(self, effect):
        self._opened.remove(effect.port)

    def _RunOpened(self, effect):
        assert effect.port in self._taken
        self._bags.add(effect.port)

    def restart(self):
        """Note that the core was restarted: records stay."""
        self._taken, self._opened, self._bags = set(), set(), set()

    def _RunResumed(self, effect):
        assert effect.port in self._opened, "a run continues without its channel"
        self._bags.add(effect.port)
        self._resumed.add(effect.port)

    def _RunLogged(self, effect):
        assert effect.port in self._bags, "an entry for a run log that is not open"
        assert effect.topic in KINDS, effect.topic
        assert _fits(KINDS[effect.topic], effect.value), effect
        self._last[effect.port, effect.topic] = effect.value

    def _RunClosed(self, effect):
        assert self._last[effect.port, run_log.END] is None
        self._bags.remove(effect.port)

    def _SendState(self, effect):
        if effect.port in self._resumed and (effect.port, run_log.STATE) not in self._last:
            return  # it was on record before the restart
        state = effect.message.state
        topics = (run_log.STATE, run_log.BOX_STATE, run_log.STATE_NAME)
        logged = [self._last.get((effect.port, topic)) for topic in topics]
        assert logged == [state, state, state.name], "a state leaves before it is on record"

    def _SetDevice(self, effect):
        topic = run_log.device_topic(effect.device)
        assert effect.value in [value for (_, known), value in self._last.items() if known == topic]

    def _RecordChanged(self, effect):
        self._ends.add((effect.record.zone, effect.record.end_reason))

    def _TimeoutRung(self, effect):
        assert (effect.zone, "timeout") in self._ends, "the timeout rings before it is on record"


class FakeRobot:
    """A robot that reports what the test wants. Its clock is ahead of the box's by `skew` seconds."""

    def __init__(self, driver, team, name, host, skew):
        self.driver = driver
        self.team = team
        self.name = name
        self.host = host
        self.skew = skew
        self.port = None
        self.saved = 1
        self.state = RobotState.STOP
        self.fields = {}  # what it says in every message
        self.last = None  # the last report

    def time(self):
        """The robot's clock as a wire time."""
        return wire(self.driver.now.utc + self.skew)

    def beacon(self, count=1):
        """Send so many beacons, a second apart; the last one just now."""
        for i in range(count):
            if i:
                self.driver.run(1.0)
            self.driver.event(self.driver.box.arrivals.on_robot_beacon, self.host, self.team, self.name, self.time())

    def report(self, state=None, **fields):
        """Return a report as the robot would send it now."""
        values = {"time": self.time(), "messages_saved": self.saved, "state": self.state if state is None else state}
        return RobotReport(**{**values, **self.fields, **fields})

    def send(self, report):
        """Send this very report (again), on the private channel."""
        self.driver.event(self.driver.box.arrivals.on_robot_report, self.port, self.host, report)

    def says(self, state=None, after=0.001, **fields):
        """Send a new report, `after` seconds from now."""
        self.driver.run(after)
        self.state = self.state if state is None else state
        self.last = self.report(**fields)
        self.send(self.last)

    def lives(self, seconds, **fields):
        """Repeat the report once a second for this many seconds."""
        for _ in range(int(seconds)):
            self.says(after=1.0, **fields)
        self.driver.run(seconds - int(seconds))

    def executes(self):
        """Obey the box from PREPARE to EXECUTING."""
        for state in (RobotState.PREPARING, RobotState.WAITING_GOAL, RobotState.EXECUTING):
            self.says(state)
        assert self._box_state() is BoxState.WAITING_RESULT

    def completes(self):
        """Finish the task, and stop as the box asks then."""
        self.says(RobotState.RESULT_TX)
        assert self._box_state() is BoxState.STOP
        self.says(RobotState.STOP)

    def _box_state(self):
        return self.driver.box.zones.run_at(self.port).message.state


def ended(driver):
    """Return why the run has ended; None: it has not."""
    run = driver.run_in()
    return run.end_reason if run.phase is Phase.ENDED else None


def public_document(driver, results=PublicResults.SCORES, provisional=True, robot_texts=True):
    """The document of a box whose organisers allow the public this."""
    return Documents(driver.box, "uuid", "", Publicity(results, provisional, robot_texts)).look(driver.now)
