"""Functionality runs between our own box and robot on a bad network, with modules that crash."""

import random

from hypothesis import given
from hypothesis import strategies as st

from helpers.competition import competition, event
from helpers.examples import examples
from helpers.linked_world import FakeLink, World, assert_legal
from helpers.module_player import BEAT_S, ScriptedModules
from roah_rsbb.core.settings import Settings
from roah_rsbb.model.modules import OutcomeKind, RequestKind
from roah_rsbb.model.records import EndReason, Phase

WAYPOINTS = [(RequestKind.GOAL, {"goal": f"[{i}, 0, 0]", "pose": (float(i), 0.0, 0.0)}) for i in range(3)]
NO_GOALS = [(RequestKind.GOAL, {}), (RequestKind.NOTE, {"note": "1"}), (RequestKind.GOAL, {})]
LINK = st.fixed_dictionaries({
    "loss": st.floats(0, 0.45), "double": st.floats(0, 0.5), "late": st.floats(0, 0.5),
    "longest_delay": st.floats(0.01, 1.5), "jitter": st.booleans(),
})


class LinkedModules(ScriptedModules):
    """Modules that publish twice a second and are sometimes missing."""

    def __init__(self, world, code, script):
        super().__init__(world.box, code, script)
        self.world = world
        self.next_mono = world.mono

    def deadline(self):
        return self.next_mono

    def poll(self):
        self.next_mono = self.world.mono + BEAT_S
        self.proceed()

    def crash(self, seconds):
        """End the process. Another one starts after this many seconds."""
        self.next_mono = self.world.mono + seconds
        self.node += "'"


def world_of(code, script, link, **kwargs):
    settings = Settings(check_messages_saved=False)
    world = World(competition(tbm=[event(code, timeout=120.0, total_timeout=600.0)]), link, settings)
    modules = LinkedModules(world, code, script)
    world.companions.append(modules)
    return world, modules, world.add_robot(**kwargs)


def completed(world):
    return world.run_until(lambda: world.box.run_in().phase is Phase.ENDED, 590)


@examples(25)
@given(LINK, st.integers(0, 2**32), st.sampled_from(["HNF", "HOPF"]), st.floats(0.01, 2), st.floats(0.01, 6))
def test_every_goal_is_done_once_on_every_link(link, seed, code, prepare_s, execute_s):
    script = WAYPOINTS if code == "HNF" else NO_GOALS
    world, _, robot = world_of(code, script, FakeLink(random.Random(seed), **link), prepare_s=prepare_s,
                               execute_s=execute_s)
    world.press("connect", limit_s=300)
    port = world.box.run_in().port
    world.press("start", limit_s=300)
    assert completed(world)
    run = world.box.run_in()
    assert run.end_reason is EndReason.COMPLETED
    assert [step.request.kind for step in run.steps] == [kind for kind, _ in script]
    assert all(step.outcome.kind is OutcomeKind.DONE for step in run.steps)
    assert_legal(world, port, robot, explicit_goal=code == "HNF")


@examples(25)
@given(st.integers(0, 2**32), st.lists(st.tuples(st.floats(0.1, 8), st.floats(0.1, 10)), min_size=1, max_size=4))
def test_a_run_survives_modules_that_crash_again_and_again(seed, crashes):
    world, modules, _ = world_of("HNF", WAYPOINTS, FakeLink(random.Random(seed)))
    world.press("connect")
    world.press("start")
    for after, away in crashes:
        world.run(after)
        modules.crash(away)
        world.run(away)
    assert completed(world)
    run = world.box.run_in()
    assert run.end_reason is EndReason.COMPLETED
    assert [step.request.goal for step in run.steps] == [fields["goal"] for _, fields in WAYPOINTS]
