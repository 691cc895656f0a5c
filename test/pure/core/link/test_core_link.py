"""The box's view of the robot at the other end of a private channel: which messages are new, the skew of its clock."""

import random

import pytest

from helpers.box_driver import wire
from helpers.competition import UTC0
from roah_rsbb.core.link.freshness import QUIET_S, Freshness, Timeline
from roah_rsbb.core.link.link import BAD_S, HERE_S, OLD_REPORTED, REMEMBER_S, SILENT_S, RobotLink
from roah_rsbb.core.link.skew import MAX_SAMPLES, WINDOW_S, SkewEstimate, within
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


def test_nothing_is_known_before_the_first_sample():
    estimate = SkewEstimate()
    assert (estimate.seconds, estimate.count) == (None, 0)
    assert not within(estimate.seconds, 1e9)


@pytest.mark.parametrize("true_skew", [-0.15, -0.05, 0.0, 0.05, 0.15])
@pytest.mark.parametrize("seed", range(5))
def test_delays_of_most_messages_do_not_matter(true_skew, seed):
    rng = random.Random(seed)
    estimate = SkewEstimate()
    for i in range(20):
        delay = 0.001 if i % 3 == 0 else rng.uniform(0.001, 0.4)
        estimate.sample(i * 0.5, true_skew - delay)
        if i >= 5:
            assert estimate.seconds == pytest.approx(true_skew, abs=0.002)


@pytest.mark.parametrize("before, samples, estimates", [
    # A clock that was put right, or put back in a silence, is believed after the window.
    ([(second, 0.5) for second in range(10)], [(10 + i, 0.0) for i in range(5)], [0.5, 0.5, 0.0, 0.0, 0.0]),
    ([(0.0, 0.5)], [(10.0 + i, 0.0) for i in range(4)], [0.5, 0.5, 0.5, 0.0]),
    # The first message after a silence may have been late.
    ([(0.0, 0.01)], [(10.0, -2.1), (10.1, 0.01)], [0.01, 0.01]),
    # One who seldom says something is believed, too.
    ([], [(3.0 * i, -float(i)) for i in range(4)], [0.0, 0.0, -1.0, -2.0]),
])
def test_the_estimate_follows_the_clock_and_no_delay(before, samples, estimates):
    assert WINDOW_S == 2.5
    estimate = SkewEstimate()
    for sample in before:
        estimate.sample(*sample)
    assert [estimate.sample(*sample) for sample in samples] == estimates


def test_a_flood_of_samples_does_not_grow_anything():
    estimate = SkewEstimate()
    for i in range(10_000):
        estimate.sample(i * 1e-5, 0.0)
    assert estimate.count == MAX_SAMPLES


def test_all_is_forgotten_when_a_clock_was_set():
    estimate = SkewEstimate()
    estimate.sample(0.0, 5.0)
    estimate.restart()
    assert (estimate.seconds, estimate.count) == (None, 0)
    assert estimate.sample(0.1, -0.2) == -0.2


@pytest.mark.parametrize("skew, is_within", [
    (0.0, True), (0.0999, True), (-0.0999, True), (0.1, False), (-0.1, False), (0.15, False), (-0.15, False),
    (9.2e18, False), (-9.2e18, False),
])
def test_only_a_skew_below_the_allowed_one_will_do_in_both_directions(skew, is_within):
    assert within(skew, 0.1) is is_within


@pytest.mark.parametrize("seed", range(20))
def test_the_estimate_is_always_the_largest_sample_of_the_window(seed):
    chance, estimate, mono, samples = random.Random(seed), SkewEstimate(), 0.0, []
    for _ in range(500):
        mono += chance.choice([0.0, 0.05, 0.05, 1.0, 2.5, 3.0])
        skew = chance.choice([-0.1, 0.0, 0.1, chance.uniform(-1.0, 1.0)])
        late = [(mono, samples[-1][1])] if samples and samples[-1][0] < mono - WINDOW_S else []
        samples = [*(one for one in samples if one[0] >= mono - WINDOW_S), *late, (mono, skew)][-MAX_SAMPLES:]
        assert estimate.sample(mono, skew) == max(one for _, one in samples)
        assert estimate.count == len(samples)


S = 1_000_000_000
T0 = 1_800_000_000 * S


