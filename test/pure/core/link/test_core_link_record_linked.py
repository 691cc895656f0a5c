"""The link record of real robots: of the original client, as recorded, and of ours on a network that loses some."""

import random

import pytest

from helpers.competition import competition, event
from helpers.examples import few
from helpers.golden import PASSWORD, SESSIONS, load
from helpers.linked_world import PUBLIC_PORT, FakeLink, World
from roah_rsbb.comm.ciphers import Key
from roah_rsbb.comm.frame import decode_private
from roah_rsbb.core.link.link import RobotLink
from roah_rsbb.model.clock import Now
from roah_rsbb.pb import roah_rsbb_msgs_pb2 as pb
from roah_rsbb.protocol import BoxState, wire_seconds
from roah_rsbb.radio import wire_convert


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
                self.samples += [sample for _, sample in self.box.box.link_samples(self.box.now, {})]
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
    world.samples = [sample for _, sample in world.box.box.link_samples(world.box.now, {})]
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
