"""Readers have the core's document, however slow they are and whatever they lose."""

import json
from types import SimpleNamespace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from helpers.examples import examples
from helpers.toy_document import BOXES, RESULTS, ZONES, Box, Result, Toy, Zone, changes
from roah_rsbb.document import document
from roah_rsbb.document.document import DocumentReader, Followed, Gap, Written
from roah_rsbb.model.as_json import BadData
from roah_rsbb.model.clock import Now

NOW = Now(5.0, 1000.0)
HOME = Toy(Box("Event"), {"Home": Zone("Home"), "Yard": Zone("Yard")}, tuple(Result(f"Team {i}") for i in range(5)))


class Reader:
    """A reader that takes messages only when the test says so."""

    def __init__(self):
        self.follower = DocumentReader()
        self.followed = Followed(Toy)

    def take(self, written, is_lost=False):
        """Returns the message; None: there is none."""
        text = self.follower.next(written, NOW)
        if text is None:
            return None
        message = json.loads(text)
        if not is_lost:
            try:
                self.followed.take(message)
            except Gap:
                self.follower.forget()
        return message


def written_of(*values):
    written = Written(Toy)
    for value in values:
        written.update(value, NOW)
    return written


STEPS = st.lists(st.tuples(changes(), st.lists(st.tuples(st.integers(0, 2), st.booleans()), max_size=3)), max_size=10)


@examples(200)
@given(st.builds(Toy, BOXES, st.dictionaries(st.sampled_from("abc"), ZONES), RESULTS), STEPS)
def test_every_reader_catches_up(toy, steps):
    written, readers = Written(Toy), [Reader() for _ in range(3)]
    written.update(toy, NOW)
    for change, takers in steps:
        before = [reader.followed.document for reader in readers]
        toy = change(toy)
        written.update(toy, NOW)
        for index, is_lost in takers:
            readers[index].take(written, is_lost)
        for reader, old in zip(readers, before):
            if old is not None:
                check_kept(old, reader.followed.document)
    for reader in readers:
        while reader.take(written):
            pass
        if reader.followed.number != written.number:  # the last message was lost: the reader asks for the whole
            reader.follower.forget()
            reader.take(written)
        assert reader.followed.document == toy
        assert reader.followed.number == written.number


def check_kept(old, new):
    """Parts that are equal are the same objects."""
    assert new.box is old.box or new.box != old.box
    assert new.results is old.results or new.results != old.results
    for name in old.zones.keys() & new.zones.keys():
        assert new.zones[name] is old.zones[name] or new.zones[name] != old.zones[name]


def test_the_whole_then_differences_with_the_clocks():
    written, reader = Written(Toy, 2.0), Reader()
    assert reader.take(written) is None
    assert written.update(HOME, NOW)
    first = reader.take(written)
    assert (first["mono"], first["utc"], first["rate"], first["number"]) == (5.0, 1000.0, 2.0, 1_000_000)
    assert first["whole"]["box"] == {"event": "Event"}
    assert reader.take(written) is None
    assert written.update(HOME._replace(box=Box("Final")), NOW)
    assert reader.take(written) == {
        "mono": 5.0, "utc": 1000.0, "rate": 2.0, "number": 1_000_001, "since": 1_000_000,
        "changes": {"box": {"event": ["Final"]}}}
    assert reader.followed.document.box == Box("Final")
    assert json.loads(written.message(NOW)) == {"mono": 5.0, "utc": 1000.0, "rate": 2.0}
    assert not reader.followed.take(json.loads(written.message(NOW)))


def test_equal_values_are_no_change():
    written = written_of(HOME)
    sections = dict(written.sections)
    assert not written.update(Toy(Box("Event"), {name: Zone(name) for name in HOME.zones}, tuple(HOME.results)), NOW)
    assert all(written.sections[name] is sections[name] for name in sections)


def test_only_what_is_another_object_is_written_again(monkeypatch):
    written = written_of(HOME)
    made = []
    entry = SimpleNamespace(write=lambda zone: made.append(zone.name) or {"name": zone.name, "count": zone.count})
    monkeypatch.setattr(written, "_kinds", [kind._replace(entry=kind.entry and entry) for kind in written._kinds])
    assert written.update(HOME._replace(zones={**HOME.zones, "Home": Zone("Home", count=1)}), NOW)
    assert made == ["Home"]


