"""The replay page shows at any moment what the box showed then; no string of a robot breaks out of its data."""

import bisect
import html
import json
import pathlib
import re

import pytest

from helpers.competition import DOOR
from helpers.journals import UTC0, Writer
from helpers.replayed import ReplayedCompetition, SetClock
from helpers.replayed import clock_at as times_at
from helpers.results_of import EVIL, runs_in, write_full_run
from roah_rsbb.journal.reader import JournalReader
from roah_rsbb.results.replay import page_parts, replay_data, replay_name, replay_of, replay_page
from roah_rsbb.results.runs import run_moments
from roah_rsbb.results.sheet import sheet_page
from roah_rsbb.wording import sheets
from roah_rsbb.wording.texts import visible

PARTS = page_parts(str(pathlib.Path(__file__).resolve().parents[3] / "resource" / "replay"))


def data_of(reader, number):
    result = runs_in(reader.path)[number - 1]
    moments = run_moments(reader, result.record.identity, pytest.fail)
    return replay_data(result, moments, in_utc=True), result.record


@pytest.fixture(scope="module", params=[1, 2])
def played(request, tmp_path_factory):
    driver = ReplayedCompetition(tmp_path_factory.mktemp("replayed"), request.param)
    path = driver.play()
    yield driver, JournalReader(path)


def value_at(track, at):
    """What the page shows of a track: its last value up to this moment."""
    place = bisect.bisect_right([time for time, _ in track], at)
    return track[place - 1][1] if place else None


def clock_at(data, at):
    place = bisect.bisect_right([time for time, _ in data["clock"]], at) - 1
    since, clock = data["clock"][place]
    return clock, (at - since) / 1000


def assert_same_clock(data, at, view, now):
    (clock, passed_s), times = clock_at(data, at), times_at(view.clock, now)
    for name, counting in (("elapsed", "counting"), ("goal_elapsed", "goal_counting"),
                           ("phase_elapsed", "counting"), ("setup_elapsed", "setup_counting")):
        shown = clock.get(name, 0.0) + (passed_s if clock.get(counting) else 0.0)
        if name in ("phase_elapsed", "goal_elapsed") and not getattr(view.clock, name[:-8] + {
                "phase_elapsed": "_number", "goal_elapsed": ""}[name]):
            continue  # the page does not show it
        assert shown == pytest.approx(times[name], abs=0.01), name
    counting = {"counting": view.clock.elapsed.counting, "setup_counting": view.clock.setup_elapsed.counting}
    for name in ("counting", "paused", "goal", "phase_number", "phase_name", "setup_counting"):
        value = counting[name] if name in counting else getattr(view.clock, name)
        assert clock.get(name, "" if isinstance(value, str) else type(value)()) == value, name


def test_every_moment_is_that_of_the_box(played):
    driver, reader = played
    for number in (1, 2):
        data, record = data_of(reader, number)
        looks = driver.looks[record.identity]
        assert len(looks) > 10
        for look in looks:
            at, view = (look.now.utc - record.opened_utc) * 1000, look.view
            assert value_at(data["phase"], at) == [view.phase, sheets.end_reason(view.end_reason)]
            assert value_at(data["desc"], at) == visible(look.desc)
            assert_same_clock(data, at, view, look.now)
            [robot] = data["robots"]
            assert value_at(robot["box"], at) == view.robot.box_state
            assert value_at(robot["robot"], at) == view.robot.robot_state
            sheet = [value_at(values, at) for values in data["values"]]
            assert [line and line[0] for line in sheet] == [
                sheets.item_value(i.type, i.value, i.not_attempted, i.text) for i in view.items]
            if view.points is not None:
                assert value_at(data["points"], at) == view.points.total
                assert [line[1] for line in sheet] == [i.points for i in view.items]
            modules = [line[2] for line in value_at(data["module"], at) or []]
            assert modules == [f"{float(s.value):g} {s.unit}" for s in view.module_scores]


def test_everything_that_happened_is_in_the_list(played):
    _, reader = played
    task, goals = data_of(reader, 1)[0], data_of(reader, 2)[0]
    assert {"Timeline of states", "Scores", "Referee's commands", "Online data", "Home devices and tablet"} \
        <= set(task["kinds"])
    texts = [event[4] for event in goals["events"]]
    assert any(text.startswith("Goal: ") for text in texts)
    assert any(text.startswith("Result: ") for text in texts)
    assert f"{DOOR.group}: {DOOR.desc}: 1" in [event[4] for event in task["events"]]
    times = [event[0] for event in task["events"]]
    assert times == sorted(times)
    assert task["events"][task["latest"][0][2][0]][4].startswith("notification: at ")
    assert task["length"] == max(times)
    assert len(task["robots"][0]["link"]) > 20


def test_the_timeline_leads_from_an_item_to_its_marks(played):
    _, reader = played
    data, record = data_of(reader, 1)
    kinds = [one["kind"] for one in data["timeline"]]
    assert kinds[0] == "connect" and {"start", "mark", "disconnect"} <= set(kinds)
    marks = [one for one in data["timeline"] if one["kind"] == "mark"]
    assert [(one["at"], data["items"][one["item"]]) for one in marks] == [
        (round((entry.utc - record.opened_utc) * 1000), [visible(entry.group), visible(entry.desc)])
        for entry in record.history]
    assert [one["at"] for one in data["timeline"]] == sorted(one["at"] for one in data["timeline"])


def test_clocks_that_only_pass_are_not_repeated(played):
    _, reader = played
    data, record = data_of(reader, 1)
    assert len(data["clock"]) < len(reader.states(record.identity)) / 2


