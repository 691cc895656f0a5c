"""The link record: which datagrams are counted; of real robots, too: the original client, and ours on a bad network."""

import random

import pytest

from helpers.box_driver import BoxDriver, wire
from helpers.competition import UTC0, competition, event
from helpers.examples import few
from helpers.golden import PASSWORD, SESSIONS, load
from helpers.linked_world import PUBLIC_PORT, FakeLink, World
from roah_rsbb.comm.ciphers import Key
from roah_rsbb.comm.frame import decode_private
from roah_rsbb.core.link.link import RobotLink
from roah_rsbb.core.link.record import skipped_states
from roah_rsbb.model.as_json import from_json, to_json
from roah_rsbb.model.clock import Now
from roah_rsbb.model.messages import LinkSample, RobotReport
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.protocol import BURST_COUNT, BURST_INTERVAL_S, BoxState, RobotState, sent_after_change, wire_seconds
from roah_rsbb.radio import wire_convert

OPENED = Now(100.0, UTC0)
# As the original client does; ours sends one more.
BURST = [0.4] + [BURST_INTERVAL_S] * (BURST_COUNT - 1)


class Line:
    """A link, and a robot that sends what the test wants, when the test wants it."""

    def __init__(self):
        self.now = OPENED
        self.skew = 0.0
        self.state = RobotState.STOP
        self.link = RobotLink(0.1, OPENED)

    def sends(self, after=1.0, state=None, late=0.0, time=None, arrives=True, **fields):
        """The robot sends `after` seconds from the last time; the message arrives `late` seconds after that."""
        self.now = self.now.later(after)
        self.state = self.state if state is None else state
        report = RobotReport(wire(self.now.utc + self.skew) if time is None else time, 1, self.state, **fields)
        if arrives:
            self.link.hear(self.now.later(late), "10.0.0.2", report)
        return report

    def sends_all(self, intervals, state=None, lost=(), **fields):
        """The robot sends several, in these intervals; those with a number in `lost` do not arrive."""
        for number, interval in enumerate(intervals):
            self.sends(interval, state, arrives=number not in lost, **fields)

    def says(self, state):
        self.link.record.box_says(self.now, state)

    def sample(self, unreadable=0, after=0.0):
        self.now = self.now.later(after)
        return self.link.sample(self.now, unreadable)


@pytest.fixture
def line():
    return Line()


def bursting(line):
    """The robot was heard to send a whole burst, and a regular message after it."""
    line.sends()
    line.sends_all(BURST, RobotState.PREPARING)
    line.sends()
    assert line.sample().lost == 0
    return line


def test_before_the_first_message_only_the_gap_grows(line):
    assert line.sample(after=1.0) == LinkSample(1.0, gap_s=1.0)
    assert line.sample(after=1.0) == LinkSample(1.0, gap_s=2.0)


def test_a_second_of_a_good_link(line):
    line.sends()
    line.sample()
    line.sends(1.0, late=0.0)
    assert line.sample(after=0.0) == LinkSample(1.0, received=1, gap_s=1.0, skew_s=0.0, host="10.0.0.2")


def test_each_sample_starts_from_zero(line):
    line.sends_all([1.0, 3.0])
    line.sample()
    assert line.sample(after=1.0) == LinkSample(1.0, gap_s=1.0, skew_s=0.0, host="10.0.0.2")


@pytest.mark.parametrize(("passed", "lost"), [(0.2, 0), (1.0, 0), (1.4, 0), (2.0, 1), (2.1, 1), (5.3, 4)])
def test_regular_messages_that_are_missing(line, passed, lost):
    line.sends()
    line.sends(passed)
    assert line.sample().lost == lost


def test_the_robots_clock_distinguishes_lost_from_late(line):
    """Three messages wait in a radio and come at once: nothing is lost."""
    line.sends()
    for late in (2.0, 1.0, 0.0):
        line.sends(late=late)
    sample = line.sample()
    assert (sample.lost, sample.received, sample.gap_s) == (0, 4, 3.0)
    assert sample.late_s == pytest.approx(2.0)  # measured with what was known before the silence
    line.sends(late=0.8)
    assert line.sample().late_s == pytest.approx(0.8)


