"""Two days of the rulebook `athome`: fifteen teams, two arenas and a hall, points worked out by hand."""

import collections

import pytest

from helpers.simulated_day import Behaviour, Day, make_competition
from roah_rsbb.rulebook.config import load_benchmarks
from roah_rsbb.rulebook.standing_rules import read_rules
from roah_rsbb.scoring.counting import RunChoice
from roah_rsbb.scoring.sheet import Mark
from roah_rsbb.scoring.standings import standings

pytestmark = pytest.mark.long

TEAMS = ("Aster", "Birch", "Cedar", "Daisy", "Elder", "Fern", "Gorse", "Hazel", "Iris", "Juniper", "Kale", "Linden",
         "Maple", "Nettle", "Oak")
# What each team does, in the order of the sheet's items.
RECEIVE = {
    "Aster": (2, 2, 2, 4, 4, 0, 0, 0), "Birch": (2, 2, 2, 4, 0, 0, 0, 0), "Cedar": (2, 2, 1, 2, 2, 1, 0, 0),
    "Daisy": (1, 1, 1, 0, 0, 0, 1, 1), "Elder": (0, 0, 0, 0, 0, 2, 1, 0), "Hazel": (2, 1, 2, 1, 0, 0, 0, 0),
    "Iris": (2, 1, 1, 1, 1, 0, 0, 0), "Juniper": (1, 0, 1, 0, 0, 0, 0, 0), "Kale": (0, 1, 1, 0, 0, 0, 0, 0),
    "Linden": (1, 1, 0, 0, 0, 0, 0, 0), "Maple": (2, 0, 2, 0, 0, 0, 0, 1), "Nettle": (2, 2, 0, 3, 0, 0, 0, 0),
    "Oak": (0, 0, 1, 0, 0, 0, 0, 0),
}
ITSELF, HELPED, NOT = "picks it up itself", "has it put into its hand", "does not take it"
CARRY = {
    "Aster": (ITSELF, 1, 1, 0, 0, 0), "Birch": (HELPED, 1, 1, 1, 0, 0), "Cedar": (ITSELF, 0, 1, 0, 0, 0),
    "Daisy": (NOT, 1, 1, 0, 0, 0), "Elder": (ITSELF, 1, 0, 0, 1, 1),
    **{team: (HELPED, 1, 0, 0, bumps, 0) for bumps, team in enumerate(TEAMS[5:])},
}
STORE = {
    "Aster": (5, 5, 5, 1, 0, 0), "Birch": (5, 4, 2, 1, 1, 0), "Cedar": (3, 3, 0, 0, 0, 1), "Daisy": (1, 1, 1, 0, 0, 0),
    "Elder": (0, 0, 0, 0, 3, 0), "Fern": (5, 0, 0, 1, 0, 0), "Gorse": (4, 0, 0, 1, 0, 0), "Hazel": (3, 0, 0, 1, 0, 0),
    "Iris": (2, 0, 0, 1, 0, 0), "Juniper": (1, 0, 0, 1, 0, 0), "Kale": (0, 0, 0, 1, 0, 0), "Linden": (4, 0, 0, 0, 0, 0),
    "Maple": (3, 0, 0, 0, 0, 0), "Nettle": (2, 0, 0, 0, 0, 0), "Oak": (1, 0, 0, 0, 0, 0),
}

