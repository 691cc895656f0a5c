"""Several judges: the rules by which their sheets become one, what nobody may see, and the head referee's decisions."""

from decimal import Decimal

import pytest
from hypothesis import given
from hypothesis import strategies as st

from helpers import journaled
from helpers.box_driver import BoxDriver
from helpers.competition import BUMPS, DOOR, competition
from helpers.examples import examples
from helpers.jury import Jury, judged
from roah_rsbb.core import effects
from roah_rsbb.core.actions.table import Target
from roah_rsbb.core.settings import Settings
from roah_rsbb.model.as_json import from_json, to_json
from roah_rsbb.model.reason import Refused, RunName
from roah_rsbb.model.records import RunRecord
from roah_rsbb.model.rules import ItemChoice, JuryResult
from roah_rsbb.model.scoring import Agreement, ScoreKind, ScoringItem
from roah_rsbb.scoring.agreement import ItemValue, agreed
from roah_rsbb.scoring.sheet import Mark

WATER = ScoringItem("Table", "water", ScoreKind.DECIMAL, Decimal(1), Decimal(0), Decimal(10))
HELP = ScoringItem("Table", "help", ScoreKind.CHOICE, choices=(ItemChoice("none"), ItemChoice("some")))
SHOW = ScoringItem("Table", "show", ScoreKind.RATING, Decimal(1), Decimal(0), Decimal(10), judges=("1", "2", "3"))
ITEMS = (DOOR, BUMPS, WATER, HELP, SHOW)
NOT_ATTEMPTED = ItemValue(not_attempted=True)
MAJORITY, MEAN, MEDIAN = Agreement.MAJORITY, Agreement.MEAN, Agreement.MEDIAN


# -- the rules --------------------------------------------------------------------------------------


def _values(item, *given_values):
    return [v if isinstance(v, ItemValue) else ItemValue(v) if item.kind in (ScoreKind.BOOL, ScoreKind.UINT)
            else ItemValue(int(float(v)) if item is not HELP else 1, v) for v in given_values]


@pytest.mark.parametrize("rule, item, values, result", [
    (Agreement.ALL_AGREE, BUMPS, (3, 3, 3), ItemValue(3)),
    (Agreement.ALL_AGREE, BUMPS, (3, 3, 4), None),
    (Agreement.ALL_AGREE, DOOR, (NOT_ATTEMPTED, NOT_ATTEMPTED), NOT_ATTEMPTED),
    (MAJORITY, BUMPS, (3, 4, 3), ItemValue(3)),
    (MAJORITY, BUMPS, (3, 4), None),
    (MAJORITY, BUMPS, (3, 3, 4, 4), None),
    (MAJORITY, DOOR, (1, NOT_ATTEMPTED, NOT_ATTEMPTED), NOT_ATTEMPTED),
    (MEAN, BUMPS, (3, 4), ItemValue(4)),
    (MEAN, BUMPS, (1, 2, 2), ItemValue(2)),
    (MEAN, WATER, ("1", "2.5"), ItemValue(1, "1.75")),
    (MEAN, BUMPS, (3, NOT_ATTEMPTED), None),
    (MEAN, DOOR, (1, 0, 1), ItemValue(1)),
    (MEAN, DOOR, (1, 0), None),
    (MEDIAN, BUMPS, (1, 9, 2), ItemValue(2)),
    (MEDIAN, WATER, ("1", "2", "9", "3"), ItemValue(2, "2.5")),
    (Agreement.WITHOUT_EXTREMES, BUMPS, (0, 4, 4, 50), ItemValue(4)),
    (Agreement.WITHOUT_EXTREMES, HELP, ("none", "some"), None),
    (Agreement.ALL_AGREE, SHOW, ("6", "7"), ItemValue(6, "6.5")),
    (Agreement.ALL_AGREE, SHOW, ("6", NOT_ATTEMPTED), None),
    (MEAN, BUMPS, (), None),
])
def test_values_become_one_by_the_rule(rule, item, values, result):
    found = agreed(rule, item, _values(item, *values))
    assert found == result
    assert agreed(rule, item, _values(item, *reversed(values))) == result


def test_a_rating_keeps_the_rule_of_its_jury():
    item = SHOW.with_jury(JuryResult.MEDIAN)
    assert agreed(Agreement.ALL_AGREE, item, _values(item, "1", "2", "9")) == ItemValue(2, "2")


