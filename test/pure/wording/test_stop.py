"""The way of a STOP: how far it came, and what the referee reads."""

import json
import pathlib
import re
from types import SimpleNamespace

import pytest

from roah_rsbb.wording import stop
from roah_rsbb.wording.stop import DONE, LOST, NOT_DELIVERED_S, TEXTS, Way, leaving, way, way_text

ROOT = pathlib.Path(__file__).resolve().parents[3]
SOON, LATE = NOT_DELIVERED_S - 0.01, NOT_DELIVERED_S


@pytest.mark.parametrize("passed_s, box_has_it, is_by_hand, not_stopped, expected", [
    (0.0, False, False, True, Way.SENT),
    (SOON, False, False, True, Way.SENT),
    (LATE, False, False, True, Way.LOST_BOX),
    (1e6, False, True, False, Way.LOST_BOX),
    (0.0, True, False, True, Way.AT_BOX),
    (SOON, True, False, True, Way.AT_BOX),
    (LATE, True, False, True, Way.LOST_ROBOT),
    (0.0, True, False, False, Way.STOPPED),
    (1e6, True, False, False, Way.STOPPED),
    (0.0, True, True, False, Way.NO_ROBOT),
    (1e6, True, True, True, Way.NO_ROBOT),
])
def test_how_far_a_stop_came(passed_s, box_has_it, is_by_hand, not_stopped, expected):
    assert way(passed_s, box_has_it, is_by_hand, not_stopped) is expected


def test_the_referee_must_act_after_a_second():
    assert NOT_DELIVERED_S == 1.0


def test_every_way_has_a_text_with_the_zone_and_what_to_do():
    assert set(TEXTS) == set(Way)
    assert set(LOST) | set(DONE) | {Way.SENT, Way.AT_BOX} == set(Way)
    for where in Way:
        text = way_text(where, "Home {A}")
        assert text.startswith("STOP Home {A}: ")
        assert ("by hand" in text, "Trying again" in text) == (where in LOST, where in LOST)
        assert text.endswith("…") == (where not in DONE), "it continues"


@pytest.mark.parametrize("phase, not_stopped, expected", [
    ("ended", ["mbot of team A", "amigo of team B"],
     "mbot of team A, amigo of team B did not answer STOP. After the disconnect the box does not repeat it: stop by "
     "hand first"),
    ("ended", [], ""),
    ("running", ["mbot of team A"], ""),
    ("connected", ["mbot of team A"], ""),
    ("idle", [], ""),
])
def test_who_leaves_a_robot_that_has_not_stopped_is_warned(phase, not_stopped, expected):
    assert leaving(SimpleNamespace(phase=phase, not_stopped=not_stopped)) == expected


def test_the_names_on_the_web_pages_stay():
    assert [where.value for where in stop.Way] == ["sent", "at_box", "stopped", "no_robot", "lost_box", "lost_robot"]


def test_the_page_has_the_same_words_and_times():
    """The script of STOP has words of its own, because it must work without any text of the box."""
    script = (ROOT / "resource" / "web" / "assets" / "stop.js").read_text(encoding="utf-8")
    assert dict(re.findall(r'(\w+): "(STOP \{zone\}: [^"]*)"', script)) == {way.value: TEXTS[way] for way in Way}
    assert re.findall(r"LATE_MS = (\d+)", script) == [f"{1000 * NOT_DELIVERED_S:.0f}"]
    assert f'DONE = {json.dumps([way.value for way in DONE])};' in script
