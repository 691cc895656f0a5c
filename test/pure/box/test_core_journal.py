"""A core that is killed resumes where it was: at every record boundary, after every event, from torn files, and with
another schedule, or in another launch. A run whose private channel is no longer available does not prevent that. The
journal has the state of a run at every moment, for replays."""

import pytest

from helpers.all_robots import robots_of, take_ports
from helpers.competition import BUMPS, DOOR, competition, event
from helpers.examples import ALL
from helpers.journaled import CATERING, NAVIGATION, NO_LISTENING, JournaledDriver, box, two_zones
from helpers.module_player import FakeModules, does_goal
from roah_rsbb.box.journal import competition as events_of
from roah_rsbb.core import effects
from roah_rsbb.core.actions.table import Target
from roah_rsbb.core.runs.run import IGNORES_STOP
from roah_rsbb.core.settings import Settings
from roah_rsbb.core.views.document import clock_of
from roah_rsbb.journal.log_dir import CoreSession, Resume
from roah_rsbb.journal.reader import JournalReader
from roah_rsbb.journal.records import Batch, ChangesReader, Kind
from roah_rsbb.journal.store import Journal
from roah_rsbb.model import run_log
from roah_rsbb.model.as_json import to_json
from roah_rsbb.model.clock import Now
from roah_rsbb.model.messages import DevicesState, TabletState
from roah_rsbb.model.modules import RequestKind, ScoreValue
from roah_rsbb.model.reason import RunName
from roah_rsbb.model.records import EndReason, Phase
from roah_rsbb.protocol import BoxState, RobotState
from roah_rsbb.scoring.sheet import Mark
from roah_rsbb.standby.beside_copy import Ahead

WAYPOINT = {"goal": "[1.0, 2.0, 0.5]", "pose": (1.0, 2.0, 0.5)}


class Story:
    """A run with strings, devices and scores in one zone, one with goals and manual operations in another."""

    def __init__(self, driver):
        self.driver = driver
        self.modules = driver.modules = FakeModules(driver, "HNF")

    def play(self):
        driver, modules = self.driver, self.modules
        modules.beat()
        alpha = driver.connected("tbm")
        beta = driver.connected("fbm", team="Beta", name="r2", host="10.0.0.3")
        modules.beat()
        driver.command("start", "tbm")
        driver.command("start", "fbm")
        alpha.executes()
        alpha.says(notifications=("at the bed",), switch_1=True, dimmer=20)
        driver.score(DOOR.group, DOOR.desc, 1, "tbm")
        modules.asks(RequestKind.REFEREE, "fbm", text="Place the robot")
        driver.event(driver.box.act, Target("fbm"), "operation")
        modules.asks(RequestKind.GOAL, "fbm", timeout=60.0, **WAYPOINT)
        alpha.says(notifications=("at the bed", "at the door"), switch_1=True, dimmer=30)
        does_goal(beta, generic_result="[1.0, 2.0]")
        modules.says("fbm", scores=(ScoreValue("waypoint 1", "distance", "0.25", "m"),))
        driver.command("stop", "tbm")
        driver.score(BUMPS.group, BUMPS.desc, 2, "tbm")
        alpha.says(RobotState.STOP)
        driver.command("start", "tbm")
        alpha.executes()
        modules.asks(RequestKind.GOAL, "fbm", timeout=60.0, goal="[3.0, 4.0, 0.0]")
        does_goal(beta)
        modules.says("fbm", finished=True, request=modules.run("fbm").steps[-1].request)
        alpha.completes()
        beta.says(RobotState.STOP)
        self.ports = alpha.port, beta.port
        self.ends = {name: driver.run_in(name).end_reason for name in ("tbm", "fbm")}
        self.scores = driver.run_in("fbm").scores
        self.sheet = driver.run_in("tbm").sheet.groups()
        driver.command("disconnect", "tbm")
        driver.command("disconnect", "fbm")
        return self

    def outcome(self):
        """The data that must be the same whatever happened to the core."""
        bags = self.driver.bags
        strings = bags[self.ports[0]]
        return (
            self.ends, self.scores, self.sheet, self.driver.box.zones["tbm"].index, self.ports,
            [value for topic, value in strings if topic == run_log.NOTIFICATION],
            [entry for entry in strings if "devices" in entry[0]],
            [value for topic, value in bags[self.ports[1]] if topic in (run_log.GOAL, run_log.RESULT)],
            [(r.end_reason, r.items, r.module_scores) for r in self.driver.box.finished.records()],
        )


