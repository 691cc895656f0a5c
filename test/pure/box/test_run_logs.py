"""The bags of runs are made by another process when runs are over, also of earlier runs and after troubles."""

import os
import queue
import re
import time

import pytest

from helpers.bags import NAME, UUID, entries, plain, read
from helpers.journals import Writer
from helpers.results_of import task_record
from roah_rsbb.box import run_logs as writers
from roah_rsbb.box.run_logs import RunLogWriter, log_name, unused
from roah_rsbb.core.effects import RunClosed, RunOpened
from roah_rsbb.ground import linux
from roah_rsbb.journal.bag import LOCK
from roah_rsbb.journal.records import Batch

PORT, OTHER = 6670, 6671
LIMIT_S = 120.0


class Box:
    """The run logs of a box, and its journal."""

    def __init__(self, log_dir):
        self.journal, self.news = Writer(log_dir), queue.Queue()
        self.logs = RunLogWriter(str(log_dir), UUID, self.news.put, lambda *texts: self.news.put(texts))

    def open(self, port):
        self.logs.opened(RunOpened(port, "Alpha", 1, 1, f"r{port}"), 1e9)
        path = self.logs.files[port]
        record = task_record("Alpha", port)._replace(closed_utc=0.0)
        self.journal.run(record, ((port, "r1"),))
        self.journal.journal.write(Batch(log_files={port: path}))
        for topic, value, _ in entries(3, first=port):
            self.journal.entry(topic, value, record.identity, port=port)
        return path, record

    def close(self, port, record):
        self.journal.outcome(record._replace(closed_utc=2e9))
        self.logs.closed(RunClosed(port))


@pytest.fixture
def box(tmp_path):
    made = Box(tmp_path)
    yield made
    made.logs.stop()
    made.journal.close()


def made(path):
    deadline = time.monotonic() + LIMIT_S
    while not os.path.exists(path):
        assert time.monotonic() < deadline
        time.sleep(0.02)
    return read(path)


def test_a_bag_is_made_when_the_run_is_over(box, tmp_path):
    (path, record), (other, _) = box.open(PORT), box.open(OTHER)
    assert path != other and not list(tmp_path.glob("*.bag")), "nothing is written before"
    box.close(PORT, record)
    assert made(path) == plain(entries(3, first=PORT))
    assert list(box.logs.files) == [OTHER] and not os.path.exists(other), "that run continues"
    assert box.news.empty()


def test_the_process_gives_way_to_the_box(box):
    assert "19" in box.logs._command[:3]


def test_missing_bags_of_earlier_runs_are_made(tmp_path):
    before = Box(tmp_path)
    paths = []
    for port in (PORT, OTHER):
        path, record = before.open(port)
        before.journal.outcome(record._replace(closed_utc=2e9))  # it is killed before it makes the bag
        paths.append(path)
    ongoing, _ = before.open(OTHER + 1)
    before.journal.close()
    after = Box(tmp_path)
    logs = after.journal.journal.previous.ended_logs
    assert sorted(logs) == sorted(paths), "not of the run that continues"
    after.logs.make(f"/another/computer/{os.path.basename(path)}" for path in logs)
    assert [made(path) for path in paths] == [plain(entries(3, first=port)) for port in (PORT, OTHER)]
    after.logs.stop()
    assert not os.path.exists(ongoing)


def test_a_trouble_is_reported_until_it_is_over(box, tmp_path, monkeypatch):
    monkeypatch.setattr(writers, "RETRY_S", 0.01)
    fd = os.open(str(tmp_path / LOCK), os.O_RDWR | os.O_CREAT)
    linux.lock(fd)
    path, record = box.open(PORT)
    box.close(PORT, record)
    problem = box.news.get(timeout=LIMIT_S)
    assert "another program makes the bags just now" in problem and "The journal has all of them" in problem
    os.close(fd)
    assert box.news.get(timeout=LIMIT_S) == (problem, "The run logs are complete again")
    assert made(path) == plain(entries(3, first=PORT))


def test_a_run_that_the_journal_has_later_is_made_later(box, monkeypatch):
    """Its disk was full at the run's end."""
    monkeypatch.setattr(writers, "RETRY_S", 0.01)
    path, record = box.open(PORT)
    box.logs.closed(RunClosed(PORT))
    box.journal.outcome(record._replace(closed_utc=2e9))
    assert made(path) == plain(entries(3, first=PORT))
    assert box.news.empty()


def test_the_end_of_the_box_waits_for_the_last_bag(box, monkeypatch):
    monkeypatch.setattr(writers, "STOP_S", LIMIT_S)
    path, record = box.open(PORT)
    box.close(PORT, record)
    box.logs.stop()
    assert read(path) == plain(entries(3, first=PORT))


@pytest.mark.parametrize("known", [f"/logs/{NAME}", ""])
def test_a_run_that_continues_keeps_its_name(box, tmp_path, known):
    box.logs.resumed(PORT, known)
    path = box.logs.files[PORT]
    assert os.path.dirname(path) == str(tmp_path) and (not known or os.path.basename(path) == NAME)


def test_no_two_runs_have_one_name(box):
    for port in (PORT, OTHER):
        box.logs.opened(RunOpened(port, "Alpha", 1, 1, ""), 1e9)
    assert len(set(box.logs.files.values())) == 2


def test_a_place_that_is_no_folder(tmp_path):
    (tmp_path / "file").touch()
    logs = RunLogWriter(str(tmp_path / "file" / "log"), UUID, print, print)
    assert "Choose another log_dir" in logs.check()
    logs.stop()


# -- names ------------------------------------------------------------------------------------------


def _name(team="Alpha", robot=""):
    return log_name(1_800_000_000.0, team, robot, 2, 3, "uuid")


def test_a_name_says_when_and_whose_run_it_is():
    assert re.fullmatch(r"online_log_2027-01-1\d_\d\d-\d\d-00_Alpha_round2_run3_uuid\.bag", _name())


def test_where_several_robots_of_a_team_run_at_once_it_says_which():
    assert "_Alpha_r1_round2" in _name(robot="r1")


@pytest.mark.parametrize("team, robot, who", [
    ("A b", "", "A-b"), ("Ä/..:x", "", "Ä-..-x"), ("Alpha", "../../etc", "Alpha_..-..-etc"),
    ("Alpha", "r 1:ä", "Alpha_r-1--"),
    ("Alpha", "x" * 100, "Alpha_" + "x" * 40), ("Alpha", "ä" * 100, "Alpha_" + "-" * 40),
])
def test_nothing_is_in_it_that_a_file_system_minds(team, robot, who):
    name = _name(team, robot)
    assert f"_{who}_round2" in name
    assert "/" not in name
    assert len(name.encode()) < 255


def test_no_two_runs_share_a_log(tmp_path):
    path = str(tmp_path / _name())
    assert unused(path, 6667, {}) == path
    other = path.replace(".bag", "_port6668.bag")
    assert unused(path, 6668, {path: 1}) == other
    with open(path, "w"):
        assert unused(path, 6668, {}) == other
