"""The configuration of the box: three YAML files, read and checked once, at the start.

docs/benchmarks.md, "Files" describes the files. Each file in ``config/`` starts with a description, too.
Whatever is wrong in any of them is reported at once, and the box does not start. An error in one file is
not reported again as its consequences in another.
"""

from typing import List, Tuple

from roah_rsbb.rulebook.benchmarks import Config
from roah_rsbb.rulebook.benchmarks_file import BenchmarksFile
from roah_rsbb.rulebook.errors import ConfigError, ConfigErrors, Report
from roah_rsbb.rulebook.passwords_file import PasswordsFile
from roah_rsbb.rulebook.schedule_file import ScheduleFile

__all__ = ["ConfigError", "ConfigErrors", "load"]


def load(benchmarks_file: str, schedule_file: str, passwords_file: str) -> Tuple[Config, List[str]]:
    """Read all three files; return the configuration, and warnings for the log.

    Raises `ConfigErrors` with all errors of all files, and nothing else, whatever the files hold.
    """
    report = Report()
    benchmarks = BenchmarksFile(benchmarks_file, report)
    passwords = PasswordsFile(passwords_file, report)
    schedule = ScheduleFile(schedule_file, report, benchmarks, passwords)
    report.raise_errors()
    return Config(benchmarks.by_code, passwords.by_team, schedule.zones), report.warnings