@pytest.mark.parametrize("burst, lost, then, missed", [
    (BURST, (2, 3, 7), 1.0, 3), (BURST, (0, 1), 1.0, 2),
    ([*BURST, BURST_INTERVAL_S], (4, 5), 1.0, 1),  # one more makes up for one that was lost
    (BURST, (7, 8, 9), 2.0, 4),  # its end, and a regular one
    (BURST, range(1, 10), 1.1, 9),  # the next regular one is due a second after the burst, not after what was heard
    ([i * 1.4 for i in BURST], (), 1.0, 0),  # a slow one is whole
])
def test_what_is_missed_of_a_burst(line, burst, lost, then, missed):
    bursting(line)
    line.sends_all(burst, RobotState.WAITING_GOAL, lost=lost)
    before = line.sample().lost
    assert before == 0 or burst is not BURST, "the next ones may still come"
    line.sends(then)
    assert before + line.sample().lost == missed


def test_a_burst_that_is_cut_short_by_the_next_change(line):
    bursting(line)
    line.sends_all(BURST[:5], RobotState.WAITING_GOAL)
    line.sends_all([0.05], RobotState.EXECUTING)
    assert line.sample().lost == 0
    line.sends_all(BURST[1:], RobotState.EXECUTING)
    line.sends()
    line.sends_all(BURST, RobotState.RESULT_TX, lost=range(1, 10))
    line.sends_all([0.01], RobotState.PREPARING)
    assert line.sample().lost == 7, "of the 9 whose intervals might have been longer"


def test_a_robot_that_never_sends_bursts_has_none_to_lose(line):
    line.sends()
    for state in (RobotState.PREPARING, RobotState.WAITING_GOAL, RobotState.EXECUTING):
        line.sends(0.3, state)
        line.sends_all([0.2] * 4)
    line.sends_all([1.0] * 3)
    assert line.sample().lost == 0


def test_overtaken_and_repeated_messages(line):
    line.sends()
    held = line.sends(arrives=False)
    last = line.sends()
    line.link.hear(line.now, "10.0.0.2", held)
    line.link.hear(line.now, "10.0.0.2", last)
    line.link.hear(line.now, "10.0.0.2", last)
    sample = line.sample()
    assert (sample.received, sample.lost, sample.stale, sample.duplicates) == (2, 1, 1, 2)


def test_unreadable_datagrams_since_the_last_sample(line):
    assert line.sample(unreadable=3).unreadable == 3
    assert line.sample(unreadable=3).unreadable == 0
    assert line.sample(unreadable=7).unreadable == 4
    assert line.sample(unreadable=0).unreadable == 0


def test_a_gap_is_reported_whole(line):
    line.sends()
    line.sample()
    assert line.sample(after=2.0).gap_s == 2.0
    line.sends(1.5)
    line.sends(0.2)
    sample = line.sample()
    assert (sample.gap_s, sample.lost) == (3.5, 3)


@pytest.mark.parametrize("skew", [-3600.0, 3600.0, 1e9])
def test_a_clock_that_is_set_loses_nothing(line, skew):
    line.sends_all([1.0] * 4)
    line.skew = skew
    line.sends_all([1.0] * 6)
    sample = line.sample()
    assert sample.lost <= 3  # those that were needed to believe it
    line.sends_all([1.0] * 3)
    assert line.sample().lost == 0


def test_losses_while_a_clock_is_set_follow_from_the_boxs_clock(line):
    line.sends_all([1.0] * 4)
    line.sample()
    line.skew = 3600.0
    line.sends(3.0)
    assert line.sample().lost == 2


def test_an_absurd_time_of_the_first_messages_is_not_believed(line):
    line.sends(time=(-(2**63), 0))
    line.sends(time=(2**63 - 1, 999))
    assert line.sample().lost <= 6


def test_skew_and_its_bounds(line):
    line.skew = 0.25
    line.sends(late=0.02)
    assert line.sample().skew_s == pytest.approx(0.23)
    line.says(BoxState.PREPARE)
    line.sends(0.04, RobotState.PREPARING, late=0.02)
    sample = line.sample()
    assert sample.skew_s == pytest.approx(0.23)
    assert sample.skew_max_s == pytest.approx(0.29)


