"""A box is cut off at random moments while a referee enters scores, and its standby takes over.

Box, journal, copy and both ends of the pair are the real ones. The link, the disks and the clocks are simulated, so a
test of many seconds takes little time, and always happens in the same way: the number of the test is its seed.
"""

import heapq
import itertools
import random
from dataclasses import replace

import pytest

from helpers.box_driver import beacon_bytes
from helpers.competition import competition, event
from helpers.examples import ALL
from helpers.journaled import NO_LISTENING, JournaledDriver
from roah_rsbb.box import journal as core_journal
from roah_rsbb.box.standby_answers import StandbyAnswers
from roah_rsbb.core import effects
from roah_rsbb.core.box import Box
from roah_rsbb.core.copies import STANDBY, SYNC_S, CopyReport
from roah_rsbb.journal import epochs
from roah_rsbb.journal.contents import FIRST
from roah_rsbb.journal.copy_folder import CannotWriteCopy
from roah_rsbb.journal.copy_follower import PERIOD_S, RETRY_S, Follower
from roah_rsbb.journal.log_dir import JOURNAL, CoreSession, Resume
from roah_rsbb.journal.store import Journal
from roah_rsbb.model.reason import Refused, RunName
from roah_rsbb.model.scoring import ScoreKind
from roah_rsbb.rulebook.benchmarks import Durable
from roah_rsbb.scoring.sheet import Mark
from roah_rsbb.standby.channel import TIMEOUT_S, decode, encode
from roah_rsbb.standby.pair import Claim, Side, State
from roah_rsbb.standby.remote import Receiver, RemoteCopy

# Half of them with `durable: two`. `make test` makes four.
CUTS = 200
# What a cut may cost without it.
LOST_S = 0.2
# Two boxes that send to one robot.
BOTH_S = 1.0
PAIR = "pair"
ZONE = "tbm"
LOOK_S = 0.05


class BoxLost(Exception):
    """The computer of the box burns."""


