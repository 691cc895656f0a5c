"""A core that is restarted with another schedule, or in another launch: which runs continue."""

import pytest

from helpers.competition import DOOR, competition, event
from helpers.journaled import CATERING, NAVIGATION, box
from roah_rsbb.journal.log_dir import Resume
from roah_rsbb.model.reason import RunName
from roah_rsbb.scoring.sheet import Mark


def test_a_run_that_cannot_continue_can_be_corrected_and_signed_off(tmp_path):
    driver = box(tmp_path)
    driver.executing("tbm")
    driver.score(DOOR.group, DOOR.desc, 1, "tbm")
    identity = driver.run_in("tbm").identity
    driver.kill(5.0, config=competition(fbm=[NAVIGATION]))
    (record,) = driver.box.finished.records()
    assert (record.identity, record.end_reason, record.items[0].value) == (identity, "stopped", 1)
    name = RunName("tbm", identity)
    driver.mark(name, Mark(DOOR.group, DOOR.desc, 0), "Anna")
    driver.enter("sign_off", name, "Anna")
    signed = driver.box.finished.find(identity).record
    driver.kill()
    assert driver.box.finished.records() == [signed]


def test_an_event_that_was_moved_in_time_is_found(tmp_path):
    driver = box(tmp_path)
    driver.command("next", "tbm")
    later = event("HWV", scheduled=event().scheduled + 900)
    moved = competition(tbm=[event("HGTKMH"), CATERING, later], fbm=[NAVIGATION])
    driver.kill(config=moved)
    assert driver.box.zones["tbm"].event.benchmark.code == "HWV"


def test_a_run_whose_event_is_gone_is_reported(tmp_path):
    driver = box(tmp_path)
    driver.executing("tbm")
    driver.kill(config=competition(tbm=["HGTKMH"], fbm=[NAVIGATION]))
    assert driver.run_in("tbm") is None
    assert any("cannot continue" in text for text in driver.box.warnings(driver.now))


def test_the_journal_of_another_competition_is_set_aside(tmp_path):
    driver = box(tmp_path)
    driver.executing("tbm")
    driver.kill(config=competition(other=["HGTKMH"]))
    assert any("another competition" in text for text in driver.troubles)
    assert [path.name for path in driver._directory.glob("*_aside_*")] != []


@pytest.mark.parametrize("resume, launch, resumes", [
    (Resume.ALWAYS, "2", True), (Resume.LAUNCH, "1", True), (Resume.LAUNCH, "2", False), (Resume.NEVER, "1", False),
])
def test_when_a_core_resumes(tmp_path, resume, launch, resumes):
    driver = box(tmp_path)
    driver.journal.close()
    driver.open(tmp_path / "0", launch="1")
    driver.executing("tbm")
    driver.journal.close()
    driver.open(tmp_path / "0", resume, launch)
    assert (driver.run_in("tbm") is not None) == resumes