def essence(driver):
    """The state of all zones, without what every datagram changes and without the texts about the restart."""

    def of_run(run):
        run = dict(run, message={key: run["message"][key] for key in run["message"] if key != "acknowledgement"})
        run["book"] = without_outages(run["book"])
        return {key: value for key, value in run.items() if key not in ("link", "log", "doubted", "away_s")}

    def without_outages(book):
        return {key: value for key, value in book.items() if key != "outages"}

    found = {}
    for name in driver.box.zones:
        state = to_json(driver.box.zones[name].saved())
        if state.get("run"):
            state["run"] = of_run(state["run"])
        if state.get("all_robots"):
            members = [of_run(member) for member in state["all_robots"]["members"]]
            book = without_outages(state["all_robots"]["book"])
            state["all_robots"] = dict(state["all_robots"], members=members, log="", book=book)
        found[name] = state
    return found


@pytest.mark.long
def test_at_every_record_boundary_the_journal_has_what_is_in_force(tmp_path):
    there = []

    def on_record(driver):
        directory = tmp_path / f"copy {len(there)}"
        driver.copy(directory)
        there.append((directory, driver.now, essence(driver)))

    driver = box(tmp_path, on_record=on_record)
    Story(driver).play()
    assert len(there) > 35
    driver.on_record = None
    for directory, now, expected in there[::1 if ALL else 3]:
        driver.now = now
        driver.resume_in(directory)
        assert essence(driver) == expected
        assert driver.troubles == []
        driver.journal.close()


class _Killed(JournaledDriver):
    """Is killed after so many events."""

    def __init__(self, *args, after, **kwargs):
        self.count, self.after = 0, after
        self.robots, self.modules = [], None
        super().__init__(*args, **kwargs)

    def robot(self, *args, **kwargs):
        self.robots.append(super().robot(*args, **kwargs))
        return self.robots[-1]

    def event(self, method, *arguments):
        try:
            return super().event(method, *arguments)
        finally:
            self.count += self.modules is not None
            if self.count == self.after and not self.restarts:
                self.kill(0.5)
                for robot in self.robots:
                    robot.beacon()
                self.modules.beat()


def _story_with_kill(directory, after):
    directory.mkdir()
    driver = _Killed(directory, two_zones(), NO_LISTENING, after=after)
    outcome = Story(driver).play().outcome()
    driver.journal.close()
    return driver, outcome


@pytest.mark.long
def test_a_core_that_is_killed_after_any_event_comes_to_the_same_end(tmp_path):
    undisturbed, expected = _story_with_kill(tmp_path / "undisturbed", None)
    assert undisturbed.count > 50
    for after in range(1, undisturbed.count, 1 if ALL else 7):
        driver, outcome = _story_with_kill(tmp_path / f"killed after {after}", after)
        assert driver.restarts == 1
        assert outcome == expected, f"killed after event {after}"


@pytest.fixture(scope="module")
def reported(tmp_path_factory):
    """The driver of a story that was played, and all its states."""
    states = []
    driver = box(tmp_path_factory.mktemp("story"), on_record=lambda d: states.append(essence(d)))
    states.append(essence(driver))
    Story(driver).play()
    driver.on_record = None
    return driver, states


@pytest.mark.parametrize("share", [0.1, 0.3, 0.5, 0.7, 0.9, 0.99])
@pytest.mark.parametrize("garbage", [False, True])
def test_a_torn_file_gives_a_state_that_was_in_force(reported, tmp_path, share, garbage):
    driver, states = reported
    torn = tmp_path / "torn"
    driver.copy(torn)
    segment = next(torn.glob("*/*.log"))
    whole = segment.read_bytes()
    kept = int(len(whole) * share)
    segment.write_bytes(whole[:kept] + (b"\xa5" * (len(whole) - kept) if garbage else b""))
    driver.resume_in(torn)
    found = essence(driver)
    assert found in states
    assert share < 0.3 or found != states[0]
    driver.journal.close()


