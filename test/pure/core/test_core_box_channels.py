"""Private ports, channels that cannot be opened, and the size of the beacon."""

import pytest

from helpers.box_driver import BoxDriver, beacon_bytes
from helpers.competition import competition, event
from roah_rsbb.core import effects
from roah_rsbb.core.connections import MAX_PORTS_TRIED
from roah_rsbb.core.effects import Level, OpenChannel, PortTaken
from roah_rsbb.core.settings import Settings
from roah_rsbb.model.messages import DevicesState, TabletState
from roah_rsbb.model.reason import Refused


def _connect(driver, zone="tbm"):
    driver.robot().beacon()
    driver.taken()
    driver.command("connect", zone)
    return driver.taken()


def _ports(taken):
    return [effect.port for effect in taken if isinstance(effect, OpenChannel)]


def test_the_first_port_is_the_one_above_the_public_one():
    driver = BoxDriver(settings=Settings(rsbb_port=7000))
    assert _connect(driver)[1:3] == [PortTaken(7001), OpenChannel(7001, "Alpha", "10.0.0.2")]


@pytest.mark.parametrize("last_port, first", [(None, 6667), (0, 6667), (6000, 6667), (6666, 6667), (6700, 6701)])
def test_after_a_restart_the_ports_on_record_are_not_used_again(last_port, first):
    driver = BoxDriver(last_port=last_port)
    assert _ports(_connect(driver)) == [first]


def test_no_port_is_used_twice():
    driver = BoxDriver()
    ports = []
    for _ in range(50):
        ports += _ports(_connect(driver))
        driver.command("disconnect")
    assert ports == list(range(6667, 6717))


def test_a_channel_that_cannot_be_opened_takes_the_next_port():
    driver = BoxDriver()
    driver.unusable_ports = {6667, 6668}
    taken = _connect(driver)
    assert [e.port for e in taken if isinstance(e, PortTaken)] == [6667, 6668, 6669]
    assert driver.run_in().port == 6669
    assert driver.channels == {6669: "10.0.0.2"}
    assert driver.box.beacon().robots == (("Alpha", "r1", 6669),)
    warnings = [e.text for e in taken if isinstance(e, effects.Notice) and e.level is Level.WARNING]
    assert warnings == [
        f"UDP port {port} cannot be used for the private channel: Address already in use" for port in (6667, 6668)
    ]
    assert set(driver.states) == {6669}
    assert [e.port for e in taken if isinstance(e, effects.RunClosed)] == [6667, 6668]


def test_a_run_is_given_up_after_many_ports():
    driver = BoxDriver()
    driver.unusable_ports = set(range(6667, 7000))
    taken = _connect(driver)
    assert _ports(taken) == list(range(6667, 6667 + MAX_PORTS_TRIED))
    assert driver.run_in() is None
    assert driver.box.beacon().robots == ()
    errors = [e.text for e in taken if isinstance(e, effects.Notice) and e.level is Level.ERROR]
    assert errors == ["No private channel could be opened: the run was not begun"]
    driver.unusable_ports = set()
    assert _ports(_connect(driver)) == [6667 + MAX_PORTS_TRIED]


def test_ports_can_be_used_up():
    driver = BoxDriver(last_port=65533)
    driver.unusable_ports = {65534}
    assert _ports(_connect(driver)) == [65534, 65535]
    driver.command("disconnect")
    with pytest.raises(Refused, match="All UDP ports up to 65535 are used up: start the box with another log_dir"):
        driver.command("connect")


def test_the_last_port_that_cannot_be_opened_ends_the_run():
    driver = BoxDriver(last_port=65534)
    driver.unusable_ports = {65535}
    assert _ports(_connect(driver)) == [65535]
    assert driver.run_in() is None
    assert "All UDP ports" in driver.off("connect")[0]


def test_a_robot_that_went_meanwhile_gets_no_other_port():
    driver = BoxDriver()
    _connect(driver)
    driver.run(40)
    assert driver.box.robots.all(driver.now) == []
    driver.event(driver.box.on_channel_failed, 6667, "gone")
    assert driver.run_in() is None
    assert _ports(driver.taken()) == []


def test_news_of_a_channel_that_is_gone_are_none():
    driver = BoxDriver()
    _connect(driver)
    driver.command("disconnect")
    driver.taken()
    driver.event(driver.box.on_channel_failed, 6667, "late")
    assert driver.taken() == []


