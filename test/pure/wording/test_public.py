"""The texts of the public display."""

from types import SimpleNamespace

import pytest

from helpers.time_zones import local_time
from roah_rsbb.wording import public as public_content

NOW = 1_800_000_000.0  # 2027-01-15 08:00:00 UTC


class _Time(float):
    def to_sec(self):
        return float(self)


@pytest.fixture(autouse=True)
def _utc():
    with local_time("UTC"):
        yield


def _event(zone="Home", team="Alpha", after_s=600.0):
    return SimpleNamespace(zone=zone, team=team, benchmark="Visitors", round=2, run=3, scheduled=_Time(NOW + after_s))


NO_POINTS = SimpleNamespace(total="", groups=[])


def _run(phase="running", counting=True, left=90.0, end_reason="", elapsed=None, activity="", **of_event):
    """A run; with `elapsed` seconds it has no limit."""
    event = _event(**of_event)
    ends = _Time(NOW + left if counting else 0.0)
    return SimpleNamespace(event=event, teams=["Alpha", "Beta"], phase=phase, end_reason=end_reason, counting=counting,
                           ends=ends, left=_Time(left), unlimited=elapsed is not None,
                           elapsed=_Time(elapsed or 0.0), activity=activity)


def _details(runs=(), following=(), finished=()):
    return SimpleNamespace(clock=_Time(NOW), box_uuid="", runs=list(runs), following=list(following),
                           finished=list(finished))


def _content(*args, utc_s=NOW, is_old=False, **kwargs):
    return public_content.content(_details(*args, **kwargs), utc_s, is_old)


def test_a_core_that_was_never_heard():
    assert public_content.content(None, 0.0, True) == public_content.NOTHING
    assert not public_content.NOTHING.is_known


@pytest.mark.parametrize("run, big, word", [
    (_run(), "▶ 1:30", "running"),
    (_run(counting=False), "‖ 1:30", "PAUSED"),
    (_run("connected", counting=False), "1:30", "getting ready"),
    (_run("ended", counting=False), "ended", ""),
    (_run("ended", counting=False, end_reason="completed"), "ended", "✓ completed"),
    (_run("ended", counting=False, end_reason="new reason"), "ended", "■ new reason"),
])
def test_a_run(run, big, word):
    (card,) = _content([run]).cards
    assert (card.team, card.benchmark, card.place, card.big, card.word) == (
        "Alpha", "Visitors", "round 2, run 3", big, word
    )


def test_a_run_without_a_limit_counts_up():
    assert [_content([_run(elapsed=700.5)], utc_s=NOW + s).cards[0].big for s in (0.0, 5.0)] == ["▶ 11:40", "▶ 11:45"]
    paused = _run(counting=False, elapsed=700.5)
    assert _content([paused], utc_s=NOW + 60.0).cards[0].big == "‖ 11:40"


def test_the_phase_of_a_task_is_shown():
    assert _content([_run(activity="phase 2 of 3, Serve")]).cards[0].place == "round 2, run 3 · phase 2 of 3, Serve"


def test_the_countdown_continues_from_one_message_and_ends_at_zero():
    assert [_content([_run()], utc_s=NOW + s).cards[0].big for s in (0.0, 30.0, 89.5, 90.0, 200.0)] == [
        "▶ 1:30", "▶ 1:00", "▶ 0:01", "▶ 0:00", "▶ 0:00"
    ]


def test_zones_are_named_where_there_are_several():
    assert _content([_run(zone="A")], [_event(zone="A")]).cards[0].place == "round 2, run 3"
    both = _content([_run(zone="A")], [_event(zone="B")])
    assert (both.cards[0].place, both.following[0].last) == ("A · round 2, run 3", "B")


def test_all_teams():
    content = _content([_run(team="ALL")], [_event(team="ALL")])
    assert (content.cards[0].team, content.cards[0].place) == ("All teams", "round 2, run 3 · Alpha, Beta")
    assert content.following[0].team == "All teams"


def test_times_are_local_and_name_another_day():
    lines = [_event(), _event(after_s=86400.0)]
    assert [line.time for line in _content((), lines).following] == ["08:10", "Sat 08:00"]
    with local_time("UTC-3"):
        content = _content((), lines)
    assert [line.time for line in content.following] == ["11:10", "Sat 11:00"]
    assert (content.date, content.clock) == ("Friday, 15 January 2027", "11:00:00")


def test_a_clock_that_is_far_off_stops_nothing():
    assert _content(utc_s=1e300).clock == "?"


def test_a_replay_is_marked():
    details = _details()
    assert not public_content.content(details, NOW, is_old=False).is_replay
    details = _details([_run()])
    [word] = [card.word for card in public_content.content(details, NOW, is_old=False).cards]
    details.box_uuid = "REPLAY 1f691652"
    content = public_content.content(details, NOW, is_old=False)
    assert content.is_replay
    assert [card.word for card in content.cards] == [f"REPLAY · {word}"]


def test_old_data_is_reported():
    assert _content().trouble == ""
    assert _content(is_old=True).trouble == "No signal since 08:00:00: this is the last known state"


def test_a_result_and_its_scores():
    def group(name, *values):
        return SimpleNamespace(group_name=name, current_values=list(values))

    score = SimpleNamespace(group="", name="reached", value="4", unit="", desc="Reached")
    result = SimpleNamespace(event=_event(), end_reason="timeout", disconnected=_Time(NOW - 60.0),
                             scoring=[group("Good", 1, 3), group("Empty"), group("Bad", 0, 0)],
                             not_attempted=[0, 0, 1], module_scores=[score], points=NO_POINTS)
    (line,) = _content(finished=[result]).results
    scores = ("Reached 4", "Good 4", "Bad 0 (1 not attempted)")
    assert line == ("07:59", "Alpha", "Visitors", "■ timeout", scores)
    result.points = SimpleNamespace(total="-2.5", groups=[
        SimpleNamespace(name="Good", points="10"), SimpleNamespace(name="Bad", points="-12.5")])
    (line,) = _content(finished=[result]).results
    assert line.scores == ("Reached 4", "-2.5 points: Good 10 · Bad -12.5")


def _board(results=(), provisional=(), standings=()):
    return SimpleNamespace(results=list(results), provisional=list(provisional), standings=list(standings))


def _result(team):
    return SimpleNamespace(event=_event(team=team), end_reason="completed", disconnected=_Time(NOW), scoring=[],
                           not_attempted=[], module_scores=[], points=NO_POINTS)


def test_the_board_has_results_provisional_ones_and_standings():
    rank = SimpleNamespace(rank="1=", team="Alpha", numbers=["5", "0.1 m"])
    out = SimpleNamespace(rank="3", team="Beta", numbers=["disqualified", ""])
    standing = SimpleNamespace(benchmark="Visitors", criteria=["Achievements", "Error (less is better)"],
                               ranks=[rank, out])
    board = _board([_result("A")], [_result("B")], [standing])
    found = public_content.content(_details(finished=[_result("old")]), NOW, False, board)
    assert [[line.team for line in lines] for lines in (found.results, found.provisional)] == [["A"], ["B"]]
    assert found.standings == (public_content.StandingTexts("Visitors", (
        ("1=", "Alpha", "", "", ("Achievements: 5", "Error (less is better): 0.1 m")),
        ("3", "Beta", "", "", ("Achievements: disqualified",)),
    )),)
    assert [line.team for line in _content(finished=[_result("old")]).results] == ["old"], "a core without a board"
