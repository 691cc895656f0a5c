"""How well a robot is heard."""

from roah_rsbb.model.zone import LATELY_S
from roah_rsbb.wording.whole_box import SILENT, WINDOW_S, LinkQuality, link_text

TICK_S = 0.1


class Watch:
    """A panel that looks ten times a second, and one robot."""

    def __init__(self, tick_s=TICK_S):
        self.tick_s = tick_s
        self.links = LinkQuality()
        self.mono = 1000.0
        self.heard = 1000.0

    def pass_time(self, seconds, every_s=1.0):
        """The robot is heard each `every_s`; None: not at all."""
        for _ in range(round(seconds / self.tick_s)):
            self.mono += self.tick_s
            if every_s is not None and self.mono - self.heard >= every_s - 1e-6:
                self.heard = self.mono
            is_silent = self.mono - self.heard > LATELY_S
            self.links.observe(self.mono, {"mbot": self.heard if is_silent else None})

    def longest(self):
        return round(self.links.longest_silence_s("mbot"), 1)


def test_a_robot_that_sends_each_second_is_well_heard():
    watch = Watch()
    watch.pass_time(20.0)
    assert watch.longest() <= 1.1
    assert link_text(watch.longest()) == "▮▮▮ good"


def test_a_gap_is_remembered_as_long_as_the_window_and_no_longer():
    watch = Watch()
    watch.pass_time(5.0)
    watch.pass_time(2.5, None)
    watch.pass_time(5.0)
    assert 2.4 <= watch.longest() <= 3.6
    assert "s" in link_text(watch.longest())
    watch.pass_time(WINDOW_S)
    assert link_text(watch.longest()) == "▮▮▮ good"


def test_pages_without_readers_look_less_often_but_remember_gaps():
    watch = Watch(tick_s=1.05)
    watch.pass_time(5.25)
    watch.pass_time(3.15, None)
    watch.pass_time(4.2)
    assert watch.longest() >= 3.0


def test_a_silence_that_lasts_counts_at_once():
    watch = Watch()
    watch.pass_time(5.0)
    watch.pass_time(4.0, None)
    assert link_text(watch.longest()).startswith("▮▯▯ poor, ")
    watch.pass_time(8.0, None)
    assert link_text(watch.longest()) == SILENT


def test_times_while_the_core_was_silent_are_unknown():
    watch = Watch()
    watch.pass_time(5.0)
    watch.mono += 60.0
    watch.heard = watch.mono
    watch.pass_time(3.0)
    assert watch.longest() <= 1.1


def test_a_robot_that_left_is_forgotten():
    watch = Watch()
    watch.pass_time(3.0)
    watch.links.observe(watch.mono + TICK_S, {})
    assert watch.links.longest_silence_s("mbot") is None
    assert link_text(None) == ""
