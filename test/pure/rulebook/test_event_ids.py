"""Ids of events: read, made where they are missing, kept through changes, and written into the file."""

import dataclasses
import re

import pytest

from helpers.competition import UTC0, event
from helpers.config_files import TEXTS, ConfigDir
from roah_rsbb.rulebook.benchmarks import ZonePlan
from roah_rsbb.rulebook.event_ids import VALID, adopted, key_of, known_by, new_id, written

HOUR, DAY = 3600.0, 86_400.0
FLOW = """\
# A comment stays.
- zone: Home
  schedule:
    - { benchmark: HGTKMH, team: TestingTeam, round: 1, run: 1, scheduled_time: 2026-11-28 08:00:00 }  # Saturday
    - {benchmark: HWV, team: TestingTeam, round: 1, run: 1, scheduled_time: 2026-11-28 09:00:00, id: mine}

    # Another comment.
    -   benchmark: HWV
        team: TestingTeam   # keys under each other
        round: 1
        run: 2
        scheduled_time: 2026-11-28 10:00:00
"""


def named(*events):
    """A schedule whose events have ids because their file lacks them."""
    place = object()
    events = tuple(dataclasses.replace(e, id=known_by(e, ()), id_goes=place) for e in events)
    return adopted((ZonePlan("a", events),), ())


def ids(zones):
    return [e.id for zone in zones for e in zone.events]


def test_an_id_is_read_and_a_missing_one_is_always_the_same(tmp_path):
    zones = ConfigDir(tmp_path).load(schedule=FLOW)[0].zones
    again = ConfigDir(tmp_path).load(schedule=FLOW.replace("08:00:00", "08:40:00"))[0].zones
    assert ids(zones) == ids(again)
    assert ids(zones)[1] == "mine"
    assert len(set(ids(zones))) == 3
    assert all(VALID.fullmatch(own) for own in ids(zones))
    assert [e.id_goes is None for e in zones[0].events] == [False, True, False]


@pytest.mark.parametrize("change", [lambda text: text, lambda text: text.replace("\n", "\r\n"), "\ufeff{}".format])
def test_ids_are_written_without_a_change_of_anything_else(tmp_path, change):
    folder, text = ConfigDir(tmp_path), change(FLOW)
    zones = folder.load(schedule=text)[0].zones
    new = written(text, zones)
    assert written(new, folder.load(schedule=new)[0].zones) == new
    assert ids(folder.load(schedule=new)[0].zones) == ids(zones)
    assert re.sub(r"(?<=\{ )id: \w+, |id: \w+\r?\n +", "", new) == text
    first, _, last = ids(zones)
    assert f"    - {{ id: {first}, benchmark: HGTKMH, " in new
    assert f"    -   id: {last}\n        benchmark: HWV" in new.replace("\r", "")


def test_the_shipped_schedule_can_take_ids(tmp_path):
    folder = ConfigDir(tmp_path)
    zones = folder.load()[0].zones
    new = written(TEXTS["schedule"], zones)
    assert ids(folder.load(schedule=new)[0].zones) == ids(zones)
    assert len(set(ids(zones))) == len(ids(zones)) == new.count(" id: ")


@pytest.mark.parametrize(("old", "new", "message"), [
    ("{ benchmark: HGTKMH", "{ id: mine, benchmark: HGTKMH", "id 'mine' again; expected each id once: delete the key"),
    ("id: mine", "id: 7", "the number '7' as id"), ("id: mine", "id: 'a b'", "the text 'a b' as id"),
    ("id: mine", "id: []", "as id"),
])
def test_errors_of_ids(tmp_path, old, new, message):
    (_, _, text), = ConfigDir(tmp_path).errors(schedule=FLOW.replace(old, new, 1))
    assert message in text


def test_twins_have_ids_of_their_own():
    zones = named(event(), event(scheduled=UTC0 + HOUR), event(scheduled=UTC0 + DAY))
    assert len(set(ids(zones))) == 3


@pytest.mark.parametrize(("moved_s", "is_same"), [(0.0, True), (40 * 60.0, True), (-9 * HOUR, True), (DAY, False)])
def test_an_event_without_an_id_is_the_one_of_the_same_day(moved_s, is_same):
    before = (ZonePlan("b", (dataclasses.replace(event(), id="explicit"),)),)
    found = adopted(named(event(scheduled=UTC0 + moved_s)), before)
    assert (ids(found) == ["explicit"]) is is_same


def test_an_event_at_the_same_time_stays_the_same_with_another_round():
    """A run late on Friday, which is round 1 now, took the id of Saturday's, and with it its runs."""
    saturday = event("HWV", round=1)
    friday = event("HWV", round=1, scheduled=UTC0 - 9 * HOUR)
    before = named(saturday)
    after = adopted(named(friday, dataclasses.replace(saturday, round=2)), before)
    assert ids(after)[1] == ids(before)[0] != ids(after)[0]


def test_an_event_without_an_id_may_have_had_runs_before_it_was_removed():
    x, y = dataclasses.replace(event(), id="x"), dataclasses.replace(event(scheduled=UTC0 + HOUR), id="y")
    new = named(event())
    assert ids(adopted(new, (), [key_of(x)])) == ["x"]
    assert ids(adopted(new, (ZonePlan("a", (y,)),), [key_of(x)])) == ["y"], "what is in force comes first"
    others = key_of(x)._replace(team="Beta"), key_of(x)._replace(scheduled=UTC0 + DAY)
    assert ids(adopted(new, (), others)) == ids(new)
    assert ids(adopted((ZonePlan("a", (x, *new[0].events)),), (), [key_of(x)])) == ["x", *ids(new)]


def test_an_id_in_the_file_is_never_given_to_another_event():
    """The event moved to the next day with its id, and a new line with the same numbers stands in its old place."""
    old = named(event())
    own, = ids(old)
    moved = dataclasses.replace(event(scheduled=UTC0 + DAY), id=own)
    new = dataclasses.replace(event(), id=own, id_goes=object())
    found = adopted((ZonePlan("a", (new, moved)),), old)
    assert ids(found)[1] == own
    assert ids(found)[0] != own


def test_new_ids_differ():
    taken = set()
    for _ in range(500):
        taken.add(new_id(taken))
    assert len(taken) == 500
    assert all(VALID.fullmatch(own) for own in taken)
