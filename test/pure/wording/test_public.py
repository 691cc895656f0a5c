"""The texts of the public display."""

from types import SimpleNamespace

import pytest

from helpers.time_zones import local_time
from roah_rsbb.wording import public

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


def _details(runs=(), following=()):
    return SimpleNamespace(clock=_Time(NOW), box_uuid="", runs=list(runs), following=list(following))


def _card(run):
    (card,) = public.cards(_details([run]))
    return card


@pytest.mark.parametrize("run, big, word", [
    (_run(), "▶ {time}", "running"),
    (_run(counting=False), "‖ 1:30", "PAUSED"),
    (_run(counting=False, elapsed=700.5), "‖ 11:40", "PAUSED"),
    (_run("connected", counting=False), "1:30", "getting ready"),
    (_run("ended", counting=False), "ended", ""),
    (_run("ended", counting=False, end_reason="completed"), "ended", "✓ completed"),
    (_run("ended", counting=False, end_reason="new reason"), "ended", "■ new reason"),
])
def test_a_run(run, big, word):
    card = _card(run)
    assert (card.team, card.benchmark, card.place, card.word) == ("Alpha", "Visitors", "round 2, run 3", word)
    assert public.still(card, run, NOW) == big
    assert card.is_paused == (word == "PAUSED")


def test_the_phase_of_a_task_is_shown():
    assert _card(_run(activity="phase 2 of 3, Serve")).place == "round 2, run 3 · phase 2 of 3, Serve"


def test_zones_are_named_where_there_are_several():
    assert public.cards(_details([_run(zone="A")], [_event(zone="A")]))[0].place == "round 2, run 3"
    both = _details([_run(zone="A")], [_event(zone="B")])
    assert (public.cards(both)[0].place, public.following(both, NOW)[0].last) == ("A · round 2, run 3", "B")


def test_all_teams():
    details = _details([_run(team="ALL")], [_event(team="ALL")])
    assert public.cards(details)[0][1:4] == ("All teams", "Visitors", "round 2, run 3 · Alpha, Beta")
    assert public.following(details, NOW)[0].team == "All teams"


def test_times_are_local_and_name_another_day():
    details = _details((), [_event(), _event(after_s=86400.0)])
    assert [line.time for line in public.following(details, NOW)] == ["08:10", "Sat 08:00"]
    with local_time("UTC-3"):
        assert [line.time for line in public.following(details, NOW)] == ["11:10", "Sat 11:00"]
        assert public.date(NOW) == "Friday, 15 January 2027"


def test_a_clock_that_is_far_off_stops_nothing():
    assert public.date(1e300) == "?"


def test_a_replay_is_marked():
    details = _details([_run()])
    details.box_uuid = "REPLAY 1f691652"
    assert [card.word for card in public.cards(details)] == ["REPLAY · running"]


def test_a_result_and_its_scores():
    def group(name, *values):
        return SimpleNamespace(group_name=name, current_values=list(values))

    score = SimpleNamespace(group="", name="reached", value="4", unit="", desc="Reached")
    result = SimpleNamespace(event=_event(), end_reason="timeout", disconnected=_Time(NOW - 60.0),
                             scoring=[group("Good", 1, 3), group("Empty"), group("Bad", 0, 0)],
                             not_attempted=[0, 0, 1], module_scores=[score], points=NO_POINTS)
    (line,) = public.result_lines([result], NOW)
    scores = ("Reached 4", "Good 4", "Bad 0 (1 not attempted)")
    assert line == ("07:59", "Alpha", "Visitors", "■ timeout", scores)
    result.points = SimpleNamespace(total="-2.5", groups=[
        SimpleNamespace(name="Good", points="10"), SimpleNamespace(name="Bad", points="-12.5")])
    (line,) = public.result_lines([result], NOW)
    assert line.scores == ("Reached 4", "-2.5 points: Good 10 · Bad -12.5")


def test_a_standing():
    rank = SimpleNamespace(rank="1=", team="Alpha", numbers=["5", "0.1 m"])
    out = SimpleNamespace(rank="3", team="Beta", numbers=["disqualified", ""])
    standing = SimpleNamespace(benchmark="Visitors", criteria=["Achievements", "Error (less is better)"],
                               ranks=[rank, out])
    assert public.standings(SimpleNamespace(standings=[standing])) == (public.StandingTexts("Visitors", (
        ("1=", "Alpha", "", "", ("Achievements: 5", "Error (less is better): 0.1 m")),
        ("3", "Beta", "", "", ("Achievements: disqualified",)),
    )),)