def _page(reader, number, **options):
    return replay_of(reader, runs_in(reader.path)[number - 1], PARTS, True, pytest.fail, **options)


# -- a clock that is set ----------------------------------------------------------------------------


@pytest.mark.parametrize("seconds", [-10.0, 86400.0])
def test_a_step_of_the_clock_does_not_change_the_times_of_a_replay(tmp_path, seconds):
    pages, plots = [], []
    for folder, step in (("plain", 0.0), ("set", seconds)):
        reader = JournalReader(SetClock(tmp_path / folder, step).play())
        pages.append([data_of(reader, number)[0] for number in (1, 2)])
        plots.append(_link_plot(reader))
    for plain, data in zip(*pages):
        assert len(plain["clock"]) > 2 < len(plain["robots"][0]["box"])
        for name in ("length", "desc", "phase", "clock", "values", "points", "module"):
            assert data[name] == plain[name], name
        [robot], [plain_robot] = data["robots"], plain["robots"]
        assert (robot["box"], robot["robot"]) == (plain_robot["box"], plain_robot["robot"])
        assert [second[0] for second in robot["link"]] == [second[0] for second in plain_robot["link"]]
        times = [event[0] for event in data["events"]]
        assert times == sorted(times)
        assert "Clock" not in dict(plain["facts"])
        assert f"set by {seconds:+.0f} s" in dict(data["facts"])["Clock"]
    (plain, plain_text), (data, text) = plots
    assert "EXECUTING" in plain == data
    assert (f"set by {seconds:+.0f} s" in text, "clock was set" in plain_text) == (True, False)


def _link_plot(reader):
    """The states and the time on the sheet of the first run, as they are drawn, and the sheet."""
    text = sheet_page(runs_in(reader.path)[0], True)
    return text[text.index(">Box<"):text.index("</svg>")], text


# -- hostile strings --------------------------------------------------------------------------------


def test_no_string_breaks_out_of_the_data(played):
    _, reader = played
    page = _page(reader, 1)
    block = re.search(r'<script id="data" type="application/json">(.*?)</script>', page, re.S).group(1)
    assert block.isascii()
    assert not set(block) & set("<>&\n")
    texts = [event[4] for event in json.loads(block)["events"]]
    assert any(visible(EVIL) in text for text in texts)
    assert any("</script><!--\\u2028" in text for text in texts)
    assert page.count("<script") == 2
    assert EVIL not in page


def test_hostile_names_stay_text():
    data = {"title": "</title><script>alert(1)</script>\u202e@DATA@", "video": ""}
    page = replay_page(data, PARTS)
    assert page.count("<script") == 2
    assert html.escape("</title><script>alert(1)</script>\\u202e@DATA@") in page


def test_the_page_may_load_nothing(played):
    _, reader = played
    page = _page(reader, 1)
    assert "default-src &#x27;none&#x27;" in page
    assert not re.search(r'(src|href)="', page)
    assert "unsafe" not in page


@pytest.mark.parametrize(("video", "source", "address"), [
    ("https://example.org/run.mp4?a=1", "media-src blob: https://example.org;", "https://example.org/run.mp4?a=1"),
    ("run 3.mp4", "media-src blob: &#x27;self&#x27; file:;", "run%203.mp4"),
    ("../videos/100% #3?.mp4", "media-src blob: &#x27;self&#x27; file:;", "../videos/100%25%20%233%3F.mp4"),
    ("javascript:alert(1)", "media-src blob: &#x27;self&#x27; file:;", "javascript%3Aalert%281%29"),
    ("https://a;script-src *", "media-src blob: &#x27;self&#x27; file:;", "https://a;script-src *"),
])
def test_a_video_may_only_come_from_its_own_place(played, video, source, address):
    page = _page(played[1], 1, video=video)
    assert source in page.split("<title>")[0]
    assert f'"video":{json.dumps(address)}' in page


# -- journals that do not have everything -----------------------------------------------------------


def test_a_journal_of_an_earlier_version_has_events_but_no_clock(tmp_path):
    writer = Writer(tmp_path)
    record = write_full_run(writer)
    writer.close()
    data, _ = data_of(JournalReader(writer.path), 1)
    assert (data["clock"], data["values"][0], data["points"]) == ([], [], [])
    assert data["phase"] == [[round((record.closed_utc - record.opened_utc) * 1000), ["disconnected", "stopped"]]]
    assert len(data["events"]) > 10
    assert value_at(data["robots"][0]["box"], 3_600_000) is not None


def test_a_damaged_state_makes_a_gap_and_is_reported(tmp_path):
    writer = Writer(tmp_path)
    record = write_full_run(writer)
    state = {"zone": {"run": {"phase": "RUNNING", "end_reason": None, "book": {}}}, "clock": {"counting": True}}
    for value in ({"number": 1, "change": [state]}, {"number": 3, "change": {"clock": {"elapsed": [1.0]}}}):
        writer.entry("state", value, identity=record.identity)
    writer.close()
    reported = []
    moments = run_moments(JournalReader(writer.path), record.identity, reported.append)
    assert [moment.clock for moment in moments] == [{"counting": True}]
    assert reported == [f"1 states of run {record.identity} cannot be read: its replay has gaps"]


def test_the_name_of_the_file_is_that_of_the_sheet(tmp_path):
    writer = Writer(tmp_path)
    record = write_full_run(writer)
    writer.close()
    assert replay_name(7, record) == "007_HGTKMH_Alpha_round1_run1_replay.html"
    assert record.opened_utc > UTC0
