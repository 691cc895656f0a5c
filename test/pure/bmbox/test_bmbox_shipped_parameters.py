"""The shipped parameters of the benchmarks with ground truth, and what is refused in them."""

import pytest

from helpers.config_files import SHIPPED
from roah_rsbb.bmbox.framework.parameters import read_parameters
from roah_rsbb.bmbox.framework.rule_files import modules
from roah_rsbb.rulebook.errors import ConfigErrors

MODULES = SHIPPED / "modules"


def read(path, code):
    return read_parameters(str(path), code, modules()[code].PARAMETERS)


def test_the_shipped_parameters():
    hopf, hppf, hpff, hgmf = (read(MODULES / f"{code}.yaml", code) for code in ("HOPF", "HPPF", "HPFF", "HGMF"))
    assert {each.goal_timeout for each in (hopf, hppf, hpff, hgmf)} == {None}  # that of benchmarks.yaml
    assert len({item.id for item in hopf.items}) == len(hopf.items) >= hopf.goals == 10
    assert "Annie" in hppf.people
    assert (hpff.minimum_distance, hpff.maximum_distance, hpff.desired_distance) == (0.15, 3.5, 2.0)
    assert len({thing.id for thing in hgmf.objects}) == len(hgmf.objects)


@pytest.mark.parametrize("code, old, new, found", [
    ("HOPF", "goals: 10", "goals: 0", "found the number '0' as goals; expected a whole number from 1 to 100"),
    ("HOPF", "goals: 10", "goals: 101", "expected a whole number from 1 to 100"),
    ("HOPF", "{ id: 1,", "{ id: 70000,", "expected a whole number from 0 to 65535"),
    ("HOPF", "{ id: 1,", "{ id: -1,", "expected a whole number from 0 to 65535"),
    ("HOPF", "x: 1.2", "x: 0", "expected a number of metres above 0 and at most 10"),
    ("HOPF", "y: 0.8", "y: 0.0", "expected a number of metres above 0 and at most 10"),
    ("HOPF", "class: cups, ", "", "without class"),
    ("HPPF", "- Annie", "- 7", "expected a text"),
    ("HPFF", "minimum_distance: 0.15", "minimum_distance: -1", "expected a number of metres at least 0 and at most"),
    ("HPFF", "maximum_distance: 3.5", "maximum_distance: 0", "expected a number of metres above 0 and at most 100"),
    ("HPFF", "desired_distance: 2.0", "desired_distance: 0", "expected a number of metres above 0 and at most 100"),
    ("HPFF", "# goal_timeout: 300", "goal_timeout: -3", "expected a number of seconds above 0"),
    # On a smaller table there may be no target 5 cm from the object.
    ("HGMF", "x: 1.2", "x: 0.49", "expected a number of metres at least 0.5 and at most 10"),
    ("HGMF", "y: 0.8", "y: 0.49", "expected a number of metres at least 0.5 and at most 10"),
    # What GoalHGMF has room for (docs/ros_interface.md, "Team's side").
    ("HGMF", "{ id: 1,", "{ id: 65536,", "expected a whole number from 0 to 65535"),
])
def test_refused_values(tmp_path, code, old, new, found):
    text = (MODULES / f"{code}.yaml").read_text(encoding="utf-8")
    assert old in text
    (tmp_path / "it.yaml").write_text(text.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(ConfigErrors, match=f"yaml:{text[:text.index(old)].count(chr(10)) + 1}: ") as wrong:
        read(tmp_path / "it.yaml", code)
    assert found in str(wrong.value)
