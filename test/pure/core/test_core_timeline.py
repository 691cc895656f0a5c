"""The timeline of a run: what the core keeps of it, and how all faces word it."""

from decimal import Decimal

import pytest

from helpers.box_driver import BoxDriver
from helpers.competition import BUMPS, DOOR, competition, event
from roah_rsbb.core.actions.table import Target
from roah_rsbb.core.settings import Settings
from roah_rsbb.core.views.document import Documents
from roah_rsbb.model.reason import Refused, RunName
from roah_rsbb.model.scoring import ScoreKind, ScoringItem
from roah_rsbb.results.paper import front_markup, front_of
from roah_rsbb.rulebook.benchmarks import EventRules, PhaseRule
from roah_rsbb.scoring.book import MAX_HAPPENED, MAX_NOTES
from roah_rsbb.scoring.timeline import run_timeline
from roah_rsbb.wording import timeline
from roah_rsbb.wording.times import Moments

RULES = EventRules(pause=True, phases=(PhaseRule("Enter", 60.0), PhaseRule("Search", 60.0)))
FOUND = ScoringItem(DOOR.group, "finds it", ScoreKind.BOOL, Decimal(80))
SHEET = (DOOR, FOUND, ScoringItem(BUMPS.group, BUMPS.desc, BUMPS.kind, Decimal(-20)))


class World(BoxDriver):
    """A run of a task with points and two phases."""

    def __init__(self):
        super().__init__(competition(tbm=[event("HWV", scoring=SHEET, rules=RULES)]), Settings(auto_next=False))
        self.robot = self.connected()
        self.name = RunName("tbm", self.run_in().identity)

    def act(self, name, who="Anna", /, **given):
        self.event(self.box.act, Target(*self.name), name, who, given)

    def items(self):
        """The timeline of the run as faces show it, the latest first."""
        timelines = Documents(self.box, "uuid", "").look(self.now).timelines
        return timeline.timeline(timelines["tbm"], Moments(True).time_of_day)

    def entries(self):
        return self.box.scores.record_of(self.now, self.name).timeline


@pytest.fixture
def world():
    return World()


def test_everything_of_a_run_is_one_list_the_latest_first_with_both_clocks(world):
    world.act("start")
    world.run(5.0)
    world.act("mark", group=FOUND.group, desc=FOUND.desc, value=1, id="m", role="judge", device="phone 3")
    world.run(2.0)
    world.act("pause", "Ben")
    world.robot.lives(10.0)
    for command in ("resume", "next_phase"):
        world.act(command)
    world.act("mark", "Ben", group=BUMPS.group, desc=BUMPS.desc, added="1", id="n", note="the vase")
    world.act("note", id="x", role="referee")
    world.act("withdraw", entry=1, note="other robot")
    world.robot.lives(3.0)
    world.act("stop", reason="fire alarm")
    world.act("start")
    shown = world.items()
    assert [(item.kind, item.clock, item.text, item.change, item.points, item.who) for item in shown] == [
        ("restart", "0:10", "Started again", "", "", "Anna"),
        ("stop", "0:10", "Benchmark stopped by the referee", "", "", "Anna"),
        ("note", "0:07", timeline.NO_TEXT, "", "", "Anna"), ("phase", "0:07", "Phase: Search", "", "", "Anna"),
        ("resume", "0:07", "Clock resumed", "", "", "Anna"), ("mark", "0:07", "bumps", "+1", "−20", "Ben"),
        ("pause", "0:07", "Clock paused", "", "", "Ben"), ("mark", "0:05", "finds it", "yes", "+80", "Anna"),
        ("start", "0:00", "Started", "", "", "Anna"), ("connect", "", "Connected", "", "", ""),
    ]
    assert len({item.id for item in shown}) == len(shown)
    found, bumps, stop = shown[7], shown[5], shown[1]
    assert (found.id, found.number, found.group, found.desc, found.role) == (
        "mark 1", 1, FOUND.group, FOUND.desc, "Judge")
    assert (found.state, found.said) == ("withdrawn", f"withdrawn by Anna at {shown[5].time}: other robot")
    assert (bumps.note, stop.note) == ("the vase", "fire alarm")
    assert timeline.timeline_line(bumps) == f"{bumps.time}  0:07  bumps +1 (−20): the vase – Ben"


def test_a_note_is_made_once_and_its_text_comes_when_somebody_has_time(world):
    world.act("start")
    world.run(5.0)
    world.act("note", id="x")
    world.run(60.0)
    world.act("note", "Ben", id="x")  # it arrives again
    world.act("note", "Ben", id="x", text="missed the door")
    world.act("note", id="x")  # and again
    (note,) = [item for item in world.items() if item.kind == "note"]
    assert (note.clock, note.text, note.who) == ("0:05", "missed the door", "Anna")
    assert note.said.startswith("text by Ben at ")
    world.act("disconnect", running=True)
    world.act("note", number=note.number, text="missed the window")
    assert [(entry.text, entry.clock_s) for entry in world.entries() if entry.kind == "note"] == [
        ("missed the window", 5.0)]
    world.act("sign_off")
    world.act("note", number=note.number, text="missed the window")  # it arrives again
    with pytest.raises(Refused, match="it is final"):
        world.act("note", number=note.number, text="missed nothing")
    with pytest.raises(Refused, match="it is final"):
        world.act("note", id="y")


