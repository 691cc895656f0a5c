"""What holds for the rules of every benchmark: rehearsed runs that are restarted, and other runs."""

from roah_rsbb.bmbox.framework.rehearsal import Poses
from roah_rsbb.bmbox.framework.runner import ModuleRunner
from roah_rsbb.model.modules import RunForModule


def assert_restarts_change_nothing(make, acts):
    """Play `acts(rehearsal)`, a list of calls, to the end: without a restart, and with one before or after each."""
    def play(restart_at):
        rehearsal = make()
        steps = [*acts(rehearsal), lambda: None]
        for number, act in enumerate(steps):
            if number == restart_at:
                rehearsal.restart()
            act()
        assert rehearsal.finished, rehearsal.failed
        return rehearsal.score.values(), rehearsal.module.warnings, len(steps)

    whole = play(None)
    for restart_at in range(whole[2]):
        assert play(restart_at) == whole, restart_at


def assert_orders_differ(rehearsal, key):
    """Each run draws an order of its own; `key`: of the first in the score."""
    kind, parameters, firsts = type(rehearsal.module), rehearsal.module.parameters, set()
    for number in range(20):
        runner = ModuleRunner(kind, lambda: parameters, Poses())
        runner.on_run(RunForModule(f"run {number}", 1, "zone", kind.CODE, "Team", 1, 1, running=True))
        firsts.add(runner.module.score[key])
    assert len(firsts) > 1