# Points by hand.
EXPECTED = {
    # Looks 15, names 20, seats 100, introductions 30 and 20 with at most 180; penalties 20, 50 and 50.
    "Receive": {
        "Aster": 450,  # 30 + 40 + 200 + 180 instead of 200
        "Birch": 390, "Hazel": 280,
        "Cedar": 250,  # 30 + 40 + 100 + 100 - 20
        "Iris": 200,
        "Maple": 180,  # 30 + 200 - 50
        "Nettle": 160, "Kale": 120, "Juniper": 115, "Oak": 100,
        "Daisy": 35,  # 15 + 20 + 100 - 50 - 50
        "Linden": 35,
        "Elder": 0,  # 0 instead of -90
    },
    # The bag 150 or 50, following 300, returning 100 (only if it followed), a point for each 2 s left of 300 s, at most
    # 60, if it returned; penalties 100, 50 and 50.
    "Carry": {
        "Aster": 610,  # 150 + 300 + 100 + 60
        "Birch": 410,  # 50 + 400 + 60 - 100
        "Daisy": 409,  # 400 + 9: between 18 and 20 s are left
        "Elder": 350,  # 150 + 300 - 50 - 50
        "Fern": 350, "Gorse": 300, "Hazel": 250, "Iris": 200,
        "Cedar": 150,  # did not follow, so its return does not count
        "Juniper": 150, "Kale": 100, "Linden": 50, "Maple": 0, "Nettle": 0, "Oak": 0,
    },
    # Recognised 20, stored 60, beside its kind 20, the cabinet 100, at most 500 together; penalties 30 and 40.
    "Store": {
        "Aster": 500, "Birch": 450, "Cedar": 200, "Fern": 200, "Gorse": 180, "Hazel": 160, "Iris": 140, "Juniper": 120,
        "Daisy": 100, "Kale": 100, "Linden": 80, "Maple": 60, "Nettle": 40, "Oak": 20, "Elder": 0,
    },
    # The middle three of five judges: 7 for the problem (2 points each), and for the method and the answers (4 points
    # each) 9 for the first team and half a point less for each further one.
    "Poster": dict(zip(TEAMS, range(86, 26, -4))),
}

# The sums of the four tests; Fern and Gorse have nothing for `Receive`.
OVERALL = [
    (1, "Aster", 1646),  # 450 + 610 + 500 + 86
    (2, "Birch", 1332),  # 390 + 410 + 450 + 82
    (3, "Hazel", 748), (4, "Cedar", 678), (5, "Daisy", 618),
    (6, "Fern", 616),  # 0 + 350 + 200 + 66
    (7, "Iris", 594),
    (8, "Gorse", 542),  # 0 + 300 + 180 + 62
    (9, "Juniper", 435), (10, "Elder", 420), (11, "Kale", 366), (12, "Maple", 278), (13, "Nettle", 234),
    (14, "Linden", 207), (15, "Oak", 150),
]


def values(event, items, row):
    """Marks with these values for the items of a sheet, in their order."""
    assert len(items) == len(row)
    for item, value in zip(items, row):
        yield Mark(item.group, item.desc, text=value) if isinstance(value, str) else Mark(item.group, item.desc, value)


class AtHome(Behaviour):
    """What the tables above say. Fern does not appear at `Receive`, Gorse withdraws, and Nettle has another radio."""

    def course(self, event):
        if event.benchmark.code == "Poster":
            return "open_sheet"
        if event.benchmark.code != "Receive":
            return "connect"
        return {"Fern": "no_show", "Gorse": "withdrawn", "Nettle": "open_sheet"}.get(event.team, "connect")

    def restarts(self, event):
        return 1 if (event.benchmark.code, event.team) == ("Carry", "Elder") else 0

    def result(self, event, number, goal):
        # Daisy prepares for 1 s. Less than a second is what the wire takes, with lost datagrams.
        return (279.5 if (event.benchmark.code, event.team) == ("Carry", "Daisy") else 2.0), None

    def marks(self, event, attempt):
        items = event.benchmark.scoring
        if event.benchmark.code == "Poster":
            yield from self.ratings(TEAMS.index(event.team), items)
        else:
            yield from values(event, items, {"Receive": RECEIVE, "Carry": CARRY, "Store": STORE}[event.benchmark.code][
                event.team])

    def ratings(self, number, items):
        middle = str(9 - number / 2)
        for item, ratings in zip(items, (("10", "8", "7", "6", "0"), ("10", middle, middle, middle, "0"),
                                         (middle, "0", "10", middle, middle))):
            for judge, rating in zip(item.judges, ratings):
                yield Mark(item.group, item.desc, text=rating, judge=judge)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    days = "2026-07-01,2026-07-02,2026-07-03"
    return make_competition(tmp_path_factory.mktemp("athome") / "day", "athome", TEAMS, days)


@pytest.fixture(scope="module")
def records(folder):
    return Day(folder, AtHome()).play()


@pytest.fixture(scope="module")
def found(folder, records):
    return standings_of(folder, records)


def standings_of(folder, records):
    """The standings by code, as the box computes them."""
    events = {code: benchmark.rules for code, benchmark in load_benchmarks(f"{folder}/benchmarks.yaml").items()}
    found = standings(records, read_rules(f"{folder}/standings.yaml"), RunChoice(events=events))
    return {standing.benchmark: standing for standing in found}


