"""Clocks: wire times, steps of the box's own clock and of robots, stale and replayed datagrams, silent robots; a busy
computer, which reads datagrams late."""

import pytest

from helpers.box_driver import BoxDriver
from helpers.competition import competition, event
from roah_rsbb.core.effects import Level
from roah_rsbb.core.robots import RobotId
from roah_rsbb.core.timers import ClockWatch
from roah_rsbb.model import run_log
from roah_rsbb.model.clock import MAX_READINGS, Now, one_moment
from roah_rsbb.model.records import EndReason, Phase
from roah_rsbb.protocol import BoxState, RobotState, wire_ns, wire_seconds

MIN, MAX = -(2**63), 2**63 - 1


def test_time_passes_on_both_clocks():
    assert Now(1.0, 100.0).later(2.5) == Now(3.5, 102.5)


@pytest.mark.parametrize("wire_time, ns", [
    ((1, 2), 1_000_000_002),
    ((0, -1), -1),
    ((-1, 0), -1_000_000_000),
    ((5, 3_000_000_000), 8_000_000_000),
    ((2**32, 0), 2**32 * 10**9),
    ((MAX, MAX), MAX * 10**9 + MAX),
    ((MIN, MIN), MIN * 10**9 + MIN),
])
def test_wire_times_of_any_size_are_exact(wire_time, ns):
    assert wire_ns(wire_time) == ns
    assert wire_seconds(wire_time) == pytest.approx(ns / 1e9)


class PausedClocks:
    """Both clocks of a process that pauses each time it has read UTC."""

    def __init__(self, pauses):
        self.mono, self.pauses = 10.0, list(pauses)

    def read_utc(self):
        utc = 1000.0 + self.mono
        self.mono += self.pauses.pop(0)
        return utc


def test_a_pause_between_both_readings_is_no_step_of_the_clock():
    clocks = PausedClocks([0.3, 0.2, 0.0])
    assert one_moment(lambda: clocks.mono, clocks.read_utc) == Now(10.5, 1010.5)


def test_a_machine_that_always_pauses_gets_its_last_reading():
    clocks = PausedClocks([0.3] * MAX_READINGS)
    now = one_moment(lambda: clocks.mono, clocks.read_utc)
    assert (now.mono, clocks.pauses) == (clocks.mono, [])


def test_a_step_of_the_clock_is_reported_once_and_with_its_sign():
    watch = ClockWatch()
    assert watch.look(Now(10.0, 1000.0)) == 0.0
    assert watch.look(Now(20.0, 1010.0)) == 0.0
    assert watch.look(Now(21.0, 1014.0)) == pytest.approx(3.0)
    assert watch.look(Now(22.0, 1015.0)) == 0.0
    assert watch.look(Now(23.0, 916.0)) == pytest.approx(-100.0)
    assert watch.look(Now(24.0, 917.0)) == 0.0


def test_slewing_by_ntp_is_not_a_step():
    watch = ClockWatch()
    assert {watch.look(Now(i / 10, 1000 + i / 10 * 1.0005)) for i in range(36_000)} == {0.0}


def _minute():
    return BoxDriver(competition(tbm=[event(timeout=60.0)]))


@pytest.mark.parametrize("step", [-1e6, -30.0, +30.0, +1e6])
def test_a_step_of_the_boxs_clock_does_not_touch_the_run(step):
    driver = _minute()
    robot = driver.executing()
    robot.lives(30)
    before = driver.run_in().timer(driver.now)
    driver.set_clock(step)
    robot.skew = -step  # the robot's clock was not set
    driver.taken()
    robot.says()
    assert f"The clock of this computer was set by {step:+.3f} s" in driver.notices(Level.WARNING)[0]
    assert any("clock of this computer was set" in text for text in driver.box.watches.warnings(driver.now))
    assert driver.run_in().timer(driver.now) == pytest.approx(before, abs=0.01)
    assert driver.run_in().phase is Phase.RUNNING
    for _ in range(40):
        driver.run(1)
    assert driver.run_in().end_reason is EndReason.TIMEOUT


def test_after_a_step_of_the_boxs_clock_skews_are_measured_again():
    driver = BoxDriver(competition(a=["HWV"], b=[event("HWV", team="Beta")]))
    robot = driver.connected("a")
    other = driver.robot("Beta", "r2")
    other.beacon()
    driver.set_clock(10)
    robot.skew = other.skew = -10
    driver.run(0.1)
    assert driver.run_in("a").link.skew is None
    assert driver.off("connect", "b") == ["Clock skew of robot r2 of team Beta is not known yet"]
    robot.says()
    other.beacon()
    assert driver.run_in("a").link.skew == pytest.approx(-10, abs=0.01)
    assert "is -10.000 s" in driver.off("connect", "b")[0]