def test_neither_notes_nor_starts_fill_the_record(world):
    for number in range(MAX_NOTES):
        world.act("note", id=f"{number}")
    with pytest.raises(Refused, match="has 100 notes"):
        world.act("note")
    with pytest.raises(Refused, match="no note 1000"):
        world.act("note", number=1000, text="x")
    world.act("start")
    for _ in range(MAX_HAPPENED):
        world.act("pause")
        world.act("resume")
    assert len(world.entries()) == MAX_NOTES + MAX_HAPPENED


def test_changes_within_a_moment_are_one_item_with_the_sum_of_their_points(world):
    world.act("start")
    for _ in range(3):
        world.act("mark", group=BUMPS.group, desc=BUMPS.desc, added="1")
    assert [(item.change, item.points) for item in world.items() if item.kind == "mark"] == [("+3", "−60")]


# -- what waited for a link -------------------------------------------------------------------------


def waited(world, seconds, number, device="phone 1", **given):
    world.act("mark", id=f"{number}", device=device, ago_ms=round(seconds * 1000), group=BUMPS.group, desc=BUMPS.desc,
              **(given or {"added": "1"}))


def marks(world):
    """The marks of the run, in the order in which they were made: clock, change, how late they arrived."""
    return [(item.clock, item.change, item.arrived) for item in world.items()[::-1] if item.kind == "mark"]


def test_a_mark_that_waited_has_the_moment_at_which_it_was_made(world):
    world.act("start")
    world.robot.lives(20.0)
    world.act("pause")
    world.robot.lives(30.0)
    world.act("resume")
    world.robot.lives(10.0)
    waited(world, 55.0, 1)
    waited(world, 35.0, 2)  # the clock was paused
    waited(world, 4.0, 3)
    waited(world, 0.5, 4)
    assert marks(world) == [("0:05", "+1", "arrived 55 s later"), ("0:20", "+1", "arrived 35 s later"),
                            ("0:26", "+1", "arrived 4 s later"), ("0:30", "+1", "")]
    waited(world, 55.0, 1)  # it arrives again
    assert len(marks(world)) == 4


@pytest.mark.parametrize("ago_s, clock", [(600.0, "0:50"), (31.5, "0:20"), (45.0, "0:50"), (29.0, "0:21")])
def test_a_moment_before_the_run_or_before_an_earlier_mark_of_the_device_is_not_believed(world, ago_s, clock):
    world.act("start")
    world.robot.lives(20.0)
    waited(world, 0.0, 1)
    world.robot.lives(30.0)
    waited(world, ago_s, 2)
    assert marks(world)[1][0] == clock


def test_of_two_marks_of_an_item_the_one_that_was_made_later_stands(world):
    world.act("start")
    world.robot.lives(20.0)
    waited(world, 0.0, 1, "phone 2", value=5)
    waited(world, 10.0, 2, value=3)
    waited(world, 12.0, 3, "phone 3", added="1")
    assert world.box.scores.record_of(world.now, world.name).items[2].value == 5
    assert [change for _, change, _ in marks(world)] == ["+1", "-2", "+5"]


def test_a_mark_that_was_made_in_the_run_and_arrives_after_it_is_no_correction(world):
    world.act("start")
    world.robot.lives(20.0)
    world.act("disconnect", running=True)
    world.run(20.0)
    waited(world, 30.0, 1)
    waited(world, 5.0, 2)
    record = world.box.scores.record_of(world.now, world.name)
    assert [(entry.clock_s, entry.correction) for entry in record.history] == [
        (pytest.approx(10.0), False), (pytest.approx(20.0), True)]