def test_round_trip_of_a_change_of_state(line):
    line.sends()
    line.says(BoxState.PREPARE)
    line.sends(0.02)
    assert line.sample().answers == 0
    line.sends(0.05, RobotState.PREPARING)
    line.says(BoxState.STOP)
    line.sends(0.3, RobotState.STOP)
    sample = line.sample()
    assert (sample.answers, sample.unanswered) == (2, 0)
    assert sample.skew_max_s == pytest.approx(0.07), "the closest bound of both"
    assert sample.round_trip_s == pytest.approx(0.07)
    assert sample.round_trip_max_s == pytest.approx(0.3)
    line.sends()
    assert line.sample().round_trip_s is None


@pytest.mark.parametrize(("seconds", "sent"), [
    (-0.2, 0), (0.0, 1), (0.06, 2), (0.49, 10), (0.5, 11), (1.4, 11), (1.6, 12), (10.6, 21),
])
def test_what_the_box_sends_by_its_rules(seconds, sent):
    assert sent_after_change(seconds) == sent


@pytest.mark.parametrize(("box", "robot"), [
    (BoxState.STOP, RobotState.STOP), (BoxState.PREPARE, RobotState.EXECUTING),
    (BoxState.PREPARE, RobotState.WAITING_GOAL), (BoxState.WAITING_RESULT, RobotState.EXECUTING),
])
def test_what_a_robot_need_not_react_to(line, box, robot):
    line.sends(state=robot)
    line.says(box)
    line.sends_all([1.0] * 4)
    line.sends(state=RobotState.STOP)
    line.sends(state=RobotState.PREPARING)
    sample = line.sample()
    assert (sample.answers, sample.unanswered) == (0, 0)


def test_datagrams_of_the_box_that_the_robot_does_not_know_of(line):
    line.sends()
    line.says(BoxState.PREPARE)
    line.sends(0.4)
    assert line.sample().unanswered == 0, "perhaps it only thinks"
    line.sends(0.32)
    assert line.sample().unanswered == 5  # at 0, 50, 100, 150 and 200 ms, half a second ago or more
    line.sends(1.5)
    assert line.sample().unanswered == 11 + 1 - 5
    line.sends(0.1, RobotState.PREPARING)
    sample = line.sample()
    assert (sample.answers, sample.unanswered) == (1, 0)
    assert sample.round_trip_s == pytest.approx(2.32)


def test_a_repeated_state_is_not_a_new_question(line):
    line.sends()
    line.says(BoxState.PREPARE)
    line.sends(0.3)
    line.says(BoxState.PREPARE)
    line.sends(0.1, RobotState.PREPARING)
    assert line.sample().round_trip_s == pytest.approx(0.4)


def test_round_trip_of_an_acknowledgement(line):
    line.sends()
    line.sends(0.5, notifications=("a",))
    line.sends(0.05, notifications=("a",))
    line.sends(0.03)
    sample = line.sample()
    assert (sample.answers, sample.unanswered) == (1, 0)
    assert sample.round_trip_s == pytest.approx(0.08)


def test_acknowledgements_that_were_lost(line):
    line.sends()
    line.sends_all(BURST, notifications=("a",))
    line.sends(0.26, notifications=("a",))
    assert line.sample().unanswered == 5  # at 0, 50, 100, 150 and 200 ms, half a second ago or more
    line.sends(0.02)
    assert line.sample().round_trip_s == pytest.approx(0.73)


def test_a_string_that_was_added_while_another_waits_is_not_measured(line):
    """If several messages acknowledged both strings, the time of the first acknowledgement is unknown."""
    line.sends()
    line.sends(notifications=("a",))
    line.sends(0.1, notifications=("a", "b"))
    line.sends(0.1, visitor=("b",), notifications=("b",))
    assert line.sample().answers == 1
    line.sends(0.1, notifications=("b",))
    line.sends(0.1)
    assert line.sample().answers == 0
    line.sends(notifications=("c",))
    line.sends(0.1)
    assert line.sample().answers == 1


