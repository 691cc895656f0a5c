"""The configuration files of the core: in force, edited, read again, and after a crash."""

import os
import shutil

import pytest

from helpers.config_files import SHIPPED
from roah_rsbb.box import configuration
from roah_rsbb.box.configuration import EDITED, Configuration
from roah_rsbb.journal.log_dir import CONFIGURATION, kept_files, read_in_force
from roah_rsbb.rulebook.errors import ConfigErrors
from roah_rsbb.rulebook.event_ids import key_of

NAMES = ("benchmarks.yaml", "schedule.yaml", "passwords.yaml", "standings.yaml")


class Competition:
    """Files of a competition, and the cores that read them."""

    def __init__(self, folder):
        self.folder = folder
        self.log_dir = str(folder / "log")
        for name in NAMES:
            shutil.copy(SHIPPED / name, folder / name)
            os.chmod(folder / name, 0o600)

    def core(self, launch="launch 1"):
        """A core that starts."""
        paths = [str(self.folder / name) for name in NAMES]
        return Configuration(self.log_dir, launch, paths[:3], paths[3])

    def edit(self, name, old, new):
        path = self.folder / name
        text = path.read_text("utf-8")
        assert old in text
        path.write_text(text.replace(old, new, 1), "utf-8")

    def reload(self, core, in_use=()):
        """What the service does with changed files."""
        content = core.read()
        core.keep(content, in_use)
        core.content = content


@pytest.fixture
def competition(tmp_path):
    return Competition(tmp_path)


def minutes(configuration):
    return configuration.benchmarks["HGTKMH"].timeout / 60.0


def test_an_edited_file_has_no_effect_until_it_is_read_again(competition):
    core = competition.core()
    before = minutes(core.content.config)
    competition.edit("benchmarks.yaml", "code: HGTKMH\n  timeout: 600", "code: HGTKMH\n  timeout: 480")
    assert minutes(core.content.config) == before == 10.0
    content = core.read()
    assert core.changes(content) == ["benchmark HGTKMH: timeout 600, now 480",
                                     "benchmark HGTKMH: total timeout 600, now 480"]
    assert content.digest != core.content.digest
    assert core.read().digest == content.digest


def test_decisions_may_be_added_and_are_kept(competition):
    decided = "timeout: {decide: Time, long: 600, short: 480}"
    competition.edit("benchmarks.yaml", "code: HGTKMH\n  timeout: 600", f"code: HGTKMH\n  {decided}")
    core = competition.core()
    assert minutes(core.content.config) == 10.0
    (competition.folder / "decisions.yaml").write_text("Time: short\n", "utf-8")
    assert competition.core().notices == [EDITED]
    assert core.changes(core.read())[-1] == "decision 'Time': long, now short"
    competition.reload(core)
    (competition.folder / "decisions.yaml").unlink()
    again = competition.core()
    assert (again.notices, minutes(again.content.config)) == ([EDITED], 8.0)
    assert kept_files(competition.log_dir)["decisions"] == "Time: short\n"


def test_decisions_of_a_box_without_rules_for_standings(competition):
    (competition.folder / "decisions.yaml").write_text("Time: short\n", "utf-8")
    competition.edit("benchmarks.yaml", "timeout: 600", "timeout: {decide: Time, long: 600, short: 480}")
    paths = [str(competition.folder / name) for name in NAMES]
    for _ in range(2):
        core = Configuration(competition.log_dir, "launch 1", paths[:3], None)
        assert (core.notices, [each.chosen for each in core.content.config.decisions]) == ([], ["short"])


def test_the_errors_of_all_files_at_once(competition):
    core = competition.core()
    competition.edit("benchmarks.yaml", "timeout: 600", "timeout: soon")
    competition.edit("schedule.yaml", "round: 1", "round: one")
    competition.edit("standings.yaml", "criteria:", "criterias:")
    with pytest.raises(ConfigErrors) as wrong:
        core.read()
    assert {os.path.basename(error.file) for error in wrong.value.errors} == {
        "benchmarks.yaml", "schedule.yaml", "standings.yaml"}


@pytest.mark.parametrize("name", NAMES)
def test_a_file_that_is_a_pipe_stops_no_reload(competition, name):
    core = competition.core()
    (competition.folder / name).unlink()
    os.mkfifo(str(competition.folder / name))
    with pytest.raises(ConfigErrors, match="a directory or a device"):
        core.read()


def test_a_reload_does_not_wait_for_one_whose_disk_hangs(competition, monkeypatch):
    monkeypatch.setattr(configuration, "WAIT_S", 0.0)
    reloads = configuration.Reloads(None, competition.core(), None, None, None)
    with reloads._lock:
        assert reloads.reload("", "Ann").errors == [configuration.BUSY]


ADJUSTED = """stages:
  - { name: Final, of: [{ test: HWV }], adjustments: { Late: -5 }, given: [{ team: DumpTeam, adjustment: Late }] }
HGTKMH:"""


