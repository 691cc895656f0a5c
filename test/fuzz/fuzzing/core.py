"""The box in a competition with arbitrary actions of robots, tablets, other boxes, modules and referees."""

import contextlib
import json
import operator
from typing import Any, Callable, Dict, Iterator, List

from fuzzing.frames import KEY
from fuzzing.reader import Reader
from fuzzing.target import Step, Target
from helpers.box_driver import BoxDriver, beacon_bytes
from helpers.commands import COMMANDS, given_with, mark_with
from helpers.competition import competition, event
from helpers.forms import ODD, form
from roah_rsbb.bmbox.host.limits import checked_state
from roah_rsbb.comm import frame
from roah_rsbb.comm.ciphers import Cipher
from roah_rsbb.core import effects
from roah_rsbb.core.actions import table
from roah_rsbb.core.box import Box
from roah_rsbb.core.continuing import BoxSaved, Saved
from roah_rsbb.core.effects import RunOpened
from roah_rsbb.core.link.link import HERE_S
from roah_rsbb.core.views import document
from roah_rsbb.core.zones import ZoneState
from roah_rsbb.model.as_json import from_json, to_json
from roah_rsbb.model.fields import form_text
from roah_rsbb.model.messages import DevicesState, RobotReport, TabletState
from roah_rsbb.model.modules import ModuleInfo, ModulesState, Progress, Request, RequestKind, ScoreValue
from roah_rsbb.model.reason import Refused
from roah_rsbb.model.records import Phase
from roah_rsbb.protocol import BoxState, RobotState
from roah_rsbb.radio import wire_convert
from roah_rsbb.rulebook.benchmarks import Config, EventRules, PhaseRule, Restarts
from roah_rsbb.scoring.sheet import Mark

ZONES = ("catering", "visitor", "object", "waypoints", "all")
HOSTS = ("10.0.0.2", "10.0.0.3", "10.0.0.9")
TEAMS = ("Alpha", "Beta", "Gamma")
CODES = ("HOPF", "HNF", "HOMF")
NODES = ("n1", "n2")
FORMS = ("", form_text(ODD), form("a", "b"), form(asks_text=True), "[{}]", "[")
RULES = EventRules(
    setup_time=60.0, attempts=3, restarts=Restarts.CLOCK_STOPS, pause=True,
    phases=(PhaseRule("Enter", 2.0), PhaseRule("Serve"), PhaseRule("Leave", 60.0)),
)
_TIMES_S = (0.0, 0.001, 0.05, 1.0, 3.1, 20.0, 1000.0, 1e6)
_CLOCK_STEPS_S = (-1e9, -1.0, 1e-3, 1.0, 1e9)


class ForgetfulDriver(BoxDriver):
    """Drives a box, and keeps only what the rules of effects need."""

    def _carry_out(self, effect):
        super()._carry_out(effect)
        self.effects.clear()
        self.states.clear()
        if not isinstance(effect, RunOpened):
            for bag in self.bags.values():
                bag.clear()

    def restart(self) -> None:
        """The core ends, and continues from its saved state."""
        box = self.box
        zones = {name: _again(ZoneState, box.zones[name].saved()) for name in box.zones}
        saved = Saved(self.now.utc, _again(BoxSaved, box.restart.saved()), zones)
        self.box = Box(self.config, self.settings, beacon_bytes, max(self.channels, default=None))
        self._rules.restart()
        self.channels.clear()
        self.event(self.box.restart.resume, saved)


def _again(kind, state):
    """A saved state, from the journal."""
    return from_json(kind, json.loads(json.dumps(to_json(state))))


