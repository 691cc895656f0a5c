"""Private ports, channels that cannot be opened, and the size of the beacon; ports after a restart."""

import json
from dataclasses import replace

import pytest

from helpers.all_robots import robots_of
from helpers.box_driver import BoxDriver
from helpers.competition import competition, event, run_record
from roah_rsbb.core import effects
from roah_rsbb.core.connections import MAX_PORTS_TRIED
from roah_rsbb.core.continuing import BoxSaved, Saved
from roah_rsbb.core.effects import Level, OpenChannel, PortTaken
from roah_rsbb.core.settings import Settings
from roah_rsbb.core.zones import ZoneState
from roah_rsbb.model.as_json import from_json, to_json
from roah_rsbb.model.messages import DevicesState, TabletState
from roah_rsbb.model.reason import Refused
from roah_rsbb.rulebook.registry import PROFILES


def _connect(driver, zone="tbm"):
    driver.robot().beacon()
    driver.taken()
    driver.command("connect", zone)
    return driver.taken()


def test_without_a_beacon_connect_opens_a_run_that_people_start_where_none_is_needed():
    own = replace(PROFILES["HGTKMH"], beacon=False)
    driver = BoxDriver(competition(tbm=[event(own=own)]))
    assert driver.off("connect") == []
    assert "No robot of team Alpha is heard: people start it" in driver.view().state
    driver.command("connect")
    assert driver.view().by_hand and driver.channels == {} and driver.view().warnings == ()
    driver.robot().beacon()
    assert "is active, but not in this run: disconnect and connect again" in str(driver.view().warnings)
    driver.command("start")
    assert driver.view().phase == "running" and driver.notices(Level.WARNING, Level.ERROR) == []
    driver.command("stop")
    driver.command("disconnect")
    assert driver.connected().port in driver.channels  # one that is heard is connected


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
    driver.event(driver.box.arrivals.on_channel_failed, 6667, "gone")
    assert driver.run_in() is None
    assert _ports(driver.taken()) == []


def test_news_of_a_channel_that_is_gone_are_none():
    driver = BoxDriver()
    _connect(driver)
    driver.command("disconnect")
    driver.taken()
    driver.event(driver.box.arrivals.on_channel_failed, 6667, "late")
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
    driver.event(driver.box.devices.on_state, DevicesState(longest, True, True, True, 100, 100, True))
    driver.event(driver.box.arrivals.on_tablet, "10.0.0.3", TabletState(True, longest, longest, 1.0, 2.0))
    assert driver.box.beacon().tablet.call_time == longest
    assert size(driver.box.beacon()) <= 1024


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


SETTINGS = Settings(listen_duration=0.0)
TEAMS = ("Alpha", "Beta", "Gamma")


def _config():
    return competition(
        teams=TEAMS, tbm=[event("HWV", timeout=300.0)], fbm=[event("HWV", team="Beta", timeout=300.0)],
        all=[event("HSUF", team="ALL", timeout=120.0)],
    )


@pytest.fixture
def driver():
    return BoxDriver(_config(), SETTINGS)


def _saved(driver, change=lambda zones: None):
    """The saved state, as JSON that `change` edits."""
    zones = {name: json.loads(json.dumps(to_json(zone.saved()))) for name, zone in driver.box.zones.items()}
    change(zones)
    return Saved(driver.now.utc, BoxSaved(), {name: from_json(ZoneState, state) for name, state in zones.items()})


def _restart(driver, saved, last_port, unusable_ports=()):
    """Another core, whose record of used ports ends with `last_port`."""
    again = BoxDriver(_config(), SETTINGS, last_port=last_port)
    again.now, again.unusable_ports = driver.now, unusable_ports
    again.event(again.box.restart.resume, saved)
    return again


def _run_ports(driver):
    return [run.port for run in driver.box.zones.runs()]


def test_an_older_record_of_ports_gives_no_port_of_a_resumed_run_again(driver):
    """The record was not written to the disk when the computer lost its power."""
    driver.connected("tbm")
    port, = _run_ports(driver)
    again = _restart(driver, _saved(driver), port - 1)
    assert _run_ports(again) == [port]
    again.connected("fbm", team="Beta", name="r2", host="10.0.0.3")
    assert _run_ports(again) == [port, port + 1]


def test_a_port_that_cannot_be_opened_is_kept_and_tried_again(driver):
    """Its robot knows no other one."""
    robot = driver.connected("tbm")
    again = _restart(driver, _saved(driver), robot.port, {robot.port})
    assert (_run_ports(again), again.channels) == ([robot.port], {})
    (text,) = [text for text in again.box.warnings(again.now) if "It is tried again every second" in text]
    assert text.startswith(f"UDP port {robot.port} of the run in zone tbm cannot be opened after the restart: ")
    again.run(5.0)
    assert (_run_ports(again), again.channels) == ([robot.port], {})
    again.unusable_ports = ()
    again.run(1.0)
    assert again.channels == {robot.port: robot.host}
    assert again.states[robot.port]


def test_two_runs_on_one_port_are_not_both_resumed(driver):
    driver.connected("tbm")
    driver.connected("fbm", team="Beta", name="r2", host="10.0.0.3")
    first, second = _run_ports(driver)

    def same_port(zones):
        zones["fbm"]["run"]["port"] = first

    again = _restart(driver, _saved(driver, same_port), second)
    assert _run_ports(again) == [first]
    assert any("cannot continue" in warning and str(first) in warning for warning in again.box.warnings(again.now))


def test_two_robots_of_a_run_on_one_port_are_not_resumed(driver):
    robots_of(driver, TEAMS)
    driver.command("connect", "all")
    ports = [member.port for member in driver.run_in("all").members()]
    assert len(set(ports)) == len(TEAMS)

    def same_port(zones):
        members = zones["all"]["all_robots"]["members"]
        members[1]["port"] = members[0]["port"]

    again = _restart(driver, _saved(driver, same_port), max(ports))
    assert _run_ports(again) == []
    assert any("cannot continue" in warning for warning in again.box.warnings(again.now))


def test_without_a_record_of_ports_the_number_of_a_sheet_is_not_given_again(driver):
    """log_dir was removed, and the box wrote the journal again. A run that is scored by hand has no channel."""
    driver.command("open_sheet")
    number, = (run.identity.split("-")[1] for run in driver.box.zones.runs())
    again = _restart(driver, _saved(driver), None)
    again.connected("fbm", team="Beta", name="r2", host="10.0.0.3")
    assert [f"-{int(number) + n}-" in run.identity for n, run in enumerate(again.box.zones.runs())] == [True, True]


def test_without_a_record_of_ports_those_of_earlier_runs_are_not_given_again(driver):
    later = run_record(1, identity="HWV-6676-2.000", closed_utc=2.0)
    records = later, run_record(2, identity="HWV-6671-1.000", closed_utc=1.0), run_record(3, identity="HWV")
    again = _restart(driver, _saved(driver)._replace(records=records), None)
    again.connected("tbm")
    assert _run_ports(again) == [6677]
