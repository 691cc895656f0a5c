"""A wrong run is put right: annulled, moved, reopened, and each of these taken back."""

from dataclasses import replace
from decimal import Decimal

import pytest

from helpers.box_driver import BoxDriver
from helpers.competition import BUMPS, DOOR, competition, event
from roah_rsbb.core.actions.table import Target
from roah_rsbb.core.settings import Settings
from roah_rsbb.model.as_json import from_json, to_json
from roah_rsbb.model.reason import Refused, RunName
from roah_rsbb.model.records import RunRecord
from roah_rsbb.model.scoring import ScoreKind, ScoringItem
from roah_rsbb.rulebook.benchmarks import CountingAttempt, EventRules
from roah_rsbb.scoring.counting import RunChoice
from roah_rsbb.scoring.standings import standing
from roah_rsbb.scoring.timeline import run_timeline
from roah_rsbb.wording import timeline
from roah_rsbb.wording.times import Moments

SHEET = (ScoringItem(DOOR.group, DOOR.desc, ScoreKind.BOOL, Decimal(80)),
         ScoringItem(BUMPS.group, BUMPS.desc, BUMPS.kind, Decimal(-20)))
BEST_OF_TWO = EventRules(attempts=2, counting=CountingAttempt.BEST)


class World(BoxDriver):
    """Two events of Alpha and one of Beta in one zone, and one of Beta in another."""

    def __init__(self, **of_benchmark):
        def of(team, round_number, code="HWV", scoring=SHEET):
            found = event(code, team=team, round=round_number, scoring=scoring, rules=BEST_OF_TWO, **of_benchmark)
            return replace(found, id=f"{code}{team}{round_number}")

        super().__init__(competition(tbm=[of("Alpha", 1), of("Beta", 1), of("Alpha", 2)],
                                     fbm=[of("Beta", 2), of("Beta", 1, "HCFGAC")]), Settings(auto_next=False))

    def ran(self, *items, zone="tbm"):
        """Score a run at the zone's event by hand, and leave it; returns its name."""
        for command in ("open_sheet", "start"):
            self.event(self.box.act, Target(zone), command)
        name = RunName(zone, self.run_in(zone).identity)
        for item in items:
            self.act(name, "mark", group=item.group, desc=item.desc, added="" if item is DOOR else "1",
                     value=int(item is DOOR))
        self.act(name, "disconnect", running=True)
        self.run(60.0)
        return name

    def act(self, name, action, who="Olga", /, **given):
        self.event(self.box.act, Target(*name), action, who, given)

    def right(self, name, action, **given):
        self.act(name, action, reason="a reason", **given)

    def record(self, name):
        return self.box.scores.record_of(self.now, name)

    def counted(self, *names):
        return [self.box.scores.why(self.now, name.identity).value for name in names]

    def totals(self):
        """The standing of the records, as the journal has them, too."""
        return {line.team: str(line.numbers[0]) for line in self.standing().lines}

    def remarks(self):
        return [str(remark) for remark in self.standing().remarks if "objection" in remark]

    def standing(self):
        records = self.box.finished.records()
        assert [from_json(RunRecord, to_json(record)) for record in records] == records
        return standing("HWV", records, None, RunChoice(events={"HWV": BEST_OF_TWO}))

    def shown(self, name):
        items = timeline.timeline(run_timeline(self.record(name)), Moments(True).time_of_day)
        return [(item.text, item.state, item.said) for item in items[::-1] if item.kind in ("change", "version")]


@pytest.fixture
def world():
    return World()


