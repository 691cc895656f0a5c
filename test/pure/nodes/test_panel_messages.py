"""The messages for panels are made of cached bytes. They have the bytes of messages that were made without a cache."""

import io
import pathlib

import pytest

import roah_rsbb
from helpers.box_driver import BoxDriver
from helpers.competition import UTC0, competition, event
from roah_rsbb.core.views.document import Documents
from roah_rsbb.model.reason import RunName
from roah_rsbb.protocol import RobotState
from roah_rsbb.scoring.sheet import Mark

# The generated messages are in the build folder.
_BUILT = pathlib.Path(__file__).parents[3] / "build" / "devel" / "lib" / "python3" / "dist-packages" / "roah_rsbb"
roah_rsbb.__path__.append(str(_BUILT))
PanelMessages = pytest.importorskip("roah_rsbb.nodes.core.panel_messages").PanelMessages
roah_rsbb.__path__.remove(str(_BUILT))


class EachTick(PanelMessages):
    """Publishes also what only time changed."""

    DETAILS_EVERY = 1


def bytes_of(messages, now, document):
    made = [messages.to_gui(now, document), messages.details(now), messages.clocks(now)]
    buffers = [io.BytesIO() for _ in made]
    for message, buffer in zip(made, buffers):
        message.serialize(buffer)
    return [buffer.getvalue() for buffer in buffers]


class Compared:
    """The messages of a box, compared with those of an object that has not made any before."""

    def __init__(self, driver):
        self._driver = driver
        self._kept = EachTick(driver.box, "uuid")
        self._documents = Documents(driver.box, "uuid", "10.0.0.255")

    def check(self, log_files):
        box, now = self._driver.box, self._driver.now
        document = self._documents.look(now, log_files)
        made = bytes_of(self._kept, now, document)
        assert made == bytes_of(PanelMessages(box, "uuid"), now, document)
        return made


def test_all_that_changes_in_a_run_is_in_the_messages():
    driver = BoxDriver(competition(tbm=["HWV", event("HWV", run=2, scheduled=UTC0 + 70.0)],
                                   other=[event("HNF", team="Beta", scheduled=UTC0 + 40.0)]))
    compared, log_files, made = Compared(driver), {}, []

    def mark():
        name = RunName("tbm", driver.run_in().identity)
        driver.mark(name, Mark("Penalized", "bumps", 1))

    robot = driver.robot()
    robot.port = 6667
    for act in (
        robot.beacon, lambda: driver.robot("Beta", "r2", "10.0.0.3").beacon(), lambda: driver.command("connect"),
        lambda: driver.run(0.5), robot.says, lambda: log_files.update({6667: "first.bag"}),
        lambda: driver.command("start"), robot.executes, lambda: driver.run(0.1),
        lambda: log_files.update({6667: "second.bag"}), lambda: robot.says(after=0.05),
        lambda: robot.says(messages_saved=2), lambda: robot.says(notifications=("a",)), mark,
        lambda: setattr(robot, "skew", 5.0), robot.says, lambda: driver.run(20.0),
        lambda: robot.says(RobotState.PREPARING),
        lambda: driver.command("stop"), lambda: driver.run(1.0), lambda: driver.command("disconnect"),
        lambda: driver.command("next"), lambda: driver.run(40.0),
    ):
        act()
        made.append(compared.check(log_files))
    assert sum(one != other for one, other in zip(made, made[1:])) > 20


def test_details_come_at_once_for_whoever_waits_for_newer_ones():
    """A terminal learns from them whether a robot has stopped, and this may have been published before it asked."""
    driver = BoxDriver(competition())
    messages, documents = PanelMessages(driver.box, "uuid"), Documents(driver.box, "uuid", "10.0.0.255")

    def publishes():
        messages.to_gui(driver.now, documents.look(driver.now))
        return messages.details(driver.now) is not None

    assert [publishes(), publishes()] == [True, False]
    messages.renew()
    assert [publishes(), publishes()] == [True, False]