def test_a_mark_that_arrives_after_the_sign_off_is_proposed_and_changes_nothing_until_it_is_accepted(world):
    world.act("start")
    world.robot.lives(20.0)
    world.act("disconnect", running=True)
    world.act("sign_off", "Ada")
    world.run(60.0)
    for number in (1, 2, 1):
        waited(world, 70.0, number)
    world.act("note", id="n", device="phone 1", ago_ms=70_000, text="missed it")
    with pytest.raises(Refused, match="it is final"):
        waited(world, 10.0, 3)
    record = world.box.scores.record_of(world.now, world.name)
    assert (record.points.total, record.history, record.sign_off.who) == ("0", (), "Ada")
    assert world.box.entries.outcome(Target(*world.name), "mark", {
        "group": BUMPS.group, "desc": BUMPS.desc, "id": "2"})["proposed"] == 2
    with pytest.raises(Refused, match="needs the name"):
        world.act("decide", "", number=1, accept=True)
    world.act("decide", "Ben", number=1, accept=True, reason="seen by both")
    world.act("decide", "Ben", number=2, reason="counted twice")
    record = world.box.scores.record_of(world.now, world.name)
    assert (record.points.total, record.sign_off.who, record.versions[0].sign_off.who) == ("-20", "Ben", "Ada")
    assert [(entry.clock_s, entry.who, entry.points) for entry in record.history] == [
        (pytest.approx(10.0), "Anna", "-20")]
    (shown,) = [item for item in timeline.timeline(run_timeline(record), Moments(True).time_of_day)
                if item.kind == "proposal"]
    assert (shown.state, shown.said[-15:]) == ("dropped", ": counted twice")
    with pytest.raises(Refused, match="has decided"):
        world.act("decide", "Ben", number=1)
    waited(world, 70.0, 1)  # it arrives again
    world.set_clock(-3600.0)
    for seconds in (0.0, 0.02, 10.0):  # ... and what is new is not of a moment before the run
        with pytest.raises(Refused, match="it is final"):
            waited(world, seconds, 4)
    world.set_clock(3600.0 - 61.0)
    with pytest.raises(Refused, match="it is final"):
        waited(world, 0.0, 4)
    assert world.box.scores.record_of(world.now, world.name) == record


def test_a_mark_that_was_taken_back_before_the_sign_off_is_proposed_if_that_arrives_after_it(world):
    def found(number, **given):
        world.act("mark", group=FOUND.group, desc=FOUND.desc, value=1, id=f"m{number}", device="phone 1", **given)

    def standing():
        record = world.box.scores.record_of(world.now, world.name)
        return record.points.total, [(each.takes_back, each.accepted, each.reason) for each in record.proposals]

    world.act("start")
    world.robot.lives(20.0)
    found(1)
    world.act("disconnect", running=True)
    world.act("sign_off", "Ada")
    world.run(60.0)
    with pytest.raises(Refused, match="it is final"):
        world.act("take_back", id="m1", ago_ms=10_000)
    for _ in range(2):
        world.act("take_back", id="m1", ago_ms=70_000)
    assert standing() == ("80", [(1, False, "")])
    (shown,) = [item for item in timeline.timeline(run_timeline(world.box.scores.record_of(world.now, world.name)),
                                                   Moments(True).time_of_day) if item.kind == "proposal"]
    assert (shown.text, shown.change, shown.state) == (FOUND.desc, "no", "proposed")
    world.act("decide", "Ben", number=1, accept=True)
    assert standing() == ("0", [(1, True, "")])
    found(2, ago_ms=70_000)
    world.act("take_back", id="m2", ago_ms=69_000)  # of a mark that is only proposed
    assert standing() == ("0", [(1, True, ""), (0, False, "taken back")])


def test_a_signature_of_the_captain_is_outdated_when_the_sheet_is_corrected_after_it(world):
    def signed():
        record = world.box.scores.record_of(world.now, world.name)
        (sign,) = [item for item in timeline.timeline(run_timeline(record), Moments(True).time_of_day)
                   if item.kind == "captain"]
        assert sign.text in str(front_markup(front_of(record, None, "", True))).replace("2027-01-15 ", "")
        return sign.state, sign.text.partition(" at ")[0]

    world.act("start")
    world.act("mark", group=FOUND.group, desc=FOUND.desc, value=1, id="m")
    world.robot.lives(20.0)
    world.act("disconnect", running=True)
    world.act("captain", "Ada", name="Cleo")
    world.act("sign_off", "Ada")
    assert signed() == ("", "Signed by captain Cleo")
    world.run(60.0)
    waited(world, 70.0, 1)
    assert signed() == ("", "Signed by captain Cleo"), "nobody has accepted it"
    world.act("decide", "Ben", number=1, accept=True)
    assert signed() == ("outdated", "Corrected after captain Cleo signed")


def test_the_captain_signs_or_refuses_with_a_reason_and_the_last_one_holds(world):
    def captain(**given):
        world.act("captain", "Ada", name="Cleo", **given)

    world.act("start")
    with pytest.raises(Refused, match="disconnect it first"):
        captain()
    world.act("disconnect", running=True)
    for given, why in (({"refused": True}, "why the captain refuses"), ({"drawing": "M1 1<svg>"}, "not made of lines")):
        with pytest.raises(Refused, match=why):
            captain(**given)
    captain(refused=True, comment="a cup is missing")
    world.act("sign_off", "Ada")
    captain(drawing="M10 20L30 40M5 6")
    record = world.box.scores.record_of(world.now, world.name)
    shown = [item for item in timeline.timeline(run_timeline(record), Moments(True).time_of_day)
             if item.kind == "captain"]
    assert [(item.state, item.text.partition(" at ")[0], item.note) for item in shown] == [
        ("", "Signed by captain Cleo", ""), ("refused", "Captain Cleo refused to sign", "a cup is missing")]
    page = str(front_markup(front_of(record, None, "", True)))
    assert 'd="M10 20L30 40M5 6"' in page and "Signed by captain Cleo" in page
