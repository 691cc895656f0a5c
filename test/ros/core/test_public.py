"""What the public may see of a run, from its start to the standing: in the document of a core that runs."""

import calendar
import contextlib
from typing import List

from support.box_case import BoxCase
from support.box_client import SIGNED_OFF, Refusal
from support.waiting import wait_until

from roah_rsbb.model.document import Document, PublicItem, PublicRank, PublicRun, PublicStanding

DOOR = ("Achievements", "Detects the door whose state has changed")
FIRST = calendar.timegm((2015, 12, 31, 9, 0, 0))


class TestPublic(BoxCase):
    def setUp(self) -> None:
        super().setUp()
        self.addCleanup(self.back_to_the_first_event)

    def back_to_the_first_event(self) -> None:
        """The cases of other files begin there."""
        self._end_runs()
        with contextlib.suppress(Refusal):
            self.box.command("previous", "Home")

    @property
    def shown(self) -> Document:
        return self.box.document

    def wait_phase(self, phase: str) -> PublicRun:
        """Wait until the run in zone Home is in this phase; returns it."""
        return wait_until(lambda: next((run for run in self.shown.runs_shown() if run.phase == phase), None),
                          lambda: f"the public sees phase {phase} in:\n{self.shown.public_runs}")

    def follow(self) -> List[tuple]:
        return [(event.zone, event.team, event.run) for event in self.shown.public.following]

    def test_a_whole_run(self) -> None:
        robot = self.robot("Alpha")
        first = self.shown.public.following[0]
        self.assertEqual((first.zone, first.team, first.benchmark), ("Home", "Alpha", "Getting to know my home"))
        self.assertEqual((first.round, first.run, first.scheduled_utc_s), (2, 3, FIRST))
        self.assertEqual((len(self.follow()), self.shown.public.results, self.shown.runs_shown()), (8, "scores", ()))
        self.box.connect("Home")
        run = self.wait_phase("connected")
        self.assertEqual((run.event.team, run.teams), ("Alpha", ("Alpha",)))
        self.assertEqual((run.elapsed.counting, run.limit), (False, 600.0))
        self.assertNotIn(("Home", "Alpha", 3), self.follow())
        self.box.start("Home")
        self.assertTrue(self.wait_phase("running").elapsed.counting)
        self.box.set_score("Home", *DOOR, 1)
        robot.let("execute")
        run = self.wait_phase("ended")
        self.assertEqual((run.end_reason, run.elapsed.counting), ("completed", False))
        self.box.command("disconnect", "Home")
        wait_until(lambda: ("Home", "Alpha", 4) in self.follow(), "the next event follows")
        self.assertEqual(self.shown.public_results, {}, "it is not signed off")
        self.box.wait_current()
        self.box.act("sign_off", "Home", self.shown.runs()[0].identity, "Anna")
        wait_until(lambda: self.shown.public.standings, "the result is published")
        (result,) = self.shown.results_shown(signed=True)
        self.assertEqual((result.event.team, result.event.run, result.end_reason), ("Alpha", 3, "completed"))
        given = [(group.name, item) for group in result.groups for item in group.items if item.value]
        self.assertEqual(given, [(DOOR[0], PublicItem(DOOR[1], "bool", 1))])
        self.assertEqual(self.shown.public.standings, (PublicStanding(
            "Getting to know my home", ("Sum of the sheet",), (PublicRank("1", "Alpha", ("1",)),)),))
        self.assertEqual(self.shown.runs_shown(), ())
        self.box.command("previous", "Home")
        with self.assertRaisesRegex(Refusal, SIGNED_OFF):
            self.box.command("connect", "Home")
        self.box.connect("Home", again=True)
