"""Marks of several referees at once, through a restart of the core."""

import threading
from unittest import mock

import rospy
from support.box_case import BoxCase
from support.box_client import Refusal
from support.waiting import LIMIT_S

from roah_rsbb.model.as_json import from_json
from roah_rsbb.model.results import RunSheet
from roah_rsbb.model.scoring import Entered
from roah_rsbb.referee import link as terminal

ZONE = "Scores"
BUMPS = ("Penalized Behaviors", "Bumps into the furniture")


class TestScores(BoxCase):
    def setUp(self) -> None:
        super().setUp()
        self.node = rospy.get_name()

    def sheet(self, identity: str = "") -> RunSheet:
        """The sheet of a run; of the connected one without an identity."""
        return from_json(RunSheet, self.box.ask("sheet", zone=ZONE, run=identity))

    def values(self, identity: str):
        """Return the values of the scored items."""
        return {
            item.desc: "-" if item.not_attempted else item.value
            for item in self.sheet(identity).items if item.value or item.not_attempted
        }

    def add(self, identity: str, mark_id: str, device: str = "", added: int = 1):
        """Count bumps."""
        return self.mark(identity, BUMPS, "Anna", added=str(added), id=mark_id, role="referee", device=device)

    def mark(self, identity: str, item: tuple, referee: str = "", **given: object):
        """Mark an item; returns the core's answer."""
        return self.box.act("mark", ZONE, identity, referee, group=item[0], desc=item[1], **given)

    def test_counts_of_several_referees_add_up_and_each_mark_counts_once(self) -> None:
        self.box.command("open_sheet", ZONE)
        self.box.command("start", ZONE)
        identity = self.box.wait_details(ZONE, lambda d: d.identity, "the sheet has a name")
        failed = []

        def referee(name: str) -> None:
            try:
                for number in [*range(10), *range(10)]:
                    self.add(identity, f"{name} {number}", name)
            except Exception as error:
                failed.append(error)

        referees = [threading.Thread(target=referee, args=(f"phone {n}",)) for n in range(3)]
        for thread in referees:
            thread.start()
        for thread in referees:
            thread.join()
        self.assertEqual((failed, self.values(identity)), ([], {BUMPS[1]: 30}))
        known = {entry.who for entry in self.sheet(identity).history}
        self.assertEqual(known, {f"Anna, phone {n} ({self.node})" for n in range(3)})
        self.kill_core()
        self.assertEqual(self.add(identity, "phone 0 0")["value"], 30)
        answer = self.add(identity, "undo", added=-1)
        self.assertEqual(answer["value"], 29)
        self.box.act("withdraw", ZONE, identity, "Anna", entry=answer["number"])
        self.assertEqual(self.values(identity), {BUMPS[1]: 30})
        with self.assertRaisesRegex(Refusal, "its value must be 0 or more, not -1"):
            self.add(identity, "too many", added=-31)
        self.box.command("disconnect", ZONE)
        self.assertEqual(self.add(identity, "phone 1 1")["value"], 30, "also of a run that is over")

    def test_marks_of_a_terminal_during_a_restart_count_once(self) -> None:
        self.box.command("open_sheet", ZONE)
        identity = self.box.wait_details(ZONE, lambda d: d.identity, "the sheet has a name")
        link = terminal.Link()
        self.addCleanup(link.close)
        link.start()
        link.open(LIMIT_S)
        (item,) = [item for item in link.box.zones[ZONE].items if item.desc == BUMPS[1]]
        killed, failed = threading.Event(), []

        def referee() -> None:
            try:
                for number in range(20):
                    link.mark(ZONE, identity, item, Entered(added="1"), "Anna")
                    if number == 10:
                        killed.set()
            except Exception as error:
                failed.append(error)

        with mock.patch.object(terminal, "ANSWER_S", LIMIT_S):
            thread = threading.Thread(target=referee)
            thread.start()
            killed.wait(LIMIT_S)
            self.kill_core()
            thread.join()
        self.assertEqual((failed, self.values(identity)), ([], {BUMPS[1]: 20}))
