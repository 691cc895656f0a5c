"""The box's view of the robot at the other end of a private channel."""

import pytest

from helpers.box_driver import wire
from helpers.competition import UTC0
from roah_rsbb.core.link.link import BAD_S, HERE_S, OLD_REPORTED, REMEMBER_S, SILENT_S, RobotLink
from roah_rsbb.model.clock import Now
from roah_rsbb.model.messages import RobotReport
from roah_rsbb.protocol import RobotState

OPENED = Now(100.0, UTC0)
HOST = "10.0.0.2"


class Line:
    """A link, and a robot that sends to it."""

    def __init__(self, allowed_skew=0.1):
        self.now = OPENED
        self.link = RobotLink(allowed_skew, OPENED)

    def hear(self, after=1.0, skew=0.0, state=RobotState.STOP, saved=0, host=HOST, time=None):
        self.now = self.now.later(after)
        report = RobotReport(wire(self.now.utc + skew) if time is None else time, saved, state)
        return self.link.hear(self.now, host, report)

    def wait(self, seconds):
        self.now = self.now.later(seconds)
        return self.link.tick(self.now)

    @property
    def warnings(self):
        return self.link.warnings(self.now)


@pytest.fixture
def line():
    return Line()


def test_nothing_is_known_of_a_robot_that_has_not_answered(line):
    link = line.link
    assert (link.skew, link.times_valid, link.robot_state, link.host) == (None, False, None, None)
    assert link.messages_saved == 0


def test_the_first_message(line):
    heard = line.hear(state=RobotState.PREPARING, saved=7)
    assert heard == (True, True, True, ())
    link = line.link
    assert (link.robot_state, link.messages_saved, link.host, link.times_valid) == (
        RobotState.PREPARING, 7, HOST, True
    )
    assert line.hear(state=RobotState.PREPARING) == (True, False, False, ())
    assert line.hear(state=RobotState.STOP).state_changed


def test_a_stale_message_is_as_if_it_had_not_come(line):
    line.hear(state=RobotState.EXECUTING, saved=3)
    stale = line.hear(after=0.1, skew=-0.5, state=RobotState.STOP)
    assert stale == (False, False, False, ())
    link = line.link
    assert (link.robot_state, link.messages_saved, link.host) == (RobotState.EXECUTING, 3, HOST)
    assert link.last_heard == line.now.later(-0.1)
    assert link.skew == pytest.approx(0.0)


def test_a_robot_that_does_not_answer_is_reported_once(line):
    assert line.link.deadline() == OPENED.mono + SILENT_S
    assert line.wait(SILENT_S - 0.1) == []
    assert line.warnings == []
    assert line.wait(0.1) == ["Robot has not answered on the private channel yet"]
    assert line.link.deadline() is None
    assert line.wait(5) == []
    assert line.warnings == ["Robot has not answered on the private channel yet"]


def test_each_silence_is_reported_once(line):
    line.hear()
    assert line.link.deadline() == line.now.mono + SILENT_S
    assert line.wait(SILENT_S) == ["No message from the robot for 3 s"]
    assert line.wait(4) == []
    assert line.warnings == ["No message from the robot for 7 s"]
    line.hear()
    assert line.warnings == []
    assert line.wait(SILENT_S) == ["No message from the robot for 3 s"]


def test_a_stopped_clock_is_distinguished_from_silence(line):
    for _ in range(OLD_REPORTED + 1):
        line.hear(time=(12345, 0))
    assert "No message from the robot for 3 s but old ones: its clock was set back or stopped" in line.warnings[0]
    line.hear()
    assert not any("is stopped" in text for text in line.warnings)
    line.wait(SILENT_S)
    assert line.warnings[0] == "No message from the robot for 3 s"


@pytest.mark.parametrize("skew", [0.15, -0.15, 3600.0, 2.0**62])
def test_times_are_invalid_while_the_skew_is_out_of_bounds(line, skew):
    line.hear(skew=0.0)
    first = line.hear(skew=skew)
    # One message that seems late proves nothing; one that comes early does.
    assert line.link.times_valid is (skew < 0)
    said = list(first.notices)
    for _ in range(5):
        said += line.hear(skew=skew).notices
    assert not line.link.times_valid
    assert sum("times are invalid from here on" in text for text in said) == 1
    assert any("Robot's times are INVALID" in text and "synchronise" in text for text in line.warnings)
    said = []
    for _ in range(6):
        said += line.hear(skew=0.0).notices
    assert line.link.times_valid
    assert sum("times are valid again" in text for text in said) == 1


def test_a_bad_skew_from_the_first_message_on_is_reported(line):
    assert line.hear(skew=0.15).notices == ("Robot's times are invalid from here on: clock skew +0.150 s",)
    assert line.hear(skew=0.15).notices == ()


@pytest.mark.parametrize("skew, is_valid", [(0.125, False), (-0.125, False), (0.1249, True), (-0.1249, True)])
def test_times_are_valid_below_the_allowed_skew_only(skew, is_valid):
    line = Line(allowed_skew=0.125)  # exact in binary
    line.hear(skew=skew)
    assert line.link.times_valid is is_valid


def test_a_clock_that_jumps_forward(line):
    for _ in range(3):
        line.hear()
    assert any("jumped forward by 0.080" in text for text in line.hear(skew=0.08).notices) is False
    notices = line.hear(skew=3.0).notices
    assert notices[0].startswith("Robot's clock jumped forward by 2.9")
    assert line.link.skew == pytest.approx(3.0)
    assert any("jumped forward" in text for text in line.warnings)
    line.wait(REMEMBER_S + 0.1)
    assert not any("jumped forward" in text for text in line.warnings)


