"""The session in simulated time: devices and tablet in the box's beacons."""

import pytest

from helpers.robot_bench import OTHER_BOX, PORT
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.robot import effects as fx

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


def test_a_beacon_of_before_2019_lacks_the_door_detector(bench):
    bench.beacon(devices_door_win_detect=None)
    assert bench.take_news(fx.Devices)[0].door_win_detect is False


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