def test_a_robot_whose_clock_is_set_right_in_a_run_continues_and_the_referee_is_warned():
    driver = _minute()
    robot = driver.executing()
    robot.skew = +1000
    robot.lives(10)
    robot.skew = 0.0
    robot.lives(3)
    driver.taken()
    assert any("Robot's clock was set back by 1000" in text for text in driver.view().warnings)
    assert "WARNING: Robot's clock was set back" in driver.view().state
    robot.completes()
    assert driver.run_in().end_reason is EndReason.COMPLETED


def test_a_robot_whose_clock_is_set_back_together_with_the_boxs_is_heard_again():
    driver = _minute()
    robot = driver.executing()
    robot.lives(5)
    driver.set_clock(-100.0)
    robot.lives(5)
    assert driver.run_in().link.last_heard == driver.now
    robot.completes()


def test_recorded_datagrams_have_no_effect_while_the_robot_lives():
    driver = BoxDriver(competition(tbm=["HCFGAC"]))
    robot = driver.connected()
    recorded = []

    def says(*args, **fields):
        robot.says(*args, **fields)
        recorded.append(robot.last)

    driver.command("start")
    for state in (RobotState.PREPARING, RobotState.WAITING_GOAL, RobotState.EXECUTING, RobotState.RESULT_TX):
        says(state, notifications=(state.name,), dimmer=state.value)
    says(RobotState.STOP, dimmer=0)
    driver.command("start")
    robot.executes()
    before = (driver.box_state(), driver.run_in().robot_state, len(driver.bags[robot.port]))
    for _ in range(5):
        for report in recorded + recorded[::-1]:
            driver.run(0.02)
            robot.send(report)
        robot.says(notifications=("EXECUTING",))
        before = before[:2] + (len(driver.bags[robot.port]),)
        robot.says(notifications=("EXECUTING",))
        assert (driver.box_state(), driver.run_in().robot_state, len(driver.bags[robot.port])) == before
    assert driver.box_state() is BoxState.WAITING_RESULT


@pytest.mark.parametrize("time", [
    (2**63 - 1, 0), (2**63 - 1, 2**63 - 1), (-(2**63), -(2**63)), (-1, 0), (0, 0), (2**32, 0), (0, 2**63 - 1),
])
def test_absurd_times_do_not_harm_the_box_and_pass(time):
    driver = _minute()
    robot = driver.executing()
    driver.event(driver.box.arrivals.on_robot_beacon, "10.0.0.5", "Beta", "r2", time)
    robot.says(time=time)
    assert driver.view().state
    for _ in range(6):
        robot.says(after=1.0)
        assert driver.view().state
    assert driver.run_in().link.times_valid
    robot.completes()
    assert driver.run_in().end_reason is EndReason.COMPLETED


@pytest.mark.parametrize("skew", [0.15, -0.15])
def test_times_that_arrive_while_the_skew_is_out_of_bounds_are_marked_in_state_and_log(skew):
    driver = BoxDriver(competition(tbm=["HWV"]))
    robot = driver.executing()
    robot.lives(5)
    payloads = driver.logged(robot.port, run_log.CLIENT_PAYLOAD)
    assert not any("time_valid" in text for text in payloads)
    assert "INVALID" not in driver.view().state

    robot.skew = skew
    robot.lives(4)
    robot.says(notifications=("doorbell",))
    assert "WARNING: Robot's times are INVALID: clock skew" in driver.view().state
    marked = driver.logged(robot.port, run_log.CLIENT_PAYLOAD)[len(payloads):]
    assert marked and all("time_valid: false" in text for text in marked)
    assert "doorbell (robot's time invalid: clock skew)" in driver.view().online_data

    robot.skew = 0.0
    robot.lives(4)
    assert "INVALID" not in driver.view().state
    assert "time_valid" not in driver.logged(robot.port, run_log.CLIENT_PAYLOAD)[-1]


def test_a_robot_that_falls_silent_is_reported_once_and_its_run_continues():
    driver = _minute()
    robot = driver.executing()
    driver.taken()
    driver.run(30)
    assert driver.notices(Level.WARNING) == [
        "No message from the robot for 3 s",
        "The robot has disappeared: no message for 10 s, and no beacon from its address. It may still be moving, "
        "and STOP may not reach it: check it",
    ]
    assert "WARNING: The robot has disappeared: no message for 30 s" in driver.view().state
    assert driver.run_in().phase is Phase.RUNNING
    robot.says()
    assert "No message" not in driver.view().state and "disappeared" not in driver.view().state