def _judged(*messages):
    """Verdicts of messages (moment of arrival in s, time in s after T0)."""
    timeline = Timeline()
    return [timeline.judge(mono, T0 + round(time * S)).value for mono, time in messages]


def test_rising_times_are_fresh_however_close():
    timeline = Timeline()
    assert [timeline.judge(0.0, T0 + ns) for ns in range(3)] == [Freshness.FRESH] * 3


@pytest.mark.parametrize("messages, verdicts", [
    ([(0, 0), (0, 0), (1, 1), (1, 0.5), (1, 0), (1, 1), (2, 2)],
     ["fresh", "duplicate", "fresh", "stale", "stale", "duplicate", "fresh"]),
    ([(0, 0), (1, 1), (2, -3600), (3, -3599), (4, -3598), (5, -3597)],
     ["fresh", "fresh", "stale", "stale", "clock set back", "fresh"]),
    # A burst is not believed before the old timeline was quiet.
    ([(0, 0), *((1 + i / 20, -100 + i / 20) for i in range(30))], ["fresh", *["stale"] * 30]),
    ([(0, 0), *((QUIET_S + i / 20, -100 + i / 20) for i in range(3))], ["fresh", "stale", "stale", "clock set back"]),
    # Times in falling order: a network that overtakes.
    ([(0, 0), *((3 + i, -1 - i) for i in range(20))], ["fresh", *["stale"] * 20]),
    # 0.95 was overtaken by 1, then the clock is set back by an hour: that does not lock the robot out.
    ([(0, 0), (1, 1), (1.01, 0.95), (2, -3598), (3, -3597), (4, -3596), (5, -3595)],
     ["fresh", "fresh", "stale", "stale", "stale", "clock set back", "fresh"]),
    # A network doubles everything.
    ([(mono + i / 100, time) for mono, time in ((0, 0), (1, 1), (2, -10), (3, -9), (4, -8), (5, -7)) for i in (0, 1)],
     [*["fresh", "duplicate"] * 2, *["stale", "duplicate"] * 2, "clock set back", "duplicate", "fresh", "duplicate"]),
])
def test_doubled_and_overtaken_messages_and_a_clock_that_was_set_back(messages, verdicts):
    assert _judged(*messages) == verdicts


def test_one_old_message_repeated_does_not_start_a_timeline():
    assert set(_judged((0, 0), *[(3 + i, -5) for i in range(20)])[1:]) <= {"stale", "duplicate"}


@pytest.mark.parametrize("seed", range(20))
def test_a_clock_set_back_is_found_on_a_network_that_doubles_and_swaps(seed):
    rng = random.Random(seed)
    sent = [(0.05 * i, 0.05 * i) for i in range(40)]  # until 2 s
    sent += [(2 + 0.5 * i, -1000 + 0.5 * i) for i in range(40)]
    arrived = sorted((mono + rng.uniform(0, 0.7), time) for mono, time in sent for _ in range(rng.randint(1, 2)))
    verdicts = _judged(*arrived)
    assert verdicts.count("clock set back") == 1
    assert arrived[verdicts.index("clock set back")][0] < 2 + QUIET_S + 6


@pytest.mark.parametrize("seed", range(20))
def test_recorded_messages_have_no_chance_while_the_robot_lives(seed):
    """The robot sends every second and loses one now and then; meanwhile its old messages are played again."""
    rng = random.Random(seed)
    old = [-1000 + i / 10 for i in range(1000)]
    lives = [(i, i) for i in range(100) if i % 3 or rng.random() < 0.5]
    replays = [(0.1 + i / 10, time) for i, time in enumerate(old)]
    verdicts = dict(zip(sorted(lives + replays), _judged(*sorted(lives + replays))))
    assert {verdicts[message] for message in lives} == {"fresh"}
    assert {verdicts[message] for message in replays if message[0] > lives[0][0]} == {"stale"}


@pytest.mark.parametrize("absurd", [2**63 - 1, -(2**63), 0, 2**32 * S, (2**63 - 1) * S + 2**63 - 1])
def test_one_absurd_time_does_not_lock_the_robot_out(absurd):
    timeline = Timeline()
    timeline.judge(0.0, T0)
    timeline.judge(1.0, absurd)
    verdicts = [timeline.judge(float(mono), T0 + mono * S) for mono in range(2, 10)]
    assert verdicts[-1] is Freshness.FRESH
    assert verdicts.count(Freshness.STALE) <= 3