@pytest.mark.parametrize(("old", "new", "change"), [
    ("runs: best", "runs: mean", ["standings of HGTKMH: other rules"]),
    ("HGTKMH:", "overall: [{name: Final, of: [{benchmark: HWV}]}]\nHGTKMH:", ["stages: 'Final' added"]),
    ("HGTKMH:", ADJUSTED, ["stages: 'Final' added", "team DumpTeam, Final: Late -5: given"])])
def test_other_standings_are_a_change(competition, old, new, change):
    core = competition.core()
    competition.edit("standings.yaml", old, new)
    assert core.changes(core.read()) == change
    core.content = core.read()
    assert core.changes(core.read()) == []


# -- ids of events ----------------------------------------------------------------------------------

SCHEDULED = "run: 1, scheduled_time: 2015-12-31 09:00:00"


def put_into_force(core):
    """What the service does with changed files; returns what it warns of."""
    content = core.read_next()
    with_ids = core.with_ids(content)
    core.keep(with_ids, ())
    core.content = with_ids
    return core.write_ids(content, with_ids)


def ids(content):
    return {(e.benchmark.code, e.team, e.scheduled): e.id for zone in content.config.zones for e in zone.events}


def test_a_reload_writes_the_ids_that_are_missing(competition):
    core = competition.core()
    before, mode = ids(core.content), 0o640
    path = competition.folder / "schedule.yaml"
    os.chmod(path, mode)
    competition.edit("schedule.yaml", SCHEDULED, SCHEDULED.replace("09:00", "09:40"))
    assert put_into_force(core) == ""
    assert sorted(before.values()) == sorted(ids(core.content).values())
    assert (path.stat().st_mode & 0o777, path.read_text("utf-8").count("{ id: ")) == (mode, len(before))
    # Later, an event may change in every way.
    later = "run: 9, scheduled_time: 2016-01-02 10:00:00"
    competition.edit("schedule.yaml", SCHEDULED.replace("09:00", "09:40"), later)
    assert sorted(ids(core.read_next()).values()) == sorted(before.values())
    # What a core that was killed reads is what is in the file, so nobody edited it.
    assert put_into_force(core) == ""
    again = competition.core()
    assert (again.notices, ids(again.content)) == ([], ids(core.content))


def test_what_becomes_of_runs_is_said_before_a_reload(competition):
    core = competition.core()
    put_into_force(core)
    old = core.content.config.zones[0].events[0]
    ran = [key_of(old)]
    line = next(line for line in (competition.folder / "schedule.yaml").read_text("utf-8").splitlines(keepends=True)
                if f"id: {old.id}, " in line)
    competition.edit("schedule.yaml", line, line.replace("benchmark: HGTKMH,", "benchmark: HWV,"))
    content = core.read_next(ran)
    assert [text for text in core.warnings_of(content, ran) if f"delete its id ({old.id})" in text]
    assert core.warnings_of(content, ()) == list(content.warnings)
    assert len(core.changes(content, ran)) == 1
    # It is removed, and later written again without an id.
    competition.edit("schedule.yaml", line.replace("benchmark: HGTKMH,", "benchmark: HWV,"), "")
    content = core.read_next(ran)
    assert core.changes(content, ran)[0].endswith("removed. Its run stays in the results")
    put_into_force(core)
    first = (competition.folder / "schedule.yaml").read_text("utf-8").index("    - {")
    text = (competition.folder / "schedule.yaml").read_text("utf-8")
    again = line.replace(f"id: {old.id}, ", "")
    (competition.folder / "schedule.yaml").write_text(f"{text[:first]}{again}{text[first:]}", "utf-8")
    content = core.read_next(ran)
    assert core.changes(content, ran)[0].endswith("added. Its run before belongs to it")
    assert content.config.zones[0].events[0].id == old.id


def test_an_event_that_moves_past_midnight_stays_the_same(competition):
    competition.edit("schedule.yaml", SCHEDULED, SCHEDULED.replace("09:00", "23:50"))
    core = competition.core()
    before = ids(core.content)
    competition.edit("schedule.yaml", "2015-12-31 23:50:00", "2016-01-01 00:30:00")
    assert ids(core.read()) != before
    assert sorted(ids(core.read_next()).values()) == sorted(before.values())


def test_a_file_that_cannot_take_ids_stays_and_is_reported(competition, monkeypatch):
    core = competition.core()
    content = core.read_next()
    with_ids = core.with_ids(content)
    before = (competition.folder / "schedule.yaml").read_text("utf-8")
    competition.edit("schedule.yaml", SCHEDULED, SCHEDULED.replace("09:00", "09:40"))
    assert "the file was changed just now" in core.write_ids(content, with_ids)
    (competition.folder / "schedule.yaml").write_text(before, "utf-8")

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("roah_rsbb.ground.durable.write_file", full)
    assert "cannot be written (No space left on device)" in core.write_ids(content, with_ids)
    assert (competition.folder / "schedule.yaml").read_text("utf-8") == before


