"""Invariants that hold for any order of events, any link and any times."""

import contextlib
import itertools
import json
import random

from hypothesis import given
from hypothesis import strategies as st

from fuzzing.core import Play
from helpers.box_driver import BoxDriver
from helpers.commands import COMMANDS
from helpers.competition import TEAMS, UTC0, competition, event
from helpers.examples import OPENINGS, STORIES, examples
from helpers.linked_world import FakeLink, World, assert_legal
from roah_rsbb.core import effects
from roah_rsbb.core.link.freshness import Freshness, Timeline
from roah_rsbb.core.views import document
from roah_rsbb.core.views.document import Documents
from roah_rsbb.core.views.public import Publicity, PublicResults
from roah_rsbb.core.views.schedule import ScheduleView, schedule
from roah_rsbb.document.document import DocumentReader, Followed, Written
from roah_rsbb.model.document import Document
from roah_rsbb.model.reason import Refused, RunName
from roah_rsbb.model.zone import IDLE
from roah_rsbb.protocol import BoxState, RobotState
from roah_rsbb.results.standings import public_standings
from roah_rsbb.robot.machine import IllegalEvent
from roah_rsbb.scoring.sheet import Mark

# What the record of a run in progress has from its next change on: its times, and the goals in its timeline.
LATER = {"elapsed_s": 0.0, "robots": (), "phases": (), "timeline": ()}


def _check_records(driver, reported):
    """The last published record of a run is the valid one, and a signed-off record does not change."""
    for effect in driver.taken(effects.RecordChanged):
        before = reported.get(effect.record.identity)
        assert before is None or before.sign_off is None
        reported[effect.record.identity] = effect.record
    for zone in driver.box.zones.values():
        if zone.run is not None:
            record = zone.run.record(driver.now)
            last = reported[record.identity]
            assert record._replace(**LATER) == last._replace(**LATER)
    for record in driver.box.finished.records():
        assert record == reported[record.identity]


@examples(150)
@given(OPENINGS, STORIES)
def test_the_last_record_of_a_run_is_the_valid_one(opening, story):
    play, reported = Play(opening, BoxDriver), {}
    for act in story:
        play.do(act)
        _check_records(play.driver, reported)


def without_skews(document):
    """A document without what is shown in steps from the one before."""
    robots = {name: robot._replace(skew=0.0) for name, robot in document.robots.items()}
    zones = {name: zone if zone.robot is None else zone._replace(robot=zone.robot._replace(skew=None))
             for name, zone in document.zones.items()}
    return document._replace(robots=robots, zones=zones)


def documents_of(driver):
    """What makes the documents of a box whose organisers allow the public everything."""
    publicity = Publicity(PublicResults.SCORES, True, True, public_standings)
    return Documents(driver.box, "uuid", "10.0.0.255", publicity)


class _Kept:
    """What a box and its views keep until it changes, beside what they would find now; and a client that is sent what
    changes, but not each time."""

    def __init__(self, driver, random):
        self._driver, self._random = driver, random
        self._documents, self._schedule = documents_of(driver), ScheduleView(driver.box)
        self._written = Written(Document)
        self._client, self._followed = DocumentReader(), Followed(Document)
        self._revision, self._coming = None, ()

    def check(self):
        box, now = self._driver.box, self._driver.now
        self._check_document(now)
        assert self._schedule.look(now) == schedule(box, now)
        coming = document.coming_events(box)
        assert box.outbox.revision != self._revision or coming == self._coming
        self._revision, self._coming = box.outbox.revision, coming
        runs = [zone.run for zone in box.zones.values() if zone.run is not None]
        members = [member for run in runs for member in run.members()]
        assert box.zones.runs() == runs and box.zones.members() == members
        assert box.beacon().robots == tuple((*run.robot, run.port) for run in members)
        for member in members:
            assert box.zones.run_of(member.robot) is member is box.zones.run_at(member.port)
        robots = box.robots.all(now)
        for team in TEAMS:
            assert {r.id for r in box.robots.of_team(now, team)} == {r.id for r in robots if r.id.team == team}

    def _check_document(self, now):
        """What the client has is what the box is, also if it was sent nothing for a while. What zones without a run
        show besides may be a second old."""
        kept, fresh = self._documents.look(now), documents_of(self._driver).look(now)
        if any(fresh.zones[name] != zone for name, zone in kept.zones.items() if zone.phase == IDLE):
            late = now.later(1.0)
            kept, fresh = self._documents.look(late), documents_of(self._driver).look(late)
        assert list(kept.zones) == list(fresh.zones)
        assert without_skews(kept) == without_skews(fresh)
        self._written.update(kept, now)
        if self._random.random() < 0.5:
            sent = self._client.next(self._written, now)  # what has changed since it was asked last
            if sent is not None:
                self._followed.take(json.loads(sent))
            document = self._followed.document
            assert document == kept
            assert [str(z) for z in document.zones.values()] == [str(z) for z in kept.zones.values()]


