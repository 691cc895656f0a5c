"""A robot's commands to the home devices and the tablet's display.

They are obeyed in HCFGAC only; in every other benchmark they are ignored and that is said once
(benchmarks). Robots repeat their wishes in every message, so a command is obeyed once per change: a
value that is merely repeated never undoes what the referee operated since. The first values count as
a change.
"""

from typing import List, NamedTuple, Optional, Tuple

from roah_rsbb.core.messages import RobotReport

# The benchmark in which devices and tablet may be commanded.
CATERING = "HCFGAC"
SWITCHES = ("switch_1", "switch_2", "switch_3")
PERCENTAGES = ("dimmer", "blinds")
FIELDS = SWITCHES + PERCENTAGES + ("display_map",)

# Values of FIELDS in one message.
Wishes = Tuple[object, ...]
NO_WISHES: Wishes = (None,) * len(FIELDS)


class Taken(NamedTuple):
    """What follows from one message."""

    commands: List[Tuple[str, int]]  # device and value: switches 0 or 1, the others per cent
    display_map: Optional[bool]  # switch the tablet to this; None: leave it
    problems: List[str]  # for the referee


class DeviceCommands:
    """The wishes of the robot in one run."""

    def __init__(self, code: str, left_over: Wishes = NO_WISHES) -> None:
        """`left_over`: what this robot wished last in its previous run. A client of 2015 repeats that in
        its first message on a new channel (wire protocol, State machines), where it means nothing."""
        self._obeys = code == CATERING
        self._code = code
        self._left_over: Optional[Wishes] = left_over if left_over != NO_WISHES else None
        self._told_ignored = False
        self.wishes: Wishes = NO_WISHES

    def take(self, report: RobotReport) -> Taken:
        """Take a fresh message; only what changed since the message before is a command."""
        wishes = tuple(getattr(report, field) for field in FIELDS)
        taken = Taken([], None, [])
        first, self._left_over = self._left_over, None
        if wishes == first or wishes == NO_WISHES:
            return taken
        before, self.wishes = self.wishes, wishes
        if not self._obeys:
            return taken._replace(problems=self._tell_ignored())
        for field, old, new in zip(FIELDS, before, wishes):
            if new is None or new == old:
                continue
            if field == "display_map":
                taken = taken._replace(display_map=bool(new))
            elif field in PERCENTAGES and new > 100:
                taken.problems.append(f"Robot sets {field} to {new}: not obeyed, it takes 0 to 100 per cent")
            else:
                taken.commands.append((field, int(new)))
        return taken

    def _tell_ignored(self) -> List[str]:
        if self._told_ignored:
            return []
        self._told_ignored = True
        return [f"Robot commands devices or tablet in {self._code}: ignored, only {CATERING} has that"]
