"""Forms of benchmarking modules, and what is answered."""

import json

from roah_rsbb.model.actions import Shown
from roah_rsbb.model.fields import Choice, Decimal, Fixed, Number, Toggle, TypedPose
from roah_rsbb.model.modules import form_of_one
from roah_rsbb.model.reason import say

# What no module of this package asks for.
ODD = (
    Toggle("held", say("Did the robot hold it?")), Number("drops", say("How often did it fall?"), high=9),
    Choice("place", say("Where is it now?"), choices=("table", "floor")), TypedPose("pose", say("Pose of the cup")),
)
ODD_VALUES = {"held": True, "drops": 2, "place": "floor", "pose": "1.25 0,40 90"}
ODD_ASKED = "Look at the cup, and measure where it is"
MEASURED = Decimal("height", say("Height"), low=0.0, high=2.5, unit="m")


def form(*choices, asks_text=False):
    """The form of one answer, as `Module.referee` makes it."""
    return form_of_one(choices, asks_text)


def answer_in(outcome):
    """The one answer in an outcome."""
    return json.loads(outcome.values or "{}").get("answer", "")


def shown_form(number, fields, text=""):
    """The action `operation` as the core shows it."""
    return Shown((), True, (Fixed("operation", say("Number"), required=False, default=number), *fields), text)
