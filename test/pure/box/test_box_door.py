"""The document is made again when something happened, and once a second of the box's clock."""

import asyncio

import pytest

from helpers.box_driver import BoxDriver
from roah_rsbb.box.door import BoxDoor
from roah_rsbb.core.views.document import Documents
from roah_rsbb.protocol import RobotState


@pytest.fixture
def looks(monkeypatch):
    found, look = [], Documents.look

    def counted(documents, now, *others):
        found.append(now)
        return look(documents, now, *others)

    monkeypatch.setattr(Documents, "look", counted)
    return found


@pytest.fixture
def driver():
    return BoxDriver()


@pytest.fixture
def door(driver):
    loop = asyncio.new_event_loop()
    made = BoxDoor(loop, driver.box, "uuid", "", lambda: driver.now, dict, tuple, {}, lambda: None)
    yield made
    made.close()
    loop.close()


def after(driver, looks, door, act):
    """How often the box is looked at after this."""
    door.publish()
    before = len(looks)
    act()
    for _ in range(3):
        door.publish()
    return len(looks) - before


def test_a_robot_that_repeats_itself_is_no_reason_to_look(driver, door, looks):
    robot = driver.executing()
    driver.jump(1.1 - driver.now.mono % 1.0)  # a second begins
    for _ in range(3):
        robot.says()

    def says_again():
        driver.jump(0.01)
        robot.send(robot.report())

    says_again()
    assert after(driver, looks, door, says_again) == 0
    assert after(driver, looks, door, lambda: driver.event(driver.box.tick_if_due)) == 0
    assert after(driver, looks, door, lambda: robot.says(messages_saved=7)) == 1
    assert after(driver, looks, door, lambda: driver.event(driver.box.on_unreadable, robot.port, "bad")) == 1
    assert after(driver, looks, door, lambda: driver.command("stop")) == 1


def test_what_only_time_changes_is_looked_at_once_a_second_of_the_box(driver, door, looks):
    driver.executing()
    assert after(driver, looks, door, lambda: driver.jump(1.0)) == 1


def test_a_robot_that_ignores_stop_is_shown_at_once(driver, door, looks):
    robot = driver.executing()
    driver.command("stop")
    robot.says(RobotState.EXECUTING)
    door.publish()
    assert driver.box.deadline() <= driver.now.mono + 1.0
    driver.run(1.0)
    assert any("did not answer STOP" in text for text in door.publish().zones["tbm"].warnings)
