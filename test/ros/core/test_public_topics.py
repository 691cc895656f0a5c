"""What the core publishes for the public display: /core/public_details."""

import calendar
import contextlib
import time
from typing import List

import rospy
from support.box_case import BoxCase
from support.box_client import Refusal
from support.waiting import happened, wait_until

from roah_rsbb.msg import PublicBoard, PublicDetails

DOOR = ("Achievements", "Detects the door whose state has changed")
FIRST = calendar.timegm((2015, 12, 31, 9, 0, 0))


class TestPublicDetails(BoxCase):
    def setUp(self) -> None:
        super().setUp()
        self.heard: List[PublicDetails] = []
        subscriber = rospy.Subscriber("/core/public_details", PublicDetails, self.on_details)
        self.addCleanup(subscriber.unregister)
        wait_until(lambda: self.heard, "it is latched")
        self.addCleanup(self.back_to_the_first_event)

    def back_to_the_first_event(self) -> None:
        """The cases of other files begin there."""
        self._end_runs()
        with contextlib.suppress(Refusal):
            self.box.command("previous", "Home")

    def on_details(self, message: PublicDetails) -> None:
        self.heard.append(message)
        happened()

    @property
    def newest(self) -> PublicDetails:
        return self.heard[-1]

    def wait_phase(self, phase: str) -> PublicDetails:
        """Wait until the run in zone Home is in this phase. Returns the message that says so."""
        def is_in(message: PublicDetails) -> bool:
            return any((run.event.zone, run.phase) == ("Home", phase) for run in message.runs)
        return wait_until(lambda: next((one for one in self.heard[-1:] if is_in(one)), None),
                          lambda: f"the public sees phase {phase} in:\n{self.newest}")

    def follow(self) -> List[tuple]:
        return [(event.zone, event.team, event.run) for event in self.newest.following]

    def test_a_whole_run(self) -> None:
        robot = self.robot("Alpha")
        self.before()
        self.box.connect("Home")
        run, = self.wait_phase("connected").runs
        self.assertEqual((run.event.team, run.teams, run.counting, run.ends.to_sec()), ("Alpha", ["Alpha"], False, 0.0))
        self.assertEqual(run.left.to_sec(), 600.0)
        self.assertNotIn(("Home", "Alpha", 3), self.follow())
        self.box.start("Home")
        self.counts(self.wait_phase("running"))
        self.box.set_score("Home", *DOOR, 1)
        robot.let("execute")
        run, = self.wait_phase("ended").runs
        self.assertEqual((run.end_reason, run.counting), ("completed", False))
        self.assertEqual(self.newest.finished, [])
        self.box.command("disconnect", "Home")
        wait_until(lambda: ("Home", "Alpha", 4) in self.follow(), "the next event follows")
        self.assertEqual(self.newest.finished, [], "it is not signed off")
        self.sign_off()
        self.finished()
        self.standing()

    def before(self) -> None:
        self.assertEqual(self.newest.box_uuid, self.box.uuid)
        first = self.newest.following[0]
        self.assertEqual((first.zone, first.team, first.benchmark), ("Home", "Alpha", "Getting to know my home"))
        self.assertEqual((first.round, first.run, first.scheduled.to_sec()), (2, 3, FIRST))
        self.assertEqual(len(self.newest.following), 8)
        self.assertEqual((self.newest.results, self.newest.runs), ("scores", []))
        self.assertEqual(self.newest._connection_header["latching"], "1")

    def counts(self, message: PublicDetails) -> None:
        """One time at which it is up, in all messages; they come twice a second, not ten times."""
        run, = message.runs
        self.assertTrue(run.counting)
        clock = message.clock.to_sec()
        self.assertLess(abs(clock - time.time()), 100.0)
        self.assertLess(abs(run.ends.to_sec() - clock - run.left.to_sec()), 0.01)
        wait_until(lambda: self.newest.clock.to_sec() > clock + 3.0, "time passes")
        later = [one for one in self.heard if clock < one.clock.to_sec() <= clock + 3.0]
        self.assertLess(len(later), 15)
        self.assertLess(abs(self.newest.runs[0].ends.to_sec() - run.ends.to_sec()), 0.05)
        self.assertLess(abs(run.ends.to_sec() - clock - 600.0), 100.0)

    def sign_off(self) -> None:
        self.box.wait_current()
        self.box.act("sign_off", "Home", self.box.document.runs()[0].identity, "Anna")

    def standing(self) -> None:
        boards: List[PublicBoard] = []
        subscriber = rospy.Subscriber("/core/public_board", PublicBoard, lambda m: boards.append(m) or happened())
        self.addCleanup(subscriber.unregister)
        wait_until(lambda: boards and boards[-1].results, "the board has the result")
        board = boards[-1]
        self.assertEqual([result.event.team for result in board.results], ["Alpha"])
        self.assertEqual(board.provisional, [])
        (standing,) = board.standings
        self.assertEqual((standing.benchmark, standing.criteria), ("Getting to know my home", ["Sum of the sheet"]))
        self.assertEqual([(rank.rank, rank.team, rank.numbers) for rank in standing.ranks], [("1", "Alpha", ["1"])])

    def finished(self) -> None:
        (result,) = wait_until(lambda: self.newest.finished, "the result is published")
        self.assertEqual((result.event.team, result.event.run, result.end_reason), ("Alpha", 3, "completed"))
        self.assertLess(abs(result.disconnected.to_sec() - self.newest.clock.to_sec()), 30.0)
        scores = {(group.group_name, desc): value for group in result.scoring
                  for desc, value in zip(group.descriptions, group.current_values)}
        self.assertEqual({item for item, value in scores.items() if value}, {DOOR})
        wait_until(lambda: not self.newest.runs and ("Home", "Alpha", 4) in self.follow(), "the next event follows")