@pytest.mark.parametrize("text", ["timeout: 480", "timeout: soon"])
def test_after_a_crash_the_core_continues_with_what_it_had_read(competition, text):
    """It also starts if the edited file has errors."""
    assert competition.core().notices == []
    competition.edit("benchmarks.yaml", "timeout: 600", text)
    core = competition.core()
    assert minutes(core.content.config) == 10.0
    assert core.notices == [EDITED]
    assert core.content.warnings == ()


def test_after_a_crash_the_core_continues_with_what_was_reloaded(competition):
    core = competition.core()
    competition.edit("benchmarks.yaml", "timeout: 600", "timeout: 480")
    competition.reload(core)
    competition.edit("benchmarks.yaml", "timeout: 480", "timeout: 60")
    core = competition.core()
    assert (minutes(core.content.config), core.version) == (8.0, 1)


def test_a_new_launch_reads_the_files(competition):
    competition.core()
    competition.edit("benchmarks.yaml", "timeout: 600", "timeout: 480")
    core = competition.core("launch 2")
    assert (minutes(core.content.config), core.version, core.notices) == (8.0, 1, [])
    assert minutes(core.earlier([0, 1, 7])[0]) == 10.0
    assert list(core.earlier([0, 1, 7])) == [0]
    assert {e.benchmark.timeout for zone in core.before for e in zone.events if e.benchmark.code == "HGTKMH"} == {600.0}
    assert competition.core("launch 2").before == competition.core("launch 3").before == ()
    assert competition.core("launch 3").version == 1
    competition.edit("benchmarks.yaml", "timeout: 480", "timeout: soon")
    with pytest.raises(ConfigErrors):
        competition.core("launch 4")


def test_without_a_launch_the_files_are_read(competition):
    competition.core("")
    competition.edit("benchmarks.yaml", "timeout: 600", "timeout: 480")
    assert minutes(competition.core("").content.config) == 8.0


def test_earlier_versions_stay_as_long_as_runs_need_them(competition):
    core = competition.core()
    for seconds in (501, 502, 503):
        competition.edit("benchmarks.yaml", "timeout: 600" if seconds == 501 else f"timeout: {seconds - 1}",
                         f"timeout: {seconds}")
        competition.reload(core, in_use=[0])
    assert sorted(read_in_force(competition.log_dir).versions) == [0, 2, 3]
    assert minutes(core.earlier([0])[0]) == 10.0


def test_a_version_that_could_not_be_used_is_put_back(competition):
    core = competition.core()
    competition.edit("benchmarks.yaml", "timeout: 600", "timeout: 480")
    core.keep(core.read(), ())
    core.put_back(0)
    assert core.version == 0
    assert minutes(competition.core().content.config) == 10.0


def test_passwords_are_not_copied(competition):
    core = competition.core()
    with open(os.path.join(competition.log_dir, CONFIGURATION), encoding="utf-8") as file:
        text = file.read()
    assert not any(password in text for password in core.content.config.passwords.values())
    competition.edit("passwords.yaml", "TestingTeam:", "Late: its password\nTestingTeam:")
    assert core.changes(core.read()) == ["team 'Late': added"]
    again = competition.core()
    assert (again.notices, "Late" in again.content.config.passwords) == ([], True)


def test_files_that_no_longer_fit_the_passwords_are_read_again(competition):
    competition.core()
    for name in ("passwords.yaml", "schedule.yaml"):
        path = competition.folder / name
        path.write_text(path.read_text("utf-8").replace("TestingTeam", "Renamed"), "utf-8")
    assert "Renamed" in competition.core().content.config.passwords


@pytest.mark.parametrize("text", ["", "[]", "{}", "{", '{"launch": "launch 1", "present": 1, "versions": {}}',
                                  '{"launch": "launch 1", "present": 0, "versions": {"0": 7}}', "[" * 100_000])
def test_a_damaged_file_is_replaced(competition, text):
    competition.core()
    path = os.path.join(competition.log_dir, CONFIGURATION)
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)
    assert read_in_force(competition.log_dir) is None
    assert minutes(competition.core().content.config) == 10.0
    assert read_in_force(competition.log_dir) is not None


def test_a_disk_that_cannot_be_written_stops_no_start_but_a_reload(competition):
    shutil.rmtree(competition.log_dir, ignore_errors=True)
    with open(competition.log_dir, "w", encoding="utf-8"):
        pass  # a file in the place of the folder
    core = competition.core()
    assert "cannot be kept" in core.notices[0]
    competition.edit("benchmarks.yaml", "timeout: 600", "timeout: 480")
    with pytest.raises(OSError):
        core.keep(core.read(), ())
    assert core.version == 0