class Play:
    """One input: a box with runs in progress, and the following events. `make` makes the driver of a box; one that
    cannot restart its box does not."""

    def __init__(self, data: bytes, make: Callable[[Config], Any] = ForgetfulDriver) -> None:
        self.reader = Reader(data)
        config = competition(
            catering=[event("HCFGAC", timeout=300.0, rules=RULES), "HWV"],
            visitor=[event("HWV", team="Beta", timeout=30.0)],
            object=[event("HOPF"), event("HOMF")], waypoints=[event("HNF", team="Gamma", timeout=60.0)],
            all=[event("HSUF", team="ALL", timeout=30.0, rules=EventRules(setup_time=30.0, pause=True))],
        )
        self.driver = make(config)
        self.driver.config = config
        self.reader.choice((self._begin_runs, self._begin_runs, self._begin_all_robots, self._begin_switches))()

    def _begin_all_robots(self) -> None:
        """All robots are in one run."""
        for host, team in zip(HOSTS, TEAMS):
            self.driver.robot(team, "r1", host).beacon()
        self.driver.command("connect", "all")
        self.driver.jump(0.001)
        now = self.driver.robot().time()
        for host, run in zip(HOSTS, self.driver.box.zones.members()):
            said = RobotReport(now, 1, RobotState.STOP)
            self.driver.event(self.driver.box.arrivals.on_robot_report, run.port, host, said)
        self.driver.command("start", "all")

    def _begin_switches(self) -> None:
        """The referee enters switches."""
        self.driver.command("next", "object")
        node = ModulesState(NODES[0], tuple(ModuleInfo(code) for code in CODES))
        self.driver.event(self.driver.box.modules.on_modules, node)
        robot = self.driver.connected("object", team="Alpha", name="r1", host=HOSTS[0])
        self.driver.command("start", "object")
        identity = self.driver.run_in("object").identity
        goal = Request(1, RequestKind.GOAL, initial_state=(True, False), switches=(2,))
        self.driver.event(self.driver.box.modules.on_modules, node._replace(progress=(Progress(identity, 1, goal),)))
        for state in (RobotState.PREPARING, RobotState.WAITING_GOAL, RobotState.EXECUTING, RobotState.RESULT_TX):
            robot.says(state)
        asked = Request(2, RequestKind.SWITCHES, "Enter")
        self.driver.event(self.driver.box.modules.on_modules, node._replace(progress=(Progress(identity, 1, asked),)))

    def _begin_runs(self) -> None:
        """A robot executes in the first zone, another has a goal in a functionality benchmark."""
        self.driver.executing("catering", team="Alpha", name="r1", host=HOSTS[0])
        node = ModulesState(NODES[0], tuple(ModuleInfo(code) for code in CODES))
        self.driver.event(self.driver.box.modules.on_modules, node)
        robot = self.driver.connected("waypoints", team="Gamma", name="r1", host=HOSTS[1])
        self.driver.event(self.driver.box.modules.on_modules, node)
        self.driver.command("start", "waypoints")
        run = self.driver.run_in("waypoints")
        goal = Request(1, RequestKind.GOAL, "to the kitchen", goal="[1.0, 2.0, 0.0]", pose=(1.0, 2.0, 0.0))
        node = node._replace(progress=(Progress(run.identity, 1, goal),))
        self.driver.event(self.driver.box.modules.on_modules, node)
        for state in (RobotState.PREPARING, RobotState.WAITING_GOAL, RobotState.EXECUTING):
            robot.says(state)

    def act(self) -> Step:
        """What happens next."""
        return self.reader.choice((
            self._report, self._report, self._report, self._report_of_anybody, self._beacon, self._tablet,
            self._network, self._modules, self._command, self._score, self._pass, self._set_clock, self._devices,
            self._operation, self._restart,
        ))()

    def do(self, data: bytes) -> None:
        """Let happen what another input says."""
        self.reader = Reader(data)
        self.act()()

    def steps(self) -> Iterator[Step]:
        """Everything that happens, and after each the look that panels take."""
        while self.reader:
            yield self.act()
            yield self._save
            yield self._look
            self._check()

    # -- what happens -------------------------------------------------------------------------------

    def _event(self, name: str, *arguments: object) -> Step:
        def do() -> None:
            with contextlib.suppress(Refused):
                self.driver.event(operator.attrgetter(name)(self.driver.box), *arguments)
        return do

    def _read_report(self, time) -> RobotReport:
        r = self.reader
        r.new_message()
        none_or = lambda read: read() if r.flag() else None  # noqa: E731
        uint32 = lambda: r.integer(signed=False, size=4)  # noqa: E731
        return RobotReport(
            time, uint32(), r.choice(list(RobotState)), r.texts(), r.texts(), r.texts(), r.texts(),
            none_or(r.flag), none_or(r.flag), none_or(r.flag), none_or(uint32), none_or(uint32), none_or(r.flag),
            none_or(r.text), none_or(r.text), none_or(r.text), none_or(r.double), none_or(r.double),
            none_or(r.double),
        )

    def _report(self) -> Step:
        """A robot in a run sends a message with the present time."""
        runs = self.driver.box.zones.members()
        self.driver.jump(0.001)
        if not runs:
            return self._event("timers.tick")
        run = self.reader.choice(runs)
        now = self.driver.robot().time()
        return self._event("arrivals.on_robot_report", run.port, run.link.host or HOSTS[0], self._read_report(now))

    def _time(self):
        return self.reader.integer(), self.reader.integer()

    def _report_of_anybody(self) -> Step:
        """Any host sends a message with any time. It changes no state while the robot is heard elsewhere."""
        port, host = 6667 + self.reader.byte() % 6, self.reader.choice(HOSTS)
        say = self._event("arrivals.on_robot_report", port, host, self._read_report(self._time()))
        self._event("timers.tick")()
        run = self.driver.box.zones.run_at(port)
        link = None if run is None else run.link
        if link is None or link.last_heard is None or link.host == host:
            return say
        if self.driver.now.mono - link.last_heard.mono >= HERE_S:
            return say
        before = run.message, link.last

        def moves_nothing() -> None:
            say()
            assert (run.message, link.last) == before
        return moves_nothing

    def _beacon(self) -> Step:
        team = self.reader.choice(TEAMS) if self.reader.flag() else self.reader.text()
        robot = self.reader.choice(("r1", "r2")) if self.reader.flag() else self.reader.text()
        time = self.driver.robot().time() if self.reader.flag() else self._time()
        return self._event("arrivals.on_robot_beacon", self.reader.choice(HOSTS), team, robot, time)

    def _tablet(self) -> Step:
        r = self.reader
        said = TabletState(False, self._time(), self._time(), r.double(), r.double())
        return self._event("arrivals.on_tablet", r.choice(HOSTS), said)

    def _network(self) -> Step:
        r = self.reader
        host, port = r.choice(HOSTS), 6667 + r.byte() % 6
        return r.choice((
            lambda: self._event("arrivals.on_foreign_box", host),
            lambda: self._event("arrivals.on_complaint", r.text()),
            lambda: self._event("arrivals.on_unreadable", port, r.text()),
            lambda: self._event("arrivals.on_channel_failed", port, "in use"),
            lambda: self._event("watches.trouble", r.text()),
        ))()

    def _modules(self) -> Step:
        r = self.reader
        infos = tuple(ModuleInfo(code) for code in CODES)
        said = ModulesState(r.choice(NODES), infos, tuple(r.list_of(self._progress, 2)))
        return lambda: self.driver.event(self.driver.box.modules.on_modules, checked_state(said))

    def _progress(self) -> Progress:
        r = self.reader
        runs = self.driver.box.modules.runs()
        run = r.choice(runs) if runs and r.byte() < 224 else None
        identity, attempt = (r.text(), r.integer()) if run is None else (run.run, run.attempt)
        request = self._request(0 if run is None else len(run.steps)) if r.flag() else None
        scores = r.list_of(lambda: ScoreValue(r.text(), r.text(), r.text(), r.text(), r.text()))
        return Progress(
            identity, attempt, request, tuple(scores), r.text(), r.texts(), r.text(), r.byte() > 224,
            r.text() if r.byte() > 224 else "",
        )

    def _request(self, taken: int) -> Request:
        r = self.reader
        number = taken + 1 if r.byte() < 224 else r.integer()
        pose = tuple(r.list_of(r.double)) if r.flag() else None
        return Request(
            number, r.choice(list(RequestKind)), r.text(), r.choice(FORMS), r.text(), pose,
            tuple(r.list_of(r.flag, 12)), tuple(r.list_of(lambda: r.integer(size=4), 12)), r.double(), "{}",
        )

    def _command(self) -> Step:
        zone, command = self.reader.choice((*ZONES, "none")), self.reader.choice(sorted(COMMANDS))
        given = given_with(command, self.reader.choice(("", *TEAMS)))
        return self._event("act", table.Target(zone), command, "", given)

    def _score(self) -> Step:
        r = self.reader
        group, desc = r.choice((("Achievements", "detects the door"), ("Penalized", "bumps"), ("", "bumps")))
        records = self.driver.box.scores.records(self.driver.now)
        record = r.choice(records) if records and r.flag() else None
        target = table.Target(r.choice(ZONES), "") if record is None else table.Target(record.zone, record.identity)
        return r.choice((
            lambda: self._enter(target._replace(run=""), "mark", mark_with(Mark(group, desc, r.integer(size=4)))),
            lambda: self._enter(target, "mark", mark_with(Mark(group, desc, r.integer(size=4), r.flag(), r.text()))),
            lambda: self._enter(target, "withdraw", {"entry": r.byte(), "note": r.text()}),
            lambda: self._enter(target, "stop_reason", {"reason": r.text(), "stop": r.byte()}),
            lambda: self._enter(target, "sign_off", {}),
        ))()

    def _enter(self, target: table.Target, entry: str, given: Dict[str, Any]) -> Step:
        return self._event("act", target, entry, self.reader.text(), given)

    def _pass(self) -> Step:
        """Time passes, and the box only notices now."""
        self.driver.jump(self.reader.choice(_TIMES_S))
        return self._event("timers.tick")

    def _set_clock(self) -> Step:
        self.driver.set_clock(self.reader.choice(_CLOCK_STEPS_S))
        return self._event("timers.tick")

    def _devices(self) -> Step:
        r = self.reader
        if r.flag():
            return self._event("devices.on_refused", r.choice(ZONES), "dimmer", r.byte(), r.text())
        return self._event("devices.on_state", DevicesState((r.byte(), r.byte()), r.flag(), dimmer=r.byte() % 101))

    def _operation(self) -> Step:
        r = self.reader
        zone = r.choice(ZONES)
        return r.choice((
            lambda: self._act(zone, "operation", {"operation": r.byte(), "answer": r.text()}),
            lambda: self._act(zone, "operation", {"operation": r.byte(), r.text(): r.integer()}),
            lambda: self._act(zone, "switch", {"number": r.byte()}),
            lambda: self._act(zone, "damaged", {"number": r.byte()}),
            lambda: self._act(zone, "confirm_switches", {}),
        ))()

    def _act(self, zone: str, name: str, given: Dict[str, object]) -> Step:
        return self._event("act", table.Target(zone), name, "", given)

    def _restart(self) -> Step:
        return getattr(self.driver, "restart", self._event("timers.tick"))

    # -- what came of it ----------------------------------------------------------------------------

    def _save(self) -> None:
        """Save the data that goes into the journal with every change."""
        box = self.driver.box
        for name in box.outbox.take_changed():
            json.dumps(to_json(box.restart.saved() if name == effects.BOX else box.zones[name].saved()))

    def _look(self) -> None:
        """Make the messages that are published and sent periodically."""
        driver = self.driver
        for view in document.ZoneViews(driver.box).look(driver.now).values():
            assert view.state
            assert view.clock.timer(driver.now.mono) >= 0
        assert document.box_status(driver.box, driver.now)
        frame.encode(wire_convert.beacon_message(driver.box.beacon()))
        driver.box.modules.runs()
        deadline = driver.box.timers.deadline()
        assert deadline is None or deadline > driver.now.mono - 1e6

    def _check(self) -> None:
        box = self.driver.box
        runs = box.zones.members()
        assert len({run.robot for run in runs}) == len({run.port for run in runs}) == len(runs)
        assert {r.port for r in box.beacon().robots} == set(self.driver.channels) == {run.port for run in runs}
        for run in runs:
            assert (run.phase is Phase.RUNNING) is (run.message.state is not BoxState.STOP)
            datagram = frame.encode(wire_convert.state_message(run.message), Cipher.AES_128_CBC, KEY)
            assert len(datagram) <= self.driver.settings.max_datagram
            assert len(run.log) <= self.driver.settings.display_log_size
            assert len(run.online_data) <= self.driver.settings.display_log_size


