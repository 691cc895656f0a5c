"""Whatever a box records, its copy has at once, and a core that starts with the copy continues."""

import contextlib
import pathlib
import tempfile

from hypothesis import given

from fuzzing.core import Play
from helpers.competition import DOOR
from helpers.copied import contents
from helpers.examples import OPENINGS, STORIES, examples
from helpers.journaled import NO_LISTENING, JournaledDriver, box
from roah_rsbb.journal.copy_folder import CopyFolder
from roah_rsbb.journal.copy_follower import Follower
from roah_rsbb.journal.log_dir import PortRecord
from roah_rsbb.model.records import EndReason, Phase


@contextlib.contextmanager
def followed(driver, stick):
    """Copies a driver's journal."""
    follower = Follower(str(pathlib.Path(driver.journal.path).parent), lambda: CopyFolder(str(stick)))
    try:
        yield follower
    finally:
        follower.close()


@examples(40)
@given(OPENINGS, STORIES)
def test_the_copy_has_everything_after_each_event(opening, story):
    with tempfile.TemporaryDirectory() as folder, contextlib.ExitStack() as stack:
        play = Play(opening, lambda config: JournaledDriver(pathlib.Path(folder), config, NO_LISTENING))
        stack.callback(play.driver.journal.close)
        stick = pathlib.Path(folder, "stick")
        stick.mkdir()
        follower = stack.enter_context(followed(play.driver, stick))
        for act in story:
            play.do(act)
            follower.step()
            assert not follower.progress.trouble
            assert contents(stick) == contents(follower.log_dir)


def test_a_core_with_the_copy_continues_the_run(tmp_path):
    driver = box(tmp_path)
    stick = tmp_path / "stick"
    stick.mkdir()
    with followed(driver, stick) as follower:
        robot = driver.executing("tbm")
        port = driver.run_in("tbm").port
        PortRecord(follower.log_dir).add(port, lambda error: None)
        driver.score(DOOR.group, DOOR.desc, 1)
        robot.says(notifications=("at the bed",))
        left = driver.view("tbm").timer
        follower.step()
        assert not follower.progress.trouble
    driver.score(DOOR.group, DOOR.desc, 0)  # the copy does not have this any more
    driver.journal.close()

    driver.boot, driver.now = "another computer", driver.now.later(3.0)
    driver.resume_in(stick)
    assert not driver.troubles
    run = driver.run_in("tbm")
    assert (run.phase, run.port) == (Phase.RUNNING, port)
    assert run.sheet.item(DOOR.group, DOOR.desc).value == 1
    assert driver.view("tbm").timer < left
    assert PortRecord(str(stick)).read() == (port, [])
    robot.says(notifications=("at the bed", "at the door"))
    robot.completes()
    assert run.end_reason is EndReason.COMPLETED
    driver.journal.close()