def test_a_first_message_that_was_late_does_not_make_a_jump_of_the_second(line):
    line.hear(skew=-0.5)
    assert not any("jumped" in text for text in line.hear(skew=0.0).notices)


def test_a_clock_that_was_set_back(line):
    for _ in range(3):
        line.hear(skew=+100)
    stale = [line.hear().fresh for _ in range(2)]
    heard = line.hear()
    assert stale == [False, False]
    assert heard.fresh
    assert heard.notices[0] == "Robot's clock was set back by 100.000 s"
    assert any("set back" in text for text in line.warnings)
    assert line.link.skew == pytest.approx(0)
    assert line.hear().fresh


def test_a_clock_that_was_set_back_to_times_that_were_heard_is_not_believed_until_it_is_right(line):
    line.hear()
    assert not any(line.hear(skew=-100).fresh for _ in range(50))
    assert "but old ones: its clock was set back or stopped, or somebody sends recordings" in line.warnings[0]
    assert line.hear().fresh
    assert line.warnings == []


def test_a_clock_that_is_corrected_by_little_is_heard_as_soon_as_it_shows_new_times(line):
    for _ in range(3):
        line.hear(after=0.1)
    assert [line.hear(after=0.1, skew=-0.3).fresh for _ in range(4)] == [False, False, False, True]


def test_a_clock_that_was_set_back_is_believed_from_the_robots_address_only(line):
    for _ in range(3):
        line.hear(skew=+100)
    assert not any(line.hear(host="10.0.0.9").fresh for _ in range(20))
    assert [line.hear().fresh for _ in range(3)] == [False, False, True]


def test_steps_of_the_boxs_clock_do_not_count_as_steps_of_the_robots(line):
    for _ in range(3):
        line.hear()
    line.now = line.now._replace(utc=line.now.utc - 50)
    line.link.restart_skew()
    assert (line.link.skew, line.link.times_valid) == (None, False)
    heard = line.hear(skew=50)
    assert heard.fresh
    assert not any("jumped" in text for text in heard.notices)


def test_another_address_is_reported_but_not_with_every_message(line):
    line.hear()
    said = []
    for i in range(10):
        heard = line.hear(after=HERE_S, host=f"10.0.0.{3 + i % 2}")
        assert heard.fresh and heard.new_host
        said += heard.notices
    assert said == ["Robot's address changed from 10.0.0.2 to 10.0.0.3"]
    assert line.warnings == ["Robot's address changed from 10.0.0.3 to 10.0.0.4"], "what is true now"
    line.wait(REMEMBER_S)
    assert line.warnings[1:] == [] and "address" not in line.warnings[0]
    assert line.hear(host=HOST).notices == ("Robot's address changed from 10.0.0.4 to 10.0.0.2",)


def test_a_robot_that_comes_back_with_another_address_is_no_rival_any_more(line):
    line.hear()
    assert line.hear(after=1.0, host="10.0.0.8").notices, "the robot may still be there"
    assert "also come from 10.0.0.8" in line.warnings[0]
    assert line.hear(after=HERE_S, host="10.0.0.8").fresh
    assert line.warnings == [f"Robot's address changed from {HOST} to 10.0.0.8"]
    (said,) = line.hear(after=0.5, host=HOST).notices
    assert "also come from 10.0.0.2" in said and "the robot is at 10.0.0.8" in said, "the earlier one is still on"


def test_while_the_robot_is_heard_nobody_else_counts_who_has_its_password(line):
    line.hear()
    said = []
    for _ in range(40):
        # Its clock is ahead: it would be the newer one every time.
        rival = line.hear(after=0.4, host="10.0.0.66", state=RobotState.RESULT_TX, saved=5, skew=3600.0)
        assert (rival.fresh, rival.new_host, rival.state_changed) == (False, False, False)
        said += rival.notices
        assert line.hear(after=0.4, saved=1).fresh
    assert (line.link.host, line.link.messages_saved, line.link.robot_state) == (HOST, 1, RobotState.STOP)
    assert line.link.times_valid
    assert len(said) == 2, "once in half a minute"
    assert "also come from 10.0.0.66" in said[0] and HOST in said[0]
    assert said[1] in line.warnings
    line.wait(REMEMBER_S + 1)
    assert said[1] not in line.warnings


def test_a_robot_that_has_another_address_is_heard_there_when_it_is_gone_here(line):
    line.hear()
    assert not line.hear(after=HERE_S - 0.1, host="10.0.0.3").fresh
    heard = line.hear(after=0.2, host="10.0.0.3")
    assert heard.fresh and heard.new_host
    assert line.link.host == "10.0.0.3"
    assert not line.hear(after=0.1, host=HOST).fresh


def test_what_cannot_be_read_matters_until_something_can(line):
    line.hear()
    line.link.on_bad_datagram(line.now, "10.0.0.2: wrong password?")
    assert line.warnings == ["10.0.0.2: wrong password?"]
    line.hear()
    assert line.warnings == []
    line.link.on_bad_datagram(line.now, "10.0.0.2: wrong password?")
    line.wait(BAD_S + 0.1)
    assert "10.0.0.2: wrong password?" not in line.warnings
