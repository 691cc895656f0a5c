"""HPFF, whole, with dummy robot and dummy ground truth; in the middle of it the modules' process is killed."""

from support.connections import kill, process_of
from support.modules_case import FunctionalityCase
from support.waiting import wait_until

MODULES = "/roah_rsbb_modules"


class TestFollowing(FunctionalityCase):
    def test_hpff_over_a_crash_of_the_modules(self) -> None:
        self.dummy_robot("Delta")
        self.begin("HPFF")
        before = self.box.wait_details("HPFF", lambda d: self.samples(d) >= 2 and self.samples(d), "it is measured")
        self.kill_modules()
        self.box.wait_zone("HPFF", lambda z: "Benchmarking module is back, at step 2" in z.log, "the run continues")
        scores, log = self.to_the_end("HPFF")
        self.assertGreater(scores["", "samples"], before)
        self.assertGreater(scores["", "reliability"], 0.5)
        self.assertGreater(scores["", "distance_covered"], 0.1)
        self.assertLess(scores["", "mean_deviation"], 1.0)
        self.assertGreater(scores["", "run_length"], 13.9)
        self.assertIs(scores["", "failed_run"], False)
        self.assertEqual(len(log.values("/rsbb_log/bmbox/goal")), 1)

    def samples(self, details) -> int:
        return next((int(s.value) for s in details.module_scores if s.name == "samples"), 0)

    def kill_modules(self) -> None:
        """Kill the modules' process, and wait until roslaunch has restarted it."""
        first = process_of(MODULES)
        kill(MODULES)
        wait_until(lambda: process_of(MODULES) not in (0, first), "other modules run")
