"""The head referee in the terminal: a run with two judges, from their differences to the final result."""

import json
import uuid
from typing import Any, Dict, List

from support.box_case import BoxCase
from support.referee_program import called
from support.waiting import wait_until

HALL = "Hall"
OBJECTS, EMPTY, SHOW = ("Table", "Objects put away"), ("Table", "Table is empty"), ("Show", "Presentation")
BY = ("--by", "Hugo")


class TestJudges(BoxCase):
    """`referee judges`."""

    def setUp(self) -> None:
        super().setUp()
        self.box.command("open_sheet", HALL, again=True)
        self.box.start(HALL)
        self.identity = self.box.zone_details(HALL).identity

    def over(self) -> None:
        """Leave the run."""
        self.box.command("stop", HALL)
        self.box.command("disconnect", HALL)

    def mark(self, judge: str, item: tuple, value: int = 0, text: str = "") -> None:
        """A judge marks an item."""
        self.box.act("judge_mark", HALL, self.identity, judge=judge, id=str(uuid.uuid4()), group=item[0], desc=item[1],
                     value=value, text=text)

    def submit(self, judge: str, objects: int, rating: str = "") -> None:
        """A judge fills in a sheet, and submits it."""
        self.mark(judge, OBJECTS, objects)
        if rating:
            self.mark(judge, SHOW, text=rating)
        self.box.act("submit", HALL, self.identity, judge=judge)

    def judges(self, action: str, *words: str, status: int = 0) -> str:
        """Call `referee judges ACTION Hall`; returns what it prints."""
        run = () if action == "list" and not words else ("--run", self.identity)
        done = called("judges", action, HALL, *words, *run)
        self.assertEqual(done.returncode, status, done.stdout + done.stderr)
        return done.stdout if status == 0 else done.stderr

    def shown(self) -> Dict[str, Any]:
        """The run, as JSON."""
        return json.loads(self.judges("list", "--json"))

    def outcomes(self) -> List[str]:
        """What became of the items."""
        return [item["outcome"] for item in self.shown()["items"]]

    def test_from_differences_to_the_final_result(self) -> None:
        self.submit("Ann", 2, "7")
        self.assertIn("Sheets that are missing: 1 of 2", self.judges("list", "--run", self.identity))
        self.assertIn("1 of 2 judges have not submitted", self.judges(
            "settle", "1", "3", "--reason", "early", *BY, status=1))
        self.submit("Ben", 3, "8")
        self.assertIn("Objects put away: ≠ differs  (Ann 2, Ben 3)", self.judges("list", "--run", self.identity))
        self.assertEqual(self.outcomes(), ["differs", "agreed", "agreed"])
        self.assertIn("looks again (count once more)",
                      self.judges("hand-back", "ben", "--reason", "count once more", *BY))
        self.assertEqual(self.outcomes(), [])
        self.submit("Ben", 4)
        self.assertIn("Settled by Hugo: the video shows it",
                      self.judges("settle", "objects", "3", "--reason", "the video shows it", *BY))
        self.judges("settle", "presentation", "7.25", "--reason", "halfway", *BY)
        self.judges("settle", "empty", "not-attempted", "--reason", "time was over", *BY)
        self.assertEqual([(item["shown"], item["who"]) for item in self.shown()["items"]],
                         [("3", "Hugo"), ("not attempted", "Hugo"), ("7.25", "Hugo")])
        self.assertIn("is still connected", self.judges("publish", *BY, status=1))
        self.over()
        self.judges("publish", "--minutes", "60", *BY)
        self.assertIn("no objection 1", self.judges("answer", "1", "uphold", "yes", *BY, status=1))
        self.assertIn("not answered", self.judges("object", "Epsilon", "the cup was away", *BY))
        self.judges("answer", "1", "reject", "it was there", *BY)
        self.assertEqual([(one["by"], one["upheld"], one["answer"]) for one in self.shown()["objections"]],
                         [("Epsilon", False, "it was there")])
        sign_off = ("sign-off", HALL, "--run", self.identity, "--yes", *BY)
        refused = called(*sign_off)
        self.assertEqual(refused.returncode, 1)
        self.assertIn("objections are possible until", refused.stderr)
        self.judges("publish", "--minutes", "0", *BY)
        self.assertEqual(called(*sign_off).returncode, 0)
        wait_until(lambda: self.identity not in called("judges", "list").stdout, "the final result is not listed")

    def test_a_judge_who_leaves(self) -> None:
        self.submit("Ann", 2, "7")
        self.mark("Ben", EMPTY, 1)
        self.assertIn("… Ben: is judging", self.judges("list", "--run", self.identity))
        self.assertNotIn("Ben", self.judges("withdraw", "Ben", "--reason", "left the hall", *BY))
        self.assertIn("'Ben' has no sheet of this run", self.judges(
            "withdraw", "Ben", "--reason", "again", *BY, status=1))
        self.assertIn("Missing judges are not waited for: nobody else is here",
                      self.judges("end-waiting", "--reason", "nobody else is here", *BY))
        self.assertEqual(self.outcomes(), ["agreed", "agreed", "agreed"])

    def test_wrong_words(self) -> None:
        self.assertIn("no scoring item 'cup'", self.judges("settle", "cup", "1", "--reason", "x", *BY, status=2))
        self.assertIn("is not a value", self.judges("settle", "1", "many", "--reason", "x", *BY, status=2))
        for words in ((), ("--by", "Ann")):
            self.assertIn("2 judges score this benchmark", called("score", HALL, "presentation", "7", *words).stderr)
        self.assertEqual(called("judges", "list", "--run", "last").returncode, 2)