def test_every_event_has_its_run(records):
    assert collections.Counter(record.benchmark for record in records) == dict.fromkeys(EXPECTED, 15)
    assert {record.zone for record in records if record.benchmark == "Poster"} == {"Hall"}
    assert {record.zone for record in records if record.benchmark != "Poster"} == {"Arena A", "Arena B"}
    ends = {(record.benchmark, record.team): record.end_reason for record in records}
    assert ends.pop(("Receive", "Fern")) == "no_show"
    assert ends.pop(("Receive", "Gorse")) == "withdrawn"
    assert {key for key, reason in ends.items() if reason == "stopped"} == {
        ("Receive", "Nettle"), *(("Poster", team) for team in TEAMS)}
    assert set(ends.values()) == {"completed", "stopped"}


@pytest.mark.parametrize("code", EXPECTED)
def test_points(records, code):
    assert {record.team: float(record.points.total) for record in records
            if record.benchmark == code and record.end_reason in ("completed", "stopped")} == EXPECTED[code]


@pytest.mark.parametrize("code", EXPECTED)
def test_the_standing_of_a_test(found, code):
    """The points decide. Teams with the same points share a rank. A team without a score is only remarked."""
    points = EXPECTED[code]
    assert ranks_of(found[code]) == {
        team: (1 + sum(other > mine for other in points.values()), mine) for team, mine in points.items()}
    absent = [remark for remark in found[code].remarks if "no score" in remark]
    assert [remark.split(",")[0] for remark in absent] == [f"team {team}" for team in TEAMS if team not in points]


def ranks_of(standing):
    return {line.team: (line.rank, line.numbers[0]) for line in standing.lines}


def test_the_overall_standing_of_the_day(found):
    assert [(line.rank, line.team, line.numbers[0]) for line in found[""].lines] == OVERALL


def test_a_restart_is_on_the_sheet(records):
    (record,) = [record for record in records if (record.benchmark, record.team) == ("Carry", "Elder")]
    assert len(record.stops) == 2


class LastDay(Behaviour):
    """Two attempts at `CleanUp`, of which the better one counts. Cedar does not appear at `Restaurant`."""

    def course(self, event):
        return "no_show" if (event.benchmark.code, event.team) == ("Restaurant", "Cedar") else "connect"

    def attempts(self, event):
        return 2 if event.benchmark.code == "CleanUp" and event.team in ("Aster", "Birch", "Cedar") else 1

    def result(self, event, number, goal):
        return 2.0, None

    def marks(self, event, attempt):
        first = {"Aster": (2, 2, 4, 0, 10), "Birch": (1, 1, 0, 1, -3), "Daisy": (0, 0, 0, 2, 0)}
        second = {"Aster": (6, 3, "alone", 1), "Birch": (0, 0, "not at all", 2), "Cedar": (2, 1, "with help", 0)}
        if event.benchmark.code == "Restaurant":  # nobody marks the incident
            yield from values(event, event.benchmark.scoring[:-1], first.get(event.team, (1, 0, 0, 0, 0)))
        else:
            row = (1, 0, "not at all", 0) if attempt == 1 else second[event.team]
            yield from values(event, event.benchmark.scoring, row)


def test_the_last_day(folder):
    day = Day(folder, LastDay(), number=3)
    found = standings_of(folder, day.play())
    # The first attempt of each team: a dish, 80. The second ones: 480 + 300 + 200 - 40; nothing; 160 + 100 + 50.
    assert ranks_of(found["CleanUp"]) == {
        **dict.fromkeys(TEAMS, (3, 80)), "Aster": (1, 940), "Cedar": (2, 310)}
    # 200 + 300 + 600 + 100; 100 + 150 - 80 - 30; 0 instead of -160; Cedar's absence counts as 0.
    assert ranks_of(found["Restaurant"]) == {
        **dict.fromkeys(TEAMS, (3, 100)), "Aster": (1, 1200), "Birch": (2, 140), "Cedar": (14, 0), "Daisy": (14, 0)}
    assert [(line.rank, line.team, line.numbers[0]) for line in found[""].lines[:3]] == [
        (1, "Aster", 2140), (2, "Cedar", 310), (3, "Birch", 220)]
