"""The session in simulated time: silence, wrong passwords, twins, and more than one box."""

import pytest

from helpers.robot_bench import BOX, OTHER_BOX, PORT, ROBOT, TEAM, executing
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.protocol import BoxState, RobotState
from roah_rsbb.robot import effects as fx
from roah_rsbb.robot.session import BOX_STARTS_S

# Trouble.


def test_no_box_is_reported_once_and_its_return_too(bench):
    bench.run(BOX_STARTS_S - 0.1)
    assert bench.take_news() == [], "it may be starting"
    bench.run(20)
    assert [(report.problem, report.over) for report in bench.take_news()] == [(fx.Problem.NO_BOX, False)]
    bench.beacon(port=None)
    reports = bench.take_news(fx.ProblemIs)
    assert [(report.problem, report.over) for report in reports] == [(fx.Problem.NO_BOX, True)]
    bench.run(5.1)
    assert len(bench.take_news(fx.ProblemIs)) == 1


def test_a_box_silent_on_the_private_channel_is_reported_once(linked):
    for second in range(12):
        linked.beacon()
        if second < 3:
            linked.box_says(BoxState.PREPARE)
        linked.run(1)
    reports = linked.take_news(fx.ProblemIs)
    assert [(report.problem, report.over) for report in reports] == [(fx.Problem.BOX_SILENT, False)]
    assert BOX in reports[0].text and str(PORT) in reports[0].text and "password" not in reports[0].text
    assert linked.state is RobotState.PREPARING, "a bad network ends no run"
    linked.box_says(BoxState.PREPARE)
    assert [(report.problem, report.over) for report in linked.take_news()] == [(fx.Problem.BOX_SILENT, True)]


def test_a_box_that_has_never_answered_may_have_another_password(linked):
    for _ in range(6):
        linked.beacon()
        linked.run(1)
    report, = linked.take_news(fx.ProblemIs)
    assert report.problem is fx.Problem.BOX_SILENT
    assert "the same password in the box" in report.text and "firewall" in report.text


def test_a_wrong_password_is_reported_once_and_not_taken_for_silence(linked):
    for _ in range(20):
        linked.beacon()
        linked.session.private_undecodable(linked.now, BOX)
        linked.run(1)
    reports = linked.take_news(fx.ProblemIs)
    assert [report.problem for report in reports] == [fx.Problem.WRONG_PASSWORD]
    assert "password of team Team" in reports[0].text


def test_a_bad_datagram_from_elsewhere_or_after_good_ones_is_not_a_wrong_password(linked):
    linked.session.private_undecodable(linked.now, OTHER_BOX)
    linked.box_says(BoxState.STOP)
    linked.session.private_undecodable(linked.now, BOX)
    linked.poll()
    assert linked.take_news(fx.ProblemIs) == []


@pytest.mark.parametrize("private", [False, True])
def test_another_robot_of_the_same_name_is_reported_once_for_each_address(linked, private):
    for host in ("127.0.0.7", "127.0.0.7", "127.0.0.8"):
        if private:
            twin = pb.RobotState(time=pb.Time(sec=1, nsec=0), messages_saved=0, robot_state=0)
            linked.session.private_message(linked.now, twin, (host, PORT))
        else:
            twin = pb.RobotBeacon(team_name=TEAM, robot_name=ROBOT, time=pb.Time(sec=1, nsec=0))
            linked.session.public_message(linked.now, twin, (host, 6666))
    linked.poll()
    reports = linked.take_news()
    assert [report.problem for report in reports] == [fx.Problem.SAME_NAME] * 2
    assert "127.0.0.7" in reports[0].text and "127.0.0.8" in reports[1].text


def test_other_robots_and_the_tablet_are_ignored(linked):
    time = pb.Time(sec=1, nsec=0)
    for team, robot in (("Other", ROBOT), (TEAM, "Other")):
        other = pb.RobotBeacon(team_name=team, robot_name=robot, time=time)
        linked.session.public_message(linked.now, other, ("127.0.0.7", 6666))
    tablet = pb.TabletBeacon(last_call=time, last_pos=time, x=1.0, y=2.0)
    linked.session.public_message(linked.now, tablet, ("127.0.0.7", 6666))
    linked.poll()
    assert linked.take_news() == []


def test_a_flood_of_twins_is_bounded(linked):
    for number in range(10_000):
        twin = pb.RobotBeacon(team_name=TEAM, robot_name=ROBOT, time=pb.Time(sec=1, nsec=0))
        linked.session.public_message(linked.now, twin, (f"10.0.{number // 256}.{number % 256}", 6666))
    linked.poll()
    assert len(linked.take_news()) == 100


# More than one box.


@pytest.mark.parametrize("port", [None, PORT, 7001])
def test_another_box_changes_nothing_while_ours_is_heard(linked, port):
    executing(linked)
    for _ in range(10):
        linked.beacon()
        linked.beacon(port=port, host=OTHER_BOX, devices_switch_1=True)
        linked.run(1)
    reports = [effect for effect in linked.take_news(fx.ProblemIs) if effect.problem is fx.Problem.ANOTHER_BOX]
    assert len(reports) == 1 and OTHER_BOX in reports[0].text and BOX in reports[0].text
    assert linked.state is RobotState.EXECUTING
    assert linked.take_news(fx.Devices, fx.CloseChannel, fx.OpenChannel) == []


