"""A score sheet from the first mark to the sign-off, through a restart of the core."""

import threading
from typing import Optional
from unittest import mock

import rospy
from support.box_case import BoxCase
from support.box_client import Refusal
from support.waiting import LIMIT_S, wait_until

from roah_rsbb.document.written import read
from roah_rsbb.model.results import RunLine, RunSheet
from roah_rsbb.model.scoring import Entered
from roah_rsbb.referee import link as terminal

ZONE = "Scores"
DOOR = ("Achievements", "Detects the door whose state has changed")
FURNITURE = ("Achievements", "Detects a piece of moved furniture")
BUMPS = ("Penalized Behaviors", "Bumps into the furniture")


class TestScores(BoxCase):
    def setUp(self) -> None:
        super().setUp()
        self.node = rospy.get_name()

    def sheet(self, identity: str = "") -> RunSheet:
        """The sheet of a run; of the connected one without an identity."""
        return read(RunSheet, self.box.ask("sheet", zone=ZONE, run=identity))

    def summary(self, identity: str) -> Optional[RunLine]:
        """The run in the newest document; None: it is not there."""
        return self.box.document.results.get(identity)

    def values(self, identity: str):
        """Return the values of the scored items."""
        return {
            item.desc: "-" if item.not_attempted else item.value
            for item in self.sheet(identity).items if item.value or item.not_attempted
        }

    def restart_core(self) -> None:
        self.kill_core()

    def test_from_the_first_mark_to_the_sign_off(self) -> None:
        self.robot("Beta")
        self.box.connect(ZONE)
        self.box.start(ZONE)
        identity = self.box.wait_details(ZONE, lambda d: d.identity, "the run has a name")
        wait_until(lambda: self.summary(identity), "the results name the run")

        for step in (self.marks, self.refusals, self.stop, self.corrections, self.sign_off):
            step(identity)

    def marks(self, identity: str) -> None:
        self.box.set_score(ZONE, *DOOR, 1)
        self.mark(identity, BUMPS, "Anna", value=2, note="the vase")
        self.mark("", FURNITURE, not_attempted=True)
        self.assertEqual(self.values(identity), {DOOR[1]: 1, BUMPS[1]: 2, FURNITURE[1]: "-"})
        history = self.sheet().history
        self.assertEqual([(e.number, e.who, e.item, e.note) for e in history], [
            (1, self.node, DOOR[1], ""),
            (2, f"Anna ({self.node})", BUMPS[1], "the vase"),
            (3, self.node, FURNITURE[1], ""),
        ])
        self.box.act("withdraw", ZONE, identity, "Ben", entry=2, note="another robot")
        self.assertEqual(self.values(identity), {DOOR[1]: 1, FURNITURE[1]: "-"})
        withdrawn = self.sheet().history[1]
        self.assertEqual((withdrawn.withdrawn_by, withdrawn.withdrawn_note), (f"Ben ({self.node})", "another robot"))
        self.assertGreaterEqual(withdrawn.withdrawn_utc_s, withdrawn.utc_s)
        self.box.wait_scored(ZONE, (*BUMPS, 1, 0))  # panels see the withdrawal
        wait_until(lambda: "not attempted)" in self.summary(identity).score, "and what was not attempted")

    def refusals(self, identity: str) -> None:
        for name, value, why in ((identity, 2, "0 or 1"), ("HWV-1-2", 1, "'HWV-1-2' is not one of")):
            with self.assertRaisesRegex(Refusal, why):
                self.mark(name, DOOR, value=value)
        for action, given, why in (
            ("withdraw", {"entry": 9}, "no entry 9: choose from 1, 3"),
            ("stop_reason", {"reason": "why"}, "was not stopped yet"),
            ("sign_off", {}, "still connected: disconnect it first"),
        ):
            with self.assertRaisesRegex(Refusal, why):
                self.box.act(action, ZONE, identity, "Anna", **given)

    def stop(self, identity: str) -> None:
        self.box.command("stop", ZONE)
        self.box.act("stop_reason", ZONE, identity, "Anna", reason="fire alarm")
        (stop,) = self.sheet().ends
        self.assertEqual((stop.who, stop.end_reason, stop.reason, stop.reason_by),
                         (self.node, "stopped", "fire alarm", f"Anna ({self.node})"))
        log = self.leave(ZONE)
        self.assertEqual([(s.desc, s.value) for s in log.messages("/rsbb_log/score")],
                         [(DOOR[1], 1), (BUMPS[1], 2), (FURNITURE[1], 0), (BUMPS[1], 0)])

    def corrections(self, identity: str) -> None:
        wait_until(lambda: self.summary(identity).closed_utc_s, "the results say that the run is over")
        self.mark(identity, BUMPS, "Anna", value=4, note="seen on video")
        wait_until(lambda: self.summary(identity).corrected, "the correction is marked")
        before = self.sheet(identity)
        self.restart_core()
        self.assertEqual(self.sheet(identity), before)
        self.box.act("withdraw", ZONE, identity, "Anna", entry=1)
        self.assertEqual(self.values(identity), {FURNITURE[1]: "-", BUMPS[1]: 4})
        self.assertEqual({i.desc for i in self.sheet(identity).items if i.corrected}, {DOOR[1], BUMPS[1]})

    def sign_off(self, identity: str) -> None:
        self.box.act("sign_off", ZONE, identity, "Cleo")
        wait_until(lambda: self.summary(identity).signed_utc_s, "the run is signed off")
        self.assertEqual(self.summary(identity).signed_by, f"Cleo ({self.node})")
        self.restart_core()
        self.assertEqual(self.summary(identity).signed_by, f"Cleo ({self.node})")
        with self.assertRaisesRegex(Refusal, r"signed off by Cleo \(.*\) at .*: it is final"):
            self.mark(identity, BUMPS, "Anna", value=5)

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
        self.restart_core()
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