# -- runs -------------------------------------------------------------------------------------------


@pytest.fixture
def jury():
    return Jury(BoxDriver(judged(), Settings(auto_next=False)))


def test_sheets_count_when_all_judges_have_submitted(jury):
    jury.mark("Ann", DOOR, 1)
    jury.mark("Ben", DOOR, 1)
    jury.submit("Ann")
    assert jury.values() == {DOOR.desc: 0, BUMPS.desc: 0}
    assert (jury.judging().missing, jury.judging().verdicts) == (1, ())
    jury.submit("Ben")
    assert jury.values() == {DOOR.desc: 1, BUMPS.desc: 0}
    (entry,) = jury.record().history
    assert (entry.who, entry.role, entry.value, entry.correction) == ("Ann, Ben", "judge", 1, False)


def test_nobody_else_sees_what_a_judge_marks(jury):
    jury.driver.taken()
    jury.mark("Ann", BUMPS, 7)
    notices = [effect for effect in jury.driver.taken() if isinstance(effect, effects.Notice)]
    assert notices == []
    ann, ben = jury.judging("Ann"), jury.judging("Ben")
    assert [item.value for item in ann.own_items] == [0, 7]
    assert [item.value for item in ben.own_items] == [0, 0]
    assert jury.values()[BUMPS.desc] == 0
    view = jury.driver.view()
    assert "7" not in view.log


def test_a_mark_of_a_judge_is_applied_once(jury):
    for _ in range(2):
        jury.driver.run(2.0)
        jury.driver.event(jury.desk.mark, jury.name, Mark(*BUMPS.key, added="1", id="same"), "Ann")
    assert [item.value for item in jury.judging("ann").own_items] == [0, 1]


@pytest.mark.parametrize("ended", ["withdrawn", "signed off"])
def test_what_a_judge_sends_again_is_no_error_and_opens_nothing(jury, ended):
    """Its answer may have been lost."""
    jury.mark("Ann", BUMPS, 2)
    again = {"group": BUMPS.group, "desc": BUMPS.desc, "value": 2, "id": "m1", "judge": "Ann"}
    if ended == "withdrawn":
        jury.driver.enter("withdraw_sheet", jury.name, "Hugo", judge="Ann", reason="left")
    else:
        jury.mark("Ben", BUMPS, 2)
        jury.submit("Ann")
        jury.submit("Ben")
        jury.finish()
        jury.sign_off()
    before = to_json(jury.record())
    jury.driver.enter("judge_mark", jury.name, **again)
    assert jury.driver.box.entries.outcome(Target(*jury.name), "judge_mark", again) == {
        "number": 1, "value": 2, "not_attempted": False, "text": ""}
    if ended == "signed off":
        jury.submit("Ann")
    assert to_json(jury.record()) == before


def test_a_withdrawn_sheet_is_not_submitted_again_empty(jury):
    """Its judge's device may send what was not answered."""
    jury.mark("Ann", BUMPS, 2)
    jury.submit("Ann")
    jury.driver.enter("withdraw_sheet", jury.name, "Hugo", judge="Ann", reason="left")
    with pytest.raises(Refused, match="was withdrawn: mark an item to begin another one"):
        jury.submit("Ann")
    jury.mark("Ann", BUMPS, 3)
    jury.submit("Ann")


def test_a_judge_takes_a_rating_back(jury):
    show = ScoringItem("Table", "show", ScoreKind.RATING, judges=("1", "2"), least=Decimal(0), most=Decimal(10))
    jury = Jury(BoxDriver(judged(items=(show,))))
    rating = {"group": "Table", "desc": "show", "judge": "Ann"}
    jury.driver.enter("judge_mark", jury.name, text="8", id="a", **rating)
    jury.driver.enter("judge_mark", jury.name, text="", id="b", **rating)
    assert jury.judging("Ann").own_items[0].text == ""
    with pytest.raises(Refused, match="give the number as a text"):
        jury.driver.enter("judge_mark", jury.name, value=5, id="c", **rating)


def test_a_judge_s_mark_is_recorded_with_its_value_and_under_the_judge_s_name(jury):
    jury.driver.taken()
    jury.mark("Ann", BUMPS, 0)
    recorded, = jury.driver.taken(effects.Recorded)
    assert (recorded.kind, recorded.who, recorded.value) == ("judge_mark", "Ann", {
        "command": "mark", "group": "Penalized", "item": "bumps", "value": 0, "mark": "m1"})