def test_an_annulled_run_is_kept_and_counts_nothing_and_gives_its_attempt_back(world):
    first, second = world.ran(DOOR), world.ran(DOOR, BUMPS)
    with pytest.raises(Refused, match="The last of 2 attempts"):
        world.ran()
    world.act(first, "sign_off")
    assert (world.totals(), world.counted(first, second)) == ({"Alpha": "80"}, ["counts", "not_best"])
    world.right(first, "annul")
    assert (world.totals(), world.counted(first, second)) == ({"Alpha": "60"}, ["annulled", "counts"])
    world.right(second, "annul")
    assert world.totals() == {}
    assert world.box.scores.event_results(world.now) == [] == world.box.scores.waiting()
    assert not world.box.scores.events_over() and not world.box.candidates.is_unsigned(world.box.zones["tbm"])
    third = world.ran(BUMPS)
    assert (world.totals(), world.counted(first, second, third)) == (
        {"Alpha": "-20"}, ["annulled", "annulled", "counts"])
    world.right(first, "undo")
    assert (world.totals(), world.counted(first, third)) == ({"Alpha": "80"}, ["counts", "not_best"])


def test_a_run_is_moved_to_the_right_team_and_to_another_zone_and_back(world):
    name = world.ran(DOOR)
    world.right(name, "move", event="HWVBeta1")
    assert world.totals() == {"Beta": "80"}
    assert [(zone, place) for zone, place in world.box.scores.results(world.now)] == [("tbm", 1)]
    assert world.box.candidates.attempt(world.box.zones["tbm"]) == 1
    world.right(name, "move", event="HWVBeta2")
    record = world.record(name)
    assert (record.zone, record.team, record.round, record.event) == ("tbm", "Beta", 2, "HWVBeta2")
    assert list(world.box.scores.results(world.now)) == [("fbm", 0)]
    for totals, slot in (({"Beta": "80"}, "HWVBeta1"), ({"Alpha": "80"}, "HWVAlpha1")):
        world.right(name, "undo")
        assert (world.totals(), world.record(name).event) == (totals, slot)
    with pytest.raises(Refused, match="nothing was annulled, moved or reopened"):
        world.right(name, "undo")
    assert [(text, state) for text, state, _ in world.shown(name)] == [
        ("Moved: team Alpha, round 1, run 1, now team Beta, round 1, run 1", "withdrawn"),
        ("Moved: team Beta, round 1, run 1, now team Beta, round 2, run 1", "withdrawn")]


def test_a_run_is_not_moved_where_it_cannot_belong(world):
    name = world.ran()
    for given, why in (("nothing", "has no event 'nothing'"), ("HWVAlpha1", "to this event already")):
        with pytest.raises(Refused, match=why):
            world.right(name, "move", event=given)
    with pytest.raises(Refused, match="scored by the sheet of HWV.*annul it"):
        world.right(name, "move", event="HCFGACBeta1")
    for command in ("next", "next"):
        world.event(world.box.act, Target("tbm"), command)
    world.ran()
    world.ran()
    with pytest.raises(Refused, match="has had its 2 attempts"):
        world.right(name, "move", event="HWVAlpha2")


def test_a_correction_after_the_sign_off_is_a_new_signed_version_and_both_are_kept(world):
    name = world.ran(DOOR)
    world.act(name, "sign_off", "Anna")
    with pytest.raises(Refused, match="it is final"):
        world.act(name, "mark", group=BUMPS.group, desc=BUMPS.desc, added="1")
    world.right(name, "reopen")
    assert (world.record(name).sign_off, world.counted(name)) == (None, ["counts"])
    world.right(name, "undo")
    record = world.record(name)
    assert (record.sign_off.who, record.versions) == ("Anna", ())
    world.right(name, "reopen")
    world.act(name, "mark", group=BUMPS.group, desc=BUMPS.desc, added="1")
    with pytest.raises(Refused, match="was changed since it was reopened"):
        world.right(name, "undo")
    world.run(60.0)
    world.act(name, "sign_off", "Ben")
    record = world.record(name)
    assert (record.sign_off.who, record.points.total) == ("Ben", "60")
    assert [(each.sign_off.who, each.points.total) for each in record.versions] == [("Anna", "80")]
    said = world.shown(name)[-1]
    assert said[0].startswith("Version 1 of the sheet: 80, signed off by Anna at ")
    assert said[2] == f"Total: 80, now 60; {BUMPS.desc}: 0, now 1"
    with pytest.raises(Refused, match="nothing was annulled"):
        world.right(name, "undo")


