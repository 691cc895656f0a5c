"""The session in simulated time: beacons, the private channel, and its messages."""

import pytest

from helpers.robot_bench import BOX, OTHER_BOX, PORT, ROBOT, TEAM, UTC0, executing
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.protocol import BoxState, RobotState
from roah_rsbb.robot import effects as fx
from roah_rsbb.robot.goals import HopfResult, Pose
from roah_rsbb.robot.machine import IllegalEvent

# Beacons and channels.


def test_a_robot_without_a_channel_says_so_each_second(bench):
    bench.run(4.5)
    assert [time for time, _ in bench.beacons] == [1000.0, 1001.0, 1002.0, 1003.0, 1004.0]
    beacon = bench.beacons[2][1]
    assert (beacon.team_name, beacon.robot_name) == (TEAM, ROBOT)
    assert (beacon.time.sec, beacon.time.nsec) == (int(UTC0) + 2, 0)
    assert not bench.sent


def test_a_beacon_that_lists_the_robot_opens_the_channel(bench):
    bench.beacon(port=None)
    bench.run(1.5)
    assert bench.take_news(fx.OpenChannel) == []
    beacons = len(bench.beacons)
    bench.beacon()
    assert bench.take_news(fx.OpenChannel) == [fx.OpenChannel(BOX, PORT)]
    assert bench.last.robot_state == RobotState.STOP, "the first state goes out at once"
    bench.run(3)
    assert len(bench.beacons) == beacons, "no beacons while there is a channel"
    bench.beacon()
    assert bench.take_news(fx.OpenChannel, fx.CloseChannel) == []


def test_another_port_is_another_channel(linked):
    executing(linked)
    linked.beacon(port=6670)
    linked.run(1.5)
    news = linked.take_news()
    assert [type(effect) for effect in news] == [
        fx.StateIs, fx.Stop, fx.BenchmarkIs, fx.CloseChannel, fx.OpenChannel
    ]
    assert news[2].code is None and news[4] == fx.OpenChannel(BOX, 6670)
    assert linked.last.robot_state == RobotState.STOP


def test_a_robot_that_is_not_listed_any_more_halts_and_beacons_again(linked):
    executing(linked)
    linked.run(2)
    beacons, sent = len(linked.beacons), len(linked.sent)
    linked.beacon(port=None)
    assert [type(effect) for effect in linked.take_news()] == [
        fx.StateIs, fx.Stop, fx.BenchmarkIs, fx.CloseChannel
    ]
    assert linked.state is RobotState.STOP and linked.session.progress.benchmark is None
    linked.run(2.5)
    assert len(linked.beacons) == beacons + 3
    assert len(linked.sent) == sent


@pytest.mark.parametrize("port", [0, 65536, 2**32 - 1])
def test_a_port_that_does_not_exist_is_reported_once(bench, port):
    for _ in range(3):
        bench.beacon(port=port)
    assert [report.problem for report in bench.take_news(fx.ProblemIs, fx.OpenChannel)] == [fx.Problem.CHANNEL]


def test_a_channel_that_cannot_be_opened_is_tried_again_and_reported_once(bench):
    for _ in range(3):
        bench.beacon()
        bench.session.channel_failed("port 6667 is in use")
        bench.poll()
        bench.run(1)
    news = bench.take_news(fx.OpenChannel, fx.ProblemIs)
    assert news.count(fx.OpenChannel(BOX, PORT)) == 3
    assert [effect for effect in news if isinstance(effect, fx.ProblemIs)] == [
        fx.ProblemIs(fx.Problem.CHANNEL, "port 6667 is in use")
    ]


# Timing and content of states.


def test_a_change_is_sent_at_once_then_in_a_burst_then_each_second(linked):
    linked.run(10)
    linked.take_sent()
    changed = linked.now
    linked.box_says(BoxState.PREPARE)
    linked.run(3)
    times = [time - changed for time, _ in linked.sent]
    assert times[0] == 0.0
    assert times[:11] == pytest.approx([0.05 * i for i in range(11)])
    assert len(times) == 13 and times[11:] == pytest.approx([1.5, 2.5])
    assert {message.robot_state for _, message in linked.sent} == {RobotState.PREPARING}


