"""A robot's commands to the home devices and the tablet's display.

They are obeyed in benchmarks that use devices or tablet. In every other benchmark they are ignored, which is reported
once (docs/benchmarks.md, "The table"). Robots repeat their commands in every message. Therefore each change is obeyed
once, and a repeated value never undoes what the referee operated in the meantime. The first values count as a change,
except those of the first message, in which an original client can repeat the commands of its previous run. From the
next message on, an original client sends off for every device, which counts (docs/protocol.md, "Device commands").
"""

from dataclasses import dataclass
from typing import List, NamedTuple, Optional, Tuple

from roah_rsbb.model.messages import RobotReport
from roah_rsbb.protocol import PERCENTAGES, SWITCHES
from roah_rsbb.rulebook.benchmarks import Benchmark
from roah_rsbb.rulebook.registry import DEVICES, TABLET

FIELDS = SWITCHES + PERCENTAGES + ("display_map",)

# Values of FIELDS; None: no command.
Wishes = Tuple[object, ...]
NO_WISHES: Wishes = (None,) * len(FIELDS)


class Taken(NamedTuple):
    """The consequences of a message."""

    commands: List[Tuple[str, int]]  # device and value: switches 0 or 1, the others per cent
    display_map: Optional[bool]  # the tablet's new view; None: unchanged
    problems: List[str]  # for the referee


@dataclass
class DeviceCommandsState:
    """The commands that were obeyed in a run. Repetitions of these are not obeyed again."""

    had_first: bool = False
    told_ignored: bool = False
    wishes: Wishes = NO_WISHES


class DeviceCommands:
    """The robot's commands in one run."""

    def __init__(self, benchmark: Benchmark, state: Optional[DeviceCommandsState] = None) -> None:
        uses = benchmark.profile.uses
        self._obeyed: Tuple[str, ...] = SWITCHES + PERCENTAGES if DEVICES in uses else ()
        if TABLET in uses:
            self._obeyed += ("display_map",)
        self._code = benchmark.code
        self.state = state or DeviceCommandsState()

    def take(self, report: RobotReport) -> Taken:
        """Take a fresh message. A command is only what changed since the earlier messages."""
        taken = Taken([], None, [])
        wishes = tuple(getattr(report, field) for field in FIELDS)
        had_first, self.state.had_first = self.state.had_first, True
        if not had_first or wishes == NO_WISHES:
            return taken
        if any(value is not None and field not in self._obeyed for field, value in zip(FIELDS, wishes)):
            taken.problems.extend(self._report_ignored())
        # A field that the robot stops sending is no command, and its last value is kept.
        before = self.state.wishes
        self.state.wishes = tuple(old if new is None else new for old, new in zip(before, wishes))
        for field, old, new in zip(FIELDS, before, self.state.wishes):
            if not isinstance(new, int) or new == old or field not in self._obeyed:
                continue
            if field == "display_map":
                taken = taken._replace(display_map=bool(new))
            elif field in PERCENTAGES and new > 100:
                taken.problems.append(f"Robot sets {field} to {new}: ignored, because the range is 0 to 100 per cent")
            else:
                taken.commands.append((field, int(new)))
        return taken

    def _report_ignored(self) -> List[str]:
        if self.state.told_ignored:
            return []
        self.state.told_ignored = True
        return [f"Robot commands devices or tablet, which {self._code} does not use: ignored"]
