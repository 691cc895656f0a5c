"""A day of the rulebook `heartmet`: four teams, all rules, goals and results as JSON, standings worked out by hand."""

import json
import re
from fractions import Fraction

import pytest

from helpers.simulated_day import Behaviour, Day, make_competition
from roah_rsbb.rulebook.standing_rules import read_rules
from roah_rsbb.scoring.counting import RunChoice
from roah_rsbb.scoring.sheet import Mark
from roah_rsbb.scoring.standings import standings

pytestmark = pytest.mark.long

TEAMS = ("Ada", "Bea", "Cyd", "Dot")
ACHIEVEMENTS = ("Says which item the person asked for", "Reaches the place of the item", "Takes the right item",
                "Returns to the person", "Hands the item over")
# Of each team: how many achievements, and how often it bumps into the furniture or hits a person.
DELIVERIES = {"Ada": (5, 2, 0), "Bea": (5, 1, 0), "Cyd": (5, 0, 1), "Dot": (3, 0, 0)}


class HeartMet(Behaviour):
    """Ada is always right. The others make the mistakes that each method names."""

    def __init__(self):
        self.asked = {}  # what the referee was last asked, by (code, team)
        self.goals = []

    def answer(self, event, asked):
        key = event.benchmark.code, event.team
        last, self.asked[key] = self.asked.get(key, ""), asked.text
        if asked.text.startswith("Where is the"):
            if event.team == "Bea" and "sitting" in last:
                return "dropped"  # in 4 of 8 trials
            if event.team == "Cyd":
                return "with the person"  # as Cyd always lets go
            return "with the person" if last.endswith(", takes the object") else "with the robot"
        return ""  # done; a box is right

    def result(self, event, number, goal):
        if goal is not None:
            self.goals.append(json.loads(goal))
            assert self.goals[-1]["trial"] == number
        do = {"SeeActivity": self.see, "FindObject": self.find, "HandOver": self.hand_over}.get(event.benchmark.code)
        return (5.0, None) if do is None else do(event.team, number, self.asked[event.benchmark.code, event.team])

    def see(self, team, number, asked):
        """Bea is wrong in three trials. Cyd is as good as Bea, but slower. Dot lets a trial time out, and once sends
        something that is not JSON.
        """
        right = json.dumps({"activity": asked.rpartition(": ")[2]})
        wrong = json.dumps({"activity": "sleeping"})
        if team == "Dot":
            return (None, None) if number == 1 else (2.0, "reading]" if number == 2 else right)
        return (4.0 if team == "Cyd" else 2.0), wrong if team in ("Bea", "Cyd") and number in (2, 5, 9) else right

    def find(self, team, number, asked):
        """Bea's answers are right, but it has no boxes. Cyd always sees the object, and is slow."""
        is_there = ", with the " in asked
        found = is_there or team == "Cyd"
        box = [1.5, 2, 30, 40] if found and team != "Bea" else []
        return (6.0 if team == "Cyd" else 3.0), json.dumps({"found": found, "box": box})

    def hand_over(self, team, number, asked):
        """Bea lets the object drop when the person sits. Cyd always lets go. Dot forgets to report."""
        takes = asked.endswith(", takes the object")
        if team == "Dot":
            return 4.0, "{}"
        return 4.0, json.dumps({"offered": True, "released": takes or team == "Cyd" or "sitting" in asked})

    def marks(self, event):
        if event.benchmark.code == "FindObject" and event.team == "Dot":
            yield Mark("Penalties", "Touches an object or the table", 3)
        if event.benchmark.code == "DeliverItem":
            done, bumps, hits = DELIVERIES[event.team]
            yield from (Mark("Achievements", desc, 1) for desc in ACHIEVEMENTS[:done])
            yield Mark("Penalized Behaviors", "Bumps into the furniture", bumps)
            yield Mark("Disqualifying Behaviors", "Hits a person", hits)