def test_strings_dropped_with_a_change_of_state_are_not_an_answer(line):
    line.sends(state=RobotState.EXECUTING)
    line.sends(notifications=("a",))
    line.sends(0.001, RobotState.STOP)
    assert line.sample().answers == 0


@pytest.mark.long
def test_a_robot_that_repeats_for_ever_grows_nothing(line):
    for i in range(3000):
        line.sends(0.001, notifications=("a", str(i)))
    assert len(line.link.record._acknowledged) <= 64


def test_strings_from_before_the_boxs_clock_was_set(line):
    line.sends(notifications=("a",))
    line.link.restart_skew()
    line.sends(0.1)
    assert line.sample().answers == 0


def test_the_boxs_clock_was_set(line):
    line.sends()
    line.says(BoxState.PREPARE)
    line.now = line.now._replace(utc=line.now.utc + 100.0)
    line.link.restart_skew()
    line.sends(0.1, RobotState.PREPARING)
    sample = line.sample()
    assert (sample.answers, sample.skew_max_s) == (0, None)


@pytest.mark.parametrize(("before", "state", "skipped"), [
    (RobotState.STOP, RobotState.PREPARING, 0), (RobotState.STOP, RobotState.EXECUTING, 2),
    (RobotState.PREPARING, RobotState.RESULT_TX, 2), (RobotState.EXECUTING, RobotState.STOP, 0),
    (RobotState.EXECUTING, RobotState.PREPARING, 0), (RobotState.RESULT_TX, RobotState.WAITING_GOAL, 1),
    (RobotState.EXECUTING, RobotState.EXECUTING, 0), (RobotState.RESULT_TX, RobotState.PREPARING, 0),
])
def test_states_that_were_not_heard_of(before, state, skipped):
    assert skipped_states(before, state) == skipped


def test_skipped_states_are_in_the_sample(line):
    line.sends()
    line.sends(state=RobotState.EXECUTING)
    line.sends(state=RobotState.RESULT_TX)
    line.sends(state=RobotState.WAITING_GOAL)
    assert line.sample().skipped_states == 3


def test_a_sample_is_kept_as_little_text(line):
    line.sends()
    line.sample()
    line.sends()
    sample = line.sample()
    assert to_json(sample) == {"seconds": 1.0, "received": 1, "gap_s": 1.0, "skew_s": 0.0, "host": "10.0.0.2"}
    assert from_json(LinkSample, to_json(sample)) == sample


def test_the_box_takes_samples_of_all_runs():
    driver = BoxDriver()
    assert driver.box.zones.link_samples(driver.now, {}) == ()
    robot = driver.executing()
    [(port, sample)] = driver.box.zones.link_samples(driver.now, {robot.port: 2, 1: 5})
    assert (port, sample.unreadable, sample.host) == (robot.port, 2, robot.host)
    assert sample.answers == 2, "to PREPARE and to WAITING_RESULT"
    driver.command("stop")
    robot.says(RobotState.STOP, after=0.2)
    [(_, sample)] = driver.box.zones.link_samples(driver.now, {})
    assert (sample.answers, sample.round_trip_s) == (1, pytest.approx(0.2))


class CountingWorld(World):
    """A world that records lost and delivered datagrams on private channels in each direction."""

    def __init__(self, link):
        config = competition(teams=["Alpha"], tbm=[event("HGTKMH", team="Alpha", timeout=600.0)])
        super().__init__(config, link)
        self.to_box = self.to_robot = 0
        self.lost_to_box = self.lost_to_robot = 0
        self.samples = []
        self.deaf = False  # nothing reaches the robot on its private channel

    def _send(self, deliver, *arguments):
        before = len(self._air)
        if not (self.deaf and deliver == self._at_robot and arguments[1] != PUBLIC_PORT):
            super()._send(deliver, *arguments)
        lost = len(self._air) == before
        if arguments[1] == PUBLIC_PORT:
            return
        if deliver == self._at_box:
            self.to_box += 1
            self.lost_to_box += lost
        else:
            self.to_robot += 1
            self.lost_to_robot += lost

    def runs(self, times):
        """A robot that starts, executes and completes this many times, and sometimes sends strings."""
        robot = self.add_robot(skew=0.05, prepare_s=2.0, execute_s=10.0)
        self.press("connect")
        for _ in range(times):
            self.press("start")
            for second in range(18):
                if second == 8 and robot.session.link is not None:
                    robot.session.add_string("notifications", f"at {self.mono}")
                self.run(1.0)
                self.samples += [sample for _, sample in self.box.box.zones.link_samples(self.box.now, {})]
        return self

    def total(self, field):
        """The sum of a field of all samples."""
        return sum(getattr(sample, field) for sample in self.samples)