@examples(100)
@given(OPENINGS, STORIES, st.integers(0, 2**32))
def test_what_is_kept_and_what_a_client_has_is_what_would_be_found_now(opening, story, seed):
    play = Play(opening, BoxDriver)
    kept = _Kept(play.driver, random.Random(seed))
    for act in story:
        play.do(act)
        kept.check()


def test_what_is_kept_of_a_run_in_progress_is_what_would_be_found_now():
    other = [event("HWV", team="Beta", scheduled=UTC0 + 40.0)]
    driver = BoxDriver(competition(tbm=["HWV", event("HWV", run=2, scheduled=UTC0 + 70.0)], other=other))
    kept = _Kept(driver, random.Random(1))
    robot = driver.executing()
    shown = document.ZoneViews(driver.box)
    first = shown.look(driver.now)
    assert all(view is first[name] for name, view in shown.look(driver.now.later(0.1)).items())
    name = RunName("tbm", driver.run_in().identity)
    for act in (
        lambda: robot.says(after=0.05), lambda: robot.says(messages_saved=2), lambda: robot.says(notifications=("a",)),
        lambda: setattr(robot, "skew", 5.0), robot.says, lambda: robot.lives(3), lambda: driver.run(4.0), robot.says,
        lambda: driver.event(driver.box.arrivals.on_unreadable, robot.port, "bad"), lambda: driver.run(20.0),
        lambda: driver.score("Penalized", "bumps", 1), lambda: robot.says(RobotState.PREPARING), robot.executes,
        lambda: driver.event(driver.box.reload.take, competition(tbm=["HGTKMH", "HWV"], other=other), 1, ["all"]),
        lambda: driver.command("stop"), lambda: driver.run(1.0), robot.says, lambda: driver.command("disconnect"),
        robot.beacon, lambda: driver.mark(name, Mark("Penalized", "bumps", 3)),
        lambda: driver.enter("sign_off", name, "Ada"), *[lambda: driver.run(7.0)] * 15,
    ):
        act()
        kept.check()


@examples(150)
@given(st.data())
def test_only_commands_that_are_off_are_refused(data):
    """A button and its command always agree. The exception: a stop of a run that is not running is accepted."""
    driver = BoxDriver(competition(
        a=["HWV", "HGTKMH"], b=["HCFGAC"], c=[event("HGTKMH", team="Beta")], all=[event("HSUF", team="ALL")]
    ))
    robots = [driver.robot(team, name) for team, name in (("Alpha", "r1"), ("Alpha", "r2"), ("Beta", "r1"))]
    for _ in range(data.draw(st.integers(1, 25))):
        robot = data.draw(st.sampled_from(robots))
        robot.beacon()
        for run in driver.box.zones.members():
            if run.robot == (robot.team, robot.name):
                robot.port = run.port
                robot.says(data.draw(st.sampled_from(RobotState)), after=data.draw(st.sampled_from([0.1, 1.0, 4.0])))
        zone = data.draw(st.sampled_from(["a", "b", "c", "all"]))
        command = data.draw(st.sampled_from(sorted(COMMANDS)))
        off = driver.off(command, zone)
        try:
            driver.command(command, zone)
            assert off == [] or (command == "stop" and driver.run_in(zone) is not None)
        except Refused as refused:
            assert refused.reasons == off