@pytest.mark.parametrize("how", [
    {}, {"boot": "boot 2"}, *({"boot": "boot 2", "ahead": ahead, "set_s": set_s} for ahead, set_s in (
        (Ahead(30.0), 0.0), (Ahead(-30.0), 0.0), (Ahead(30.0, 5000.0), 900.0), (Ahead(0.0, -900.0), -900.0)))])
def test_the_true_time_is_left_after_a_restart(tmp_path, how):
    """Also after a restart of the computer, and on another one, whose clocks differ. The standby has measured by how
    much. If it ran all the time, a step of its UTC changes nothing."""
    driver = box(tmp_path)
    driver.executing("tbm")
    driver.run(10.0)
    left = driver.run_in("tbm").timer(driver.now)
    driver.kill(60.0, **how)
    assert driver.run_in("tbm").timer(driver.now) == pytest.approx(left - 60.0)
    assert not how or any(" 60 s after its last record" in warning for warning in driver.box.warnings(driver.now))


def test_a_robot_that_did_not_answer_stop_is_warned_of_from_the_first_moment(tmp_path):
    driver = box(tmp_path)
    robot = driver.executing("tbm")
    driver.command("stop", "tbm")
    driver.kill(0.1)
    assert driver.view("tbm").warnings[0] == IGNORES_STOP
    robot.says(RobotState.STOP)
    assert IGNORES_STOP not in driver.view("tbm").warnings


def test_a_run_whose_time_ran_out_meanwhile_ends_by_timeout(tmp_path):
    driver = box(tmp_path)
    robot = driver.executing("tbm")
    driver.taken()
    driver.kill(301.0)
    run = driver.run_in("tbm")
    assert (run.phase, run.end_reason) == (Phase.ENDED, EndReason.TIMEOUT)
    assert driver.states[robot.port][-1].state is BoxState.STOP
    assert driver.taken(effects.TimeoutRung) == [effects.TimeoutRung("tbm")]


def test_the_robot_finds_its_channel_its_port_and_its_state_again(tmp_path):
    driver = box(tmp_path, settings=Settings())
    robot = driver.executing("tbm")
    robot.says(notifications=("once",))
    driver.kill()
    assert driver.channels == {robot.port: robot.host}
    assert driver.states[robot.port][-1].state is BoxState.WAITING_RESULT
    assert [listed.port for listed in driver.box.beacon().robots] == [robot.port]
    assert driver.box.watches.listening_left(driver.now) == 0.0, "robots that wait for their box are not kept waiting"
    robot.says(notifications=("once",))
    assert driver.logged(robot.port, run_log.NOTIFICATION) == ["once"]
    robot.completes()
    assert driver.run_in("tbm").end_reason is EndReason.COMPLETED


def test_what_was_stale_before_is_stale_after(tmp_path):
    driver = box(tmp_path)
    robot = driver.connected("tbm")
    old = robot.report(RobotState.PREPARING)
    driver.command("start", "tbm")
    robot.executes()
    driver.kill()
    robot.send(old)
    assert driver.box_state("tbm") is BoxState.WAITING_RESULT


def test_robots_receive_the_same_state_of_devices_and_tablet(tmp_path):
    driver = box(tmp_path)
    devices = DevicesState(bell=(5, 6), switch_2=True, blinds=30)
    driver.event(driver.box.devices.on_state, devices)
    driver.event(driver.box.arrivals.on_tablet, "10.0.0.9",
                 TabletState(call_time=(7, 8), position_x=1.5, position_time=(9, 1)))
    before = driver.box.beacon()
    driver.kill()
    assert driver.box.beacon() == before


def test_a_silence_that_is_the_boxs_own_is_not_held_against_the_robot(tmp_path):
    driver = box(tmp_path)
    driver.executing("tbm")
    driver.kill(30.0)
    assert not any("No message" in text for text in driver.view("tbm").warnings)
    driver.run(3.1)
    assert any("No message" in text for text in driver.view("tbm").warnings)


def in_goal(driver):
    modules = FakeModules(driver, "HNF")
    modules.beat()
    robot = driver.connected("fbm", team="Beta", name="r2", host="10.0.0.3")
    modules.beat()
    driver.command("start", "fbm")
    modules.asks(RequestKind.GOAL, "fbm", timeout=60.0, **WAYPOINT)
    return modules, robot