def test_a_submitted_sheet_is_locked_until_it_is_handed_back(jury):
    jury.mark("Ann", BUMPS, 1)
    jury.submit("Ann")
    jury.submit("Ann")  # the answer was lost
    mark = Mark(*BUMPS.key, 2, id="late")
    assert "hand it back" in jury.refused(jury.desk.mark, jury.name, mark, "Ann")[0]
    assert "a reason" in jury.refused(jury.desk.hand_back, jury.name, "Ann", "", "Hugo")[0]
    assert "the name" in jury.refused(jury.desk.hand_back, jury.name, "Ann", "look again", "")[0]
    jury.driver.event(jury.desk.hand_back, jury.name, "Ann", "look at minute 2", "Hugo")
    assert jury.judging("Ann").own.again == "look at minute 2"
    jury.mark("Ann", BUMPS, 2)
    jury.submit("Ann")
    assert (jury.judging("Ann").own.again, jury.judging("Ann").own_items[1].value) == ("", 2)
    assert [act.act for act in jury.record().judging.acts] == ["submitted", "handed back", "submitted"]


def _differ(jury):
    jury.mark("Ann", BUMPS, 1)
    jury.mark("Ben", BUMPS, 3)
    jury.submit("Ann")
    jury.submit("Ben")


def test_the_head_referee_settles_a_difference_with_a_reason(jury):
    _differ(jury)
    (verdict,) = jury.judging().verdicts[1:]
    assert (verdict.value, verdict.proposals) == (None, (("Ann", "1"), ("Ben", "3")))
    assert "a reason" in jury.refused(jury.desk.settle, jury.name, Mark(*BUMPS.key, 2), "", "Hugo")[0]
    jury.settle(BUMPS, 2)
    assert jury.values() == {DOOR.desc: 0, BUMPS.desc: 2}
    (entry,) = jury.record().history
    assert (entry.who, entry.role, entry.note) == ("Hugo", "referee", "the video shows it")
    assert jury.judging().verdicts[1].is_settled


def test_a_settlement_ends_when_a_judge_changes_the_value(jury):
    _differ(jury)
    jury.settle(BUMPS, 2)
    jury.driver.event(jury.desk.hand_back, jury.name, "Ben", "count again", "Hugo")
    assert jury.judging().verdicts == ()
    jury.submit("Ben")
    assert jury.values()[BUMPS.desc] == 2
    jury.driver.event(jury.desk.hand_back, jury.name, "Ben", "count again", "Hugo")
    jury.mark("Ben", BUMPS, 1)
    jury.submit("Ben")
    assert jury.values()[BUMPS.desc] == 1


def test_a_sheet_can_be_settled_only_when_the_judges_are_complete(jury):
    jury.submit("Ann")
    reasons = jury.refused(jury.desk.settle, jury.name, Mark(*BUMPS.key, 2), "why", "Hugo")
    assert reasons[0].startswith("1 of 2 judges have not submitted")
    jury.driver.event(jury.desk.waive, jury.name, "Ben is ill", "Hugo")
    jury.settle(BUMPS, 2)
    assert jury.values()[BUMPS.desc] == 2
    jury.driver.event(jury.desk.hand_back, jury.name, "Ann", "look again", "Hugo")
    assert jury.judging().verdicts == (), "this judge is waited for"


def test_a_third_judge_needs_a_place(jury):
    jury.mark("Ann", BUMPS, 1)
    jury.submit("Ben")
    mark = Mark(*BUMPS.key, 1, id="c")
    assert jury.refused(jury.desk.mark, jury.name, mark, "Cleo") == [
        "this run already has its 2 judges (Ann, Ben): the head referee can withdraw a sheet"]
    jury.driver.event(jury.desk.withdraw, jury.name, "Ann", "had to leave", "Hugo")
    jury.driver.event(jury.desk.mark, jury.name, mark, "Cleo")
    jury.submit("Cleo")
    assert jury.judging().verdicts[1].proposals == (("Ben", "0"), ("Cleo", "1"))
    assert [sheet.judge for sheet in jury.record().judging.sheets] == ["Ann", "Ben", "Cleo"]


