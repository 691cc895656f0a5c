"""Box and standby as two linked state machines in simulated time: never two boxes that hear each other."""

import heapq
import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st

from helpers.examples import examples
from roah_rsbb.standby.pair import (
    ASK_AGAIN_S,
    ASK_S,
    AWAY_S,
    SAY_S,
    BoxSilence,
    Claim,
    Side,
    State,
    Word,
    pair_name,
    seal,
    unseal,
)

STEP_S = 0.05
# Two boxes that hear each other are active at the same time for at most this long.
BOTH_S = 1.0
# Each end loses at most two words in a row, and they are delayed by at most this.
DELAY_S = 0.2
PAIR = "pair"


class Computer:
    """One end of a pair: what its journal says survives its restarts."""

    def __init__(self, side):
        self.side = side
        self.epoch, self.is_superseded = 1, False
        self.claim = None
        self.hung_since = None
        self.waiting = []  # words that came while it hung

    def start(self):
        self.hung_since, self.waiting = None, []
        self.claim = Claim(self.epoch, 0, {PAIR: self.side}, self.is_superseded)

    def take_over(self, known):
        """What the program `standby takeover` does."""
        self.epoch, self.is_superseded = known + 1, False
        self.start()

    @property
    def is_active(self):
        return self.claim is not None and self.claim.state is State.ACTIVE and self.hung_since is None

    def resume(self, now):
        """The first thing that a process does after it was stopped (`Fence.check`)."""
        if self.hung_since is not None and now - self.hung_since >= AWAY_S and self.claim is not None:
            self.claim.ask_again()
        self.hung_since = None

    @property
    def is_silent_for_good(self):
        return self.claim is not None and self.claim.state is State.SUPERSEDED

    def note(self):
        self.is_superseded = self.is_silent_for_good


class World:
    """Two computers, and the words on their ways."""

    def __init__(self, fates=()):
        self.now = 0.0
        self.box, self.standby = Computer(Side.BOX), Computer(Side.STANDBY)
        self.is_cut = {Side.BOX: False, Side.STANDBY: False}  # by the side that says
        self.fates = iter(fates)
        self.lost_in_a_row = dict.fromkeys(Side, 0)
        self.on_the_way = []
        self.numbers = itertools.count()
        self.both_since = None
        self.box.start()

    def other(self, side):
        return self.standby if side is Side.BOX else self.box

    def say(self, word):
        if self.is_cut[word.side]:
            return
        fate = next(self.fates, "")
        if fate == "lost" and self.lost_in_a_row[word.side] < 2:
            self.lost_in_a_row[word.side] += 1
            return
        self.lost_in_a_row[word.side] = 0
        for delay in {"late": (DELAY_S,), "doubled": (0.0, DELAY_S)}.get(fate, (0.0,)):
            heapq.heappush(self.on_the_way, (self.now + delay, next(self.numbers), word))

    def run(self, seconds):
        for _ in range(round(seconds / STEP_S)):
            self.now += STEP_S
            while self.on_the_way and self.on_the_way[0][0] <= self.now:
                word = heapq.heappop(self.on_the_way)[2]
                self.other(word.side).waiting.append(word)
            for computer in (self.box, self.standby):
                if computer.hung_since is None:
                    heard, computer.waiting = computer.waiting, []
                    for word in heard:
                        answer = computer.claim.hear(PAIR, word) if computer.claim is not None else None
                        if answer is not None:
                            self.say(answer)
                if computer.claim is not None and computer.hung_since is None:
                    for _, word in computer.claim.tick(self.now):
                        self.say(word)
                    computer.note()
            self.check()

    def check(self):
        hear_each_other = not any(self.is_cut.values())
        if not (self.box.is_active and self.standby.is_active and hear_each_other):
            self.both_since = None
        elif self.both_since is None:
            self.both_since = self.now
        else:
            assert self.now - self.both_since <= BOTH_S
        assert not (self.box.is_silent_for_good and self.standby.is_silent_for_good), "there is no box any more"

    def happen(self, what):
        if what == "takeover":
            self.standby.take_over(max(self.standby.epoch, 1))
        elif what == "box again" and self.box.is_superseded:
            self.box.take_over(max(self.box.epoch, self.standby.epoch))
        elif what == "box restarts":
            self.box.start()
        elif what == "standby restarts" and self.standby.claim is not None:
            self.standby.start()
        elif what == "box off":
            self.box.claim = None
        elif what == "box hangs" and self.box.hung_since is None:
            self.box.hung_since = self.now
        elif what == "box continues":
            self.box.resume(self.now)
        elif what == "split":
            self.is_cut = dict.fromkeys(self.is_cut, True)
        elif what == "box is not heard":
            self.is_cut[Side.BOX] = True
        elif what == "standby is not heard":
            self.is_cut[Side.STANDBY] = True
        elif what == "heal":
            self.is_cut = dict.fromkeys(self.is_cut, False)