def test_a_module_gets_back_what_it_wanted_kept(tmp_path):
    driver = box(tmp_path)
    modules, _ = in_goal(driver)
    modules.says("fbm", kept='{"sum":1}')
    driver.kill()
    assert modules.run("fbm").kept == '{"sum":1}'


def test_a_run_that_is_held_stays_so_until_its_module_is_heard(tmp_path):
    driver = box(tmp_path)
    modules, _ = in_goal(driver)
    driver.run(3.0)
    left = driver.run_in("fbm").clock.left(driver.now)
    driver.kill(20.0)
    driver.run(5.0)
    assert driver.run_in("fbm").held
    assert driver.run_in("fbm").clock.left(driver.now) == pytest.approx(left)
    modules.beat()
    assert not driver.run_in("fbm").held
    driver.run(1.0)
    assert driver.run_in("fbm").clock.left(driver.now) == pytest.approx(left - 1.0)


def test_who_said_what(tmp_path):
    driver = box(tmp_path)
    robot = driver.connected("tbm")
    driver.event(driver.box.act, Target("tbm"), "start", "/referee_2")
    entries = JournalReader(driver.journal.path).entries(driver.run_in("tbm").identity)
    said = {entry.who for entry in entries if entry.kind == run_log.CLIENT_STATE}
    assert said == {robot.host}
    commands = [(entry.who, entry.value) for entry in entries if entry.kind == "command"]
    assert ("/referee_2", {"command": "start"}) in commands


def test_all_robots_continue_together(tmp_path):
    first = event("HSUF", team="ALL", timeout=120.0, scoring=())
    driver = box(tmp_path, competition(tbm=[first]))
    robots = robots_of(driver)
    driver.command("connect")
    take_ports(driver, robots)
    for robot in robots:
        robot.says(RobotState.STOP)
    driver.command("start")
    robots[0].executes()
    before = essence(driver)
    driver.kill(5.0)
    assert essence(driver) == before
    assert sorted(driver.channels) == [robot.port for robot in robots]
    robots[0].completes()
    for robot in robots[1:]:
        robot.executes()
        robot.completes()
    assert driver.run_in().end_reason is EndReason.COMPLETED


def test_a_port_that_cannot_be_opened_is_tried_again_and_the_run_waits(tmp_path):
    driver = box(tmp_path)
    robot = driver.executing("tbm")
    driver.unusable_ports.add(robot.port)
    driver.kill()
    assert driver.run_in("tbm").phase is Phase.RUNNING
    assert driver.channels == {}
    assert any(f"UDP port {robot.port}" in text for text in driver.box.warnings(driver.now))
    driver.unusable_ports.clear()
    driver.run(1.1)
    assert driver.channels == {robot.port: robot.host}
    robot.completes()
    assert driver.run_in("tbm").end_reason is EndReason.COMPLETED


def test_a_state_that_makes_no_sense_costs_its_zone_alone(tmp_path):
    driver = box(tmp_path)
    story = Story(driver)
    story.modules.beat()
    driver.connected("tbm")
    beta = driver.connected("fbm", team="Beta", name="r2", host="10.0.0.3")
    story.modules.beat()
    driver.command("start", "fbm")
    story.modules.asks(RequestKind.GOAL, "fbm", timeout=60.0, **WAYPOINT)
    driver.run_in("fbm").steps.clear()  # a goal under way that nobody asked for
    beta.says(RobotState.PREPARING)
    driver.kill()
    assert driver.run_in("tbm").phase is Phase.CONNECTED
    assert driver.run_in("fbm") is None
    assert list(driver.channels) == [driver.run_in("tbm").port]
    assert any("HNF, team Beta" in text and "is invalid" in text for text in driver.box.warnings(driver.now))


def test_no_port_is_given_twice(tmp_path):
    driver = box(tmp_path)
    ports = []
    for _ in range(3):
        robot = driver.connected("tbm")
        ports.append(robot.port)
        driver.command("disconnect", "tbm")
        driver.kill()
    assert len(set(ports)) == 3


