"""Marks that add, so that referees who count at once lose nothing, and marks with an identity, which apply once."""

from decimal import Decimal

import pytest
from hypothesis import given
from hypothesis import strategies as st

from helpers.box_driver import BoxDriver
from helpers.competition import BUMPS, DOOR, UTC0, competition, event
from helpers.examples import examples
from helpers.journaled import box as journaled_box
from roah_rsbb.core import effects
from roah_rsbb.core.settings import Settings
from roah_rsbb.model import run_log
from roah_rsbb.model.clock import Now
from roah_rsbb.model.reason import MAX_WHO, Refused, RunName
from roah_rsbb.model.saved import freeze, thaw
from roah_rsbb.model.scoring import ItemChoice, ScoreKind, ScoringItem
from roah_rsbb.rulebook.benchmarks import Benchmark
from roah_rsbb.scoring import sheet as sheets
from roah_rsbb.scoring.book import FinishedRun
from roah_rsbb.scoring.sheet import MAX_ENTRIES, MAX_MARKS, MAX_NOTED, Mark, ScoreSheet, SheetState

CUPS = ScoringItem("Table", "cups", ScoreKind.UINT, most=Decimal(3))
HEIGHT = ScoringItem("Table", "height", ScoreKind.INT, least=Decimal(-2), most=Decimal(2))
WATER = ScoringItem("Table", "water", ScoreKind.DECIMAL, least=Decimal(0), most=Decimal(10))
HELP = ScoringItem("Table", "help", ScoreKind.CHOICE, choices=(ItemChoice("none"), ItemChoice("some")))
SHOW = ScoringItem("Table", "show", ScoreKind.RATING, judges=("Anna", "Ben"))
ITEMS = (BUMPS, DOOR, CUPS, HEIGHT, WATER, HELP, SHOW)


class Referees:
    """They mark a sheet, `pause` seconds after one another."""

    def __init__(self, pause=60.0):
        self.sheet = ScoreSheet(ITEMS)
        self.now = Now(1000.0, UTC0)
        self.pause = pause

    def set(self, item, value=0, who="Anna", correction=False, **of_mark):
        self.now = self.now.later(self.pause)
        self.sheet.set(self.now, who, Mark(*item.key, value, **of_mark), correction)

    def add(self, item, added=1, who="Anna", **of_mark):
        self.set(item, 0, who, added=str(added), **of_mark)

    def withdraw(self, number, correction=False):
        self.sheet.withdraw(self.now, "Cleo", number, "", correction)

    def item(self, item):
        return self.sheet.item(*item.key)

    def value(self, item):
        record = self.item(item)
        return "-" if record.not_attempted else record.text or record.value

    def entries(self, *fields):
        return [tuple(getattr(entry, field) for field in fields) for entry in self.sheet.history]


@pytest.fixture
def referees():
    return Referees()


# -- adding -----------------------------------------------------------------------------------------


def test_two_referees_who_count_at_once_lose_nothing():
    referees = Referees(pause=0.05)
    for _ in range(10):
        referees.add(BUMPS, who="Anna")
        referees.add(BUMPS, who="Ben")
    assert referees.value(BUMPS) == 20
    for who in ("Anna", "Ben"):
        assert sum(int(added) for by, added in referees.entries("who", "added") if by == who) == 10


def test_each_entry_has_what_was_added_and_both_values(referees):
    referees.add(BUMPS, role="referee", device="phone 3")
    referees.add(BUMPS, "+2", who="Ben")
    referees.set(BUMPS, 7)
    assert referees.entries("who", "role", "device", "added", "old", "value") == [
        ("Anna", "referee", "phone 3", "1", 0, 1), ("Ben", "", "", "2", 1, 3), ("Anna", "", "", "", 3, 7)]


def test_without_an_entry_the_others_still_count(referees):
    for who in ("Anna", "Ben", "Anna"):
        referees.add(BUMPS, who=who)
    referees.withdraw(1)
    assert referees.value(BUMPS) == 2
    referees.withdraw(3)
    referees.withdraw(2)
    assert referees.value(BUMPS) == 0


