"""A host of modules without ROS: whole runs, its messages, and files that change."""

import shutil

import pytest

from helpers.config_files import SHIPPED
from helpers.dummy_set_up import Timers
from roah_rsbb.bmbox.host.ground_truth_of_frames import NoFrames, ZonesGroundTruth
from roah_rsbb.bmbox.host.host import BEAT_S, ModulesHost, chosen_benchmarks
from roah_rsbb.ground.params import BadParams, Params
from roah_rsbb.model.modules import OutcomeKind, RequestOutcome, RunForModule, Step

RUN = RunForModule("HNF-1", 1, "North", "HNF", "Alpha", 1, 1, running=True)


class Hosted:
    """A host at the test's time, and the states that it sent."""

    def __init__(self, folder, codes=None):
        self.now = 100.0
        self.states = []
        self.timers = Timers(lambda: self.now)
        self.host = ModulesHost(self.timers, str(folder), codes, ZonesGroundTruth(str(folder), NoFrames),
                                self.states.append, lambda: self.now)
        self.host.start()

    def beat(self):
        """Advance to the next beat, and return its state."""
        before = len(self.states)
        self.now += BEAT_S
        self.timers.turn()
        assert len(self.states) == before + 1
        return self.states[-1]

    def info(self, code, zone=""):
        """What the newest state says of a benchmark."""
        return next(info for info in self.states[-1].modules if (info.benchmark, info.zone) == (code, zone))


@pytest.fixture
def folder(tmp_path):
    for name in ("HNF.yaml", "ground_truth.yaml"):
        shutil.copy(str(SHIPPED / "modules" / name), str(tmp_path))
    return tmp_path


def test_the_state_is_sent_when_it_changes_and_every_half_a_second(folder):
    hosted = Hosted(folder)
    assert len(hosted.states) == 1
    hosted.beat()
    hosted.host.take((RUN,))
    assert len(hosted.states) == 3
    progress, = hosted.states[-1].progress
    assert progress.request.text.startswith("Place the robot at the starting pose")
    hosted.host.take((RUN,))
    assert len(hosted.states) == 3, "nothing changed"
    hosted.host.take((RUN._replace(steps=(Step(progress.request, RequestOutcome(OutcomeKind.DONE)),)),))
    assert hosted.states[-1].progress[0].request.text == "waypoint 1"
    hosted.host.take(())
    assert hosted.states[-1].progress == ()
    assert len({state.node for state in hosted.states}) == 1


def test_at_its_end_it_drives_nothing_and_is_silent(folder):
    hosted = Hosted(folder)
    hosted.host.close()
    assert hosted.states[-1] == hosted.states[0]._replace(modules=(), progress=())
    sent = len(hosted.states)
    hosted.now += 10.0
    hosted.timers.turn()
    assert len(hosted.states) == sent


def test_only_runs_of_chosen_benchmarks_are_taken(folder):
    hosted = Hosted(folder, ["STB"])
    assert {info.benchmark for info in hosted.states[-1].modules} == {"STB"}
    hosted.host.take((RUN,))
    assert hosted.states[-1].progress == ()


def test_files_are_followed(folder):
    hosted = Hosted(folder, ["HNF"])
    good = (folder / "HNF.yaml").read_text("utf-8")
    assert hosted.info("HNF").problems == ()
    (folder / "HNF.yaml").write_text("waypoints: soon\n", "utf-8")
    hosted.beat()
    assert f"{folder}/HNF.yaml:1: found the text 'soon' as waypoints" in "".join(hosted.info("HNF").problems)
    (folder / "HNF.yaml").write_text(good, "utf-8")
    hosted.beat()
    assert hosted.info("HNF").problems == ()
    (folder / "HNF.py").write_text("CODE = 1 / 0\n", "utf-8")
    hosted.beat()
    assert "HNF.py:1: found ZeroDivisionError" in "".join(hosted.info("HNF").problems)
    (folder / "HNF.py").unlink()
    (folder / "North").mkdir()
    (folder / "North" / "HNF.yaml").write_text("waypoints: soon\n", "utf-8")
    hosted.beat()
    assert (hosted.info("HNF").problems, len(hosted.info("HNF", "North").problems) > 0) == ((), True)


def test_without_motion_capture_the_referee_reads_the_remedy(folder):
    hosted = Hosted(folder, ["HNF"])
    assert hosted.info("HNF").problems == ()
    warning, = hosted.info("HNF").warnings
    assert warning == (
        "ground truth: reference frame 'testbed' was never seen: motion capture needs ROS: run the box with ROS, or "
        "set 'source: referee' or 'source: none' in ground_truth.yaml")
    (folder / "ground_truth.yaml").write_text("source: referee\n", "utf-8")
    hosted.beat()
    assert hosted.info("HNF").warnings == ()


class Given(Params):
    """Parameters of a dict."""

    def __init__(self, **given):
        super().__init__()
        self.given = given

    def full_name(self, name):
        return name

    def _get(self, name, default):
        return self.given.get(name, default)


def test_the_choice_of_benchmarks(folder):
    (folder / "FetchMug.py").write_text("", "utf-8")
    assert chosen_benchmarks(Given(), str(folder)) is None
    assert chosen_benchmarks(Given(benchmarks="HNF, FetchMug STB"), str(folder)) == ["HNF", "FetchMug", "STB"]
    with pytest.raises(BadParams, match="^parameter benchmarks: no module for HFN: did you mean 'HNF'"):
        chosen_benchmarks(Given(benchmarks="STB HFN"), str(folder))
    with pytest.raises(BadParams, match="^parameter benchmarks: it is empty$"):
        chosen_benchmarks(Given(benchmarks=", "), str(folder))
