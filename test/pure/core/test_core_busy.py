"""A busy computer: the box reads datagrams late, and knows from the system when they arrived."""

import pytest

from helpers.box_driver import BoxDriver
from helpers.competition import competition, event
from roah_rsbb.core.robots import RobotId
from roah_rsbb.model.records import EndReason, Phase
from roah_rsbb.protocol import RobotState


class Late:
    """What the robots of a busy box send. The box reads it later."""

    def __init__(self, driver):
        self.driver = driver
        self._waiting = []

    def beacon(self, robot):
        self._waiting.append((self.driver.box.on_robot_beacon, (robot.host, robot.team, robot.name, robot.time())))
        self._stamp()

    def says(self, robot, *args, host=None, **fields):
        report = robot.report(*args, **fields)
        self._waiting.append((self.driver.box.on_robot_report, (robot.port, host or robot.host, report)))
        self._stamp()

    def _stamp(self):
        method, arguments = self._waiting[-1]
        self._waiting[-1] = method, (*arguments, self.driver.now.utc)

    def read(self):
        """The box reads everything now."""
        waiting, self._waiting = self._waiting, []
        for method, arguments in waiting:
            self.driver.event(method, *arguments)
        self.driver.event(self.driver.box.tick)


def _connected(code="HGTKMH", **of_event):
    driver = BoxDriver(competition(tbm=[event(code, **of_event)]))
    return driver, driver.connected(), Late(driver)


@pytest.mark.parametrize("busy_s", [0.2, 1.0, 5.0])
def test_a_delay_in_the_box_is_no_skew_of_the_robot(busy_s):
    driver = BoxDriver()
    robot, late = driver.robot(), Late(driver)
    for _ in range(5):
        late.beacon(robot)
        driver.jump(busy_s)
        late.read()
    assert driver.off("connect") == []
    driver.command("connect")
    robot.port = driver.run_in().port
    for _ in range(5):
        late.says(robot)
        driver.jump(busy_s)
        late.read()
        assert driver.run_in().link.skew == pytest.approx(0.0, abs=1e-5)
    late.says(robot)
    driver.jump(0.15)
    late.read()
    assert driver.off("start") == []


def test_a_skew_is_seen_although_the_box_is_busy():
    driver, robot, late = _connected()
    robot.skew = -0.15
    for _ in range(5):
        late.says(robot)
        driver.jump(1.0)
        late.read()
    assert driver.run_in().link.skew == pytest.approx(-0.15, abs=1e-5)
    assert any("Clock skew of the robot is -0.150 s" in reason for reason in driver.off("start"))


def test_a_robot_is_not_silent_because_the_box_was_busy():
    driver, robot, late = _connected()
    driver.command("start")
    driver.taken()
    for _ in range(6):
        driver.jump(1.0)
        late.says(robot)
    late.read()
    assert not any("No message" in text for text in driver.notices())
    assert driver.view().warnings == ()


def test_a_box_that_was_stopped_reports_one_silence():
    """It looks first, and reads then what arrived meanwhile."""
    driver, robot, late = _connected()
    driver.command("start")
    driver.taken()
    for _ in range(130):
        driver.jump(0.03)
        late.says(robot)
    driver.event(driver.box.tick)
    late.read()
    assert sum("No message" in text for text in driver.notices()) == 1
    assert driver.view().warnings == ()
    driver.run(6.0)
    assert sum("No message" in text for text in driver.notices()) == 1, "the next silence is another one"


def test_the_silence_of_a_robot_counts_from_its_last_message_not_from_the_moment_of_reading():
    driver, robot, late = _connected()
    late.says(robot)
    driver.jump(2.9)
    late.read()
    assert not driver.run_in().link.is_silent(driver.now)
    driver.run(0.1)
    assert driver.run_in().link.is_silent(driver.now)


def test_a_result_within_the_time_counts_although_it_is_read_after_it():
    driver, robot, late = _connected(timeout=60.0)
    driver.command("start")
    robot.executes()
    driver.jump(59.9 - driver.run_in().clock.elapsed(driver.now))
    late.says(robot, RobotState.RESULT_TX)
    driver.jump(1.0)
    late.read()
    run = driver.run_in()
    assert run.end_reason is EndReason.COMPLETED
    assert run.record(driver.now).elapsed_s == pytest.approx(59.9)