class World:
    """Two computers, their link, a robot and a referee. `are_two`: the standby must have what is confirmed."""

    def __init__(self, folder, seed, are_two):
        self.random = random.Random(seed)
        self.are_two = are_two
        self.config = replace(competition(tbm=[event("HCFGAC", timeout=300.0)]),
                              durable=Durable.TWO if are_two else Durable.ONE)
        self.driver = JournaledDriver(folder / "box", self.config, NO_LISTENING)
        self.far = folder / "far"
        self.far.mkdir()
        self.receiver = Receiver(str(self.far))
        self.follower = Follower(str(folder / "box" / "0"), self.open_copy, now=lambda: self.mono,
                                 on_answer=lambda number: self.later(self.ros_s(), self.answers.on_answer, number))
        self.box.copies.expect(self.driver.now, STANDBY)
        self.answers = StandbyAnswers(self, self.box, lambda: self.driver.now, self.driver.event, lambda ticket:
                                      self.later(self.ros_s(), self.ask_follower, ticket, is_of_core=False),
                                      lambda: self.driver.journal.committed)
        self.robot = self.driver.executing(ZONE)
        self.run = RunName(ZONE, self.driver.run_in(ZONE).identity)
        self.item = next(item for item in self.driver.run_in(ZONE).event.benchmark.scoring
                         if item.kind is ScoreKind.UINT)
        self.plan, self.numbers = [], itertools.count()
        self.burns_at = self.hangs_until = float("inf")
        self.burns_after_mark = False
        self.is_hanging = self.is_cut = self.was_interrupted = self.has_taken_over = False
        self.is_copying = self.is_asked = False
        self.copy_number = 0
        self.entered, self.confirmed, self.warned = {}, set(), set()  # marks, which are numbers from 1
        self.claims = {Side.BOX: Claim(FIRST, 0, {}), Side.STANDBY: None}
        self.claims[Side.BOX].use({PAIR: Side.BOX})
        self.lost_in_a_row, self.both_since = dict.fromkeys(Side, 0), None
        for step in (self.report, self.look):
            self.later(0.0, step)
        self.later(0.0, self.copy, 0, is_of_core=False)
        self.later(1.0, self.enter)

    @property
    def box(self):
        return self.driver.box

    @property
    def mono(self):
        return self.driver.now.mono

    def ros_s(self):
        """How long a message between two nodes takes."""
        return self.random.uniform(0.0005, 0.01)

    def close(self):
        self.follower.close()
        self.receiver.close()
        self.driver.journal.close()

    # -- time -----------------------------------------------------------------------------------------

    def later(self, seconds, step, *arguments, is_of_core=True):
        """Plan a step. Those of the core wait while it hangs."""
        heapq.heappush(self.plan, (self.mono + seconds, next(self.numbers), is_of_core, step, arguments))

    def call_later(self, seconds, step, *arguments):
        """The core's loop."""
        self.later(seconds, step, *arguments)

    def pass_time(self, seconds):
        """Let time pass. Steps that take time, such as a request to the standby, call this, too."""
        end = self.mono + seconds
        while self.plan and self.plan[0][0] <= min(end, self.burns_at):
            mono, _, is_of_core, step, arguments = heapq.heappop(self.plan)
            self.advance_to(mono)
            if self.is_hanging and is_of_core:
                self.later(self.hangs_until - self.mono + 0.001, step, *arguments)
            else:
                step(*arguments)
        self.advance_to(min(end, self.burns_at))
        if self.mono >= self.burns_at:
            raise BoxLost

    def advance_to(self, mono):
        (self.driver.jump if self.is_hanging else self.driver.run)(max(0.0, mono - self.mono))

    # -- the copy -------------------------------------------------------------------------------------

    def open_copy(self):
        self.check_link()
        return RemoteCopy(self.exchange, lambda: self.mono)

    def check_link(self):
        if self.is_cut or self.has_taken_over:
            raise CannotWriteCopy("the standby is not connected")

    def exchange(self, message):
        """A message to the standby, its disk, and the answer. Each can be the last."""
        for way in (lambda: decode(encode(message)), lambda: self.receiver.answer(decode(encode(message)))):
            answer = way()
            self.pass_time(self.random.choice((0.001, 0.01, 0.03)))
            if self.is_cut:
                self.pass_time(TIMEOUT_S)
            self.check_link()
        return answer

    def ask_follower(self, number):
        self.follower.ask(number)
        self.is_asked = True
        if not self.is_copying and not self.follower.progress.trouble:
            self.copy_number += 1
            self.copy(self.copy_number)

    def copy(self, number):
        """What the thread of the follower does."""
        if number != self.copy_number:
            return  # a question woke it before
        self.is_copying, self.is_asked = True, False
        self.follower.step()
        self.is_copying = False
        wait_s = RETRY_S if self.follower.progress.trouble else 0.0 if self.is_asked else PERIOD_S
        self.later(wait_s, self.copy, number, is_of_core=False)

    def report(self):
        progress = self.follower.progress
        behind_s = 0.0 if progress.complete_mono is None else self.mono - progress.complete_mono
        self.driver.event(self.box.copies.report, CopyReport(
            STANDBY, True, behind_s, progress.missing_bytes, progress.trouble))
        self.answers.look()
        self.robot.saved += 1
        self.robot.send(self.robot.report())
        self.later(1.0, self.report)

    # -- the referee ----------------------------------------------------------------------------------

    def enter(self):
        """Count one more, and wait for the answer."""
        self.later(self.random.choice((0.02, 0.1, 0.4, 0.9)), self.enter)
        number = len(self.entered) + 1
        mark = Mark(self.item.group, self.item.desc, added="1", id=str(number), role="referee", device="tablet")
        try:
            self.driver.mark(self.run, mark, "Anna")
        except Refused as refused:
            assert self.box.authority.is_superseded, refused.reasons
            return
        self.entered[number] = self.mono
        if self.burns_after_mark:
            self.burns_after_mark = False
            self.burns_at = self.mono + self.random.uniform(0.0, 0.1)
        answer = self.answers.ask(self.driver.core_journal.ticket())
        if answer is not None:
            answer.add_done_callback(lambda answer: self.answered(number, answer.result()))

    def answered(self, number, why):
        if not self.is_hanging and self.mono < self.hangs_until:
            assert self.mono - self.entered[number] <= SYNC_S + 1e-6
        if not why:
            self.confirmed.add(number)
        else:
            assert any("standby" in text for text in self.box.warnings(self.driver.now)), "nobody was warned"
            self.warned.add(number)

    # -- the takeover ---------------------------------------------------------------------------------

    def take_over(self):
        """What the program `standby takeover` does; returns the value that the new box has."""
        self.receiver.close()
        self.has_taken_over = True
        standing = epochs.raise_epoch(str(self.far / JOURNAL), self.driver.now.utc, "standby")
        self.claims[Side.STANDBY] = Claim(standing.epoch, standing.cut, {PAIR: Side.STANDBY})
        now, troubles = self.driver.now, []
        session = CoreSession(now.utc, now.mono, "boot 2", 2, "uuid 2", "")
        journal = Journal(str(self.far), session, core_journal.competition(self.config), Resume.ALWAYS, troubles.append)
        try:
            box = Box(self.config, NO_LISTENING, beacon_bytes, journal.previous.last_port)
            saved, warnings = core_journal.saved_state(journal.previous, now, "boot 2")
            box.restart.resume(now, saved)
        finally:
            journal.close()
        assert not warnings and not any(troubles)
        record = box.scores.record_of(now, self.run)
        return next(item.value for item in record.items if (item.group, item.desc) == (self.item.group, self.item.desc))

    def look(self):
        """The words of both ends, and whom the robot hears."""
        self.later(LOOK_S, self.look, is_of_core=False)
        for side, claim in self.claims.items():
            if claim is not None and not (side is Side.BOX and self.is_hanging):
                for _, word in claim.tick(self.mono):
                    self.say(word)
        both = all(claim is not None and claim.state is State.ACTIVE for claim in self.claims.values())
        if not both or self.is_cut or self.is_hanging:
            self.both_since = None
        elif self.both_since is None:
            self.both_since = self.mono
        else:
            assert self.mono - self.both_since <= BOTH_S, "two boxes"

    def say(self, word):
        is_lost = self.random.random() < 0.3 and self.lost_in_a_row[word.side] < 2
        self.lost_in_a_row[word.side] = self.lost_in_a_row[word.side] + 1 if is_lost else 0
        if not is_lost and not self.is_cut:
            hearer = Side.STANDBY if word.side is Side.BOX else Side.BOX
            self.later(self.random.uniform(0.0, 0.2), self.hear, hearer, word, is_of_core=hearer is Side.BOX)

    def hear(self, side, word):
        claim = self.claims[side]
        answer = None if claim is None or self.is_cut else claim.hear(PAIR, word)
        if answer is not None:
            self.say(answer)
        if side is Side.BOX and claim.state is State.SUPERSEDED:
            self.driver.event(lambda now: self.box.authority.supersede(word.epoch, word.cut, "10.0.0.3"))


