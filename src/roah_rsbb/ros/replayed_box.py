"""A box that shows an earlier run again, from its states in the journal. No ROS.

The box is the core's own, and a state is put into it as after a restart. What the journal does not have stays empty:
active robots, home devices, the tablet, what benchmarking modules report, and the results of other runs. All times on
the monotonic clock are moved so that they equal UTC. One moment then means the same in all starts of the core.
"""

import bisect
import os
from typing import Dict, Iterable, List, NamedTuple, Optional, Sequence, Tuple

from roah_rsbb.core.box import Box
from roah_rsbb.core.settings import Settings
from roah_rsbb.core.zones import ZoneState
from roah_rsbb.journal.log_dir import CONFIGURATION, kept_files
from roah_rsbb.journal.reader import JournalReader
from roah_rsbb.model.as_json import BadData, from_json
from roah_rsbb.model.clock import Now
from roah_rsbb.model.records import RunRecord
from roah_rsbb.results.runs import (
    LinkSecond,
    RunMoment,
    RunResult,
    clock_text,
    find_record,
    run_moments,
    run_result,
    run_state_of,
    without_step,
)
from roah_rsbb.rulebook import config
from roah_rsbb.rulebook.benchmarks import Config
from roah_rsbb.rulebook.decisions import beside
from roah_rsbb.rulebook.errors import known
from roah_rsbb.wording import sheets
from roah_rsbb.wording.texts import one_line

# A box needs one for each team, and a replay sends nothing.
NO_PASSWORD = "none"
OTHER_FILES = "give the files with which the run was conducted, with --benchmarks-file and --schedule-file"


class CannotReplay(Exception):
    """The run cannot be replayed. The text names the remedy."""


class _Change(NamedTuple):
    """A zone has another state from a moment on."""

    utc: float
    zone: str
    moment: Optional[RunMoment]  # None: it has no run

    @property
    def phase(self) -> str:
        """The name of the run's phase; empty: there is no run."""
        return "" if self.moment is None else str(run_state_of(self.moment).get("phase", ""))

    def state(self) -> Optional[ZoneState]:
        """Return the state, with its times moved to UTC. Raises `CannotReplay`."""
        if self.moment is None:
            return None
        try:
            return from_json(ZoneState, self.moment.zone, self.moment.utc - self.moment.mono)
        except BadData as error:
            raise CannotReplay(f"a state in the journal cannot be read ({error}): use the version of this software "
                               "that wrote it") from None


class ReplayedRun(NamedTuple):
    """What the journal has of the run to be replayed, and of the runs in other zones at the same time."""

    name: str
    begin_utc: float
    end_utc: float
    version: int  # of the configuration with which it was connected
    changes: Tuple[_Change, ...]  # in their order
    teams: Tuple[str, ...]
    links: Dict[int, Tuple[LinkSecond, ...]]  # by port


def read_run(reader: JournalReader, word: str, warnings: List[str]) -> ReplayedRun:
    """Read the run with this number or identity. Raises `CannotReplay`, `NotPossible` and JournalError."""
    number, record = find_record(reader, word, warnings.append)
    played, moments = _read(reader, number, record, warnings)
    if not moments:
        raise CannotReplay(
            f"the journal has no states of run {record.identity}: an earlier version of the box wrote it, or it is "
            f"damaged. Its page shows what there is: rosrun roah_rsbb results replay {number}")
    end = played.record.closed_utc or moments[-1].utc
    changes: List[_Change] = []
    links: Dict[int, Tuple[LinkSecond, ...]] = {}
    teams = set()
    for other, run in enumerate(reader.runs(), 1):
        if run.opened_utc > end or (run.closed_utc is not None and run.closed_utc < record.opened_utc):
            continue
        of_run = find_record(reader, run.identity, warnings.append)[1]
        result, known = (played, moments) if other == number else _read(reader, other, of_run, warnings)
        changes += _changes(run.zone, known, None if run.closed_utc is None else result.record.closed_utc)
        for robot in result.robots:
            links[robot.port] = robot.link
            teams.add(robot.team)
    return ReplayedRun(
        one_line(sheets.run_name(record.benchmark, record.team, record.round, record.run)), record.opened_utc, end,
        int(moments[0].zone.get("version", 0)), tuple(sorted(changes, key=lambda change: change.utc)),
        tuple(sorted(teams)), links)


def _read(
    reader: JournalReader, number: int, record: RunRecord, warnings: List[str]
) -> Tuple[RunResult, Sequence[RunMoment]]:
    """Read a run and its states, with the times as if nobody had set the box's clock during the run."""
    result = run_result(reader, number, record, warnings.append)
    moments = run_moments(reader, record.identity, warnings.append)
    return without_step(result, moments) if clock_text(result) else (result, moments)