def test_a_run_by_hand_continues_after_a_kill_and_is_in_the_journal(tmp_path):
    driver = box(tmp_path)
    driver.command("open_sheet", "tbm")
    driver.command("start", "tbm")
    identity = driver.run_in("tbm").identity
    driver.run(10.0)
    driver.kill(20.0)
    run = driver.run_in("tbm")
    assert (run.identity, run.phase, run.timer(driver.now)) == (identity, Phase.RUNNING, pytest.approx(270.0))
    driver.command("stop", "tbm")
    driver.command("disconnect", "tbm")
    driver.command("no_show", "tbm")
    driver.kill(1.0)
    ends = [(record.end_reason, record.robots) for record in driver.box.finished.records()]
    assert ends == [("no_show", ()), ("stopped", ())]
    driver.journal.close()
    reader = JournalReader(driver.journal.path)
    runs = reader.runs()
    assert [run.outcome["end_reason"] for run in runs] == ["stopped", "no_show"]
    assert reader.members(runs[0].identity) == []


def test_a_core_that_ended_before_it_resumed_changes_no_times(tmp_path):
    """The computer starts again, and the core is killed before it has written a state. The states' times are still
    those of the boot before."""
    driver = box(tmp_path)
    driver.executing()
    driver.run(10.0)
    elapsed = driver.run_in().clock.elapsed(driver.now)
    driver.journal.close()
    driver.now, driver.boot = Now(20.0, driver.now.utc + 30.0), "boot 2"
    session = CoreSession(driver.now.utc, driver.now.mono, "boot 2", 2, "uuid 2", "")
    Journal(str(tmp_path / "0"), session, events_of(driver.config), Resume.ALWAYS, driver.troubles.append).close()
    driver.now = driver.now.later(5.0)
    driver.resume_in(tmp_path / "0")
    assert driver.run_in().clock.elapsed(driver.now) == pytest.approx(elapsed + 35.0)


def test_a_run_that_cannot_continue_can_be_corrected_and_signed_off(tmp_path):
    driver = box(tmp_path)
    driver.executing("tbm")
    driver.score(DOOR.group, DOOR.desc, 1, "tbm")
    identity = driver.run_in("tbm").identity
    driver.kill(5.0, config=competition(fbm=[NAVIGATION]))
    (record,) = driver.box.finished.records()
    assert (record.identity, record.end_reason, record.items[0].value) == (identity, "stopped", 1)
    name = RunName("tbm", identity)
    driver.mark(name, Mark(DOOR.group, DOOR.desc, 0), "Anna")
    driver.enter("sign_off", name, "Anna")
    signed = driver.box.finished.find(identity).record
    driver.kill()
    assert driver.box.finished.records() == [signed]


def test_an_event_that_was_moved_in_time_is_found(tmp_path):
    driver = box(tmp_path)
    driver.command("next", "tbm")
    later = event("HWV", scheduled=event().scheduled + 900)
    moved = competition(tbm=[event("HGTKMH"), CATERING, later], fbm=[NAVIGATION])
    driver.kill(config=moved)
    assert driver.box.zones["tbm"].event.benchmark.code == "HWV"


def test_a_run_whose_event_is_gone_is_reported(tmp_path):
    driver = box(tmp_path)
    driver.executing("tbm")
    driver.kill(config=competition(tbm=["HGTKMH"], fbm=[NAVIGATION]))
    assert driver.run_in("tbm") is None
    assert any("cannot continue" in text for text in driver.box.warnings(driver.now))


def test_the_journal_of_another_competition_is_set_aside(tmp_path):
    driver = box(tmp_path)
    driver.executing("tbm")
    driver.kill(config=competition(other=["HGTKMH"]))
    assert any("another competition" in text for text in driver.troubles)
    assert [path.name for path in driver._directory.glob("*_aside_*")] != []


@pytest.mark.parametrize("resume, launch, resumes", [
    (Resume.ALWAYS, "2", True), (Resume.LAUNCH, "1", True), (Resume.LAUNCH, "2", False), (Resume.NEVER, "1", False),
])
def test_when_a_core_resumes(tmp_path, resume, launch, resumes):
    driver = box(tmp_path)
    driver.journal.close()
    driver.open(tmp_path / "0", launch="1")
    driver.executing("tbm")
    driver.journal.close()
    driver.open(tmp_path / "0", resume, launch)
    assert (driver.run_in("tbm") is not None) == resumes


ALL_ROBOTS = competition(a=[event("HSUF", team="ALL", timeout=120.0, scoring=())], b=["HWV"])


def why_not(driver):
    return [text for text in driver.box.warnings(driver.now) if "cannot continue" in text]