@pytest.mark.parametrize("method, arguments", [
    ("add_string", ("visitor", "x")), ("set_device", ("dimmer", 3)), ("display_map", (True,)),
])
def test_what_the_owner_requests_is_sent_at_once(linked, method, arguments):
    linked.run(10)
    linked.take_sent()
    linked.do(method, *arguments)
    assert len(linked.sent) == 1


def test_times_increase_strictly_even_while_the_clock_stands(linked):
    linked.run(1)
    linked.clock_offset -= 0.4
    linked.do("add_string", "visitor", "x")
    linked.run(3)
    times = [(message.time.sec, message.time.nsec) for message in linked.take_sent()]
    assert len(times) > 15
    assert all(earlier < later for earlier, later in zip(times, times[1:]))


def test_nothing_is_sent_that_the_owner_did_not_set(linked):
    assert {field.name for field, _ in linked.last.ListFields()} == {"time", "messages_saved", "robot_state"}


def test_messages_saved_is_repeated(linked):
    linked.session.progress.messages_saved = 12
    linked.run(5)
    assert linked.last.messages_saved == 12
    for wrong in (-1, 2**32):
        with pytest.raises(ValueError, match="0 to 4294967295"):
            linked.session.progress.messages_saved = wrong
    assert linked.session.progress.messages_saved == 12


def test_commands_are_repeated_once_they_were_given_and_forgotten_with_the_channel(linked):
    linked.do("set_device", "switch_2", False)
    linked.do("set_device", "dimmer", 70)
    linked.run(5)
    assert (linked.last.devices_switch_2, linked.last.devices_dimmer) == (False, 70)
    assert linked.last.HasField("devices_switch_2") and not linked.last.HasField("devices_switch_1")
    linked.do("display_map", True)
    linked.do("set_device", "dimmer", 0)
    assert linked.last.tablet_display_map is True and linked.last.devices_dimmer == 0
    linked.beacon(port=6668)
    assert not linked.last.HasField("devices_dimmer") and not linked.last.HasField("tablet_display_map")


@pytest.mark.parametrize("name, value, found", [
    ("switch_4", True, "choose from switch_1, switch_2, switch_3, dimmer, blinds"),
    ("switch_1", 1, "True .on. or False"), ("dimmer", 101, "0 to 100"), ("blinds", -1, "0 to 100"),
    ("blinds", 3.5, "whole"), ("dimmer", True, "whole"),
])
def test_impossible_commands_are_refused(linked, name, value, found):
    with pytest.raises(IllegalEvent, match=found):
        linked.session.set_device(name, value)
    linked.run(1)
    assert not linked.last.HasField("devices_dimmer")


@pytest.mark.parametrize("method, arguments", [
    ("add_string", ("visitor", "x")), ("set_device", ("dimmer", 3)), ("display_map", (True,)),
    ("end_prepare", ()), ("end_execute", ()),
])
def test_without_a_run_there_is_nothing_to_do(bench, method, arguments):
    with pytest.raises(IllegalEvent):
        bench.do(method, *arguments)
    assert bench.state is RobotState.STOP


def test_a_string_is_sent_until_acknowledged_and_not_in_the_next_run(linked):
    linked.do("add_string", "notifications", "hello")
    first = linked.last
    assert list(first.notifications) == ["hello"]
    linked.box_says(BoxState.STOP, acknowledge=pb.Time(sec=first.time.sec - 1, nsec=0))
    linked.run(2)
    assert list(linked.last.notifications) == ["hello"]
    linked.box_says(BoxState.STOP, acknowledge=first.time)
    linked.run(2)
    assert list(linked.last.notifications) == []
    linked.do("add_string", "visitor", "of this run")
    linked.beacon(port=6668)
    assert list(linked.last.visitor) == []


