"""The texts of the public pages."""

import pytest

from helpers.public_box import PublicBox, event, result, run
from helpers.shown_box import NOW
from helpers.time_zones import local_time
from roah_rsbb.model.document import PublicGroup, PublicItem, PublicRank, PublicStanding
from roah_rsbb.model.records import GroupPoints, ScoreValue, SheetPoints
from roah_rsbb.wording import public


@pytest.fixture(autouse=True)
def _utc():
    with local_time("UTC"):
        yield


def card(shown, following=()):
    (found,) = public.cards(PublicBox([shown], following).document)
    return found


@pytest.mark.parametrize("shown, look, big, word", [
    (run(), "executing", "{time}", "running"),
    (run(counting=False), "executing", "1:30", "PAUSED"),
    (run(counting=False, elapsed=700.9), "executing", "11:40", "PAUSED"),
    (run(phase="connected", counting=False), "ready", "1:30", "ready"),
    (run(phase="ended", counting=False), "stopped", "1:30", "ended"),
    (run(phase="ended", counting=False, end_reason="completed"), "completed", "1:30", "completed"),
    (run(phase="ended", counting=False, end_reason="new reason"), "stopped", "1:30", "new reason"),
])
def test_a_run(shown, look, big, word):
    assert card(shown) == (look, "Alpha", "Visitors", "round 2, run 3", big, word, word == "PAUSED")


def test_the_phase_of_a_task_is_shown():
    assert card(run(activity="phase 2 of 3, Serve")).place == "round 2, run 3 · phase 2 of 3, Serve"


def test_zones_are_named_where_there_are_several():
    assert card(run("A"), [event("A")]).place == "round 2, run 3"
    both = PublicBox([run("A")], [event("B")]).document
    assert (public.cards(both)[0].place, public.following(both, NOW)[0].last) == ("A · round 2, run 3", "B")


def test_all_teams():
    shown = run()
    found = card(shown._replace(event=shown.event._replace(team="ALL"), teams=("Alpha", "Beta")))
    assert (found.team, found.place) == ("All teams", "round 2, run 3 · Alpha, Beta")
    assert public.following(PublicBox([], [event(team="ALL")]).document, NOW)[0].team == "All teams"


def test_times_are_local_and_name_another_day():
    document = PublicBox([], [event(), event(after_s=86400.0)]).document
    assert [line.time for line in public.following(document, NOW)] == ["08:10", "Sat 08:00"]
    with local_time("UTC-3"):
        assert [line.time for line in public.following(document, NOW)] == ["11:10", "Sat 11:00"]
        assert public.date(NOW) == "Friday, 15 January 2027"


def test_an_event_that_is_late():
    late = event()._replace(begins_utc_s=NOW + 1500.0)
    early = event()._replace(begins_utc_s=NOW)  # none begins before its time
    found = public.following(PublicBox([], [late, early, event()]).document, NOW)
    assert [(line.time, line.planned) for line in found] == [("08:25", "08:10"), ("08:10", ""), ("08:10", "")]


def test_a_clock_that_is_far_off_stops_nothing():
    assert public.date(1e300) == "?"


def test_a_replay_is_marked():
    document = PublicBox([run()]).document
    replay = document._replace(box=document.box._replace(uuid="REPLAY 1f691652"))
    assert [found.word for found in public.cards(replay)] == [f"REPLAY · {public.cards(document)[0].word}"]


def test_a_result_and_its_scores():
    def group(name, not_attempted, *values):
        return PublicGroup(name, tuple(PublicItem("item", "count", value) for value in values), not_attempted)

    found = result()._replace(
        end_reason="timeout", groups=(group("Good", 0, 1, 3), group("Empty", 0), group("Bad", 1, 0, 0)),
        module_scores=(ScoreValue("", "reached", "4", "", "Reached"),), points=None)
    (line,) = public.result_lines([found], NOW)
    assert line[:4] == ("07:59", "Alpha", "Visitors", "timeout")
    assert line.scores == (("Reached", "4"), ("Good", "4"), ("Bad", "0 (1 not attempted)"))
    assert (line.look, line.points, line.rank) == ("timeout", "", "")
    points = SheetPoints("-2.5", (GroupPoints("Good", "10"), GroupPoints("Bad", "-12.5")))
    standing = PublicStanding("Visitors", (), (PublicRank("1=", "Beta", ()), PublicRank("3", "Alpha", ())))
    (line,) = public.result_lines([found._replace(points=points)], NOW, [standing])
    assert (line.points, line.rank) == ("-2.5", "3")
    assert line.scores == (("Reached", "4"), ("Good", "10"), ("Bad", "-12.5"))


def test_a_standing():
    ranks = (PublicRank("1=", "Alpha", ("5", "0.1 m")), PublicRank("3", "Beta", ("disqualified", "")))
    standing = PublicStanding("Visitors", ("Achievements", "Error (less is better)"), ranks, ("Gamma is not there",))
    found = public.standings(PublicBox([run()], standings=[standing]).document)
    assert found == ((*standing[:3], (("Gamma is not there", ""),)),)