def test_what_is_done_to_a_signed_run_is_signed_by_who_does_it(world):
    name = world.ran(DOOR)
    world.act(name, "sign_off", "Anna")
    for action, given in (("move", {"event": "HWVBeta1"}), ("annul", {}), ("undo", {})):
        world.right(name, action, **given)
    record = world.record(name)
    assert [each.sign_off.who for each in (*record.versions, record)] == ["Anna", "Olga", "Olga", "Olga"]
    assert world.totals() == {"Beta": "80"}


@pytest.mark.parametrize("action", ["annul", "reopen", "undo", "move"])
def test_each_needs_a_name_and_a_reason_and_a_run_that_is_over(world, action):
    name, given = world.ran(DOOR), {"event": "HWVBeta1"} if action == "move" else {}
    world.act(name, "sign_off", "Anna")
    if action == "undo":
        world.right(name, "annul")
    for who, reason, why in (("", "r", "needs the name"), ("Olga", " ", "enter why")):
        before = world.record(name)
        with pytest.raises(Refused, match=why):
            world.act(name, action, who, reason=reason, **given)
        assert world.record(name) == before
    world.event(world.box.act, Target("fbm"), "open_sheet")
    with pytest.raises(Refused, match="still connected"):
        world.right(RunName("fbm", world.run_in("fbm").identity), action, **given)


# -- protests ---------------------------------------------------------------------------------------


def test_a_protest_after_the_sign_off_waits_until_it_is_decided_and_the_result_follows(world):
    name = world.ran(DOOR)
    world.act(name, "sign_off", "Anna")
    for number in (1, 2):
        world.act(name, "object", by="Beta", text=f"protest {number}", second=161)
    (waiting,) = world.box.judges.waiting(world.now)
    assert (waiting.record.identity, waiting.record.open_objections) == (name.identity, 2)
    assert world.remarks() == ["team Alpha, round 1, run 1: an objection is not answered yet"]
    world.act(name, "answer", number=1, upheld=False, text="it was in")
    assert world.record(name).sign_off.who == "Anna"
    with pytest.raises(Refused, match="needs the name"):
        world.act(name, "answer", "", number=2, upheld=True, text="seen in the replay")
    assert world.record(name).open_objections == 1
    world.act(name, "answer", number=2, upheld=True, text="seen in the replay")
    record = world.record(name)
    assert (record.sign_off, record.changes[-1].reason) == (None, "Objection 2 of Beta upheld: seen in the replay")
    world.act(name, "mark", group=BUMPS.group, desc=BUMPS.desc, added="1")
    world.act(name, "sign_off")
    record = world.record(name)
    assert (world.totals(), world.remarks(), world.box.judges.waiting(world.now)) == ({"Alpha": "60"}, [], [])
    assert [each.points.total for each in (*record.versions, record)] == ["80", "60"]
    assert [(one.upheld, one.second) for one in record.publication.objections] == [(False, 161), (True, 161)]


def test_a_run_with_a_protest_is_not_signed_before_the_answer(world):
    name = world.ran(DOOR)
    world.act(name, "object", by="Beta", text="a protest")
    with pytest.raises(Refused, match="answer objection 1 first"):
        world.act(name, "sign_off")


@pytest.mark.parametrize("later_s, is_late", [(1799.0, False), (1801.0, True)])
def test_the_rules_limit_the_time_for_protests(later_s, is_late):
    world = World(protest_time=1800.0)
    name = world.ran(DOOR)
    world.run(4000.0)  # the time begins with the sign-off
    world.act(name, "object", by="Beta", text="early")
    world.act(name, "answer", number=1, text="no")
    world.act(name, "sign_off")
    world.run(later_s)
    if is_late:
        with pytest.raises(Refused, match="objections were possible until"):
            world.act(name, "object", by="Beta", text="late")
    else:
        world.act(name, "object", by="Beta", text="in time")
    assert world.record(name).open_objections == (not is_late)
