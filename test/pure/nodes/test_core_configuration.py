"""The configuration files of the core: in force, edited, read again, and after a crash."""

import os
import shutil

import pytest

from helpers.config_files import SHIPPED
from roah_rsbb.journal.in_force import FILE_NAME, read_in_force
from roah_rsbb.nodes.core.configuration import EDITED, Configuration
from roah_rsbb.rulebook.errors import ConfigErrors

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


def test_the_errors_of_all_files_at_once(competition):
    core = competition.core()
    competition.edit("benchmarks.yaml", "timeout: 600", "timeout: soon")
    competition.edit("schedule.yaml", "round: 1", "round: one")
    competition.edit("standings.yaml", "criteria:", "criterias:")
    with pytest.raises(ConfigErrors) as wrong:
        core.read()
    assert {os.path.basename(error.file) for error in wrong.value.errors} == {
        "benchmarks.yaml", "schedule.yaml", "standings.yaml"}


def test_other_standings_are_a_change(competition):
    core = competition.core()
    competition.edit("standings.yaml", "runs: best", "runs: mean")
    assert core.changes(core.read()) == ["standings: other rules"]


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
    with open(os.path.join(competition.log_dir, FILE_NAME), encoding="utf-8") as file:
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
    path = os.path.join(competition.log_dir, FILE_NAME)
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
