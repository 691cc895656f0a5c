"""What a robot reports besides its state: online data, and commands to the home devices and the tablet's display.

Online data are strings that a robot sends until they are acknowledged. The box logs a string once. It logs the same
text again only if a message without it came in between (docs/protocol.md, "Repeated strings"). Here are also the lines
of logs for panels.

Commands are obeyed in benchmarks that use devices or tablet. In every other benchmark they are ignored, which is
reported once (docs/benchmarks.md, "The table"). Robots repeat their commands in every message. Therefore each change is
obeyed once, and a repeated value never undoes what the referee operated in the meantime. The first values count as a
change, except those of the first message, in which an original client can repeat the commands of its previous run. From
the next message on, an original client sends off for every device, which counts (docs/protocol.md, "Device commands").
"""

from dataclasses import dataclass
from typing import Dict, List, NamedTuple, Optional, Sequence, Tuple

from roah_rsbb.core.settings import Budget
from roah_rsbb.model.clock import Now
from roah_rsbb.model.messages import RobotReport
from roah_rsbb.protocol import PERCENTAGES, SWITCHES
from roah_rsbb.rulebook.benchmarks import Benchmark
from roah_rsbb.rulebook.registry import DEVICES, TABLET
from roah_rsbb.wording.texts import escaped

# The texts of the last message, by the name of the repeated field.
Strings = Dict[str, Tuple[str, ...]]


def receive(last: Strings, field: str, texts: Sequence[str]) -> List[str]:
    """Put the texts of one field of a fresh message into `last`. Return the new ones, in their order."""
    if not texts:
        last.pop(field, None)
        return []
    unique = dict.fromkeys(texts)
    before = frozenset(last.get(field, ()))
    last[field] = tuple(unique)
    return [text for text in unique if text not in before]


class Said(NamedTuple):
    """What a robot said, for spectators."""

    utc: float
    kind: str  # the name of the repeated field
    text: str  # one line, shortened


# Spectators read the newest ones.
MAX_SAID = 5
_MAX_SAID_SIGNS = 160


def said(now: Now, kind: str, text: str) -> Said:
    """Return a robot's text as spectators may read it: one line without control characters, and short."""
    line = " ".join("".join(sign if sign.isprintable() else " " for sign in text).split())
    return Said(now.utc, kind, line if len(line) <= _MAX_SAID_SIGNS else f"{line[:_MAX_SAID_SIGNS - 1].rstrip()}…")


class StringsBudget:
    """Limits the new strings of one robot that are logged. Each is an entry of the run log and of the journal.

    A robot normally sends something new a few times a minute. A robot that always sends something new would fill the
    disk and delay the other zones.
    """

    STRINGS_AT_ONCE, STRINGS_PER_SECOND = 500, 50
    CHARACTERS_AT_ONCE, CHARACTERS_PER_SECOND = 50_000, 5_000

    def __init__(self) -> None:
        self._strings = Budget(self.STRINGS_AT_ONCE, self.STRINGS_PER_SECOND)
        self._characters = Budget(self.CHARACTERS_AT_ONCE, self.CHARACTERS_PER_SECOND)

    def take(self, now: Now, text: str) -> bool:
        """Whether to log this string."""
        return self._strings.take(now.mono, 1) and self._characters.take(now.mono, len(text))


def with_line(text: str, line: str, size: int) -> str:
    """Add a line to a text, of which only the last `size` characters are kept (`display_log_size`).

    Whole lines are dropped where possible. A robot's text stays in one line, so it cannot imitate other lines.
    """
    text = f"{text}{escaped(line)}\n"
    start = max(0, len(text) - size)
    if start > 0 and text[start - 1] != "\n":
        next_line = text.index("\n", start) + 1
        # If the line itself is longer than `size`, its end is kept.
        start = next_line if next_line < len(text) else start
    return text[start:]


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