def steps(data: bytes) -> Iterator[Step]:
    """Everything that happens to a box."""
    return Play(data).steps()


def seeds() -> List[bytes]:
    """Robots that finish with results, send very much, or fall back; requests of modules; referees; restarts."""
    return [bytes([opening]) + seed for opening in (0, 2, 3) for seed in _seeds_of_a_run()]


def _seeds_of_a_run() -> List[bytes]:
    """The same happens after each opening."""
    said = bytes([0, 1, 1])  # of the first run: a message is saved, PREPARING
    return [
        b"",
        bytes(range(256)),
        said + b"\xff\x02ab" + said + b"\0\xff\x05visit",  # 990 texts, twice
        said + b"\x01\xffabcd" + said + b"\x02\xff\xf0\x9f\xa4\x96\x03abc",  # texts of 60 kB
        bytes([0, 1, 1, 4, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1]) + b"\xff[",  # the goal's result, 60 kB
        bytes([0, 0, 1, 3, 0, 0, 0, 0, 1, 1, 1, 0, 0, 1, 200, 1, 101, 1, 1]),  # devices
        bytes([10, 4, 0, 0, 1, 1, 10, 6, 0, 1, 1, 1]),
        bytes([14, 0, 0, 1, 1, 14, 10, 3, 14]),
        bytes([8, 0, 4, 8, 0, 1, 8, 2, 0, 4, 1, 1, 1, 0, 8, 2, 0, 8, 2, 4]),
        bytes([7, 0, 1, 0, 0, 1, 0, 1, 2, 0x48, 0x69, 1, 1, 0x61, 0, 0, 0, 0, 0, 0, 0]),
        bytes([11, 0, 0, 1, 1, 11, 4, 10, 7, 3, 0, 1, 200, 200, 1, 1]),
        bytes([8, 0, 4, 8, 2, 4, 8, 4, 4, 9, 0, 1, 0, 0, 0, 5, 0, 0, 9, 0, 1, 1, 0, 0, 2, 0, 0, 0, 9, 0, 1, 1, 0, 4]),
        bytes([13, 2, 1, 1, 13, 2, 2, 3, 13, 2, 3, 13, 4, 0, 0, 0]),
    ]


BOX = Target("box", steps, seeds, tuple(bytes([kind]) for kind in range(15)) + (b"\xff", b"\xfe", b"\x80"))
