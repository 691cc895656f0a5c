"""Private ports after a restart: no two runs, and no two robots of a run, have the same one."""

import json

import pytest

from helpers.all_robots import robots_of
from helpers.box_driver import BoxDriver
from helpers.competition import competition, event, run_record
from roah_rsbb.core.continuing import BoxSaved, Saved
from roah_rsbb.core.settings import Settings
from roah_rsbb.core.zones import ZoneState
from roah_rsbb.model.saved import freeze, thaw

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
    zones = {name: json.loads(json.dumps(freeze(zone.saved()))) for name, zone in driver.box.zones.items()}
    change(zones)
    return Saved(driver.now.utc, BoxSaved(), {name: thaw(ZoneState, state) for name, state in zones.items()})


def _restart(driver, saved, last_port):
    """Another core, whose record of used ports ends with `last_port`. Its notices are returned."""
    again = BoxDriver(_config(), SETTINGS, last_port=last_port)
    again.now = driver.now
    again.event(again.box.resume, saved)
    return again


def _ports(driver):
    return [run.port for run in driver.box.zones.runs()]


def test_an_older_record_of_ports_gives_no_port_of_a_resumed_run_again(driver):
    """The record was not written to the disk when the computer lost its power."""
    driver.connected("tbm")
    port, = _ports(driver)
    again = _restart(driver, _saved(driver), port - 1)
    assert _ports(again) == [port]
    again.connected("fbm", team="Beta", name="r2", host="10.0.0.3")
    assert _ports(again) == [port, port + 1]


def test_two_runs_on_one_port_are_not_both_resumed(driver):
    driver.connected("tbm")
    driver.connected("fbm", team="Beta", name="r2", host="10.0.0.3")
    first, second = _ports(driver)

    def same_port(zones):
        zones["fbm"]["run"]["port"] = first

    again = _restart(driver, _saved(driver, same_port), second)
    assert _ports(again) == [first]
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
    assert _ports(again) == []
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
    assert _ports(again) == [6677]