BEACONS_ONLY = (", but its beacons arrive: its program was restarted, or a firewall blocks the private channel. Check "
                "whether it moves")


def test_a_robot_that_sends_beacons_only_has_not_disappeared():
    driver = _minute()
    robot = driver.executing()
    driver.taken()
    driver.run(2)
    robot.beacon(19)
    assert driver.view().warnings == (f"No message from the robot for 20 s{BEACONS_ONLY}",)
    notices = driver.notices(Level.WARNING)
    assert [text.endswith(BEACONS_ONLY) for text in notices] == [True], notices
    driver.run(5)
    assert driver.view().warnings == ("No message from the robot for 20 s",), "the beacons may only be late"
    driver.run(5)
    assert driver.view().warnings[0].startswith(
        "The robot has disappeared: no message for 30 s, and no beacon from its address.")
    robot.beacon()
    assert driver.view().warnings == (f"No message from the robot for 30 s{BEACONS_ONLY}",)
    driver.run(30)
    later = driver.notices(Level.WARNING)
    assert [text[:46] for text in later] == ["The robot has disappeared: no message for 30 s"], "once in a silence"
    robot.says()
    assert driver.view().warnings == ()


def test_a_beacon_of_before_the_run_says_nothing_about_its_silence():
    driver = _minute()
    robot = driver.connected()
    driver.run(5)
    assert driver.view().warnings == ("No message from the robot for 5 s",)
    assert robot.port is not None


def test_a_robot_whose_messages_are_old_has_not_disappeared():
    driver = _minute()
    robot = driver.executing()
    for _ in range(30):
        driver.run(1.0)
        robot.send(robot.last)
    assert driver.view().warnings[0].startswith("No message from the robot for 30 s but old ones: its clock")


def test_what_cannot_be_read_on_the_private_channel_is_before_the_referees_eyes():
    driver = _minute()
    driver.robot().beacon()
    driver.command("connect")
    port = driver.run_in().port
    driver.event(driver.box.arrivals.on_unreadable, port, "10.0.0.2 sends what does not decrypt: wrong password?")
    driver.event(driver.box.arrivals.on_unreadable, port + 1, "nobody's")
    assert "10.0.0.2 sends what does not decrypt: wrong password?" in driver.view().state
    assert "nobody's" not in driver.view().state


class Late:
    """What the robots of a busy box send. The box reads it later."""

    def __init__(self, driver):
        self.driver = driver
        self._waiting = []

    def beacon(self, robot):
        said = robot.host, robot.team, robot.name, robot.time()
        self._waiting.append((self.driver.box.arrivals.on_robot_beacon, said))
        self._stamp()

    def says(self, robot, *args, host=None, **fields):
        report = robot.report(*args, **fields)
        self._waiting.append((self.driver.box.arrivals.on_robot_report, (robot.port, host or robot.host, report)))
        self._stamp()

    def _stamp(self):
        method, arguments = self._waiting[-1]
        self._waiting[-1] = method, (*arguments, self.driver.now.utc)

    def read(self):
        """The box reads everything now."""
        waiting, self._waiting = self._waiting, []
        for method, arguments in waiting:
            self.driver.event(method, *arguments)
        self.driver.event(self.driver.box.timers.tick)


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


def test_a_box_that_was_stopped_reports_one_silence():
    """It looks first, and reads then what arrived meanwhile."""
    driver, robot, late = _connected()
    driver.command("start")
    driver.taken()
    for _ in range(130):
        driver.jump(0.03)
        late.says(robot)
    driver.event(driver.box.timers.tick)
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


@pytest.mark.parametrize("sent_s, end, elapsed_s", [
    (59.9, EndReason.COMPLETED, 59.9), (60.1, EndReason.TIMEOUT, 60.0)])
def test_a_result_within_the_time_counts_although_it_is_read_after_it(sent_s, end, elapsed_s):
    driver, robot, late = _connected(timeout=60.0)
    driver.command("start")
    robot.executes()
    driver.jump(sent_s - driver.run_in().clock.elapsed(driver.now))
    late.says(robot, RobotState.RESULT_TX)
    driver.jump(1.0)
    late.read()
    run = driver.run_in()
    assert (run.end_reason, run.record(driver.now).elapsed_s) == (end, pytest.approx(elapsed_s))


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
    driver.event(driver.box.timers.tick)
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
    driver.event(driver.box.arrivals.on_robot_report, robot.port, robot.host, robot.report(), driver.now.utc + 5.0)
    assert driver.run_in().link.last_heard == driver.now != before