def test_a_value_that_is_set_replaces_what_was_counted_before_and_counts_on(referees):
    referees.add(BUMPS, 4)
    referees.set(BUMPS, 1)
    referees.add(BUMPS, 2)
    assert referees.value(BUMPS) == 3
    referees.withdraw(1)
    assert referees.value(BUMPS) == 3
    referees.withdraw(2)
    assert referees.value(BUMPS) == 2


def test_counting_removes_not_attempted_and_its_withdrawal_brings_it_back(referees):
    referees.add(BUMPS, 3)
    referees.set(BUMPS, not_attempted=True)
    referees.add(BUMPS)
    assert referees.value(BUMPS) == 1
    referees.withdraw(3)
    assert referees.value(BUMPS) == "-"
    referees.withdraw(2)
    assert referees.value(BUMPS) == 3


def test_decimals_are_added_exactly(referees):
    for added in ("0,1", ".2", "+1.005"):
        referees.add(WATER, added)
    assert (referees.value(WATER), referees.item(WATER).value) == ("1.305", 1)
    referees.withdraw(1)
    assert referees.value(WATER) == "1.205"


def test_changes_of_one_moment_are_one_entry_and_a_slip_is_none():
    referees = Referees(pause=0.1)
    for number in range(3):
        referees.add(BUMPS, id=f"up {number}")
    assert (referees.entries("number", "old", "added", "value"), referees.value(BUMPS)) == ([(1, 0, "3", 3)], 3)
    for number in range(3):
        referees.add(BUMPS, -1, id=f"down {number}")
    assert (referees.sheet.history, referees.value(BUMPS)) == ((), 0)
    referees.add(CUPS, id="other")
    assert referees.sheet.marks == "0 up 0\n0 up 1\n0 up 2\n0 down 0\n0 down 1\n1 \n0 down 2\n2 other\n"


@pytest.mark.parametrize("first, second", [
    ({}, {"who": "Ben"}), ({}, {"device": "phone"}), ({"role": "judge"}, {"role": "referee"}), ({}, {"note": "n"}),
    ({}, {"correction": True}),
])
def test_what_matters_is_an_entry_of_its_own(first, second):
    referees = Referees(pause=0.1)
    referees.add(BUMPS, **first)
    referees.add(BUMPS, **second)
    referees.set(BUMPS, 9)
    assert len(referees.sheet.history) == 3


def test_a_mark_that_sets_is_taken_back_alone_and_once():
    referees = Referees(pause=0.1)
    for number in (1, 2):
        referees.set(CUPS, number, id=f"mark {number}")
    referees.set(CUPS, 3)
    assert referees.entries("number", "value") == [(1, 1), (2, 2), (3, 3)]
    referees.withdraw(3)
    assert referees.sheet.take_back(referees.now, "Anna", "mark 2").number == 2
    assert referees.sheet.take_back(referees.now, "Anna", "mark 2") is None, "it arrived again"
    assert (referees.value(CUPS), len(referees.sheet.history)) == (1, 3)


def test_a_number_of_an_entry_is_not_used_again():
    """A withdrawal that arrives late would meet another mark."""
    referees = Referees(pause=0.1)
    referees.set(CUPS, 1)
    referees.set(CUPS, 0)
    assert referees.sheet.history == ()
    referees.set(CUPS, 2)
    with pytest.raises(Refused, match="the score sheet has no entry 1"):
        referees.withdraw(1)
    assert referees.value(CUPS) == 2


def test_a_number_is_not_used_again_after_a_restart_or_the_end_of_the_run():
    referees = Referees(pause=0.1)
    referees.add(BUMPS, id="slip")
    referees.add(BUMPS, -1, id="undone")
    again = ScoreSheet(ITEMS, SheetState(list(referees.sheet.history), referees.sheet.marks))
    again.set(referees.now, "Anna", Mark(*CUPS.key, 2, id="other"))
    assert [entry.number for entry in again.history] == [2]
    assert again.set(referees.now, "Anna", Mark(*CUPS.key, 1)).value == 2  # a mark without identity is applied