def test_a_robot_whose_team_has_no_password_any_more(tmp_path):
    driver = JournaledDriver(tmp_path, ALL_ROBOTS, NO_LISTENING)
    robots = robots_of(driver)
    driver.command("connect", "a")
    take_ports(driver, robots)
    for robot in robots:
        robot.says(RobotState.STOP)
    left_out = robots[-1].team
    rest = competition(teams=[team for team in ("Alpha", "Beta", "Gamma") if team != left_out], **{
        plan.name: plan.events for plan in ALL_ROBOTS.zones
    })
    driver.kill(config=rest)
    assert driver.run_in("a") is None
    assert driver.channels == {}
    assert len(why_not(driver)) == 1 and f"team {left_out} has no password any more" in why_not(driver)[0]


@pytest.mark.parametrize("port", [0, -1, 65536, 10**12, 6667])
def test_a_port_that_cannot_be_a_runs(tmp_path, port):
    """6667 is the other run's: the file is damaged."""
    driver = JournaledDriver(tmp_path, competition(a=["HGTKMH"], b=[event("HWV", team="Beta")]), NO_LISTENING)
    driver.executing("a")
    driver.connected("b", team="Beta", host="10.0.0.3")
    state = driver.journal._writer.contents.states["zone:b"].state
    driver.journal.write(Batch(states={"zone:b": {**state, "run": {**state["run"], "port": port}}}))
    driver.kill()
    assert driver.run_in("b") is None
    assert driver.run_in("a") is not None
    assert list(driver.channels) == [6667]
    assert f"its port {port} cannot be used" in why_not(driver)[0]


def states_of(path):
    """The states of all runs in a journal: by identity, (UTC, state) in order."""
    found = {}
    journal = JournalReader(str(path))
    for run in journal.runs():
        reader = ChangesReader()
        found[run.identity] = [(entry.utc, reader.take(entry.value)) for entry in journal.states(run.identity)]
        assert not any(entry.kind == Kind.STATE for entry in journal.entries(run.identity))
    return found


class _Watched:
    """Notes the state of each run after each record."""

    def __init__(self):
        self.states = {}  # by identity and UTC: the last state of this moment

    def __call__(self, driver):
        for zone in driver.box.zones.values():
            if zone.run is not None:
                clock = clock_of(zone.run, zone.event.benchmark, driver.now)
                self.states.setdefault(zone.run.identity, {})[driver.now.utc] = (
                    to_json(zone.saved()), clock.spent(driver.now.mono))


def check(driver, watched):
    path = driver.journal.path
    driver.journal.close()
    found = states_of(path)
    assert found.keys() == watched.states.keys()
    for identity, states in found.items():
        assert None not in [state for _, state in states]
        last = dict(states)
        for utc, (state, elapsed_s) in watched.states[identity].items():
            if utc in last:
                assert last[utc]["zone"] == state
                assert abs(last[utc]["clock"].get("elapsed", 0.0) - elapsed_s) < 0.001
        assert len(last) > 3


def test_the_states_of_a_run_are_those_of_the_box(tmp_path):
    watched = _Watched()
    driver = box(tmp_path, on_record=watched)
    robot = driver.executing("tbm")
    for i in range(5):
        robot.says(notifications=(f"text {i}",))
        driver.score(DOOR.group, DOOR.desc, i % 2, "tbm")
    driver.command("stop", "tbm")
    robot.says(RobotState.STOP)
    driver.command("start", "tbm")
    robot.executes()
    robot.completes()
    driver.command("disconnect", "tbm")
    check(driver, watched)


def test_after_a_restart_the_states_begin_again_with_a_complete_one(tmp_path):
    watched = _Watched()
    driver = box(tmp_path, on_record=watched)
    robot = driver.executing("tbm")
    driver.kill(3.0)
    robot.says(notifications=("after",))
    driver.command("stop", "tbm")
    check(driver, watched)


def test_the_states_of_a_run_of_all_robots_have_all_robots(tmp_path):
    watched = _Watched()
    driver = box(tmp_path, competition(tbm=[event("HSUF", team="ALL", scoring=())]), on_record=watched)
    robots = robots_of(driver)
    driver.command("connect", "tbm")
    take_ports(driver, robots)
    for robot in robots:
        robot.says()
    driver.command("start", "tbm")
    robots[0].says(notifications=("hello",))
    check(driver, watched)