@pytest.mark.parametrize("arguments, reason", [
    ((Mark("G", "nothing", id="a"), "Ann"), "no scoring group 'G': there is 'Achievements', 'Penalized'"),
    ((Mark(*BUMPS.key, -1, id="a"), "Ann"), "'bumps' is a count: its value must be 0 or more, not -1"),
    ((Mark(*BUMPS.key, 1, id="a"), ""), "a judge needs a name: enter it, in the terminal with --by"),
    ((Mark(*BUMPS.key, 1, id="a"), "/node"), "a judge needs a name: enter it, in the terminal with --by"),
    ((Mark(*BUMPS.key, 1), "Ann"), "the id '' cannot identify a mark: give each mark a new UUID"),
])
def test_a_refused_mark_opens_no_sheet(jury, arguments, reason):
    assert jury.refused(jury.desk.mark, jury.name, *arguments) == [reason]
    assert jury.record().judging.sheets == ()


def test_the_referee_cannot_score_over_the_judges(jury):
    assert "judges score this benchmark" in jury.refused(
        jury.driver.box.scores.mark, jury.name, Mark(*BUMPS.key, 1), "Hugo")[0]


def test_a_benchmark_without_judges_has_no_sheets_of_judges():
    jury = Jury(BoxDriver(competition(tbm=["HGTKMH"]), Settings(auto_next=False)))
    assert "no judges" in jury.refused(jury.desk.mark, jury.name, Mark(*BUMPS.key, 1, id="a"), "Ann")[0]
    assert jury.judging("Ann").count == 0


def test_the_run_is_not_signed_off_before_the_judges_are_done(jury):
    jury.mark("Ann", BUMPS, 1)
    jury.mark("Ben", BUMPS, 3)
    jury.submit("Ann")
    jury.finish()
    assert jury.refused(jury.driver.box.scores.sign_off, jury.name, "Hugo") == [
        "1 of 2 judges have not submitted (Ben): wait for them, or decide with a reason not to wait"]
    jury.submit("Ben")
    assert jury.refused(jury.driver.box.scores.sign_off, jury.name, "Hugo") == [
        "the judges differ: the head referee settles Penalized: bumps"]
    jury.settle(BUMPS, 2)
    jury.sign_off()
    jury.submit("Ann")  # again: the answer may have been lost
    assert (jury.values()[BUMPS.desc], jury.record().items[1].corrected) == (2, False)


def test_each_judge_rates_and_the_jury_decides():
    jury = Jury(BoxDriver(judged(3, items=(SHOW,)), Settings(auto_next=False)))
    assert "no rating of show" in jury.refused(jury.desk.submit, jury.name, "Ann")[0]
    for judge, text in (("Cleo", "9"), ("Ann", "6"), ("Ben", "6")):
        jury.mark(judge, SHOW, text=text)
        jury.submit(judge)
    (item,) = jury.record().items
    assert (item.text, [rating.text for rating in item.ratings]) == ("7", ["6", "6", "9"])


# -- objections -------------------------------------------------------------------------------------


@pytest.fixture
def objected():
    jury = Jury(BoxDriver(judged(objection_time=600.0), Settings(auto_next=False)))
    jury.submit("Ann")
    jury.submit("Ben")
    jury.finish()
    return jury


def test_a_result_is_provisional_until_objections_are_answered_and_the_time_is_over(objected):
    desk, sign = objected.desk, objected.driver.box.scores.sign_off
    assert "publish the result" in objected.refused(sign, objected.name, "Hugo")[0]
    objected.driver.event(desk.publish, objected.name, -1.0, "Olga")
    assert "objections are possible until" in objected.refused(sign, objected.name, "Hugo")[0]
    objected.driver.event(desk.object, objected.name, "Alpha", "no bump at minute 2", "Olga")
    objected.driver.jump(601.0)
    assert "objections were possible until" in objected.refused(desk.object, objected.name, "Beta", "late", "Olga")[0]
    assert objected.refused(sign, objected.name, "Hugo") == ["answer objection 1 first"]
    objected.driver.event(desk.answer, objected.name, 1, True, "seen on the video", "Hugo")
    objected.settle(BUMPS, 0, "objection 1")
    objected.sign_off()
    (objection,) = objected.record().publication.objections
    assert (objection.by, objection.upheld, objection.answer) == ("Alpha", True, "seen on the video")


def test_the_organiser_may_set_another_time_limit(objected):
    objected.driver.event(objected.desk.publish, objected.name, 0.0, "Olga")
    objected.driver.run(1.0)
    objected.sign_off()