# Rank, team, and the numbers of the criteria.
EXPECTED = {
    # 10 trials. Ada: 10 right, 2 s each. Bea, Cyd: 7 of 10; 2 s and 4 s each. Dot: 8 of 10; once until the timeout
    # of 30 s, of which it executes about 29 s after a preparation of 1 s.
    "SeeActivity": [(1, "Ada", (1.0, 2.0)), (2, "Dot", (0.8, (29 + 9 * 2) / 10)), (3, "Bea", (0.7, 2.0)),
                    (4, "Cyd", (0.7, 4.0))],
    # 10 trials, the object is there in 5. Ada: 10 answers and 5 boxes. Bea: 10 answers. Cyd: 5 answers, 5 boxes.
    # Dot: 15 points, 3 penalties.
    "FindObject": [(1, "Ada", (15.0, 3.0)), (2, "Dot", (12.0, 3.0)), (3, "Bea", (10.0, 3.0)), (4, "Cyd", (10.0, 6.0))],
    # 2 objects, 2 postures, 2 reactions: 8 trials. Ada: 8. Bea: 4, and 4 dropped. Cyd: the 4 in which the person takes
    # the object. Dot: no report, no success.
    "HandOver": [(1, "Ada", (8.0, 0.0)), (2, "Cyd", (4.0, 0.0)), (3, "Bea", (4.0, 4.0)), (4, "Dot", (0.0, 0.0))],
    # Bea has fewer penalties than Ada. Cyd is disqualified.
    "DeliverItem": [(1, "Bea", (5.0, 1.0)), (2, "Ada", (5.0, 2.0)), (3, "Dot", (3.0, 0.0)), (4, "Cyd", (5.0, 0.0))],
}


@pytest.fixture(scope="module")
def competition(tmp_path_factory):
    return make_competition(tmp_path_factory.mktemp("heartmet") / "day", "heartmet", "--teams", ", ".join(TEAMS),
                            "--days", "2026-11-28")


@pytest.fixture(scope="module")
def played(competition):
    behaviour = HeartMet()
    return behaviour, Day(competition, behaviour).play()


def test_every_run_is_complete_and_signed_off(played):
    _, records = played
    assert sorted((record.benchmark, record.team) for record in records) == sorted(
        (code, team) for code in EXPECTED for team in TEAMS)
    assert {record.end_reason for record in records} == {"completed"}
    assert all(record.sign_off.who == "Anna" for record in records)


def test_goals_are_json(played):
    behaviour, _ = played
    keys = {frozenset(goal) for goal in behaviour.goals}
    assert keys == {frozenset({"trial", "activities"}), frozenset({"trial", "object"})}
    assert len(behaviour.goals) == 4 * (10 + 10 + 8)


def test_the_standings(competition, played):
    _, records = played
    found = standings(records, read_rules(f"{competition}/standings.yaml"), RunChoice(signed_off=True))
    overall, *found = found
    assert [(line.rank, line.team) for line in overall.lines] == [(1, "Ada"), (2, "Bea"), (3, "Dot"), (4, "Cyd")]
    # Shares of the best. Bea: 0.7 + 10/15 + 4/8 + 5/5. Dot: 0.8 + 12/15 + 0 + 3/5. Cyd: 0.7 + 10/15 + 4/8 + 0.
    assert [line.numbers[0] for line in overall.lines] == [4, Fraction(43, 15), Fraction(11, 5), Fraction(28, 15)]
    assert {standing.benchmark for standing in found} == set(EXPECTED)
    for standing in found:
        lines = [(line.rank, line.team, line.numbers) for line in standing.lines]
        expected = EXPECTED[standing.benchmark]
        assert [line[:2] for line in lines] == [line[:2] for line in expected], standing.benchmark
        for (_, team, numbers), (_, _, right) in zip(lines, expected):
            # Times differ by what the wire takes, with lost datagrams.
            assert numbers == pytest.approx(right, abs=0.3), (standing.benchmark, team)
    assert [line.disqualified for s in found if s.benchmark == "DeliverItem" for line in s.lines] == [
        False, False, False, True]


def test_the_module_keeps_each_trial(played):
    _, records = played
    (record,) = [r for r in records if (r.benchmark, r.team) == ("SeeActivity", "Dot")]
    trials = {group for group in (score.group for score in record.module_scores) if re.match(r"trial \d+$", group)}
    assert len(trials) == 10
    answers = {score.group: json.loads(score.value) for score in record.module_scores if score.name == "answer"}
    assert answers["trial 1"] is None and answers["trial 2"] is None
    assert None not in [answers[f"trial {number}"] for number in range(3, 11)]
