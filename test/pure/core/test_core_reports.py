"""After a report, the box only checks the run concerned. This must neither change nor delay anything."""

from hypothesis import given
from hypothesis import strategies as st

from helpers.box_driver import BoxDriver
from helpers.commands import COMMANDS
from helpers.competition import competition, event
from helpers.examples import examples
from roah_rsbb.core.settings import Settings
from roah_rsbb.model.reason import Refused
from roah_rsbb.protocol import RobotState

ROBOTS = (("Alpha", "r1"), ("Beta", "r1"), ("Gamma", "r1"))
ZONES = ("a", "b", "all")
ROBOT = st.integers(0, len(ROBOTS) - 1)
STATES = st.sampled_from([*RobotState, RobotState.EXECUTING, RobotState.RESULT_TX])

ACTS = st.one_of(
    *[st.tuples(st.just("report"), ROBOT, STATES, st.sampled_from([0, 1]))] * 4,
    st.tuples(st.just("command"), st.sampled_from(ZONES), st.sampled_from([*sorted(COMMANDS), "start", "connect"])),
    st.tuples(st.just("beacon"), ROBOT),
    st.tuples(st.just("jump"), st.sampled_from([0.01, 0.5, 2.0, 4.0, 20.0])),
    st.tuples(st.just("failed"), st.integers(6667, 6670)),
)


class _Side:
    """A box and its robots, without ticks between the events."""

    def __init__(self, looks_at_all):
        settings = Settings(check_messages_saved=True, check_messages_saved_timeout=3.0)
        self.driver = BoxDriver(competition(
            a=[event("HWV", team="Alpha", timeout=30.0)], b=[event("HGTKMH", team="Beta", timeout=15.0)],
            all=[event("HSUF", team="ALL", timeout=20.0)],
        ), settings)
        self._looks_at_all = looks_at_all
        self.robots = [self.driver.robot(team, name, host=f"10.0.0.{i}") for i, (team, name) in enumerate(ROBOTS)]
        for robot in self.robots:
            robot.beacon()

    def deadline(self):
        self._forget()
        return self.driver.box.deadline()

    def _forget(self):
        """Have the box look at all runs at the next report, as if it never remembered when one is due."""
        if self._looks_at_all:
            self.driver.box._calm_until = None

    def act(self, kind, *what):
        driver = self.driver
        self._forget()
        if kind == "jump":
            driver.jump(*what)
        elif kind == "beacon":
            self.robots[what[0]].beacon()
        elif kind == "failed":
            driver.event(driver.box.on_channel_failed, what[0], "in use")
        elif kind == "command":
            try:
                driver.command(*reversed(what))
            except Refused:
                return
        else:
            self._report(*what)

    def _report(self, index, state, saved):
        robot = self.robots[index]
        for run in self.driver.box.zones.members():
            if run.robot == (robot.team, robot.name):
                self.driver.jump(0.001)
                robot.port = run.port
                robot.send(robot.report(state, messages_saved=saved))


@examples(150)
@given(st.lists(ACTS, max_size=60), st.sampled_from([("a", "b"), ("all",)]))
def test_the_box_does_the_same_as_one_that_looks_at_all_runs_each_time(acts, begun):
    sides = [_Side(looks_at_all=False), _Side(looks_at_all=True)]
    acts = [
        *[("command", zone, "connect") for zone in begun], *[("report", i, RobotState.STOP, 1) for i in range(3)],
        *[("command", zone, "start") for zone in begun], *[("report", i, RobotState.WAITING_GOAL, 1) for i in range(3)],
        *acts,
    ]
    for act in acts:
        for side in sides:
            side.act(*act)
        ours, theirs = (side.deadline() for side in sides)
        assert (ours is None) == (theirs is None)
        assert ours is None or ours <= theirs
        assert sides[0].driver.effects == sides[1].driver.effects, act


def test_one_robot_that_reports_does_not_hide_that_another_is_silent():
    driver = BoxDriver(competition(a=["HWV"], b=[event("HGTKMH", team="Beta")]))
    talks = driver.connected("a")
    driver.connected("b", team="Beta", host="10.0.0.3")
    driver.taken()
    for _ in range(40):
        driver.jump(0.1)
        talks.send(talks.report())
    assert any("No message from the robot for 3 s" in text for text in driver.notices())


def test_runs_that_nothing_is_due_in_are_not_looked_at_for_a_report():
    """The load of 100 robots at 50 ms depends on this."""
    driver = BoxDriver(competition(a=["HWV"], b=[event("HGTKMH", team="Beta")]))
    talks = driver.connected("a")
    driver.connected("b", team="Beta", host="10.0.0.3")
    looks = []
    quiet = driver.run_in("b")
    tick = quiet.tick
    quiet.tick = lambda now: (looks.append(now), tick(now))
    for _ in range(20):
        driver.jump(0.05)
        talks.send(talks.report())
    assert len(looks) <= 1


def test_a_run_that_moved_to_another_port_is_looked_at_again():
    driver = BoxDriver(competition(a=["HWV"], b=[event("HGTKMH", team="Beta")]))
    stuck = driver.connected("a")
    beta = driver.robot(team="Beta", host="10.0.0.3")
    beta.beacon()
    driver.command("connect", "b")
    driver.run(10.0)
    stuck.send(stuck.last)
    driver.event(driver.box.on_channel_failed, driver.run_in("b").port, "in use")
    driver.taken()
    driver.jump(3.5)
    stuck.send(stuck.last)
    assert any("has not answered" in text for text in driver.notices())