def pass_with_interruptions(world, seconds):
    """Let time pass, in which the cable of the standby may be pulled out for a while."""
    end = world.mono + seconds
    while world.are_two and world.random.random() < 0.4 and end - world.mono > 1.0:
        world.pass_time(world.random.uniform(0.0, 0.4 * (end - world.mono)))
        world.is_cut = world.was_interrupted = True
        world.pass_time(world.random.uniform(0.0, 0.6 * (end - world.mono)))
        world.is_cut = False
    world.pass_time(end - world.mono)


def lose_box(world, how):
    """Cut the box off, take over, and connect it again, if it still exists; returns the value that the new box has."""
    wait_s = world.random.choice((0.0, 0.5, 3.0, 8.0))
    if how == "burns":
        return world.take_over()
    if how == "hangs":
        world.is_hanging, world.hangs_until = True, world.mono + wait_s + world.random.uniform(0.1, 5.0)
    else:
        world.is_cut = True
    world.pass_time(wait_s)
    value = world.take_over()
    world.pass_time(max(0.0, world.hangs_until - world.mono) if how == "hangs" else world.random.uniform(0.0, 5.0))
    world.is_hanging = world.is_cut = False
    world.pass_time(3.0)
    assert world.box.authority.is_superseded
    assert world.claims[Side.STANDBY].state is State.ACTIVE
    return value


@pytest.mark.random
@pytest.mark.parametrize("are_two", [True, False], ids=("two", "one"))
@pytest.mark.parametrize("seed", range(CUTS // 2 if ALL else 2))
def test_a_cut_at_a_random_moment(tmp_path, seed, are_two):
    world = World(tmp_path, seed, are_two)
    how = world.random.choice(("burns", "burns", "is cut off", "hangs"))
    cut_s = world.random.uniform(1.5, 7.0)
    try:
        pass_with_interruptions(world, cut_s)
        if how == "burns":
            # Most cuts come while a mark is on its way: the other moments are dull.
            world.burns_after_mark = world.random.random() < 0.8
            world.burns_at = world.mono + world.random.uniform(1.0, 2.0)
            with pytest.raises(BoxLost):
                world.pass_time(2.0)
        cut_mono = world.mono
        value = lose_box(world, how)
    finally:
        world.close()
    print(f"seed {seed}: the box {how} after {len(world.entered)} marks, {len(world.confirmed)} of them confirmed")
    lost = {number: mono for number, mono in world.entered.items() if number > value}
    assert world.confirmed.isdisjoint(lost)
    if not are_two:
        assert all(mono >= cut_mono - LOST_S for mono in lost.values())
    else:
        assert world.confirmed or world.was_interrupted
    assert not world.driver.taken(effects.AnotherBox)
