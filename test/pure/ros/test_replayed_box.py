"""The replayed box shows at any moment what the box showed then, and takes no command."""

import itertools
import os

import pytest

from helpers.commands import COMMANDS
from helpers.competition import DOOR
from helpers.journaled import NO_LISTENING, JournaledDriver
from helpers.jury import Jury, judged
from helpers.replayed import LOOK_S, ReplayedCompetition, SetClock, clock_at, untimed
from roah_rsbb.core.actions.table import Target
from roah_rsbb.core.views import document
from roah_rsbb.core.views.document import Documents
from roah_rsbb.journal.reader import JournalReader
from roah_rsbb.model.clock import Now
from roah_rsbb.model.document import REPLAY as PREFIX
from roah_rsbb.model.document import BoxSeen
from roah_rsbb.model.reason import Refused
from roah_rsbb.model.zone import Count
from roah_rsbb.ros.replayed_box import CannotReplay, ReplayedBox, configuration, read_run

# What depends on things that the journal does not have, or on the commands, which are off.
NOT_COMPARED = {"actions", "state", "warnings", "module_status"}
TIMES = {"clock", "robot"}


@pytest.fixture(scope="module")
def played(tmp_path_factory):
    driver = ReplayedCompetition(tmp_path_factory.mktemp("replayed"))
    path = driver.play()
    yield driver, JournalReader(path)


def replayed(played, word="1"):
    driver, reader = played
    return ReplayedBox(read_run(reader, word, []), driver.config)


def assert_same(found, now, expected, then):
    for name, value in expected._asdict().items():
        if name in TIMES or name in NOT_COMPARED:
            continue
        assert getattr(found, name) == value, name
    assert clock_at(found.clock, now) == pytest.approx(clock_at(expected.clock, then), abs=0.001)
    assert without_moments(found.clock) == without_moments(expected.clock)
    # Between two samples of the link, the newest reports are not known yet.
    no_link = {"skew": None, "silent_since": None}
    assert found.robot._replace(**no_link) == expected.robot._replace(**no_link)


def without_moments(clock):
    counted = {name: value.counting for name, value in clock._asdict().items() if isinstance(value, Count)}
    return clock._replace(after_stop_until=clock.after_stop_until is None, **counted)


def test_every_moment_is_that_of_the_box(played):
    driver, _ = played
    box = replayed(played)
    looks = sorted((look for looks in driver.looks.values() for look in looks), key=lambda look: look.now.utc)
    assert len(looks) > 50
    for look in looks:
        box.show(look.now.utc)
        document = Documents(box.box, "", "").look(box.now)
        assert_same(document.zones[look.view.zone], box.now, look.view, look.now)
        assert untimed(document.runs_shown()) == look.explained


def test_a_silent_robot_is_reported_when_it_was(played):
    driver, reader = played
    run = read_run(reader, "1", [])
    [port] = [robot for robot in run.links if robot == driver.looks[next(iter(driver.looks))][0].view.robot.port]
    box = ReplayedBox(run, driver.config)
    for second in run.links[port]:
        box.show(second.utc)
        warned = any("No message" in text for text in box.box.warnings_of(box.now, "tbm"))
        assert warned == (second.sample.gap_s > 3.0)


def test_the_run_begins_connected_and_ends_left(played):
    box = replayed(played)
    assert box.box.zones["tbm"].run is not None
    assert box.box.zones["tbm"].event.benchmark.code == "HCFGAC"
    while not box.is_over:
        box.show(box.now.utc + 1e6)
    assert box.box.zones["tbm"].run is None
    assert "Disconnected" not in " ".join(document.ZoneViews(box.box).look(box.now)["tbm"].state)


def test_no_phase_is_skipped_however_fast(played):
    box, phases = replayed(played), []
    while not box.is_over:
        phases.append(document.ZoneViews(box.box).look(box.now)["tbm"].phase)
        box.show(box.now.utc + 1e6)
    phases.append(document.ZoneViews(box.box).look(box.now)["tbm"].phase)
    assert [phase for phase, _ in itertools.groupby(phases)] == ["connected", "running", "ended", "idle"]


