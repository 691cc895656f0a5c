"""What panels say of score sheets and runs."""

from types import SimpleNamespace

import pytest

from roah_rsbb.wording import sheet_texts

BOOL, UINT = 0, 1


class _Time:
    def __init__(self, seconds):
        self._seconds = seconds

    def to_sec(self):
        return self._seconds


def _summary(**fields):
    values = {"end_reason": "stopped", "started": _Time(5.0), "closed": _Time(9.0), "signed": _Time(0.0),
              "signed_by": "", "corrected": False, "code": "HWV", "round": 1, "run": 2}
    return SimpleNamespace(**{**values, **fields})


def _entry(**fields):
    values = {"old": 1, "old_not_attempted": False, "value": 2, "not_attempted": False, "note": "", "correction": False,
              "withdrawn": _Time(0.0), "withdrawn_by": "", "withdrawn_note": "", "withdrawal_corrects": False}
    return SimpleNamespace(**{**values, **fields})


@pytest.mark.parametrize("value, not_attempted, kind, text", [
    (0, False, UINT, "0"), (3, False, UINT, "3"), (0, False, BOOL, "no"), (1, False, BOOL, "yes"),
    (0, True, UINT, "not attempted"), (0, True, BOOL, "not attempted"),
])
def test_how_an_item_stands(value, not_attempted, kind, text):
    assert sheet_texts.standing(value, not_attempted, kind) == text


@pytest.mark.parametrize("fields, text", [
    ({}, "stopped"), ({"end_reason": "timeout"}, "time is up"), ({"end_reason": "new_one"}, "new_one"),
    ({"end_reason": ""}, "running"), ({"end_reason": "", "started": _Time(0.0)}, "connected"),
])
def test_how_a_run_ended(fields, text):
    assert sheet_texts.end(_summary(**fields)) == text


@pytest.mark.parametrize("fields, text", [
    ({"closed": _Time(0.0)}, "not over"), ({}, "unsigned"),
    ({"corrected": True}, "✎ corrected, unsigned"),
    ({"corrected": True, "signed": _Time(7.0), "signed_by": "Cleo"}, "✎ corrected, ✔ signed off"),
])
def test_what_became_of_a_sheet(fields, text):
    assert sheet_texts.state(_summary(**fields)) == text


@pytest.mark.parametrize("fields, text", [
    ({}, ""), ({"signed": _Time(3661.0), "signed_by": "Cleo"}, "by Cleo at 01:01:01 UTC"),
    ({"signed": _Time(3661.0)}, "by somebody at 01:01:01 UTC"),
])
def test_who_signed_a_sheet_off(fields, text):
    assert sheet_texts.signature(_summary(**fields)) == text


def test_what_an_entry_changed():
    assert sheet_texts.change(_entry(), UINT) == "1 → 2"
    assert sheet_texts.change(_entry(old_not_attempted=True, value=1), BOOL) == "not attempted → yes"


@pytest.mark.parametrize("fields, text", [
    ({}, ""), ({"note": "the vase"}, "the vase"), ({"correction": True, "note": "video"}, "✎ correction; video"),
    ({"note": "n", "withdrawn": _Time(3661.0), "withdrawn_by": "Ben"}, "n; ✘ withdrawn 01:01:01 by Ben"),
    ({"withdrawn": _Time(3661.0), "withdrawal_corrects": True, "withdrawn_note": "why"},
     "✘ withdrawn 01:01:01 by somebody (✎ correction): why"),
])
def test_what_else_there_is_to_say(fields, text):
    assert sheet_texts.entry_notes(_entry(**fields)) == text


@pytest.mark.parametrize("reason, by, who, text", [
    ("", "", "Anna", ""), ("fire", "Anna", "Anna", "fire"), ("fire", "Ben", "Anna", "fire (Ben)"),
])
def test_why_a_run_was_stopped(reason, by, who, text):
    assert sheet_texts.stop_reason(SimpleNamespace(reason=reason, reason_by=by, who=who)) == text
