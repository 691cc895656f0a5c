"""A run that several judges score, in simulated time."""

import pytest

from helpers.commands import mark_with
from helpers.competition import BUMPS, DOOR, competition, event
from roah_rsbb.model.as_json import to_json
from roah_rsbb.model.reason import Refused, RunName
from roah_rsbb.model.scoring import Agreement, JudgesRule
from roah_rsbb.scoring.sheet import Mark


def judged(count=2, agreement=Agreement.ALL_AGREE, items=(DOOR, BUMPS), **of_benchmark):
    """A competition whose zone tbm has an event with several judges."""
    return competition(
        tbm=[event(scoring=items, judges=JudgesRule(count, agreement), **of_benchmark)], other=["HWV"])


class Jury:
    """A box whose run is scored by several judges."""

    def __init__(self, driver):
        self.driver = driver
        self.driver.executing()
        self.name = RunName("tbm", driver.run_in().identity)
        self.desk = driver.box.judges
        self.marks = 0

    def mark(self, judge, item, value=0, **of_mark):
        self.marks += 1
        self.driver.run(2.0)
        mark = Mark(*item.key, value, id=f"m{self.marks}", judge=judge, **of_mark)
        self.driver.enter("judge_mark", self.name, **mark_with(mark))

    def submit(self, judge):
        self.driver.run(2.0)
        self.driver.enter("submit", self.name, judge=judge)

    def settle(self, item, value, reason="the video shows it", who="Hugo", **of_mark):
        self.driver.enter("settle", self.name, who, reason=reason, **mark_with(Mark(*item.key, value, **of_mark)))

    def refused(self, method, *arguments):
        """Return the reasons of a refusal, which changes nothing."""
        before = to_json(self.record())
        with pytest.raises(Refused) as refused:
            self.driver.event(method, *arguments)
        assert to_json(self.record()) == before
        return refused.value.reasons

    def finish(self):
        self.driver.command("stop")
        self.driver.command("disconnect")

    def record(self):
        return self.driver.box.scores.record_of(self.driver.now, self.name)._replace(elapsed_s=0.0)

    def judging(self, judge=""):
        return self.driver.box.judges.judging(self.driver.now, self.name, judge)

    def values(self):
        return {item.desc: "-" if item.not_attempted else item.text or item.value for item in self.record().items}

    def sign_off(self):
        self.driver.enter("sign_off", self.name, "Hugo")