@pytest.mark.parametrize("seconds", [-10.0, 86400.0])
def test_a_step_of_the_clock_changes_no_time_of_a_replay(tmp_path, seconds):
    runs = []
    for folder, step in (("plain", 0.0), ("set", seconds)):
        driver = SetClock(tmp_path / folder, step)
        runs.append(read_run(JournalReader(driver.play()), "1", []))
    plain, begins = (
        {change.phase: change.utc for change in reversed(run.changes) if change.zone == "tbm"} for run in runs)
    assert begins == pytest.approx(plain, abs=0.001)
    assert len(begins) == 4
    assert runs[1].end_utc == pytest.approx(runs[0].end_utc, abs=0.001)
    box = ReplayedBox(runs[1], driver.config)
    while not box.is_over:
        box.show(box.now.utc + 1.0)
    assert box.now.utc == pytest.approx(runs[0].end_utc, abs=0.001)


def test_all_commands_are_refused_with_the_reason(played):
    driver, _ = played
    box = replayed(played)
    reason = ("This is a replay of HCFGAC, team Alpha, round 1, run 1: nothing here is live, and commands have no "
              "effect")
    for view in document.ZoneViews(box.box).look(box.now).values():
        assert [view.off(command) for command in COMMANDS] == [(reason,)] * len(COMMANDS)
    for command in COMMANDS:
        with pytest.raises(Refused) as refused:
            box.box.actions.do(box.now, Target("tbm"), command)
        assert refused.value.reasons == [reason]
    assert document.box_status(box.box, Now(0.0, 0.0)) == reason
    assert driver.troubles is not None


def test_only_a_replay_is_marked_as_one():
    assert BoxSeen(f"{PREFIX}1f691652", "", 0).is_replay
    assert not BoxSeen("1f691652-bd12-41b6-ba41-403569205c35", "", 0).is_replay


# -- judges -----------------------------------------------------------------------------------------


def judgings(box, now):
    return [judging._replace(record=judging.record._replace(elapsed_s=0.0)) for judging in box.judges.waiting(now)]


class JudgedCompetition(JournaledDriver):
    """Conducts a run with two judges, and notes what referees and judges see."""

    def __init__(self, log_dir):
        super().__init__(log_dir, judged(), NO_LISTENING)
        self.jury = Jury(self)
        self.noted = []  # UTC seconds, and what /core/judging is made of

    def look(self):
        self.jump(LOOK_S)
        self.noted.append((self.now.utc, judgings(self.box, self.now)))
        self.jump(LOOK_S)

    def play(self):
        """Conduct the run; returns the path of the journal."""
        acts = [
            lambda: self.jury.mark("Anna", DOOR, 1), lambda: self.jury.mark("Bert", DOOR, 0),
            lambda: self.jury.submit("Anna"), lambda: self.jury.submit("Bert"),
            lambda: self.jury.settle(DOOR, 1), lambda: self.command("stop"),
        ]
        self.look()
        for act in acts:
            act()
            self.look()
        self.command("disconnect")
        self.journal.close()
        return self.journal.path


def test_judges_are_shown_as_they_were(tmp_path):
    driver = JudgedCompetition(tmp_path)
    box = ReplayedBox(read_run(JournalReader(driver.play()), "1", []), driver.config)
    shown = [judging for _, seen in driver.noted for judging in seen]
    assert [len(judging.active) for judging in shown] == [0, 1, 2, 2, 2, 2, 2]
    assert [judging.is_complete for judging in shown] == [False] * 4 + [True] * 3
    assert [verdict.value for verdict in shown[4].verdicts] != [verdict.value for verdict in shown[5].verdicts]
    for utc, seen in driver.noted:
        box.show(utc)
        assert judgings(box.box, box.now) == seen


# -- what cannot be replayed ------------------------------------------------------------------------


def test_a_run_without_states_is_refused_with_the_remedy(tmp_path):
    from helpers.journals import Writer
    from helpers.results_of import write_full_run

    writer = Writer(tmp_path)
    write_full_run(writer)
    writer.close()
    with pytest.raises(CannotReplay, match="results replay 1"):
        read_run(JournalReader(writer.path), "1", [])


def test_missing_and_other_files_are_refused_with_the_remedy(played, tmp_path):
    driver, reader = played
    run = read_run(reader, "1", [])
    with pytest.raises(CannotReplay, match="configuration.json is missing .*--benchmarks-file and --schedule-file"):
        configuration(str(tmp_path), run, None, None)
    folder = os.path.join(os.path.dirname(__file__), "..", "..", "..", "config")
    files = [os.path.join(folder, name) for name in ("benchmarks.yaml", "schedule.yaml")]
    with pytest.raises(CannotReplay, match="the schedule has no zone"):
        ReplayedBox(run, configuration(str(tmp_path), run, *files))