@examples(150)
@given(st.lists(st.tuples(st.floats(0.0, 2.4), st.integers(-(2**80), 2**80)), max_size=40))
def test_a_timeline_that_is_not_quiet_only_ever_rises(messages):
    timeline = Timeline()
    mono, newest, newest_mono = 0.0, None, 0.0
    for after, time in messages:
        mono += after
        verdict = timeline.judge(mono, time)
        is_newer = newest is None or time > newest
        assert (verdict is Freshness.FRESH) is is_newer
        if verdict is Freshness.CLOCK_SET_BACK:
            assert mono - newest_mono >= 2.5
        if verdict in (Freshness.FRESH, Freshness.CLOCK_SET_BACK):
            newest, newest_mono = time, mono


LINK = st.fixed_dictionaries({
    "loss": st.floats(0, 0.45), "double": st.floats(0, 0.5), "late": st.floats(0, 0.5),
    "longest_delay": st.floats(0.01, 1.5), "jitter": st.booleans(),
})


@examples(25)
@given(LINK, st.integers(0, 2**32), st.lists(
    st.tuples(st.sampled_from(["start", "stop", "disconnect", "connect", "crash", "end_execute", "set clock"]),
              st.floats(0.0, 4.0)),
    max_size=15,
))
def test_whatever_referee_and_robot_do_both_ends_keep_to_their_tables(link, seed, acts):
    world = World(competition(tbm=["HWV"]), FakeLink(random.Random(seed), **link))
    robot = world.add_robot()
    world.press("connect", limit_s=300)
    for act, after in acts:
        if act == "crash":
            robot.crash()
        elif act == "set clock":
            robot.set_clock(robot.skew + (-50 if len(acts) % 2 else 50))
        elif act == "end_execute":
            with contextlib.suppress(IllegalEvent):
                robot.end_execute()
        elif not world.box.off(act):
            world.press(act)
        world.run(after)
    for port in world.box.states:
        world_states = [state for state, _ in itertools.groupby(m.state for m in world.box.states[port])]
        assert BoxState.GOAL_TX not in world_states
    if not any(act in ("crash", "set clock") for act, _ in acts):
        for port in world.box.states:
            assert_legal(world, port, robot)


@examples(150)
@given(OPENINGS, STORIES)
def test_the_box_does_the_same_as_one_that_looks_at_all_runs_each_time(opening, story):
    plays = [Play(opening, BoxDriver) for _ in range(2)]
    ours, theirs = (play.driver for play in plays)
    for act in story:
        theirs.box.timers.moved()
        for play in plays:
            play.do(act)
        theirs.box.timers.moved()
        due, due_then = (driver.box.timers.deadline() for driver in (ours, theirs))
        assert (due is None) == (due_then is None)
        assert due is None or due <= due_then
        assert ours.effects == theirs.effects, act


def test_one_robot_that_reports_does_not_hide_that_another_is_silent():
    driver = BoxDriver(competition(a=["HWV"], b=[event("HGTKMH", team="Beta")]))
    talks = driver.connected("a")
    driver.connected("b", team="Beta", host="10.0.0.3")
    driver.taken()
    for _ in range(40):
        driver.jump(0.1)
        talks.send(talks.report())
    assert any("No message from the robot for 3 s" in text for text in driver.notices())


def test_runs_that_nothing_is_due_in_are_not_looked_at_for_a_report():
    """The load of 100 robots at 50 ms depends on this."""
    driver = BoxDriver(competition(a=["HWV"], b=[event("HGTKMH", team="Beta")]))
    talks = driver.connected("a")
    driver.connected("b", team="Beta", host="10.0.0.3")
    looks = []
    quiet = driver.run_in("b")
    tick = quiet.tick
    quiet.tick = lambda now: (looks.append(now), tick(now))
    for _ in range(20):
        driver.jump(0.05)
        talks.send(talks.report())
    assert len(looks) <= 1


def test_a_run_that_moved_to_another_port_is_looked_at_again():
    driver = BoxDriver(competition(a=["HWV"], b=[event("HGTKMH", team="Beta")]))
    stuck = driver.connected("a")
    beta = driver.robot(team="Beta", host="10.0.0.3")
    beta.beacon()
    driver.command("connect", "b")
    driver.run(10.0)
    stuck.send(stuck.last)
    driver.event(driver.box.arrivals.on_channel_failed, driver.run_in("b").port, "in use")
    driver.taken()
    driver.jump(3.5)
    stuck.send(stuck.last)
    assert any("has not answered" in text for text in driver.notices())