def test_another_box_takes_over_when_ours_is_gone(linked):
    executing(linked)
    for _ in range(5):
        linked.run(1)
        linked.beacon(port=7001, host=OTHER_BOX)
    assert linked.take_news(fx.OpenChannel) == []
    linked.run(1)
    linked.beacon(port=7001, host=OTHER_BOX)
    assert linked.take_news(fx.OpenChannel) == [fx.OpenChannel(OTHER_BOX, 7001)]
    assert linked.state is RobotState.STOP


@pytest.mark.parametrize("is_stopped", [False, True])
def test_a_standby_takes_over_at_once_when_our_box_is_gone(linked, is_stopped):
    """It lists the robot with the port that it has. The robot stays in its state."""
    executing(linked)
    if is_stopped:
        linked.box_says(BoxState.STOP)
    state = linked.state
    linked.run(4)
    linked.beacon(host=OTHER_BOX)
    assert linked.take_news(fx.OpenChannel) == []
    linked.run(2)
    linked.beacon(host=OTHER_BOX)
    assert linked.take_news(fx.OpenChannel, fx.StateIs, fx.Prepare) == [fx.OpenChannel(OTHER_BOX, PORT)]
    linked.run(1)
    linked.box_says(BoxState.STOP if is_stopped else BoxState.WAITING_RESULT, host=OTHER_BOX)
    assert linked.state is state and linked.take_news(fx.StateIs, fx.Prepare, fx.Stop) == []


@pytest.mark.parametrize("on_public_channel", [True, False])
def test_another_box_takes_nothing_over_because_the_network_was_away(linked, on_public_channel):
    """It is only the first one that is heard again."""
    executing(linked)
    linked.beacon(port=7001, host=OTHER_BOX)
    for _ in range(2):
        linked.run(10)
        for _ in range(4):
            linked.beacon(port=7001, host=OTHER_BOX)
            linked.run(1)
        if on_public_channel:
            linked.beacon()
        else:
            linked.box_says(BoxState.WAITING_RESULT)
    assert linked.take_news(fx.OpenChannel, fx.CloseChannel) == []
    assert linked.state is RobotState.EXECUTING


def test_of_two_boxes_that_list_the_robot_it_finds_the_one_that_answers(bench):
    """A robot that starts again in the middle of its run cannot know which box is its own."""
    for second in range(6):
        bench.beacon(port=9999, host=OTHER_BOX)
        bench.beacon()
        opened = bench.take_news(fx.OpenChannel)
        assert opened == {0: [fx.OpenChannel(OTHER_BOX, 9999)], 5: [fx.OpenChannel(BOX, PORT)]}.get(second, [])
        bench.run(1)
    for _ in range(10):
        bench.beacon(port=9999, host=OTHER_BOX)
        bench.beacon()
        bench.box_says(BoxState.PREPARE)
        bench.run(1)
    bench.run(10)  # its own box is silent, but it is the one
    bench.beacon(port=9999, host=OTHER_BOX)
    assert bench.take_news(fx.OpenChannel) == []
    assert bench.state is RobotState.PREPARING


@pytest.mark.parametrize("port", [None, 6670])
def test_forged_beacons_of_our_box_do_not_end_a_run_that_continues(linked, port):
    executing(linked)
    for number in range(100):
        linked.beacon(port=port, devices_bell=pb.Time(sec=number + 1, nsec=0), devices_switch_1=number % 2 == 0)
        linked.run(0.05)
        if number % 20 == 0:
            linked.beacon()
            linked.box_says(BoxState.WAITING_RESULT)
    assert linked.state is RobotState.EXECUTING
    [report] = linked.take_news(fx.ProblemIs, fx.CloseChannel, fx.BellRang, fx.Devices)
    assert report.problem is fx.Problem.ANOTHER_BOX
    assert f"beacons from {BOX} take this robot out of its run, but the box there continues it" in report.text


@pytest.mark.parametrize("port", [None, 6670])
def test_a_run_ends_soon_after_the_beacon_that_ends_it(linked, port):
    """A message of the box that the beacon has overtaken does not hold it up."""
    executing(linked)
    linked.beacon(port=port)
    linked.run(0.1)
    linked.box_says(BoxState.WAITING_RESULT)
    linked.run(1.4)
    assert linked.state is RobotState.EXECUTING
    linked.run(0.1)
    assert linked.state is RobotState.STOP
    left = linked.take_news(fx.CloseChannel, fx.OpenChannel, fx.ProblemIs)
    assert left == [fx.CloseChannel()] + ([] if port is None else [fx.OpenChannel(BOX, port)])


def test_recorded_states_of_the_box_do_not_keep_a_robot_in_a_run(linked):
    executing(linked)
    recorded = linked.last_time
    linked.run(2.0)
    linked.box_says(BoxState.WAITING_RESULT)
    linked.beacon(port=None)
    for _ in range(20):
        linked.run(0.1)
        linked.box_says(BoxState.WAITING_RESULT, acknowledge=recorded)
    assert linked.state is RobotState.STOP