EVENTS = st.sampled_from(["takeover", "box again", "box restarts", "standby restarts", "box off", "split", "heal",
                          "heal", "box hangs", "box hangs", "box continues", "box is not heard",
                          "standby is not heard"])
FATES = st.sampled_from(["", "", "lost", "late", "doubled"])


@examples(240)
@given(st.lists(st.tuples(EVENTS, st.sampled_from([0.1, 0.3, 1.2])), max_size=14), st.lists(FATES, max_size=200))
def test_two_boxes_that_hear_each_other_are_never_active_for_long(story, fates):
    world = World(fates)
    world.run(1.0)
    for what, seconds in story:
        world.happen(what)
        world.run(seconds)
    world.happen("heal")
    world.happen("box continues")
    world.run(ASK_AGAIN_S + 2 * BOTH_S)
    active = [computer for computer in (world.box, world.standby) if computer.is_active]
    assert len(active) == 1 or world.box.claim is None


def test_a_box_whose_cable_is_plugged_in_again_stops():
    world = World()
    world.run(1.0)
    world.happen("split")
    world.happen("takeover")
    world.run(5.0)
    assert world.box.is_active and world.standby.is_active, "which nobody can exclude"
    world.happen("heal")
    world.run(0.5)
    assert world.box.is_silent_for_good and world.standby.is_active
    by = world.box.claim.by
    assert (by.pair, by.word.epoch) == (PAIR, 2)


def test_both_took_over_while_they_did_not_hear_each_other():
    world = World()
    world.happen("takeover")
    world.run(1.0)
    world.happen("split")
    world.happen("box again")
    world.happen("takeover")
    world.run(1.0)
    assert world.box.epoch == world.standby.epoch == 3
    world.happen("heal")
    world.run(1.0)
    assert world.box.is_silent_for_good and world.standby.is_active


def test_a_box_that_only_hears_stops_too():
    """The standby does not hear the box, but the box hears the standby."""
    world = World()
    world.happen("box is not heard")
    world.happen("takeover")
    world.run(1.0)
    assert world.box.is_silent_for_good and world.standby.is_active


def test_a_box_that_starts_again_asks_before_it_sends():
    world = World()
    world.happen("box off")
    world.happen("takeover")
    world.run(2.0)
    world.happen("box restarts")
    for _ in range(40):
        world.run(STEP_S)
        assert not world.box.is_active
    assert world.box.is_silent_for_good


@pytest.mark.parametrize("until_takeover_s", [2.0, 6.0])
@pytest.mark.parametrize("starts_s", [0.0, 1.0])
def test_a_box_that_hung_is_not_active_for_a_moment_after_a_takeover(until_takeover_s, starts_s):
    """Also if it continues while the standby is still starting."""
    world = World()
    world.run(1.0)
    world.happen("box hangs")
    world.run(until_takeover_s)
    if starts_s:
        world.happen("box continues")
        for _ in range(round(starts_s / STEP_S)):
            world.run(STEP_S)
            assert not world.box.is_active
    world.happen("takeover")
    world.run(1.0)
    world.happen("box continues")
    for _ in range(40):
        world.run(STEP_S)
        assert not world.box.is_active
    assert world.box.is_silent_for_good and world.standby.is_active


@pytest.mark.parametrize("hung_s, silent_s", [(1.0, 0.0), (2.0, ASK_AGAIN_S)])
def test_a_box_that_hung_continues_if_nobody_took_over(hung_s, silent_s):
    world = World()
    world.happen("split")
    world.run(1.0)
    world.happen("box hangs")
    world.run(hung_s)
    world.happen("box continues")
    if silent_s:
        world.run(silent_s - STEP_S)
        assert not world.box.is_active
    world.run(3 * STEP_S)
    assert world.box.is_active


def test_a_box_whose_standby_is_off_waits_for_a_moment_only():
    world = World()
    world.happen("split")
    world.run(ASK_S - STEP_S)
    assert not world.box.is_active
    world.run(3 * STEP_S)
    assert world.box.is_active


