"""Files that are repaired while they are in use."""

import os

import pytest

from roah_rsbb.bmbox.framework.rule_files import WatchedFile
from roah_rsbb.rulebook.errors import ConfigErrors, Report
from roah_rsbb.rulebook.yaml_lines import Place


class Reader:
    """Reads a file whose content must be a number."""

    def __init__(self, path):
        self.path = path
        self.times = 0

    def __call__(self):
        self.times += 1
        try:
            return int(self.path.read_text(encoding="utf-8"))
        except (OSError, ValueError):
            report = Report()
            report.error(Place(str(self.path), 1, 1), "nonsense", "a number")
            report.raise_errors()


@pytest.fixture
def path(tmp_path):
    return tmp_path / "number"


def watched(path):
    read = Reader(path)
    return WatchedFile(str(path), read), read


def test_it_is_read_only_when_it_changed(path):
    path.write_text("1", encoding="utf-8")
    file, read = watched(path)
    assert (file.content(), file.problems, read.times) == (1, [], 1)
    assert not file.reload()
    path.write_text("22", encoding="utf-8")
    assert (file.content(), read.times) == (22, 2)
    other = path.with_name("other")
    other.write_text("33", encoding="utf-8")
    os.utime(str(other), ns=(path.stat().st_atime_ns, path.stat().st_mtime_ns))
    other.replace(path)  # as editors do; the same size, the same time
    assert file.reload()
    assert file.content() == 33


def test_errors_are_reported_until_they_are_repaired(path):
    file, read = watched(path)
    assert len(file.problems) == 1
    with pytest.raises(ConfigErrors, match="nonsense"):
        file.content()
    assert read.times == 1
    path.write_text("x", encoding="utf-8")
    assert file.reload()
    assert "number:1: found nonsense; expected a number" in file.problems[0]
    path.write_text("5", encoding="utf-8")
    assert (file.content(), file.problems) == (5, [])
    path.unlink()
    with pytest.raises(ConfigErrors):
        file.content()
    assert len(file.problems) == 1
