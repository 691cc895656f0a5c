"""A box from which a standby took over: it stops, refuses everything, and leaves its runs as they were."""

import pytest

from helpers.box_driver import BoxDriver
from helpers.commands import COMMANDS
from roah_rsbb.core import effects
from roah_rsbb.core.actions.table import Target
from roah_rsbb.core.continuing import Saved
from roah_rsbb.core.copies import STANDBY, CopyReport
from roah_rsbb.core.views import document
from roah_rsbb.model.actions import ENTRIES
from roah_rsbb.model.reason import Refused, RunName

HOST = "10.0.0.3"
RUN = RunName("tbm")
MARK = {"group": "Achievements", "desc": "Detects the door", "value": 1, "id": "1", "judge": "Ben"}


@pytest.fixture
def driver():
    made = BoxDriver()
    made.executing()
    made.event(lambda now: made.box.supersede(2, 17, HOST))
    return made


def test_it_is_recorded_once(driver):
    driver.event(lambda now: driver.box.supersede(3, 18, HOST))
    assert driver.taken(effects.Superseded) == [effects.Superseded(2, 17, HOST)]


def test_every_panel_shows_it(driver):
    (warning,) = driver.box.warnings(driver.now)
    assert warning.startswith(f"This box is superseded: the box at {HOST}")
    assert driver.box.superseded_by == HOST
    assert document.box_status(driver.box, driver.now) == warning
    assert all(driver.off(command) == [warning] for command in COMMANDS)


def test_panels_offer_no_command_any_more():
    """Also of a run in progress, whose view is kept while nothing happens."""
    driver = BoxDriver()
    driver.executing()
    shown = document.ZoneViews(driver.box)
    assert any(view.is_on("stop") for view in shown.look(driver.now).values())
    driver.event(lambda now: driver.box.supersede(2, 17, HOST))
    assert all(view.off(command) for view in shown.look(driver.now).values() for command in COMMANDS)


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_is_refused(driver, command):
    with pytest.raises(Refused, match="has taken over"):
        driver.command(command)


@pytest.mark.parametrize("call", [
    *[lambda box, now, name=name: box.act(now, Target("tbm"), name, "who", MARK if "mark" in name else {})
      for name in ENTRIES],
    lambda box, now: box.scores.stop(now, RUN, "who"),
    lambda box, now: box.act(now, Target("tbm"), "operation"),
    lambda box, now: box.reload(now, None, 2, ()),
], ids=(*ENTRIES, "stop", "operation", "reload"))
def test_scores_are_refused(driver, call):
    """They would be lost: the other box does not have them."""
    record = driver.run_in().record(driver.now)
    with pytest.raises(Refused, match="has taken over"):
        driver.event(lambda now: call(driver.box, now))
    assert driver.run_in().record(driver.now)._replace(elapsed_s=0.0) == record._replace(elapsed_s=0.0)


def test_the_runs_do_not_continue(driver):
    """Neither does a run time out, nor is anything sent."""
    state = driver.box_state()
    driver.effects.clear()
    assert driver.box.deadline() is None
    driver.jump(10_000.0)
    driver.event(driver.box.tick)
    assert driver.box_state() == state
    assert driver.effects == []


@pytest.mark.parametrize("by, where", [("", " if its robot does"), (HOST, f" on the box at {HOST}")])
def test_after_a_restart_it_says_where_its_runs_continue(by, where):
    first, second = BoxDriver(), BoxDriver()
    first.executing()
    if by:
        second.box.stay_superseded(by)
    second.event(second.box.resume, Saved(
        second.now.utc, first.box.saved(), {name: zone.saved() for name, zone in first.box.zones.items()}))
    assert second.run_in().state.log.endswith(f": the run continues{where}\n")


def test_after_a_restart_it_is_not_recorded_again():
    driver = BoxDriver()
    driver.effects.clear()
    driver.box.stay_superseded(HOST)
    driver.event(driver.box.tick)
    assert driver.effects == [] and driver.box.is_superseded


def test_it_does_not_ask_for_a_copy_of_its_own_journal(driver):
    driver.effects.clear()
    driver.event(driver.box.on_copy_report, CopyReport(STANDBY, True, 60.0, 7, "the standby is not connected"))
    assert driver.notices() == []