def test_followers_share_what_they_are_sent(monkeypatch):
    calls = []
    monkeypatch.setattr(document, "difference", lambda *both: calls.append(both) or {})
    written, readers = written_of(HOME), [Reader() for _ in range(5)]
    for reader in readers:
        reader.take(written)
    written.update(HOME._replace(results=()), NOW)
    for reader in readers:
        reader.take(written)
    assert len(calls) == 1


def test_a_late_reader_costs_only_the_sections_that_changed(monkeypatch):
    written = written_of(HOME)
    Reader().take(written)
    written.update(HOME._replace(box=Box("Final")), NOW)
    made = []
    monkeypatch.setattr(document, "_text", lambda data: made.append(data) or json.dumps(data))
    Reader().take(written)
    assert [data for data in made if not isinstance(data, str)] == [{"event": "Final"}]


def test_a_slow_reader_gets_one_difference():
    written, reader = written_of(HOME), Reader()
    reader.take(written)
    for number in range(10):
        written.update(HOME._replace(zones={**HOME.zones, "Home": Zone("Home", count=number)}), NOW)
    assert reader.take(written)["changes"] == {"zones": {"Home": {"count": [9]}}}
    assert reader.take(written) is None


def test_a_change_that_was_taken_back_is_an_empty_difference():
    written, reader = written_of(HOME), Reader()
    reader.take(written)
    kept = reader.followed.document
    written.update(HOME._replace(box=Box("Final")), NOW)
    written.update(HOME, NOW)
    assert reader.take(written)["changes"] == {}
    assert reader.followed.document is kept and reader.followed.number == written.number


def test_a_reader_with_a_gap_asks_for_the_whole():
    written, reader = written_of(HOME), Reader()
    reader.take(written)
    home = reader.followed.document.zones["Home"]
    for number in (1, 2):
        written.update(HOME._replace(zones={**HOME.zones, "Yard": Zone("Yard", count=number)}), NOW)
        reader.take(written, is_lost=number == 1)
    assert reader.followed.document.zones["Yard"].count == 0
    assert "whole" in reader.take(written)
    assert reader.followed.document.zones["Yard"].count == 2
    assert reader.followed.document.zones["Home"] is home


@pytest.mark.parametrize("message", [
    {"number": 2, "since": 1, "changes": {"box": {"event": ["x"]}}}, {"number": 2, "since": 1_000_000, "changes": 7},
    {"number": 2, "since": 1_000_000, "changes": {"unknown": [[1, []]]}},
])
def test_a_difference_that_does_not_fit_is_a_gap(message):
    reader = Reader()
    with pytest.raises(Gap):
        reader.followed.take(message)
    reader.take(written_of(HOME))
    message["changes"] = {"results": [[[99, [1]]], []]} if message["since"] != 1 else message["changes"]
    with pytest.raises(Gap):
        reader.followed.take(message)
    assert reader.followed.document == HOME


def test_a_wrong_document_changes_nothing():
    reader = Reader()
    reader.take(written_of(HOME))
    wrong = ({"box": {"event": 1}}, "box.event"), ({"zones": {"Home": {"count": 1}}}, "zones.Home"), (7, "no sections")
    for whole, where in wrong:
        with pytest.raises(BadData, match=where):
            reader.followed.take({"number": 9, "whole": whole})
    assert reader.followed.document == HOME and reader.followed.number == 1_000_000


def test_sections_of_a_newer_box_are_followed_and_those_of_an_older_one_are_usual():
    followed = Followed(Toy)
    assert followed.take({"number": 1, "whole": {"weather": {"sun": 1}}})
    assert followed.document == Toy()
    assert not followed.take({"number": 2, "since": 1, "changes": {"weather": {"sun": [2]}}})
    assert followed.take({"number": 3, "since": 2, "changes": {"weather": {"sun": None}, "box": [{"event": "e"}]}})
    assert followed.document == Toy(Box("e"))


def test_the_numbers_of_a_box_that_starts_again_are_higher():
    first = written_of(HOME, Toy())
    again = Written(Toy)
    again.update(HOME, NOW.later(0.01))
    assert again.number > first.number