def _changes(zone: str, moments: Iterable[RunMoment], closed_utc: Optional[float]) -> List[_Change]:
    found = [_Change(moment.utc, zone, moment) for moment in moments]
    return found + ([] if closed_utc is None else [_Change(closed_utc, zone, None)])


def _first_states(run: ReplayedRun) -> Dict[str, ZoneState]:
    """Return the first known state of each zone."""
    found: Dict[str, ZoneState] = {}
    for change in run.changes:
        if change.moment is not None and change.zone not in found:
            found[change.zone] = change.state()
    return found


def configuration(
    log_dir: str, run: ReplayedRun, benchmarks_file: Optional[str], schedule_file: Optional[str]
) -> Config:
    """Return the configuration of a run: the given files, or those that the core kept beside its journal. Passwords
    are not needed. Raises `CannotReplay` and ConfigErrors."""
    paths, texts = [benchmarks_file, schedule_file], {}
    if None in paths:
        kept = kept_files(log_dir, run.version)
        if not {"benchmarks", "schedule"} <= set(kept):
            raise CannotReplay(f"{os.path.join(log_dir, CONFIGURATION)} is missing or cannot be read: copy it with the "
                               "journal, or give --benchmarks-file and --schedule-file")
        for number, name in enumerate(("benchmarks", "schedule")):
            if paths[number] is None:
                paths[number] = os.path.join(log_dir, CONFIGURATION, f"{name}.yaml")
                texts[paths[number]] = kept[name]
        if benchmarks_file is None and "decisions" in kept:
            texts[beside(paths[0])] = kept["decisions"]
    with known(texts):
        benchmarks, zones = config.load_schedule(*paths)
    used = {change.zone for change in run.changes}
    return Config(benchmarks, dict.fromkeys(run.teams, NO_PASSWORD), tuple(z for z in zones if z.name in used))


class ReplayedBox:
    """The box at a moment that only moves forward."""

    def __init__(self, run: ReplayedRun, files: Config) -> None:
        """Raises `CannotReplay`."""
        self._run = run
        self._next = 0  # number of the next change
        self._phases: Dict[str, str] = {}  # of the zones' runs
        self.now = Now(run.begin_utc, run.begin_utc)
        self.box = Box(files, Settings(listen_duration=0.0), lambda beacon: 0)
        self.box.restart.begin_replay(run.name)
        missing = {change.zone for change in run.changes} - set(self.box.zones)
        if missing:
            raise CannotReplay(f"the schedule has no zone {', '.join(sorted(missing))}: {OTHER_FILES}")
        for zone, state in _first_states(run).items():
            self.box.zones[zone].resume_at(state)
        self.show(run.begin_utc)

    @property
    def is_over(self) -> bool:
        """Whether the end of the run is shown."""
        return self.now.utc >= self._run.end_utc

    def show(self, utc: float) -> None:
        """Show the moment, at most the end of the run. It is an earlier one if a phase of a run would be skipped.
        Raises `CannotReplay`."""
        utc = min(utc, self._run.end_utc)
        newest: Dict[str, _Change] = {}
        moved = set()  # zones
        while self._next < len(self._run.changes) and self._run.changes[self._next].utc <= utc:
            change = self._run.changes[self._next]
            if change.phase != self._phases.get(change.zone):
                if change.zone in moved:
                    utc = newest[change.zone].utc
                    break
                moved.add(change.zone)
                self._phases[change.zone] = change.phase
            newest[change.zone] = change
            self._next += 1
        for change in newest.values():
            self._show(change)
        self.now = Now(utc, utc)
        for run in self.box.zones.members():
            self._show_link(run, utc)

    def _show(self, change: _Change) -> None:
        try:
            self.box.restart.show(Now(change.utc, change.utc), change.zone, change.state())
        except ValueError as error:
            raise CannotReplay(f"{error}: {OTHER_FILES}") from None

    def _show_link(self, run, utc: float) -> None:
        """Take the latest second of the link record: reports that change nothing are only there."""
        link = self._run.links.get(run.port, ())
        place = bisect.bisect_right([second.utc for second in link], utc) - 1
        while place >= 0 and not link[place].sample.received:
            place -= 1
        if place < 0:
            return
        sample, known = link[place].sample, run.link.last_heard
        # The robot was heard within the seconds of the sample, at most `gap_s` before its end.
        heard = link[place].utc - min(sample.gap_s, sample.seconds)
        if known is None or heard > known.utc:
            run.link.show_heard(Now(heard, heard), sample.skew_s)
        else:
            run.link.show_heard(known, run.link.skew)