def test_only_a_mark_with_its_own_entry_is_taken_back():
    referees = Referees(pause=0.1)
    referees.add(BUMPS, id="one")
    referees.add(BUMPS, id="two")
    referees.set(CUPS, 0, id="no change")
    for mark_id, why in (("one", "added to its item"), ("no change", "has no entry"), ("none", "was not applied")):
        with pytest.raises(Refused, match=why):
            referees.sheet.take_back(referees.now, "Anna", mark_id)
    assert referees.value(BUMPS) == 2


def test_the_id_of_a_mark_of_another_item_is_refused():
    """The mark would be lost without a word."""
    referees = Referees(pause=0.1)
    referees.add(BUMPS, id="one")
    with pytest.raises(Refused, match="the id 'one' was used for 'bumps': give each mark a new UUID"):
        referees.add(CUPS, id="one")
    referees.add(BUMPS, id="one")
    assert (referees.value(BUMPS), referees.value(CUPS)) == (1, 0)


def test_an_item_is_corrected_if_something_was_added_or_withdrawn_after_the_end(referees):
    referees.add(BUMPS)
    referees.add(BUMPS, who="Ben")
    assert not referees.item(BUMPS).corrected
    referees.add(BUMPS, correction=True)
    assert referees.item(BUMPS).corrected
    referees.withdraw(3, correction=True)
    assert not referees.item(BUMPS).corrected
    referees.withdraw(1, correction=True)
    assert (referees.value(BUMPS), referees.item(BUMPS).corrected) == (1, True)


# -- limits -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("item, start, added, why", [
    (CUPS, 3, "1", "'cups' is a count: its value must be from 0 to 3, not 4"),
    (CUPS, 0, "-1", "'cups' is a count: its value must be from 0 to 3, not -1"),
    (HEIGHT, -2, "-1", "'height' is a whole number: its value must be from -2 to 2, not -3"),
    (BUMPS, 0, "-1", "'bumps' is a count: its value must be 0 or more, not -1"),
    (BUMPS, 2**31 - 1, "1", "its value must be 0 or more, not 2147483648"),
    (BUMPS, 0, "0", "'bumps' cannot be changed by '0': give a number such as +1 or -1"),
    (BUMPS, 0, "one", "'bumps' cannot be changed by 'one'"),
    (BUMPS, 0, "1.5", "'bumps' is counted in whole numbers, not by '1.5'"),
    (WATER, 0, "10.5", "'water' takes a number from 0 to 10 with at most 3 decimals, not '10.5'"),
    (WATER, 0, "nan", "'water' cannot be changed by 'nan'"),
    (DOOR, 0, "1", "'detects the door' cannot be counted: set its value"),
    (HELP, 0, "1", "'help' cannot be counted: set its value"),
    (SHOW, 0, "1", "'show' cannot be counted: set its value"),
])
def test_a_count_beyond_the_limits_is_refused_and_changes_nothing(referees, item, start, added, why):
    if start:
        referees.set(item, start)
    before = referees.sheet.history, referees.value(item)
    with pytest.raises(Refused) as refused:
        referees.add(item, added, id="a mark")
    assert why in str(refused.value)
    assert (referees.sheet.history, referees.value(item)) == before
    assert referees.sheet.taken("a mark") is None


def test_a_withdrawal_on_which_later_counts_depend_is_refused(referees):
    referees.set(HEIGHT, 2)
    referees.add(HEIGHT, -3)
    referees.add(HEIGHT, -1)
    before = referees.sheet.history
    with pytest.raises(Refused) as refused:
        referees.withdraw(1)
    assert str(refused.value) == (
        "entry 1 cannot be withdrawn, because later entries count from it: without it, 'height' is a whole number: its "
        "value must be from -2 to 2, not -4. Withdraw those first, or set the value")
    assert (referees.sheet.history, referees.value(HEIGHT)) == (before, -2)
    referees.withdraw(3)
    referees.withdraw(2)
    referees.withdraw(1)
    assert referees.value(HEIGHT) == 0


# -- how much is kept -------------------------------------------------------------------------------