def _many_zones(count):
    return competition(
        teams=[f"Team{i}" for i in range(count)],
        **{f"zone{i}": [event("HWV", team=f"Team{i}")] for i in range(count)},
    )


def _connect_all(driver, count):
    """Connect the robots of all zones; returns how many could be."""
    for i in range(count):
        driver.robot(f"Team{i}", f"robot{i}", f"10.0.0.{i + 2}").beacon()
        try:
            driver.command("connect", f"zone{i}")
        except Refused as refused:
            return i, refused.reasons
    return count, []


def test_a_beacon_that_would_be_too_large_refuses_connect_with_its_size():
    driver = BoxDriver(_many_zones(40))
    connected, reasons = _connect_all(driver, 40)
    assert connected == (1024 - 100) // 32
    size = 100 + 32 * (connected + 1)
    assert reasons == [
        f"The beacon may need {size} bytes with one more robot, and robots may read only 1024: end another run first, "
        "or raise max_datagram if all robots are known to read more"
    ]
    driver.command("disconnect", "zone0")
    assert driver.off("connect", f"zone{connected}") == []


def test_robots_that_are_known_to_read_more_raise_the_limit():
    driver = BoxDriver(_many_zones(40), Settings(max_datagram=2000))
    assert _connect_all(driver, 40) == (40, [])


def test_the_beacon_keeps_to_its_size_whatever_devices_and_tablet_say_later():
    """Measured in real bytes: a ring of the bell lengthens the beacon."""
    core_radio_size = pytest.importorskip("roah_rsbb.comm.frame").encoded_size
    wire_convert = pytest.importorskip("roah_rsbb.radio.wire_convert")

    def size(beacon):
        return core_radio_size(wire_convert.beacon_message(beacon))

    driver = BoxDriver(_many_zones(60), beacon_size=size)
    connected, reasons = _connect_all(driver, 60)
    assert 20 <= connected < 60
    assert "The beacon may need" in reasons[0]
    longest = (2**32 - 1, 999_999_999)
    driver.event(driver.box.on_devices, DevicesState(longest, True, True, True, 100, 100, True))
    driver.event(driver.box.on_tablet, "10.0.0.3", TabletState(True, longest, longest, 1.0, 2.0))
    assert driver.box.beacon().tablet.call_time == longest
    assert size(driver.box.beacon()) <= 1024


def test_the_size_is_asked_with_the_robot_that_comes():
    asked = []

    def size(beacon):
        asked.append([r.port for r in beacon.robots])
        return beacon_bytes(beacon)

    driver = BoxDriver(beacon_size=size)
    driver.robot().beacon()
    assert driver.off("connect") == []
    assert asked[-1] == [6667]


@pytest.mark.parametrize("last_port, reported", [(6990, None), (6991, "9 UDP ports"), (7000, "0 UDP ports"),
                                             (7001, "0 UDP ports")])
def test_every_referee_is_warned_before_ports_leave_the_range_of_firewalls(last_port, reported):
    driver = BoxDriver(last_port=last_port)
    driver.robot().beacon()
    assert driver.off("connect") == []
    found = driver.box.warnings(driver.now)
    if reported is None:
        assert found == []
    else:
        assert [f"{reported} are left of 6666 to 7000" in text for text in found] == [True]


def test_what_prevents_a_connection_is_of_these_robots_and_these_ports():
    long_name = "r" * 60
    driver = BoxDriver(competition(tbm=["HGTKMH"], other=[event("HWV", team="Beta")]),
                       Settings(max_datagram=150), last_port=65534,
                       beacon_size=lambda beacon: 100 + sum(len(robot.robot) for robot in beacon.robots))
    driver.robot("Alpha", "r1").beacon()
    driver.robot("Beta", long_name, "10.0.0.3").beacon()
    assert driver.off("connect", "tbm") == []
    assert [reason[:36] for reason in driver.off("connect", "other")] == ["The beacon may need 160 bytes with o"]
    driver.command("open_sheet", "tbm")
    assert [reason[:36] for reason in driver.off("connect", "other")] == [
        "All UDP ports up to 65535 are used u", "The beacon may need 160 bytes with o"]
