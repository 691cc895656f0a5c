"""Which windows a client opens."""

import pytest

from roah_rsbb.rqt import display, gui


@pytest.mark.parametrize(("wanted", "has_rqt", "command"), [
    ("auto", True, gui.RQT), ("auto", False, gui.WINDOW), ("window", True, gui.WINDOW), ("window", False, gui.WINDOW),
    ("rqt", True, gui.RQT), ("public", True, gui.PUBLIC), ("public", False, gui.PUBLIC),
])
def test_what_is_opened(wanted, has_rqt, command):
    assert gui.choose(wanted, has_display=True, has_rqt=has_rqt) == (command, "", 0)


@pytest.mark.parametrize("wanted", ["auto", "rqt", "window", "public"])
def test_without_a_display_nothing_is_opened_and_nothing_failed(wanted):
    choice = gui.choose(wanted, has_display=False, has_rqt=True)
    assert choice == (None, display.NO_DISPLAY, 0)
    assert "\n" not in choice.text


def test_rqt_that_is_not_there_is_named_with_its_remedy():
    choice = gui.choose("rqt", has_display=True, has_rqt=False)
    assert (choice.command, choice.code) == (None, 1)
    assert "ros-noetic-rqt-gui-py" in choice.text
    assert "gui:=window" in choice.text
