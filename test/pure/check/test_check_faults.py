"""Each fault of a robot is found, and its cause is named right."""

import pytest

from helpers.checked_robot import Checked
from helpers.faulty_robots import FAULTS
from roah_rsbb.check.report import Cause, Verdict


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.name.replace(" ", "-"))
def test_a_fault_is_found_and_named(monkeypatch, fault):
    checked = Checked(monkeypatch, lambda loop: fault.make(monkeypatch, loop), names=fault.scenarios,
                      **{"patience": 10.0, **dict(fault.given)})
    assert fault.cause in checked.causes(fault.verdict), checked.findings
    assert checked.causes(Verdict.FAILED) - {fault.cause, *fault.also} == set(), checked.findings


@pytest.mark.parametrize("names", sorted({fault.scenarios for fault in FAULTS}), ids=",".join)
def test_the_same_scenarios_find_nothing_in_a_robot_without_faults(monkeypatch, names):
    checked = Checked(monkeypatch, names=names)
    assert checked.findings == []


def test_a_fault_is_tried_for_each_cause():
    assert {fault.cause for fault in FAULTS} == set(Cause)
