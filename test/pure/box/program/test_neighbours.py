"""What the program that copies the journal says to the box through the door, and is asked."""

import math
from types import SimpleNamespace

import pytest

from roah_rsbb.box.program.neighbours import CopyCalls
from roah_rsbb.core.copies import CopyReport
from roah_rsbb.document.calls import COPIED, COPY, COPY_REPORT, Caller
from roah_rsbb.model.reason import Refused, encode, say

REPORT = {"place": "standby", "journal": "own", "behind_s": 0.5, "missing_bytes": 7, "trouble": "", "notice": ""}
TROUBLE = say("no space left on {place}")


@pytest.fixture
def box():
    """A box whose events, answers and questions are noted."""
    noted = SimpleNamespace(events=[], looks=[], answers=[], asked=[])
    core = SimpleNamespace(
        store=SimpleNamespace(identity="own"), box=SimpleNamespace(copies=SimpleNamespace(report="report")),
        event=lambda method, report: noted.events.append(report),
        standby=SimpleNamespace(look=lambda: noted.looks.append(1), on_answer=noted.answers.append))
    door = SimpleNamespace(ask=lambda *call: noted.asked.append(call))
    noted.calls = CopyCalls("this start", core, door)
    noted.call = lambda name, **found: noted.calls.named()[name](found, Caller())
    return noted


def test_a_report_becomes_an_event_and_unanswered_questions_are_repeated(box):
    box.call(COPY_REPORT, **REPORT)
    assert box.events == [CopyReport("standby", True, 0.5, 7, "", "")] and box.looks == [1]


def test_a_copy_of_another_journal_that_was_never_complete(box):
    box.call(COPY_REPORT, **{**REPORT, "journal": "other", "behind_s": None})
    (report,) = box.events
    assert (report.is_of_this_box, report.behind_s) == (False, math.inf)


def test_its_reasons_are_shown_in_every_language(box):
    trouble = TROUBLE(place="/media")
    box.call(COPY_REPORT, **{**REPORT, "trouble": encode(trouble)})
    assert (box.events[0].trouble, box.events[0].trouble.values) == (trouble, {"place": "/media"})


def test_the_standby_has_what_this_start_of_the_box_asked_for(box):
    box.calls.ask(12)
    ((name, asked, _caller),) = box.asked
    assert (name, asked) == (COPY, {"box": "this start", "journal": "own", "ticket": 12})
    box.call(COPIED, box="the start before", ticket=99)
    assert box.answers == [], "its tickets are others"
    box.call(COPIED, box="this start", ticket=12)
    assert box.answers == [12]


@pytest.mark.parametrize("name, found", [
    (COPY_REPORT, {}), (COPY_REPORT, {**REPORT, "place": 1}), (COPY_REPORT, {**REPORT, "behind_s": "1"}),
    (COPY_REPORT, {**REPORT, "missing_bytes": True}), (COPY_REPORT, {**REPORT, "journal": None}),
    (COPIED, {"box": "this start"}), (COPIED, {"box": "this start", "ticket": "12"}), (COPIED, {"ticket": 12})])
def test_nonsense_is_refused_with_the_remedy_and_changes_nothing(box, name, found):
    with pytest.raises(Refused, match="install the same version"):
        box.call(name, **found)
    assert (box.events, box.answers) == ([], [])