def test_a_result_after_the_time_does_not_count():
    driver, robot, late = _connected(timeout=60.0)
    driver.command("start")
    robot.executes()
    driver.jump(60.1)
    late.says(robot, RobotState.RESULT_TX)
    driver.jump(1.0)
    late.read()
    assert driver.run_in().end_reason is EndReason.TIMEOUT


def test_another_host_with_the_password_does_not_replace_the_robot_because_the_box_was_busy():
    driver, robot, late = _connected()
    driver.command("start")
    robot.executes()
    driver.jump(0.5)
    late.says(robot, RobotState.RESULT_TX, host="10.0.0.66")
    driver.jump(0.5)
    late.says(robot)
    driver.jump(4.0)
    late.read()
    assert driver.channels == {robot.port: robot.host}
    assert driver.run_in().phase is Phase.RUNNING


def test_the_boxs_own_times_never_go_back():
    """A result takes effect after what the box did since it arrived."""
    driver, robot, late = _connected(timeout=60.0)
    driver.command("start")
    began = driver.now.mono
    robot.executes()
    driver.jump(0.1)
    late.says(robot, RobotState.RESULT_TX)
    driver.jump(0.5)
    driver.event(driver.box.tick)
    did = driver.now.mono
    driver.jump(0.5)
    late.read()
    assert driver.run_in().phase is Phase.ENDED
    assert driver.run_in().record(driver.now).elapsed_s == pytest.approx(did - began)


def test_the_order_of_reading_does_not_matter_for_what_is_known_of_a_robot():
    """The box reads one socket after the other."""
    driver = BoxDriver(competition(teams=("Alpha", "Beta", "Gamma"), a=["HWV"], b=[event("HWV", team="Beta")]))
    one, two = driver.connected("a"), driver.connected("b", team="Beta", host="10.0.0.3")
    three = driver.robot("Gamma", host="10.0.0.4", skew=-0.2)
    three.beacon()
    three.skew = 0.0
    late = {robot: Late(driver) for robot in (one, two, three)}
    driver.jump(0.5)
    late[two].says(two, RobotState.EXECUTING, host="10.0.0.66")
    for _ in range(5):
        driver.jump(0.5)
        late[one].says(one)
        late[two].says(two)
        late[three].beacon(three)
    driver.jump(0.3)
    for robot in (one, two, three):
        late[robot].read()
    assert driver.channels == {one.port: one.host, two.port: two.host}
    assert driver.run_in("b").link.skew == pytest.approx(0.0, abs=1e-5)
    assert driver.box.robots.find(RobotId("Gamma", "r1")).skew.seconds == pytest.approx(0.0, abs=1e-5)


def test_a_message_from_before_a_command_is_no_answer_to_it():
    driver, robot, late = _connected()
    driver.command("start")
    robot.executes()
    driver.run_in().link.sample(driver.now, 0)
    driver.jump(0.1)
    late.says(robot, RobotState.STOP)
    driver.jump(0.1)
    driver.command("stop")
    driver.jump(0.1)
    late.read()
    sample = driver.run_in().link.sample(driver.now, 0)
    assert (sample.received, sample.answers, sample.round_trip_s) == (1, 0, None)


@pytest.mark.parametrize("step", [-30.0, -0.2, 0.2, 30.0])
def test_a_datagram_from_before_a_step_of_the_clock_is_no_sample_on_the_new_clock(step):
    driver, robot, late = _connected()
    driver.jump(0.01)
    late.says(robot)
    driver.jump(0.01)
    driver.set_clock(step)
    robot.skew = -step  # the robot's clock was not set
    late.read()
    driver.run(0.1)
    late.says(robot)
    driver.jump(0.5)
    late.read()
    assert driver.run_in().link.skew == pytest.approx(-step, abs=0.02)


def test_a_time_to_come_is_none():
    """The system's clock was set back between the arrival and the reading."""
    driver, robot, late = _connected()
    before = driver.run_in().link.last_heard
    driver.run(1.0)
    driver.event(driver.box.on_robot_report, robot.port, robot.host, robot.report(), driver.now.utc + 5.0)
    assert driver.run_in().link.last_heard == driver.now != before