def test_only_a_run_that_is_over_is_published(jury):
    assert "still connected" in jury.refused(jury.desk.publish, jury.name, 0.0, "Olga")[0]


@pytest.mark.parametrize("method, arguments, reason", [
    ("object", ("Alpha", "why", "Olga"), "not published yet"),
    ("answer", (1, True, "because", "Hugo"), "no objection 1"),
    ("publish", (1e9, "Olga"), "at most 86400"),
])
def test_what_publication_refuses(objected, method, arguments, reason):
    assert reason in objected.refused(getattr(objected.desk, method), objected.name, *arguments)[0]


# -- orders and restarts ----------------------------------------------------------------------------

_RULES = st.sampled_from(list(Agreement))
_SHEETS = st.fixed_dictionaries({judge: st.fixed_dictionaries({
    BUMPS: st.integers(0, 2), DOOR: st.integers(0, 1), SHOW: st.integers(0, 3)}) for judge in ("Ann", "Ben", "Cleo")})


@examples(25)
@given(_RULES, _SHEETS, st.permutations(["Ann", "Ben", "Cleo"]))
def test_the_order_of_the_submissions_does_not_matter(rule, marked, order):
    def result(judges):
        jury = Jury(BoxDriver(judged(3, rule, (BUMPS, DOOR, SHOW)), Settings(auto_next=False)))
        for judge in judges:
            for item, value in marked[judge].items():
                jury.mark(judge, item, value, **({"text": str(value)} if item is SHOW else {}))
            jury.submit(judge)
        return jury.record().items, jury.judging().verdicts

    assert result(order) == result(sorted(order))


def _story(jury):
    """Everything that judges and the head referee do, one step after the other."""
    name, event_ = jury.name, jury.driver.event
    yield lambda: jury.mark("Ann", BUMPS, 1)
    yield lambda: jury.mark("Ben", BUMPS, 3)
    yield lambda: jury.submit("Ann")
    yield lambda: event_(jury.driver.box.judges.hand_back, name, "Ann", "again", "Hugo")
    yield lambda: jury.mark("Ann", BUMPS, 2)
    yield lambda: jury.submit("Ann")
    yield lambda: jury.submit("Ben")
    yield lambda: jury.settle(BUMPS, 2)
    yield lambda: event_(jury.driver.box.judges.withdraw, name, "Ben", "left", "Hugo")
    yield lambda: event_(jury.driver.box.judges.waive, name, "no other judge", "Hugo")
    yield jury.finish
    yield lambda: event_(jury.driver.box.judges.publish, name, 5.0, "Olga")
    yield lambda: event_(jury.driver.box.judges.object, name, "Alpha", "why", "Olga")
    yield lambda: event_(jury.driver.box.judges.answer, name, 1, False, "so", "Hugo")
    yield lambda: jury.driver.jump(10.0)
    yield jury.sign_off


def test_a_core_that_is_killed_after_every_event_keeps_everything(tmp_path):
    plain = Jury(journaled.box(tmp_path / "plain", judged(), Settings(auto_next=False, listen_duration=0.0)))
    for step in _story(plain):
        step()
    killed = Jury(journaled.box(tmp_path / "killed", judged(), Settings(auto_next=False, listen_duration=0.0)))
    for step in _story(killed):
        step()
        before = killed.record()
        killed.driver.kill(0.0)
        after = killed.record()
        assert after.judging == before.judging
        assert after.publication == before.publication
        assert [item[:8] for item in after.items] == [item[:8] for item in before.items]

    def without_times(record):
        judging = record.judging
        return (
            [(s.judge, s.again, [i[:5] for i in s.items], bool(s.withdrawn_utc)) for s in judging.sheets],
            [s[1:] for s in judging.settlements], [a[1:] for a in judging.acts], judging.waiver[1:],
            [o[2:5] + o[6:] for o in record.publication.objections], record.items, record.sign_off.who,
        )

    assert without_times(killed.record()) == without_times(plain.record())
    assert from_json(RunRecord, to_json(killed.record())) == killed.record()


@pytest.mark.parametrize("end", ["withdrawn", "no_show"])
def test_of_an_event_that_had_no_run_nobody_asks_the_judges(end):
    driver = BoxDriver(judged())
    driver.command(end)
    (run,) = driver.box.scores.waiting()
    assert driver.box.judges.waiting(driver.now) == []
    driver.enter("sign_off", RunName("tbm", run.record.identity), "Hugo")
    assert run.record.sign_off is not None
