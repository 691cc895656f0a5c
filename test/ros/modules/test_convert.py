"""Messages between core and modules survive the conversion to ROS messages, or become harmless."""

import io
import math
import random
import unittest

from helpers.forms import ODD
from helpers.random_sheets import random_form, random_mark
from roah_rsbb.bmbox.host.limits import MAX_LIST, MAX_TEXT
from roah_rsbb.core.views.sheets import sheet_items
from roah_rsbb.model.clock import Now
from roah_rsbb.model.fields import form_text
from roah_rsbb.model.modules import (
    ModuleInfo,
    ModulesState,
    OutcomeKind,
    Progress,
    Request,
    RequestKind,
    RequestOutcome,
    RunForModule,
    ScoreValue,
    Step,
)
from roah_rsbb.model.scoring import ScoreGroup, ScoreKind, ScoringItem
from roah_rsbb.msg import ModuleOutcome, ModuleRequest, ModuleRuns
from roah_rsbb.msg import ModulesState as ModulesStateMsg
from roah_rsbb.ros.modules.convert import (
    group_message,
    modules_state_message,
    modules_state_of,
    old_groups,
    runs_message,
    runs_of,
)
from roah_rsbb.scoring.book import RunBook

GOAL = Request(
    2, RequestKind.GOAL, "Waypoint 1", form_text(ODD), "[1, 2, 3]", (1.0, -2.0, 3.0), (True, False), (2, 1), 15.5,
    '{"ä": 1}',
)
PROGRESS = Progress(
    "HNF-1", 2, GOAL, (ScoreValue("waypoint 1", "time", "1.5", "s", "Time"),), "under way", ("old",), '{"sum": 1}',
    True, "",
)
RUN = RunForModule(
    "HNF-1", 2, "Home", "HNF", "Alpha", 3, 4, True, "stopped", 12.5, 120.0, 600.0, 1.25e9,
    (ScoreGroup("Penalized", ((ScoringItem("Penalized", "Bumps", ScoreKind.UINT), 3),
                              (ScoringItem("Penalized", "Sings", ScoreKind.BOOL), 1))),),
    (
        Step(Request(1, RequestKind.REFEREE, "Place it"),
             RequestOutcome(OutcomeKind.DONE, '{"a": 1}', ended_utc=1.5e9)),
        Step(GOAL, RequestOutcome(OutcomeKind.TIMED_OUT, "", "{x: 1}", 14.25, 1.5e9, (1, 2, 1), 3)),
        Step(Request(3, RequestKind.NOTE)),
    ),
    '{"sum": 1}',
)


def sent(message):
    """A message as it arrives on the other side."""
    buffer = io.BytesIO()
    message.serialize(buffer)
    return type(message)().deserialize(buffer.getvalue())


class TestSheets(unittest.TestCase):
    """What panels get of a score sheet: what the original's messages can show."""

    def test_random_sheets(self) -> None:
        for seed in range(30):
            chance = random.Random(seed)
            form = random_form(chance)
            book, now = RunBook(form), Now(100.0, 1.5e9)
            for _ in range(30):
                now = now.later(2.0)
                book.mark(now, "Anna", random_mark(chance, form))
            items, _ = book.counted("")
            for old in (list(map(group_message, book.sheet.groups())), old_groups(sheet_items(items, form))):
                found = {(g.group_name, d): (t, v) for g in old
                         for t, d, v in zip(g.types, g.descriptions, g.current_values)}
                self.assertEqual(found, {
                    i.key: (0 if i.kind == "bool" else 1, max(0, i.value)) for i in items
                    if i.kind not in ("choice", "rating")})