def test_a_box_whose_standby_answers_does_not_wait():
    claim = Claim(1, 0, {PAIR: Side.BOX})
    ((_, asked),) = claim.tick(0.0)
    assert asked.asks and claim.state is State.ASKING
    assert claim.hear(PAIR, Word(Side.STANDBY, 1, claims=False)) is None
    assert claim.state is State.ACTIVE


def test_a_superseded_box_answers_and_stays_silent():
    claim = Claim(1, 0, {PAIR: Side.BOX}, is_superseded=True)
    assert claim.tick(0.0) == [] and claim.tick(100.0) == []
    answer = claim.hear(PAIR, Word(Side.STANDBY, 2, claims=True, asks=True))
    assert not answer.claims
    claim.hear(PAIR, Word(Side.STANDBY, 1, claims=False))
    assert claim.state is State.SUPERSEDED


@pytest.mark.parametrize("word", [
    Word(Side.STANDBY, 2, claims=False),  # a copy that nobody started
    Word(Side.BOX, 2, claims=True),  # an echo
    Word(Side.STANDBY, 1, claims=False, asks=True)])
def test_words_that_do_not_stop_a_box(word):
    claim = Claim(1, 0, {PAIR: Side.BOX})
    claim.tick(0.0)
    claim.tick(ASK_S)
    claim.hear(PAIR, word)
    assert claim.state is State.ACTIVE


def test_words_of_no_pair_do_not_stop_a_box():
    claim = Claim(1, 0, {PAIR: Side.BOX})
    claim.hear("another", Word(Side.STANDBY, 9, claims=True))
    assert claim.state is State.ASKING


def test_words_keep_their_period_when_ticks_are_a_little_late():
    """Each tick is some milliseconds late, and some more than the next one."""
    claim = Claim(1, 0, {PAIR: Side.BOX})
    said = [number for number in range(40) if claim.tick(number * SAY_S + 0.001 * (number % 3))]
    assert said == list(range(40))


def test_words_that_were_not_said_in_time_are_not_said_together_later():
    claim = Claim(1, 0, {PAIR: Side.BOX})
    claim.tick(0.0)
    said = [step for step in range(20) if claim.tick(60.0 + step * SAY_S / 5)]
    assert len(said) <= 5 and said[0] == 0


def test_another_pair():
    """The standby was replaced: only the new one can take over."""
    claim = Claim(1, 0, {PAIR: Side.BOX})
    claim.use({"new": Side.BOX})
    claim.hear(PAIR, Word(Side.STANDBY, 2, claims=True))
    assert claim.state is not State.SUPERSEDED
    claim.hear("new", Word(Side.STANDBY, 2, claims=True))
    assert claim.state is State.SUPERSEDED


def test_a_box_that_was_never_heard_is_not_silent():
    """The standby may have been started first, or on another network."""
    silence = BoxSilence()
    assert not silence.lasts(1000.0, 5.0)
    silence.hear(1000.0)
    assert not silence.lasts(1004.0, 5.0)
    assert silence.lasts(1005.0, 5.0)


# -- words as datagrams: nobody but the ends of the pair can make one ---------------------------------

SECRET, OTHER = "5" * 64, "6" * 64
SECRETS = {pair_name(secret): secret for secret in (SECRET, OTHER)}
WORD = Word(Side.STANDBY, 2, claims=True, asks=False, cut=1234)


def test_a_word_arrives():
    assert unseal(SECRETS, seal(SECRET, WORD)) == (pair_name(SECRET), WORD)
    assert unseal(SECRETS, seal(OTHER, WORD)) == (pair_name(OTHER), WORD)


def test_a_word_of_another_pair():
    assert unseal({pair_name(OTHER): OTHER}, seal(SECRET, WORD)) is None


def test_a_word_whose_sender_does_not_have_the_key():
    forged = seal(OTHER, WORD).replace(pair_name(OTHER).encode(), pair_name(SECRET).encode())
    assert unseal(SECRETS, forged) is None


@pytest.mark.parametrize("place", range(0, len(seal(SECRET, WORD)), 7))
def test_a_word_that_was_changed(place):
    data = bytearray(seal(SECRET, WORD))
    data[place] ^= 1
    assert unseal(SECRETS, bytes(data)) is None


@pytest.mark.parametrize("data", [b"", b" ", b"\xff \xff \xff", b"a b c", seal(SECRET, WORD)[:-1],
                                  seal(SECRET, WORD._replace(epoch=0)), seal(SECRET, WORD._replace(cut=-1))])
def test_an_invalid_word(data):
    assert unseal(SECRETS, data) is None