def test_the_largest_message_fits_a_robots_datagram(linked):
    executing(linked, "HOPF")
    linked.session.progress.messages_saved = 2**32 - 1
    for name in ("switch_1", "switch_2", "switch_3"):
        linked.session.set_device(name, True)
    linked.session.set_device("dimmer", 100)
    linked.session.set_device("blinds", 100)
    linked.session.display_map(True)
    for number in range(100):
        linked.session.add_string("notifications", f"{number:03d}" + "x" * 97)
    far = Pose(-1.2345678901234e-100, 1e-5, 3.141592653589793)
    linked.session.end_execute(HopfResult("c" * 50, "i" * 50, far))
    linked.poll()
    assert len(linked.last.notifications) >= 4
    assert len(linked.last.SerializeToString()) <= 987


# -- the session in simulated time: devices and tablet in the box's beacons ---------------------------

# The home.


def test_devices_and_tablet_are_published_when_they_change(bench):
    bench.beacon(devices_bell=pb.Time(sec=5, nsec=0), tablet_call_time=pb.Time(sec=6, nsec=0))
    # What was before the first beacon is no ring now.
    assert [type(effect) for effect in bench.take_news()] == [fx.Devices, fx.TabletIs, fx.OpenChannel]
    same = {"devices_bell": pb.Time(sec=5, nsec=0), "tablet_call_time": pb.Time(sec=6, nsec=0)}
    bench.beacon(**same)
    assert bench.take_news() == []
    bench.beacon(devices_dimmer=30, devices_door_win_detect=True, **same)
    assert bench.take_news() == [fx.Devices((5, 0), False, False, False, 30, 0, True)]


def test_rings_calls_and_positions(bench):
    bench.beacon()
    bench.take_news()
    bench.beacon(devices_bell=pb.Time(sec=5, nsec=0))
    assert fx.BellRang() in bench.take_news()
    bench.beacon(devices_bell=pb.Time(sec=5, nsec=0), tablet_call_time=pb.Time(sec=5, nsec=1))
    news = bench.take_news()
    assert fx.TabletCalled() in news and fx.BellRang() not in news
    bench.beacon(
        devices_bell=pb.Time(sec=5, nsec=0), tablet_call_time=pb.Time(sec=5, nsec=1),
        tablet_position_time=pb.Time(sec=7, nsec=0), tablet_position_x=1.5, tablet_position_y=-2.0,
    )
    assert bench.take_news()[-1] == fx.PositionSelected(1.5, -2.0)


def test_a_box_that_starts_again_does_not_ring(bench):
    bench.beacon(devices_bell=pb.Time(sec=5, nsec=0))
    bench.take_news()
    bench.beacon()
    assert bench.take_news(fx.BellRang) == []


@pytest.mark.parametrize("field, effect", [("devices_bell", fx.BellRang), ("tablet_call_time", fx.TabletCalled)])
def test_a_beacon_that_was_overtaken_makes_no_second_ring(bench, field, effect):
    old, new = pb.Time(sec=100, nsec=0), pb.Time(sec=200, nsec=0)
    for time in (old, new, old, new, old, old, new):
        bench.beacon(**{field: time})
    assert len(bench.take_news(effect)) == 1


def test_a_box_whose_clock_was_set_back_rings_again(bench):
    for second in (200, 100, 100, 100, 100, 100, 150):
        bench.beacon(devices_bell=pb.Time(sec=second, nsec=0))
    assert len(bench.take_news(fx.BellRang)) == 1


def test_nobody_rings_because_the_robot_follows_another_box(bench):
    rang = {"devices_bell": pb.Time(sec=100, nsec=0)}
    bench.beacon(port=None, **rang)
    for _ in range(6):
        bench.beacon(port=PORT, host=OTHER_BOX)
        bench.run(1)
    bench.beacon(port=PORT, **rang)
    assert bench.take_news(fx.BellRang) == []
