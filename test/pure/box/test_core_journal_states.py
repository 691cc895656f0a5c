"""The journal has the state of a zone's run at every moment, for replays."""

from helpers.all_robots import robots_of, take_ports
from helpers.competition import DOOR, competition, event
from helpers.journaled import box
from roah_rsbb.core.views.document import clock_of
from roah_rsbb.journal.reader import JournalReader
from roah_rsbb.journal.records import ChangesReader, Kind
from roah_rsbb.model.as_json import to_json
from roah_rsbb.protocol import RobotState


def states_of(path):
    """The states of all runs in a journal: by identity, (UTC, state) in order."""
    found = {}
    journal = JournalReader(str(path))
    for run in journal.runs():
        reader = ChangesReader()
        found[run.identity] = [(entry.utc, reader.take(entry.value)) for entry in journal.states(run.identity)]
        assert not any(entry.kind == Kind.STATE for entry in journal.entries(run.identity))
    return found


class _Watched:
    """Notes the state of each run after each record."""

    def __init__(self):
        self.states = {}  # by identity and UTC: the last state of this moment

    def __call__(self, driver):
        for zone in driver.box.zones.values():
            if zone.run is not None:
                clock = clock_of(zone.run, zone.event.benchmark, driver.now)
                self.states.setdefault(zone.run.identity, {})[driver.now.utc] = (
                    to_json(zone.saved()), clock.spent(driver.now.mono))


def check(driver, watched):
    path = driver.journal.path
    driver.journal.close()
    found = states_of(path)
    assert found.keys() == watched.states.keys()
    for identity, states in found.items():
        assert None not in [state for _, state in states]
        last = dict(states)
        for utc, (state, elapsed_s) in watched.states[identity].items():
            if utc in last:
                assert last[utc]["zone"] == state
                assert abs(last[utc]["clock"].get("elapsed", 0.0) - elapsed_s) < 0.001
        assert len(last) > 3


def test_the_states_of_a_run_are_those_of_the_box(tmp_path):
    watched = _Watched()
    driver = box(tmp_path, on_record=watched)
    robot = driver.executing("tbm")
    for i in range(5):
        robot.says(notifications=(f"text {i}",))
        driver.score(DOOR.group, DOOR.desc, i % 2, "tbm")
    driver.command("stop", "tbm")
    robot.says(RobotState.STOP)
    driver.command("start", "tbm")
    robot.executes()
    robot.completes()
    driver.command("disconnect", "tbm")
    check(driver, watched)


def test_after_a_restart_the_states_begin_again_with_a_complete_one(tmp_path):
    watched = _Watched()
    driver = box(tmp_path, on_record=watched)
    robot = driver.executing("tbm")
    driver.kill(3.0)
    robot.says(notifications=("after",))
    driver.command("stop", "tbm")
    check(driver, watched)


def test_the_states_of_a_run_of_all_robots_have_all_robots(tmp_path):
    watched = _Watched()
    driver = box(tmp_path, competition(tbm=[event("HSUF", team="ALL", scoring=())]), on_record=watched)
    robots = robots_of(driver)
    driver.command("connect", "tbm")
    take_ports(driver, robots)
    for robot in robots:
        robot.says()
    driver.command("start", "tbm")
    robots[0].says(notifications=("hello",))
    check(driver, watched)