@pytest.mark.long
@pytest.mark.parametrize("many, noted", [(1000, 0), (300, MAX_NOTED)])
def test_wild_counting_grows_nothing_and_loses_no_count(many, noted):
    referees = Referees()
    referees.set(BUMPS, 5)
    for number in range(noted):
        referees.add(BUMPS, note=f"bump {number}")
    for number in range(many):
        referees.add(BUMPS, 1, who=("Anna", "Ben", "Cleo")[number % 3], correction=number > many // 2)
        if number == many // 2:
            referees.set(CUPS, 2)
    assert len(referees.sheet.history) <= MAX_ENTRIES + 2 * (len(ITEMS) + 2)
    assert (referees.value(BUMPS), referees.value(CUPS)) == (5 + noted + many, 2)
    assert _again(referees.sheet).items() == referees.sheet.items()


def test_entries_that_are_joined_for_lack_of_room_change_the_item_as_both_did(referees, monkeypatch):
    monkeypatch.setattr(sheets, "MAX_ENTRIES", -2 * referees.sheet._places + 1)
    referees.set(BUMPS, 5)
    for number in range(3):
        referees.add(BUMPS, 2, id=f"mark {number}")
    assert referees.entries("number", "old", "value", "added") == [(3, 0, 9, ""), (4, 9, 11, "2")]
    assert (referees.value(BUMPS), referees.sheet.marks) == (11, "3 mark 0\n3 mark 1\n4 mark 2\n")
    referees.set(BUMPS, not_attempted=True)
    referees.add(BUMPS, 3)
    assert (referees.value(BUMPS), referees.item(BUMPS).not_attempted) == (3, False)


# -- any order --------------------------------------------------------------------------------------

STEPS = st.lists(st.one_of(
    st.tuples(st.just("add"), st.integers(-3, 3).filter(bool), st.sampled_from(["Anna", "Ben"])),
    st.tuples(st.just("set"), st.integers(0, 5), st.sampled_from(["Anna", "Ben"])),
    st.tuples(st.just("not attempted"), st.just(0), st.just("Anna")),
    st.tuples(st.just("withdraw"), st.integers(1, 12), st.just("Cleo")),
    st.tuples(st.just("restart"), st.just(0), st.just("")),
), max_size=15)


@examples(300)
@given(STEPS, st.sampled_from([0.3, 60.0]))
def test_the_value_is_the_last_one_set_and_what_was_added_since(steps, pause):
    referees = Referees(pause)
    for what, number, who in steps:
        try:
            if what == "add":
                referees.add(BUMPS, number, who)
            elif what == "set":
                referees.set(BUMPS, number, who)
            elif what == "not attempted":
                referees.set(BUMPS, not_attempted=True)
            elif what == "withdraw":
                referees.withdraw(number)
            else:
                referees.sheet = _again(referees.sheet)
        except Refused:
            pass
        expected = 0
        for entry in referees.sheet.history:
            if not entry.withdrawn_utc:
                added = int(entry.added or 0)
                expected = (0 if expected == "-" else expected) + added if entry.added else (
                    "-" if entry.not_attempted else entry.value)
        assert referees.value(BUMPS) == expected
        assert expected == "-" or expected >= 0


# -- identities -------------------------------------------------------------------------------------


def _again(sheet):
    """The sheet after a restart."""
    return ScoreSheet(ITEMS, thaw(SheetState, freeze(sheet.state)))


def test_a_mark_is_applied_once_also_after_a_withdrawal_and_a_restart(referees):
    for _ in range(3):
        referees.add(BUMPS, id="one")
        referees.set(DOOR, 1, id="two")
        referees.set(DOOR, 0, who="Ben", id="three")
        referees.sheet = _again(referees.sheet)
    assert (referees.value(BUMPS), referees.value(DOOR), len(referees.sheet.history)) == (1, 0, 3)
    referees.withdraw(1)
    referees.add(BUMPS, id="one")
    assert referees.value(BUMPS) == 0
    assert referees.sheet.taken("one") == 1


def test_a_mark_without_an_identity_counts_each_time(referees):
    for _ in range(2):
        referees.add(BUMPS)
    assert (referees.value(BUMPS), referees.sheet.marks, referees.sheet.taken("")) == (2, "", None)


def test_a_mark_that_changes_nothing_is_known_too(referees):
    referees.set(BUMPS, 0, id="no change")
    referees.set(BUMPS, 4)
    referees.set(BUMPS, 0, id="no change")
    assert (referees.value(BUMPS), referees.sheet.taken("no change")) == (4, 0)


@pytest.mark.long
def test_the_newest_identities_are_kept(referees):
    for number in range(MAX_MARKS + 5):
        referees.add(BUMPS, id=str(number))
    kept = [line.split()[1] for line in referees.sheet.marks.splitlines()]
    assert kept == [str(number) for number in range(5, MAX_MARKS + 5)]
    assert [referees.sheet.taken(mark_id) is None for mark_id in ("4", "5")] == [True, False]
    assert _again(referees.sheet).taken("5") == referees.sheet.taken("5")


# -- in the box -------------------------------------------------------------------------------------


def _config():
    return competition(tbm=[event("HGTKMH", scoring=ITEMS)], other=[event("HWV", team="Beta")])


@pytest.fixture
def driver():
    return BoxDriver(_config(), Settings(auto_next=False))


def _plus(number, item=BUMPS, **of_mark):
    return Mark(*item.key, added="1", id=f"mark {number}", role="referee", device="phone", **of_mark)


def _mark(driver, name, mark, who="Anna"):
    driver.mark(name, mark, who)
    return driver.box.scores.outcome(name, mark)


def _refused(driver, name, mark):
    driver.taken()
    with pytest.raises(Refused) as refused:
        driver.mark(name, mark, "Anna")
    (recorded,) = driver.taken()
    assert recorded.value["refused"] == refused.value.reasons
    (reason,) = refused.value.reasons
    return reason


def _running(driver):
    driver.executing()
    return RunName("tbm", driver.run_in().identity)


def test_taking_back_arrives_again_after_the_run_and_its_sign_off(driver):
    name = _running(driver)
    _mark(driver, name, Mark(*DOOR.key, 1, id="the door"))
    _mark(driver, name, Mark(*BUMPS.key, 4, id="bumps"))
    driver.enter("take_back", name, "Anna", id="the door")
    driver.command("stop")
    driver.command("disconnect")
    driver.enter("sign_off", name, "Anna")
    driver.enter("take_back", name, "Anna", id="the door")
    with pytest.raises(Refused, match="signed off"):
        driver.enter("take_back", name, "Anna", id="bumps")
    with pytest.raises(Refused, match="name the run"):
        driver.enter("take_back", RunName("tbm"), "Anna", id="bumps")
    history = driver.box.scores.record_of(driver.now, name).history
    assert [(entry.desc, entry.withdrawn_utc > 0) for entry in history] == [(DOOR.desc, True), (BUMPS.desc, False)]


def test_a_mark_is_logged_and_recorded_with_role_and_device(driver):
    name = _running(driver)
    driver.taken()
    for _ in range(2):
        entry, item = _mark(driver, name, _plus(1, note="the vase"))
        assert (entry, item.value) == (1, 1)
    taken = driver.taken()
    recorded = [effect for effect in taken if isinstance(effect, effects.Recorded)]
    assert [(effect.who, effect.value) for effect in recorded] == 2 * [("Anna", {
        "command": "mark", "group": "Penalized", "item": "bumps", "note": "the vase", "added": "1", "mark": "mark 1",
        "role": "referee", "device": "phone"})]
    logged = [effect.value for effect in taken if isinstance(effect, effects.RunLogged)]
    assert logged == [("Penalized", "bumps", 1)]
    assert [effect.topic for effect in taken if isinstance(effect, effects.RunLogged)] == [run_log.SCORE]
    (changed,) = [effect.record for effect in taken if isinstance(effect, effects.RecordChanged)]
    assert [(e.role, e.device, e.added) for e in changed.history] == [("referee", "phone", "1")]
    assert changed.marks == "1 mark 1\n"
    assert driver.view().log.count("bumps 0 -> 1 (the vase)") == 1


@pytest.mark.parametrize("mark, why", [
    (_plus(1)._replace(id=" "), "the id ' ' cannot identify a mark: give each mark a new UUID"),
    (_plus(1)._replace(id="x" * 65), "cannot identify a mark"),
    (_plus(1)._replace(id="a\nb"), "cannot identify a mark"),
    (_plus(1)._replace(role="king"), "no role 'king': choose one of referee, judge, organiser"),
    (_plus(1, CUPS)._replace(added="4"), "'cups' is a count: its value must be from 0 to 3, not 4"),
])
def test_what_cannot_be_marked_is_refused(driver, mark, why):
    assert why in _refused(driver, _running(driver), mark)


def test_a_mark_names_its_run_and_never_counts_in_the_next(driver):
    name = _running(driver)
    assert _refused(driver, RunName("tbm"), _plus(1)).startswith("name the run")
    _mark(driver, name, _plus(1))
    driver.command("disconnect")
    following = _running(driver)
    for _ in range(2):
        _mark(driver, name, _plus(1))
        _mark(driver, name, _plus(2))
    assert driver.box.scores.outcome(following, _plus(3)).item.value == 0
    record = driver.box.finished.find(name.identity).record
    assert [(item.value, item.corrected) for item in record.items if item.desc == "bumps"] == [(2, True)]
    assert [entry.correction for entry in record.history] == [False, True]


def test_a_mark_that_arrives_again_after_the_sign_off_is_no_error(driver):
    name = _running(driver)
    _mark(driver, name, _plus(1))
    driver.command("disconnect")
    driver.enter("sign_off", name, "Cleo (/roah_rsbb_window_1)")
    driver.taken()
    assert _mark(driver, name, _plus(1)).item.value == 1
    assert {type(effect) for effect in driver.taken()} == {effects.Recorded}
    assert "was signed off by Cleo at" in _refused(driver, name, _plus(2))


def test_long_names_of_devices_are_cut(driver):
    name = _running(driver)
    _mark(driver, name, _plus(1)._replace(device="d" * 400))
    assert driver.run_in().record(driver.now).history[0].device == "d" * MAX_WHO


def test_a_finished_run_of_an_older_journal_has_no_marks(driver):
    name = _running(driver)
    _mark(driver, name, _plus(1))
    driver.command("disconnect")
    record = driver.box.finished.find(name.identity).record
    frozen = freeze(record)
    del frozen["marks"]
    del frozen["history"][0]["added"]
    old = FinishedRun(thaw(type(record), frozen), Benchmark("HGTKMH", "", "", 0.0, 0.0, ITEMS))
    assert [item.value for item in old.record.items if item.desc == "bumps"] == [1]
    assert old.sheet.taken("mark 1") is None


@pytest.mark.long
def test_after_a_kill_at_any_record_all_marks_arrive_again_and_count_once(tmp_path):
    """Each record of the journal is a moment at which the core may be killed, before it answers."""
    copies = []

    def keep(driver):
        copies.append(tmp_path / f"copy {len(copies)}")
        driver.copy(copies[-1])

    driver = journaled_box(tmp_path, _config())
    name = _running(driver)
    driver.on_record = keep
    marks = [_plus(number, item) for number, item in enumerate((BUMPS, CUPS, BUMPS, CUPS))]

    def send_all(to):
        for number, mark in enumerate(marks):
            _mark(to, name, mark, "Anna" if number % 2 else "Ben")

    for mark in marks[:2]:
        _mark(driver, name, mark)
    driver.command("disconnect")
    send_all(driver)
    driver.on_record = None
    assert len(copies) >= 5
    for path in copies:
        again = journaled_box(tmp_path / f"after {path.name}", _config())
        again.now = driver.now.later(2.0)
        again.journal.close()
        again.resume_in(path)
        for _ in range(2):
            send_all(again)
        values = {item.desc: item.value for item in again.box.scores.record_of(again.now, name).items}
        assert (values["bumps"], values["cups"]) == (2, 2), path
        again.journal.close()
    driver.journal.close()