@pytest.mark.long
def test_an_undisturbed_link_has_no_losses():
    world = CountingWorld(FakeLink(random.Random(1), jitter=False)).runs(5)
    for field in ("lost", "unanswered", "stale", "duplicates", "skipped_states"):
        assert world.total(field) == 0
    assert world.total("received") == world.to_box
    assert world.total("answers") >= 3 * 5
    assert max(s.round_trip_max_s for s in world.samples if s.round_trip_max_s) < 0.1
    assert min(s.round_trip_s for s in world.samples if s.round_trip_s) < 0.01
    bounds = [(s.skew_s, s.skew_max_s) for s in world.samples if s.skew_max_s is not None]
    assert all(low <= 0.05 <= high + 1e-6 for low, high in bounds)
    assert min(high - low for low, high in bounds) < 0.01


@pytest.mark.long
@pytest.mark.parametrize("seed", range(few(3)))
@pytest.mark.parametrize("loss", [0.1, 0.3])
def test_recorded_losses_never_exceed_the_real_ones(seed, loss):
    world = CountingWorld(FakeLink(random.Random(seed), loss=loss)).runs(5)
    assert 0.3 * world.lost_to_box < world.total("lost") <= world.lost_to_box
    assert world.total("unanswered") <= world.lost_to_robot


def test_a_robot_that_hears_nothing_answers_nothing():
    world = CountingWorld(FakeLink(random.Random(1))).runs(1)
    world.press("start")
    world.run(0.5)
    answers, lost = world.total("answers"), world.lost_to_robot
    world.deaf = True
    world.run(4.0)
    world.box.command("stop")
    world.run(5.0)
    world.samples = [sample for _, sample in world.box.box.zones.link_samples(world.box.now, {})]
    assert world.total("answers") <= 1
    assert answers > 0
    assert 11 <= world.total("unanswered") <= world.lost_to_robot - lost


@pytest.mark.long
@pytest.mark.parametrize("seed", range(few(3)))
def test_late_and_duplicate_datagrams_are_not_losses(seed):
    world = CountingWorld(FakeLink(random.Random(seed), double=0.3, late=0.2, longest_delay=0.3)).runs(4)
    assert world.total("duplicates") + world.total("stale") == world.stale
    assert world.total("lost") <= world.total("stale")
    assert max(s.late_s for s in world.samples) > 0.1
    assert world.total("unanswered") == 0


@pytest.mark.parametrize("name", SESSIONS)
def test_the_original_client_lost_nothing(name):
    """The sessions were recorded on one machine, so any loss in their record would be false."""
    records = [r for r in load(name) if r["dport"] != PUBLIC_PORT]
    key, link = Key(PASSWORD), None
    for record in records:
        message = decode_private(bytes.fromhex(record["hex"]), key)
        if isinstance(message, pb.RobotState):
            report = wire_convert.report_of(message)
            if link is None:
                offset = wire_seconds(report.time) - record["t_rel"]
                link = RobotLink(0.1, Now(record["t_rel"], offset + record["t_rel"]))
            link.hear(Now(record["t_rel"], offset + record["t_rel"]), "10.99.0.2", report)
        elif link is not None:
            link.record.box_says(Now(record["t_rel"], offset + record["t_rel"]), BoxState(message.benchmark_state))
    sample = link.sample(Now(records[-1]["t_rel"], 0.0), 0)
    assert sample.received > 20
    assert (sample.lost, sample.skipped_states) == (0, 0)
    assert sample.answers >= 3
    assert sample.round_trip_max_s < 0.25, "the original box sent every 0.2 s"