class TestModuleConvert(unittest.TestCase):
    def test_what_a_module_says(self) -> None:
        state = ModulesState("node", (ModuleInfo("HNF", ("wrong",), ("old",)),), (PROGRESS, Progress("STB-1", 1)))
        self.assertEqual(modules_state_of(sent(modules_state_message(state))), state)

    def test_what_the_core_says(self) -> None:
        runs = (RUN, RunForModule("STB-2", 0, "Door", "STB", "Beta", 1, 1, False))
        message = sent(runs_message("box", runs))
        self.assertEqual((message.box_uuid, runs_of(message)), ("box", runs))

    def test_reports_about_modules_are_limited_before_they_are_sent(self) -> None:
        info = ModuleInfo("HNF", ("a\ud800",), ("x" * 5000,) * 200)
        message = sent(modules_state_message(ModulesState("n", (info,), ())))
        self.assertEqual(message.modules[0].problems, ["a?"])
        self.assertEqual([len(text) for text in message.modules[0].warnings], [MAX_TEXT] * MAX_LIST)

    def test_progress_beyond_the_limits_ends_its_run_on_arrival(self) -> None:
        wild = PROGRESS._replace(request=GOAL._replace(pose=(math.nan,) * 5))
        progress = modules_state_of(sent(modules_state_message(ModulesState("n", (), (wild, PROGRESS))))).progress
        self.assertEqual((progress[0].request, progress[1]), (None, PROGRESS))
        self.assertIn("x, y and theta must be finite numbers", progress[0].failed)

    def test_what_another_version_asks_for(self) -> None:
        message = modules_state_message(ModulesState("n", (), (PROGRESS,)))
        message.progress[0].request.kind = 77
        self.assertIn("its request has the unknown kind 77", modules_state_of(sent(message)).progress[0].failed)
        message.progress[0].request.pose = [1.0]
        message.progress[0].request.kind = ModuleRequest.GOAL
        self.assertIn("its goal's pose is (1.0,)", modules_state_of(sent(message)).progress[0].failed)

    def test_a_run_that_cannot_be_read_is_left_out(self) -> None:
        for field, kind in (("request", 77), ("request", 0), ("outcome", 77)):
            message = runs_message("box", (RUN, RUN._replace(run="STB-9")))
            getattr(message.runs[0].steps[0], field).kind = kind
            self.assertEqual([run.run for run in runs_of(sent(message))], ["STB-9"])

    def test_arrays_that_do_not_fit_each_other(self) -> None:
        message = runs_message("box", (RUN,))
        message.runs[0].sheet[0].types = bytes([9])
        group = runs_of(sent(message))[0].sheet[0]
        self.assertEqual(group.items, ((ScoringItem("Penalized", "Bumps", ScoreKind.UINT), 3),))

    def test_noise_never_raises(self) -> None:
        """Every byte of good messages changed at random: those that ROS can read, we can convert."""
        rng = random.Random(4)
        read = 0
        for good, convert in (
            (modules_state_message(ModulesState("node", (ModuleInfo("HNF"),), (PROGRESS,))), modules_state_of),
            (runs_message("box", (RUN,)), runs_of),
        ):
            buffer = io.BytesIO()
            good.serialize(buffer)
            for _ in range(3000):
                noisy = bytearray(buffer.getvalue())
                for _ in range(rng.randint(1, 5)):
                    noisy[rng.randrange(len(noisy))] = rng.randrange(256)
                try:
                    message = type(good)().deserialize(bytes(noisy))
                except Exception:  # whatever ROS itself refuses never reaches us
                    continue
                read += 1
                made = convert(message)
                if isinstance(made, ModulesState):
                    sent(modules_state_message(made))
        self.assertGreater(read, 1000)

    def test_the_numbers_are_those_of_the_messages(self) -> None:
        for kind in RequestKind:
            self.assertEqual(getattr(ModuleRequest, kind.name), kind)
        for kind in OutcomeKind:
            self.assertEqual(getattr(ModuleOutcome, kind.name), kind)
        self.assertEqual(runs_of(ModuleRuns()), ())
        self.assertEqual(modules_state_of(ModulesStateMsg()), ModulesState(""))
